#pragma once
// What gearboxes built within their tolerances will do.

#include <string>

#include "design/built_series.hpp"
#include "design/evaluation.hpp"
#include "optimize/progress.hpp"
#include "report/turn_report.hpp"

namespace gear3k::app {

struct TolerancesRequest {
  design::Design design;          ///< with tolerances; its `sampling` says how many gearboxes
  std::string source = "design";  ///< stands for the design in messages
};

struct Tolerances {
  design::Evaluation evaluation;
  design::BuiltSeries series;
  report::TurnResult turn;   ///< the first gearbox of the series over a turn
  bool interrupted = false;  ///< fewer gearboxes were built than asked for
};

/// Builds gearboxes at random within the tolerances of a design.
/// @param progress  may be watched, and ends the series early by its `stop`
/// @throws io::InvalidInput without tolerances, where the geometry is not defined, or where a mesh
/// has no working angle in the middle of the tolerances
Tolerances tolerances(const TolerancesRequest& request, optimize::Progress& progress);

}  // namespace gear3k::app
