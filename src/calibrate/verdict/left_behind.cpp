#include "calibrate/verdict/left_behind.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calibrate/causes/reading_change.hpp"
#include "calibrate/measurement/noise.hpp"
#include "calibrate/verdict/correction.hpp"

namespace gear3k::calibrate {

namespace {

/// Whether values of sessions say nothing of the next one: they are drawn anew, or may be.
bool is_drawn_anew(const Form& form) {
  return std::ranges::find(form.constants, kSessions, &FormConstant::name) != form.constants.end();
}

bool goes_by_conditions(const Alternative& a) {
  const Cause* cause = find_cause(a.id);
  return cause != nullptr && cause->leave_behind == nullptr;
}

/// Whether it is not known that a change stays as it was at the end.
bool may_not_stay(const Candidate& c, const std::vector<Effect>& found) {
  if (is_drawn_anew(c.form)) return true;
  const auto own = std::ranges::find_if(found, [&](const Effect& effect) {
    return effect.id == c.cause->id && effect.form.name == c.form.name;
  });
  return own == found.end() || std::ranges::any_of(own->alternatives, goes_by_conditions);
}

std::vector<std::string_view> laws_of_refits(Kind kind) {
  if (kind == Kind::kLostMotion || kind == Kind::kTorqueAngle) return {""};
  return {kOnFriction, kOnGain};
}

struct TriedChange {
  CommonChange change;
  double missed = HUGE_VAL;  ///< huber_square() of the measured rows over the scale
};

/// Least Σ ρ((r − x s)/scale) by steps that never raise it: ρ bends no more than a square does.
double huber_slope(const Eigen::VectorXd& residual, const Eigen::VectorXd& slope, double scale) {
  constexpr int kMost = 200;
  constexpr double kSame = 1e-12;
  const double square = slope.squaredNorm();
  if (!(square > 0.0)) return kUnknown;
  double x = 0.0;
  for (int step = 0; step < kMost; ++step) {
    const double more = slope.dot(winsorised(residual - x * slope, scale)) / square;
    x += more;
    if (std::abs(more) <= kSame * std::abs(x)) break;
  }
  return x;
}

/// What a refit is made to.
struct RefittedRows {
  Eigen::VectorXd measured, weight;
  double scale = 0.0;  ///< of the weighted rows without the effect
};

/// The change of one law in the place of an effect, by Gauss-Newton steps.
std::optional<TriedChange> in_its_place(const Problem& problem, const Hypothesis& fitted,
                                        std::size_t effect, const RefittedRows& rows,
                                        std::string_view law) {
  constexpr int kSteps = 3;
  const Candidate& own = fitted.effects[effect];
  Candidate constant{
      .cause = own.cause, .form = own.cause->as_constant(own.form, law), .parameters = {}};
  constant.parameters = own.cause->parameters(constant.form, problem.data.kind);
  const ParameterRecord& range = constant.parameters.front();
  Hypothesis one = with(without(fitted, effect), constant);
  double& change = one.value.back();
  for (int step = 0;; ++step) {
    const Linearisation at = linearise(problem, one, {});
    if (!at.runs) return std::nullopt;
    const Eigen::VectorXd residual = (rows.measured - at.simulated).cwiseProduct(rows.weight);
    if (step == kSteps) {
      double missed = 0.0;
      for (const double r : residual) missed += huber_square(r / rows.scale);
      return TriedChange{.change = {.law = law, .value = change}, .missed = missed};
    }
    const double more =
        huber_slope(residual, at.own.rightCols(1).cwiseProduct(rows.weight), rows.scale);
    if (!std::isfinite(more)) return std::nullopt;
    change = std::clamp(change + more, range.lower, range.upper);
  }
}

}  // namespace

std::optional<CommonChange> change_left_behind(const Problem& problem, const Hypothesis& fitted,
                                               std::size_t effect,
                                               const std::vector<Effect>& found) {
  const Candidate& own = fitted.effects[effect];
  if (own.cause == nullptr || own.cause->as_constant == nullptr || !may_not_stay(own, found)) {
    return std::nullopt;
  }
  // What the rows say of the noise is no part of a refit.
  RefittedRows rows{.measured = measured(problem.data),
                    .weight = make_noise_model(problem.data).weight};
  const Linearisation others = linearise(problem, without(fitted, effect), {});
  if (!others.runs) return std::nullopt;
  rows.scale = robust_deviation((rows.measured - others.simulated).cwiseProduct(rows.weight));
  if (!(rows.scale > 0.0)) return std::nullopt;
  const auto tried = [&](std::string_view law) {
    return in_its_place(problem, fitted, effect, rows, law);
  };
  std::optional<TriedChange> refit;
  bool is_refit = false;
  for (const std::string_view law : laws_of_refits(problem.data.kind)) {
    is_refit = is_refit || law == own.form.law;
    const auto change = tried(law);
    if (change && (!refit || change->missed < refit->missed)) refit = change;
  }
  const auto of_effect = is_refit ? std::nullopt : tried(own.form.law);
  if (of_effect && (!refit || is_much_worse(refit->missed, of_effect->missed))) {
    return of_effect->change;
  }
  return refit ? std::optional(refit->change) : std::nullopt;
}

}  // namespace gear3k::calibrate
