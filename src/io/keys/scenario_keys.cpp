#include "io/keys/scenario_keys.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace gear3k::io {

namespace {

using motion::Control, motion::Load, motion::Pendulum, motion::Scenario, motion::Signal;
using motion::Solver;
using units::Unit;

constexpr double kMostAngle_rad = 1e6;
constexpr double kMostTorque_Nm = 1e9;
constexpr double kMostHertz = 1e6;

/// A view of a member of the scenario.
template <class Member>
auto of_scenario(Member member) {
  return [member](auto& t, std::size_t) -> auto& { return t.scenario.*member; };
}
template <class Member>
auto of_command(Member member) {
  return [member](auto& t, std::size_t) -> auto& { return t.scenario.command.*member; };
}
template <class Member>
auto of_load(Member member) {
  return [member](auto& t, std::size_t) -> auto& { return t.scenario.load.*member; };
}
template <class Member>
auto of_load_torque(Member member) {
  return [member](auto& t, std::size_t) -> auto& { return t.scenario.load.torque_Nm.*member; };
}
template <class Member>
auto of_pendulum(Member member) {
  return [member](auto& t, std::size_t) -> auto& { return t.scenario.load.pendulum.*member; };
}
template <class Member>
auto of_solver(Member member) {
  return [member](auto& t, std::size_t) -> auto& { return t.scenario.solver.*member; };
}

std::vector<Key<ScenarioInput>> start_keys() {
  using In = ScenarioInput;
  return {make_key<In>({.path = "name",
                        .type = KeyType::kText,
                        .default_text = "\"\"",
                        .help = "name in tables and results"},
                       of_scenario(&Scenario::name)),
          make_key<In>(number("duration_s", Unit::kNone, above(0.0, 1e6), kRequired,
                              "how long the motion is followed"),
                       of_scenario(&Scenario::duration_s)),
          make_key<In>(number("start.output_angle_rad", Unit::kNone,
                              within(-kMostAngle_rad, kMostAngle_rad), "0", "of the output"),
                       of_scenario(&Scenario::start_angle_rad)),
          make_key<In>(number("start.output_speed_rad_s", Unit::kNone, within(-1e6, 1e6), "0",
                              "of the output, and of the motor's side with it"),
                       of_scenario(&Scenario::start_speed_rad_s)),
          make_key<In>(number("start.gap_position", Unit::kNone, within(-1.0, 1.0), "0",
                              "where the motor's side begins within the backlash: -1 and 1 at its "
                              "ends"),
                       of_scenario(&Scenario::start_gap_position))};
}

std::vector<Key<ScenarioInput>> control_keys() {
  using In = ScenarioInput;
  return {
      make_key<In>({.path = "control.mode",
                    .type = KeyType::kChoice,
                    .choices = {"torque", "voltage", "shorted", "open", "position"},
                    .required = true,
                    .help = "what is prescribed at the motor: its torque, the voltage at its "
                            "terminals, terminals that are shorted or open, or the output's angle, "
                            "which a proportional and derivative control follows"},
                   of_scenario(&Scenario::control)),
      make_key<In>(
          number("control.torque_nm", Unit::kNewtonMetre, within(-kMostTorque_Nm, kMostTorque_Nm),
                 "0", "of the motor; constant part"),
          &In::torque_Nm),
      make_key<In>(number("control.torque_amplitude_nm", Unit::kNewtonMetre,
                          within(-kMostTorque_Nm, kMostTorque_Nm), "0", "of its sine"),
                   &In::torque_amplitude_Nm),
      make_key<In>(number("control.voltage_v", Unit::kNone, within(-1e6, 1e6), "0",
                          "at the terminals; constant part"),
                   &In::voltage_V),
      make_key<In>(
          number("control.voltage_amplitude_v", Unit::kNone, within(-1e6, 1e6), "0", "of its sine"),
          &In::voltage_amplitude_V),
      make_key<In>(number("control.angle_rad", Unit::kNone, within(-kMostAngle_rad, kMostAngle_rad),
                          "0", "of the output that the control follows; constant part"),
                   &In::angle_rad),
      make_key<In>(number("control.angle_amplitude_rad", Unit::kNone,
                          within(-kMostAngle_rad, kMostAngle_rad), "0", "of its sine"),
                   &In::angle_amplitude_rad),
      make_key<In>(number("control.frequency_hz", Unit::kNone, above(0.0, kMostHertz), "none",
                          "of the sine amplitude sin(2 pi frequency t + phase)"),
                   of_command(&Signal::frequency_Hz),
                   [](const In& t, std::size_t) { return t.scenario.command.frequency_Hz > 0.0; }),
      make_key<In>(
          number("control.phase_deg", Unit::kDegree, within(-360.0, 360.0), "0", "of the sine"),
          of_command(&Signal::phase_rad)),
      make_key<In>(
          {.path = "control.table",
           .type = KeyType::kText,
           .default_text = "none",
           .help = "CSV file, its path as seen from this file: time_s and motor_torque_nm, "
                   "voltage_v or angle_rad by the mode, added to constant and sine; rows "
                   "are joined by straight lines, two of one time are a jump"},
          &In::control_table, [](const In& t, std::size_t) { return !t.control_table.empty(); }),
      make_key<In>(
          number("control.stiffness_nm_per_rad", Unit::kTorsionalStiffness, above(0.0, 1e12),
                 "needed in mode position", "proportional gain, at the output"),
          of_scenario(&Scenario::control_stiffness_Nm_rad),
          [](const In& t, std::size_t) { return t.scenario.control_stiffness_Nm_rad > 0.0; }),
      make_key<In>(number("control.damping_nms_per_rad", Unit::kViscousDrag, within(0.0, 1e9), "0",
                          "derivative gain, at the output; a jump of the angle in control.table "
                          "has no slope, so that it gives no torque there"),
                   of_scenario(&Scenario::control_damping_Nms))};
}

std::vector<Key<ScenarioInput>> load_keys() {
  using In = ScenarioInput;
  return {
      make_key<In>(number("load.inertia_kgm2", Unit::kKilogramSquareMetre, within(0.0, 1e9), "0",
                          "besides that of the ACTUATOR's load"),
                   of_load(&Load::inertia_kgm2)),
      make_key<In>(
          number("load.torque_nm", Unit::kNewtonMetre, within(-kMostTorque_Nm, kMostTorque_Nm), "0",
                 "of the load on the output; constant part"),
          of_load_torque(&Signal::constant)),
      make_key<In>(number("load.torque_amplitude_nm", Unit::kNewtonMetre,
                          within(-kMostTorque_Nm, kMostTorque_Nm), "0", "of its sine"),
                   of_load_torque(&Signal::amplitude)),
      make_key<In>(
          number("load.frequency_hz", Unit::kNone, above(0.0, kMostHertz), "none",
                 "of the sine amplitude sin(2 pi frequency t + phase)"),
          of_load_torque(&Signal::frequency_Hz),
          [](const In& t, std::size_t) { return t.scenario.load.torque_Nm.frequency_Hz > 0.0; }),
      make_key<In>(
          number("load.phase_deg", Unit::kDegree, within(-360.0, 360.0), "0", "of the sine"),
          of_load_torque(&Signal::phase_rad)),
      make_key<In>({.path = "load.table",
                    .type = KeyType::kText,
                    .default_text = "none",
                    .help = "CSV file, its path as seen from this file: time_s and torque_nm (or "
                            "load_nm), added to constant and sine; rows as in control.table, "
                            "sign as in a CYCLE"},
                   &In::load_table, [](const In& t, std::size_t) { return !t.load_table.empty(); }),
      make_key<In>(number("load.stiffness_nm_per_rad", Unit::kTorsionalStiffness, within(0.0, 1e12),
                          "0", "of a spring from the output to the frame"),
                   of_load(&Load::stiffness_Nm_rad)),
      make_key<In>(
          number("load.rest_angle_rad", Unit::kNone, within(-kMostAngle_rad, kMostAngle_rad), "0",
                 "angle of the output at which the spring is without torque"),
          of_load(&Load::rest_angle_rad)),
      make_key<In>(number("load.pendulum_mass_kg", Unit::kKilogram, within(0.0, 1e6), "0",
                          "of a mass on an arm that turns with the output, axis level"),
                   of_pendulum(&Pendulum::mass_kg)),
      make_key<In>(number("load.pendulum_length_m", Unit::kNone, within(0.0, 1e3), "0",
                          "from the axis to the mass"),
                   of_pendulum(&Pendulum::length_m)),
      make_key<In>(
          number("load.pendulum_angle_rad", Unit::kNone, within(-kMostAngle_rad, kMostAngle_rad),
                 "0", "angle of the output at which the mass hangs"),
          of_pendulum(&Pendulum::hanging_rad)),
      make_key<In>(number("load.gravity_m_s2", Unit::kNone, within(0.0, 1e3), "9.80665",
                          "acceleration of free fall"),
                   of_pendulum(&Pendulum::gravity_m_s2))};
}

std::vector<Key<ScenarioInput>> solver_keys() {
  using In = ScenarioInput;
  return {make_key<In>(number("solver.relative_tolerance", Unit::kNone, within(1e-13, 1e-2),
                              "1e-11", "of the error of a step"),
                       of_solver(&Solver::relative_tolerance)),
          make_key<In>(number("solver.absolute_tolerance", Unit::kNone, within(1e-16, 1e-2),
                              "1e-14", "of the error of a step, in rad, rad/s and J"),
                       of_solver(&Solver::absolute_tolerance)),
          make_key<In>(number("solver.max_step_s", Unit::kNone, above(0.0, 1e6),
                              "a fortieth of the shortest period",
                              "longest step; by itself at most a fiftieth of the duration"),
                       of_solver(&Solver::max_step_s)),
          make_key<In>(integer("solver.max_events", within(1.0, 1e7), "100000",
                               "events after which a run is ended"),
                       of_solver(&Solver::max_events)),
          make_key<In>(integer("solver.max_steps", within(1.0, 1e9), "10000000",
                               "steps after which a run is ended, as where a control is stiff"),
                       of_solver(&Solver::max_steps)),
          make_key<In>(
              number("output.sample_s", Unit::kNone, above(0.0, 1e6), "a thousandth of duration_s",
                     "distance of the rows of motion.csv; events have rows besides"),
              of_scenario(&Scenario::sample_s))};
}

std::vector<Key<ScenarioInput>> keys_of_scenario() {
  std::vector<Key<ScenarioInput>> keys = start_keys();
  for (auto part : {control_keys(), load_keys(), solver_keys()}) {
    keys.insert(keys.end(), part.begin(), part.end());
  }
  return keys;
}

/// A key of [control] with its value, zero where it changes nothing.
struct ControlValue {
  const char* key;
  double value;
};

/// Complains of keys that change something and stand with another mode than theirs.
void refuse_control(const std::vector<ControlValue>& values, const std::string& modes,
                    FileReading& reading) {
  for (const auto& [key, value] : values) {
    if (value == 0.0) continue;
    reading.error_at(key, fmt::format("{}: allowed: with control.mode = {}", key, modes));
  }
}

void check_modes(const ScenarioInput& in, FileReading& reading) {
  const Scenario& scenario = in.scenario;
  const Control mode = scenario.control;
  if (mode != Control::kTorque) {
    refuse_control({{"control.torque_nm", in.torque_Nm},
                    {"control.torque_amplitude_nm", in.torque_amplitude_Nm}},
                   "\"torque\"", reading);
  }
  if (mode != Control::kVoltage) {
    refuse_control({{"control.voltage_v", in.voltage_V},
                    {"control.voltage_amplitude_v", in.voltage_amplitude_V}},
                   "\"voltage\"", reading);
  }
  if (mode != Control::kPosition) {
    refuse_control({{"control.angle_rad", in.angle_rad},
                    {"control.angle_amplitude_rad", in.angle_amplitude_rad},
                    {"control.stiffness_nm_per_rad", scenario.control_stiffness_Nm_rad},
                    {"control.damping_nms_per_rad", scenario.control_damping_Nms}},
                   "\"position\"", reading);
  } else if (!reading.stated("control.stiffness_nm_per_rad")) {
    reading.error_at("control.stiffness_nm_per_rad",
                     "control.stiffness_nm_per_rad is missing: allowed: a number with control.mode "
                     "= \"position\"");
  }
  if (mode == Control::kShorted || mode == Control::kOpen) {
    refuse_control({{"control.table", in.control_table.empty() ? 0.0 : 1.0},
                    {"control.frequency_hz", scenario.command.frequency_Hz},
                    {"control.phase_deg", scenario.command.phase_rad}},
                   "\"torque\", \"voltage\" or \"position\"", reading);
  }
}

void check_sines(const ScenarioInput& in, FileReading& reading) {
  const auto wants = [&](const char* amplitude, double value, const char* frequency) {
    if (value == 0.0 || reading.stated(frequency)) return;
    reading.error_at(amplitude, fmt::format("{}: allowed: with {}", amplitude, frequency));
  };
  wants("control.torque_amplitude_nm", in.torque_amplitude_Nm, "control.frequency_hz");
  wants("control.voltage_amplitude_v", in.voltage_amplitude_V, "control.frequency_hz");
  wants("control.angle_amplitude_rad", in.angle_amplitude_rad, "control.frequency_hz");
  wants("load.torque_amplitude_nm", in.scenario.load.torque_Nm.amplitude, "load.frequency_hz");
}

/// Complains of keys that change nothing, as what they are of is not stated.
void check_idle(const ScenarioInput& in, FileReading& reading) {
  const auto wants = [&](const char* key, bool changes, const char* owner) {
    if (!changes || reading.stated(owner)) return;
    reading.error_at(key, fmt::format("{}: allowed: with {}", key, owner));
  };
  const Control mode = in.scenario.control;
  const char* const amplitude = mode == Control::kTorque     ? "control.torque_amplitude_nm"
                                : mode == Control::kVoltage  ? "control.voltage_amplitude_v"
                                : mode == Control::kPosition ? "control.angle_amplitude_rad"
                                                             : nullptr;
  if (amplitude != nullptr && reading.has("control.mode")) {
    wants("control.frequency_hz", in.scenario.command.frequency_Hz != 0.0, amplitude);
    wants("control.phase_deg", in.scenario.command.phase_rad != 0.0, amplitude);
  }
  const Load& load = in.scenario.load;
  wants("load.frequency_hz", load.torque_Nm.frequency_Hz != 0.0, "load.torque_amplitude_nm");
  wants("load.phase_deg", load.torque_Nm.phase_rad != 0.0, "load.torque_amplitude_nm");
  wants("load.rest_angle_rad", load.rest_angle_rad != 0.0, "load.stiffness_nm_per_rad");
  wants("load.pendulum_angle_rad", load.pendulum.hanging_rad != 0.0, "load.pendulum_mass_kg");
  wants("load.gravity_m_s2", load.pendulum.gravity_m_s2 != Pendulum{}.gravity_m_s2,
        "load.pendulum_mass_kg");
}

}  // namespace

