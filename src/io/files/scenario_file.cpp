#include "io/files/scenario_file.hpp"

#include <filesystem>

#include "io/files/document_kind.hpp"
#include "io/keys/scenario_keys.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

namespace {

constexpr std::size_t kMostTableBytes = std::size_t{1} << 28U;

/// The command of the mode.
void take_command(const ScenarioInput& in, motion::Signal& command) {
  using motion::Control;
  switch (in.scenario.control) {
    case Control::kTorque:
      command.constant = in.torque_Nm;
      command.amplitude = in.torque_amplitude_Nm;
      break;
    case Control::kVoltage:
      command.constant = in.voltage_V;
      command.amplitude = in.voltage_amplitude_V;
      break;
    case Control::kPosition:
      command.constant = in.angle_rad;
      command.amplitude = in.angle_amplitude_rad;
      break;
    case Control::kShorted:
    case Control::kOpen:
      break;
  }
}

std::vector<std::string> command_columns(motion::Control control) {
  switch (control) {
    case motion::Control::kVoltage:
      return {"voltage_v"};
    case motion::Control::kPosition:
      return {"angle_rad"};
    default:
      return {"motor_torque_nm"};
  }
}

using TableText = std::function<std::string(const std::string&)>;

std::string text_of_file(const std::string& path) {
  return read_text(path, "a CSV file", kMostTableBytes);
}

ScenarioFiles scenario_from(const TomlValue& document, const std::string& name,
                            const TableText& table_text) {
  refuse_other_documents(document, name, {DocumentKind::kScenario},
                         "SCENARIO takes a file with [control]");
  FileReading reading(name);
  ScenarioInput input;
  read_by_schema(document, scenario_schema(), input, reading);
  check_scenario(input, reading);
  ScenarioFiles files{.scenario = input.scenario, .inputs = {name}};
  take_command(input, files.scenario.command);
  CollectedErrors errors;
  errors.attempt([&] { reading.throw_if_invalid(); });
  const auto folder = std::filesystem::path(name).parent_path();
  const auto read_table = [&](const std::string& file, const TimeTableKind& kind,
                              motion::Signal& signal, const std::string& key) {
    if (file.empty()) return;
    errors.attempt([&] {
      const std::string path = (folder / file).string();
      files.inputs.push_back(path);
      parse_time_table(text_of_named_file(table_text, path, key, reading.place_of(key)), path, kind,
                       signal);
    });
  };
  read_table(input.control_table, {.columns = command_columns(input.scenario.control)},
             files.scenario.command, "control.table");
  read_table(input.load_table, {.columns = {"torque_nm", "load_nm"}, .torque_of_load = true},
             files.scenario.load.torque_Nm, "load.table");
  errors.raise();
  return files;
}

}  // namespace

ScenarioFiles read_scenario(const std::string& path) {
  return scenario_from(read_toml(path), path, text_of_file);
}

ScenarioFiles parse_scenario(const std::string& text, const std::string& name) {
  return scenario_from(parse_toml(text, name), name, text_of_file);
}

ScenarioFiles parse_scenario(const std::string& text, const std::string& name,
                             const TableText& table_text) {
  return scenario_from(parse_toml(text, name), name, table_text);
}

std::string scenario_key_table() { return key_table(scenario_schema()); }

}  // namespace gear3k::io
