#include "io/files/design_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "backlash/thickness_allowance.hpp"
#include "design/rating_inputs.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/strength_task.hpp"
#include "io/keys/axial_keys.hpp"
#include "io/keys/cutter_keys.hpp"
#include "io/keys/design_keys.hpp"
#include "io/keys/mass_keys.hpp"
#include "io/keys/model_keys.hpp"

namespace gear3k::io {

namespace {

using units::Unit;

constexpr int kFewestTeeth = 3;

/// A gear in our convention; what cannot be one is said in `reading`.
struct GearPlace {
  std::string path;
  bool ring = false;
  double module_m = 0.0;
  bool external_mesh = false;  ///< has a mesh that the KHK tip rule applies to
};
geometry::GearGeometry<double> circles_of(const CommonInput& input,
                                          const geometry::Gear<double>& gear) {
  return geometry::make_gear_geometry(gear,
                                      geometry::make_pressure_angle(input.pressure_angle_rad));
}

/// Takes the thinning that a gear states as a length.
void take_thinning(const CommonInput& input, const GearInput& g, const GearPlace& place,
                   geometry::Gear<double>& gear, FileReading& reading) {
  std::string stated;
  double most_um = units::from_si(kGreatestAllowance * place.module_m, Unit::kMicrometre);
  if (g.thickness_allowance_m) {
    const auto& limits = *g.thickness_allowance_m;
    gear.machining_allowance =
        backlash::machining_allowance_of(limits, input.pressure_angle_rad, place.module_m);
    most_um /= std::cos(input.pressure_angle_rad);
    stated = fmt::format("A_sn_um = [{:.6g}, {:.6g}]: thins the tooth by {:.6g} um",
                         units::from_si(limits.lower, Unit::kMicrometre),
                         units::from_si(limits.upper, Unit::kMicrometre),
                         units::from_si(-limits.middle(), Unit::kMicrometre));
  } else if (g.normal_thinning_m) {
    gear.machining_allowance = *g.normal_thinning_m / place.module_m;
    stated = fmt::format("normal_thinning_um = {:.6g}",
                         units::from_si(*g.normal_thinning_m, Unit::kMicrometre));
  }
  if (stated.empty() || gear.machining_allowance <= kGreatestAllowance) return;
  const char* key = g.thickness_allowance_m ? "A_sn_um" : "normal_thinning_um";
  reading.error_at(fmt::format("{}.{}", place.path, key),
                   fmt::format("{}.{}: allowed: at most {:.6g} um ({:g} module)", place.path,
                               stated, most_um, kGreatestAllowance));
}

geometry::Gear<double> finish_gear(const CommonInput& input, const GearInput& g,
                                   const GearPlace& place, FileReading& reading) {
  const std::string teeth_key = place.path + ".teeth";
  const bool flipped = place.ring && input.iso;
  const int teeth = flipped ? -g.teeth : g.teeth;
  if (reading.has(teeth_key) && teeth < kFewestTeeth) {
    reading.error_at(
        teeth_key,
        fmt::format("{} = {}: allowed: {}", teeth_key, g.teeth,
                    flipped ? fmt::format("at most -{} (sign_convention iso21771)", kFewestTeeth)
                            : fmt::format("at least {}{}", kFewestTeeth,
                                          place.ring ? " (sign_convention khk)" : "")));
  }
  if (reading.has(place.path + ".machining_allowance") && g.normal_thinning_m) {
    reading.error_at(place.path + ".normal_thinning_um",
                     fmt::format("{0}.normal_thinning_um and {0}.machining_allowance say the same: "
                                 "allowed: one of them",
                                 place.path));
  }
  for (const char* other : {".normal_thinning_um", ".machining_allowance"}) {
    refuse_both(place.path + ".A_sn_um", place.path + other, reading);
  }
  if (g.tip_shortening >= input.rack.addendum + input.rack.dedendum) {
    reading.error_at(
        place.path + ".tip_shortening",
        fmt::format("{}.tip_shortening = {}: allowed: below rack addendum + dedendum "
                    "= {}",
                    place.path, g.tip_shortening, input.rack.addendum + input.rack.dedendum));
  }
  if (g.khk_tip && !place.external_mesh) {
    reading.error_at(place.path + ".tip_rule",
                     fmt::format("{}.tip_rule = \"khk\": allowed: \"full\" (the rule is for the "
                                 "gears of an external mesh)",
                                 place.path));
  }
  if (g.khk_tip && reading.has(place.path + ".tip_shortening")) {
    reading.error_at(
        place.path + ".tip_shortening",
        fmt::format("{0}.tip_shortening and {0}.tip_rule = \"khk\" exclude each other: "
                    "allowed: one of them",
                    place.path));
  }
  const std::string cutter_path = place.path + ".cutter";
  if (!place.ring) {
    for (const char* key : {".teeth", ".profile_shift", ".tip_radius"}) {
      if (reading.stated(cutter_path + key)) {
        reading.error_at(cutter_path + key,
                         fmt::format("{}{}: allowed for rings only (external gears are cut by the "
                                     "rack)",
                                     cutter_path, key));
      }
    }
  } else {
    check_cutter(cutter_path, g.cutter, teeth, reading);
  }
  const double x = flipped ? -g.profile_shift : g.profile_shift;
  geometry::Gear<double> gear{
      .teeth = teeth,
      .kind = place.ring ? geometry::GearKind::kRing : geometry::GearKind::kExternal,
      .module_m = place.module_m,
      .profile_shift = x,
      .machining_allowance = g.machining_allowance,
      .tip_shortening = g.tip_shortening,
      .rack = input.rack,
      .cutter = g.cutter};
  if (teeth < kFewestTeeth || !(place.module_m > 0.0)) return gear;
  const geometry::GearGeometry<double> circles = circles_of(input, gear);
  const double innermost =
      (place.ring ? circles.tip_radius_m : circles.root_radius_m) / place.module_m;
  if (innermost <= 0.0) {
    reading.error_at(
        place.path + ".profile_shift",
        fmt::format("{}.profile_shift = {}: leaves no {} circle, allowed: {} {:.6g}", place.path,
                    g.profile_shift, place.ring ? "tip" : "root", flipped ? "below" : "above",
                    flipped ? g.profile_shift + innermost : g.profile_shift - innermost));
  }
  take_thinning(input, g, place, gear, reading);
  return gear;
}

void require_more_ring_teeth(const GearPlace& ring, const GearPlace& mate, int ring_teeth,
                             int mate_teeth, FileReading& reading) {
  if (ring_teeth >= kFewestTeeth && mate_teeth >= kFewestTeeth && ring_teeth <= mate_teeth) {
    reading.error_at(ring.path + ".teeth",
                     fmt::format("{}.teeth: {} teeth, allowed: more than the {} of {}", ring.path,
                                 ring_teeth, mate_teeth, mate.path));
  }
}

/// Where an impossible centre distance is reported: at its key, else at the file.
std::string center_distance_place(const FileReading& reading) {
  return reading.stated("center_distance_mm") ? "center_distance_mm" : "";
}

/// A gear with the names of its tables.
struct TolerancedGear {
  std::string path, name;  ///< "gears.S", of its tolerances "S"
  const GearInput& input;
  const geometry::Gear<double>& gear;
};

/// Tolerances of a gear, that of its thickness by its allowances where it states them.
backlash::GearTolerances gear_tolerances(const ToleranceInput::Gear& input, const TolerancedGear& g,
                                         FileReading& reading) {
  const std::string path = "tolerances." + g.name;
  auto result = finish_gear_tolerances(input,
                                       {.path = path,
                                        .module_m = g.gear.module_m,
                                        .reference_diameter_m = g.gear.module_m * g.gear.teeth},
                                       reading);
  refuse_both(g.path + ".A_sn_um", path + ".tooth_thickness_um", reading);
  if (const auto& stated = g.input.thickness_allowance_m) {
    result.tooth_thickness_m = backlash::thickness_tolerance_of(*stated);
  }
  return result;
}

void check_bore(const DesignInput& input, const GearPlace& place, double bore_radius_m,
                const geometry::Gear<double>& gear, FileReading& reading) {
  const double root_radius_m = circles_of(input, gear).root_radius_m;
  if (bore_radius_m < root_radius_m) return;
  reading.error_at(place.path + ".bore_mm",
                   fmt::format("{}.bore_mm = {:.6g}: allowed: below the root diameter {:.6g}",
                               place.path, units::from_si(bore_radius_m, Unit::kDiameterMillimetre),
                               units::from_si(root_radius_m, Unit::kDiameterMillimetre)));
}

void check_rim(const DesignInput& input, const GearPlace& place, double outer_radius_m,
               const geometry::Gear<double>& gear, FileReading& reading) {
  const double root_radius_m = circles_of(input, gear).root_radius_m;
  if (outer_radius_m > root_radius_m) return;
  reading.error_at(
      place.path + ".outer_diameter_mm",
      fmt::format("{}.outer_diameter_mm = {:.6g}: allowed: above the root diameter {:.6g}",
                  place.path, units::from_si(outer_radius_m, Unit::kDiameterMillimetre),
                  units::from_si(root_radius_m, Unit::kDiameterMillimetre)));
}

/// Whether any gear states its thickness by allowances, which are tolerances too.
bool states_allowance(const CommonInput& input) {
  return std::ranges::any_of(
      input.gears, [](const GearInput& gear) { return gear.thickness_allowance_m.has_value(); });
}

/// The gears of a design as read, with what is judged of all of them together.
struct DesignGears {
  std::array<GearPlace, train::kGearCount> places{};
  std::array<RingBody, 2> rings{};
  bool rings_known = true;  ///< both have circles
};

/// What a gear has within or around its teeth: an external one a bore, a ring an outer diameter.
void check_body(const DesignInput& input, std::size_t i, const GearPlace& place,
                const geometry::Gear<double>& gear, bool has_circles, FileReading& reading) {
  const auto& outer_radius_m = input.outer_radius_m[i];
  const double bore_radius_m = input.masses.bore_radius_m[i];
  if (place.ring) {
    if (bore_radius_m > 0.0) {
      reading.error_at(place.path + ".bore_mm",
                       fmt::format("{}.bore_mm: allowed for S, P1 and P2 only (a ring has "
                                   "outer_diameter_mm)",
                                   place.path));
    }
    if (outer_radius_m && has_circles) check_rim(input, place, *outer_radius_m, gear, reading);
    return;
  }
  if (outer_radius_m) {
    reading.error_at(place.path + ".outer_diameter_mm",
                     fmt::format("{}.outer_diameter_mm: allowed for R1 and R2 only (external "
                                 "gears end at their teeth)",
                                 place.path));
  }
  if (has_circles) check_bore(input, place, bore_radius_m, gear, reading);
}

/// Fills what the design says of each gear, except the numbers of teeth.
DesignGears finish_gears(const DesignInput& input, design::Design& design,
                         std::array<int, train::kGearCount>& teeth,
                         backlash::Tolerances& tolerances, FileReading& reading) {
  DesignGears gears;
  auto& t = design.train;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const int id = static_cast<int>(i);
    GearPlace& place = gears.places[i];
    place = {.path = fmt::format("gears.{}", train::kGearNames[i]),
             .ring = train::kind_of(id) == geometry::GearKind::kRing,
             .module_m = input.module_m[static_cast<std::size_t>(train::stage_of(id))],
             .external_mesh = id == train::kS || id == train::kP1};
    const auto gear = finish_gear(input, input.gears[i], place, reading);
    teeth[i] = gear.teeth;
    t.profile_shift[i] = gear.profile_shift;
    t.machining_allowance[i] = gear.machining_allowance;
    t.tip_shortening[i] = gear.tip_shortening;
    t.rack[i] = gear.rack;
    t.khk_tip[i] = input.gears[i].khk_tip;
    t.cutter[i] = gear.cutter;
    tolerances.gears[i] = gear_tolerances(input.tolerances.gears[i],
                                          {.path = place.path,
                                           .name = std::string(train::kGearNames[i]),
                                           .input = input.gears[i],
                                           .gear = gear},
                                          reading);
    design.thickness_allowance_m[i] = input.gears[i].thickness_allowance_m;
    design.pin_diameter_m[i] = input.gears[i].pin_diameter_m;
    const bool has_circles = teeth[i] >= kFewestTeeth && gear.module_m > 0.0;
    check_body(input, i, place, gear, has_circles, reading);
    if (!place.ring) continue;
    const auto& outer_radius_m = input.outer_radius_m[i];
    const bool first = id == train::kR1;
    gears.rings_known = gears.rings_known && has_circles;
    if (has_circles) {
      const geometry::GearGeometry<double> circles = circles_of(input, gear);
      gears.rings[first ? 0 : 1] = {.tip_radius_m = circles.tip_radius_m,
                                    .root_radius_m = circles.root_radius_m,
                                    .outer_radius_m = outer_radius_m};
    }
    if (outer_radius_m) {
      (first ? design.masses.ring1_outer_radius_m : design.masses.ring2_outer_radius_m) =
          outer_radius_m;
    }
  }
  return gears;
}

/// Rings that hold their planets, an output that turns, gears that mesh.
void check_train(const design::Design& design, const DesignGears& gears, FileReading& reading) {
  const auto& t = design.train;
  const train::ToothSet& z = t.teeth;
  require_more_ring_teeth(gears.places[train::kR1], gears.places[train::kP1], z.R1, z.P1, reading);
  require_more_ring_teeth(gears.places[train::kR2], gears.places[train::kP2], z.R2, z.P2, reading);
  if (z.R2 > 0 && 1LL * z.P1 * z.R2 == 1LL * z.P2 * z.R1) {
    reading.error_at("gears.R2.teeth",
                     fmt::format("gears: zP1 zR2 = zP2 zR1 = {}: the output would stand still, "
                                 "allowed: different products",
                                 1LL * z.P1 * z.R2));
  }
  const bool teeth_known =
      std::min({z.S, z.P1, z.R1, z.P2, z.R2}) >= kFewestTeeth && z.R1 > z.P1 && z.R2 > z.P2;
  if (!teeth_known || !(t.module_m[0] > 0.0) || !(t.module_m[1] > 0.0)) return;
  if (const auto undefined = design::why_undefined(design)) {
    reading.error_at(center_distance_place(reading), undefined->message);
  }
}

/// What the strength of a design is judged by, where its file states it.
/// @param materials  of each gear
std::optional<strength::RatingTask> finish_rating_task(const DesignInput& input,
                                                       const design::GearMaterials& materials,
                                                       const design::Design& design,
                                                       const DesignGears& gears,
                                                       FileReading& reading) {
  const auto& point = design.operating_point;
  auto task = finish_train_strength(
      input.strength, materials,
      {.planets = {input.planets},
       .face_width_m = design.masses.face_width_m,
       .sun_speed_rad_s = point ? std::optional(point->sun_speed_rad_s) : std::nullopt,
       .axial = design.axial,
       .limits = design.limits,
       .has_pin = design.masses.planet_pin_radius_m.has_value(),
       .lubricant = design.friction.lubricant},
      reading);
  std::vector<std::string> uncut;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const GearPlace& place = gears.places[i];
    if (place.ring && design.train.cutter[i].teeth == 0) uncut.push_back(place.path + ".cutter");
  }
  check_ring_corners(input.rack, uncut, task, reading);
  return task;
}

