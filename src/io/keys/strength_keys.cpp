#include "io/keys/strength_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "io/keys/temperature_range.hpp"

namespace gear3k::io {

namespace {

using strength::MeshLoadSource, strength::RatingTask, strength::StatedFactors,
    strength::StatedTeeth, units::Unit;
using StrengthKey = Key<StrengthInput>;

constexpr double kGreatestFactor = 1000.0;
constexpr int kFinestAccuracy = 3, kCoarsestAccuracy = 8;

const char* const kWhenStated = "none";

/// The view of a member of the task.
template <class Member>
auto of_task(Member RatingTask::*member) {
  return [member](auto& t, std::size_t) -> auto& { return t.task.*member; };
}
template <class Member>
auto of_factors(Member StatedFactors::*member) {
  return [member](auto& t, std::size_t) -> auto& { return t.task.factors.*member; };
}

template <class View>
StrengthKey strength_number(const char* name, Unit unit, const Range& range,
                            const char* default_text, const std::string& help, View view) {
  return unless_default(make_key<StrengthInput>(
      number(fmt::format("strength.{}", name), unit, range, default_text, help), view));
}

template <class View>
StrengthKey strength_switch(const char* name, const char* default_text, const char* help,
                            View view) {
  return unless_default(make_key<StrengthInput>({.path = fmt::format("strength.{}", name),
                                                 .type = KeyType::kBoolean,
                                                 .default_text = default_text,
                                                 .help = help},
                                                view));
}

StrengthKey train_mesh_load_key() {
  return unless_default(StrengthKey{
      .record = {.path = "strength.k_gamma",
                 .type = KeyType::kNumberOrChoice,
                 .min = 1.0,
                 .max = kGreatestFactor,
                 .choices = {strength::kMeshLoadSourceNames.begin() + 1,
                             strength::kMeshLoadSourceNames.end()},
                 .default_text = "with [strength]: 1",
                 .help = "K_gamma, the share of the most loaded planet: a number, or a table's for "
                         "3 planets and more: m56 1.0, 1.2, 1.3, 1.4, drivetrain 1.1, 1.25, 1.35, "
                         "1.44 for 3, 4, 5, 6 and more; tolerances: of each mesh, from random "
                         "gearboxes within [tolerances]"},
      .assign =
          [](const KeyRecord& record, StrengthInput& t, std::size_t, const TomlValue& v) {
            StatedFactors& factors = t.task.factors;
            factors.mesh_load_source = MeshLoadSource::kNumber;
            if (v.is_number()) {
              store(record, v, factors.mesh_load);
            } else {
              factors.mesh_load_source =
                  static_cast<MeshLoadSource>(index_of(strength::kMeshLoadSourceNames, v.text));
            }
          },
      .state =
          [](const KeyRecord& record, const StrengthInput& t, std::size_t) {
            const StatedFactors& factors = t.task.factors;
            return factors.mesh_load_source == MeshLoadSource::kNumber
                       ? stated(record, factors.mesh_load)
                       : text_value(
                             std::string(strength::kMeshLoadSourceNames[static_cast<std::size_t>(
                                 factors.mesh_load_source)]));
          }});
}

void add_factor_keys(std::vector<StrengthKey>& keys) {
  const auto add = [&](const char* name, auto member, const char* default_text, const char* help) {
    keys.push_back(strength_number(name, Unit::kNone, within(1.0, kGreatestFactor), default_text,
                                   help, of_factors(member)));
  };
  add("k_v", &StatedFactors::dynamic, "computed",
      "dynamic factor, in place of method C, which needs a speed and accuracy_grade");
  add("k_h_beta", &StatedFactors::flank_face, "computed",
      "face load factor of the flank, in place of that of f_beta_um");
  add("k_h_alpha", &StatedFactors::flank_transverse, "computed",
      "transverse load factor of the flank, in place of that of accuracy_grade");
  add("k_f_beta", &StatedFactors::root_face, "computed",
      "face load factor of the root, in place of that which follows from k_h_beta");
  add("k_f_alpha", &StatedFactors::root_transverse, "computed",
      "transverse load factor of the root, in place of that of accuracy_grade");
}

void add_safety_keys(std::vector<StrengthKey>& keys) {
  keys.push_back(strength_number("overload", Unit::kNone, within(1.0, 100.0), kWhenStated,
                                 "greatest torque over the stated one, judged without life; "
                                 "without it not rated",
                                 of_task(&RatingTask::overload)));
  keys.push_back(strength_number("virtual_root_radius", Unit::kModules, within(0.0, 1.0),
                                 "that of the tool",
                                 "root radius of the virtual rack of ISO 6336-3:2007 in place of a "
                                 "ring's tool",
                                 of_task(&RatingTask::virtual_root_radius)));
}

void add_surface_keys(std::vector<StrengthKey>& keys) {
  keys.push_back(strength_number("f_beta_um", Unit::kMicrometre, within(0.0, 1e4),
                                 "with [strength]: 0",
                                 "misalignment over the face width that running in leaves",
                                 of_task(&RatingTask::misalignment_m)));
  keys.push_back(unless_default(make_key<StrengthInput>(
      integer("strength.accuracy_grade", within(kFinestAccuracy, kCoarsestAccuracy), kWhenStated,
              "ISO 1328-1:1995 accuracy grade; without it K_v = K_Halpha = K_Falpha = 1"),
      of_task(&RatingTask::accuracy_grade))));
  keys.push_back(strength_number(
      "viscosity40_mm2_s", Unit::kSquareMillimetrePerSecond, above(0.0, 1e6), kWhenStated,
      "kinematic viscosity of the lubricant at 40 C; without it Z_L = Z_v = 1",
      of_task(&RatingTask::viscosity40_m2_s)));
  keys.push_back(strength_switch("pitting_allowed", "false with [strength]",
                                 "some pitting is allowed: the life curve of the flank for it",
                                 of_task(&RatingTask::pitting_allowed)));
}

void add_plastic_keys(std::vector<StrengthKey>& keys) {
  keys.push_back(strength_number("ambient_c", Unit::kCelsius, within(kColdest_C, kHottest_C),
                                 "with [strength]: 20", "temperature about plastic gears",
                                 of_task(&RatingTask::ambient_K)));
  keys.push_back(strength_number("tooth_temperature_c", Unit::kCelsius,
                                 within(kColdest_C, kHottest_C), "computed",
                                 "temperature of plastic teeth, in place of VDI 2736's",
                                 of_task(&RatingTask::tooth_temperature_K)));
  keys.push_back(strength_number("duty", Unit::kNone, above(0.0, 1.0), "with [strength]: 1",
                                 "share of the time at work, for the temperature of plastic teeth",
                                 of_task(&RatingTask::duty)));
  keys.push_back(
      strength_number("housing_resistance_k_m2_w", Unit::kHousingResistance, within(0.0, 100.0),
                      "with [strength]: 0",
                      "R_lambda of VDI 2736: 0 open, 0.015 to 0.045 partly open, 0.06 closed; with "
                      "housing_surface_mm2",
                      of_task(&RatingTask::housing_resistance)));
  keys.push_back(strength_number("housing_surface_mm2", Unit::kSquareMillimetre, above(0.0, 1e9),
                                 kWhenStated, "surface of the housing that cools",
                                 of_task(&RatingTask::housing_surface_m2)));
  keys.push_back(strength_number("wear_coefficient_mm3_nm", Unit::kWearCoefficient, above(0.0, 1.0),
                                 kWhenStated, "k_w of plastic flanks; without it wear is not rated",
                                 of_task(&RatingTask::wear_coefficient_m2_N)));
}

/// Keys of what may be stated of one gear too, without the table's name.
std::vector<Key<StatedTeeth>> teeth_keys() {
  const auto roughness = [](const char* name, std::optional<double> StatedTeeth::*member,
                            const char* help) {
    return make_key<StatedTeeth>(
        number(name, Unit::kMicrometre, above(0.0, 1000.0), kWhenStated, help), member);
  };
  return {
      make_key<StatedTeeth>(number("cycles", Unit::kNone, within(1.0, 1e18), kWhenStated,
                                   "load cycles of every tooth, in place of a life; without either "
                                   "the endurance limit of metals"),
                            &StatedTeeth::cycles),
      make_key<StatedTeeth>(
          {.path = "load_reversal",
           .type = KeyType::kBoolean,
           .default_text = "true with [strength]",
           .help = "the torque changes its sign: Y_M = 0.7 for every metal tooth; "
                   "else of idlers only"},
          &StatedTeeth::load_reversal),
      make_key<StatedTeeth>(
          number("y_m", Unit::kNone, above(0.0, 1.0), "with [strength]: 0.7, of plastics 1",
                 "Y_M of teeth that are loaded on both flanks (load_reversal, idlers), in place of "
                 "0.7; UR M56 has 0.9 for occasional reversal, and no source has one for plastics"),
          &StatedTeeth::reversal),
      roughness("root_roughness_um", &StatedTeeth::root_roughness_m,
                "R_z of the root; without it Y_R = 1"),
      roughness("flank_roughness_um", &StatedTeeth::flank_roughness_m,
                "R_z of the flank; without that of both gears of a mesh Z_R = 1"),
      make_key<StatedTeeth>(number("s_f_min", Unit::kNone, above(0.0, 100.0),
                                   "with [strength]: 1, of plastics 2", "least safety of the root"),
                            &StatedTeeth::root_safety_min),
      make_key<StatedTeeth>(
          number("s_h_min", Unit::kNone, above(0.0, 100.0), "with [strength]: 1, of plastics 1.4",
                 "least safety of the flank"),
          &StatedTeeth::flank_safety_min)};
}

/// The same in the table `strength` of a gear.
void add_gear_teeth_keys(std::vector<StrengthKey>& keys, const std::string& gear) {
  std::vector<Key<StatedTeeth>> own = teeth_keys();
  for (Key<StatedTeeth>& key : own) {
    const std::string common = "strength." + key.record.path;
    key.record.default_text = common;
    key.record.help = fmt::format("of the teeth of one gear, in place of {}", common);
  }
  append_keys(
      keys, own, [](auto& t, std::size_t g) -> auto& { return t.task.gear_teeth[g]; },
      gear + ".strength.");
}

/// What differs between a train's keys and a pair's.
struct TorqueKeys {
  const char* torque;  ///< its name in [strength]
  const char* torque_help;
  const char* speed;  ///< the key that life_hours needs
};
/// @param mesh_load  the key of K_gamma
std::vector<StrengthKey> common_strength_keys(const TorqueKeys& of, StrengthKey mesh_load) {
  std::vector<StrengthKey> keys;
  keys.push_back(strength_number(of.torque, Unit::kNewtonMetre, within(1e-6, 1e7),
                                 "required by [strength]", of.torque_help,
                                 &StrengthInput::torque_Nm));
  keys.push_back(strength_number(
      "life_hours", Unit::kHour, above(0.0, 1e7), kWhenStated,
      fmt::format("time at work, which with {} gives the load cycles of each tooth", of.speed),
      of_task(&RatingTask::life_s)));
  append_keys(
      keys, teeth_keys(), [](auto& t, std::size_t) -> auto& { return t.task.teeth; }, "strength.");
  keys.push_back(strength_number("k_a", Unit::kNone, within(1.0, kGreatestFactor),
                                 "with [strength]: 1", "application factor",
                                 of_factors(&StatedFactors::application)));
  keys.push_back(std::move(mesh_load));
  add_factor_keys(keys);
  add_safety_keys(keys);
  add_surface_keys(keys);
  add_plastic_keys(keys);
  return keys;
}

void add_material_keys(std::vector<StrengthKey>& keys, const std::string& gear) {
  append_keys(keys, material_keys(), &StrengthInput::material, "material.");
  append_keys(
      keys, material_keys(), [](auto& t, std::size_t g) -> auto& { return t.gear_material[g]; },
      gear + ".material.");
  for (StrengthKey& key : keys) {
    if (key.record.path == gear + ".material.name") {
      key.record.help =
          "material of one gear, in place of [material] as a whole; " + key.record.help;
    }
  }
}

}  // namespace

std::vector<std::string> train_gear_tables() {
  std::vector<std::string> gears;
  gears.reserve(train::kGearNames.size());
  for (const std::string_view name : train::kGearNames)
    gears.push_back(fmt::format("gears.{}", name));
  return gears;
}

std::vector<std::string> pair_gear_tables() { return {"gear1", "gear2"}; }

std::vector<Key<StrengthInput>> train_strength_keys() {
  auto keys = common_strength_keys(
      {.torque = "output_torque_nm",
       .torque_help = "torque at R2 that the gearbox is to carry, in either direction",
       .speed = "operating_point.sun_speed_rpm"},
      train_mesh_load_key());
  keys.push_back(strength_number(
      "k_gamma_quantile", Unit::kNone, within(0.5, 1.0), "with k_gamma = \"tolerances\": 0.99",
      "share of the gearboxes within [tolerances] whose K_gamma is no greater",
      of_factors(&StatedFactors::mesh_load_quantile)));
  keys.push_back(make_key<StrengthInput>(
      number_range("bearings.planet_positions_mm", Unit::kMillimetre, within(-1e4, 1e4),
                   kWhenStated,
                   "where the two bearings of a planet stand along the axis, as axial.P1_mm and "
                   "axial.P2_mm; with [strength]: their loads"),
      &StrengthInput::planet_position_m));
  keys.push_back(make_key<StrengthInput>(
      number("bearings.planet_stiffness_n_per_um", Unit::kNewtonPerMicrometre, above(0.0, 1e6),
             "rigid", "radial stiffness of one of these bearings"),
      &StrengthInput::planet_stiffness_N_m));
  keys.push_back(make_key<StrengthInput>(
      number("bearings.pin_stiffness_n_per_um", Unit::kNewtonPerMicrometre, above(0.0, 1e6),
             "rigid",
             "stiffness of a planet's pin under each of these bearings, in series with it"),
      &StrengthInput::pin_stiffness_N_m));
  keys.push_back(unless_default(
      make_key<StrengthInput>(number("bearings.pin_diameter_mm", Unit::kMillimetre,
                                     above(0.0, 1000.0), "in a DESIGN inertia.pin_diameter_mm",
                                     "diameter of a planet's pin, for its bending stress"),
                              of_task(&RatingTask::pin_diameter_m))));
  const auto add_torsion = [&](const char* name, auto member, const char* help) {
    keys.push_back(strength_number(name, Unit::kTorsionalStiffness, above(0.0, 1e9), "rigid", help,
                                   of_task(member)));
  };
  add_torsion("planet_torsion_nm_per_rad", &RatingTask::planet_torsion_Nm_rad,
              "torsional stiffness of one planet between P1 and P2");
  add_torsion("sun_shaft_nm_per_rad", &RatingTask::sun_shaft_Nm_rad,
              "torsional stiffness between the teeth of the sun and the input");
  add_torsion("ring2_nm_per_rad", &RatingTask::ring2_Nm_rad,
              "torsional stiffness between the teeth of R2 and the output");
  add_gear_teeth_keys(keys, "gears.{gear}");
  add_material_keys(keys, "gears.{gear}");
  return keys;
}

std::vector<Key<StrengthInput>> pair_strength_keys() {
  auto keys = common_strength_keys(
      {.torque = "torque_nm",
       .torque_help = "torque on gear1 that the pair is to carry",
       .speed = "strength.speed_rpm"},
      strength_number("k_gamma", Unit::kNone, within(1.0, kGreatestFactor), "with [strength]: 1",
                      "mesh load factor", of_factors(&StatedFactors::mesh_load)));
  keys.push_back(strength_number("speed_rpm", Unit::kRpm, within(0.0, 1e6), "none",
                                 "speed of gear1; without it K_v = 1",
                                 &StrengthInput::speed_rad_s));
  keys.push_back(
      make_key<StrengthInput>(number("face_width_mm", Unit::kMillimetre, above(0.0, 1000.0),
                                     "required by [strength]", "face width that both gears share"),
                              &StrengthInput::face_width_m));
  add_gear_teeth_keys(keys, "{gear}");
  add_material_keys(keys, "{gear}");
  return keys;
}

StrengthInput stated_strength(const std::optional<RatingTask>& task) {
  StrengthInput input;
  if (!task) return input;
  input.task = *task;
  input.torque_Nm = task->torque_Nm;
  if (task->supports) {
    input.planet_position_m = task->supports->position_m;
    input.planet_stiffness_N_m = task->supports->stiffness_N_m;
    input.pin_stiffness_N_m = task->supports->pin_stiffness_N_m;
  }
  for (std::size_t g = 0; g < train::kGearCount; ++g) {
    if (task->material[g]) input.gear_material[g] = stated_material(*task->material[g]);
  }
  const auto& materials = input.gear_material;
  if (std::ranges::all_of(materials, [&](const auto& m) { return m == materials[0]; })) {
    input.material = materials[0];
    input.gear_material.fill({});
  }
  return input;
}

}  // namespace gear3k::io
