#pragma once
// The one place where geometry, backlash, efficiency and inertia of a design meet.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "design/design.hpp"
#include "design/mass_model.hpp"
#include "design/operation.hpp"
#include "design/planet_sharing.hpp"
#include "design/thermal_result.hpp"
#include "design/tolerance_limits.hpp"
#include "geometry/interference.hpp"
#include "geometry/sliding.hpp"
#include "geometry/tooth_measures.hpp"
#include "strength/train_rating.hpp"

namespace gear3k::design {

struct MeshResult {
  std::string name;
  double working_pressure_angle_rad;
  std::optional<double> zero_backlash_center_distance_m;  ///< of the full teeth (q = 0)
  double contact_ratio;
  double approach_contact_ratio, recess_contact_ratio;  ///< forward drive direction
  double normal_backlash_m;
  /// Coefficient of friction; NaN where the law has none (no operating point, or no operation
  /// there).
  double friction_forward, friction_backward;
  double efficiency_forward, efficiency_backward;
  bool loss_model_in_range;
  long long hunting_period_teeth;
  int common_factor;  ///< gcd of the tooth numbers; 1 = hunting tooth
  /// Of gear 1 and 2: diameter where the active flank ends; empty beyond the base circle (involute
  /// interference).
  std::array<std::optional<double>, 2> active_root_diameter_m;
  std::array<double, 2> root_clearance_m;  ///< between the tip of gear 1 or 2 and its mate's root
  std::array<geometry::TipSliding, 2> tip_sliding;  ///< at the tip of gear 1, 2
  /// Where in its pitch the mesh of each planet stands, in [0, 1): the phase of planet k less that
  /// of planet 0.  Empty for a pair.
  std::vector<double> planet_phase;
};

/// The cut tooth and what is measured on it.
struct ToothResult {
  geometry::RootTool tool;
  double form_diameter_m;
  bool undercut;
  double fillet_radius_m;   ///< of the tool's rounding, or of the arc
  bool full_round;          ///< one arc instead of two: the space has no room for both
  double form_thickness_m;  ///< chord of the tooth at its form circle
  std::optional<double> root_space_m;
  std::optional<geometry::SpanMeasure> span;
  std::optional<geometry::PinMeasure> pins;
  std::optional<double> stated_pin_m;              ///< diameter; empty: by geometry::pin_measure()
  std::optional<geometry::PinRange> fitting_pins;  ///< sought where the pins find no seat
  geometry::ChordalThickness chordal;
  geometry::Infeed infeed;
  int cutter_teeth;  ///< 0 without cutter
  double cutter_tip_diameter_m, cutter_center_distance_m;
};

/// Why there is no measure over pins, with those that would fit; "" where there is one.
std::string why_no_pins(const ToothResult& tooth);

struct GearResult {
  std::string name;
  int teeth;
  double profile_shift;
  double tip_shortening;
  double pitch_diameter_m, base_diameter_m, tip_diameter_m, root_diameter_m, tip_thickness_m;
  ToothResult tooth;
};

struct CheckResult {
  const CheckRecord* record;
  std::string mesh, gear;       ///< "" where the check has none
  double value, limit, margin;  ///< SI
  bool ok;
};

struct InertiaResult {
  double lossless_kgm2;
  std::optional<double> backward_kgm2, forward_kgm2;  ///< empty where the train locks
  std::optional<double> paper_kgm2;                   ///< empty where a mesh efficiency is ≤ 0
};

struct LostMotionResult {
  double paper_rad, kinematic_rad, input_kinematic_rad;  ///< rigid bodies
  std::array<double, train::kMeshCount> kinematic_share_rad;
  /// With the calibrated model that changes it, at the operating point (its torque as ±T), without
  /// one at T = 0 and 20 °C; empty without such a model, or where a mesh has no working angle.
  std::optional<double> measured_rad;
};

struct EfficiencyResult {
  /// By the formulas, unclamped; empty where a mesh efficiency is not positive, as then no first-
  /// order loss describes the mesh, or where a mesh has no contact.
  std::optional<double> forward, backward;
  bool backdrivable;
  double backdriving_margin;
};

/// The gearbox at its operating point, with the losses of its shafts.
struct OperatingResult {
  OperatingPoint<double> point;
  OperationResult<double> forward, backward;
};

/// What a gearbox carries; empty parts where it cannot be known.
struct StrengthResult {
  std::optional<PlanetSharing> planet_sharing;      ///< where K_γ is that of the tolerances
  strength::TrainRating<double> forward, backward;  ///< at the stated torque
  /// Empty where no safety is judged.
  std::optional<strength::Capacity<double>> capacity_forward, capacity_backward;

