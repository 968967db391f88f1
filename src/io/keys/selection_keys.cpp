#include "io/keys/selection_keys.hpp"

#include <fmt/format.h>

#include "io/keys/actuator_keys.hpp"

namespace gear3k::io {

namespace {

using units::Unit;
using Selected = SelectionInput;

/// A path as seen from the file.
Key<Selected> path_key(std::string path, std::string Selected::*member, std::string help) {
  return make_key<Selected>(
      {.path = std::move(path), .type = KeyType::kText, .required = true, .help = std::move(help)},
      member);
}

std::vector<Key<Selected>> keys_of_selection() {
  const auto of_task = [](auto member) {
    return [member](auto& t, std::size_t) -> auto& { return t.task.*member; };
  };
  const auto of_drive = [](auto member) {
    return [member](auto& t, std::size_t) -> auto& { return t.task.drive.*member; };
  };
  using actuator::Drive, actuator::SelectionTask;
  std::vector<Key<Selected>> keys{
      make_key<Selected>({.path = "name",
                          .type = KeyType::kText,
                          .default_text = "\"\"",
                          .help = "name in tables and results"},
                         of_task(&SelectionTask::name)),
      path_key("motors", &Selected::motors, "CSV of motors, as data/motor_catalogue.csv"),
      make_key<Selected>(
          {.path = "gearboxes",
           .type = KeyType::kTexts,
           .required = true,
           .help = "CSV of gearboxes, as data/planetary_gearbox_catalogue.csv, pareto.csv "
                   "or refined.csv of `optimize`, DESIGN.toml, SPEC.toml of `optimize`, whose "
                   "designs are made, or a list of them"},
          &Selected::gearboxes),
      make_key<Selected>({.path = "cycles",
                          .type = KeyType::kTexts,
                          .required = true,
                          .help = "CYCLE.csv, or a list of them"},
                         &Selected::cycles),
      make_key<Selected>({.path = "weights",
                          .type = KeyType::kNumbers,
                          .min = 0.0,
                          .max = 1e9,
                          .min_excluded = true,
                          .default_text = "1 for each",
                          .help = "how often each cycle is run"},
                         of_task(&SelectionTask::weights)),
      make_key<Selected>(
          {.path = "objective",
           .type = KeyType::kChoices,
           .choices = {actuator::kObjectiveNames.begin(), actuator::kObjectiveNames.end()},
           .default_text = "[\"energy\", \"mass\"]",
           .help = "what is to be small; of several the Pareto front. energy: from the "
                   "bus, less what goes back; inertia: reflected, of motor and gearbox"},
          of_task(&SelectionTask::objectives)),
      make_key<Selected>(number("gearbox.efficiency_backward_over_forward", Unit::kNone,
                                within(-1000.0, 1000.0), "1",
                                "backward efficiency over the catalogue's efficiency, of which no "
                                "catalogue tells; at most 1 is taken"),
                         &Selected::backward_over_forward),
      make_key<Selected>(number("load.inertia_kgm2", Unit::kKilogramSquareMetre, within(0.0, 1e9),
                                "0", "of the load, at the output"),
                         of_task(&SelectionTask::load_inertia_kgm2)),
      make_key<Selected>(number("drive.bus_voltage_v", Unit::kNone, above(0.0, 1e6),
                                "the motor's nominal voltage", "greatest voltage at the motor"),
                         of_drive(&Drive::bus_voltage_V)),
      make_key<Selected>(number("drive.efficiency_motoring", Unit::kNone, above(0.0, 1.0), "1",
                                "motor's power over that from the bus"),
                         of_drive(&Drive::efficiency_motoring)),
      make_key<Selected>(number("drive.efficiency_regenerating", Unit::kNone, within(0.0, 1.0), "1",
                                "power to the bus over that of the motor; 0: a chopper burns it"),
                         of_drive(&Drive::efficiency_regenerating)),
      make_key<Selected>(number("drive.standby_w", Unit::kNone, within(0.0, 1e6), "0",
                                "power that the drive takes at any time"),
                         of_drive(&Drive::standby_W)),
      make_key<Selected>(number("limits.peak_current_factor", Unit::kNone, above(0.0, 1e6),
                                "no limit", "greatest current over the motor's nominal current"),
                         of_task(&SelectionTask::peak_current_factor)),
      make_key<Selected>(number("limits.max_winding_c", Unit::kCelsius, within(-200.0, 1000.0),
                                "no limit", "greatest steady temperature of the winding"),
                         of_task(&SelectionTask::max_winding_K)),
      make_key<Selected>(number("limits.ambient_c", Unit::kCelsius, within(-200.0, 1000.0), "25",
                                "temperature of the surroundings"),
                         of_task(&SelectionTask::ambient_K))};
  append_keys(
      keys, felt_keys(), [](auto& t, std::size_t) -> auto& { return t.task.felt; });
  return keys;
}

}  // namespace

const Schema<SelectionInput>& selection_schema() {
  static const Schema<SelectionInput> schema({}, keys_of_selection());
  return schema;
}

void check_selection(const SelectionInput& input, FileReading& reading) {
  const actuator::SelectionTask& task = input.task;
  check_felt(task.felt, "", reading);
  if (reading.has("motors") && input.motors.empty()) {
    reading.error_at("motors", "motors = \"\": allowed: the name of a CSV of motors");
  }
  for (auto at = task.objectives.begin(); at != task.objectives.end(); ++at) {
    if (std::find(task.objectives.begin(), at, *at) == at) continue;
    reading.error_at("objective",
                     fmt::format("objective: \"{}\" twice: allowed: each once",
                                 actuator::kObjectiveNames[static_cast<std::size_t>(*at)]));
  }
  if (reading.stated("weights") && !task.weights.empty() &&
      task.weights.size() != input.cycles.size()) {
    reading.error_at("weights", fmt::format("weights: {} for {} cycles: allowed: one for each",
                                            task.weights.size(), input.cycles.size()));
  }
  if (task.max_winding_K && *task.max_winding_K <= task.ambient_K) {
    reading.error_at(
        "limits.max_winding_c",
        fmt::format("limits.max_winding_c = {:g}: allowed: above limits.ambient_c = {:g}",
                    units::from_si(*task.max_winding_K, Unit::kCelsius),
                    units::from_si(task.ambient_K, Unit::kCelsius)));
  }
}

}  // namespace gear3k::io
