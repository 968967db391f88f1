#pragma once

#include <string>

#include "report/plot.hpp"
#include "sweep/questions.hpp"

namespace gear3k::sweep {

/// Lines through the points, a colour for each.  x is logarithmic where it spans more than eight to
/// one.
/// @param name  of the figure's file, without .svg
report::Plot map_plot(const Map& map, const std::string& name);

}  // namespace gear3k::sweep
