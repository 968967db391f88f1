#include "calibrate/search/better_names.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/search/replacements.hpp"

namespace gear3k::calibrate {

namespace {

/// χ² within which the coefficient of friction, a parameter, is preferred to a missing effect.
constexpr double kParameter = 4.0;

bool is_step(const Cause& cause) { return cause.id == "run_step"; }

/// Laws of load, speed or temperature, which a session measured in order may imitate.
bool is_law(const Cause& cause) {
  return cause.remedy == Remedy::kFlanks || cause.remedy == Remedy::kDrag ||
         cause.remedy == Remedy::kBearings || cause.remedy == Remedy::kStiffness;
}

/// Whether the last effect, the level of friction, is one that is more likely than a missing
/// effect: within three times what is stated.
bool last_is_likely(const Hypothesis& h) {
  constexpr double kLeast = -0.7, kMost = 2.0;
  return h.value.back() >= kLeast && h.value.back() <= kMost;
}

/// The fit of a replacement with the new effect, which is its last, in the place of the old one.
Fit in_place(Fit fit, std::size_t effect) {
  Hypothesis& h = fit.hypothesis;
  const auto count = static_cast<std::ptrdiff_t>(h.effects.back().parameters.size());
  const auto first = static_cast<std::ptrdiff_t>(value_offset(h, effect));
  std::rotate(h.effects.begin() + static_cast<std::ptrdiff_t>(effect), h.effects.end() - 1,
              h.effects.end());
  std::rotate(h.value.begin() + first, h.value.end() - count, h.value.end());
  return fit;
}

/// The same cause at another body, or in the reading where the other is in the gearbox: one
/// sensor's zero, and the other's.
bool is_elsewhere(const Candidate& c, const Candidate& own) {
  return c.cause == own.cause && c.parameters.size() == own.parameters.size() &&
         (c.form.body != own.form.body || place_of(c) != place_of(own));
}

/// A fit with another form in the place of an effect, from where that does nothing.
Hypothesis start_with(const Hypothesis& h, std::size_t effect, const Candidate& form) {
  Hypothesis start = h;
  start.effects[effect] = form;
  const auto first = start.value.begin() + static_cast<std::ptrdiff_t>(value_offset(h, effect));
  std::fill_n(first, form.parameters.size(), 0.0);
  return start;
}

/// The effect's cause elsewhere, where that explains as well.
std::vector<Replacement> elsewhere(const Judge& judge, const SearchResult& result,
                                   std::size_t effect) {
  const Candidate& own = result.fit.hypothesis.effects[effect];
  std::vector<Replacement> found;
  std::vector<const Candidate*> bodies;
  std::vector<Hypothesis> starts;
  // Forms with harmonics are not searched for, but a body that is round in none has them too.
  for (const Candidate& c : judge.candidates()) {
    const bool searched = c.form.weight > 0.0 || own.form.order > 0.0;
    if (!searched || !is_elsewhere(c, own)) continue;
    bodies.push_back(&c);
    starts.push_back(start_with(result.fit.hypothesis, effect, c));
  }
  std::vector<Fit> fits = fit_all(judge.problem(), starts, judge.scale());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const double statistic = judge.difference(fits[k], result.fit);
    if (statistic > kAsWell) continue;
    found.push_back({.candidate = *bodies[k], .statistic = statistic, .fit = std::move(fits[k])});
  }
  std::ranges::stable_sort(found, {},
                           [](const Replacement& r) { return std::round(r.statistic / kSameChi); });
  return found;
}

/// What is missed is missed in readings: the zero of the sensor that gave them is named before that
/// of another one, where it explains as well.
void prefer_reading(const Judge& judge, SearchResult& result, std::size_t effect) {
  const Candidate own = result.fit.hypothesis.effects[effect];
  if (own.cause->place != Place::kMeasurement || place_of(own) != Place::kGearbox) return;
  std::optional<Fit> best;
  double least = kAsWell;
  for (const Candidate& c : judge.candidates()) {
    if (!(c.form.weight > 0.0) || !is_elsewhere(c, own) || place_of(c) == Place::kGearbox) continue;
    Fit trial = fit(judge.problem(), start_with(result.fit.hypothesis, effect, c), judge.scale());
    const double statistic = judge.difference(trial, result.fit);
    if (statistic > least) continue;
    least = statistic;
    best = std::move(trial);
  }
  if (!best) return;
  result.fit = std::move(*best);
  for (Replacement& r : result.effects[effect].replacements) r.statistic -= least;
  for (std::size_t other = 0; other < result.effects.size(); ++other) {
    if (other != effect) refit_beside(judge, result, other, result.effects[other].replacements);
  }
}

}  // namespace

void take_better_names(const Judge& judge, const std::vector<Candidate>& all,
                       SearchResult& result) {
  prefer_parameters(judge, result);
  for (std::size_t e = 0; e < result.effects.size(); ++e) prefer_reading(judge, result, e);
  const std::vector<Candidate> searched = result.fit.hypothesis.effects;
  take_unsearched_forms(judge, all, result);
  for (std::size_t e = 0; e < result.effects.size(); ++e) {
    weigh_effect(judge, result, e, searched[e], result.effects[e]);
    result.effects[e].other_bodies = elsewhere(judge, result, e);
  }
}

