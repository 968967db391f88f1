#include "io/files/specification_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "actuator/co_design.hpp"
#include "design/rating_inputs.hpp"
#include "geometry/rack_point.hpp"
#include "io/files/co_design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/strength_task.hpp"
#include "io/keys/axial_keys.hpp"
#include "io/keys/cutter_keys.hpp"
#include "io/keys/design_keys.hpp"
#include "io/keys/model_keys.hpp"
#include "io/keys/robust_keys.hpp"
#include "io/keys/round_keys.hpp"
#include "io/keys/specification_keys.hpp"
#include "optimize/lattice.hpp"
#include "optimize/objective_value.hpp"

namespace gear3k::io {

namespace {

/// Whether one of these keys is stated with a value that is refused: what needs it is not missing.
bool any_refused(const FileReading& reading, std::initializer_list<const char*> keys) {
  return std::ranges::any_of(
      keys, [&](const char* key) { return reading.stated(key) && !reading.has(key); });
}

/// What the free variables exclude.
void check_free(const optimize::Specification& spec, FileReading& reading) {
  const char* const tips = reading.has("free.addendum") ? "free.addendum" : "free.tip_shortening";
  if (reading.has("free.addendum")) {
    for (const char* other : {"rack.addendum", "free.tip_shortening", "tip_shortening"}) {
      if (!reading.stated(other)) continue;
      reading.error_at(other, fmt::format("{} and free.addendum: allowed: one of them", other));
    }
  } else if (reading.has("free.tip_shortening") && reading.stated("tip_shortening")) {
    reading.error_at("tip_shortening",
                     "tip_shortening and free.tip_shortening: allowed: one of them");
  }
  if (spec.free.tip_shortening && (spec.khk_tip[train::kS] || spec.khk_tip[train::kP1])) {
    reading.error_at(tips, fmt::format("{} and tip_rule = \"khk\": allowed: one of them", tips));
  }
}

/// The rack must have a tooth over the whole range of its angle.
void check_free_angle(const optimize::Specification& spec, FileReading& reading) {
  const auto& range = spec.free.pressure_angle_rad;
  const double greatest_rad = geometry::pointed_rack_angle(spec.rack);
  if (!range || range->max < greatest_rad || any_refused(reading, {"rack.dedendum"})) return;
  const auto degrees = [](double rad) { return units::from_si(rad, units::Unit::kDegree); };
  reading.error_at(
      "free.pressure_angle_deg",
      fmt::format("free.pressure_angle_deg = [{:.6g}, {:.6g}]: allowed: below {:.6g}, where the "
                  "tooth of a rack with dedendum = {} comes to a point",
                  degrees(range->min), degrees(range->max), degrees(greatest_rad),
                  spec.rack.dedendum));
}

/// Shifts that are multiples of a step.
void finish_shift_step(optimize::Specification& spec, FileReading& reading) {
  if (!spec.shift_step) return;
  const double step = *spec.shift_step;
  if (reading.stated("round.profile_shift")) {
    reading.error_at("round.profile_shift",
                     "round.profile_shift and profile_shift.step: allowed: one of them");
  }
  spec.round.profile_shift = step;
  const optimize::Multiples multiples(step, units::Unit::kModules);
  const auto holds_one = [&](const char* key, const optimize::NumberRange& range) {
    if (multiples.first_from(range.min) <= multiples.last_to(range.max)) return;
    reading.error_at(reading.stated(key) ? key : "profile_shift.step",
                     fmt::format("{} = [{:g}, {:g}] with profile_shift.step = {:g}: allowed: a "
                                 "range that holds a multiple of the step",
                                 key, range.min, range.max, step));
  };
  holds_one("profile_shift.range", spec.profile_shift);
  if (spec.ring_shift) holds_one("profile_shift.ring_range", *spec.ring_shift);
}

void check_objectives(const optimize::Specification& spec, FileReading& reading) {
  for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
    const auto name = optimize::objective_record(spec.objectives[k]).name;
    const auto first =
        std::find(spec.objectives.begin(), spec.objectives.end(), spec.objectives[k]);
    if (first != spec.objectives.begin() + static_cast<std::ptrdiff_t>(k)) {
      reading.error_at("objective",
                       fmt::format("objective: \"{}\" twice: allowed: each once", name));
      continue;  // what it lacks was told of the first
    }
    const bool needs_masses = spec.objectives[k] == optimize::Objective::kMass ||
                              spec.objectives[k] == optimize::Objective::kInertia ||
                              spec.objectives[k] == optimize::Objective::kTorqueDensity;
    if (optimize::is_of_load(spec.objectives[k]) && !spec.rating) {
      reading.error_at("objective",
                       fmt::format("objective \"{}\" without [strength]: allowed: with it", name));
    }
    const bool needs_limits = spec.objectives[k] == optimize::Objective::kTorqueCapacity ||
                              spec.objectives[k] == optimize::Objective::kTorqueDensity;
    if (needs_limits && spec.rating && !strength::judges_any(*spec.rating)) {
      reading.error_at("objective",
                       fmt::format("objective \"{}\" with materials of which no limit stress is "
                                   "stated: allowed: with sigma_f_lim_mpa or sigma_h_lim_mpa",
                                   name));
    }
    if (needs_masses && !optimize::knows_masses(spec) &&
        !any_refused(reading, {"stage1.face_width_mm", "stage2.face_width_mm",
                               "inertia.density_kg_m3", "material.name"})) {
      reading.error_at("objective",
                       fmt::format("objective \"{}\" without inertia.density_kg_m3, or "
                                   "materials of a known density, stage1.face_width_mm and "
                                   "stage2.face_width_mm: allowed: with all three",
                                   name));
    }
  }
}

/// Lists of teeth must hold a number of the gear's range.
void check_allowed_teeth(const optimize::Specification& spec, FileReading& reading) {
  if (!spec.limits[design::CheckId::kAllowedTeeth]) return;
  const optimize::ToothRanges& teeth = spec.teeth;
  const int least = teeth.min_internal_difference;
  const auto check = [&](int gear, const optimize::IntegerRange& range,
                         std::initializer_list<const char*> keys, const std::string& stated) {
    const auto i = static_cast<std::size_t>(gear);
    const std::vector<int>& list = spec.limits.allowed_teeth[i];
    const auto in_range = [&](int z) { return z >= range.min && z <= range.max; };
    if (list.empty() || range.min > range.max || any_refused(reading, keys) ||
        std::ranges::any_of(list, in_range)) {
      return;
    }
    const std::string key = fmt::format("allowed_teeth.{}", train::kGearNames[i]);
    reading.error_at(key, fmt::format("{} = [{}]: allowed: at least one of {} to {} ({})", key,
                                      fmt::join(list, ", "), range.min, range.max, stated));
  };
  check(train::kS, teeth.S, {"teeth.S"}, "teeth.S");
  check(train::kP1, teeth.P1, {"teeth.P1"}, "teeth.P1");
  check(train::kP2, teeth.P2, {"teeth.P2"}, "teeth.P2");
  check(train::kR1, {.min = teeth.P1.min + least, .max = teeth.R1_max},
        {"teeth.P1", "teeth.R1_max", "teeth.min_internal_difference"},
        "teeth.P1 and min_internal_difference to teeth.R1_max");
  check(train::kR2, {.min = teeth.P2.min + least, .max = teeth.R2_max},
        {"teeth.P2", "teeth.R2_max", "teeth.min_internal_difference"},
        "teeth.P2 and min_internal_difference to teeth.R2_max");
}

void check_sizes(const optimize::Specification& spec, FileReading& reading) {
  const auto& whole_m = spec.limits[design::CheckId::kGearboxDiameter];
  if (whole_m && *whole_m <= 2.0 * spec.bodies.ring_rim_m &&
      !any_refused(reading, {"size.ring_rim_mm"})) {
    reading.error_at("size.max_outer_diameter_mm",
                     fmt::format("size.max_outer_diameter_mm = {:.6g}: allowed: above twice "
                                 "ring_rim_mm = {:.6g}",
                                 units::from_si(*whole_m, units::Unit::kMillimetre),
                                 units::from_si(spec.bodies.ring_rim_m, units::Unit::kMillimetre)));
  }
  const auto widths = optimize::least_face_widths_m(spec);
  if (spec.limits[design::CheckId::kGearboxLength] && !train::whole_extent(spec.axial) &&
      !(widths[0] > 0.0 && widths[1] > 0.0) &&
      !any_refused(reading, {"stage1.face_width_mm", "stage2.face_width_mm"})) {
    reading.error_at("size.max_length_mm",
                     "size.max_length_mm without [axial] and without stage1.face_width_mm and "
                     "stage2.face_width_mm: allowed: with [axial], or with both face widths");
  }
}

void check_relations(const SpecificationInput& input, FileReading& reading) {
  const optimize::Specification& spec = input.spec;
  check_sizes(spec, reading);
  check_allowed_teeth(spec, reading);
  const auto& teeth = spec.teeth;
  if (reading.has("ratio.target") && spec.ratio.target == 0.0) {
    reading.error_at("ratio.target", "ratio.target = 0: allowed: any number but 0");
  }
  const auto ring_holds = [&](const char* key, int most, const char* planet, int least) {
    if (reading.has(key) && reading.has(fmt::format("teeth.{}", planet)) &&
        most < least + teeth.min_internal_difference) {
      reading.error_at(key, fmt::format("{} = {}: allowed: at least the smallest {} plus "
                                        "min_internal_difference = {}",
                                        key, most, planet, least + teeth.min_internal_difference));
    }
  };
  ring_holds("teeth.R1_max", teeth.R1_max, "P1", teeth.P1.min);
  ring_holds("teeth.R2_max", teeth.R2_max, "P2", teeth.P2.min);
  check_objectives(spec, reading);
  check_free(spec, reading);
  using design::CheckId;
  const auto& least = input.limits.limits[CheckId::kOutputBacklashMin];
  const auto& most = input.limits.limits[CheckId::kOutputBacklashMax];
  if (least && most && *least > *most) {
    reading.error_at("backlash.min_output_arcmin",
                     fmt::format("backlash.min_output_arcmin = {:.6g}: allowed: at most "
                                 "max_output_arcmin = {:.6g}",
                                 units::from_si(*least, units::Unit::kArcmin),
                                 units::from_si(*most, units::Unit::kArcmin)));
  }
  const std::array<const char*, 2> both{"operating_point.sun_speed_rpm",
                                        "operating_point.output_torque_nm"};
  const bool point = reading.stated(both[0]) || reading.stated(both[1]);
  for (const std::size_t k : {0U, 1U}) {
    if (!point || reading.stated(both[k])) continue;
    reading.error_at(both[1 - k],
                     fmt::format("{} without {}: allowed: both or neither", both[1 - k], both[k]));
  }
  if (!point && reading.stated("operating_point.temperature_c")) {
    reading.error_at("operating_point.temperature_c",
                     "operating_point.temperature_c without sun_speed_rpm and output_torque_nm: "
                     "allowed: all three");
  }
  check_axial(spec.axial, reading);
  check_rings_apart(spec.axial, std::nullopt, reading);
  check_rack(spec.rack, spec.pressure_angle_rad, reading);
  check_free_angle(spec, reading);
  check_friction(spec.friction, reading);
  for (const auto& [ring, teeth_of_ring] :
       {std::pair{train::kR1, teeth.R1_max}, std::pair{train::kR2, teeth.R2_max}}) {
    geometry::PinionCutter largest = spec.cutter[ring];
    if (!spec.cutter_teeth[ring].empty()) largest.teeth = spec.cutter_teeth[ring].back();
    check_cutter(fmt::format("cutter.{}", train::kGearNames[ring]), largest, teeth_of_ring,
                 reading);
  }
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (spec.khk_tip[i] && spec.tip_shortening[i] > 0.0) {
      reading.error_at(
          "tip_shortening",
          fmt::format("tip_shortening of {0} and tip_rule.{0} = \"khk\" exclude each other: "
                      "allowed: one of them",
                      train::kGearNames[i]));
    }
    if (spec.tip_shortening[i] >= spec.rack.addendum + spec.rack.dedendum) {
      reading.error_at("tip_shortening",
                       fmt::format("tip_shortening of {} = {}: allowed: below rack addendum + "
                                   "dedendum = {}",
                                   train::kGearNames[i], spec.tip_shortening[i],
                                   spec.rack.addendum + spec.rack.dedendum));
    }
  }
}

