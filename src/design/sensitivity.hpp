#pragma once
// How far efficiency, lost motion and the tightest checks of a gearbox move with each of its
// inputs.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "design/design.hpp"
#include "train/thermal_growth.hpp"

namespace gear3k::design {

/// A continuous input of a design.
enum class InputKind {
  kPressureAngle,
  kCenterDistance,
  kAddendum,
  kDedendum,
  kRootRadius,
  kModule,        ///< by stage
  kFaceWidth,     ///< by stage
  kProfileShift,  ///< by gear, as the next two
  kMachiningAllowance,
  kTipShortening,
  kFrictionCoefficient,
  kApproachFactor,
  kRecessFactor,
  kLoadExponent,
  kReferenceForce,
  kStaticCoefficient,
  kStribeckSpeed,
  kStribeckExponent,
  kViscousFriction,
  kRoughness,
  kLubricantFactor,
  kLubricantTemperature,  ///< of the first or the second viscosity
  kLubricantViscosity,    ///< the first or the second
  kLubricantDensity,
  kConstantDrag,  ///< by ShaftId, as the next two
  kViscousDrag,
  kQuadraticDrag,
  kBearingCoefficient,
  kBearingRadius,
  kSunSpeed,
  kOutputTorque,
  kTemperature
};
struct InputId {
  InputKind kind{};
  std::size_t index = 0;  ///< of the stage, gear, point or shaft

  bool operator==(const InputId&) const = default;
};

/// What of a train is derived by its inputs, besides the margins of checks.
enum QuantityId {
  kEtaForward = 0,   ///< η_f, as EfficiencyResult::forward
  kEtaBackward,      ///< η_b, as EfficiencyResult::backward
  kTotalEtaForward,  ///< with drag, bearings and load at the operating point, as operate()
  kTotalEtaBackward,
  kLostMotion  ///< at the output, kinematic [rad]
};
inline constexpr std::size_t kQuantityCount = 5;

/// A check whose margin is derived.
struct TightCheck {
  const CheckRecord* record = nullptr;
  std::string mesh, gear;  ///< "" where the check has none
  double margin = 0.0;     ///< SI
};

/// Derivatives by one input of the plays in a state of the range of temperature.
struct ThermalSlopes {
  std::optional<double> lost_motion;  ///< kinematic, at the output; SI per unit, as the next
  std::array<std::optional<double>, train::kMeshCount> normal_backlash{}, least_backlash{};
};

/// Derivatives by one input; empty where a quantity or its derivative is not defined.
struct Sensitivity {
  InputId input;
  units::Unit unit{};  ///< of the next two
  double value = 0.0, step = 0.0;
  std::array<std::optional<double>, kQuantityCount> slope{};  ///< SI per unit
  std::vector<std::optional<double>> margin_slope;  ///< by Sensitivities::checks, the same
  std::vector<ThermalSlopes> thermal;               ///< by Sensitivities::ends

  /// Change of a quantity per step: slope times step, in SI.
  [[nodiscard]] std::optional<double> effect(QuantityId quantity) const;
  [[nodiscard]] std::optional<double> margin_effect(std::size_t check) const;
};

struct Sensitivities {
  std::array<std::optional<double>, kQuantityCount> value{};  ///< SI
  std::vector<Sensitivity> inputs;  ///< by falling effect on η_b, then η_f, then lost motion
  std::vector<TightCheck> checks;   ///< the tightest first
  /// Of the range of temperature, where there is one.
  std::vector<train::ThermalState> ends;
  bool center_distance_given = false;
  bool operating_point = false;  ///< without one, no total efficiencies
};

/// Exact first derivatives, by automatic differentiation, of what evaluate() and operate() return
/// by every continuous input of the design that acts.
///
/// Without a stated centre distance the train sits at the zero-backlash distance of mesh P1-R1.
/// Derivatives are then total: that distance moves with the other inputs, as it would in a file
/// that is changed.  The row of the centre distance is the derivative at that distance as if the
/// file stated it, all others held.
///
/// The steps are what a designer would change and small enough for first order:
///
///   modules (shift, allowance, shortening, rack)  0.01      centre distance  0.01 mm
///   module                                        0.001 mm  pressure angle   0.1 deg
///   temperature                                   1 K       all others       1 % of the value
///                                                           (0.01 units where the value is 0)
///
/// A module's step is smaller, as tens of teeth multiply it.  Rings' shifts count as in the KHK
/// convention, machining_allowance as stated in modules, whatever the file said of them.  The rack
/// is one for all gears.
///
/// Plays at the ends of a range of temperature are derived by the same inputs: those of the
/// drawing, as thermal_play() has them grown.
///
/// The checks are the `tightest` with the least margin over scale, failed ones first, of those
/// that move with any input (assembly does not).
///
/// Does not cover: tooth numbers, cutters, limits, the axial layout, masses, the range of
/// temperature and what grows, and the points of a friction table; speed at rest and torque without
/// load, where friction laws have their corner. η_b is empty where the train cannot be back-driven.
/// Where a formula changes branch exactly at the design, a derivative is that of one side. Source:
/// docs/theory §3-§26 through their templates; property-tested against central differences of
/// evaluate().
/// @returns no inputs where evaluate() returns NotDefined
/// @throws std::invalid_argument as evaluate()
Sensitivities sensitivities(const Design& design, std::size_t tightest = 5);

}  // namespace gear3k::design
