#include "io/keys/specification_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "io/keys/axial_keys.hpp"
#include "io/keys/cutter_keys.hpp"
#include "io/keys/mass_keys.hpp"
#include "io/keys/model_keys.hpp"
#include "io/keys/robust_keys.hpp"
#include "io/keys/round_keys.hpp"
#include "optimize/objective_value.hpp"

namespace gear3k::io {

namespace {

using Input = SpecificationInput;
using optimize::Specification, units::Unit;

template <class Number>
void sort_and_unify(std::vector<Number>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// The view of a member of the specification.
template <class Member>
auto of_spec(Member Specification::*member) {
  return [member](auto& t, std::size_t) -> auto& { return t.spec.*member; };
}

TomlValue member_value(std::string key, TomlValue value) {
  value.key = std::move(key);
  return value;
}

Key<Input> module_key(std::size_t stage) {
  return {.record = {.path = fmt::format("module.stage{}_mm", stage + 1),
                     .type = KeyType::kModule,
                     .unit = Unit::kMillimetre,
                     .min = 0.001,
                     .max = 100.0,
                     .required = true,
                     .help = stage == 0 ? "module of S, P1, R1: refined in a range, chosen from a "
                                          "series, or given"
                                        : "module of P2, R2, in the same way"},
          .assign =
              [stage](const KeyRecord& r, Input& t, std::size_t, const TomlValue& v) {
                optimize::ModuleChoice choice;
                if (v.is_number()) {
                  const double module_m = units::to_si(v.number, r.unit);
                  choice.range_m = optimize::NumberRange{.min = module_m, .max = module_m};
                } else if (v.table.size() == 1) {
                  store(r, v.table[0], choice.series_m);
                  sort_and_unify(choice.series_m);
                } else {
                  optimize::NumberRange& range = choice.range_m.emplace();
                  for (const TomlValue& end : v.table) {
                    store(r, end, end.key == "min" ? range.min : range.max);
                  }
                }
                t.spec.module[stage] = choice;
              },
          .state = [stage](const KeyRecord& r, const Input& t,
                           std::size_t) -> std::optional<TomlValue> {
            const optimize::ModuleChoice& choice = t.spec.module[stage];
            if (!choice.range_m) {
              const auto series = stated(r, choice.series_m);
              if (!series) return std::nullopt;
              return table_value({member_value("series", *series)});
            }
            const auto& [min, max] = *choice.range_m;
            if (min == max) return stated(r, min);
            return table_value(
                {member_value("min", *stated(r, min)), member_value("max", *stated(r, max))});
          }};
}

/// A face width, or a range of them of which the bodies have the least.
Key<Input> face_width_key(std::size_t stage) {
  KeyRecord record = face_width_record(stage);
  record.type = KeyType::kNumberOrMinMax;
  record.help =
      "face width, in a range refined where mass, inertia or strength ask for it; without "
      "it no mass or inertia from geometry";
  return {.record = std::move(record),
          .assign =
              [stage](const KeyRecord& r, Input& t, std::size_t, const TomlValue& v) {
                optimize::NumberRange range;
                if (v.is_number()) range.min = range.max = units::to_si(v.number, r.unit);
                for (const TomlValue& end : v.table) {
                  store(r, end, end.key == "min" ? range.min : range.max);
                }
                t.spec.bodies.face_width_m[stage] = range.min;
                if (range.min < range.max) t.spec.free.face_width_m[stage] = range;
              },
          .state = [stage](const KeyRecord& r, const Input& t,
                           std::size_t) -> std::optional<TomlValue> {
            const auto& range = t.spec.free.face_width_m[stage];
            if (!range) return stated(r, t.spec.bodies.face_width_m[stage]);
            return table_value({member_value("min", *stated(r, range->min)),
                                member_value("max", *stated(r, range->max))});
          }};
}

/// A number for all gears, or for each of them.
Key<Input> per_gear_key(KeyRecord record,
                        std::array<double, train::kGearCount> Specification::*member) {
  record.type = KeyType::kNumberPerGear;
  record.unit = Unit::kModules;
  return {.record = std::move(record),
          .assign =
              [member](const KeyRecord& r, Input& t, std::size_t, const TomlValue& v) {
                auto& values = t.spec.*member;
                values.fill(v.is_number() ? units::to_si(v.number, r.unit) : 0.0);
                for (const TomlValue& gear : v.table) {
                  store(r, gear, values[index_of(train::kGearNames, gear.key)]);
                }
              },
          .state =
              [member](const KeyRecord& r, const Input& t, std::size_t) {
                std::vector<TomlValue> gears;
                for (std::size_t i = 0; i < train::kGearCount; ++i) {
                  gears.push_back(member_value(std::string(train::kGearNames[i]),
                                               *stated(r, (t.spec.*member)[i])));
                }
                return table_value(std::move(gears));
              }};
}

std::vector<std::string> objective_names() {
  std::vector<std::string> names;
  for (const optimize::ObjectiveRecord& record : optimize::objective_records()) {
    names.emplace_back(record.name);
  }
  return names;
}

void append_objective_keys(std::vector<Key<Input>>& keys) {
  keys.push_back(make_key<Input>({.path = "objective",
                                  .type = KeyType::kChoices,
                                  .choices = objective_names(),
                                  .default_text = "\"backward_efficiency\"",
                                  .help = "what is best; a list asks for the Pareto front, the "
                                          "first of it picks best.toml"},
                                 of_spec(&Specification::objectives)));
  keys.push_back(make_key<Input>(integer("pareto.points", within(2, 10000), "30",
                                         "designs of the Pareto front that are sought where the "
                                         "objectives are several"),
                                 of_spec(&Specification::pareto_points)));
  keys.push_back(make_key<Input>(
      density_record(), [](auto& t, std::size_t) -> auto& { return t.spec.bodies.density_kgm3; }));
  for (const std::size_t stage : {0U, 1U}) {
    keys.push_back(face_width_key(stage));
  }
  keys.push_back(make_key<Input>(
      number("size.ring_rim_mm", Unit::kMillimetre, within(0.0, 1000.0), "0",
             "rim of both rings outside their root circles, for mass, inertia, outer diameter and "
             "the rims of [strength]"),
      [](auto& t, std::size_t) -> auto& { return t.spec.bodies.ring_rim_m; }));
  keys.push_back(make_key<Input>(
      number("size.sun_bore_mm", Unit::kDiameterMillimetre, within(0.0, 1000.0), "0",
             "bore diameter of the sun, for its wall, mass, inertia and rim"),
      [](auto& t, std::size_t) -> auto& { return t.spec.bodies.bore_radius_m[train::kS]; }));
  keys.push_back(make_key<Input>(
      number("size.planet_bore_mm", Unit::kDiameterMillimetre, within(0.0, 1000.0), "0",
             "bore diameter of P1 and P2, for their walls, masses, inertia and rims"),
      [](auto& t, std::size_t) -> auto& { return t.spec.bodies.bore_radius_m[train::kP1]; }));
}

void append_tip_keys(std::vector<Key<Input>>& keys) {
  keys.push_back(per_gear_key(
      number("tip_shortening", Unit::kNone, within(0.0, design::kGreatestTipShortening), "0",
             "shortening of the teeth at their tips, on rings too"),
      &Specification::tip_shortening));
  for (const std::size_t gear : {train::kS, train::kP1}) {
    keys.push_back(make_key<Input>(
        {.path = fmt::format("tip_rule.{}", train::kGearNames[gear]),
         .type = KeyType::kChoice,
         .choices = {"full", "khk"},
         .default_text = "\"full\"",
         .help = "full = tip_shortening as stated; khk = x1 + x2 - y of mesh S-P1 instead"},
        [gear](auto& t, std::size_t) -> auto& { return t.spec.khk_tip[gear]; }));
  }
}

void append_tooth_keys(std::vector<Key<Input>>& keys) {
  using optimize::ToothRanges;
  const auto add_range = [&](const char* name, optimize::IntegerRange ToothRanges::*member) {
    keys.push_back(make_key<Input>(
        {.path = fmt::format("teeth.{}", name),
         .type = KeyType::kIntegerRange,
         .min = 4,
         .max = 500,
         .required = true,
         .help = fmt::format("teeth of {}, both ends included", name)},
        [member](auto& t, std::size_t) -> auto& { return t.spec.teeth.*member; }));
  };
  add_range("S", &ToothRanges::S);
  add_range("P1", &ToothRanges::P1);
  add_range("P2", &ToothRanges::P2);
  const auto add = [&](KeyRecord record, int ToothRanges::*member) {
    record.type = KeyType::kInteger;
    record.required = record.default_text.empty();
    keys.push_back(make_key<Input>(
        std::move(record), [member](auto& t, std::size_t) -> auto& {
          return t.spec.teeth.*member;
        }));
  };
  add(number("teeth.R1_max", Unit::kNone, within(5, 2000), "", "most teeth of ring R1"),
      &ToothRanges::R1_max);
  add(number("teeth.R2_max", Unit::kNone, within(5, 2000), "", "most teeth of ring R2"),
      &ToothRanges::R2_max);
  add(number("teeth.max_coaxial_offset", Unit::kNone, within(0, 100), "4",
             "greatest |zR1 - (zS + 2 zP1)|"),
      &ToothRanges::max_coaxial_offset);
  add(number("teeth.min_internal_difference", Unit::kNone, within(1, 100), "8",
             "least zR - zP of both internal meshes"),
      &ToothRanges::min_internal_difference);
}

void append_ratio_keys(std::vector<Key<Input>>& keys) {
  keys.push_back(make_key<Input>(
      number("ratio.target", Unit::kNone, within(-1e5, 1e5), kRequired,
             "w_S/w_R2; negative = output turns against the input"),
      [](auto& t, std::size_t) -> auto& { return t.spec.ratio.target; }));
  keys.push_back(make_key<Input>(
      number("ratio.tolerance", Unit::kNone, within(0.0, 0.9), "0.005",
             "greatest |ratio/target - 1|"),
      [](auto& t, std::size_t) -> auto& { return t.spec.ratio.tolerance; }));
}

/// Profile shifts, and variables that are fixed unless a range is stated.
void append_free_keys(std::vector<Key<Input>>& keys) {
  const auto add = [&](KeyRecord record, auto view) {
    record.type = KeyType::kNumberRange;
    if (record.unit == Unit::kNone) record.unit = Unit::kModules;
    keys.push_back(make_key<Input>(std::move(record), view));
  };
  add(number("profile_shift.range", Unit::kNone, within(-5.0, 5.0), "[0, 1]",
             "profile shift of every gear"),
      of_spec(&Specification::profile_shift));
  add(number("profile_shift.ring_range", Unit::kNone, within(-5.0, 5.0), "profile_shift.range",
             "profile shift of R1 and R2"),
      of_spec(&Specification::ring_shift));
  keys.push_back(
      make_key<Input>(number("profile_shift.step", Unit::kModules, within(1e-3, 1.0), "none",
                             "profile shifts are multiples of it; without it any in their ranges"),
                      of_spec(&Specification::shift_step)));
  add(number("free.addendum", Unit::kNone, within(0.2, 2.0), "rack.addendum",
             "addendum of each gear, refined in this range; best.toml states it as rack.addendum "
             "less tip_shortening"),
      &Input::free_addendum);
  add(
      number("free.tip_shortening", Unit::kNone, within(0.0, design::kGreatestTipShortening),
             "tip_shortening", "tip shortening of each gear, refined in this range"),
      [](auto& t, std::size_t) -> auto& { return t.spec.free.tip_shortening; });
  add(
      number("free.pressure_angle_deg", Unit::kDegree, within(10.0, 35.0), "pressure_angle_deg",
             "pressure angle, refined in this range; without bounds then"),
      [](auto& t, std::size_t) -> auto& { return t.spec.free.pressure_angle_rad; });
}

void append_solver_keys(std::vector<Key<Input>>& keys) {
  keys.push_back(make_key<Input>(
      {.path = "solver.refine",
       .type = KeyType::kChoice,
       .choices = {optimize::kRefineNames.begin(), optimize::kRefineNames.end()},
       .default_text = "\"slsqp\"",
       .help = "slsqp = in all threads; ipopt = one at a time; both = SLSQP polished by Ipopt"},
      [](auto& t, std::size_t) -> auto& { return t.spec.solver.refine; }));
  keys.push_back(make_key<Input>(
      integer("solver.starts", within(1, 1000), "4", "starting points per tooth set"),
      [](auto& t, std::size_t) -> auto& { return t.spec.solver.starts; }));
  keys.push_back(make_key<Input>(
      integer("solver.seed", within(0, 9007199254740992.0), "1",
              "seed of the starting points after the fourth"),
      [](auto& t, std::size_t) -> auto& { return t.spec.solver.seed; }));
  keys.push_back(make_key<Input>(
      integer(
          "solver.grid_relaxations", within(1, 1e9), "20000",
          "with profile_shift.step: relaxations after which the search of one grid is cut short"),
      [](auto& t, std::size_t) -> auto& { return t.spec.solver.grid_relaxations; }));
}

/// The keys of a DESIGN's operating point.
std::vector<Key<LossInput>> operating_point_keys() {
  std::vector<Key<LossInput>> keys;
  for (const LossKey& k : loss_keys()) {
    if (!k.key.record.path.starts_with("operating_point.")) continue;
    keys.push_back(k.key);
    const bool speed = keys.back().record.path == "operating_point.sun_speed_rpm";
    keys.back().record.help +=
        fmt::format("; read with --model, which judges the refined sets there{}",
                    speed ? ", and by [strength]" : "");
  }
  return keys;
}

/// Those of a DESIGN; grades, of which only gears of known modules and teeth have deviations, are
/// refused (check_robust).
std::vector<Key<ToleranceInput>> task_tolerance_keys() {
  std::vector<Key<ToleranceInput>> keys = tolerance_keys();
  for (Key<ToleranceInput>& key : keys) {
    KeyRecord& record = key.record;
    if (record.default_text == "that of accuracy_grade, else 0") record.default_text = "0";
    if (!record.path.ends_with(".accuracy_grade")) continue;
    record.default_text = "none: of a DESIGN only";
    record.help =
        "refused in a SPEC, whose gears are not known: state runout_um, cumulative_pitch_um and "
        "single_pitch_um";
  }
  return keys;
}

/// Makes the number of teeth of a ring's cutter a list to choose from.
void choose_from_cutters(std::size_t ring, std::vector<Key<Input>>& keys) {
  const std::string path = fmt::format("cutter.{}.teeth", train::kGearNames[ring]);
  const auto key =
      std::ranges::find_if(keys, [&](const Key<Input>& k) { return k.record.path == path; });
  key->record.type = KeyType::kIntegers;
  key->record.help =
      "teeth of the pinion cutter that shapes the ring, or of all at hand (one profile_shift, one "
      "tip_radius), of which optimize chooses; fewer than the ring's; without it the ring's root "
      "is filleted by an arc of rack.root_radius";
  key->assign = [ring](const KeyRecord& r, Input& t, std::size_t, const TomlValue& v) {
    std::vector<int> teeth;
    store(r, v, teeth);
    sort_and_unify(teeth);
    if (teeth.empty()) return;
    t.spec.cutter[ring].teeth = teeth.front();
    t.spec.cutter_teeth[ring] = std::move(teeth);
  };
  key->state = [ring](const KeyRecord& r, const Input& t, std::size_t) {
    const std::vector<int>& listed = t.spec.cutter_teeth[ring];
    return stated(r, listed.empty() ? std::vector{t.spec.cutter[ring].teeth} : listed);
  };
}

std::vector<Key<Input>> specification_keys() {
  std::vector<Key<Input>> keys;
  keys.push_back(make_key<Input>({.path = "name",
                                  .type = KeyType::kText,
                                  .default_text = "\"\"",
                                  .help = "name in tables and results"},
                                 of_spec(&Specification::name)));
  keys.push_back(make_key<Input>({.path = "planets",
                                  .type = KeyType::kIntegers,
                                  .min = 1,
                                  .max = 24,
                                  .default_text = "3",
                                  .help = "number of equally spaced planets, or a list to try"},
                                 of_spec(&Specification::planets)));
  keys.back().assign = [store_list = keys.back().assign](const KeyRecord& r, Input& t,
                                                         std::size_t gear, const TomlValue& v) {
    store_list(r, t, gear, v);
    sort_and_unify(t.spec.planets);
  };
  keys.push_back(
      make_key<Input>(pressure_angle_record(), of_spec(&Specification::pressure_angle_rad)));
  append_keys(keys, rack_keys(), of_spec(&Specification::rack));
  append_keys(keys, friction_keys(), of_spec(&Specification::friction));
  append_objective_keys(keys);
  append_tip_keys(keys);
  for (const std::size_t ring : {train::kR1, train::kR2}) {
    append_keys(
        keys, cutter_keys(), [ring](auto& t, std::size_t) -> auto& { return t.spec.cutter[ring]; },
        fmt::format("cutter.{}.", train::kGearNames[ring]));
    choose_from_cutters(ring, keys);
  }
  append_keys(keys, axial_keys(), of_spec(&Specification::axial));
  append_keys(keys, thermal_keys(), &Input::thermal);
  append_ratio_keys(keys);
  append_tooth_keys(keys);
  for (const std::size_t stage : {0U, 1U}) keys.push_back(module_key(stage));
  append_free_keys(keys);
  keys.push_back(per_gear_key(number("backlash.machining_allowance", Unit::kNone, within(0.0, 1.0),
                                     "0", "q: normal thinning of the whole tooth over the module"),
                              &Specification::machining_allowance));
  keys.push_back(make_key<Input>(
      thickness_allowance_record("backlash.{gear}.A_sn_um"),
      [](auto& t, std::size_t gear) -> auto& { return t.spec.thickness_allowance_m[gear]; }));
  append_solver_keys(keys);
  append_keys(keys, operating_point_keys(), &Input::losses);
  append_keys(keys, train_strength_keys(), &Input::strength);
  append_keys(keys, limit_keys(false), &Input::limits);
  append_keys(keys, task_tolerance_keys(), &Input::tolerances);
  append_keys(keys, robust_keys(), of_spec(&Specification::robust));
  append_keys(keys, round_keys(), of_spec(&Specification::round));
  append_keys(keys, co_design_keys(), &Input::co_design);
  return keys;
}

}  // namespace

SpecificationInput::SpecificationInput() {
  spec.pressure_angle_rad = units::to_si(20.0, Unit::kDegree);
  spec.ratio.tolerance = 0.005;
}

const Schema<Input>& specification_schema() {
  static const Schema<Input> schema({train::kGearNames.begin(), train::kGearNames.end()},
                                    specification_keys());
  return schema;
}

}  // namespace gear3k::io
