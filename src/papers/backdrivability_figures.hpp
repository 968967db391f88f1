#pragma once
// The backdrivability paper's Figs. 8, 10 and 11 and its scaling laws, from our own models.

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "papers/backdrivability.hpp"
#include "papers/paper_figures_report.hpp"
#include "report/plot.hpp"

namespace gear3k::papers {

/// Names of the files, without .csv and .svg.
inline constexpr std::array<const char*, 4> kBackdrivabilityFigures{
    "backdrivability_fig8", "backdrivability_fig10", "backdrivability_fig11",
    "backdrivability_scaling"};

/// Stiffness over torque capacity of one 3K gearbox in other sizes, every length scaled.
/// Its points are the sizes; the fit has one series.
struct ScaledDesign {
  std::string name;
  std::vector<double> sizes;
  ScalingLaw stiffness;
};
/// examples/designs/loaded.toml in sizes from 1/2 to 2.8, without its planets' supports.
/// @throws std::invalid_argument when a size has no capacity or no stiffness
ScaledDesign scaled_design();

struct BackdrivabilityFigures {
  BackdrivabilityComparison comparison;
  std::vector<StrainWaveGearbox> strain_waves;
  ScaledDesign designed;
};

/// Where a run gives electrical power back, in per cent of the stride.
std::vector<std::pair<double, double>> regenerating_places(const KneeRun& run, double stride_s);

/// The statements for the end of the table that `reproduce` prints.
std::string backdrivability_figures_table(const BackdrivabilityFigures& figures);
/// docs/interface.md, "Figures of `reproduce`".
std::vector<FigureData> backdrivability_figure_data(const BackdrivabilityFigures& figures);
std::vector<report::Plot> backdrivability_figure_plots(const BackdrivabilityFigures& figures);

}  // namespace gear3k::papers
