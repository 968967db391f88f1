#include "io/files/co_design_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>

#include "efficiency/friction_law.hpp"
#include "io/files/actuator_file.hpp"
#include "io/files/cycle_file.hpp"
#include "io/files/selection_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/file_reader.hpp"
#include "units/units.hpp"

namespace gear3k::io {

namespace {

constexpr std::size_t kMostMotorBytes = std::size_t{1} << 26U;

bool states(const ActuatorFiles& files, std::string_view key) {
  return std::ranges::find(files.stated, key) != files.stated.end();
}

/// The motor of an ACTUATOR as one of a catalogue; voltage and surroundings are its own where the
/// SPEC states none.
actuator::CatalogueMotor catalogued(const ActuatorFiles& files, const std::string& path,
                                    const FileReading& reading) {
  const actuator::Actuator& stated = files.actuator;
  const bool coulomb =
      states(files, "motor.coulomb_torque_nm") || states(files, "motor.static_torque_nm");
  actuator::CatalogueMotor motor{
      .name = stated.name.empty() ? std::filesystem::path(path).stem().string() : stated.name,
      .motor = stated.motor,
      .nominal_current_A = std::nullopt,
      .nominal_voltage_V = stated.drive.bus_voltage_V,
      .friction_known = coulomb || states(files, "motor.viscous_nms_per_rad") ||
                        states(files, "motor.no_load_current_a"),
      .coulomb_known = coulomb,
      .inertia_known = states(files, "motor.rotor_inertia_kgm2")};
  if (!reading.stated("actuator.limits.ambient_c")) motor.ambient_K = stated.motor.heat.ambient_K;
  return motor;
}

/// @throws InvalidInput where no current at all keeps a limit of the winding
void refuse_hot_surroundings(const actuator::CatalogueMotor& motor,
                             const actuator::SelectionTask& task, const std::string& path,
                             const FileReading& reading) {
  const double ambient_K = motor.ambient_K.value_or(task.ambient_K);
  const auto refuse = [&](const std::optional<double>& most_K, const std::string& limit) {
    if (!most_K || *most_K > ambient_K) return;
    throw InvalidInput(fmt::format(
        "{} = {:g}: allowed: above {} = {:g}{}", limit,
        units::from_si(*most_K, units::Unit::kCelsius),
        motor.ambient_K ? fmt::format("motor.ambient_c of {}", path) : "actuator.limits.ambient_c",
        units::from_si(ambient_K, units::Unit::kCelsius),
        motor.ambient_K ? ", or with actuator.limits.ambient_c" : ""));
  };
  refuse(motor.motor.heat.max_winding_K, fmt::format("{}: motor.max_winding_c", path));
  refuse(task.max_winding_K, fmt::format("{}: actuator.limits.max_winding_c",
                                         reading.place_of("actuator.limits.max_winding_c")));
}

/// Keys of an ACTUATOR beside its motor, under one of these tables, that a SPEC neither reads nor
/// states itself.
std::string unread_of(const ActuatorFiles& files, const std::string& path,
                      std::initializer_list<std::string_view> tables, const FileReading& reading) {
  std::vector<std::string> unread;
  for (const std::string& key : files.stated) {
    const bool taken = key == "drive.bus_voltage_v" ||  // the motor's nominal voltage
                       reading.stated("actuator." + key) ||
                       std::ranges::none_of(
                           tables, [&](std::string_view table) { return key.starts_with(table); });
    if (!taken) unread.push_back(key);
  }
  if (unread.empty()) return "";
  return fmt::format(
      "actuator.motor is the motor of {} alone, whose {} {} not read: allowed in the SPEC, as "
      "actuator.{}",
      path, fmt::join(unread, ", "), unread.size() == 1 ? "is" : "are",
      fmt::join(unread, ", actuator."));
}

void note(std::string text, std::vector<std::string>& notes) {
  if (!text.empty()) notes.push_back(std::move(text));
}

/// @throws InvalidInput  by the limits that left none of the motors
[[noreturn]] void refuse_no_motor(const CoDesignInput& input, const FileReading& reading) {
  const auto& most = input.max_motor_mass_kg;
  std::vector<std::string> limits;
  if (most) limits.push_back(fmt::format("actuator.limits.max_motor_mass_kg = {:g}", *most));
  if (input.known_friction) limits.emplace_back("actuator.limits.known_friction = true");
  throw InvalidInput(fmt::format("{}: limits leave no motor: {}: allowed: limits that leave one",
                                 reading.place_of(most ? "actuator.limits.max_motor_mass_kg"
                                                       : "actuator.limits.known_friction"),
                                 fmt::join(limits, " and ")));
}

}  // namespace

std::shared_ptr<const actuator::CoDesign> read_co_design(const CoDesignInput& input,
                                                         const std::string& file,
                                                         const FileReading& reading,
                                                         std::vector<std::string>& notes) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const SelectionInput& in = input.selection;
  actuator::SelectionTask task = in.task;
  std::vector<std::string> sources;
  const auto source = [&](const std::string& name, const std::string& key) {
    sources.push_back((folder / name).string());
    check_named_file(sources.back(), key, reading.place_of(key));
    return sources.back();
  };
  CollectedErrors errors;
  if (!input.motor.empty()) {
    errors.attempt([&] {
      const std::string path = source(input.motor, "actuator.motor");
      ActuatorFiles files = read_actuator(path);
      // The first is the file itself.
      sources.insert(sources.end(), files.inputs.begin() + 1, files.inputs.end());
      actuator::CatalogueMotor motor = catalogued(files, path, reading);
      refuse_hot_surroundings(motor, task, path, reading);
      task.motors.push_back(std::move(motor));
      note(unread_of(files, path, {"drive.", "load.", "limits."}, reading), notes);
    });
  }
  if (!in.motors.empty()) {
    errors.attempt([&] {
      const std::string path = source(in.motors, "actuator.motors");
      const auto more = parse_motors(read_text(path, "a CSV file", kMostMotorBytes), path);
      task.motors.insert(task.motors.end(), more.begin(), more.end());
    });
  }
  for (const std::string& cycle : in.cycles) {
    errors.attempt([&] { task.cycles.push_back(read_cycle(source(cycle, "cycle.files"))); });
  }
  errors.raise();
  const auto& most = input.max_motor_mass_kg;
  std::erase_if(task.motors, [&](const actuator::CatalogueMotor& m) {
    return (most && !(m.motor.mass_kg && *m.motor.mass_kg <= *most)) ||
           (input.known_friction && !m.friction_known);
  });
  if (task.motors.empty()) refuse_no_motor(input, reading);
  // Of another number than the cycles they have been refused (check_co_design).
  if (task.weights.size() != task.cycles.size()) task.weights.assign(task.cycles.size(), 1.0);
  return std::make_shared<const actuator::CoDesign>(std::move(task), std::move(sources));
}

