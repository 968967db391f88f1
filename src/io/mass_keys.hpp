#pragma once

#include <array>
#include <optional>

#include "design/design.hpp"

namespace gear3k::io {

/// A key of [inertia] that states a body.
struct Body {
  const char* name;
  std::optional<double> design::Masses::*member;
  const char* unit;
  const char* help;
};
inline constexpr std::array<Body, 6> kBodies{
    {{"S_kgm2", &design::Masses::sun_kgm2, "kg m2", "inertia of the sun about its axis"},
     {"P1_kgm2", &design::Masses::planet1_kgm2, "kg m2", "inertia of one planet's step P1"},
     {"P2_kgm2", &design::Masses::planet2_kgm2, "kg m2", "inertia of one planet's step P2"},
     {"planet_mass_kg", &design::Masses::planet_mass_kg, "kg", "mass of one planet, both steps"},
     {"carrier_kgm2", &design::Masses::carrier_kgm2, "kg m2",
      "inertia of the carrier without planets about the main axis"},
     {"R2_kgm2", &design::Masses::ring2_kgm2, "kg m2", "inertia of ring R2 with its output"}}};

}  // namespace gear3k::io
