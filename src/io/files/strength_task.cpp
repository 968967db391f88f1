#include "io/files/strength_task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gear3k::io {

namespace {

using design::GearMaterials, strength::GearMaterial, strength::MeshLoadSource, strength::RatingTask,
    units::Unit;

/// Planets from which the tables of K_gamma have a row.
constexpr int kFewestOfTables = 3;

/// Of a file with [strength]: the torque that is missing, materials that say too little.
void check_common(const StrengthInput& input, const GearMaterials& materials,
                  const std::vector<std::string>& gears, const std::string& torque_key,
                  FileReading& reading) {
  if (!reading.stated(torque_key)) {
    reading.error_at(torque_key,
                     fmt::format("{} is missing, required by [strength]: allowed: a number in N m, "
                                 "1e-06 to 10000000",
                                 torque_key));
  }
  std::vector<std::string> without;
  bool shared_is_checked = false;
  for (std::size_t g = 0; g < gears.size(); ++g) {
    const std::string own = gears[g] + ".material";
    const bool has_own = reading.stated(own);
    if (!has_own && !reading.stated("material")) without.push_back(own);
    if (!materials[g] || (!has_own && std::exchange(shared_is_checked, true))) continue;
    check_rated_material(has_own ? own : "material", *materials[g], reading);
  }
  if (without.size() == gears.size()) {
    reading.error_at("strength",
                     "material is missing, required by [strength]: allowed: [material] "
                     "of all gears, or one of each gear");
  } else if (!without.empty()) {
    reading.error_at("strength", fmt::format("{} is missing, required by [strength]: allowed: with "
                                             "it, or with [material] of all gears",
                                             fmt::join(without, ", ")));
  }
  if (reading.stated("strength.life_hours") && reading.stated("strength.cycles")) {
    reading.error_at("strength.cycles",
                     "strength.cycles and strength.life_hours: allowed: one of them");
  }
  if (input.task.housing_resistance > 0.0 && !reading.stated("strength.housing_surface_mm2")) {
    reading.error_at("strength.housing_resistance_k_m2_w",
                     "strength.housing_resistance_k_m2_w without strength.housing_surface_mm2: "
                     "allowed: both or neither");
  }
  if (reading.stated("strength.housing_surface_mm2") &&
      !reading.stated("strength.housing_resistance_k_m2_w")) {
    reading.error_at("strength.housing_surface_mm2",
                     "strength.housing_surface_mm2 without strength.housing_resistance_k_m2_w: "
                     "allowed: both or neither (0: an open housing)");
  }
}

bool states_life(const std::string& gear, const FileReading& reading) {
  return reading.stated("strength.life_hours") || reading.stated("strength.cycles") ||
         reading.stated(gear + ".strength.cycles");
}

/// Wear wants a life of every plastic gear to count meetings of its teeth over.
void check_wear(const GearMaterials& materials, const std::vector<std::string>& gears,
                FileReading& reading) {
  constexpr const char* kWear = "strength.wear_coefficient_mm3_nm";
  if (!reading.stated(kWear)) return;
  std::vector<std::string> without;
  for (std::size_t g = 0; g < gears.size(); ++g) {
    const bool plastic = materials[g] && strength::is_plastic(materials[g]->record.group);
    if (plastic && !states_life(gears[g], reading)) without.push_back(gears[g]);
  }
  if (without.empty()) return;
  reading.error_at(kWear, fmt::format("{} without a life of {}: allowed: with strength.cycles, "
                                      "strength.life_hours or {}.strength.cycles",
                                      kWear, fmt::join(without, ", "),
                                      fmt::join(without, ".strength.cycles, ")));
}

/// What the curves of plastics need, and where they end.
void check_curves(const StrengthInput& input, const GearMaterials& materials,
                  const std::vector<std::string>& gears, FileReading& reading) {
  std::string_view name;
  bool told = false;
  for (std::size_t g = 0; g < gears.size(); ++g) {
    if (!materials[g] || !strength::has_life_curves(materials[g]->record)) continue;
    if (name.empty()) name = materials[g]->record.name;
    if (told || states_life(gears[g], reading)) continue;
    told = true;
    reading.error_at("strength.cycles",
                     fmt::format("strength.cycles is missing, which the limits of \"{}\" ({}) "
                                 "depend on: allowed: cycles or life_hours",
                                 materials[g]->record.name, gears[g]));
  }
  if (name.empty()) return;
  const auto check = [&](const char* key, const std::optional<double>& temperature_K) {
    if (!temperature_K || !(*temperature_K > strength::kHighestPlasticTemperature_K)) return;
    reading.error_at(
        key,
        fmt::format("{} = {:g}: allowed: at most {:g}, where the curves of \"{}\" end", key,
                    units::from_si(*temperature_K, Unit::kCelsius),
                    units::from_si(strength::kHighestPlasticTemperature_K, Unit::kCelsius), name));
  };
  check("strength.tooth_temperature_c", input.task.tooth_temperature_K);
  if (!input.task.tooth_temperature_K) check("strength.ambient_c", input.task.ambient_K);
}

/// A gear's own values: with a load, and Y_M only where both flanks carry.
/// @param idler  place of a gear that may be an idler, by the teeth; -1: none
void check_gear_teeth(const StrengthInput& input, const std::vector<std::string>& gears, int idler,
                      FileReading& reading) {
  bool any_reversed = false;
  for (std::size_t g = 0; g < gears.size(); ++g) {
    const bool reversed = static_cast<int>(g) == idler ||
                          strength::stated_teeth(input.task, g).load_reversal.value_or(true);
    any_reversed = any_reversed || reversed;
    const std::string table = gears[g] + ".strength";
    if (!reading.stated(table)) continue;
    if (!reading.stated("strength")) {
      reading.error_at(table, fmt::format("{} without [strength]: allowed: with it", table));
    }
    const std::string y_m = table + ".y_m";
    if (reversed || !reading.stated(y_m)) continue;
    reading.error_at(y_m, fmt::format("{} without load reversal: allowed: with {}.load_reversal = "
                                      "true",
                                      y_m, table));
  }
  if (any_reversed || !reading.stated("strength.y_m")) return;
  reading.error_at("strength.y_m",
                   "strength.y_m without load reversal: allowed: with load_reversal = true of all "
                   "gears or of one");
}

void check_planets(const StrengthInput& input, const std::vector<int>& planets,
                   FileReading& reading) {
  const MeshLoadSource source = input.task.factors.mesh_load_source;
  if (source == MeshLoadSource::kNumber || source == MeshLoadSource::kTolerances) return;
  const auto few = std::ranges::min_element(planets);
  if (few == planets.end() || *few >= kFewestOfTables) return;
  reading.error_at(
      "strength.k_gamma",
      fmt::format("strength.k_gamma = \"{}\" with {} planet{}: allowed: a number (the table begins "
                  "with {} planets)",
                  strength::kMeshLoadSourceNames[static_cast<std::size_t>(source)], *few,
                  *few == 1 ? "" : "s", kFewestOfTables));
}

/// K_gamma of tolerances wants them.
void check_mesh_load(const StrengthInput& input, FileReading& reading) {
  constexpr const char* kFactor = "strength.k_gamma";
  constexpr const char* kQuantile = "strength.k_gamma_quantile";
  if (input.task.factors.mesh_load_source != MeshLoadSource::kTolerances) {
    if (!reading.stated(kQuantile)) return;
    reading.error_at(kQuantile, fmt::format("{} without {} = \"tolerances\": allowed: with it",
                                            kQuantile, kFactor));
  } else if (!reading.stated("tolerances")) {
    reading.error_at(
        kFactor,
        fmt::format("{} = \"tolerances\" without [tolerances]: allowed: with it", kFactor));
  }
}

/// The bearings of a planet; empty where they are not stated.
std::optional<strength::PlanetSupports> finish_supports(const StrengthInput& input,
                                                        const train::AxialLayout& axial,
                                                        FileReading& reading) {
  constexpr const char* kPositions = "bearings.planet_positions_mm";
  constexpr const char* kStiffness = "bearings.planet_stiffness_n_per_um";
  constexpr const char* kPinStiffness = "bearings.pin_stiffness_n_per_um";
  constexpr const char* kPinDiameter = "bearings.pin_diameter_mm";
  if (!reading.stated(kPositions)) {
    for (const char* key : {kStiffness, kPinStiffness, kPinDiameter}) {
      if (!reading.stated(key)) continue;
      reading.error_at(key, fmt::format("{} without {}: allowed: with it", key, kPositions));
    }
    return std::nullopt;
  }
  std::vector<std::string> missing;
  for (const auto step : {train::kP1, train::kP2}) {
    std::string key = fmt::format("axial.{}_mm", train::kGearNames[static_cast<std::size_t>(step)]);
    if (!reading.stated(key)) missing.push_back(std::move(key));
  }
  if (!missing.empty()) {
    reading.error_at(kPositions, fmt::format("{} without {}: allowed: with it, whose middle is the "
                                             "plane of its forces",
                                             kPositions, fmt::join(missing, " and ")));
  }
  if (!input.planet_position_m) return std::nullopt;
  const auto& [a, b] = *input.planet_position_m;
  if (a == b) {
    const double position_mm = units::from_si(a, Unit::kMillimetre);
    reading.error_at(
        kPositions, fmt::format("{} = [{:g}, {:g}]: both bearings are in one plane, which holds no "
                                "tilting couple: allowed: two places",
                                kPositions, position_mm, position_mm));
  }
  return strength::PlanetSupports{.position_m = *input.planet_position_m,
                                  .plane_m = design::toothing_planes_m(axial),
                                  .stiffness_N_m = input.planet_stiffness_N_m,
                                  .pin_stiffness_N_m = input.pin_stiffness_N_m};
}

/// Limits of bearings and pin want them to be known.
void check_planet_limits(const RatedTrainFile& file, FileReading& reading) {
  using design::CheckId;
  const bool positions = reading.stated("bearings.planet_positions_mm");
  if (file.limits[CheckId::kBearingLoad] && !positions) {
    reading.error_at("limits.bearing_load",
                     "limits.bearing_load without bearings.planet_positions_mm: allowed: with it");
  }
  const bool pin = file.has_pin || reading.stated("bearings.pin_diameter_mm");
  if (file.limits[CheckId::kPinStress] && !(positions && pin)) {
    reading.error_at("limits.pin_stress",
                     "limits.pin_stress without bearings.planet_positions_mm and "
                     "bearings.pin_diameter_mm: allowed: with both");
  }
  if (file.has_pin && reading.stated("bearings.pin_diameter_mm")) {
    reading.error_at("bearings.pin_diameter_mm",
                     "bearings.pin_diameter_mm and inertia.pin_diameter_mm: allowed: one of them");
  }
}

/// One gearbox has one oil: that of friction and that of the flanks, at 40 C.  Beyond the stated
/// temperatures, where rounded viscosities say less, they are not compared.
void check_oil(const StrengthInput& input, const efficiency::Lubricant<double>& oil,
               FileReading& reading) {
  constexpr const char* kKey = "strength.viscosity40_mm2_s";
  constexpr double kApart = 0.05;
  constexpr double k40_K = 273.15 + 40.0;
  for (const char* key : {kKey, "lubricant.temperature1_c", "lubricant.temperature2_c",
                          "lubricant.viscosity1_mm2_s", "lubricant.viscosity2_mm2_s"}) {
    if (!reading.has(key)) return;
  }
  constexpr double kDegree = 1e-6;  // of rounding
  if (!(oil.temperature_K[0] < oil.temperature_K[1]) || oil.temperature_K[0] > k40_K + kDegree ||
      oil.temperature_K[1] < k40_K - kDegree) {
    return;
  }
  const efficiency::Lubricant<double> of_unit_density{.temperature_K = oil.temperature_K,
                                                      .viscosity_m2_s = oil.viscosity_m2_s,
                                                      .density_kgm3 = 1.0};
  const double by_points = efficiency::dynamic_viscosity(of_unit_density, k40_K);
  const double stated = input.task.viscosity40_m2_s.value_or(by_points);
  if (std::abs(stated - by_points) <= kApart * by_points) return;
  reading.error_at(
      kKey,
      fmt::format("{} = {:g}: allowed: within {:g} % of {:.4g}, which [lubricant] says of "
                  "40 C",
                  kKey, units::from_si(stated, Unit::kSquareMillimetrePerSecond), 100.0 * kApart,
                  units::from_si(by_points, Unit::kSquareMillimetrePerSecond)));
}

RatingTask task_of(const StrengthInput& input, const GearMaterials& materials) {
  RatingTask task = input.task;
  task.material = materials;
  task.torque_Nm = input.torque_Nm.value_or(0.0);
  return task;
}

/// Life in hours wants a speed above 0.
void check_life(const char* speed_key, double speed_rad_s, FileReading& reading) {
  if (!reading.stated("strength.life_hours")) return;
  if (!reading.stated(speed_key)) {
    reading.error_at("strength.life_hours",
                     fmt::format("strength.life_hours without {}: allowed: with it, or "
                                 "strength.cycles instead",
                                 speed_key));
  } else if (reading.has(speed_key) && !(speed_rad_s > 0.0)) {
    reading.error_at(speed_key,
                     fmt::format("{} = 0: allowed: above 0 with strength.life_hours", speed_key));
  }
}

void check_face_width(const std::string& key, FileReading& reading) {
  if (reading.stated(key)) return;
  reading.error_at(
      key, fmt::format("{} is missing, required by [strength]: allowed: a width in mm", key));
}

}  // namespace

