#pragma once
// Gearboxes of a selection that are still to be designed.

#include <vector>

#include "io/files/selection_file.hpp"
#include "optimize/progress.hpp"
#include "report/selection_report.hpp"

namespace gear3k::app {

/// Makes the designs of the selection's SPEC files, the best of every tooth set, and puts them
/// after its other gearboxes.
/// @param progress  may be watched; its stop ends the work with what is done
std::vector<report::MadeGearbox> make_gearboxes(io::SelectionFiles& files,
                                                optimize::Progress& progress);

}  // namespace gear3k::app
