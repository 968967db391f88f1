#pragma once
// The thesis's bench in what `reproduce` prints and draws.

#include <array>
#include <string>
#include <vector>

#include "io/text/json.hpp"
#include "papers/directional_bench.hpp"
#include "papers/paper_figures_report.hpp"
#include "report/plot.hpp"

namespace gear3k::papers {

std::string directional_bench_table(const DirectionalBench& bench);
io::Json directional_bench_json(const DirectionalBench& bench);
/// @param item  the lines' first field
std::string directional_bench_csv(const DirectionalBench& bench, const char* item);

/// Names of the files, without .csv and .svg.
inline constexpr std::array<const char*, 4> kDirectionalFigures{
    "directional_felt", "directional_transparency", "directional_bench", "directional_braking"};

/// The statements for the end of the table that `reproduce` prints.
std::string directional_figures_table(const DirectionalBench& bench);
/// docs/interface.md, "Figures of `reproduce`".
std::vector<FigureData> directional_figure_data(const DirectionalBench& bench);
std::vector<report::Plot> directional_figure_plots(const DirectionalBench& bench);

}  // namespace gear3k::papers
