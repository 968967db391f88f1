#pragma once
// Keys of face widths and of the table [inertia]: what is stated of masses and inertias, and the
// sizes of the carrier.

#include <vector>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

KeyRecord density_record();
/// @param stage  0 or 1
KeyRecord face_width_record(std::size_t stage);
/// Keys of [inertia].
std::vector<Key<design::Masses>> mass_keys();

/// What the keys say together.
/// @param masses  with the bores of the gears
void check_masses(const design::Masses& masses, FileReading& reading);

}  // namespace gear3k::io
