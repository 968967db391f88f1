#pragma once
// ACTUATOR.toml.

#include <string>
#include <vector>

#include "actuator/actuator.hpp"

namespace gear3k::io {

/// An actuator, and the paths of all that was read.
struct ActuatorFiles {
  actuator::Actuator actuator;
  std::vector<std::string> inputs;
  std::vector<std::string> stated;  ///< paths of the keys that the file states
};

/// Reads an ACTUATOR file, and the DESIGN file that it names (seen from its own folder).
/// @throws InvalidInput with every error of both files
ActuatorFiles read_actuator(const std::string& path);
/// An actuator from a text; `name` stands for the file in messages and for its folder.
actuator::Actuator parse_actuator(const std::string& text, const std::string& name);

/// The file of an actuator whose gearbox is a DESIGN file.
/// @param design  its path as seen from the file
std::string actuator_text(const actuator::Actuator& actuator, const std::string& design);
/// The file of an actuator with catalogue values, play included.
std::string actuator_text(const actuator::Actuator& actuator);

/// Table of the keys, in Markdown.
std::string actuator_key_table();

}  // namespace gear3k::io