design::GearMaterials finish_materials(const StrengthInput& input,
                                       const std::vector<std::string>& gears,
                                       FileReading& reading) {
  std::optional<GearMaterial> shared;
  if (reading.stated("material")) shared = finish_material("material", input.material, reading);
  GearMaterials materials{};
  for (std::size_t g = 0; g < gears.size(); ++g) {
    const std::string own = gears[g] + ".material";
    materials[g] =
        reading.stated(own) ? finish_material(own, input.gear_material[g], reading) : shared;
  }
  return materials;
}

std::optional<RatingTask> finish_train_strength(const StrengthInput& input,
                                                const GearMaterials& materials,
                                                const RatedTrainFile& file, FileReading& reading) {
  check_gear_teeth(input, train_gear_tables(), train::kP1, reading);
  if (!reading.stated("strength")) {
    for (const char* key : {"bearings.planet_positions_mm", "bearings.planet_stiffness_n_per_um",
                            "bearings.pin_stiffness_n_per_um", "bearings.pin_diameter_mm"}) {
      if (!reading.stated(key)) continue;
      reading.error_at(key, fmt::format("{}: allowed with [strength] only", key));
    }
    check_planet_limits(file, reading);
    return std::nullopt;
  }
  const std::vector<std::string> gears = train_gear_tables();
  check_common(input, materials, gears, "strength.output_torque_nm", reading);
  check_curves(input, materials, gears, reading);
  check_wear(materials, gears, reading);
  check_planets(input, file.planets, reading);
  check_mesh_load(input, reading);
  check_oil(input, file.lubricant, reading);
  check_life("operating_point.sun_speed_rpm", file.sun_speed_rad_s.value_or(0.0), reading);
  RatingTask task = task_of(input, materials);
  for (const std::size_t stage : {0U, 1U}) {
    check_face_width(fmt::format("stage{}.face_width_mm", stage + 1), reading);
    task.face_width_m[stage] = file.face_width_m[stage].value_or(0.0);
  }
  task.speed_rad_s = file.sun_speed_rad_s.value_or(0.0);
  task.supports = finish_supports(input, file.axial, reading);
  check_planet_limits(file, reading);
  return task;
}

