#pragma once
// SCENARIO.toml, with the tables that it names.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/scenario.hpp"

namespace gear3k::io {

/// A scenario, and the paths of all that was read.
struct ScenarioFiles {
  motion::Scenario scenario;
  std::vector<std::string> inputs;
};

/// Reads a SCENARIO with its tables, their paths as seen from its folder.
/// @throws InvalidInput with every error of all files
ScenarioFiles read_scenario(const std::string& path);
/// The same from a text; `name` stands for the file in messages and for its folder.
ScenarioFiles parse_scenario(const std::string& text, const std::string& name);
/// The same with tables that are not files: `table_text` gives the text of each by its path.
ScenarioFiles parse_scenario(const std::string& text, const std::string& name,
                             const std::function<std::string(const std::string&)>& table_text);

/// What a table over time holds.
struct TimeTableKind {
  std::vector<std::string> columns;  ///< names of that of the values
  bool torque_of_load = false;       ///< reads the note whose torque it is (TorqueNote)
};

/// Rows of a table over time, into a signal: a column time_s that does not decrease (two rows of
/// one time are a jump, of more the first and the last count) and one of the kind's.
/// @throws InvalidInput with every error of the text
void parse_time_table(std::string_view text, const std::string& name, const TimeTableKind& kind,
                      motion::Signal& signal);

/// Table of the keys, in Markdown.
std::string scenario_key_table();

}  // namespace gear3k::io