design::Design finish_design(const DesignInput& input, FileReading& reading) {
  design::Design design;
  design.name = input.name;
  design.masses = input.masses;
  design.axial = input.axial;
  check_axial(input.axial, reading);
  finish_losses(input.losses, design, reading);
  check_friction(design.friction, reading);
  check_rack(input.rack, input.pressure_angle_rad, reading);
  design.limits = finish_limits(input.limits, reading);
  design.thermal = finish_thermal(input.thermal, input.limits, design.limits, reading);
  design.center_distance_given = input.center_distance_m.has_value();
  auto& t = design.train;
  t.planets = input.planets;
  t.pressure_angle_rad = input.pressure_angle_rad;
  t.center_distance_m = input.center_distance_m.value_or(0.0);
  t.module_m = input.module_m;
  std::array<int, train::kGearCount> teeth{};
  backlash::Tolerances tolerances = stated_tolerances(input.tolerances);
  const DesignGears gears = finish_gears(input, design, teeth, tolerances, reading);
  t.teeth = {.S = teeth[0], .P1 = teeth[1], .R1 = teeth[2], .P2 = teeth[3], .R2 = teeth[4]};
  if (gears.rings_known) check_rings_apart(input.axial, gears.rings, reading);
  if (input.tolerances.stated || states_allowance(input)) design.tolerances = tolerances;
  design.sampling = input.tolerances.sampling;
  const auto materials = finish_materials(input.strength, train_gear_tables(), reading);
  if (!reading.stated("inertia.density_kg_m3")) {
    design.masses.density_kgm3 = design::common_density_kgm3(materials);
    design.masses.gear_density_kgm3 = design::material_densities_kgm3(materials);
  }
  check_masses(design.masses, reading);
  check_train(design, gears, reading);
  if (const auto task = finish_rating_task(input, materials, design, gears, reading)) {
    design.rating = design::rating_of(*task, design);
  }
  return design;
}

