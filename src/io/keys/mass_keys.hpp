#pragma once
// Keys of the table [inertia]: what is stated of masses and inertias, and the sizes of the carrier.

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"
#include "units/units.hpp"

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

/// A key of [inertia] that gives a size or density of the carrier.
struct CarrierSize {
  const char* name;
  std::optional<double> design::Masses::*member;
  double per_unit;  ///< of the member, SI, per unit of the key
  const char* unit;
  double max;
  bool may_be_zero;
  const char* default_text;
  const char* help;
};
inline constexpr std::array<CarrierSize, 6> kCarrierSizes{
    {{"carrier_outer_diameter_mm", &design::Masses::carrier_outer_radius_m, 0.5e-3, "mm", 1e4,
      false, "none",
      "outer diameter of the carrier's plates; with carrier_thickness_mm, instead of carrier_kgm2"},
     {"carrier_bore_mm", &design::Masses::carrier_bore_radius_m, 0.5e-3, "mm", 1e4, true,
      "with plates: 0", "bore diameter of the carrier's plates"},
     {"carrier_thickness_mm", &design::Masses::carrier_thickness_m, 1e-3, "mm", 1e4, false, "none",
      "thickness of the carrier's plates, all together; they count as full"},
     {"carrier_density_kg_m3", &design::Masses::carrier_density_kgm3, 1.0, "kg/m3", 3e4, false,
      "density_kg_m3", "density of the carrier's plates"},
     {"pin_diameter_mm", &design::Masses::planet_pin_radius_m, 0.5e-3, "mm", 1e3, false, "none",
      "diameter of a planet's pin, one per planet, fixed in the carrier, of density_kg_m3"},
     {"pin_length_mm", &design::Masses::planet_pin_length_m, 1e-3, "mm", 1e4, false, "none",
      "length of a planet's pin outside the carrier's plates"}}};

/// @param view  std::optional<double>&(Target&), the density [kg/m³]
template <class Target, class View>
void append_density_key(std::vector<Key<Target>>& keys, View view) {
  keys.push_back(
      {.record = {.path = "inertia.density_kg_m3",
                  .type = KeyType::kNumber,
                  .unit = "kg/m3",
                  .min = 0.0,
                  .max = 30000.0,
                  .min_excluded = true,
                  .default_text = "none",
                  .help = "density of the gears, for mass and inertia from geometry"},
       .assign = [view](Target& t, std::size_t, const TomlValue& v) { view(t) = v.number; }});
}

/// Key of one stage's face width.
/// @param stage  0 or 1  @param view  std::optional<double>&(Target&), the face width [m]
template <class Target, class View>
void append_face_width_key(std::vector<Key<Target>>& keys, std::size_t stage, View view) {
  keys.push_back({.record = {.path = fmt::format("stage{}.face_width_mm", stage + 1),
                             .type = KeyType::kNumber,
                             .unit = "mm",
                             .min = 0.0,
                             .max = 1000.0,
                             .min_excluded = true,
                             .default_text = "none",
                             .help = "face width; without it no mass or inertia from geometry"},
                  .assign = [view](Target& t, std::size_t, const TomlValue& v) {
                    view(t) = v.number * units::kMillimetre;
                  }});
}

/// @param view  design::Masses&(Target&)
template <class Target, class View>
void append_mass_keys(std::vector<Key<Target>>& keys, View view) {
  append_density_key<Target>(
      keys, [view](Target& t) -> std::optional<double>& { return view(t).density_kgm3; });
  for (const Body& body : kBodies) {
    keys.push_back(
        {.record = {.path = fmt::format("inertia.{}", body.name),
                    .type = KeyType::kNumber,
                    .unit = body.unit,
                    .min = 0.0,
                    .max = 1e6,
                    .default_text = "from geometry",
                    .help = body.help},
         .assign = [view, member = body.member](Target& t, std::size_t, const TomlValue& v) {
           view(t).*member = v.number;
         }});
  }
  for (const CarrierSize& size : kCarrierSizes) {
    keys.push_back({.record = {.path = fmt::format("inertia.{}", size.name),
                               .type = KeyType::kNumber,
                               .unit = size.unit,
                               .min = 0.0,
                               .max = size.max,
                               .min_excluded = !size.may_be_zero,
                               .default_text = size.default_text,
                               .help = size.help},
                    .assign = [view, member = size.member, per_unit = size.per_unit](
                                  Target& t, std::size_t, const TomlValue& v) {
                      view(t).*member = v.number * per_unit;
                    }});
  }
}

/// What the keys say together.
/// @param masses  with the bores of the gears
inline void check_masses(const design::Masses& masses, FileReading& reading) {
  const auto has = [&](const char* name) { return reading.has(fmt::format("inertia.{}", name)); };
  const auto error_at = [&](const char* name, const std::string& rest) {
    const std::string key = fmt::format("inertia.{}", name);
    reading.error_at(key, key + rest);
  };
  const auto require = [&](const char* name, const char* other, const char* allowed) {
    if (has(name) && !reading.stated(fmt::format("inertia.{}", other))) {
      error_at(name, fmt::format(" without inertia.{}: allowed: {}", other, allowed));
    }
  };
  for (const CarrierSize& size : kCarrierSizes) {
    if (has(size.name) && reading.stated("inertia.carrier_kgm2")) {
      error_at(size.name, fmt::format(" and inertia.carrier_kgm2, which holds plates and pins: "
                                      "allowed: one of them"));
    }
  }
  require("carrier_outer_diameter_mm", "carrier_thickness_mm", "both or neither");
  require("carrier_thickness_mm", "carrier_outer_diameter_mm", "both or neither");
  require("carrier_bore_mm", "carrier_outer_diameter_mm", "with it");
  require("carrier_density_kg_m3", "carrier_outer_diameter_mm", "with it");
  require("pin_diameter_mm", "pin_length_mm", "both or neither");
  require("pin_length_mm", "pin_diameter_mm", "both or neither");
  require("pin_diameter_mm", "density_kg_m3", "with it");
  if (!reading.stated("inertia.carrier_density_kg_m3")) {
    require("carrier_outer_diameter_mm", "density_kg_m3", "with it or with carrier_density_kg_m3");
  }
  if (has("carrier_bore_mm") && has("carrier_outer_diameter_mm") &&
      *masses.carrier_bore_radius_m >= *masses.carrier_outer_radius_m) {
    error_at(
        "carrier_bore_mm",
        fmt::format(" = {:.6g}: allowed: below inertia.carrier_outer_diameter_mm = {:.6g}",
                    2e3 * *masses.carrier_bore_radius_m, 2e3 * *masses.carrier_outer_radius_m));
  }
  for (const train::GearId step : {train::kP1, train::kP2}) {
    const auto index = static_cast<std::size_t>(step);
    const std::string bore = fmt::format("gears.{}.bore_mm", train::kGearNames[index]);
    if (has("pin_diameter_mm") && reading.has(bore) &&
        *masses.planet_pin_radius_m > masses.bore_radius_m[index]) {
      error_at("pin_diameter_mm", fmt::format(" = {:.6g}: allowed: at most {} = {:.6g}",
                                              2e3 * *masses.planet_pin_radius_m, bore,
                                              2e3 * masses.bore_radius_m[index]));
    }
  }
}

}  // namespace gear3k::io
