#pragma once
// Keys of the basic rack and of friction: the same in DESIGN, PAIR and SPEC.

#include <vector>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

KeyRecord pressure_angle_record();
std::vector<Key<geometry::BasicRack<double>>> rack_keys();
/// Coefficient, loss model and its factors.
std::vector<Key<design::Friction>> friction_keys();

/// The factors act in one loss model only.
void check_friction(const design::Friction& friction, FileReading& reading);

/// The rack's tooth must not come to a point before its tip: hfP* < π/(4 tan α).
void check_rack(const geometry::BasicRack<double>& rack, double pressure_angle_rad,
                FileReading& reading);

}  // namespace gear3k::io