/// The bores, and the wall that a bore is to leave: at least what is not nothing.
void finish_bodies(optimize::Specification& spec) {
  auto& bores = spec.bodies.bore_radius_m;
  bores[train::kP2] = bores[train::kP1];
  auto& wall = spec.limits[design::CheckId::kWall];
  constexpr double kLeastWall_m = 1e-6;
  if (std::ranges::any_of(bores, [](double r) { return r > 0.0; })) {
    wall = std::max(wall.value_or(0.0), kLeastWall_m);
  }
}

/// What both modules can be, where they are to be the same.
void unite_modules(optimize::Specification& spec, FileReading& reading) {
  if (!optimize::has_same_module(spec)) return;
  if (!reading.has("module.stage1_mm") || !reading.has("module.stage2_mm")) return;
  const optimize::ModuleChoice& first = spec.module[0];
  const optimize::ModuleChoice& second = spec.module[1];
  optimize::ModuleChoice both;
  if (first.range_m && second.range_m) {
    both.range_m = optimize::NumberRange{.min = std::max(first.range_m->min, second.range_m->min),
                                         .max = std::min(first.range_m->max, second.range_m->max)};
    if (both.range_m->min > both.range_m->max) both.range_m.reset();
  } else {
    const auto holds = [](const optimize::ModuleChoice& choice, double module_m) {
      if (choice.range_m) return module_m >= choice.range_m->min && module_m <= choice.range_m->max;
      return std::ranges::find(choice.series_m, module_m) != choice.series_m.end();
    };
    const optimize::ModuleChoice& series = first.range_m ? second : first;
    const optimize::ModuleChoice& other = first.range_m ? first : second;
    for (const double module_m : series.series_m) {
      if (holds(other, module_m)) both.series_m.push_back(module_m);
    }
  }
  if (!both.range_m && both.series_m.empty()) {
    reading.error_at(
        "limits.same_module",
        "limits.same_module = true: module.stage1_mm and module.stage2_mm have no module in "
        "common: allowed: choices that share one");
    return;
  }
  spec.module = {both, both};
}

