#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "report/diagnosis_plot.hpp"
#include "report/display.hpp"
#include "report/motion_diagnosis_report.hpp"

namespace gear3k::report {

namespace {

using calibrate::MotionDiagnosis, calibrate::MotionWindow;

constexpr const char* kMeasuredPlot = "measured_vs_simulated";
constexpr const char* kResidualPlot = "residuals";

/// Windows that look alike.
struct WindowSeries {
  int flow, sense;
  const char* title;
  const char* style;  ///< point type and colour
};
constexpr std::array<WindowSeries, 4> kWindowSeries{
    {{.flow = 1, .sense = 1, .title = "flow forward, +", .style = "pt 7 lc rgb '#1f5fa8'"},
     {.flow = -1, .sense = 1, .title = "flow backward, +", .style = "pt 7 lc rgb '#c0392b'"},
     {.flow = 1, .sense = -1, .title = "flow forward, -", .style = "pt 6 lc rgb '#1f5fa8'"},
     {.flow = -1, .sense = -1, .title = "flow backward, -", .style = "pt 6 lc rgb '#c0392b'"}}};

using Points = std::vector<double>;

/// Data blocks of all series and what plots them after the layers given.
std::string window_panel(const MotionDiagnosis& d, const std::string& name, const Points& x,
                         const Points& y, const std::string& first) {
  // Thinned series by series: of senses that alternate every second window has but one.
  const std::size_t stride =
      std::max<std::size_t>(1, (d.rows.size() + kMostPlottedRows - 1) / kMostPlottedRows);
  std::string data, plots = first;
  int count = 0;
  for (const WindowSeries& series : kWindowSeries) {
    std::string points;
    std::size_t seen = 0;
    for (std::size_t k = 0; k < d.rows.size(); ++k) {
      const MotionWindow& w = d.rows[k];
      if (w.flow != series.flow || w.sense != series.sense || seen++ % stride != 0) continue;
      points += fmt::format("{} {}\n", exact(clean(x[k])), exact(clean(y[k])));
    }
    if (points.empty()) continue;
    const std::string block = fmt::format("${}{}", name, ++count);
    data += fmt::format("{} << EOD\n{}EOD\n", block, points);
    plots += fmt::format(", \\\n  {} using 1:2 with points ps 0.55 {} title {}", block,
                         series.style, plot_text(series.title));
  }
  return fmt::format("{}plot {}\n", data, plots);
}

std::string motion_subject(const MotionDiagnosisResult& r) {
  return r.subject.empty() ? "" : r.subject + ": ";
}

std::string torque_script(const MotionDiagnosisResult& r) {
  const MotionDiagnosis& d = r.diagnosis;
  Points measured, stated, found;
  for (std::size_t k = 0; k < d.rows.size(); ++k) {
    measured.push_back(d.rows[k].motor_Nm / d.rows[k].term[4]);
    stated.push_back(measured.back() - d.baseline[k]);
    found.push_back(measured.back() - d.extended[k]);
  }
  Points all = measured;
  all.insert(all.end(), stated.begin(), stated.end());
  all.insert(all.end(), found.begin(), found.end());
  std::string text = plot_prologue(1000, 560);
  text += panels_beside(motion_subject(r) + "means of the windows, logged against simulated");
  text +=
      "set xlabel 'simulated motor torque at the output (Nm)'\n"
      "set ylabel 'logged motor torque at the output (Nm)'\n";
  text += plot_range("x", all) + plot_range("y", all);
  const std::string diagonal = "x with lines lc rgb '#808080' notitle";
  text += fmt::format("set title 'as stated: {:.3g} Nm off (noise {:.3g} Nm)'\n", d.baseline_Nm,
                      d.noise_Nm);
  text += window_panel(d, "before", stated, measured, diagonal);
  text += d.effects.empty() ? "unset key\nset title 'no cause added'\n"
                            : fmt::format("unset key\nset title 'with the causes: {:.3g} Nm off'\n",
                                          d.extended_Nm);
  text += window_panel(d, "after", found, measured, diagonal);
  return text + "unset multiplot\n";
}

/// Along what the first cause acts.
struct WindowAxis {
  const char* title;
  std::size_t term;  ///< of MotionWindow
  double sign;
};

WindowAxis axis_of(const MotionDiagnosis& d) {
  constexpr WindowAxis kAcceleration{
      .title = "acceleration of the output (rad/s2)", .term = 0, .sign = 1.0};
  const std::string_view id =
      d.effects.empty() ? "" : calibrate::kDriveCauses.at(d.effects.front().cause).id;
  if (id.empty() || id.starts_with("drag_")) {
    return {.title = "speed of the output (rad/s)", .term = 1, .sign = 1.0};
  }
  const bool load = std::ranges::any_of(d.rows, [](const auto& w) { return w.term[3] != 0.0; });
  if (id == "inertia" || !load) return kAcceleration;
  return {.title = "torque of the load at the output (Nm)", .term = 3, .sign = -1.0};
}

std::string motion_residual_script(const MotionDiagnosisResult& r) {
  const MotionDiagnosis& d = r.diagnosis;
  const WindowAxis axis = axis_of(d);
  Points x;
  for (const MotionWindow& w : d.rows) x.push_back(axis.sign * w.term.at(axis.term) / w.term[4]);
  Points all = d.baseline;
  all.insert(all.end(), d.extended.begin(), d.extended.end());
  all.push_back(0.0);
  std::string text = plot_prologue(900, 720);
  text += panels_below(motion_subject(r) + "logged less simulated, means of the windows");
  text += fmt::format("set xlabel '{}'\nset ylabel 'residual of the motor torque (Nm)'\n{}{}",
                      axis.title, plot_range("x", x), plot_range("y", all));
  const std::string noise = fmt::format(
      "0 with lines lc rgb '#404040' notitle, {0} with lines dt 2 lc rgb '#808080' title "
      "'noise ±1 sd', -{0} with lines dt 2 lc rgb '#808080' notitle",
      exact(d.noise_Nm));
  text += "set label 1 'as stated' at graph 0.02,0.94 left front\n";
  text += window_panel(d, "before", x, d.baseline, noise);
  text += fmt::format("unset key\nset label 1 '{}' at graph 0.02,0.94 left front\n",
                      d.effects.empty() ? "no cause added" : "with the causes");
  text += window_panel(d, "after", x, d.extended, noise);
  return text + "unset multiplot\n";
}

}  // namespace

std::vector<Plot> motion_diagnosis_plots(const MotionDiagnosisResult& result) {
  if (result.diagnosis.rows.empty()) return {};
  return {{.name = kMeasuredPlot, .script = torque_script(result)},
          {.name = kResidualPlot, .script = motion_residual_script(result)}};
}

std::vector<std::string> motion_diagnosis_plot_names() { return {kMeasuredPlot, kResidualPlot}; }

}  // namespace gear3k::report
