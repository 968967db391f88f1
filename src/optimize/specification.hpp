#pragma once
// What a user asks for (SPEC.toml), in SI.

#include <array>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/thickness_allowance.hpp"
#include "design/design.hpp"
#include "design/extension.hpp"
#include "optimize/cycle_energy.hpp"
#include "optimize/felt_limits.hpp"
#include "optimize/objective.hpp"

namespace gear3k::optimize {

enum class Refine { kSlsqp, kIpopt, kBoth };
inline constexpr std::array<std::string_view, 3> kRefineNames{"slsqp", "ipopt", "both"};

/// Both ends belong to the range.
struct IntegerRange {
  int min = 0, max = 0;
};
struct NumberRange {
  double min = 0.0, max = 0.0;
};

/// Module of a stage: a continuous range, or a list of which one is chosen.
struct ModuleChoice {
  std::optional<NumberRange> range_m;
  std::vector<double> series_m;
};

/// Which tooth sets are looked at.
struct ToothRanges {
  IntegerRange S, P1, P2;
  int R1_max = 0, R2_max = 0;
  int max_coaxial_offset = 4;       ///< |zR1 − (zS + 2 zP1)| ≤
  int min_internal_difference = 8;  ///< zR − zP ≥, both internal meshes
};

struct RatioTarget {
  double target = 0.0;     ///< signed: negative = the output turns against the input
  double tolerance = 0.0;  ///< |ratio/target − 1| ≤
};

/// Sizes from which the gears' masses follow.
struct GearBodySizes {
  std::optional<double> density_kgm3;                 ///< of all gears
  design::GearDensities gear_density_kgm3{};          ///< of one gear, where that of all is empty
  std::array<std::optional<double>, 2> face_width_m;  ///< by stage
  double ring_rim_m = 0.0;                            ///< of both rings outside their root circles
  std::array<double, train::kGearCount> bore_radius_m{};  ///< of S, P1 and P2
};

/// Variables that are fixed unless a range is stated.
struct FreeVariables {
  std::optional<NumberRange> tip_shortening;      ///< of every gear, in modules
  bool addendum_stated = false;                   ///< it was stated as a range of the addendum
  std::optional<NumberRange> pressure_angle_rad;  ///< instead of Specification's
  /// By stage; GearBodySizes has the least.
  std::array<std::optional<NumberRange>, 2> face_width_m;
};

struct Solver {
  Refine refine = Refine::kSlsqp;
  int starts = 4;
  unsigned long long seed = 1;
  /// With a step of shifts: relaxations after which the search of one grid takes its best point.
  int grid_relaxations = 20'000;
};

/// What the limits hold for.
enum class Hold {
  kNominal,    ///< the drawn gearbox
  kWorstCase,  ///< every gearbox within its tolerances
  kYield       ///< a share of the gearboxes
};
inline constexpr std::array<std::string_view, 3> kHoldNames{"nominal", "worst_case", "yield"};
struct Robust {
  Hold hold = Hold::kNominal;
  double yield = 0.99;    ///< share that assembles and keeps the limits of lost motion
  bool cheapest = false;  ///< tolerances may be scaled, for the least cost at that yield
  /// By backlash::ToleranceKind: cost of one stated tolerance as stated; cost ∝ 1/tolerance.
  std::array<double, backlash::kToleranceKindNames.size()> cost{1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
};

/// Steps of what is made, for a design that is rounded to them.
struct RoundSteps {
  bool stated = false;           ///< a file states one of them
  double profile_shift = 0.01;   ///< modules
  double tip_shortening = 0.01;  ///< where it is free; modules
  double center_distance_m = 5e-6;
  double module_m = 1e-5;      ///< where it is in a range
  double allowance_m = 1e-6;   ///< of the machining allowance as a length
  double face_width_m = 1e-4;  ///< where it is in a range
  double pressure_angle_rad = 0.1 * std::numbers::pi / 180.0;  ///< where it is free
};

struct Specification {
  std::string name;
  std::vector<std::string> notes{};  ///< what its file states and nothing of the task reads
  std::vector<int> planets{3};
  double pressure_angle_rad = 0.0;
  /// Not empty; the first decides, several ask for their Pareto front.
  std::vector<Objective> objectives{Objective::kBackwardEfficiency};
  int pareto_points = 30;  ///< designs of the front that are sought
  /// What else designs have to reach; those on lost motion and diameter are in `limits`, too.
  std::vector<ObjectiveLimit> objective_limits;
  RatioTarget ratio;
  ToothRanges teeth;
  std::array<ModuleChoice, 2> module;
  NumberRange profile_shift{.min = 0.0, .max = 1.0};
  std::optional<NumberRange> ring_shift;  ///< of R1 and R2; empty: as all gears
  std::optional<double> shift_step;       ///< shifts are multiples of it; empty: any
  FreeVariables free;
  geometry::BasicRack<double> rack;
  std::array<double, train::kGearCount> tip_shortening{};
  std::array<bool, train::kGearCount> khk_tip{};  ///< S and P1
  std::array<geometry::PinionCutter, train::kGearCount> cutter{};
  /// Rising numbers of teeth of which `cutter` takes one; where it has less than two, its own.
  std::array<std::vector<int>, train::kGearCount> cutter_teeth{};
  train::AxialLayout axial;
  GearBodySizes bodies;
  /// In modules; of gears with a thickness allowance that of the least module.
  std::array<double, train::kGearCount> machining_allowance{};
  /// A_sn by gear: the thinning of a gear that has one is a length, and q follows the module.
  design::ThicknessAllowances thickness_allowance_m{};
  design::Limits limits = design::default_limits();
  /// Its extension acts in the refinement with what does not depend on where the gearbox runs.
  design::Friction friction;
  /// Where a calibrated model judges the refined sets, and the speed of `rating`.
  std::optional<design::OperatingPoint<double>> operating_point;
  /// Of a calibrated model: with an operating point, its efficiencies there decide between sets.
  std::optional<design::Extension<double>> model;
  /// Of the built gearboxes; required by `robust` unless it holds at nominal.
  std::optional<backlash::Tolerances> tolerances;
  design::Sampling sampling;
  std::optional<train::ThermalRange> thermal;  ///< where it is to work
  /// What it is to carry; face widths and the rings' rim as in `bodies`, the speed of
  /// `operating_point`.
  std::optional<strength::RatingTask> rating;
  /// Of the objective cycle_energy: motors, load and cycles; null without.
  std::shared_ptr<const CycleEnergy> cycle_energy;
  /// Limits of what is felt at the output through one stated motor.
  std::optional<FeltTask> felt;
  Robust robust;
  RoundSteps round;
  Solver solver;
};

/// The objective that decides.
inline Objective first_objective(const Specification& spec) { return spec.objectives.front(); }

/// Whether both stages have one module.
inline bool has_same_module(const Specification& spec) {
  return spec.limits[design::CheckId::kSameModule].has_value();
}

/// What the specification states of a train's bodies; must not outlive it.
/// @param face_width_m  by stage; 0 where it is not stated
template <class T>
design::TrainBodies<T> bodies_of(const Specification& spec, const std::array<T, 2>& face_width_m) {
  return {.bore_radius_m = spec.bodies.bore_radius_m,
          .ring_outer_radius_m = {},
          .ring_rim_m = spec.bodies.ring_rim_m,
          .face_width_m = face_width_m,
          .allowed_teeth = &spec.limits.allowed_teeth};
}

/// The least face widths [m]; 0 where they are not stated.
std::array<double, 2> least_face_widths_m(const Specification& spec);

/// Greatest root diameter that the limits leave the rings [m]; empty: any.
std::optional<double> most_ring_root_diameter_m(const Specification& spec);

/// Profile shifts that a gear may have.
const NumberRange& shift_limits(const Specification& spec, int gear);

/// The least module that a choice offers [m].
double least_module(const ModuleChoice& choice);

/// Whether a thinning that is stated as a length is of modules or a pressure angle to be chosen, so
/// that its q is.
bool thinning_varies(const Specification& spec);

/// q of a gear at this module and pressure angle.
template <class T>
T machining_allowance(const Specification& spec, std::size_t gear, const T& pressure_angle_rad,
                      const T& module_m) {
  const auto& stated = spec.thickness_allowance_m[gear];
  return stated ? backlash::machining_allowance_of(*stated, pressure_angle_rad, module_m)
                : constant<T>(spec.machining_allowance[gear]);
}

/// The cutters with these teeth in R1 and R2; 0: as stated.
std::array<geometry::PinionCutter, train::kGearCount> cutters_of(const Specification& spec,
                                                                 const std::array<int, 2>& teeth);

/// Length that makes lengths of this task of order 1: the least of stage 1's modules [m], so that
/// what is feasible here is feasible to the analysis of the design with its own module.
double length_scale_m(const Specification& spec);

}  // namespace gear3k::optimize
