#include "calibrate/verdict/possible_conditions.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "calibrate/fit/linearisation.hpp"
#include "calibrate/measurement/value_range.hpp"

namespace gear3k::calibrate {

MeasurementSet rows_at(const std::vector<Condition>& conditions, const MeasurementSet& data) {
  MeasurementSet possible;
  possible.kind = data.kind;
  possible.runs = data.runs;
  possible.rows.reserve(conditions.size());
  for (const Condition& c : conditions) possible.rows.push_back({.condition = c});
  return possible;
}

Hypothesis later(Hypothesis h) {
  h.left_behind = true;
  return h;
}

namespace {

using Limits = std::array<double, 2>;

/// Evenly over the limits; without any, over what the design is meant for and the data widened by a
/// quarter.
std::vector<double> levels(const std::optional<Limits>& limits, const ValueRange& data,
                           const design::GridAxis* meant, int count) {
  if (!data.known()) return {kUnknown};
  Limits range = limits.value_or(Limits{0.75 * data.low, 1.25 * data.high});
  if (!limits && meant != nullptr) {
    range = {std::min(range[0], meant->from), std::max(range[1], meant->to)};
  }
  if (!(range[1] > range[0])) return {range[0]};
  std::vector<double> result;
  result.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double level = range[0] + (range[1] - range[0]) * k / (count - 1);
    // Near the greatest number the product has none.
    result.push_back(std::min(level, range[1]));
  }
  return result;
}

bool about_sensor(const std::vector<Explanation>& explanations) {
  return std::ranges::any_of(explanations, [](const Explanation& e) {
    return std::ranges::any_of(e.fit.hypothesis.effects, [](const Candidate& c) {
      return c.cause->remedy == Remedy::kSensor;
    });
  });
}

bool about_angle(const std::vector<Explanation>& explanations) {
  return std::ranges::any_of(explanations, [](const Explanation& e) {
    return std::ranges::any_of(e.fit.hypothesis.effects,
                               [](const Candidate& c) { return c.form.order > 0.0; });
  });
}

/// Each condition at angles of one turn of the output, in golden sections: no order repeats itself
/// at all of them.
std::vector<Condition> at_angles(const std::vector<Condition>& conditions) {
  constexpr int kAngles = 12;
  std::vector<Condition> result;
  result.reserve(conditions.size() * kAngles);
  for (const Condition& c : conditions) {
    for (int k = 0; k < kAngles; ++k) {
      const double turn = k / std::numbers::phi;
      result.push_back(c);
      result.back().output_angle_rad = 2.0 * std::numbers::pi * (turn - std::floor(turn));
    }
  }
  return result;
}

/// Whether an explanation has the gearbox give more than it takes in (a sensor's error), or turn
/// the magnitude of a torque round (a sun that must be helped): such rows are not taken when they
/// are read.
bool is_beyond_physics(const Condition& c, double sun_torque_Nm, double ratio) {
  const double without_loss = c.output_torque_Nm / std::abs(ratio);
  return sun_torque_Nm < 0.0 ||
         (c.direction == design::Direction::kForward ? sun_torque_Nm < without_loss
                                                     : sun_torque_Nm > without_loss);
}

/// Conditions at which every explanation stays within physics, where there are any.
std::vector<Condition> believable(const Problem& problem,
                                  const std::vector<Explanation>& explanations,
                                  const std::vector<Condition>& conditions) {
  if (problem.simulation.kind() != Kind::kTransmission) return conditions;
  const MeasurementSet possible = rows_at(conditions, problem.data);
  const Problem imagined{.simulation = problem.simulation, .data = possible, .noise = {}};
  std::vector<bool> out(conditions.size(), false);
  for (const Explanation& e : explanations) {
    const Eigen::VectorXd torque = linearise(imagined, later(e.fit.hypothesis), {}).simulated;
    for (std::size_t k = 0; k < conditions.size(); ++k) {
      out[k] = out[k] || is_beyond_physics(conditions[k], torque[static_cast<Eigen::Index>(k)],
                                           problem.simulation.ratio());
    }
  }
  std::vector<Condition> result;
  for (std::size_t k = 0; k < conditions.size(); ++k) {
    if (!out[k]) result.push_back(conditions[k]);
  }
  return result.empty() ? conditions : result;
}

std::vector<Condition> every_condition(const Problem& problem,
                                       const std::vector<Explanation>& explanations,
                                       const DiagnoseOptions& options) {
  const MeasurementSet& data = problem.data;
  const ValueRange time = range_of(data, &Condition::time_s);
  const ValueRange temperature = range_of(data, &Condition::temperature_K);
  std::optional<Limits> temperatures = options.temperature_K;
  constexpr double kMargin_K = 10.0;
  if (!temperatures && temperature.known()) {
    temperatures = Limits{temperature.low - kMargin_K, temperature.high + kMargin_K};
  }
  Condition start;
  start.run = data.runs.empty() ? -1 : static_cast<int>(data.runs.size());
  start.time_s = time.high;
  start.cycles = range_of(data, &Condition::cycles).high;
  std::vector<Condition> result;
  const std::vector<double> warm = levels(temperatures, temperature, nullptr, 2);
  const auto with_temperature = [&](Condition c) {
    for (const double t : warm) {
      c.temperature_K = t;
      result.push_back(c);
    }
  };
  switch (problem.simulation.kind()) {
    case Kind::kTransmission: {
      const design::MapGrid* grid = problem.simulation.grid();
      for (const double speed :
           levels(options.sun_speed_rad_s, range_of(data, &Condition::sun_speed_rad_s),
                  grid == nullptr ? nullptr : &grid->sun_speed_rad_s, 3)) {
        for (const double load :
             levels(options.output_torque_Nm, range_of(data, &Condition::output_torque_Nm),
                    grid == nullptr ? nullptr : &grid->output_torque_Nm, 3)) {
          for (const auto direction : {design::Direction::kForward, design::Direction::kBackward}) {
            for (const int rotation : {1, -1}) {
              Condition c = start;
              c.sun_speed_rad_s = speed;
              c.output_torque_Nm = load;
              c.direction = direction;
              c.rotation = rotation;
              with_temperature(c);
            }
          }
        }
      }
      break;
    }
    case Kind::kLostMotion:
    case Kind::kTorqueAngle:
      for (const double torque :
           levels(options.test_torque_Nm, range_of(data, &Condition::test_torque_Nm), nullptr, 4)) {
        Condition c = start;
        c.test_torque_Nm = torque;
        with_temperature(c);
      }
      break;
    case Kind::kPairLoss: {
      std::set<int> teeth;
      for (const Observation& row : data.rows) {
        teeth.insert(row.condition.driving_teeth);
        teeth.insert(row.condition.driven_teeth);
      }
      for (const int driving : teeth) {
        for (const int driven : teeth) {
          Condition c = start;
          c.driving_teeth = driving;
          c.driven_teeth = driven;
          c.module_m = data.rows.front().condition.module_m;
          result.push_back(c);
        }
      }
      break;
    }
  }
  if (about_angle(explanations)) result = at_angles(result);
  if (about_sensor(explanations)) {
    const std::size_t count = result.size();
    result.reserve(2 * count);
    for (std::size_t k = 0; k < count; ++k) {
      result.push_back(result[k]);
      result.back().reference_sensor = true;
    }
  }
  return result;
}

}  // namespace

std::vector<Condition> possible_conditions(const Problem& problem,
                                           const std::vector<Explanation>& explanations,
                                           const DiagnoseOptions& options) {
  return believable(problem, explanations, every_condition(problem, explanations, options));
}

}  // namespace gear3k::calibrate