optimize::FeltTask felt_of(const CoDesignInput& in, const actuator::Motor& motor,
                           std::vector<std::string> sources) {
  optimize::FeltTask task{
      .rotor_inertia_kgm2 = motor.rotor_inertia_kgm2,
      .coulomb_Nm = motor.coulomb_Nm,
      .static_Nm = motor.static_Nm,
      .load_inertia_kgm2 = in.selection.task.load_inertia_kgm2,
      .transparency_torque_Nm = in.selection.task.felt.transparency_torque_Nm.value_or(0.0),
      .sources = std::move(sources)};
  const auto add = [&](optimize::FeltQuantity quantity, const std::optional<double>& most) {
    if (most) task.limits.push_back({.quantity = quantity, .value = *most});
  };
  add(optimize::FeltQuantity::kInertia, in.selection.task.felt.max_inertia_kgm2);
  add(optimize::FeltQuantity::kBreakaway, in.selection.task.felt.max_breakaway_Nm);
  add(optimize::FeltQuantity::kTransparency, in.selection.task.felt.max_transparency);
  return task;
}

optimize::FeltTask read_felt(const CoDesignInput& in, const std::string& file,
                             const FileReading& reading, std::vector<std::string>& notes) {
  const std::string path = (std::filesystem::path(file).parent_path() / in.motor).string();
  check_named_file(path, "actuator.motor", reading.place_of("actuator.motor"));
  ActuatorFiles files = read_actuator(path);
  note(unread_of(files, path, {"load.", "limits."}, reading), notes);
  return felt_of(in, files.actuator.motor, std::move(files.inputs));
}

void check_felt_task(const optimize::Specification& spec, FileReading& reading) {
  if (!efficiency::depends_on_state(spec.friction)) return;
  reading.error_at("friction.law",
                   "actuator.limits of what is felt with friction that depends on load or speed: "
                   "allowed: a constant friction.coefficient");
}

void check_cycle_energy(const optimize::Specification& spec, FileReading& reading) {
  if (spec.objectives.size() > 1) {
    reading.error_at(
        "objective",
        "objective: \"cycle_energy\" among others: allowed: by itself (`gear3k actuator "
        "--select` weighs masses of motors and gearboxes)");
  }
  if (efficiency::depends_on_state(spec.friction)) {
    reading.error_at("friction.law",
                     "objective \"cycle_energy\" with friction that depends on load or speed: "
                     "allowed: a constant friction.coefficient");
  }
}

}  // namespace gear3k::io