/// Refuses tooth ranges that hold more sets than can be worked on, before they are searched.
void check_size(const optimize::Specification& spec, double most, FileReading& reading) {
  const double sets = optimize::estimated_candidates(spec, most);
  if (sets <= most) return;
  const optimize::ToothRanges& teeth = spec.teeth;
  for (const auto& [name, range] : {std::pair{"teeth.S", teeth.S}, std::pair{"teeth.P1", teeth.P1},
                                    std::pair{"teeth.P2", teeth.P2}}) {
    if (range.min == range.max) continue;
    reading.error_at(
        name, fmt::format("{} = [{}, {}]: with the other ranges, ratio.tolerance = {:g} and "
                          "{} of planets these are about {:.2g} tooth sets: allowed: at "
                          "most {:.2g}",
                          name, range.min, range.max, spec.ratio.tolerance,
                          spec.planets.size() == 1 ? "one number"
                                                   : fmt::format("{} numbers", spec.planets.size()),
                          sets, most));
  }
}

/// The document without the gears of a DESIGN, which are one message instead of one a key.
TomlValue without_gears(TomlValue document, FileReading& reading) {
  const auto gears = std::ranges::find(document.table, "gears", &TomlValue::key);
  if (gears == document.table.end()) return document;
  const bool has_teeth = std::ranges::any_of(gears->table, [](const TomlValue& gear) {
    return std::ranges::find(gear.table, "teeth", &TomlValue::key) != gear.table.end();
  });
  if (!has_teeth) return document;
  reading.error(gears->position,
                "unknown table [gears]: allowed: materials, as gears.S.material (tooth ranges are "
                "in [teeth])");
  document.table.erase(gears);
  return document;
}

