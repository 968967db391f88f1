#include "report/actuator_plot.hpp"

#include <fmt/format.h>

#include <complex>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

constexpr const char* kFrame =
    "set grid lc rgb '#e0e0e0'\nset key outside bottom center horizontal\nset format '%g'\n";

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

/// One panel over frequency.
struct ImpedancePanel {
  const char* label;
  const char* scale;
  double (*value)(const std::complex<double>&);
};

std::string impedance_panel(const ActuatorResult& result, const ImpedancePanel& panel, int number) {
  std::string linear;
  std::string harmonic;
  for (const actuator::ImpedancePoint& p : result.impedance) {
    const std::string hertz = exact(p.frequency_Hz);
    const auto add = [&](std::string& data, const std::optional<std::complex<double>>& z) {
      if (z && std::abs(*z) > 0.0) data += fmt::format("{} {}\n", hertz, exact(panel.value(*z)));
    };
    add(linear, p.impedance_Nms);
    add(harmonic, p.first_harmonic_Nms);
  }
  std::string text = fmt::format("{}set ylabel '{}'\n", panel.scale, panel.label);
  std::vector<std::string> layers;
  const auto layer = [&](const char* name, const std::string& data, const char* look) {
    if (data.empty()) return;
    text += fmt::format("${}{} << EOD\n{}EOD\n", name, number, data);
    layers.push_back(
        fmt::format("${}{} using 1:2 with linespoints pt 7 ps 0.4 lw 2 {}", name, number, look));
  };
  layer("linear", linear, "lc rgb '#1f5fa8' title 'inertias, dampings, springs'");
  layer("harmonic", harmonic, "lc rgb '#c0392b' title 'first harmonic, losses and friction'");
  if (layers.empty()) layers.emplace_back("NaN notitle");
  return text + fmt::format("plot {}\n", fmt::join(layers, ", "));
}

ActuatorFigure impedance_figure(const ActuatorResult& result) {
  const actuator::ImpedanceTask& task = *result.impedance_task;
  const double span = task.high_Hz > task.low_Hz ? 1.0 : 1.1;
  std::string script = plot_prologue(900, 700);
  script += fmt::format(
      "set multiplot layout 2,1 title {}\nset lmargin 12\nset grid lc rgb '#e0e0e0'\n"
      "set logscale x\nset xrange [{}:{}]\nset xlabel 'frequency (Hz)'\nset format '%g'\n"
      "set key top left\n",
      title(result, fmt::format("impedance of the output at {:g} rad", task.amplitude_rad)),
      exact(task.low_Hz / span), exact(task.high_Hz * span));
  script += impedance_panel(result,
                            {.label = "|Z| (N m s/rad)",
                             .scale = "set logscale y\n",
                             .value = [](const std::complex<double>& z) { return std::abs(z); }},
                            1);
  script +=
      impedance_panel(result,
                      {.label = "phase (deg)",
                       .scale = "unset logscale y\nset yrange [-180:180]\nset ytics 45\n",
                       .value = [](const std::complex<double>& z) { return degrees(std::arg(z)); }},
                      2);
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