void prefer_parameters(const Judge& judge, SearchResult& result) {
  const auto rank = [](const Candidate& c) {
    return std::ranges::find(causes(), c.cause) - causes().begin();
  };
  for (std::size_t e = 0; e < result.effects.size(); ++e) {
    FoundEffect& found = result.effects[e];
    const Candidate own = result.fit.hypothesis.effects[e];
    if (is_parameter(*own.cause)) continue;
    constexpr double kTie = 1e-3;
    const auto parameter = [&](const Replacement& r) {
      return is_parameter(*r.candidate.cause) && r.statistic <= kParameter &&
             last_is_likely(r.fit.hypothesis);
    };
    const auto step = [&](const Replacement& r) {
      return is_step(*r.candidate.cause) && is_law(*own.cause) &&
             r.candidate.parameters.size() <= own.parameters.size() && r.statistic <= kPreferred;
    };
    const auto earlier = [&](const Replacement& r) {
      return !is_parameter(*r.candidate.cause) && !is_step(*r.candidate.cause) &&
             !is_step(*own.cause) && r.statistic <= kTie && rank(r.candidate) < rank(own);
    };
    const auto end = found.replacements.end();
    const auto first_that = [&](const auto& reason) {
      return std::ranges::find_if(found.replacements,
                                  [&](const Replacement& r) { return !r.with_level && reason(r); });
    };
    auto better = first_that(parameter);
    if (better == end) better = first_that(step);
    if (better == end) better = first_that(earlier);
    if (better == end) continue;
    const Replacement taken = *better;
    found.replacements.erase(better);
    for (Replacement& r : found.replacements) r.statistic -= taken.statistic;
    found.replacements.insert(
        found.replacements.begin(),
        {.candidate = own, .statistic = -taken.statistic, .fit = std::move(result.fit)});
    result.fit = in_place(taken.fit, e);
    for (std::size_t other = 0; other < result.effects.size(); ++other) {
      if (other != e) refit_beside(judge, result, other, result.effects[other].replacements);
    }
  }
}

namespace {

/// Whether the last effect of a hypothesis has values that a gearbox may show.
bool last_is_plausible(const Hypothesis& h) {
  const auto values = values_of(h, h.effects.size() - 1);
  const auto& records = h.effects.back().parameters;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!(values[k] >= records[k].plausible_low && values[k] <= records[k].plausible_high)) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool take_likelier_name(const Judge& judge, SearchResult& result) {
  for (std::size_t e = 0; e < result.effects.size(); ++e) {
    if (is_parameter(*result.fit.hypothesis.effects[e].cause)) continue;
    for (Replacement& r : result.effects[e].replacements) {
      const Hypothesis& h = r.fit.hypothesis;
      // An effect more has to pay as every one beside another does.
      const bool adds = h.effects.size() > result.effects.size();
      if (!(r.statistic < (adds ? -kBesideAnother : -kLikelier))) continue;
      // Nor back again: of any shape it is likelier, and by what the shape costs it is not.
      if (judge.difference(r.fit, result.fit) > kLikelier) continue;
      if (h.effects.size() > kMostEffects || !last_is_plausible(h)) continue;
      result.fit = r.with_level ? std::move(r.fit) : in_place(std::move(r.fit), e);
      return true;
    }
  }
  return false;
}

void take_unsearched_forms(const Judge& judge, const std::vector<Candidate>& all,
                           SearchResult& result) {
  const Candidate* level = level_of(result);
  for (std::size_t e = 0; e < result.effects.size(); ++e) {
    for (const Candidate& form : all) {
      const Fit& best = result.fit;
      const Candidate own = best.hypothesis.effects[e];
      if (form.form.weight > 0.0 || own.form.weight == 0.0 || form.cause != own.cause ||
          form.form.law != own.form.law || form.form.order != own.form.order) {
        continue;
      }
      // A form with a level of its own makes no sense beside the level.
      const bool no_level = level == nullptr || has_cause(best.hypothesis, level->cause);
      if (no_level && has_level_parameter(form.parameters)) continue;
      // Whether a free shape is worth its parameters the search has settled.
      if (form.parameters.size() != own.parameters.size()) continue;
      const std::size_t at = value_offset(best.hypothesis, e);
      Hypothesis h = best.hypothesis;
      h.effects[e] = form;
      Fit trial = fit(judge.problem(), std::move(h), judge.scale());
      const double value = trial.hypothesis.value[at];
      const bool plausible =
          value >= form.parameters[0].plausible_low && value <= form.parameters[0].plausible_high;
      if (plausible && judge.chi(trial) <= judge.chi(best) + kPreferred) {
        result.fit = std::move(trial);
      }
    }
  }
}

}  // namespace gear3k::calibrate
