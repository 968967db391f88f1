#include "calibrate/search/second_names.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/causes/reading_change.hpp"
#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/search/best_fit.hpp"
#include "calibrate/search/free_shapes.hpp"

namespace gear3k::calibrate {

namespace {

/// ln L by which a second name has to be there beside another: ΔBIC 10, strong evidence.
constexpr double kStrongLogLikelihood = 5.0;

/// ln L by which a fit with a constant as a cause of its own may be worse.
constexpr double kAsGood = 3.0;

}  // namespace

Fit with_freed_rests(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale) {
  for (bool again = true; again && found.hypothesis.effects.size() > 1;) {
    again = false;
    const Hypothesis h = found.hypothesis;
    double most = score_of(problem, found, scale) - kStrongLogLikelihood;
    std::vector<Fit> trials(h.effects.size());
    for_fits(problem, trials.size(), [&](std::size_t e) {
      if (is_play_beside_windup(h, e)) return;
      trials[e] = with_free_shapes(problem, all, fit(problem, without(h, e), scale), scale);
    });
    std::optional<Fit> freed;
    for (std::size_t e = 0; e < trials.size(); ++e) {
      if (is_play_beside_windup(h, e)) continue;
      const double score = score_of(problem, trials[e], scale);
      if (same_forms(trials[e].hypothesis, without(h, e)) || !(score > most)) continue;
      most = score;
      freed = std::move(trials[e]);
    }
    again = freed.has_value();
    if (freed) found = std::move(*freed);
  }
  return found;
}

Fit with_one_law_of_time(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                         double scale) {
  const Hypothesis h = found.hypothesis;
  const auto at = [&](std::string_view id) {
    return std::ranges::find_if(h.effects, [&](const Candidate& c) { return c.cause->id == id; });
  };
  const auto drift = at("drift"), step = at("run_step");
  if (drift == h.effects.end() || step == h.effects.end()) return found;
  std::vector<bool> stays(h.effects.size(), true);
  stays[static_cast<std::size_t>(drift - h.effects.begin())] = false;
  stays[static_cast<std::size_t>(step - h.effects.begin())] = false;
  const Hypothesis rest = subset(h, stays);
  const double change = values_of(h, static_cast<std::size_t>(drift - h.effects.begin())).front();
  std::vector<Hypothesis> starts;
  for (const Candidate& form : all) {
    if (form.cause != drift->cause || form.form.weight > 0.0) continue;
    if (form.form.law != drift->form.law && form.form.law != step->form.law) continue;
    // Steep or flat, early or late: from one place alone the fit may end in a valley beside it.
    for (const double scale_from : {0.0, 1.0}) {
      for (const double exponent_from : {0.0, 1.0}) {
        Hypothesis trial = with(rest, form);
        bool has_exponent = false;
        for (std::size_t k = 0; k < form.parameters.size(); ++k) {
          double& value = trial.value[rest.value.size() + k];
          const std::string_view name = form.parameters[k].name;
          if (name == "change") value = change;
          if (name == "log_scale_change") value = scale_from;
          if (name == "log_exponent") {
            value = exponent_from;
            has_exponent = true;
          }
        }
        if (!has_exponent && exponent_from > 0.0) continue;
        starts.push_back(std::move(trial));
      }
    }
  }
  BestFit one(problem, scale);
  one.offer_all(std::move(starts));
  return std::move(one).or_else(std::move(found), kStrongLogLikelihood);
}

Fit with_one_wave(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                  double scale) {
  const Hypothesis h = found.hypothesis;
  std::vector<bool> stays;
  stays.reserve(h.effects.size());
  for (const Candidate& c : h.effects) stays.push_back(!(c.form.order > 0.0));
  if (std::ranges::count(stays, false) < 2) return found;
  const Hypothesis rest = subset(h, stays);
  std::vector<Hypothesis> waves;
  for (const Candidate& form : all) {
    if (!(form.form.order > 0.0) || form.form.weight > 0.0) continue;
    if (std::ranges::none_of(h.effects, [&](const Candidate& c) {
          return c.form.order > 0.0 && c.form.law == form.form.law;
        })) {
      continue;
    }
    waves.push_back(with(rest, form));
  }
  BestFit one(problem, scale);
  one.offer_all(std::move(waves));
  return std::move(one).or_else(std::move(found), kStrongLogLikelihood);
}

namespace {

/// Whether a candidate is what all rows have in common where a change acts.
bool is_constant_on(Target target, const Candidate& c) {
  if (!(c.form.weight > 0.0) || c.parameters.size() != 1) return false;
  switch (target) {
    case Target::kFriction:
      return c.cause->id == "friction_level";
    case Target::kGain:
      return c.cause->id == "sensor_gain";
    case Target::kOffset:
      return c.cause->id == "sensor_offset" && c.form.name == "offset";
    case Target::kDrag:
      return c.cause->id == "drag_constant";
    case Target::kAdded:
      break;
  }
  // Another load at the output asks for about as much more torque in all rows.
  return c.cause->id == "clearance" ||
         (c.cause->id == "sensor_offset" && c.form.name == kOutputMagnitude);
}

/// That candidate; null where there is none or its cause is there already.
const Candidate* constant_on(Target target, const std::vector<Candidate>& all,
                             const Hypothesis& beside) {
  const auto constant =
      std::ranges::find_if(all, [&](const Candidate& c) { return is_constant_on(target, c); });
  return constant != all.end() && !has_cause(beside, constant->cause) ? &*constant : nullptr;
}

/// The hypothesis with a drift's value at the start as a cause of its own; none where there is no
/// such cause or it is there already.
std::optional<Hypothesis> with_named_start(const std::vector<Candidate>& all, const Hypothesis& h,
                                           std::size_t effect, Candidate& constant) {
  const Candidate& own = h.effects[effect];
  const Candidate* const named = constant_on(target_of(own.form.name), all, h);
  // Of the same shape along the same variable.
  std::string name = own.form.name;
  constexpr std::string_view kFrom = "_any_start";
  if (const auto at = name.find(kFrom); at != std::string::npos) name.erase(at, kFrom.size());
  const auto without_start = std::ranges::find_if(
      all, [&](const Candidate& c) { return c.cause == own.cause && c.form.name == name; });
  if (named == nullptr || without_start == all.end()) return std::nullopt;
  constant = *named;
  const double start = values_of(h, effect).back();
  Hypothesis result = with(in_form(h, effect, *without_start), constant);
  result.value.back() = start;
  return result;
}

/// The best score of a drift of any shape without a value at the start in the place of one with it.
double best_without_start(const Problem& problem, const std::vector<Candidate>& all,
                          const Hypothesis& h, std::size_t effect, double scale) {
  std::vector<Hypothesis> starts;
  for (const Candidate& c : all) {
    if (c.cause == h.effects[effect].cause && c.form.law == h.effects[effect].form.law &&
        !has_start_parameter(c.parameters)) {
      starts.push_back(in_form(h, effect, c));
    }
  }
  double best = -HUGE_VAL;
  for (const Fit& trial : fit_all(problem, starts, scale)) {
    best = std::max(best, score_of(problem, trial, scale));
  }
  return best;
}

}  // namespace

const Candidate* constant_of(const std::vector<Candidate>& all, const Hypothesis& h,
                             std::size_t effect) {
  return constant_on(target_of(h.effects[effect].form.law), all, without(h, effect));
}

Fit with_named_starts(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                      double scale, int most) {
  for (std::size_t e = 0; e < found.hypothesis.effects.size(); ++e) {
    const Hypothesis& h = found.hypothesis;
    if (static_cast<int>(h.effects.size()) >= most) break;
    if (!has_start_parameter(h.effects[e].parameters)) continue;
    Candidate constant;
    const std::optional<Hypothesis> named = with_named_start(all, h, e, constant);
    if (!named || named->value.size() > static_cast<std::size_t>(kMostParameters)) continue;
    const Hypothesis rest = without(h, e);
    const double none = fit(problem, rest, scale).sum_of_squares;
    const double alone = fit(problem, with(rest, constant), scale).sum_of_squares;
    constexpr double kLargePart = 0.5;
    Fit trial = fit(problem, *named, scale);
    if (!(none - alone > kLargePart * (none - found.sum_of_squares)) &&
        !(score_of(problem, trial, scale) >
          best_without_start(problem, all, h, e, scale) + kStrongLogLikelihood)) {
      continue;
    }
    if (score_of(problem, trial, scale) > score_of(problem, found, scale) - kAsGood) {
      found = std::move(trial);
    }
  }
  return found;
}

namespace {

/// Sessions that each have a value, as what they have in common and one change in time beside it,
/// or as that alone; none where there is no such constant or it is there already.
std::optional<Fit> with_named_mean(const Problem& problem, const std::vector<Candidate>& all,
                                   const Hypothesis& rest, const Candidate& own, double scale) {
  const Candidate* const constant = constant_on(target_of(own.form.law), all, rest);
  if (constant == nullptr) return std::nullopt;
  const Fit mean = fit(problem, with(rest, *constant), scale);
  std::vector<Hypothesis> changes;
  for (const Candidate& c : all) {
    const bool in_time = c.cause == own.cause || c.cause->id == "drift";
    if (in_time && c.form.law == own.form.law && c.form.weight > 0.0 &&
        !gives_each_session_a_value(c.form) && !has_cause(rest, c.cause)) {
      changes.push_back(with(mean.hypothesis, c));
    }
  }
  BestFit best(problem, mean, scale);
  best.offer_all(std::move(changes));
  return with_free_shapes(problem, all, std::move(best).take(), scale);
}

}  // namespace

Fit with_named_means(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale, int most) {
  for (std::size_t e = 0; e < found.hypothesis.effects.size(); ++e) {
    const Hypothesis& h = found.hypothesis;
    if (static_cast<int>(h.effects.size()) >= most) break;
    if (!gives_each_session_a_value(h.effects[e].form)) continue;
    std::optional<Fit> named = with_named_mean(problem, all, without(h, e), h.effects[e], scale);
    if (named && score_of(problem, *named, scale) > score_of(problem, found, scale) - kAsGood) {
      found = std::move(*named);
    }
  }
  return found;
}

}  // namespace gear3k::calibrate
