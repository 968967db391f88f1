#include "io/keys/actuator_keys.hpp"

#include <fmt/format.h>

#include <vector>

namespace gear3k::io {

namespace {

using units::Unit;

constexpr double kMostRatio = 1e6;

std::vector<Key<MotorInput>> motor_keys() {
  using In = MotorInput;
  const auto of_motor = [](auto member) {
    return [member](auto& t, std::size_t) -> auto& { return t.motor.*member; };
  };
  const auto of_heat = [](auto member) {
    return [member](auto& t, std::size_t) -> auto& { return t.motor.heat.*member; };
  };
  using actuator::Motor, actuator::MotorHeat;
  return {
      make_key<In>(number("motor.resistance_ohm", Unit::kNone, above(0.0, 1e6), kRequired,
                          "R at 25 C: copper loss R I2 (of amplitudes of sinusoidal phases 1.5 "
                          "R_phase)"),
                   of_motor(&Motor::resistance_ohm)),
      make_key<In>(number("motor.torque_constant_nm_per_a", Unit::kNone, above(0.0, 1e6), kRequired,
                          "K_t: torque over current, volts over rad/s"),
                   of_motor(&Motor::torque_constant_Nm_A)),
      make_key<In>(number("motor.rotor_inertia_kgm2", Unit::kKilogramSquareMetre, within(0.0, 1e6),
                          "0", "J_m, at the motor"),
                   of_motor(&Motor::rotor_inertia_kgm2)),
      make_key<In>(number("motor.no_load_current_a", Unit::kNone, within(0.0, 1e6), "none",
                          "current that turns the motor alone; with no_load_speed_rad_s: viscous "
                          "friction is what coulomb_torque_nm leaves of it"),
                   &In::no_load_current_A),
      make_key<In>(number("motor.no_load_speed_rad_s", Unit::kNone, above(0.0, 1e6), "none",
                          "speed of the motor at no_load_current_a"),
                   &In::no_load_speed_rad_s),
      make_key<In>(number("motor.coulomb_torque_nm", Unit::kNewtonMetre, within(0.0, 1e6), "0",
                          "friction of the turning motor that no speed changes"),
                   of_motor(&Motor::coulomb_Nm)),
      make_key<In>(number("motor.static_torque_nm", Unit::kNewtonMetre, within(0.0, 1e6),
                          "motor.coulomb_torque_nm", "friction of the motor at rest"),
                   &In::static_Nm),
      make_key<In>(number("motor.viscous_nms_per_rad", Unit::kViscousDrag, within(0.0, 1e6),
                          "none, or what no_load_current_a leaves",
                          "friction of the motor over its speed, in place of no_load_current_a"),
                   of_motor(&Motor::viscous_Nms)),
      make_key<In>(number("motor.shaft_stiffness_nm_per_rad", Unit::kTorsionalStiffness,
                          above(0.0, 1e12), "rigid", "of the motor's shaft, at the motor"),
                   of_motor(&Motor::shaft_stiffness_Nm_rad)),
      make_key<In>(number("motor.mass_kg", Unit::kKilogram, within(0.0, 1e6), "not known",
                          "mass of the motor"),
                   of_motor(&Motor::mass_kg)),
      make_key<In>(number("motor.max_current_a", Unit::kNone, above(0.0, 1e6), "no limit",
                          "greatest current at any instant"),
                   of_motor(&Motor::max_current_A)),
      make_key<In>(number("motor.max_speed_rad_s", Unit::kNone, above(0.0, 1e6), "no limit",
                          "greatest speed of the motor at any instant"),
                   of_motor(&Motor::max_speed_rad_s)),
      make_key<In>(number("motor.thermal_resistance_k_per_w", Unit::kNone, above(0.0, 1e6), "none",
                          "from the winding to the surroundings as one, in place of the two "
                          "below; all heat of the motor, friction too, passes it"),
                   &In::thermal_resistance_K_W),
      make_key<In>(number("motor.winding_housing_k_per_w", Unit::kNone, above(0.0, 1e6), "none",
                          "thermal resistance from winding to housing; with the one below"),
                   of_heat(&MotorHeat::winding_housing_K_W)),
      make_key<In>(number("motor.housing_ambient_k_per_w", Unit::kNone, above(0.0, 1e6), "none",
                          "thermal resistance from housing to surroundings; with the one above"),
                   of_heat(&MotorHeat::housing_ambient_K_W)),
      make_key<In>(number("motor.winding_time_constant_s", Unit::kNone, above(0.0, 1e9), "none",
                          "thermal, of the winding: its heat capacity, and whether a cycle is "
                          "short against it"),
                   of_heat(&MotorHeat::winding_time_constant_s)),
      make_key<In>(number("motor.housing_time_constant_s", Unit::kNone, above(0.0, 1e9), "none",
                          "thermal, of the housing: its heat capacity"),
                   of_heat(&MotorHeat::housing_time_constant_s)),
      make_key<In>(number("motor.max_winding_c", Unit::kCelsius, within(-200.0, 1000.0), "no limit",
                          "greatest temperature of the winding"),
                   of_heat(&MotorHeat::max_winding_K)),
      make_key<In>(number("motor.ambient_c", Unit::kCelsius, within(-200.0, 1000.0), "25",
                          "temperature of the surroundings"),
                   of_heat(&MotorHeat::ambient_K))};
}

std::vector<Key<GearboxInput>> gearbox_keys() {
  using In = GearboxInput;
  const auto of_gearbox = [](auto member) {
    return [member](auto& t, std::size_t) -> auto& { return t.gearbox.*member; };
  };
  using actuator::Gearbox;
  return {
      make_key<In>({.path = "gearbox.design",
                    .type = KeyType::kText,
                    .default_text = "none",
                    .help = "a DESIGN file, its path as seen from this file, in place of every "
                            "other key of [gearbox] but least_friction_speed_rad_s"},
                   &In::design, [](const In& t, std::size_t) { return !t.design.empty(); }),
      make_key<In>(
          number("gearbox.least_friction_speed_rad_s", Unit::kNone, above(0.0, 1e6), "none",
                 "with design: friction of the flanks is that of at least this speed of "
                 "the output; for laws without a value at rest"),
          &In::least_friction_speed_rad_s),
      make_key<In>(
          number("gearbox.ratio", Unit::kNone, within(-kMostRatio, kMostRatio),
                 "needed without design", "speed of the motor over that of the output, signed"),
          of_gearbox(&Gearbox::ratio)),
      make_key<In>(number("gearbox.efficiency_forward", Unit::kNone, above(0.0, 1.0),
                          "needed without design", "of the loaded meshes, with the motor driving"),
                   of_gearbox(&Gearbox::efficiency_forward)),
      make_key<In>(number("gearbox.efficiency_backward", Unit::kNone, within(-1000.0, 1.0),
                          "needed without design",
                          "of the loaded meshes, with the output driving; 0 or less: "
                          "self-locking"),
                   of_gearbox(&Gearbox::efficiency_backward)),
      make_key<In>(number("gearbox.efficiency_includes_drag_at_nm", Unit::kNewtonMetre,
                          above(0.0, 1e9), "no drag in it",
                          "output torque at which both efficiencies were measured with the drag "
                          "of the gearbox in them"),
                   &In::efficiency_includes_drag_at_Nm),
      make_key<In>(number("gearbox.input_inertia_kgm2", Unit::kKilogramSquareMetre,
                          within(0.0, 1e6), "0", "at the motor"),
                   of_gearbox(&Gearbox::input_inertia_kgm2)),
      make_key<In>(number("gearbox.output_inertia_kgm2", Unit::kKilogramSquareMetre,
                          within(0.0, 1e6), "0", "at the output"),
                   of_gearbox(&Gearbox::output_inertia_kgm2)),
      make_key<In>(number("gearbox.stiffness_nm_per_rad", Unit::kTorsionalStiffness,
                          above(0.0, 1e12), "rigid", "at the output"),
                   of_gearbox(&Gearbox::stiffness_Nm_rad)),
      make_key<In>(
          number("gearbox.backdriving_torque_nm", Unit::kNewtonMetre, within(0.0, 1e9),
                 "gearbox.coulomb_torque_nm", "drag at the output at rest, without the motor's"),
          &In::backdriving_Nm),
      make_key<In>(number("gearbox.coulomb_torque_nm", Unit::kNewtonMetre, within(0.0, 1e9),
                          "half of backdriving_torque_nm", "drag at the output while it turns"),
                   &In::coulomb_Nm),
      make_key<In>(number("gearbox.viscous_nms_per_rad", Unit::kViscousDrag, within(0.0, 1e9), "0",
                          "drag at the output over its speed"),
                   of_gearbox(&Gearbox::viscous_Nms)),
      make_key<In>(number("gearbox.mass_kg", Unit::kKilogram, within(0.0, 1e6), "not known",
                          "mass of the gearbox"),
                   of_gearbox(&Gearbox::mass_kg))};
}

std::vector<Key<ActuatorInput>> keys_of_actuator() {
  using In = ActuatorInput;
  using actuator::Drive;
  std::vector<Key<In>> keys{make_key<In>({.path = "name",
                                          .type = KeyType::kText,
                                          .default_text = "\"\"",
                                          .help = "name in tables and results"},
                                         &In::name)};
  append_keys(keys, motor_keys(), &In::motor);
  for (Key<GearboxInput> key : gearbox_keys()) {
    if (!key.record.path.ends_with(".design")) {
      key.written = [](const GearboxInput& in, std::size_t) { return in.design.empty(); };
    }
    append_keys(keys, std::vector{key}, &In::gearbox);
  }
  const std::vector<Key<Drive>> drive{
      make_key<Drive>(number("drive.bus_voltage_v", Unit::kNone, above(0.0, 1e6), "no limit",
                             "greatest voltage at the motor at any instant"),
                      &Drive::bus_voltage_V),
      make_key<Drive>(number("drive.efficiency_motoring", Unit::kNone, above(0.0, 1.0), "1",
                             "motor's power over that from the bus"),
                      &Drive::efficiency_motoring),
      make_key<Drive>(number("drive.efficiency_regenerating", Unit::kNone, within(0.0, 1.0), "1",
                             "power to the bus over that of the motor; 0: a chopper burns it"),
                      &Drive::efficiency_regenerating),
      make_key<Drive>(number("drive.standby_w", Unit::kNone, within(0.0, 1e6), "0",
                             "power that the drive takes at any time"),
                      &Drive::standby_W)};
  append_keys(keys, drive, &In::drive);
  append_keys(keys, felt_keys(), &In::felt);
  keys.push_back(
      make_key<In>(number("load.inertia_kgm2", Unit::kKilogramSquareMetre, within(0.0, 1e9), "0",
                          "of the load, at the output, on top of the cycle's torque"),
                   &In::load_inertia_kgm2));
  keys.push_back(make_key<In>(
      number("backlash.output_arcmin", Unit::kArcmin, within(0.0, 3600.0),
             "that of gearbox.design, else 0",
             "lost motion of the output with the motor locked, for simulate: within it motor and "
             "output move by themselves"),
      &In::backlash_rad));
  return keys;
}

void check_motor(const MotorInput& in, FileReading& reading) {
  const actuator::Motor& motor = in.motor;
  if (in.no_load_current_A.has_value() != in.no_load_speed_rad_s.has_value()) {
    const char* stated = in.no_load_current_A ? "no_load_current_a" : "no_load_speed_rad_s";
    const char* missing = in.no_load_current_A ? "no_load_speed_rad_s" : "no_load_current_a";
    reading.error_at(fmt::format("motor.{}", stated),
                     fmt::format("motor.{}: allowed: with motor.{}", stated, missing));
  } else if (in.no_load_current_A) {
    const double torque = motor.torque_constant_Nm_A * *in.no_load_current_A;
    if (motor.coulomb_Nm > torque) {
      reading.error_at(
          "motor.coulomb_torque_nm",
          fmt::format("motor.coulomb_torque_nm = {:g}: allowed: up to the torque of the no-load "
                      "current, {:g} N m",
                      motor.coulomb_Nm, torque));
    }
  }
  if (in.no_load_current_A && reading.stated("motor.viscous_nms_per_rad")) {
    reading.error_at("motor.viscous_nms_per_rad",
                     "motor.viscous_nms_per_rad: allowed: without motor.no_load_current_a");
  }
  if (in.static_Nm && *in.static_Nm < motor.coulomb_Nm) {
    reading.error_at("motor.static_torque_nm",
                     fmt::format("motor.static_torque_nm = {:g}: allowed: "
                                 "motor.coulomb_torque_nm = {:g} or more",
                                 *in.static_Nm, motor.coulomb_Nm));
  }
  const actuator::MotorHeat& heat = motor.heat;
  if (in.thermal_resistance_K_W && (heat.winding_housing_K_W || heat.housing_ambient_K_W)) {
    reading.error_at("motor.thermal_resistance_k_per_w",
                     "motor.thermal_resistance_k_per_w: allowed: without "
                     "motor.winding_housing_k_per_w and motor.housing_ambient_k_per_w");
  }
  const bool known = in.thermal_resistance_K_W || heat.winding_housing_K_W;
  const auto wants = [&](const char* key, bool stated, bool there, const char* what) {
    if (stated && !there) reading.error_at(key, fmt::format("{}: allowed: with {}", key, what));
  };
  if (!in.thermal_resistance_K_W) {
    const bool winding = heat.winding_housing_K_W.has_value();
    const bool housing = heat.housing_ambient_K_W.has_value();
    wants("motor.winding_housing_k_per_w", winding, housing,
          "motor.housing_ambient_k_per_w; from the winding to the surroundings as one: "
          "motor.thermal_resistance_k_per_w");
    wants("motor.housing_ambient_k_per_w", housing, winding, "motor.winding_housing_k_per_w");
  }
  wants("motor.max_winding_c", heat.max_winding_K.has_value(), known,
        "motor.winding_housing_k_per_w or motor.thermal_resistance_k_per_w");
  wants("motor.winding_time_constant_s", heat.winding_time_constant_s.has_value(), known,
        "motor.winding_housing_k_per_w or motor.thermal_resistance_k_per_w");
  wants("motor.housing_time_constant_s", heat.housing_time_constant_s.has_value(),
        heat.housing_ambient_K_W.has_value(), "motor.housing_ambient_k_per_w");
}

void check_catalogue(const GearboxInput& in, FileReading& reading) {
  for (const char* key :
       {"gearbox.ratio", "gearbox.efficiency_forward", "gearbox.efficiency_backward"}) {
    if (reading.stated(key)) continue;
    reading.error_at(key, fmt::format("{} is missing: allowed: a number, or gearbox.design", key));
  }
  if (reading.has("gearbox.ratio") && in.gearbox.ratio == 0.0) {
    reading.error_at("gearbox.ratio",
                     fmt::format("gearbox.ratio = 0: allowed: a number, {:g} to {:g}, but 0",
                                 -kMostRatio, kMostRatio));
  }
  if (in.coulomb_Nm && in.backdriving_Nm && *in.coulomb_Nm > *in.backdriving_Nm) {
    reading.error_at("gearbox.coulomb_torque_nm",
                     fmt::format("gearbox.coulomb_torque_nm = {:g}: allowed: up to "
                                 "gearbox.backdriving_torque_nm = {:g}",
                                 *in.coulomb_Nm, *in.backdriving_Nm));
  }
  const double running = in.coulomb_Nm.value_or(0.5 * in.backdriving_Nm.value_or(0.0));
  if (in.efficiency_includes_drag_at_Nm && *in.efficiency_includes_drag_at_Nm <= running) {
    reading.error_at(
        "gearbox.efficiency_includes_drag_at_nm",
        fmt::format("gearbox.efficiency_includes_drag_at_nm = {:g}: allowed: above the running "
                    "drag, {:g} N m",
                    *in.efficiency_includes_drag_at_Nm, running));
  }
}

}  // namespace

std::vector<Key<actuator::FeltLimits>> felt_keys() {
  using In = actuator::FeltLimits;
  return {
      make_key<In>(number("limits.max_felt_inertia_kgm2", Unit::kKilogramSquareMetre,
                          above(0.0, 1e9), "no limit",
                          "greatest inertia that is felt where the output is sped up from outside, "
                          "motor off"),
                   &In::max_inertia_kgm2),
      make_key<In>(number("limits.max_breakaway_nm", Unit::kNewtonMetre, above(0.0, 1e9),
                          "no limit", "greatest torque that starts the output from outside"),
                   &In::max_breakaway_Nm),
      make_key<In>(number("limits.max_transparency", Unit::kNone, above(0.0, 1e6), "no limit",
                          "greatest width of the output's torque over its mean at "
                          "limits.transparency_torque_nm"),
                   &In::max_transparency),
      make_key<In>(
          number("limits.transparency_torque_nm", Unit::kNewtonMetre, above(0.0, 1e9), "none",
                 "torque that the motor holds, times the ratio: tells the torques at the "
                 "output moving with it and pushed back, and their width over their mean"),
          &In::transparency_torque_Nm)};
}

void check_felt(const actuator::FeltLimits& felt, const std::string& table, FileReading& reading) {
  if (!felt.max_transparency || felt.transparency_torque_Nm) return;
  const std::string path = table + "limits.max_transparency";
  reading.error_at(path,
                   fmt::format("{}: allowed: with {}limits.transparency_torque_nm", path, table));
}

const Schema<ActuatorInput>& actuator_schema() {
  static const Schema<ActuatorInput> schema({}, keys_of_actuator());
  return schema;
}

void check_actuator(const ActuatorInput& input, FileReading& reading) {
  check_felt(input.felt, "", reading);
  check_motor(input.motor, reading);
  if (!reading.stated("gearbox.design")) {
    check_catalogue(input.gearbox, reading);
    if (reading.stated("gearbox.least_friction_speed_rad_s")) {
      reading.error_at("gearbox.least_friction_speed_rad_s",
                       "gearbox.least_friction_speed_rad_s: allowed: with gearbox.design");
    }
    return;
  }
  for (const KeyRecord* record : actuator_schema().records()) {
    if (!record->path.starts_with("gearbox.") || record->path == "gearbox.design" ||
        record->path == "gearbox.least_friction_speed_rad_s") {
      continue;
    }
    if (!reading.stated(record->path)) continue;
    reading.error_at(record->path, fmt::format("{}: allowed: without gearbox.design, which tells "
                                               "it",
                                               record->path));
  }
}

}  // namespace gear3k::io