/// Density of the gears and what they are to carry.
void finish_rating(SpecificationInput& input, FileReading& reading) {
  optimize::Specification& spec = input.spec;
  const auto materials = finish_materials(input.strength, train_gear_tables(), reading);
  if (!reading.stated("inertia.density_kg_m3")) {
    spec.bodies.density_kgm3 = design::common_density_kgm3(materials);
    spec.bodies.gear_density_kgm3 = design::material_densities_kgm3(materials);
  }
  const bool has_speed = reading.has("operating_point.sun_speed_rpm");
  spec.rating = finish_train_strength(
      input.strength, materials,
      {.planets = spec.planets,
       .face_width_m = spec.bodies.face_width_m,
       .sun_speed_rad_s =
           has_speed ? std::optional(input.losses.operating_point.sun_speed_rad_s) : std::nullopt,
       .axial = spec.axial,
       .limits = spec.limits},
      reading);
  std::vector<std::string> uncut;
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    if (spec.cutter[ring].teeth > 0) continue;
    uncut.push_back(fmt::format("cutter.{}", train::kGearNames[ring]));
  }
  check_ring_corners(spec.rack, uncut, spec.rating, reading);
  if (spec.rating && spec.bodies.ring_rim_m > 0.0) {
    spec.rating->ring_rim_m = spec.bodies.ring_rim_m;
  }
  for (const int gear : {train::kS, train::kP1, train::kP2}) {
    const auto i = static_cast<std::size_t>(gear);
    if (spec.rating && spec.bodies.bore_radius_m[i] > 0.0) {
      spec.rating->rim_radius_m[i] = spec.bodies.bore_radius_m[i];
    }
  }
}

