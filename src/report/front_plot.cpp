#include "report/front_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

struct FrontAxes {
  std::string title;
  std::vector<std::string> names;           ///< of the objectives, with their units
  std::vector<std::vector<double>> values;  ///< by design, in those units
};

constexpr std::size_t kPanelsInARow = 3;

std::string front_panel(const FrontAxes& front, std::size_t k) {
  const std::size_t count = front.names.size();
  std::string script = fmt::format("set xlabel {}\nset ylabel {}\n", plot_text(front.names[k]),
                                   plot_text(front.names[0]));
  if (count == 2) {
    return script + "plot $front using 2:1 with points pt 7 ps 0.8 lc rgb '#1f5fa8' notitle\n";
  }
  const std::size_t colour = k + 1 < count ? k + 1 : 1;
  return script + fmt::format(
                      "set cblabel {} offset 1.5,0\nset rmargin 14\nplot $front using {}:1:{} with "
                      "points pt 7 ps 0.8 lc "
                      "palette notitle\n",
                      plot_text(front.names[colour]), k + 1, colour + 1);
}

Plot front_plot(const FrontAxes& front) {
  const std::size_t panels = front.names.size() - 1;
  const std::size_t columns = std::min(panels, kPanelsInARow);
  const std::size_t rows = (panels + columns - 1) / columns;
  std::string script = plot_prologue(static_cast<int>(columns == 1 ? 640 : 520 * columns),
                                     static_cast<int>(60 + 400 * rows));
  script += "$front << EOD\n";
  for (const std::vector<double>& design : front.values) {
    for (const double value : design) script += exact(value) + " ";
    script += "\n";
  }
  script += fmt::format(
      "EOD\nset multiplot layout {},{} title {}\nset format '%g'\nset grid lc rgb '#e0e0e0'\n"
      "set offsets graph 0.04, graph 0.04, graph 0.04, graph 0.04\n"
      "set palette defined (0 '#1f5fa8', 0.5 '#9ab8a0', 1 '#e08e0b')\n",
      rows, columns, plot_text(front.title));
  for (std::size_t k = 1; k <= panels; ++k) script += front_panel(front, k);
  return {.name = "pareto", .script = script + "unset multiplot\n"};
}

/// An objective as reports show it: efficiencies and shares, which have no unit, in per cent.
struct ShownObjective {
  std::string axis;
  double per_unit;  ///< SI value of one unit of the axis
};
ShownObjective shown_objective(optimize::Objective objective) {
  const optimize::ObjectiveRecord& record = optimize::objective_record(objective);
  if (record.unit.empty()) {
    return {.axis = fmt::format("{} (%)", record.title), .per_unit = 0.01 * record.per_unit};
  }
  return {.axis = fmt::format("{} ({})", record.title, record.unit), .per_unit = record.per_unit};
}

}  // namespace

Plot pareto_plot(const optimize::Specification& spec, const optimize::ParetoFront& front) {
  FrontAxes axes{
      .title = fmt::format("{}Pareto front, {} designs", spec.name.empty() ? "" : spec.name + ": ",
                           front.points.size()),
      .names = {},
      .values = {}};
  for (const optimize::Objective objective : spec.objectives) {
    axes.names.push_back(shown_objective(objective).axis);
  }
  for (const optimize::ParetoPoint& point : front.points) {
    std::vector<double> values;
    for (std::size_t k = 0; k < spec.objectives.size(); ++k) {
      values.push_back(point.values[k] / shown_objective(spec.objectives[k]).per_unit);
    }
    axes.values.push_back(std::move(values));
  }
  return front_plot(axes);
}

Plot selection_plot(const actuator::SelectionTask& task, const actuator::Selection& selection) {
  using actuator::Objective;
  FrontAxes axes{.title = fmt::format("{}: front of {} pairs", task.name, selection.front.size()),
                 .names = {},
                 .values = {}};
  for (const Objective objective : task.objectives) {
    constexpr std::array<const char*, 5> kNames{"energy (J)", "mass (kg)", "peak current (A)",
                                                "breakaway (N m)",
                                                "inertia at the output (kg m^2)"};
    axes.names.emplace_back(kNames[static_cast<std::size_t>(objective)]);
  }
  for (const actuator::PairResult& r : selection.front) {
    const std::array values{r.energy_J, r.mass_kg.value_or(0.0), r.peak_current_A,
                            r.breakaway_Nm.value_or(0.0), r.inertia_kgm2};
    std::vector<double> row;
    for (const Objective objective : task.objectives) {
      row.push_back(values[static_cast<std::size_t>(objective)]);
    }
    axes.values.push_back(std::move(row));
  }
  return front_plot(axes);
}

}  // namespace gear3k::report
