#include "design/mass_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "inertia/mass_properties.hpp"

namespace gear3k::design {

namespace {

using inertia::MassProperties;

/// Outer radius of a ring, bore radius of an external gear.
std::optional<double> other_radius(const Masses& masses, train::GearId id) {
  if (id == train::kR1) return masses.ring1_outer_radius_m;
  if (id == train::kR2) return masses.ring2_outer_radius_m;
  return masses.bore_radius_m[static_cast<std::size_t>(id)];
}

std::optional<MassProperties<double>> gear_from_geometry(const Masses& masses,
                                                         const train::TrainGeometry<double>& train,
                                                         train::GearId id) {
  const auto& width = masses.face_width_m[static_cast<std::size_t>(train::stage_of(id))];
  const auto other = other_radius(masses, id);
  const auto index = static_cast<std::size_t>(id);
  const auto density = density_of(masses.density_kgm3, masses.gear_density_kgm3, index);
  if (!width || !density || !other) return std::nullopt;
  return inertia::gear_body(train.gears[index], *other, *width, *density);
}

std::optional<MassProperties<double>> plates_from_geometry(const Masses& masses) {
  const auto& density =
      masses.carrier_density_kgm3 ? masses.carrier_density_kgm3 : masses.density_kgm3;
  if (!masses.carrier_outer_radius_m || !masses.carrier_thickness_m || !density) {
    return std::nullopt;
  }
  return inertia::hollow_cylinder<double>(
      {.outer_radius_m = *masses.carrier_outer_radius_m,
       .inner_radius_m = masses.carrier_bore_radius_m.value_or(0.0),
       .width_m = *masses.carrier_thickness_m,
       .density_kgm3 = *density});
}

std::optional<MassProperties<double>> pin_from_geometry(const Masses& masses) {
  const auto& density =
      masses.planet_pin_density_kgm3 ? masses.planet_pin_density_kgm3 : masses.density_kgm3;
  if (!masses.planet_pin_radius_m || !masses.planet_pin_length_m || !density) return std::nullopt;
  return inertia::hollow_cylinder<double>({.outer_radius_m = *masses.planet_pin_radius_m,
                                           .inner_radius_m = 0.0,
                                           .width_m = *masses.planet_pin_length_m,
                                           .density_kgm3 = *density});
}

PartMass part_of(std::string_view name, int count,
                 const std::optional<MassProperties<double>>& body,
                 const std::optional<double>& stated_inertia_kgm2) {
  PartMass part{.name = std::string(name), .count = count, .mass_kg = {}, .inertia_kgm2 = {}};
  if (body) {
    part.mass_kg = body->mass_kg;
    part.inertia_kgm2 = body->inertia_kgm2;
  }
  if (stated_inertia_kgm2) {
    part.inertia_kgm2 = stated_inertia_kgm2;
    part.inertia_origin = MassOrigin::kStated;
  }
  return part;
}

/// What a part without a mass lacks of what would give it one.
std::string lacking(const Masses& masses, std::string_view part) {
  std::vector<std::string> keys;
  const auto need = [&](bool stated, std::string key) {
    if (!stated) keys.push_back(std::move(key));
  };
  const auto gear = std::ranges::find(train::kGearNames, part);
  if (part == "carrier") {
    need(masses.carrier_outer_radius_m.has_value(), "carrier_outer_diameter_mm");
    need(masses.carrier_thickness_m.has_value(), "carrier_thickness_mm");
    need(masses.carrier_density_kgm3 || masses.density_kgm3, "density_kg_m3");
  } else if (part == "pin") {
    need(masses.planet_pin_radius_m.has_value(), "pin_diameter_mm");
    need(masses.planet_pin_length_m.has_value(), "pin_length_mm");
    need(masses.planet_pin_density_kgm3 || masses.density_kgm3, "density_kg_m3");
  } else if (gear != train::kGearNames.end()) {
    const auto id = static_cast<train::GearId>(gear - train::kGearNames.begin());
    const auto stage = static_cast<std::size_t>(train::stage_of(id));
    need(density_of(masses.density_kgm3, masses.gear_density_kgm3, id).has_value(),
         "density_kg_m3");
    need(masses.face_width_m[stage].has_value(), fmt::format("stage{}.face_width_mm", stage + 1));
    need(other_radius(masses, id).has_value(), fmt::format("gears.{}.outer_diameter_mm", part));
  }
  return fmt::format("{}", fmt::join(keys, ", "));
}

bool has_pins(const Masses& masses) {
  return masses.planet_pin_radius_m || masses.planet_pin_length_m;
}

bool has_plates(const Masses& masses) {
  return masses.carrier_outer_radius_m || masses.carrier_thickness_m;
}

void add_total(const Masses& masses, MassModel& model) {
  double total = 0.0;
  std::vector<std::string> missing;
  for (const PartMass& part : model.parts) {
    const bool counted_as_planet =
        masses.planet_mass_kg && (part.name == "P1" || part.name == "P2");
    if (part.mass_kg) {
      total += part.count * *part.mass_kg;
    } else if (!counted_as_planet) {
      missing.push_back(fmt::format("{} ({})", part.name, lacking(masses, part.name)));
    }
  }
  if (missing.empty()) model.total_mass_kg = total;
  model.total_mass_missing = fmt::format("{}", fmt::join(missing, "; "));
}

void add_bodies(const Masses& masses, const train::TrainGeometry<double>& train,
                const std::optional<MassProperties<double>>& pin, MassModel& model) {
  std::vector<std::string> missing;
  const auto inertia_of = [&](std::string_view name, std::string_view key) {
    for (const PartMass& part : model.parts) {
      if (part.name == name && part.inertia_kgm2) return *part.inertia_kgm2;
    }
    missing.emplace_back(key);
    return 0.0;
  };
  inertia::BodyInertias<double> bodies{};
  bodies.sun_kgm2 = inertia_of("S", "inertia.S_kgm2");
  bodies.planet1_kgm2 = inertia_of("P1", "inertia.P1_kgm2");
  bodies.planet2_kgm2 = inertia_of("P2", "inertia.P2_kgm2");
  bodies.ring2_kgm2 = inertia_of("R2", "inertia.R2_kgm2");
  const auto step1 = gear_from_geometry(masses, train, train::kP1);
  const auto step2 = gear_from_geometry(masses, train, train::kP2);
  if (masses.planet_mass_kg) {
    bodies.planet_mass_kg = *masses.planet_mass_kg;
  } else if (step1 && step2) {
    bodies.planet_mass_kg = step1->mass_kg + step2->mass_kg;
  } else {
    missing.emplace_back("inertia.planet_mass_kg");
  }
  model.counts_carrier = masses.carrier_kgm2 || has_plates(masses);
  if (model.counts_carrier) bodies.carrier_kgm2 = inertia_of("carrier", "inertia.carrier_kgm2");
  if (pin && !masses.carrier_kgm2) {
    bodies.carrier_kgm2 +=
        train.planets * inertia::inertia_about_parallel_axis(*pin, train.center_distance_m);
  } else if (has_pins(masses) && !masses.carrier_kgm2) {
    missing.emplace_back("inertia.density_kg_m3, pin_diameter_mm, pin_length_mm of the pins");
  }
  if (missing.empty()) {
    model.bodies = bodies;
  } else {
    model.bodies_missing =
        fmt::format("{} (or density_kg_m3 with face widths, and outer_diameter_mm of R2)",
                    fmt::join(missing, ", "));
  }
}

}  // namespace

MassModel mass_model(const Masses& masses, const train::TrainGeometry<double>& train) {
  const std::array<std::optional<double>, train::kGearCount> stated{
      masses.sun_kgm2, masses.planet1_kgm2, std::nullopt, masses.planet2_kgm2, masses.ring2_kgm2};
  MassModel model;
  model.parts.reserve(train::kGearCount + 3);
  for (const train::GearId id : {train::kS, train::kP1, train::kP2, train::kR1, train::kR2}) {
    const bool step = id == train::kP1 || id == train::kP2;
    const auto index = static_cast<std::size_t>(id);
    model.parts.push_back(part_of(train::kGearNames[index], step ? train.planets : 1,
                                  gear_from_geometry(masses, train, id), stated[index]));
    if (step && masses.planet_mass_kg) model.parts.back().mass_kg.reset();
  }
  if (masses.planet_mass_kg) {
    model.parts.push_back({.name = "planet",
                           .count = train.planets,
                           .mass_kg = masses.planet_mass_kg,
                           .inertia_kgm2 = {},
                           .mass_origin = MassOrigin::kStated});
  }
  model.parts.push_back(part_of("carrier", 1, plates_from_geometry(masses), masses.carrier_kgm2));
  const auto pin = pin_from_geometry(masses);
  if (has_pins(masses)) model.parts.push_back(part_of("pin", train.planets, pin, std::nullopt));
  model.pins_in_solid_planets = pin && !masses.planet_mass_kg &&
                                (masses.bore_radius_m[train::kP1] < *masses.planet_pin_radius_m ||
                                 masses.bore_radius_m[train::kP2] < *masses.planet_pin_radius_m);
  add_total(masses, model);
  add_bodies(masses, train, pin, model);
  return model;
}

}  // namespace gear3k::design
