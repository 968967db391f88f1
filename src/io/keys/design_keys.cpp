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
      make_key<Target>({.path = "name",
                        .type = KeyType::kText,
                        .default_text = "\"\"",
                        .help = "name in tables and results"},
                       &Target::name),
      make_key<Target>({.path = "sign_convention",
                        .type = KeyType::kChoice,
                        .choices = {"khk", "iso21771"},
                        .default_text = "\"khk\"",
                        .help = "rings: khk = teeth positive, shift positive outwards; iso21771 = "
                                "teeth negative, shift of the opposite sign"},
                       &Target::iso),
      make_key<Target>(
          number("center_distance_mm", Unit::kMillimetre, above(0.0, 1e5), "zero-backlash distance",
                 "centre distance of all meshes; without it the zero-backlash "
                 "distance (of mesh P1-R1 in a train) at q = 0",
                 {design::InputKind::kCenterDistance}),
          &Target::center_distance_m),
      make_key<Target>(pressure_angle_record(), &Target::pressure_angle_rad)};
  append_keys(keys, rack_keys(), &Target::rack);
  append_keys(keys, friction_keys(), friction);
  return keys;
}

std::vector<Key<GearInput>> gear_keys() {
  using Gear = GearInput;
  std::vector<Key<Gear>> keys{
      make_key<Gear>(integer("teeth", within(-2000, 2000), kRequired,
                             "number of teeth, at least 3 (rings: negative with iso21771)"),
                     &Gear::teeth),
      make_key<Gear>(number("profile_shift", Unit::kModules, within(-5.0, 5.0), "0",
                            "profile shift coefficient", {design::InputKind::kProfileShift}),
                     &Gear::profile_shift),
      make_key<Gear>(number("machining_allowance", Unit::kModules, within(0.0, kGreatestAllowance),
                            "0", "q: normal thinning of the whole tooth over the module",
                            {design::InputKind::kMachiningAllowance}),
                     &Gear::machining_allowance,
                     [](const Gear& g, std::size_t) { return !g.thickness_allowance_m; }),
      make_key<Gear>(number("normal_thinning_um", Unit::kMicrometre, within(0.0, 1e5), "none",
                            "the same as a length, instead of machining_allowance"),
                     &Gear::normal_thinning_m),
      make_key<Gear>(thickness_allowance_record("A_sn_um"), &Gear::thickness_allowance_m),
      make_key<Gear>(
          number("tip_shortening", Unit::kModules, within(0.0, design::kGreatestTipShortening), "0",
                 "shortening of the tooth at its tip, on rings too",
                 {design::InputKind::kTipShortening}),
          &Gear::tip_shortening, [](const Gear& g, std::size_t) { return !g.khk_tip; }),
      unless_default(make_key<Gear>(
          {.path = "tip_rule",
           .type = KeyType::kChoice,
           .choices = {"full", "khk"},
           .default_text = "\"full\"",
           .help = "full = tip_shortening as stated; khk = x1 + x2 - y of the external mesh "
                   "instead, for its two gears"},
          &Gear::khk_tip)),
      make_key<Gear>(number("pin_diameter_mm", Unit::kMillimetre, above(0.0, 1000.0), "by geometry",
                            "measuring pin; without it the one that touches on the circle d + 2 "
                            "x m, rounded up to 0.01 mm"),
                     &Gear::pin_diameter_m)};
  append_keys(keys, cutter_keys(), &Gear::cutter, "cutter.");
  return keys;
}

/// Keys and tables in the order of a written DESIGN.
std::vector<std::string> file_order() {
  return {"name",
          "planets",
          "identical_planets",
          "preset",
          "pressure_angle_deg",
          "center_distance_mm",
          "sign_convention",
          "rack",
          "stage1",
          "stage2",
          "gears",
          "material",
          "axial",
          "thermal",
          "inertia",
          "friction",
          "tolerances",
          "lubricant",
          "drag",
          "bearings",
          "operating_point",
          "strength",
          "map",
          "backlash.model",
          "backlash.min_normal_um",
          "backlash",
          "contact_ratio",
          "size",
          "allowed_teeth",
          "limits"};
}