/// Thinning, at the least module, and tolerance of the gears that state thickness allowances.
void take_allowances(optimize::Specification& spec, FileReading& reading) {
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const auto& stated = spec.thickness_allowance_m[i];
    if (!stated) continue;
    const std::string path = fmt::format("backlash.{}.A_sn_um", train::kGearNames[i]);
    if (spec.machining_allowance[i] != 0.0) {
      refuse_both(path, "backlash.machining_allowance", reading);
    }
    refuse_both(path, fmt::format("tolerances.{}.tooth_thickness_um", train::kGearNames[i]),
                reading);
    spec.tolerances->gears[i].tooth_thickness_m = backlash::thickness_tolerance_of(*stated);
    const auto stage = static_cast<std::size_t>(train::stage_of(static_cast<int>(i)));
    if (!reading.has(fmt::format("module.stage{}_mm", stage + 1))) continue;
    const double module_m = optimize::least_module(spec.module[stage]);
    spec.machining_allowance[i] =
        optimize::machining_allowance(spec, i, spec.pressure_angle_rad, module_m);
    if (spec.machining_allowance[i] <= kGreatestAllowance) continue;
    const double most_um = units::from_si(kGreatestAllowance * module_m, units::Unit::kMicrometre) /
                           std::cos(spec.pressure_angle_rad);
    reading.error_at(path,
                     fmt::format("{} = [{:.6g}, {:.6g}]: allowed: a middle of at least "
                                 "-{:.6g} (1 module, the least of the stage)",
                                 path, units::from_si(stated->lower, units::Unit::kMicrometre),
                                 units::from_si(stated->upper, units::Unit::kMicrometre), most_um));
  }
}

/// Motors, load and cycles of the objective cycle_energy.
/// @throws InvalidInput with the errors so far, and those of the files
void take_co_design(SpecificationInput& input, const std::string& name, FileReading& reading) {
  optimize::Specification& spec = input.spec;
  const bool wanted = std::ranges::find(spec.objectives, optimize::Objective::kCycleEnergy) !=
                      spec.objectives.end();
  check_co_design(input.co_design, wanted, reading);
  if (wanted) check_cycle_energy(spec, reading);
  const bool felt = !wanted && limits_felt(input.co_design);
  if (felt) check_felt_task(spec, reading);
  CollectedErrors errors;
  errors.attempt([&] { reading.throw_if_invalid(); });
  if (wanted) {
    errors.attempt([&] {
      const CoDesignInput& in = input.co_design;
      if (!in.selection.cycles.empty() && (!in.motor.empty() || !in.selection.motors.empty())) {
        const auto co_design = read_co_design(in, name, reading, spec.notes);
        const auto& motors = co_design->task().motors;
        if (limits_felt(in) && motors.size() == 1) {
          spec.felt = felt_of(in, motors.front().motor, co_design->sources());
        }
        spec.cycle_energy = co_design;
      }
    });
  }
  if (felt && !input.co_design.motor.empty()) {
    errors.attempt([&] { spec.felt = read_felt(input.co_design, name, reading, spec.notes); });
  }
  errors.raise();
}

