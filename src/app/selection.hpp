#pragma once
// Gearboxes of a selection that are still to be designed.

#include <string>
#include <vector>

#include "io/files/selection_file.hpp"
#include "optimize/progress.hpp"
#include "report/selection_report.hpp"

namespace gear3k::app {

/// What the SPEC files of a selection gave.
struct MadeGearboxes {
  std::vector<report::MadeGearbox> gearboxes;
  std::vector<std::string> blocked;  ///< of each without a design: what blocks it
};

/// Makes the designs of the selection's SPEC files, the best of every tooth set, and puts them
/// after its other gearboxes.
/// @param progress  may be watched; its stop ends the work with what is done
MadeGearboxes make_gearboxes(io::SelectionFiles& files, optimize::Progress& progress);

/// Gives gearboxes of one name names of their own, as "12/36/84/33/89-knee-4planets-2": with the
/// name of their file where their files differ, the number of planets where that does, and a number
/// where neither tells them apart.  Other names stay.
void tell_apart(std::vector<actuator::CatalogueGearbox>& gearboxes);

}  // namespace gear3k::app
