#include "report/actuator_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

constexpr const char* kFrame =
    "set grid lc rgb '#e0e0e0'\nset key outside top center horizontal\nset format '%g'\n";

std::string title(const ActuatorResult& result, const std::string& what) {
  const std::string& name = result.actuator.name;
  return plot_text(name.empty() ? what : fmt::format("{}: {}", name, what));
}

ActuatorFigure power_figure(const ActuatorResult& result) {
  std::string data;
  for (const actuator::MotorInstant& p : result.cycle->instants) {
    data += fmt::format("{} {} {}\n", exact(p.time_s), exact(-p.load_Nm * p.speed_rad_s),
                        exact(p.electrical_W));
  }
  return {.plot = {.name = "power",
                   .script = plot_prologue(900, 520) + kFrame +
                             fmt::format("set title {}\nset xlabel 'time (s)'\n"
                                         "set ylabel 'power (W)'\nset xzeroaxis lc rgb '#404040'\n"
                                         "$power << EOD\n{}EOD\n"
                                         "plot $power using 1:2 with lines lw 2 lc rgb '#1f5fa8' "
                                         "title 'mechanical, to the load', "
                                         "$power using 1:3 with lines lw 2 lc rgb '#c0392b' "
                                         "title 'electrical, into the motor'\n",
                                         title(result, "power over " + result.cycle_name), data)},
          .csv = actuator_cycle_csv(*result.cycle)};
}

/// What the cycle costs less without a cause; 0 where it is not known.
double saved_without(const ActuatorResult& result, const std::string& cause) {
  if (!result.without_each) return 0.0;
  for (const auto& w : *result.without_each) {
    if (w.cause == cause) return w.saved_J;
  }
  return 0.0;
}

ActuatorFigure ledger_figure(const ActuatorResult& result) {
  std::string data;
  std::string csv = "cause,loss_j,saved_without_it_j\n";
  for (const auto& [cause, energy] : result.cycle->losses) {
    const double saved = saved_without(result, cause);
    data += fmt::format("\"{}\" {} {}\n", cause, exact(energy), exact(saved));
    csv += csv_line({cause, exact(energy), result.without_each ? exact(saved) : ""});
  }
  std::string script = plot_prologue(900, 520) + kFrame;
  script += fmt::format(
      "set title {}\nset ylabel 'energy per cycle (J)'\nset style data histograms\n"
      "set style histogram clustered gap 1\nset style fill solid 0.9 border rgb '#ffffff'\n"
      "set xtics rotate by -30\nset xzeroaxis lc rgb '#404040'\n$ledger << EOD\n{}EOD\n"
      "plot $ledger using 2:xtic(1) lc rgb '#1f5fa8' title 'lost'",
      title(result, "where the energy of " + result.cycle_name + " goes"), data);
  if (result.without_each) {
    script += ", $ledger using 3 lc rgb '#e08e0b' title 'saved without this cause'";
  }
  return {.plot = {.name = "ledger", .script = script + '\n'}, .csv = csv};
}

/// One panel over frequency: a total and what each cause adds.
struct ImpedancePanel {
  const char* label;
  const char* scale;
  double (*value)(const std::complex<double>&);
};
/// Of which impedance.
struct ImpedanceColumn {
  const char* total;
  std::optional<std::complex<double>> actuator::ImpedancePoint::*impedance;
  std::vector<actuator::ImpedanceCause> actuator::ImpedancePoint::*causes;
};

/// Line of a cause, the same in every panel; black is the total's.
std::string look_of(const std::string& cause, std::size_t place) {
  constexpr std::array<std::pair<std::string_view, const char*>, 11> kColours{
      {{"motor_inertia", "#1f5fa8"},
       {"gear_inertia", "#c0392b"},
       {"load_inertia", "#8d6e63"},
       {"motor_viscous", "#e08e0b"},
       {"short_circuit", "#16a0a0"},
       {"gear_viscous", "#2e8b57"},
       {"motor_stiffness", "#7d3c98"},
       {"gear_stiffness", "#d16ba5"},
       {"motor_coulomb", "#b8860b"},
       {"gear_coulomb", "#556b2f"},
       {"mesh", "#606060"}}};
  const auto* const known =
      std::ranges::find(kColours, std::string_view(cause), &decltype(kColours)::value_type::first);
  if (known != kColours.end()) return fmt::format("lw 1.5 lc rgb '{}'", known->second);
  // Losses of a designed gearbox.
  return fmt::format("lw 1.5 dt 2 lc {}", place);
}