/// Names what is stated and, with what else is stated, read by nothing.
void note_unread(const SpecificationInput& input, const FileReading& reading,
                 std::vector<std::string>& notes) {
  const optimize::Specification& spec = input.spec;
  if (!spec.cycle_energy) {
    const std::vector<std::string> unread = unread_co_design(input.co_design, reading);
    if (!unread.empty()) {
      notes.push_back(fmt::format("not read, as the objective is not \"cycle_energy\"{}: {}",
                                  spec.felt ? "" : " and no limit of what is felt is stated",
                                  fmt::join(unread, ", ")));
    }
  }
  if (spec.free.pressure_angle_rad && reading.stated("pressure_angle_deg")) {
    notes.emplace_back("pressure_angle_deg is not read: free.pressure_angle_deg has the range");
  }
  if (spec.objectives.size() == 1 && reading.stated("pareto.points")) {
    notes.emplace_back("pareto.points is not read: one objective has no Pareto front");
  }
}

optimize::Specification specification_from(const TomlValue& document, const std::string& name,
                                           double most_sets) {
  FileReading reading(name);
  SpecificationInput input;
  read_by_schema(with_material_tables(without_gears(document, reading), train_gear_tables()),
                 specification_schema(), input, reading);
  if (const auto& addendum = input.free_addendum) {
    input.spec.rack.addendum = addendum->max;
    input.spec.free.tip_shortening = {.min = 0.0, .max = addendum->max - addendum->min};
    input.spec.free.addendum_stated = true;
  }
  input.spec.limits = finish_limits(input.limits, reading);
  input.spec.thermal = finish_thermal(input.thermal, input.limits, input.spec.limits, reading);
  finish_bodies(input.spec);
  input.spec.round.stated = std::ranges::any_of(
      round_keys(), [&](const auto& key) { return reading.stated(key.record.path); });
  finish_shift_step(input.spec, reading);
  unite_modules(input.spec, reading);
  finish_rating(input, reading);
  check_relations(input, reading);
  const bool allowances = std::ranges::any_of(input.spec.thickness_allowance_m,
                                              [](const auto& a) { return a.has_value(); });
  input.tolerances.stated = input.tolerances.stated || allowances;
  check_robust(input.spec, input.tolerances, reading);
  if (input.tolerances.stated) input.spec.tolerances = stated_tolerances(input.tolerances);
  take_allowances(input.spec, reading);
  input.spec.sampling = input.tolerances.sampling;
  take_co_design(input, name, reading);
  check_size(input.spec, most_sets, reading);
  reading.throw_if_invalid();
  note_unread(input, reading, input.spec.notes);
  if (reading.has("operating_point.sun_speed_rpm")) {
    input.spec.operating_point = input.losses.operating_point;
  }
  return input.spec;
}

/// A value of a key in its one form.
TomlValue as_stated(const Key<SpecificationInput>& key, std::size_t gear, const TomlValue& value) {
  SpecificationInput scratch;
  key.assign(key.record, scratch, gear, value);
  return key.state(key.record, scratch, gear).value_or(value);
}

std::string path_of(const KeyRecord& record, const std::vector<std::string>& gears,
                    std::size_t gear) {
  constexpr std::string_view kPlaceholder = "{gear}";
  std::string path = record.path;
  const auto at = path.find(kPlaceholder);
  if (at != std::string::npos) path.replace(at, kPlaceholder.size(), gears[gear]);
  return path;
}

