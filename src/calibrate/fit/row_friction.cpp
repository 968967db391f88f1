#include "calibrate/fit/row_friction.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "calibrate/causes/friction_change.hpp"
#include "calibrate/fit/row_drag.hpp"
#include "calibrate/fit/row_gain.hpp"

namespace gear3k::calibrate {

namespace {

bool acts_on_friction(const Candidate& c) {
  const bool of_flanks =
      c.cause->remedy == Remedy::kFrictionValue || c.cause->remedy == Remedy::kFlanks;
  return changes_row_friction(c) || (of_flanks && c.form.law != kOnDrag);
}

/// The states at which the flanks are looked at.
std::vector<std::size_t> looked_at(const std::vector<Condition>& states) {
  constexpr std::size_t kMost = 500;
  const std::size_t step = (states.size() + kMost - 1) / kMost;
  std::set<std::size_t> result;
  for (std::size_t k = 0; k < states.size(); k += step) result.insert(k);
  for (double Condition::*member :
       {&Condition::temperature_K, &Condition::sun_speed_rad_s, &Condition::output_torque_Nm}) {
    const auto at = [&](const Condition& c) { return c.*member; };
    const auto [low, high] = std::ranges::minmax_element(states, {}, at);
    if (low == states.end()) continue;
    result.insert(static_cast<std::size_t>(low - states.begin()));
    result.insert(static_cast<std::size_t>(high - states.begin()));
  }
  return {result.begin(), result.end()};
}

struct RowFriction {
  FrictionRange range{.least = HUGE_VAL, .greatest = -HUGE_VAL};

  void add(const FrictionRange& state, double level) {
    range.least = std::min(range.least, state.least * level);
    range.greatest = std::max(range.greatest, state.greatest * level);
  }
};

}  // namespace

std::optional<FrictionRange> row_friction(const Problem& problem, const Hypothesis& h) {
  const Simulation& simulation = problem.simulation;
  const Kind kind = simulation.kind();
  if (kind != Kind::kTransmission && kind != Kind::kPairLoss) return std::nullopt;
  const std::vector<Scalar> values = constants_of(h.value);
  const auto modified = [&](const Condition& condition) {
    Modification m = simulation.unmodified(condition);
    apply(h, values, condition, kind, m);
    return m;
  };
  const RowStates& states = problem.states;
  const std::vector<std::size_t> places = looked_at(states.states);
  std::vector<Condition> conditions;
  conditions.reserve(places.size());
  for (const std::size_t k : places) conditions.push_back(states.states[k]);
  if (conditions.empty()) return std::nullopt;
  const auto flanks = simulation.flank_friction(conditions, modified(conditions.front()));
  RowFriction found;
  if (std::ranges::none_of(h.effects, changes_row_friction)) {
    for (const auto& state : flanks) {
      if (state) found.add(*state, 1.0);
    }
  } else {
    std::vector<const FrictionRange*> of_state(states.states.size(), nullptr);
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (flanks[k]) of_state[places[k]] = &*flanks[k];
    }
    for (std::size_t i = 0; i < problem.data.rows.size(); ++i) {
      const FrictionRange* state = of_state[states.state_of_row[i]];
      if (state == nullptr) continue;
      found.add(*state, modified(problem.data.rows[i].condition).friction_level.a);
    }
  }
  if (!(found.range.least <= found.range.greatest)) return std::nullopt;
  return found.range;
}

void add_implausible_friction(const Problem& problem, const FinalFit& fit, std::size_t effect,
                              std::vector<ParameterResult>& parameters) {
  if (!acts_on_friction(fit.hypothesis.effects[effect])) return;
  // Told already, side by side.
  const auto side = std::ranges::find(parameters, "friction_in_approach", &ParameterResult::name);
  if (side != parameters.end()) return;
  const auto range = row_friction(problem, fit.hypothesis);
  if (!range || (range->least >= 0.0 && range->greatest <= kMostFriction)) return;
  const auto given = row_friction(problem, {});
  const FrictionRange plausible{
      .least = 0.0, .greatest = given ? std::max(kMostFriction, given->greatest) : kMostFriction};
  // By differences: the friction of a row at which it is least or greatest.
  const auto add = [&](const char* name, double FrictionRange::*end) {
    const double value = *range.*end;
    if (value >= plausible.least && value <= plausible.greatest) return;
    const auto count = static_cast<Eigen::Index>(fit.hypothesis.value.size());
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      Hypothesis moved = fit.hypothesis;
      double& x = moved.value[static_cast<std::size_t>(k)];
      const double step = 1e-4 * std::max(std::abs(x), 1e-2);
      x += step;
      const auto there = row_friction(problem, moved);
      if (there) slope[k] = (*there.*end - value) / step;
    }
    const double half =
        interval_factor(fit) * std::sqrt(std::max(0.0, slope.dot(fit.covariance * slope)));
    parameters.push_back({.name = name,
                          .unit = "",
                          .value = value,
                          .low = value - half,
                          .high = value + half,
                          .plausible = false,
                          .plausible_low = plausible.least,
                          .plausible_high = plausible.greatest,
                          .derived = true});
  };
  add("least_friction", &FrictionRange::least);
  add("greatest_friction", &FrictionRange::greatest);
}

std::vector<ParameterResult> parameter_results(const Problem& problem, const FinalFit& fit,
                                               std::size_t effect) {
  std::vector<ParameterResult> result = parameter_results(problem.simulation, fit, effect);
  add_implausible_friction(problem, fit, effect, result);
  add_implausible_drag(problem, fit, effect, result);
  add_implausible_gain(problem, fit, effect, result);
  judge_output_zero(problem, fit, effect, result);
  return result;
}

}  // namespace gear3k::calibrate