const Schema<ScenarioInput>& scenario_schema() {
  static const Schema<ScenarioInput> schema({}, keys_of_scenario());
  return schema;
}

void check_scenario(const ScenarioInput& input, FileReading& reading) {
  if (reading.has("control.mode")) check_modes(input, reading);
  check_sines(input, reading);
  check_idle(input, reading);
  const Pendulum& pendulum = input.scenario.load.pendulum;
  if (pendulum.mass_kg > 0.0 && !reading.stated("load.pendulum_length_m")) {
    reading.error_at("load.pendulum_mass_kg",
                     "load.pendulum_mass_kg: allowed: with load.pendulum_length_m");
  }
  if (pendulum.length_m > 0.0 && !reading.stated("load.pendulum_mass_kg")) {
    reading.error_at("load.pendulum_length_m",
                     "load.pendulum_length_m: allowed: with load.pendulum_mass_kg");
  }
  constexpr double kMostRows = 1e7;
  const Scenario& scenario = input.scenario;
  if (scenario.sample_s && reading.has("duration_s") &&
      scenario.duration_s / *scenario.sample_s > kMostRows) {
    reading.error_at("output.sample_s",
                     fmt::format("output.sample_s = {:g}: allowed: {:g} or more, {:g} rows",
                                 *scenario.sample_s, scenario.duration_s / kMostRows, kMostRows));
  }
  if (scenario.solver.max_step_s && reading.has("duration_s") &&
      scenario.duration_s / *scenario.solver.max_step_s > kMostRows) {
    reading.error_at(
        "solver.max_step_s",
        fmt::format("solver.max_step_s = {:g}: allowed: {:g} or more, {:g} steps",
                    *scenario.solver.max_step_s, scenario.duration_s / kMostRows, kMostRows));
  }
}

}  // namespace gear3k::io
