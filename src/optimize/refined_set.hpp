#pragma once
// What became of one tooth set.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "optimize/specification.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Largest KKT residual that counts as a local optimum.
inline constexpr double kStationary = 1e-4;

/// optimal: a feasible point with KKT residual ≤ kStationary.  no_feasible_found: the solver found
/// none, which proves nothing.  infeasible: proven by SetBounds to have none.  failed: the model
/// was defined at no end of the solver.  bounded: not refined, as its bound is below the best that
/// was found; or, on a grid, its local optimum with free shifts, or what the grid has, is no better
/// than that, which proves nothing.  not_stationary: a feasible point, the best that was found, at
/// which the solver left a greater KKT residual: a design, but no optimum.
enum class Status : std::uint8_t {
  kOptimal,
  kNoFeasibleFound,
  kInfeasible,
  kFailed,
  kBounded,
  kNotStationary
};
inline constexpr std::size_t kStatusCount = 6;
/// Names in result files, in the order of the enum.
inline constexpr std::array<std::string_view, kStatusCount> kStatusNames{
    "optimal", "no_feasible_found", "infeasible", "failed", "bounded", "not_stationary"};

/// Whether sets of a status have a design.
inline constexpr bool has_design(Status status) {
  return status == Status::kOptimal || status == Status::kNotStationary;
}

/// By how much one constraint is missed.
struct Miss {
  std::string_view name;   ///< a check, or stage1_module / stage2_module
  double violation = 0.0;  ///< scaled to order 1; 0 when it is not known
  double amount = 0.0;     ///< the same in `unit`, as files and tables print it
  std::string_view unit;
};

/// The variables of a refined train; the rest is the specification's.
struct RefinedTrain {
  std::array<double, train::kGearCount> profile_shift{};
  std::array<double, 2> module_m{};
  double center_distance_m = 0.0;
  std::array<double, train::kGearCount> tip_shortening{};
  double pressure_angle_rad = 0.0;
  std::array<double, 2> face_width_m{};  ///< by stage; 0 where it is not stated
  std::array<int, 2> cutter_teeth{};     ///< of R1 and R2, where they are chosen; else 0
};

struct RefinedSet {
  std::uint32_t index = 0;  ///< among the candidates of the search
  Candidate candidate;
  Status status = Status::kFailed;
  /// The search of a grid of shifts was cut short (Solver::grid_relaxations): it may have a better
  /// point, or one at all.
  bool grid_cut = false;
  /// Problems that were refined from their starts, one for each choice of modules that the bounds
  /// left, of cutters and of branches; and boxes of grids that were relaxed from one start.
  std::uint32_t refinements = 0, relaxations = 0;
  bool blocked_together = false;  ///< none of blocked_by was found to suffice alone
  /// What blocks the set; empty with a design, when failed or grid_cut.  infeasible: the constraint
  /// that no point of the box can meet.  no_feasible_found: the constraints any one of which may
  /// give way alone (a point was found that meets all others), least (scaled) first; or, when none
  /// was found to suffice, those that the least violating point misses most, together.
  std::vector<Miss> blocked_by;
  // The rest only where it has_design().
  RefinedTrain train;
  double eta_b = 0.0, eta_f = 0.0;
  /// With all losses of the calibrated model at the operating point; empty without them, or where
  /// the gearbox does not run.
  std::optional<double> eta_b_model, eta_f_model;
  double lost_motion_rad = 0.0;  ///< by the specification's model
  std::array<double, train::kMeshCount> contact_ratio{};
  double ring_root_diameter_m = 0.0;         ///< the larger ring's
  double mass_kg = 0.0, inertia_kgm2 = 0.0;  ///< see objective_value(); 0 when not known
  /// Under the load of the specification, in the worse drive direction and driven forward; empty
  /// without a load, and the capacity where no limit stress is stated.
  std::optional<double> torque_capacity_Nm, torsional_stiffness_Nm_rad;
  double kkt_residual = 0.0;  ///< NaN where gradients are not defined
  /// With the inertia of its gears, by its power flow, and the motor; empty without inertia, and
  /// infinite where no motor keeps its limits.
  std::optional<double> cycle_energy_J;
  std::size_t motor = 0;
};

/// The first constraint that blocks a set; "" when there is none.
inline std::string_view reason_of(const RefinedSet& set) {
  return set.blocked_by.empty() ? std::string_view() : set.blocked_by.front().name;
}

/// What sets are ordered by, less first: merit_of() in steps of its resolution, then the index.
std::pair<double, std::uint32_t> merit_order(const Specification& spec, const RefinedSet& set);

/// The train of a refined set.
train::TrainParameters<double> train_of(const Specification& spec, const RefinedSet& set);

/// The design of a refined set, with the specification's limits and friction; without its model.
design::Design design_of(const Specification& spec, const RefinedSet& set);

/// The energy of its duty cycles with the best motor, of a specification with cycle_energy; with
/// the inertia of its gears where that is known.
EnergyAt energy_of(const Specification& spec, const RefinedSet& set);

/// Value of an objective, SI.
double objective_of(const Specification& spec, const RefinedSet& set, Objective objective);

/// Whether a calibrated model decides between the refined sets.
bool judged_by_model(const Specification& spec);

/// What refined sets are compared by, more is better: the first objective with its sense, or that
/// efficiency with the model; minus infinity where the gearbox does not run with it.
double merit_of(const Specification& spec, const RefinedSet& set);

}  // namespace gear3k::optimize
