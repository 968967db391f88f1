#include "io/keys/design_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/keys/axial_keys.hpp"
#include "io/keys/cutter_keys.hpp"
#include "io/keys/mass_keys.hpp"
#include "io/keys/model_keys.hpp"

namespace gear3k::io {

namespace {

using units::Unit;

/// @param friction  the view of the friction
template <class Target, class View>
std::vector<Key<Target>> common_keys(View friction) {
  std::vector<Key<Target>> keys{
      make_key<Target>(
          {.path = "name",
           .type = KeyType::kText,
           .default_text = "\"\"",
           .help = "name in tables and results"},
          [](auto& t, std::size_t) -> auto& { return t.name; }),
      make_key<Target>(
          {.path = "sign_convention",
           .type = KeyType::kChoice,
           .choices = {"khk", "iso21771"},
           .default_text = "\"khk\"",
           .help = "rings: khk = teeth positive, shift positive outwards; iso21771 = "
                   "teeth negative, shift of the opposite sign"},
          [](auto& t, std::size_t) -> auto& { return t.iso; }),
      make_key<Target>(
          {.path = "center_distance_mm",
           .unit = Unit::kMillimetre,
           .min = 0.0,
           .max = 1e5,
           .min_excluded = true,
           .default_text = "zero-backlash distance",
           .help = "centre distance of all meshes; without it the zero-backlash "
                   "distance (of mesh P1-R1 in a train) at q = 0",
           .input = design::InputId{design::InputKind::kCenterDistance}},
          [](auto& t, std::size_t) -> auto& { return t.center_distance_m; }),
      make_key<Target>(
          pressure_angle_record(),
          [](auto& t, std::size_t) -> auto& { return t.pressure_angle_rad; })};
  append_keys(
      keys, rack_keys(), [](auto& t, std::size_t) -> auto& { return t.rack; });
  append_keys(keys, friction_keys(), friction);
  return keys;
}

std::vector<Key<GearInput>> gear_keys() {
  using Gear = GearInput;
  std::vector<Key<Gear>> keys{
      make_key<Gear>(
          {.path = "teeth",
           .type = KeyType::kInteger,
           .min = -2000,
           .max = 2000,
           .required = true,
           .help = "number of teeth, at least 3 (rings: negative with iso21771)"},
          [](auto& t, std::size_t) -> auto& { return t.teeth; }),
      make_key<Gear>(
          {.path = "profile_shift",
           .unit = Unit::kModules,
           .min = -5.0,
           .max = 5.0,
           .default_text = "0",
           .help = "profile shift coefficient",
           .input = design::InputId{design::InputKind::kProfileShift}},
          [](auto& t, std::size_t) -> auto& { return t.profile_shift; }),
      make_key<Gear>(
          {.path = "machining_allowance",
           .unit = Unit::kModules,
           .min = 0.0,
           .max = kGreatestAllowance,
           .default_text = "0",
           .help = "q: normal thinning of the whole tooth over the module",
           .input = design::InputId{design::InputKind::kMachiningAllowance}},
          [](auto& t, std::size_t) -> auto& { return t.machining_allowance; }),
      make_key<Gear>(
          {.path = "normal_thinning_um",
           .unit = Unit::kMicrometre,
           .min = 0.0,
           .max = 1e5,
           .default_text = "none",
           .help = "the same as a length, instead of machining_allowance"},
          [](auto& t, std::size_t) -> auto& { return t.normal_thinning_m; }),
      make_key<Gear>(
          {.path = "tip_shortening",
           .unit = Unit::kModules,
           .min = 0.0,
           .max = design::kGreatestTipShortening,
           .default_text = "0",
           .help = "shortening of the tooth at its tip, on rings too",
           .input = design::InputId{design::InputKind::kTipShortening}},
          [](auto& t, std::size_t) -> auto& { return t.tip_shortening; },
          [](const Gear& g, std::size_t) { return !g.khk_tip; }),
      unless_default(make_key<Gear>(
          {.path = "tip_rule",
           .type = KeyType::kChoice,
           .choices = {"full", "khk"},
           .default_text = "\"full\"",
           .help = "full = tip_shortening as stated; khk = x1 + x2 - y of the external mesh "
                   "instead, for its two gears"},
          [](auto& t, std::size_t) -> auto& { return t.khk_tip; })),
      make_key<Gear>(
          {.path = "pin_diameter_mm",
           .unit = Unit::kMillimetre,
           .min = 0.0,
           .max = 1000.0,
           .min_excluded = true,
           .default_text = "by geometry",
           .help = "measuring pin; without it the one that touches on the circle d + 2 "
                   "x m, rounded up to 0.01 mm"},
          [](auto& t, std::size_t) -> auto& { return t.pin_diameter_m; })};
  append_keys(
      keys, cutter_keys(), [](auto& t, std::size_t) -> auto& { return t.cutter; }, "cutter.");
  return keys;
}

}  // namespace

Schema<DesignInput> design_schema() {
  using Input = DesignInput;
  Schema<Input> schema{
      .gears = {train::kGearNames.begin(), train::kGearNames.end()},
      .keys = common_keys<Input>([](auto& t, std::size_t) -> auto& { return t.losses.friction; }),
      .order = {"name",
                "planets",
                "identical_planets",
                "pressure_angle_deg",
                "center_distance_mm",
                "sign_convention",
                "rack",
                "stage1",
                "stage2",
                "gears",
                "axial",
                "inertia",
                "friction",
                "tolerances",
                "lubricant",
                "drag",
                "bearings",
                "operating_point",
                "map",
                "backlash.model",
                "backlash.min_normal_um",
                "backlash",
                "contact_ratio",
                "size",
                "limits"}};
  auto& keys = schema.keys;
  keys.push_back(make_key<Input>(
      {.path = "planets",
       .type = KeyType::kInteger,
       .min = 1,
       .max = 24,
       .default_text = "3",
       .help = "number of equally spaced planets"},
      [](auto& t, std::size_t) -> auto& { return t.planets; }));
  for (const std::size_t stage : {0U, 1U}) {
    keys.push_back(make_key<Input>(
        {.path = fmt::format("stage{}.module_mm", stage + 1),
         .unit = Unit::kMillimetre,
         .min = 0.0,
         .max = 100.0,
         .min_excluded = true,
         .required = true,
         .help = stage == 0 ? "module of S, P1, R1" : "module of P2, R2",
         .input = design::InputId{design::InputKind::kModule, stage}},
        [stage](auto& t, std::size_t) -> auto& { return t.module_m[stage]; }));
    keys.push_back(make_key<Input>(
        face_width_record(stage), [stage](auto& t, std::size_t) -> auto& {
          return t.masses.face_width_m[stage];
        }));
  }
  append_keys(
      keys, gear_keys(), [](auto& t, std::size_t gear) -> auto& { return t.gears[gear]; },
      "gears.{gear}.");
  keys.push_back(unless_default(make_key<Input>(
      {.path = "gears.{gear}.bore_mm",
       .unit = Unit::kDiameterMillimetre,
       .min = 0.0,
       .max = 1000.0,
       .default_text = "0",
       .help = "bore diameter of an external gear, for its mass and inertia"},
      [](auto& t, std::size_t gear) -> auto& { return t.masses.bore_radius_m[gear]; })));
  keys.push_back(make_key<Input>(
      {.path = "gears.{gear}.outer_diameter_mm",
       .unit = Unit::kDiameterMillimetre,
       .min = 0.0,
       .max = 10000.0,
       .min_excluded = true,
       .default_text = "none",
       .help = "outer diameter of ring R1 or R2, for its mass and inertia"},
      [](auto& t, std::size_t gear) -> auto& { return t.outer_radius_m[gear]; }));
  append_keys(
      keys, mass_keys(), [](auto& t, std::size_t) -> auto& { return t.masses; });
  append_keys(
      keys, axial_keys(), [](auto& t, std::size_t) -> auto& { return t.axial; });
  std::vector<Key<LossInput>> losses;
  for (const LossKey& k : loss_keys()) losses.push_back(k.key);
  append_keys(
      keys, losses, [](auto& t, std::size_t) -> auto& { return t.losses; });
  append_keys(
      keys, tolerance_keys(), [](auto& t, std::size_t) -> auto& { return t.tolerances; });
  append_keys(
      keys, limit_keys(false), [](auto& t, std::size_t) -> auto& { return t.limits; });
  return schema;
}

const std::string& key_of(const design::InputId& input) {
  struct InputKey {
    design::InputId input;
    std::string path;
  };
  static const std::vector<InputKey> keys = [] {
    std::vector<InputKey> list;
    const Schema<DesignInput> schema = design_schema();
    for (const ExpandedKey& key : expand_keys(records_of(schema), schema.gears)) {
      if (!key.record->input) continue;
      const auto [kind, index] = *key.record->input;
      list.push_back({.input = {.kind = kind, .index = index + key.gear}, .path = key.path});
    }
    return list;
  }();
  return std::ranges::find(keys, input, &InputKey::input)->path;
}

Schema<PairInput> pair_schema() {
  using Input = PairInput;
  Schema<Input> schema{
      .gears = {"gear1", "gear2"},
      .keys = common_keys<Input>([](auto& t, std::size_t) -> auto& { return t.friction; })};
  auto& keys = schema.keys;
  keys.push_back(make_key<Input>(
      {.path = "kind",
       .type = KeyType::kChoice,
       .choices = {"external", "internal"},
       .required = true,
       .help = "external: two external gears; internal: gear2 is the ring"},
      [](auto& t, std::size_t) -> auto& { return t.internal; }));
  keys.push_back(make_key<Input>(
      {.path = "module_mm",
       .unit = Unit::kMillimetre,
       .min = 0.0,
       .max = 100.0,
       .min_excluded = true,
       .required = true,
       .help = "module of both gears"},
      [](auto& t, std::size_t) -> auto& { return t.module_m; }));
  append_keys(
      keys, gear_keys(), [](auto& t, std::size_t gear) -> auto& { return t.gears[gear]; },
      "{gear}.");
  append_keys(
      keys, gear_tolerance_keys(true), [](auto& t, std::size_t) -> auto& { return t.tolerances; });
  append_keys(
      keys, limit_keys(true), [](auto& t, std::size_t) -> auto& { return t.limits; });
  return schema;
}

}  // namespace gear3k::io
