#pragma once
// Keys of the SPEC files of `gear3k actuator --select`, and what they set.

#include <string>
#include <vector>

#include "actuator/selection.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

struct SelectionInput {
  actuator::SelectionTask task;
  std::string motors;  ///< path of a catalogue
  std::vector<std::string> gearboxes, cycles;
  double backward_over_forward = 1.0;
};

const Schema<SelectionInput>& selection_schema();

/// What the keys say together.
void check_selection(const SelectionInput& input, FileReading& reading);

}  // namespace gear3k::io
