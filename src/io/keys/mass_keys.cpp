#include "io/keys/mass_keys.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>

namespace gear3k::io {

namespace {

using design::Masses, units::Unit;

/// A key of [inertia] that gives a size or density of the carrier.
struct CarrierSize {
  const char* name;
  std::optional<double> Masses::*member;
  Unit unit;
  double max;
  bool may_be_zero;
  const char* default_text;
  const char* help;
};
constexpr std::array<CarrierSize, 7> kCarrierSizes{
    {{"carrier_outer_diameter_mm", &Masses::carrier_outer_radius_m, Unit::kDiameterMillimetre, 1e4,
      false, "none",
      "outer diameter of the carrier's plates; with carrier_thickness_mm, instead of carrier_kgm2"},
     {"carrier_bore_mm", &Masses::carrier_bore_radius_m, Unit::kDiameterMillimetre, 1e4, true,
      "with plates: 0", "bore diameter of the carrier's plates"},
     {"carrier_thickness_mm", &Masses::carrier_thickness_m, Unit::kMillimetre, 1e4, false, "none",
      "thickness of the carrier's plates, all together; they count as full"},
     {"carrier_density_kg_m3", &Masses::carrier_density_kgm3, Unit::kKilogramPerCubicMetre, 3e4,
      false, "density_kg_m3", "density of the carrier's plates"},
     {"pin_diameter_mm", &Masses::planet_pin_radius_m, Unit::kDiameterMillimetre, 1e3, false,
      "none", "diameter of a planet's pin, one per planet, fixed in the carrier"},
     {"pin_length_mm", &Masses::planet_pin_length_m, Unit::kMillimetre, 1e4, false, "none",
      "length of a planet's pin outside the carrier's plates"},
     {"pin_density_kg_m3", &Masses::planet_pin_density_kgm3, Unit::kKilogramPerCubicMetre, 3e4,
      false, "density_kg_m3", "density of the planets' pins"}}};

double in_mm(const std::optional<double>& radius_m) {
  return units::from_si(*radius_m, Unit::kDiameterMillimetre);
}

}  // namespace

KeyRecord density_record() {
  return number("inertia.density_kg_m3", Unit::kKilogramPerCubicMetre, above(0.0, 30000.0),
                "of each gear that of its material, else none",
                "density of all gears, for mass and inertia from geometry; carrier and pins have "
                "it too, or that which all materials share");
}

KeyRecord face_width_record(std::size_t stage) {
  return number(fmt::format("stage{}.face_width_mm", stage + 1), Unit::kMillimetre,
                above(0.0, 1000.0), "none",
                "face width; without it no strength, and no mass or inertia from geometry",
                {design::InputKind::kFaceWidth, stage});
}

std::vector<Key<Masses>> mass_keys() {
  std::vector<Key<Masses>> keys;
  const auto add = [&](KeyRecord record, std::optional<double> Masses::*member) {
    keys.push_back(make_key<Masses>(
        std::move(record), [member](auto& t, std::size_t) -> auto& { return t.*member; }));
  };
  const auto add_body = [&](const char* name, std::optional<double> Masses::*member, Unit unit,
                            const char* help) {
    add(number(fmt::format("inertia.{}", name), unit, within(0.0, 1e6), "from geometry", help),
        member);
  };
  add(density_record(), &Masses::density_kgm3);
  constexpr Unit kInertia = Unit::kKilogramSquareMetre;
  add_body("S_kgm2", &Masses::sun_kgm2, kInertia, "inertia of the sun about its axis");
  add_body("P1_kgm2", &Masses::planet1_kgm2, kInertia, "inertia of one planet's step P1");
  add_body("P2_kgm2", &Masses::planet2_kgm2, kInertia, "inertia of one planet's step P2");
  add_body("planet_mass_kg", &Masses::planet_mass_kg, Unit::kKilogram,
           "mass of one planet, both steps");
  add_body("carrier_kgm2", &Masses::carrier_kgm2, kInertia,
           "inertia of the carrier without planets about the main axis");
  add_body("R2_kgm2", &Masses::ring2_kgm2, kInertia, "inertia of ring R2 with its output");
  for (const CarrierSize& size : kCarrierSizes) {
    add({.path = fmt::format("inertia.{}", size.name),
         .unit = size.unit,
         .min = 0.0,
         .max = size.max,
         .min_excluded = !size.may_be_zero,
         .default_text = size.default_text,
         .help = size.help},
        size.member);
  }
  return keys;
}

void check_masses(const Masses& masses, FileReading& reading) {
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
  require("pin_density_kg_m3", "pin_diameter_mm", "with it");
  require("pin_diameter_mm", "pin_length_mm", "both or neither");
  require("pin_length_mm", "pin_diameter_mm", "both or neither");
  // Without the key it may be that which all materials share.
  if (!masses.density_kgm3 && !reading.stated("inertia.pin_density_kg_m3")) {
    require("pin_diameter_mm", "density_kg_m3", "with it or with pin_density_kg_m3");
  }
  if (!masses.density_kgm3 && !reading.stated("inertia.carrier_density_kg_m3")) {
    require("carrier_outer_diameter_mm", "density_kg_m3", "with it or with carrier_density_kg_m3");
  }
  if (has("carrier_bore_mm") && has("carrier_outer_diameter_mm") &&
      *masses.carrier_bore_radius_m >= *masses.carrier_outer_radius_m) {
    error_at(
        "carrier_bore_mm",
        fmt::format(" = {:.6g}: allowed: below inertia.carrier_outer_diameter_mm = {:.6g}",
                    in_mm(masses.carrier_bore_radius_m), in_mm(masses.carrier_outer_radius_m)));
  }
  for (const train::GearId step : {train::kP1, train::kP2}) {
    const auto index = static_cast<std::size_t>(step);
    const std::string bore = fmt::format("gears.{}.bore_mm", train::kGearNames[index]);
    if (has("pin_diameter_mm") && reading.has(bore) &&
        *masses.planet_pin_radius_m > masses.bore_radius_m[index]) {
      error_at("pin_diameter_mm", fmt::format(" = {:.6g}: allowed: at most {} = {:.6g}",
                                              in_mm(masses.planet_pin_radius_m), bore,
                                              in_mm(masses.bore_radius_m[index])));
    }
  }
}

}  // namespace gear3k::io