  std::optional<strength::DrivenCapacity> least_capacity() const {
    return strength::least_capacity(capacity_forward, capacity_backward);
  }
};

struct Evaluation {
  std::string name;
  train::ToothSet teeth;
  int planets;
  double ratio, g1, g2;
  double center_distance_m;
  bool center_distance_given;
  std::array<double, 2> module_m;
  EfficiencyResult efficiency;               ///< of the meshes alone
  std::optional<OperatingResult> operation;  ///< where the design has an operating point
  std::vector<MeshResult> meshes;
  std::vector<GearResult> gears;
  LostMotionResult lost_motion;
  std::optional<InertiaResult> inertia;
  std::string inertia_missing;  ///< what input it lacks, when inertia is empty
  std::vector<PartMass> parts;
  std::optional<double> total_mass_kg;
  std::string total_mass_missing;  ///< what input it lacks, when the total is empty
  train::Assembly assembly;
  std::vector<CheckResult> checks;
  std::optional<ToleranceLimits> tolerance_limits;  ///< where the design has tolerances
  std::optional<StrengthResult> strength;           ///< where the design has a rating task
  std::optional<ThermalResult> thermal;             ///< where the design has a range
  std::vector<std::string> notes;
};

struct PairEvaluation {
  std::string name;
  double center_distance_m;
  bool center_distance_given;
  MeshResult mesh;
  std::vector<GearResult> gears;
  std::vector<CheckResult> checks;
  std::optional<ToleranceLimits> tolerance_limits;            ///< where the design has tolerances
  std::optional<strength::MeshRating<double>> strength;       ///< where the pair has a rating task
  std::optional<strength::Capacity<double>> torque_capacity;  ///< on gear 1, with `strength`
  std::vector<std::string> notes;
};

/// Why a design cannot be evaluated at all; a message that names the quantity and its bound.
struct NotDefined {
  std::string message;
};

/// Why the geometry of a design is not defined (no real working angle at its centre distance, or
/// no zero-backlash distance to take); empty when it is.
/// @throws std::invalid_argument for values outside the geometry functions' ranges
std::optional<NotDefined> why_undefined(const Design& design);
std::optional<NotDefined> why_undefined(const PairDesign& design);

/// What is given of a design's train, with the centre distance that evaluate() takes: the stated
/// one, else the zero-backlash distance of mesh P1-R1.  The design must be defined.
train::TrainParameters<double> resolved_parameters(const Design& design);

/// The gears of a pair at the centre distance that evaluate() takes.  The design must be defined.
std::array<geometry::GearGeometry<double>, 2> resolved_gears(const PairDesign& design);

/// A train with what a design loses; refers to both arguments.
LossyTrain<double> lossy_train(const Design& design, const train::TrainGeometry<double>& geometry);

/// Everything known about a gearbox.
/// Without a given centre distance, the zero-backlash distance of mesh P1-R1 is taken.
/// @throws std::invalid_argument for values outside the geometry functions' ranges
std::variant<Evaluation, NotDefined> evaluate(const Design& design);

/// Everything known about one pair (its zero-backlash distance is taken when none is given).
std::variant<PairEvaluation, NotDefined> evaluate(const PairDesign& design);

/// True when no check failed.
bool all_ok(const std::vector<CheckResult>& checks);

}  // namespace gear3k::design
