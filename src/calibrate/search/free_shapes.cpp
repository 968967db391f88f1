#include "calibrate/search/free_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/causes/reading_change.hpp"
#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/search/best_fit.hpp"

namespace gear3k::calibrate {

namespace {

bool has_parameter(const Candidate& c, std::string_view name) {
  return std::ranges::find(c.parameters, name, &ParameterRecord::name) != c.parameters.end();
}

/// The hypothesis without the level of friction; none where it has not got it by itself.
std::optional<Hypothesis> without_level(const Hypothesis& h) {
  for (std::size_t e = 0; e < h.effects.size(); ++e) {
    if (h.effects[e].cause->remedy == Remedy::kFrictionValue) return without(h, e);
  }
  return std::nullopt;
}

}  // namespace

Hypothesis in_form(const Hypothesis& h, std::size_t effect, const Candidate& form) {
  Hypothesis result = h;
  const Candidate& own = h.effects[effect];
  const auto old = values_of(h, effect);
  const auto first = static_cast<std::ptrdiff_t>(value_offset(h, effect));
  std::vector<double> values;
  values.reserve(form.parameters.size());
  for (const ParameterRecord& record : form.parameters) {
    const auto same = std::ranges::find(own.parameters, record.name, &ParameterRecord::name);
    values.push_back(same == own.parameters.end()
                         ? 0.0
                         : old[static_cast<std::size_t>(same - own.parameters.begin())]);
  }
  result.effects[effect] = form;
  result.value.erase(result.value.begin() + first,
                     result.value.begin() + first + static_cast<std::ptrdiff_t>(old.size()));
  result.value.insert(result.value.begin() + first, values.begin(), values.end());
  return result;
}

bool is_play_beside_windup(const Hypothesis& h, std::size_t effect) {
  return h.effects[effect].cause->remedy == Remedy::kClearance &&
         std::ranges::any_of(
             h.effects, [](const Candidate& c) { return c.cause->remedy == Remedy::kStiffness; });
}

bool may_free(const Hypothesis& h, std::size_t effect, const Candidate& form) {
  const Candidate& own = h.effects[effect];
  if (form.form.weight > 0.0 || form.cause != own.cause || form.form.law != own.form.law ||
      form.form.body != own.form.body || form.form.order != own.form.order) {
    return false;
  }
  // As many parameters, but by each mesh's own share of the load or by its force.
  const bool other_variable = own.form.weight == 0.0 &&
                              form.parameters.size() == own.parameters.size() &&
                              load_variable(form.form) != load_variable(own.form);
  // As many, but of the levels that the data have.
  const bool levels = is_of_levels(form.form) && !is_smooth(own.form) &&
                      form.parameters.size() == own.parameters.size();
  if (form.parameters.size() <= own.parameters.size() && !other_variable && !levels) return false;
  // What bends may need a curve of any shape.
  if (is_smooth(form.form) && !is_smooth(own.form) && !has_parameter(own, "curvature")) {
    return false;
  }
  // A form with a level of its own makes no sense beside the level.
  const bool level_beside = std::ranges::any_of(h.effects, [&](const Candidate& c) {
    return &c != &own && has_level_parameter(c.parameters);
  });
  return !(level_beside && has_level_parameter(form.parameters));
}

double log_weight_of(const Candidate& candidate) {
  // A form with free parameters pays for them; beyond that it is one form among those of its cause.
  constexpr double kFreeForm = 0.05;
  const double weight = candidate.form.weight > 0.0 ? candidate.form.weight : kFreeForm;
  return std::log(weight * candidate.cause->weight);
}

double score_of(const Problem& problem, const Fit& fit, double scale) {
  const auto n = static_cast<double>(problem.data.rows.size());
  const auto p = static_cast<double>(fit.hypothesis.value.size());
  const double known = problem.noise.known_scale();
  const double likelihood = known > 0.0
                                ? -0.5 * fit.sum_of_squares * scale * scale / (known * known)
                                : -0.5 * n * std::log(std::max(fit.sum_of_squares, 1e-12));
  double log_weight = 0.0;
  // The coefficient of friction is a parameter, and preferred to a missing effect at a tie (χ² 3).
  constexpr double kOfParameter = 1.5;
  for (const Candidate& c : fit.hypothesis.effects) {
    log_weight +=
        log_weight_of(c) + (c.cause->remedy == Remedy::kFrictionValue ? kOfParameter : 0.0);
  }
  return likelihood - 0.5 * p * std::log(std::max(n, 2.0)) + log_weight;
}

namespace {

/// A law beside the level of friction, with that level as its own and of free shape.
bool offer_own_level(const std::vector<Candidate>& all, BestFit& best) {
  const std::optional<Hypothesis> rest = without_level(best.hypothesis());
  if (!rest) return false;
  bool better = false;
  for (std::size_t e = 0; e < rest->effects.size(); ++e) {
    for (const Candidate& form : all) {
      if (!has_level_parameter(form.parameters) || !may_free(*rest, e, form)) continue;
      better = best.offer(in_form(*rest, e, form)) || better;
    }
  }
  return better;
}

}  // namespace

Fit with_free_shapes(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale) {
  BestFit best(problem, std::move(found), scale);
  for (bool again = true; again;) {
    again = false;
    for (std::size_t e = 0; e < best.hypothesis().effects.size(); ++e) {
      // All from the same fit: the first that is better may be another one's likeness.
      const Hypothesis from = best.hypothesis();
      std::vector<Hypothesis> freer;
      for (const Candidate& form : all) {
        if (may_free(from, e, form)) freer.push_back(in_form(from, e, form));
      }
      again = best.offer_all(std::move(freer)) || again;
    }
    again = again || offer_own_level(all, best);
  }
  return std::move(best).take();
}

namespace {

/// The cause whose smooth law takes most off what a hypothesis leaves, by linearisation.
std::optional<Candidate> likeliest_smooth(const Problem& problem, const std::vector<Candidate>& all,
                                          const Hypothesis& rest, double scale) {
  std::vector<Candidate> smooth;
  for (const Candidate& c : all) {
    const bool plain =
        c.form.name == kAnySmooth || (is_of_levels(c.form) && load_variable(c.form).empty());
    if (plain && !has_cause(rest, c.cause)) smooth.push_back(c);
  }
  if (smooth.size() < 2) return smooth.empty() ? std::nullopt : std::optional(smooth.front());
  const Fit left = fit(problem, rest, scale);
  const double wide = std::max(scale, robust_deviation(left.residual));
  const Columns columns = columns_at(problem, left.hypothesis, smooth, wide);
  if (columns.own.cols() >= columns.own.rows()) return std::nullopt;
  const Screen screen(columns.own, columns.other, blocks_of(smooth), problem.noise.known_scale());
  const std::vector<Gain> gains = screen.gains(columns.residual);
  const auto most = std::ranges::max_element(gains, {}, &Gain::sum_of_squares);
  return smooth[static_cast<std::size_t>(most - gains.begin())];
}

/// A law of any smooth curve as one of the same cause with fewer parameters, where that scores
/// better.
Fit with_fewer_bends(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale) {
  const Hypothesis h = found.hypothesis;
  std::vector<Hypothesis> others;
  for (std::size_t e = 0; e < h.effects.size(); ++e) {
    if (!is_smooth(h.effects[e].form)) continue;
    for (const Candidate& form : all) {
      if (form.cause == h.effects[e].cause && form.form.law == h.effects[e].form.law &&
          has_level_parameter(form.parameters) && !is_smooth(form.form)) {
        others.push_back(with(without(h, e), form));
      }
    }
  }
  BestFit best(problem, std::move(found), scale);
  best.offer_all(std::move(others));
  return std::move(best).take();
}

/// The three causes that explain most of what a fit leaves, each in its best plain form; of rows
/// far off clipped, and of all rows as they are.
std::vector<Candidate> most_promising(const Problem& problem, const std::vector<Candidate>& all,
                                      const Fit& fit, double scale) {
  constexpr std::size_t kMost = 3;
  std::vector<Candidate> others;
  for (const Candidate& c : all) {
    if (c.form.weight > 0.0 && !has_cause(fit.hypothesis, c.cause)) others.push_back(c);
  }
  const double wide = std::max(scale, robust_deviation(fit.residual));
  const Columns columns = columns_at(problem, fit.hypothesis, others, wide);
  if (columns.own.cols() >= columns.own.rows()) return {};
  const Screen screen(columns.own, columns.other, blocks_of(others), problem.noise.known_scale());
  std::vector<std::size_t> taken;
  for (const Eigen::VectorXd* residual : {&columns.residual, &columns.raw}) {
    std::vector<std::size_t> order = ranked(others, screen.gains(*residual), 1);
    if (order.size() > kMost) order.resize(kMost);
    for (const std::size_t k : order) {
      if (std::ranges::find(taken, k) == taken.end()) taken.push_back(k);
    }
  }
  std::vector<Candidate> result;
  result.reserve(taken.size());
  for (const std::size_t k : taken) result.push_back(others[k]);
  return result;
}

/// Fits with something plain in the place of an effect of free shape: the best plain form of its
/// cause, and the coefficient of friction alone where the form has a level.
std::vector<Fit> plain_fits(const Problem& problem, const std::vector<Candidate>& all,
                            const Hypothesis& h, std::size_t effect, double scale) {
  const Candidate& own = h.effects[effect];
  std::vector<Hypothesis> levels, forms;
  for (const Candidate& form : all) {
    if (!(form.form.weight > 0.0)) continue;
    const bool level =
        form.cause->remedy == Remedy::kFrictionValue && has_level_parameter(own.parameters);
    const bool plain = form.cause == own.cause && form.form.law == own.form.law &&
                       form.form.body == own.form.body && form.form.order == own.form.order;
    if (!level && !plain) continue;
    (level ? levels : forms).push_back(with(without(h, effect), form));
  }
  std::vector<Fit> result = fit_all(problem, levels, scale);
  std::vector<Fit> plain = fit_all(problem, forms, scale);
  const auto best = std::ranges::min_element(plain, {}, &Fit::sum_of_squares);
  if (best != plain.end()) result.push_back(std::move(*best));
  return result;
}

}  // namespace

Fit with_plain_shapes(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                      double scale, int most) {
  const Hypothesis h = found.hypothesis;
  BestFit best(problem, std::move(found), scale);
  for (std::size_t e = 0; e < h.effects.size() && static_cast<int>(h.effects.size()) < most; ++e) {
    if (h.effects[e].form.weight > 0.0) continue;
    for (const Fit& plain : plain_fits(problem, all, h, e, scale)) {
      best.offer(plain);
      std::vector<Hypothesis> more;
      for (const Candidate& c : most_promising(problem, all, plain, scale)) {
        more.push_back(with(plain.hypothesis, c));
      }
      best.offer_all(std::move(more));
    }
    std::vector<Hypothesis> with_play;
    for (const Candidate& c : all) {
      if (!(c.form.weight > 0.0) || has_cause(h, c.cause)) continue;
      Hypothesis more = with(h, c);
      if (is_play_beside_windup(more, h.effects.size())) with_play.push_back(std::move(more));
    }
    best.offer_all(std::move(with_play));
  }
  const bool changed = !same_forms(best.hypothesis(), h);
  Fit result = std::move(best).take();
  return changed ? with_free_shapes(problem, all, std::move(result), scale) : result;
}

Fit with_exchanges(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                   double scale) {
  BestFit best(problem, std::move(found), scale);
  constexpr int kRounds = 3;
  bool again = true;
  bool exchanged = false;
  for (int round = 0; round < kRounds && again; ++round) {
    again = false;
    const Hypothesis h = best.hypothesis();
    if (h.effects.size() < 2) break;
    std::vector<Hypothesis> rests, others;
    for (std::size_t e = 0; e < h.effects.size(); ++e) rests.push_back(without(h, e));
    const std::vector<Fit> left = fit_all(problem, rests, scale);
    for (std::size_t e = 0; e < h.effects.size(); ++e) {
      again = best.offer(left[e]) || again;
      for (const Candidate& c : most_promising(problem, all, left[e], scale)) {
        if (c.cause != h.effects[e].cause || c.form.law != h.effects[e].form.law) {
          others.push_back(with(left[e].hypothesis, c));
        }
      }
    }
    again = best.offer_all(std::move(others)) || again;
    exchanged = exchanged || again;
  }
  Fit result = std::move(best).take();
  return exchanged ? with_free_shapes(problem, all, std::move(result), scale) : result;
}

Fit with_smooth_laws(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale) {
  const Hypothesis h = found.hypothesis;
  const std::size_t count = h.effects.size();
  if (count < 2) return found;
  std::vector<Hypothesis> others;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a; b < count; ++b) {
      // No curve of a condition goes around with an angle.
      if (h.effects[a].form.order > 0.0 || h.effects[b].form.order > 0.0) continue;
      std::vector<bool> stays(count, true);
      stays[a] = stays[b] = false;
      const Hypothesis rest = subset(h, stays);
      const bool has_level = std::ranges::any_of(
          rest.effects, [](const Candidate& c) { return has_level_parameter(c.parameters); });
      if (has_level) continue;
      if (const auto form = likeliest_smooth(problem, all, rest, scale)) {
        others.push_back(with(rest, *form));
      }
    }
  }
  BestFit best(problem, std::move(found), scale);
  best.offer_all(std::move(others));
  const bool changed = !same_forms(best.hypothesis(), h);
  Fit result = std::move(best).take();
  if (!changed) return result;
  result = with_exchanges(problem, all, std::move(result), scale);
  return with_free_shapes(problem, all, with_fewer_bends(problem, all, std::move(result), scale),
                          scale);
}

}  // namespace gear3k::calibrate
