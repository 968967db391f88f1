#pragma once
// The built gearboxes of a design at the ends of its range of temperature.

#include <optional>
#include <vector>

#include "backlash/monte_carlo.hpp"
#include "design/design.hpp"
#include "train/thermal_growth.hpp"

namespace gear3k::design {

/// A series at an end of the range.
struct ThermalSeries {
  train::ThermalState state;
  /// Lost motion by the mean play of each mesh; its limit is that of thermal_lost_motion.
  backlash::MonteCarloResult result;
  /// Of all gearboxes, those that jam in some position: by the least play of each mesh.
  backlash::Proportion jammed;
};

/// Plays of built gearboxes in a state: those of the drawing's temperature, with every mesh wider
/// by
///
///   Δj_k = j_k(state) − j_k(as drawn),
///
/// the mean play of gears of different base pitches, or the least one in any position
/// (backlash::UnequalMesh).  Source: own derivation, docs/theory §64.
/// Truncation: what deviations do is that of the drawing, to the growth of angles and sizes (a
/// carrier that is 0.2 % longer at α_w = 22 deg moves the effect of the centre distance by 1.2 %).
/// @param least  by the least play
/// @returns empty where a mesh has no working angle
std::optional<backlash::ClearanceModel> thermal_clearance(const Design& design,
                                                          const backlash::ClearanceModel& model,
                                                          const train::ThermalState& state,
                                                          bool least);

/// At each end of the design's range that leaves every mesh a working angle; empty without a range.
/// @param options  its limit is not read
std::vector<ThermalSeries> thermal_series(const Design& design,
                                          const backlash::ClearanceModel& model,
                                          backlash::MonteCarloOptions options);

}  // namespace gear3k::design
