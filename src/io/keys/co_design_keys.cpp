#include "io/keys/co_design_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "io/keys/actuator_keys.hpp"

namespace gear3k::io {

namespace {

constexpr std::array<std::string_view, 4> kTaken{"motors", "drive.", "load.", "limits."};

/// The keys of a selection that a SPEC has, too, none of them required.
std::vector<Key<SelectionInput>> selection_part() {
  std::vector<Key<SelectionInput>> keys;
  for (const Key<SelectionInput>& key : selection_schema().keys()) {
    const std::string& path = key.record.path;
    if (std::ranges::any_of(kTaken,
                            [&](std::string_view start) { return path.starts_with(start); })) {
      keys.push_back(key);
      if (path == "limits.ambient_c") {
        keys.back().record.default_text = "that of actuator.motor, else 25";
      }
    } else if (path == "cycles" || path == "weights") {
      keys.push_back(key);
      keys.back().record.path = path == "cycles" ? "cycle.files" : "cycle.weights";
      if (path == "weights") keys.back().record.default_text = "each once";
    }
    if (keys.empty() || !keys.back().record.required) continue;
    keys.back().record.required = false;
    keys.back().record.default_text = "none";
  }
  return keys;
}

}  // namespace

std::vector<Key<CoDesignInput>> co_design_keys() {
  std::vector<Key<CoDesignInput>> keys;
  keys.push_back(make_key<CoDesignInput>(
      {.path = "actuator.motor",
       .type = KeyType::kText,
       .default_text = "none",
       .help = "ACTUATOR.toml of whose motor the cycle's energy is to be least, with its greatest "
               "current, speed and winding temperature, its surroundings, and drive.bus_voltage_v "
               "as nominal voltage; with motors one more of them"},
      &CoDesignInput::motor,
      [](const CoDesignInput& in, std::size_t) { return !in.motor.empty(); }));
  keys.push_back(make_key<CoDesignInput>(
      number("actuator.limits.max_motor_mass_kg", units::Unit::kKilogram, above(0.0, 1e6),
             "no limit", "greatest mass of a motor; one of unknown mass is left out then"),
      &CoDesignInput::max_motor_mass_kg));
  keys.push_back(unless_default(make_key<CoDesignInput>(
      {.path = "actuator.limits.known_friction",
       .type = KeyType::kBoolean,
       .default_text = "false",
       .help = "motors of which no friction is published are left out, instead of running without"},
      &CoDesignInput::known_friction)));
  for (const Key<SelectionInput>& key : selection_part()) {
    const bool cycle = key.record.path.starts_with("cycle.");
    append_keys(keys, std::vector{key}, &CoDesignInput::selection, cycle ? "" : "actuator.");
    if (key.record.type != KeyType::kText && key.record.type != KeyType::kTexts) continue;
    keys.back().written = [state = key.state, record = key.record](const CoDesignInput& in,
                                                                   std::size_t) {
      const auto value = state(record, in.selection, 0);
      return value && !(value->kind == TomlValue::Kind::kText && value->text.empty());
    };
  }
  return keys;
}

bool limits_felt(const CoDesignInput& in) {
  const actuator::FeltLimits& f = in.selection.task.felt;
  return f.max_inertia_kgm2 || f.max_breakaway_Nm || f.max_transparency;
}

namespace {

/// Limits of motors, which hold only where one is chosen.
constexpr std::array<std::string_view, 4> kMotorLimits{
    "actuator.drive.bus_voltage_v", "actuator.limits.peak_current_factor",
    "actuator.limits.max_winding_c", "actuator.limits.max_motor_mass_kg"};

void refuse_motor_limits(FileReading& reading) {
  for (const std::string_view key : kMotorLimits) {
    if (!reading.stated(std::string(key))) continue;
    reading.error_at(std::string(key),
                     fmt::format("{} limits a motor, which no other objective than "
                                 "\"cycle_energy\" chooses: allowed: with that objective",
                                 key));
  }
}

}  // namespace

std::vector<std::string> unread_co_design(const CoDesignInput& in, const FileReading& reading) {
  std::vector<std::string> unread;
  if (!reading.stated("actuator") && !reading.stated("cycle")) return unread;
  for (const Key<CoDesignInput>& key : co_design_keys()) {
    const std::string& path = key.record.path;
    const bool of_felt = path == "actuator.motor" || path.starts_with("actuator.load.") ||
                         path == "actuator.limits.transparency_torque_nm" ||
                         path.starts_with("actuator.limits.max_");
    if (reading.stated(path) && !(of_felt && limits_felt(in))) unread.push_back(path);
  }
  return unread;
}

void check_co_design(const CoDesignInput& in, bool wanted, FileReading& reading) {
  if (!wanted) refuse_motor_limits(reading);
  if (!wanted && limits_felt(in)) {
    if (in.motor.empty()) {
      reading.error_at("actuator.limits",
                       "actuator.limits of what is felt without actuator.motor: allowed: with the "
                       "ACTUATOR.toml of the motor (of several motors, objective \"cycle_energy\" "
                       "chooses one)");
    }
    check_felt(in.selection.task.felt, "actuator.", reading);
  }
  if (!wanted) return;
  if (!reading.stated("actuator.motors") && !reading.stated("actuator.motor")) {
    reading.error_at("actuator",
                     "objective \"cycle_energy\" without a motor: allowed: with actuator.motors, a "
                     "CSV of motors, actuator.motor, an ACTUATOR.toml, or both");
  }
  if (!reading.stated("cycle.files")) {
    reading.error_at("cycle",
                     "objective \"cycle_energy\" without cycle.files: allowed: CYCLE.csv, or a "
                     "list of them");
  }
  const actuator::SelectionTask& task = in.selection.task;
  if (reading.has("cycle.weights") && reading.has("cycle.files") &&
      task.weights.size() != in.selection.cycles.size()) {
    reading.error_at("cycle.weights",
                     fmt::format("cycle.weights: {} for {} cycles: allowed: one for each",
                                 task.weights.size(), in.selection.cycles.size()));
  }
  check_felt(task.felt, "actuator.", reading);
  if (task.max_winding_K && *task.max_winding_K <= task.ambient_K) {
    reading.error_at("actuator.limits.max_winding_c",
                     fmt::format("actuator.limits.max_winding_c = {:g}: allowed: above "
                                 "actuator.limits.ambient_c = {:g}",
                                 units::from_si(*task.max_winding_K, units::Unit::kCelsius),
                                 units::from_si(task.ambient_K, units::Unit::kCelsius)));
  }
}

}  // namespace gear3k::io
