#include "calibrate/search/free_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibrate/causes/free_shape.hpp"
#include "calibrate/causes/reading_change.hpp"
#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"

namespace gear3k::calibrate {

namespace {

/// The fit of the best score among those that were offered.
class BestFit {
 public:
  BestFit(const Problem& problem, Fit found, double scale)
      : problem_(problem),
        scale_(scale),
        fit_(std::move(found)),
        score_(score_of(problem_, fit_, scale_)) {}

  /// @returns whether it is the best now
  bool offer(Fit trial) {
    const double score = score_of(problem_, trial, scale_);
    if (!(score > score_)) return false;
    score_ = score;
    fit_ = std::move(trial);
    return true;
  }
  /// Fits the hypothesis first; one of too many parameters is none.
  bool offer(Hypothesis h) {
    if (h.value.size() > static_cast<std::size_t>(kMostParameters)) return false;
    return offer(fit(problem_, std::move(h), scale_));
  }
  [[nodiscard]] const Hypothesis& hypothesis() const { return fit_.hypothesis; }
  [[nodiscard]] Fit take() && { return std::move(fit_); }

 private:
  const Problem& problem_;
  double scale_;
  Fit fit_;
  double score_;
};

}  // namespace

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

bool may_free(const Hypothesis& h, std::size_t effect, const Candidate& form) {
  const Candidate& own = h.effects[effect];
  if (form.form.weight > 0.0 || form.cause != own.cause || form.form.law != own.form.law ||
      form.form.body != own.form.body || form.form.order != own.form.order) {
    return false;
  }
  // As many parameters, but by each mesh's own share of the load or by its force.
  const bool other_variable =
      own.form.weight == 0.0 && form.parameters.size() == own.parameters.size() &&
      form.form.name.ends_with(kByTorque) != own.form.name.ends_with(kByTorque);
  if (form.parameters.size() <= own.parameters.size() && !other_variable) return false;
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
      for (const Candidate& form : all) {
        if (!may_free(best.hypothesis(), e, form)) continue;
        again = best.offer(in_form(best.hypothesis(), e, form)) || again;
      }
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
    const bool plain = c.form.name == kAnySmooth;
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
  BestFit best(problem, std::move(found), scale);
  for (std::size_t e = 0; e < h.effects.size(); ++e) {
    if (!is_smooth(h.effects[e].form)) continue;
    for (const Candidate& form : all) {
      if (form.cause == h.effects[e].cause && form.form.law == h.effects[e].form.law &&
          has_level_parameter(form.parameters) && !is_smooth(form.form)) {
        best.offer(with(without(h, e), form));
      }
    }
  }
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
  std::optional<Fit> best;
  std::vector<Fit> result;
  for (const Candidate& form : all) {
    if (!(form.form.weight > 0.0)) continue;
    const bool level =
        form.cause->remedy == Remedy::kFrictionValue && has_level_parameter(own.parameters);
    const bool plain = form.cause == own.cause && form.form.law == own.form.law &&
                       form.form.body == own.form.body && form.form.order == own.form.order;
    if (!level && !plain) continue;
    Fit trial = fit(problem, with(without(h, effect), form), scale);
    if (level) {
      result.push_back(std::move(trial));
    } else if (!best || trial.sum_of_squares < best->sum_of_squares) {
      best = std::move(trial);
    }
  }
  if (best) result.push_back(std::move(*best));
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
      for (const Candidate& c : most_promising(problem, all, plain, scale)) {
        best.offer(with(plain.hypothesis, c));
      }
    }
  }
  return std::move(best).take();
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
    for (std::size_t e = 0; e < h.effects.size() && h.effects.size() > 1; ++e) {
      const Fit rest = fit(problem, without(h, e), scale);
      again = best.offer(rest) || again;
      for (const Candidate& c : most_promising(problem, all, rest, scale)) {
        if (c.cause != h.effects[e].cause || c.form.law != h.effects[e].form.law) {
          again = best.offer(with(rest.hypothesis, c)) || again;
        }
      }
    }
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
  BestFit best(problem, std::move(found), scale);
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
        best.offer(with(rest, *form));
      }
    }
  }
  const bool changed = !same_forms(best.hypothesis(), h);
  Fit result = std::move(best).take();
  if (!changed) return result;
  result = with_exchanges(problem, all, std::move(result), scale);
  return with_free_shapes(problem, all, with_fewer_bends(problem, all, std::move(result), scale),
                          scale);
}

namespace {

/// ln L by which a second name has to be there beside another: ΔBIC 10, strong evidence.
constexpr double kStrongLogLikelihood = 5.0;

/// The fit of the best score among those of one name in the place of several.
class BestOfOne {
 public:
  BestOfOne(const Problem& problem, double scale) : problem_(problem), scale_(scale) {}
  /// One of too many parameters is none.
  void offer(Hypothesis h) {
    if (h.value.size() > static_cast<std::size_t>(kMostParameters)) return;
    Fit trial = fit(problem_, std::move(h), scale_);
    const double score = score_of(problem_, trial, scale_);
    if (fit_ && !(score > score_)) return;
    score_ = score;
    fit_ = std::move(trial);
  }
  /// Of several names the second has to be as strongly there as beside any other (ΔBIC 10).
  [[nodiscard]] Fit in_place_of(Fit several) && {
    const bool stays = fit_ && score_ > score_of(problem_, several, scale_) - kStrongLogLikelihood;
    return stays ? std::move(*fit_) : std::move(several);
  }

