#pragma once

#include <array>

#include "tests/rig/rig_train.hpp"

namespace gear3k::rig {

/// Angle that the output turns through, sun locked and bodies rigid, when every mesh goes from one
/// flank to the other: the sum over the meshes of |d output / d clearance| times the backlash.
///
/// Source: own derivation; the three rolling conditions are solved as a linear system.
/// @param center_distance_m of each mesh (S-P1, P1-R1, P2-R2)
double lost_motion_rad(const Train& train, const std::array<double, 3>& center_distance_m);

}  // namespace gear3k::rig
