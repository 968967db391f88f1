#include "io/files/specification_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/keys/axial_keys.hpp"
#include "io/keys/cutter_keys.hpp"
#include "io/keys/limit_keys.hpp"
#include "io/keys/loss_keys.hpp"
#include "io/keys/mass_keys.hpp"
#include "io/keys/model_keys.hpp"
#include "io/keys/robust_keys.hpp"
#include "io/keys/tolerance_keys.hpp"
#include "optimize/objective_value.hpp"
#include "units/units.hpp"

namespace gear3k::io {

namespace {

struct SpecificationInput {
  optimize::Specification spec;
  LimitInput limits;
  LossInput losses;  ///< its operating point
  ToleranceInput tolerances;
};

using Input = SpecificationInput;

template <class Number>
void sort_and_unify(std::vector<Number>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

optimize::ModuleChoice module_choice(const TomlValue& v) {
  optimize::ModuleChoice choice;
  if (v.is_number()) {
    choice.range_m =
        optimize::NumberRange{v.number * units::kMillimetre, v.number * units::kMillimetre};
  } else if (v.table.size() == 1) {
    for (const TomlValue& e : v.table[0].list) {
      choice.series_m.push_back(e.number * units::kMillimetre);
    }
    sort_and_unify(choice.series_m);
  } else {
    optimize::NumberRange range;
    for (const TomlValue& end : v.table) {
      (end.key == "min" ? range.min : range.max) = end.number * units::kMillimetre;
    }
    choice.range_m = range;
  }
  return choice;
}

std::array<double, train::kGearCount> per_gear(const TomlValue& v) {
  std::array<double, train::kGearCount> values{};
  if (v.is_number()) {
    values.fill(v.number);
    return values;
  }
  for (const TomlValue& value : v.table) {
    values[index_of(train::kGearNames, value.key)] = value.number;
  }
  return values;
}

optimize::IntegerRange integer_range(const TomlValue& v) {
  return {.min = static_cast<int>(v.list[0].integer), .max = static_cast<int>(v.list[1].integer)};
}

optimize::NumberRange number_range(const TomlValue& v) {
  return {.min = v.list[0].number, .max = v.list[1].number};
}

/// Variables that are fixed unless a range is stated.
void append_free_keys(std::vector<Key<Input>>& keys) {
  keys.push_back({.record = {.path = "profile_shift.ring_range",
                             .type = KeyType::kNumberRange,
                             .unit = "modules",
                             .min = -5.0,
                             .max = 5.0,
                             .default_text = "profile_shift.range",
                             .help = "profile shift of R1 and R2"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.ring_shift = number_range(v);
                  }});
  keys.push_back({.record = {.path = "free.addendum",
                             .type = KeyType::kNumberRange,
                             .unit = "modules",
                             .min = 0.2,
                             .max = 2.0,
                             .default_text = "rack.addendum",
                             .help = "addendum of each gear, refined in this range; best.toml "
                                     "states it as rack.addendum less tip_shortening"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    const optimize::NumberRange range = number_range(v);
                    t.spec.rack.addendum = range.max;
                    t.spec.free.tip_shortening = {.min = 0.0, .max = range.max - range.min};
                  }});
  keys.push_back({.record = {.path = "free.tip_shortening",
                             .type = KeyType::kNumberRange,
                             .unit = "modules",
                             .min = 0.0,
                             .max = 1.5,
                             .default_text = "tip_shortening",
                             .help = "tip shortening of each gear, refined in this range"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.free.tip_shortening = number_range(v);
                  }});
  keys.push_back({.record = {.path = "free.pressure_angle_deg",
                             .type = KeyType::kNumberRange,
                             .unit = "deg",
                             .min = 10.0,
                             .max = 35.0,
                             .default_text = "pressure_angle_deg",
                             .help = "pressure angle, refined in this range; without bounds then"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    const optimize::NumberRange range = number_range(v);
                    t.spec.free.pressure_angle_rad = {.min = range.min * units::kDegree,
                                                      .max = range.max * units::kDegree};
                  }});
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

std::vector<std::string> objective_names() {
  std::vector<std::string> names;
  for (const optimize::ObjectiveRecord& record : optimize::objective_records()) {
    names.emplace_back(record.name);
  }
  return names;
}

void append_objective_keys(std::vector<Key<Input>>& keys) {
  keys.push_back({.record = {.path = "objective",
                             .type = KeyType::kChoices,
                             .choices = objective_names(),
                             .default_text = "\"backward_efficiency\"",
                             .help = "what is best; a list asks for the Pareto front, the first "
                                     "of it picks best.toml"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.objectives.clear();
                    const auto add = [&](const std::string& name) {
                      t.spec.objectives.push_back(
                          static_cast<optimize::Objective>(index_of(objective_names(), name)));
                    };
                    if (v.kind != TomlValue::Kind::kList) add(v.text);
                    for (const TomlValue& e : v.list) add(e.text);
                  }});
  keys.push_back({.record = {.path = "pareto.points",
                             .type = KeyType::kInteger,
                             .min = 2,
                             .max = 10000,
                             .default_text = "15",
                             .help = "steps of the front; with three objectives or more, of all "
                                     "but the first together"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.pareto_points = static_cast<int>(v.integer);
                  }});
  append_density_key<Input>(
      keys, [](Input& t) -> std::optional<double>& { return t.spec.bodies.density_kgm3; });
  for (const std::size_t stage : {0U, 1U}) {
    append_face_width_key<Input>(keys, stage, [stage](Input& t) -> std::optional<double>& {
      return t.spec.bodies.face_width_m[stage];
    });
  }
  keys.push_back({.record = {.path = "size.ring_rim_mm",
                             .type = KeyType::kNumber,
                             .unit = "mm",
                             .min = 0.0,
                             .max = 1000.0,
                             .default_text = "0",
                             .help = "rim of both rings outside their root circles, for mass, "
                                     "inertia and outer diameter"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.bodies.ring_rim_m = v.number * units::kMillimetre;
                  }});
}

void append_tooth_keys(std::vector<Key<Input>>& keys) {
  struct Range {
    const char* name;
    optimize::IntegerRange optimize::ToothRanges::*member;
  };
  static constexpr std::array<Range, 3> kRanges{{{"S", &optimize::ToothRanges::S},
                                                 {"P1", &optimize::ToothRanges::P1},
                                                 {"P2", &optimize::ToothRanges::P2}}};
  for (const Range& r : kRanges) {
    keys.push_back({.record = {.path = fmt::format("teeth.{}", r.name),
                               .type = KeyType::kIntegerRange,
                               .min = 4,
                               .max = 500,
                               .required = true,
                               .help = fmt::format("teeth of {}, both ends included", r.name)},
                    .assign = [member = r.member](Input& t, std::size_t, const TomlValue& v) {
                      t.spec.teeth.*member = integer_range(v);
                    }});
  }
  struct Single {
    const char* name;
    int optimize::ToothRanges::*member;
    double min, max;
    const char* default_text;
    const char* help;
  };
  static constexpr std::array<Single, 4> kSingles{
      {{"R1_max", &optimize::ToothRanges::R1_max, 5, 2000, "", "most teeth of ring R1"},
       {"R2_max", &optimize::ToothRanges::R2_max, 5, 2000, "", "most teeth of ring R2"},
       {"max_coaxial_offset", &optimize::ToothRanges::max_coaxial_offset, 0, 100, "4",
        "greatest |zR1 - (zS + 2 zP1)|"},
       {"min_internal_difference", &optimize::ToothRanges::min_internal_difference, 1, 100, "8",
        "least zR - zP of both internal meshes"}}};
  for (const Single& s : kSingles) {
    keys.push_back({.record = {.path = fmt::format("teeth.{}", s.name),
                               .type = KeyType::kInteger,
                               .min = s.min,
                               .max = s.max,
                               .required = std::string_view(s.default_text).empty(),
                               .default_text = s.default_text,
                               .help = s.help},
                    .assign = [member = s.member](Input& t, std::size_t, const TomlValue& v) {
                      t.spec.teeth.*member = static_cast<int>(v.integer);
                    }});
  }
}

/// The keys of a DESIGN's operating point.
void append_operating_point_keys(std::vector<Key<Input>>& keys) {
  for (const LossNumber& n : loss_numbers()) {
    if (!n.record.path.starts_with("operating_point.")) continue;
    KeyRecord record = n.record;
    record.help += "; read with --model, which judges the refined sets there";
    keys.push_back(
        {.record = std::move(record), .assign = [&n](Input& t, std::size_t, const TomlValue& v) {
           n.member(t.losses) = v.number * n.per_unit + n.offset;
         }});
  }
}

Schema<Input> specification_schema() {
  Schema<Input> schema{.gears = {train::kGearNames.begin(), train::kGearNames.end()}, .keys = {}};
  auto& keys = schema.keys;
  keys.push_back(
      {.record = {.path = "name",
                  .type = KeyType::kText,
                  .default_text = "\"\"",
                  .help = "name in tables and results"},
       .assign = [](Input& t, std::size_t, const TomlValue& v) { t.spec.name = v.text; }});
  keys.push_back({.record = {.path = "planets",
                             .type = KeyType::kIntegers,
                             .min = 1,
                             .max = 24,
                             .default_text = "3",
                             .help = "number of equally spaced planets, or a list to try"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.planets.clear();
                    if (v.kind != TomlValue::Kind::kList) {
                      t.spec.planets.push_back(static_cast<int>(v.integer));
                    }
                    for (const TomlValue& e : v.list) {
                      t.spec.planets.push_back(static_cast<int>(e.integer));
                    }
                    sort_and_unify(t.spec.planets);
                  }});
  append_model_keys<Input>(keys, [](Input& t) {
    return ModelInput{t.spec.pressure_angle_rad, t.spec.rack, t.spec.friction};
  });
  append_objective_keys(keys);
  keys.push_back({.record = {.path = "tip_shortening",
                             .type = KeyType::kNumberPerGear,
                             .unit = "modules",
                             .min = 0.0,
                             .max = 1.5,
                             .default_text = "0",
                             .help = "shortening of the teeth at their tips, on rings too"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.tip_shortening = per_gear(v);
                  }});
  for (const std::size_t gear : {train::kS, train::kP1}) {
    keys.push_back({.record = {.path = fmt::format("tip_rule.{}", train::kGearNames[gear]),
                               .type = KeyType::kChoice,
                               .choices = {"full", "khk"},
                               .default_text = "\"full\"",
                               .help = "full = tip_shortening as stated; khk = x1 + x2 - y of mesh "
                                       "S-P1 instead"},
                    .assign = [gear](Input& t, std::size_t, const TomlValue& v) {
                      t.spec.khk_tip[gear] = v.text == "khk";
                    }});
  }
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    append_cutter_keys<Input>(
        keys, fmt::format("cutter.{}", train::kGearNames[ring]),
        [ring](Input& t, std::size_t) -> geometry::PinionCutter& { return t.spec.cutter[ring]; });
  }
  append_axial_keys<Input>(keys, [](Input& t) -> train::AxialLayout& { return t.spec.axial; });
  keys.push_back({.record = {.path = "ratio.target",
                             .type = KeyType::kNumber,
                             .min = -1e5,
                             .max = 1e5,
                             .required = true,
                             .help = "w_S/w_R2; negative = output turns against the input"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.ratio.target = v.number;
                  }});
  keys.push_back({.record = {.path = "ratio.tolerance",
                             .type = KeyType::kNumber,
                             .min = 0.0,
                             .max = 0.5,
                             .default_text = "0.005",
                             .help = "greatest |ratio/target - 1|"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.ratio.tolerance = v.number;
                  }});
  append_tooth_keys(keys);
  for (const std::size_t stage : {0U, 1U}) {
    keys.push_back(
        {.record = {.path = fmt::format("module.stage{}_mm", stage + 1),
                    .type = KeyType::kModule,
                    .unit = "mm",
                    .min = 0.0,
                    .max = 100.0,
                    .min_excluded = true,
                    .required = true,
                    .help = stage == 0 ? "module of S, P1, R1: refined in a range, chosen from a "
                                         "series, or given"
                                       : "module of P2, R2, in the same way"},
         .assign = [stage](Input& t, std::size_t, const TomlValue& v) {
           t.spec.module[stage] = module_choice(v);
         }});
  }
  keys.push_back({.record = {.path = "profile_shift.range",
                             .type = KeyType::kNumberRange,
                             .unit = "modules",
                             .min = -5.0,
                             .max = 5.0,
                             .default_text = "[0, 1]",
                             .help = "profile shift of every gear"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.profile_shift = {.min = v.list[0].number, .max = v.list[1].number};
                  }});
  append_free_keys(keys);
  keys.push_back({.record = {.path = "backlash.machining_allowance",
                             .type = KeyType::kNumberPerGear,
                             .unit = "modules",
                             .min = 0.0,
                             .max = 1.0,
                             .default_text = "0",
                             .help = "q: normal thinning of the whole tooth over the module"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.machining_allowance = per_gear(v);
                  }});
  keys.push_back(
      {.record = {.path = "solver.refine",
                  .type = KeyType::kChoice,
                  .choices = {optimize::kRefineNames.begin(), optimize::kRefineNames.end()},
                  .default_text = "\"slsqp\"",
                  .help = "slsqp = in all threads; ipopt = one at a time; both = SLSQP "
                          "polished by Ipopt"},
       .assign = [](Input& t, std::size_t, const TomlValue& v) {
         t.spec.solver.refine =
             static_cast<optimize::Refine>(index_of(optimize::kRefineNames, v.text));
       }});
  keys.push_back({.record = {.path = "solver.starts",
                             .type = KeyType::kInteger,
                             .min = 1,
                             .max = 1000,
                             .default_text = "4",
                             .help = "starting points per tooth set"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.solver.starts = static_cast<int>(v.integer);
                  }});
  keys.push_back({.record = {.path = "solver.seed",
                             .type = KeyType::kInteger,
                             .min = 0,
                             .max = 9007199254740992.0,
                             .default_text = "1",
                             .help = "seed of the starting points after the fourth"},
                  .assign = [](Input& t, std::size_t, const TomlValue& v) {
                    t.spec.solver.seed = static_cast<unsigned long long>(v.integer);
                  }});
  append_operating_point_keys(keys);
  append_limit_keys<Input>(keys, &Input::limits, false);
  append_tolerance_keys<Input>(keys, [](Input& t) -> ToleranceInput& { return t.tolerances; });
  append_robust_keys<Input>(keys, [](Input& t) -> optimize::Robust& { return t.spec.robust; });
  return schema;
}

void check_objectives(const optimize::Specification& spec, FileReading& reading) {
  for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
    const auto name = optimize::objective_record(spec.objectives[k]).name;
    const auto first =
        std::find(spec.objectives.begin(), spec.objectives.end(), spec.objectives[k]);
    if (first != spec.objectives.begin() + static_cast<std::ptrdiff_t>(k)) {
      reading.error_at("objective",
                       fmt::format("objective: \"{}\" twice: allowed: each once", name));
    }
    const bool needs_masses = spec.objectives[k] == optimize::Objective::kMass ||
                              spec.objectives[k] == optimize::Objective::kInertia;
    if (needs_masses && !optimize::knows_masses(spec)) {
      reading.error_at("objective",
                       fmt::format("objective \"{}\" without inertia.density_kg_m3, "
                                   "stage1.face_width_mm and stage2.face_width_mm: allowed: with "
                                   "all three",
                                   name));
    }
  }
}

void check_relations(const Input& input, FileReading& reading) {
  const optimize::Specification& spec = input.spec;
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
                                 design::in_unit(*least, design::Unit::kArcmin),
                                 design::in_unit(*most, design::Unit::kArcmin)));
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
  check_rack(spec.rack, spec.pressure_angle_rad, reading);
  check_friction(spec.friction, reading);
  check_cutter("cutter.R1", spec.cutter[train::kR1], teeth.R1_max, reading);
  check_cutter("cutter.R2", spec.cutter[train::kR2], teeth.R2_max, reading);
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

optimize::Specification specification_from(const TomlValue& document, const std::string& name) {
  FileReading reading(name);
  Input input;
  input.spec.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  input.spec.ratio.tolerance = 0.005;
  read_by_schema(document, specification_schema(), input, reading);
  input.spec.limits = finish_limits(input.limits, reading);
  check_relations(input, reading);
  check_robust(input.spec, input.tolerances, reading);
  if (input.tolerances.stated) input.spec.tolerances = stated_tolerances(input.tolerances);
  input.spec.sampling = input.tolerances.sampling;
  reading.throw_if_invalid();
  if (reading.has("operating_point.sun_speed_rpm")) {
    input.spec.operating_point = input.losses.operating_point;
  }
  return input.spec;
}

}  // namespace

optimize::Specification read_specification(const std::string& path) {
  return specification_from(read_toml(path), path);
}

optimize::Specification parse_specification(const std::string& text, const std::string& name) {
  return specification_from(parse_toml(text, name), name);
}

std::string specification_key_table() { return key_table(specification_schema()); }

}  // namespace gear3k::io
