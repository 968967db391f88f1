#pragma once
// Keys of the table [axial]: where bodies lie along the axis; the same in DESIGN and SPEC.

#include <array>
#include <optional>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "train/axial_layout.hpp"

namespace gear3k::io {

std::vector<Key<train::AxialLayout>> axial_keys();

/// What the keys say together.
void check_axial(const train::AxialLayout& layout, FileReading& reading);

/// A ring's material from its tip circle outwards.
struct RingBody {
  double tip_radius_m = 0.0, root_radius_m = 0.0;
  std::optional<double> outer_radius_m{};  ///< empty: its rim is not stated
};

/// Refuses rings that stand at the same place along the axis, unless the one is known to be inside
/// the other: outer radius of the inner one up to the tip radius of the outer one.
/// @param rings  R1 and R2; empty where their gears are not known, as in a SPEC
void check_rings_apart(const train::AxialLayout& layout,
                       const std::optional<std::array<RingBody, 2>>& rings, FileReading& reading);

}  // namespace gear3k::io
