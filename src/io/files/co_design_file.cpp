#include "io/files/co_design_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
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

/// @throws InvalidInput where no current at all keeps the winding's limit
void refuse_hot_surroundings(const actuator::Motor& motor, double ambient_K,
                             const std::string& path) {
  const std::optional<double>& most_K = motor.heat.max_winding_K;
  if (!most_K || *most_K > ambient_K) return;
  throw InvalidInput(
      fmt::format("{}: motor.max_winding_c = {:g}: allowed: above actuator.limits.ambient_c = {:g}",
                  path, units::from_si(*most_K, units::Unit::kCelsius),
                  units::from_si(ambient_K, units::Unit::kCelsius)));
}

}  // namespace

std::shared_ptr<const actuator::CoDesign> read_co_design(const CoDesignInput& input,
                                                         const std::string& file,
                                                         const FileReading& reading) {
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
      const actuator::Actuator& stated = files.actuator;
      // The first is the file itself.
      sources.insert(sources.end(), files.inputs.begin() + 1, files.inputs.end());
      refuse_hot_surroundings(stated.motor, task.ambient_K, path);
      task.motors.push_back(
          {.name = stated.name.empty() ? std::filesystem::path(path).stem().string() : stated.name,
           .motor = stated.motor,
           .nominal_current_A = std::nullopt,
           .nominal_voltage_V = std::nullopt});
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
  if (task.motors.empty()) {
    throw InvalidInput(
        fmt::format("{}: actuator.limits: max_motor_mass_kg and known_friction leave "
                    "no motor: allowed: limits that leave one",
                    reading.place_of(most ? "actuator.limits.max_motor_mass_kg"
                                          : "actuator.limits.known_friction")));
  }
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
                             const FileReading& reading) {
  const std::string path = (std::filesystem::path(file).parent_path() / in.motor).string();
  check_named_file(path, "actuator.motor", reading.place_of("actuator.motor"));
  ActuatorFiles files = read_actuator(path);
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
