#pragma once
// Keys of a ring's pinion cutter; the same in DESIGN, PAIR and SPEC.

#include <string>
#include <vector>

#include "geometry/gear.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// Keys within the cutter's table.
std::vector<Key<geometry::PinionCutter>> cutter_keys();

/// A ring's cutter needs teeth, and fewer than the ring's least tooth number.
/// @param path  of the cutter's table
void check_cutter(const std::string& path, const geometry::PinionCutter& cutter, int ring_teeth,
                  FileReading& reading);

}  // namespace gear3k::io