/// By key, its default in that form as TOML; "" where the key has none that is a value.
const std::vector<std::string>& usual_texts() {
  static const std::vector<std::string> texts = [] {
    std::vector<std::string> all;
    for (const Key<SpecificationInput>& key : specification_schema().keys()) {
      all.emplace_back();
      if (key.record.required || key.record.default_text.empty()) continue;
      try {
        const TomlValue document = parse_toml("x = " + key.record.default_text, "");
        // What is no value of the key is refused as any other; gears share their default.
        FileReading unheard("");
        KeyRecord own = key.record;
        own.path = "x";
        const KeyIndex index(expand_keys({&own}, {}));
        if (match_keys(document, index, unheard).empty()) continue;
        all.back() = toml_text(as_stated(key, 0, document.table.front()));
      } catch (const InvalidInput&) {
        // A default in words, as "with [strength]: 1".
      }
    }
    return all;
  }();
  return texts;
}

/// A limit that is its default, where it has one, whatever that is.
bool switches_on(const KeyRecord& record, const TomlValue& value) {
  return record.type == KeyType::kNumberOrSwitch && value.kind == TomlValue::Kind::kBoolean &&
         value.boolean;
}

}  // namespace

optimize::Specification read_specification(const std::string& path, double most_sets) {
  return parse_specification(read_toml_text(path), path, most_sets);
}

optimize::Specification parse_specification(const std::string& text, const std::string& name,
                                            double most_sets) {
  const TomlValue document = parse_toml(text, name);
  refuse_other_documents(document, name, {DocumentKind::kSpecification},
                         "SPEC takes a file with [ratio] and [teeth]");
  return specification_from(document, name, most_sets);
}

optimize::Specification specification_of(const TomlValue& document, const std::string& name,
                                         double most_sets) {
  return specification_from(document, name, most_sets);
}

std::vector<StatedKey> stated_keys(const TomlValue& document) {
  const Schema<SpecificationInput>& schema = specification_schema();
  const TomlValue tables = with_material_tables(document, train_gear_tables());
  FileReading unheard("");
  std::vector<FoundValue> found = match_keys(tables, schema.index(), unheard);
  std::ranges::sort(found, {}, [](const FoundValue& f) { return std::pair(f.key, f.gear); });
  const bool preset = unheard.has("preset");
  std::vector<StatedKey> keys;
  for (const FoundValue& f : found) {
    const Key<SpecificationInput>& key = schema.keys()[f.key];
    if (key.record.path == "name") continue;
    TomlValue value = as_stated(key, f.gear, *f.value);
    const std::string path = path_of(key.record, schema.gears(), f.gear);
    const std::string& usual_text = usual_texts()[f.key];
    if (!preset && switches_on(key.record, value) && !usual_text.empty()) {
      value = as_stated(key, f.gear, parse_toml("x = " + usual_text, "").table.front());
    }
    const bool usual =
        !preset && !path.starts_with("tolerances.") && toml_text(value) == usual_text;
    keys.push_back(
        {.key = {.path = path, .gear = f.gear, .value = std::move(value)}, .usual = usual});
  }
  return keys;
}

std::vector<std::string> named_files(const optimize::Specification& spec) {
  const actuator::CoDesign* const co_design = actuator::co_design_of(spec.cycle_energy.get());
  if (co_design != nullptr) return co_design->sources();
  return spec.felt ? spec.felt->sources : std::vector<std::string>();
}

void check_keys(const TomlValue& part, FileReading& reading) {
  // The records once more, none of them required.
  static const std::vector<KeyRecord> records = [] {
    std::vector<KeyRecord> copies;
    copies.reserve(specification_schema().keys().size());
    for (const KeyRecord* record : specification_schema().records()) {
      copies.push_back(*record);
      copies.back().required = false;
    }
    return copies;
  }();
  static const KeyIndex index = [] {
    std::vector<const KeyRecord*> pointers;
    pointers.reserve(records.size());
    for (const KeyRecord& record : records) pointers.push_back(&record);
    return KeyIndex(expand_keys(pointers, specification_schema().gears()));
  }();
  match_keys(with_material_tables(without_gears(part, reading), train_gear_tables()), index,
             reading);
}

std::string specification_key_table() { return key_table(specification_schema()); }

}  // namespace gear3k::io