design::Design design_from(const TomlValue& document, const std::string& name) {
  FileReading reading(name);
  DesignInput input;
  read_by_schema(with_material_tables(document, train_gear_tables()), design_schema(), input,
                 reading);
  design::Design design = finish_design(input, reading);
  reading.throw_if_invalid();
  return design;
}

design::PairDesign pair_from(const TomlValue& document, const std::string& name) {
  FileReading reading(name);
  PairInput input;
  read_by_schema(with_material_tables(document, pair_gear_tables()), pair_schema(), input, reading);
  const GearPlace place1{
      .path = "gear1", .ring = false, .module_m = input.module_m, .external_mesh = !input.internal};
  const GearPlace place2{.path = "gear2",
                         .ring = input.internal,
                         .module_m = input.module_m,
                         .external_mesh = !input.internal};
  check_rack(input.rack, input.pressure_angle_rad, reading);
  check_friction(input.friction, reading);
  design::PairDesign pair{
      .name = input.name,
      .pressure_angle_rad = input.pressure_angle_rad,
      .center_distance_m = input.center_distance_m,
      .gear1 = finish_gear(input, input.gears[0], place1, reading),
      .gear2 = finish_gear(input, input.gears[1], place2, reading),
      .khk_tip = {input.gears[0].khk_tip, input.gears[1].khk_tip},
      .pin_diameter_m = {input.gears[0].pin_diameter_m, input.gears[1].pin_diameter_m},
      .friction = input.friction,
      .limits = finish_limits(input.limits, reading),
      .tolerances = {},
      .thickness_allowance_m = {input.gears[0].thickness_allowance_m,
                                input.gears[1].thickness_allowance_m},
      .rating = {}};
  if (input.tolerances.stated || states_allowance(input)) {
    const auto of = [&](std::size_t i, const char* table, const geometry::Gear<double>& gear) {
      return gear_tolerances(input.tolerances.gears[i],
                             {.path = table, .name = table, .input = input.gears[i], .gear = gear},
                             reading);
    };
    pair.tolerances =
        backlash::PairTolerances{.gears = {of(0, "gear1", pair.gear1), of(1, "gear2", pair.gear2)},
                                 .center_distance_m = input.tolerances.center_distance_m};
  }
  pair.rating = finish_pair_strength(
      input.strength, finish_materials(input.strength, pair_gear_tables(), reading), reading);
  if (input.internal) {
    if (pair.gear2.cutter.teeth == 0) {
      check_ring_corners(input.rack, {"gear2.cutter"}, pair.rating, reading);
    }
    require_more_ring_teeth(place2, place1, pair.gear2.teeth, pair.gear1.teeth, reading);
  }
  const bool ring_fits = !input.internal || pair.gear2.teeth > pair.gear1.teeth;
  if (pair.gear1.teeth >= kFewestTeeth && pair.gear2.teeth >= kFewestTeeth && ring_fits &&
      input.module_m > 0.0) {
    if (const auto undefined = design::why_undefined(pair)) {
      reading.error_at(center_distance_place(reading), undefined->message);
    }
  }
  reading.throw_if_invalid();
  return pair;
}

}  // namespace

design::Design read_design(const std::string& path) {
  const TomlValue document = read_toml(path);
  refuse_other_documents(document, path, {DocumentKind::kDesign},
                         "DESIGN takes a file with [gears]");
  return design_from(document, path);
}

design::Design parse_design(const std::string& text, const std::string& name) {
  return design_from(parse_toml(text, name), name);
}

design::PairDesign read_pair(const std::string& path) {
  const TomlValue document = read_toml(path);
  refuse_other_documents(document, path, {DocumentKind::kPair},
                         "PAIR takes a file with [gear1] and [gear2]");
  return pair_from(document, path);
}

design::PairDesign parse_pair(const std::string& text, const std::string& name) {
  return pair_from(parse_toml(text, name), name);
}

std::string design_key_table() { return key_table(design_schema()); }
std::string pair_key_table() { return key_table(pair_schema()); }

}  // namespace gear3k::io
