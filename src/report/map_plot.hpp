#pragma once
// Figures of an operating map, as scripts for gnuplot.

#include <vector>

#include "design/operating_map.hpp"
#include "report/plot.hpp"

namespace gear3k::report {

/// efficiency_forward, efficiency_backward, torques.
///
/// Efficiency over speed and load, a coloured cell per point, with its value where cells are large
/// enough and contour lines where they are small; grey cells have none.  Both directions share one
/// colour scale.  No-load, back-driving and breakaway torques over speed.
/// The scripts hold their data and say everything that decides the figure.
std::vector<Plot> map_plots(const design::OperatingMap& map);

}  // namespace gear3k::report