std::vector<Key<DesignInput>> keys_of_design() {
  using KeyTarget = DesignInput;
  auto keys =
      common_keys<KeyTarget>([](auto& t, std::size_t) -> auto& { return t.losses.friction; });
  keys.push_back(make_key<KeyTarget>(
      integer("planets", within(1, 24), "3", "number of equally spaced planets"),
      &KeyTarget::planets));
  for (const std::size_t stage : {0U, 1U}) {
    keys.push_back(make_key<KeyTarget>(
        number(fmt::format("stage{}.module_mm", stage + 1), Unit::kMillimetre, within(0.001, 100.0),
               kRequired, stage == 0 ? "module of S, P1, R1" : "module of P2, R2",
               {design::InputKind::kModule, stage}),
        [stage](auto& t, std::size_t) -> auto& { return t.module_m[stage]; }));
    keys.push_back(make_key<KeyTarget>(
        face_width_record(stage), [stage](auto& t, std::size_t) -> auto& {
          return t.masses.face_width_m[stage];
        }));
  }
  append_keys(
      keys, gear_keys(), [](auto& t, std::size_t gear) -> auto& { return t.gears[gear]; },
      "gears.{gear}.");
  keys.push_back(unless_default(make_key<KeyTarget>(
      number("gears.{gear}.bore_mm", Unit::kDiameterMillimetre, within(0.0, 1000.0), "0",
             "bore diameter of an external gear, for its mass, inertia and rim"),
      [](auto& t, std::size_t gear) -> auto& { return t.masses.bore_radius_m[gear]; })));
  keys.push_back(make_key<KeyTarget>(
      number("gears.{gear}.outer_diameter_mm", Unit::kDiameterMillimetre, above(0.0, 10000.0),
             "none", "outer diameter of ring R1 or R2, for its mass, inertia and rim"),
      [](auto& t, std::size_t gear) -> auto& { return t.outer_radius_m[gear]; }));
  append_keys(keys, mass_keys(), &KeyTarget::masses);
  append_keys(keys, axial_keys(), &KeyTarget::axial);
  append_keys(keys, thermal_keys(), &KeyTarget::thermal);
  std::vector<Key<LossInput>> losses;
  for (const LossKey& k : loss_keys()) losses.push_back(k.key);
  append_keys(keys, losses, &KeyTarget::losses);
  append_keys(keys, train_strength_keys(), &KeyTarget::strength);
  append_keys(keys, tolerance_keys(), &KeyTarget::tolerances);
  append_keys(keys, limit_keys(false), &KeyTarget::limits);
  return keys;
}

std::vector<Key<PairInput>> keys_of_pair() {
  using KeyTarget = PairInput;
  auto keys = common_keys<KeyTarget>(&KeyTarget::friction);
  keys.push_back(
      make_key<KeyTarget>({.path = "kind",
                           .type = KeyType::kChoice,
                           .choices = {"external", "internal"},
                           .required = true,
                           .help = "external: two external gears; internal: gear2 is the ring"},
                          &KeyTarget::internal));
  keys.push_back(make_key<KeyTarget>(number("module_mm", Unit::kMillimetre, within(0.001, 100.0),
                                            kRequired, "module of both gears"),
                                     &KeyTarget::module_m));
  append_keys(
      keys, gear_keys(), [](auto& t, std::size_t gear) -> auto& { return t.gears[gear]; },
      "{gear}.");
  append_keys(keys, pair_strength_keys(), &KeyTarget::strength);
  append_keys(keys, gear_tolerance_keys(true), &KeyTarget::tolerances);
  append_keys(keys, limit_keys(true), &KeyTarget::limits);
  return keys;
}

}  // namespace

const Schema<DesignInput>& design_schema() {
  static const Schema<DesignInput> schema({train::kGearNames.begin(), train::kGearNames.end()},
                                          keys_of_design(), file_order());
  return schema;
}

const Schema<PairInput>& pair_schema() {
  static const Schema<PairInput> schema({"gear1", "gear2"}, keys_of_pair());
  return schema;
}

const std::string& key_of(const design::InputId& input) {
  struct InputKey {
    design::InputId input;
    std::string path;
  };
  static const std::vector<InputKey> keys = [] {
    std::vector<InputKey> list;
    for (const ExpandedKey& key : design_schema().index().keys) {
      if (!key.record->input) continue;
      const auto [kind, index] = *key.record->input;
      list.push_back({.input = {.kind = kind, .index = index + key.gear}, .path = key.path});
    }
    return list;
  }();
  return std::ranges::find(keys, input, &InputKey::input)->path;
}

}  // namespace gear3k::io