std::optional<RatingTask> finish_pair_strength(const StrengthInput& input,
                                               const GearMaterials& materials,
                                               FileReading& reading) {
  check_gear_teeth(input, pair_gear_tables(), -1, reading);
  if (!reading.stated("strength")) return std::nullopt;
  const std::vector<std::string> gears = pair_gear_tables();
  check_common(input, materials, gears, "strength.torque_nm", reading);
  check_curves(input, materials, gears, reading);
  check_wear(materials, gears, reading);
  check_life("strength.speed_rpm", input.speed_rad_s.value_or(0.0), reading);
  check_face_width("face_width_mm", reading);
  RatingTask task = task_of(input, materials);
  task.face_width_m[0] = input.face_width_m.value_or(0.0);
  task.speed_rad_s = input.speed_rad_s.value_or(0.0);
  return task;
}

void check_ring_corners(const geometry::BasicRack<double>& rack,
                        const std::vector<std::string>& cutter_tables,
                        const std::optional<RatingTask>& task, FileReading& reading) {
  if (!task || task->virtual_root_radius || rack.root_radius > 0.0 || cutter_tables.empty()) return;
  reading.error_at(
      "rack.root_radius",
      fmt::format("rack.root_radius = 0 with [strength]: Y_S of a ring's sharp corner has no bound "
                  "(stated for 1 <= q_s < 8): allowed: above 0, {}.teeth of a cutter, or "
                  "strength.virtual_root_radius",
                  fmt::join(cutter_tables, ".teeth and ")));
}

}  // namespace gear3k::io
