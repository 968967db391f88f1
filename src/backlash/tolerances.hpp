#pragma once
// By how much the built gears and the built carrier may differ from the drawn ones.

#include <array>
#include <optional>
#include <string_view>

#include "train/tooth_set.hpp"

namespace gear3k::backlash {

/// Limits of a deviation from the drawn value: lower ≤ deviation ≤ upper.
struct DeviationLimits {
  double lower = 0.0, upper = 0.0;

  [[nodiscard]] double middle() const { return 0.5 * (lower + upper); }
  [[nodiscard]] double half_width() const { return 0.5 * (upper - lower); }
};

/// What a tolerance is about.
enum class ToleranceKind {
  kCenterDistance,
  kToothThickness,
  kPinPosition,
  kPlanetPhase,
  kRunout,
  kCumulativePitch,
  kSinglePitch
};
inline constexpr std::array<std::string_view, 7> kToleranceKindNames{
    "center_distance", "tooth_thickness",  "pin_position", "planet_phase",
    "runout",          "cumulative_pitch", "single_pitch"};

/// How built values scatter about the middle of their limits; none lies beyond them.
enum class Scatter {
  kNormal,  ///< normal, cut off at the limits, which lie Tolerances::sigma_level deviations out
  kUniform
};
inline constexpr std::array<std::string_view, 2> kScatterNames{"normal", "uniform"};

/// Of one gear.
struct GearTolerances {
  /// Arc on the reference circle, from that of profile shift and machining allowance:
  /// A_sne ≥ A_sni of ISO 21771.
  DeviationLimits tooth_thickness_m;
  DeviationLimits tip_diameter_m;
  /// Empty: the root follows the tooth thickness, as the tool is fed in for it.
  std::optional<DeviationLimits> root_diameter_m;
  /// F_r: twice the greatest eccentricity of the teeth.
  double runout_m = 0.0;
  /// F_p: total cumulative pitch deviation, as it is measured: with what the eccentricity adds.
  double cumulative_pitch_m = 0.0;
  /// f_pt: each pitch differs by up to ± this, each flank stands within ± half of it.
  double single_pitch_m = 0.0;
};

/// What of a mesh of two gears deviates.
struct PairTolerances {
  std::array<GearTolerances, 2> gears{};
  DeviationLimits center_distance_m;
};

/// Of a 3K gearbox.
struct Tolerances {
  std::array<GearTolerances, train::kGearCount> gears{};
  DeviationLimits center_distance_m;  ///< of the carrier, the same at all planets
  /// Diameter of the circle about the drawn place in which each planet's pin stands.
  double pin_position_m = 0.0;
  DeviationLimits planet_phase_rad;  ///< of P2 against P1, on each planet
  Scatter scatter = Scatter::kNormal;
  double sigma_level = 3.0;
};

}  // namespace gear3k::backlash
