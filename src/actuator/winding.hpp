#pragma once
// Temperature of a motor's winding and housing under a repeated load.

#include <optional>

#include "actuator/actuator.hpp"

namespace gear3k::actuator {

/// What heats a motor, by means over a cycle.
struct HeatSources {
  double mean_square_current_A2 = 0.0;
  double friction_W = 0.0;            ///< of the motor, into the housing
  std::optional<double> ambient_K{};  ///< in place of the motor's
};

struct WindingState {
  bool runaway = false;  ///< heat grows faster with temperature than it leaves: no steady state
  /// Empty at a runaway; the housing's also where one resistance leads from winding to ambient.
  std::optional<double> winding_K, housing_K;
  /// Of winding and housing, time constant over resistance; empty where one is not stated.
  std::optional<double> winding_J_K, housing_J_K;
};

/// Steady state of the two nodes winding and housing, whose copper loss grows with temperature.
///
///   ΔT = ((R1 + R2) q (1 + α (T_amb − 25 °C)) + R2 P_h)/(1 − α (R1 + R2) q),   q = R25 ⟨I²⟩
///
/// No steady state where the denominator is not positive.  One resistance R from the winding to the
/// surroundings is passed by all heat of the motor: R in place of R1 + R2 and of R2.
/// Source: own derivation from the heat balance of both nodes, docs/theory §61.
/// Valid: cycles much shorter than the winding's time constant.
/// @returns empty without heat paths from the winding to the surroundings
std::optional<WindingState> winding_state(const Motor& motor, const HeatSources& heat);

}  // namespace gear3k::actuator
