#pragma once
// SPEC files of `gear3k actuator --select`, and the catalogues that they name.

#include <functional>
#include <string>
#include <vector>

#include "actuator/selection.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

/// A SPEC of `optimize`, whose designs are still to be made.
struct GearboxTask {
  std::string file;
  optimize::Specification spec;
};

/// A task with all that its file names, and the paths of it.
struct SelectionFiles {
  actuator::SelectionTask task;
  std::vector<std::string> inputs;
  std::vector<GearboxTask> tasks{};  ///< among the gearboxes
};

/// Reads a SPEC with its catalogues and cycles, their paths as seen from its folder.
/// @throws InvalidInput with every error of all files
SelectionFiles read_selection(const std::string& path);
/// The same from a text with catalogues and cycles that are not files: `file_text` gives the text
/// of each by its path.  DESIGN and SPEC files among the gearboxes are read as files.
SelectionFiles parse_selection(const std::string& text, const std::string& name,
                               const std::function<std::string(const std::string&)>& file_text);

/// Motors of a catalogue: columns manufacturer, order_code, resistance_ohm,
/// torque_constant_nm_per_a and optionally those of data/motor_catalogue.csv.
std::vector<actuator::CatalogueMotor> parse_motors(const std::string& text,
                                                   const std::string& name);
/// Gearboxes of a catalogue: columns manufacturer, order_code, ratio, efficiency and optionally
/// those of data/planetary_gearbox_catalogue.csv; or, told by its column zS, the optimal tooth sets
/// of pareto.csv or refined.csv of `optimize`, with both efficiencies, and mass, inertia (at the
/// output) and torque capacity where they have them.
/// @param backward_over_forward  backward over the catalogue's efficiency
std::vector<actuator::CatalogueGearbox> parse_gearboxes(const std::string& text,
                                                        const std::string& name,
                                                        double backward_over_forward);

/// Table of the keys, in Markdown.
std::string selection_key_table();

}  // namespace gear3k::io
