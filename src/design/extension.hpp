#pragma once
// What measurements added to the simulation of a gearbox: the physical part of an extended model.

#include <array>

#include "backlash/lost_motion_extension.hpp"
#include "design/design.hpp"
#include "design/operating_point.hpp"
#include "efficiency/friction_extension.hpp"

namespace gear3k::design {

/// Differences from what a design states; by default none.
template <class T>
struct Extension {
  efficiency::FrictionExtension<T> friction;
  std::array<ShaftDrag<T>, kShaftCount> drag{};  ///< added, by ShaftId
  T drag_temperature_1_K{};                      ///< β of all drags, see ShaftLosses
  double drag_reference_temperature_K = 293.15;
  /// Added to planet_bearing_coefficient times planet_bearing_radius_m.
  T planet_bearing_arm_m{};
  T output_bearing_share{};                 ///< added, see ShaftLosses
  GrowingShare<T> output_bearing_growth{};  ///< added
  backlash::LostMotionExtension<T> lost_motion;
};

/// A design with an extension's differences.
Design extended(Design design, const Extension<double>& extension);

}  // namespace gear3k::design
