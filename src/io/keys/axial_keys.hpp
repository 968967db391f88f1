#pragma once
// Keys of the table [axial]: where bodies lie along the axis; the same in DESIGN and SPEC.

#include <vector>

#include "io/keys/key_registry.hpp"
#include "train/axial_layout.hpp"

namespace gear3k::io {

std::vector<Key<train::AxialLayout>> axial_keys();

/// What the keys say together.
void check_axial(const train::AxialLayout& layout, FileReading& reading);

}  // namespace gear3k::io
