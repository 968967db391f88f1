#pragma once

#include <vector>

#include "papers/paper_figures.hpp"
#include "report/plot.hpp"

namespace gear3k::papers {

/// The figures of kFigureNames as scripts for gnuplot.
std::vector<report::Plot> figure_plots(const PaperFigures& figures);

}  // namespace gear3k::papers