 private:
  const Problem& problem_;
  double scale_;
  std::optional<Fit> fit_;
  double score_ = 0.0;
};

/// Whether an effect is play beside a wind-up: both are in every gearbox, and a wind-up that is
/// soft enough draws play as well.
bool is_play_beside_windup(const Hypothesis& h, std::size_t effect) {
  return h.effects[effect].cause->remedy == Remedy::kClearance &&
         std::ranges::any_of(
             h.effects, [](const Candidate& c) { return c.cause->remedy == Remedy::kStiffness; });
}

}  // namespace

Fit with_freed_rests(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale) {
  for (bool again = true; again && found.hypothesis.effects.size() > 1;) {
    again = false;
    const Hypothesis h = found.hypothesis;
    double most = score_of(problem, found, scale) - kStrongLogLikelihood;
    std::optional<Fit> freed;
    for (std::size_t e = 0; e < h.effects.size(); ++e) {
      if (is_play_beside_windup(h, e)) continue;
      const Fit rest = fit(problem, without(h, e), scale);
      Fit trial = with_free_shapes(problem, all, rest, scale);
      const double score = score_of(problem, trial, scale);
      if (same_forms(trial.hypothesis, rest.hypothesis) || !(score > most)) continue;
      most = score;
      freed = std::move(trial);
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
  BestOfOne one(problem, scale);
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
        one.offer(std::move(trial));
      }
    }
  }
  return std::move(one).in_place_of(std::move(found));
}

Fit with_one_wave(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                  double scale) {
  const Hypothesis h = found.hypothesis;
  std::vector<bool> stays;
  stays.reserve(h.effects.size());
  for (const Candidate& c : h.effects) stays.push_back(!(c.form.order > 0.0));
  if (std::ranges::count(stays, false) < 2) return found;
  const Hypothesis rest = subset(h, stays);
  BestOfOne one(problem, scale);
  for (const Candidate& form : all) {
    if (!(form.form.order > 0.0) || form.form.weight > 0.0) continue;
    if (std::ranges::none_of(h.effects, [&](const Candidate& c) {
          return c.form.order > 0.0 && c.form.law == form.form.law;
        })) {
      continue;
    }
    one.offer(with(rest, form));
  }
  return std::move(one).in_place_of(std::move(found));
}

namespace {

/// The cause of what all rows have in common where a change acts.
std::string_view constant_on(Target target) {
  switch (target) {
    case Target::kFriction:
      return "friction_level";
    case Target::kGain:
      return "sensor_gain";
    case Target::kOffset:
      return "sensor_offset";
    case Target::kDrag:
      return "drag_constant";
    case Target::kAdded:
      break;
  }
  return "clearance";
}

/// The hypothesis with a drift's value at the start as a cause of its own; none where there is no
/// such cause or it is there already.
std::optional<Hypothesis> with_named_start(const std::vector<Candidate>& all, const Hypothesis& h,
                                           std::size_t effect, Candidate& constant) {
  const Candidate& own = h.effects[effect];
  const std::string_view id = constant_on(target_of(own.form.name));
  const auto named = std::ranges::find_if(all, [&](const Candidate& c) {
    return c.cause->id == id && c.form.weight > 0.0 && c.parameters.size() == 1;
  });
  const auto without_start = std::ranges::find_if(all, [&](const Candidate& c) {
    return c.cause == own.cause && c.form.law == own.form.law &&
           c.parameters.size() + 1 == own.parameters.size() &&
           std::ranges::all_of(c.parameters,
                               [&](const ParameterRecord& r) {
                                 return r.name != kStartChange &&
                                        std::ranges::find(own.parameters, r.name,
                                                          &ParameterRecord::name) !=
                                            own.parameters.end();
                               }) &&
           own.form.name.starts_with(c.form.name.substr(0, c.form.name.find('_')));
  });
  if (named == all.end() || without_start == all.end() || has_cause(h, named->cause)) {
    return std::nullopt;
  }
  constant = *named;
  const double start = values_of(h, effect).back();
  Hypothesis result = with(in_form(h, effect, *without_start), constant);
  result.value.back() = start;
  return result;
}

}  // namespace

namespace {

/// ln L by which a fit with a constant as a cause of its own may be worse.
constexpr double kAsGood = 3.0;

}  // namespace

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
    if (!(none - alone > kLargePart * (none - found.sum_of_squares))) continue;
    Fit trial = fit(problem, *named, scale);
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
  const std::string_view id = constant_on(target_of(own.form.law));
  const auto constant = std::ranges::find_if(all, [&](const Candidate& c) {
    return c.cause->id == id && c.form.weight > 0.0 && c.parameters.size() == 1;
  });
  if (constant == all.end() || has_cause(rest, constant->cause)) return std::nullopt;
  const Fit mean = fit(problem, with(rest, *constant), scale);
  BestFit best(problem, mean, scale);
  for (const Candidate& c : all) {
    const bool in_time = c.cause == own.cause || c.cause->id == "drift";
    if (in_time && c.form.law == own.form.law && c.form.weight > 0.0 &&
        !gives_each_session_a_value(c.form) && !has_cause(rest, c.cause)) {
      best.offer(with(mean.hypothesis, c));
    }
  }
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