std::string impedance_panel(const ActuatorResult& result, const ImpedancePanel& panel,
                            const ImpedanceColumn& column, int number) {
  std::string text = fmt::format("{}set ylabel '{}'\n", panel.scale, panel.label);
  std::vector<std::string> layers;
  const auto layer = [&](const std::string& name, const std::string& look, const auto& value_of) {
    std::string data;
    for (const actuator::ImpedancePoint& p : result.impedance) {
      const std::optional<std::complex<double>> z = value_of(p);
      if (!z || !(std::abs(*z) > 0.0)) continue;
      data += fmt::format("{} {}\n", exact(p.frequency_Hz), exact(panel.value(*z)));
    }
    if (data.empty()) return;
    const std::string block = fmt::format("$p{}_{}", number, layers.size());
    text += fmt::format("{} << EOD\n{}EOD\n", block, data);
    layers.push_back(fmt::format("{} using 1:2 with {} title {}", block, look, plot_text(name)));
  };
  layer(column.total, "linespoints pt 7 ps 0.2 lw 3 lc rgb '#000000'",
        [&](const actuator::ImpedancePoint& p) { return p.*column.impedance; });
  std::vector<std::string> names;
  for (const actuator::ImpedancePoint& p : result.impedance) {
    for (const auto& cause : p.*column.causes) {
      if (std::ranges::find(names, cause.name) == names.end()) names.push_back(cause.name);
    }
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    layer(names[k], "linespoints pt 7 ps 0.2 " + look_of(names[k], k),
          [&](const actuator::ImpedancePoint& p) -> std::optional<std::complex<double>> {
            const auto& causes = p.*column.causes;
            const auto at = std::ranges::find(causes, names[k], &actuator::ImpedanceCause::name);
            if (at == causes.end()) return std::nullopt;
            return at->impedance_Nms;
          });
  }
  if (layers.empty()) {
    // Nothing resists: an axis of its own, as there are no values to take one from.
    text += "unset logscale y\nset yrange [-1:1]\n";
    layers.emplace_back("NaN notitle");
  }
  return text + fmt::format("plot {}\n", fmt::join(layers, ", "));
}

ActuatorFigure impedance_figure(const ActuatorResult& result) {
  const actuator::ImpedanceTask& task = *result.impedance_task;
  const double span = task.high_Hz > task.low_Hz ? 1.0 : 1.1;
  const ImpedanceColumn linear{.total = "all, linear",
                               .impedance = &actuator::ImpedancePoint::impedance_Nms,
                               .causes = &actuator::ImpedancePoint::causes};
  const ImpedanceColumn harmonic{.total = "all, first harmonic",
                                 .impedance = &actuator::ImpedancePoint::first_harmonic_Nms,
                                 .causes = &actuator::ImpedancePoint::harmonic_causes};
  std::vector<ImpedanceColumn> columns{linear};
  if (task.amplitude_rad > 0.0) columns.push_back(harmonic);
  std::string script = plot_prologue(columns.size() > 1 ? 1500 : 900, 700);
  script += fmt::format(
      "set multiplot layout 2,{} title {}\nset lmargin 12\nset grid lc rgb '#e0e0e0'\n"
      "set logscale x\nset xrange [{}:{}]\nset xlabel 'frequency (Hz)'\nset format '%g'\n"
      "set key outside right top vertical\n",
      columns.size(),
      title(result,
            fmt::format("impedance of the output by cause, which add up as complex numbers; "
                        "first harmonic at {:g} rad",
                        task.amplitude_rad)),
      exact(task.low_Hz / span), exact(task.high_Hz * span));
  const std::array<ImpedancePanel, 2> panels{
      ImpedancePanel{.label = "|Z| (N m s/rad)",
                     .scale = "set logscale y\nset autoscale y\nset ytics auto\n",
                     .value = [](const std::complex<double>& z) { return std::abs(z); }},
      ImpedancePanel{.label = "phase (deg)",
                     .scale = "unset logscale y\nset yrange [-190:190]\nset ytics 45\n",
                     .value = [](const std::complex<double>& z) { return degrees(std::arg(z)); }}};
  int number = 0;
  for (const ImpedancePanel& panel : panels) {
    for (const ImpedanceColumn& column : columns) {
      script += impedance_panel(result, panel, column, ++number);
    }
  }
  return {.plot = {.name = "impedance", .script = script + "unset multiplot\n"},
          .csv = impedance_csv(result.impedance)};
}

ActuatorFigure drive_figure(const ActuatorResult& result) {
  std::string data;
  std::string csv = "load_nm,stick_low_nm,stick_high_nm,running_down_nm,running_up_nm\n";
  for (const actuator::DrivePoint& p : result.drive_diagram) {
    const std::vector<std::string> cells{exact(p.load_Nm), exact(p.stick_low_Nm),
                                         exact(p.stick_high_Nm), exact(p.running_down_Nm),
                                         exact(p.running_up_Nm)};
    data += fmt::format("{}\n", fmt::join(cells, " "));
    csv += csv_line(cells);
  }
  return {
      .plot = {.name = "drive_backdrive",
               .script =
                   plot_prologue(900, 620) + kFrame +
                   fmt::format(
                       "set title {}\nset xlabel 'load against the actuator (N m)'\n"
                       "set ylabel 'motor torque (N m)'\nset xzeroaxis lc rgb '#404040'\n"
                       "set yzeroaxis lc rgb '#404040'\n$band << EOD\n{}EOD\n"
                       "plot $band using 1:2:3 with filledcurves fc rgb '#d9d9d9' title 'sticks', "
                       "$band using 1:5 with lines lw 2 lc rgb '#1f5fa8' title 'turns forward', "
                       "$band using 1:4 with lines lw 2 lc rgb '#c0392b' title 'turns backward'\n",
                       title(result, "what drives, holds and is driven"), data)},
      .csv = csv};
}

}  // namespace

std::vector<ActuatorFigure> actuator_figures(const ActuatorResult& result) {
  std::vector<ActuatorFigure> figures;
  if (result.cycle) {
    figures.push_back(power_figure(result));
    figures.push_back(ledger_figure(result));
  }
  if (result.impedance_task) figures.push_back(impedance_figure(result));
  if (!result.drive_diagram.empty()) figures.push_back(drive_figure(result));
  return figures;
}

}  // namespace gear3k::report
