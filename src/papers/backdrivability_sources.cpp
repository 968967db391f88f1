#include "papers/backdrivability_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "papers/embedded_data.hpp"
#include "papers/statement_table.hpp"
#include "units/units.hpp"

namespace gear3k::papers {

namespace {

using Table = io::CsvTable;

constexpr double kSquareCentimetre = 1e-4;
constexpr double kMilli = 1e-3;

Table table_of(std::string_view text, const char* name) {
  return io::parse_csv(std::string(text), name);
}

BackdrivabilityStatements backdrivability_statements() {
  const Table table = table_of(backdrivability_statements_csv(), "backdrivability_statements.csv");
  const auto stated = [&](const char* name) {
    return required(table, row_named(table, "name", name), "value");
  };
  return {.ratio = stated("ratio"),
          .acceleration_torque_Nm = stated("acceleration_torque"),
          .efficiency = stated("efficiency"),
          .gear_inertia_kgm2 = kSquareCentimetre * stated("gear_inertia"),
          .gear_stiffness_Nm_rad = stated("gear_stiffness"),
          .max_backdriving_Nm = stated("max_backdriving_torque"),
          .gear_viscous_Nms = stated("gear_viscous"),
          .rotor_inertia_kgm2 = kSquareCentimetre * stated("rotor_inertia"),
          .motor_stiffness_Nm_rad = stated("motor_stiffness"),
          .motor_viscous_Nms = stated("motor_viscous"),
          .resistance_ohm = stated("resistance"),
          .torque_constant_Nm_A = stated("torque_constant"),
          .no_load_speed_rad_s = stated("no_load_speed"),
          .no_load_current_A = stated("no_load_current"),
          .motor_nominal_Nm = stated("motor_nominal_torque"),
          .knee_torque_Nm = stated("knee_torque"),
          .body_mass_kg = stated("body_mass"),
          .eq37_factor = stated("eq37_factor"),
          .eq38_viscous_Nms = stated("eq38_viscous"),
          .eq39_coulomb_Nm = stated("eq39_coulomb"),
          .eq40_load_share = stated("eq40_load_share"),
          .eq41_inertia_kgm2 = stated("eq41_inertia"),
          .eq42_inertia_kgm2 = stated("eq42_inertia"),
          .eq45_torque_factor = stated("eq45_torque_factor"),
          .eq45_viscous_Nms = stated("eq45_viscous"),
          .eq45_inertia_kgm2 = stated("eq45_inertia"),
          .eq45_stiffness_Nm_rad = stated("eq45_stiffness"),
          .point_i = stated("point_i"),
          .enough_torque = stated("enough_torque"),
          .point_ii = stated("point_ii"),
          .passable_share = stated("passable_share"),
          .fig9_exponent = stated("fig9_exponent")};
}

MotionCurves knee_curves() {
  const Table table = table_of(knee_walking_csv(), "knee_walking_digitised.csv");
  MotionCurves curves;
  for (const Table::Row& row : table.rows) {
    const bool moment = table.text(row, "series") == "knee_moment_nm_per_kg";
    double percent = std::fmod(required(table, row, "stride_percent"), 100.0);
    if (percent < 0.0) percent += 100.0;
    (moment ? curves.moment_Nm_kg : curves.speed_deg_s)
        .emplace_back(percent, required(table, row, "value"));
  }
  std::ranges::sort(curves.moment_Nm_kg);
  std::ranges::sort(curves.speed_deg_s);
  return curves;
}

/// Series within which a catalogue's motors are of one kind, by maker and order code.
std::string motor_series(const std::string& maker, const std::string& code) {
  if (maker == "Allied_Motion") {
    return code.starts_with("MF") ? "Allied Motion Megaflux" : "Allied Motion " + code.substr(0, 2);
  }
  if (maker == "Maxon") return code.starts_with("ECX") ? "maxon ECX" : "maxon EC";
  return maker == "Faulhaber" ? "FAULHABER" : maker;
}

/// The frames of the motor catalogue: rows of one maker with the same inertia and mass are
/// windings of one.
std::vector<MotorFrame> motor_frames(const Table& table) {
  std::vector<MotorFrame> frames;
  std::vector<std::array<std::string, 3>> keys;
  for (const Table::Row& row : table.rows) {
    const auto current = table.number(row, "nominal_current_a");
    if (!current) continue;
    const std::string maker = table.text(row, "manufacturer").value_or("");
    const std::string code = table.text(row, "order_code").value_or("");
    MotorFrame frame{.series = motor_series(maker, code),
                     .inertia_kgm2 = required(table, row, "rotor_inertia_kgm2"),
                     .torque_Nm = *current * required(table, row, "torque_constant_nm_per_a"),
                     .diameter_m = table.number(row, "diameter_mm"),
                     .length_m = table.number(row, "length_mm")};
    if (frame.diameter_m) *frame.diameter_m *= units::kMillimetre;
    if (frame.length_m) *frame.length_m *= units::kMillimetre;
    std::array<std::string, 3> key{maker, table.text(row, "rotor_inertia_kgm2").value_or(""),
                                   table.text(row, "mass_kg").value_or("")};
    const auto at = std::ranges::find(keys, key);
    if (at == keys.end()) {
      keys.push_back(std::move(key));
      frames.push_back(std::move(frame));
    } else if (MotorFrame& known = frames[static_cast<std::size_t>(at - keys.begin())];
               frame.torque_Nm > known.torque_Nm) {
      known = std::move(frame);
    }
  }
  return frames;
}

std::vector<NoLoadTorque> no_load_torques(const Table& table) {
  std::vector<NoLoadTorque> torques;
  for (const Table::Row& row : table.rows) {
    const auto coulomb = table.number(row, "coulomb_torque_nm");
    const auto viscous = table.number(row, "viscous_nms_per_rad");
    if (!coulomb || !viscous) continue;
    torques.push_back({.coulomb_Nm = *coulomb,
                       .viscous_Nm = *viscous * required(table, row, "no_load_speed_rad_s")});
  }
  return torques;
}

/// Gearboxes of a catalogue, and the frames among them: one for each mass and torque.
void read_planetary(ScalingTables& tables) {
  const Table table = table_of(planetary_catalogue_csv(), "planetary_gearbox_catalogue.csv");
  std::vector<std::array<std::string, 4>> keys;
  for (const Table::Row& row : table.rows) {
    const auto field = [&](const char* column) { return table.text(row, column).value_or(""); };
    const std::string series = field("manufacturer") + ", " + field("stages") + " stages";
    const double torque = required(table, row, "intermittent_torque_nm");
    std::array<std::string, 4> key{series, field("mass_kg"), field("continuous_torque_nm"),
                                   field("intermittent_torque_nm")};
    tables.planetary.push_back({.series = series,
                                .ratio = required(table, row, "ratio"),
                                .input_inertia_kgm2 = required(table, row, "input_inertia_kgm2"),
                                .torque_Nm = torque,
                                .frame = fmt::format("{}", fmt::join(key, "; "))});
    if (std::ranges::find(keys, key) != keys.end()) continue;
    keys.push_back(std::move(key));
    tables.planetary_frames.push_back(
        {.series = series, .mass_kg = required(table, row, "mass_kg"), .torque_Nm = torque});
  }
}

std::vector<StrainWaveGearbox> strain_waves() {
  const Table table = table_of(strain_wave_catalogue_csv(), "strain_wave_catalogue_rt1_i100.csv");
  std::vector<StrainWaveGearbox> gearboxes;
  for (const Table::Row& row : table.rows) {
    const auto number = [&](const char* column) { return required(table, row, column); };
    gearboxes.push_back({.size = number("size"),
                         .pitch_radius_m = number("pitch_radius_mm") * units::kMillimetre,
                         .rated_Nm = number("T_rated_Nm"),
                         .backdriving_Nm = number("backdriving_torque_Nm"),
                         .starting_Nm = kMilli * number("starting_torque_mNm"),
                         .first_stiffness_Nm_rad = number("K1_Nm_rad"),
                         .last_stiffness_Nm_rad = number("K3_Nm_rad")});
  }
  return gearboxes;
}

}  // namespace

BackdrivabilitySources backdrivability_sources() {
  BackdrivabilitySources sources;
  sources.statements = backdrivability_statements();
  sources.knee = knee_curves();
  const Table motors = table_of(motor_catalogue_csv(), "motor_catalogue.csv");
  sources.no_load_torques = no_load_torques(motors);
  sources.strain_waves = strain_waves();
  sources.scaling.motors = motor_frames(motors);
  read_planetary(sources.scaling);
  for (const StrainWaveGearbox& g : sources.strain_waves) {
    sources.scaling.strain_waves.push_back({.radius_m = g.pitch_radius_m,
                                            .torque_Nm = g.rated_Nm,
                                            .first_stiffness_Nm_rad = g.first_stiffness_Nm_rad,
                                            .last_stiffness_Nm_rad = g.last_stiffness_Nm_rad});
  }
  return sources;
}

}  // namespace gear3k::papers
