#pragma once
// What a task may ask for: one objective, or several for a Pareto front.

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace gear3k::optimize {

enum class Objective {
  kBackwardEfficiency,
  kForwardEfficiency,
  kLostMotion,
  kOuterDiameter,
  kInertia,
  kMass,
  kRatioError,
  kTorqueCapacity,
  kTorqueDensity,
  kTorsionalStiffness,
  kCycleEnergy
};
inline constexpr std::size_t kObjectiveCount = 11;

/// One record per objective: names, sense and unit.
struct ObjectiveRecord {
  Objective id;
  std::string_view name;   ///< in files
  std::string_view title;  ///< in tables
  bool maximise;           ///< else minimised
  std::string_view unit;   ///< in files and tables; "" = dimensionless
  double per_unit;         ///< SI value of one unit
  /// Values of refined sets within about this [SI] are taken for equal where sets are compared:
  /// ten to a thousand times what another machine's exp() or sin() makes of them.
  double resolution;
  std::string_view help;
};
std::span<const ObjectiveRecord> objective_records();
const ObjectiveRecord& objective_record(Objective objective);

/// Objectives that follow from the load that is stated; nothing bounds them.
inline bool is_of_load(Objective objective) {
  return objective == Objective::kTorqueCapacity || objective == Objective::kTorqueDensity ||
         objective == Objective::kTorsionalStiffness;
}

/// Whether SetBounds bounds an objective; best_value() the others.
inline bool is_efficiency(Objective objective) {
  return objective == Objective::kBackwardEfficiency || objective == Objective::kForwardEfficiency;
}

/// Whether an objective follows from the efficiencies of a tooth set, and is bounded by theirs.
inline bool follows_efficiency(Objective objective) {
  return is_efficiency(objective) || objective == Objective::kCycleEnergy;
}

/// Sign with which more is better.
inline double sense_of(Objective objective) {
  return objective_record(objective).maximise ? 1.0 : -1.0;
}

/// A value [SI] in steps of the objective's resolution, with its sense turned so that less is
/// better.
double cost_in_steps(Objective objective, double value);

/// A value [SI] that an objective has to reach: at least it when maximised, else at most.
struct ObjectiveLimit {
  Objective objective = Objective::kBackwardEfficiency;
  double value = 0.0;
  bool by_check = false;  ///< a limit of the checks holds it, too: for bounds alone
};

}  // namespace gear3k::optimize
