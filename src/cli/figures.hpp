#pragma once
// Figures of a result, as far as gnuplot draws them.

#include <string>
#include <vector>

#include "io/text/file_set.hpp"
#include "io/text/json.hpp"
#include "report/plot.hpp"

namespace gear3k::cli {

struct Figures {
  std::vector<io::FileText> files;  ///< NAME.svg of each plot that was drawn
  struct Missing {
    std::string file, cause;
  };
  std::vector<Missing> missing;
};

/// Draws plots.  One that gnuplot cannot draw is missing, with what gnuplot says.
Figures draw(const std::vector<report::Plot>& plots);

/// A result as JSON with what it lacks: member missing_figures, [{"file", "cause"}], at its end,
/// where figures are missing.
std::string with_missing_figures(io::Json json, const Figures& figures);

}  // namespace gear3k::cli
