#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "papers/backdrivability_figures.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::papers {

namespace {

using report::fixed, report::percent, report::plot_prologue, report::plot_text, report::rpm;

constexpr const char* kBlue = "#1f5fa8";
constexpr const char* kRed = "#c0392b";
constexpr const char* kOrange = "#e08e0b";
constexpr const char* kFrame = "set grid lc rgb '#e6e6e6' lt 1\nset format '%g'\n";

/// Coordinates of a plot need no more.
std::string coordinate(double value) { return fmt::format("{:.8g}", value); }

std::string data_block(const char* name, const std::string& rows) {
  return fmt::format("${} << EOD\n{}EOD\n", name, rows);
}

std::string point_row(double x, double y) {
  return fmt::format("{} {}\n", coordinate(x), coordinate(y));
}

/// A power law through the geometric mean of points, from end to end.
std::string power_line(const std::vector<ScalingPoint>& points, double exponent) {
  double x_mean = 0.0;
  double y_mean = 0.0;
  double least = points.front().x[0];
  double most = least;
  for (const ScalingPoint& p : points) {
    x_mean += std::log(p.x[0]) / static_cast<double>(points.size());
    y_mean += std::log(p.y) / static_cast<double>(points.size());
    least = std::min(least, p.x[0]);
    most = std::max(most, p.x[0]);
  }
  std::string rows;
  for (const double x : {least / 1.5, 1.5 * most}) {
    rows += point_row(x, std::exp(y_mean + exponent * (std::log(x) - x_mean)));
  }
  return rows;
}

std::string stiffness_script(const BackdrivabilityFigures& f) {
  std::string first;
  std::string last;
  std::vector<ScalingPoint> last_points;
  for (const StrainWaveGearbox& g : f.strain_waves) {
    first += point_row(g.rated_Nm, g.first_stiffness_Nm_rad);
    last += point_row(g.rated_Nm, g.last_stiffness_Nm_rad);
    last_points.push_back({.series = "K3", .y = g.last_stiffness_Nm_rad, .x = {g.rated_Nm}});
  }
  std::string designed;
  for (const ScalingPoint& p : f.designed.stiffness.points) designed += point_row(p.x[0], p.y);
  std::string text = plot_prologue(900, 620) + kFrame;
  text +=
      "set title 'stiffness over torque' offset 0,0.3\nset logscale xy\n"
      "set xlabel 'torque (N m)'\nset ylabel 'stiffness at the output (N m/rad)'\n"
      "set key top left Left reverse\n";
  text += data_block("first", first) + data_block("last", last) + data_block("designed", designed);
  text += data_block("line", power_line(last_points, 1.0));
  text += data_block("printed", power_line(last_points, 5.0 / 3.0));
  text += data_block("designed_line", power_line(f.designed.stiffness.points, 1.0));
  text += fmt::format(
      "plot $line using 1:2 with lines lw 1.5 lc rgb '#808080' title 'K ~ T, eq. 31 corrected', "
      "\\\n  $designed_line using 1:2 with lines lw 1.5 lc rgb '#808080' notitle, \\\n"
      "  $printed using 1:2 with lines lw 1.5 dt 2 lc rgb '#808080' title 'eq. 31 as printed', "
      "\\\n  $first using 1:2 with points pt 6 ps 1.2 lw 2 lc rgb '{}' title 'RT1 K1', \\\n"
      "  $last using 1:2 with points pt 7 ps 1.2 lc rgb '{}' title 'RT1 K3', \\\n"
      "  $designed using 1:2 with points pt 5 ps 1.2 lc rgb '{}' title {}\n",
      kBlue, kBlue, kRed, plot_text(f.designed.name + ", its sizes"));
  return text;
}

std::string stride_script(const KneeExample& knee) {
  const actuator::Cycle& c = knee.cycle;
  std::string rows;
  for (std::size_t k = 0; k < c.time_s.size(); ++k) {
    rows += fmt::format("{} {} {} {}\n", coordinate(percent(c.time_s[k] / c.time_s.back())),
                        coordinate(-c.load_Nm[k] * c.motion[k]), coordinate(-c.load_Nm[k]),
                        coordinate(rpm(c.motion[k])));
  }
  std::string text = plot_prologue(900, 760);
  text += data_block("stride", rows) + kFrame;
  int object = 0;
  for (const NegativeStretch& n : knee.negative) {
    text += fmt::format(
        "set object {} rectangle from {},graph 0 to {},graph 1 behind fc rgb '#f3e3e0' "
        "fillstyle solid noborder\n",
        ++object, coordinate(percent(n.from_s / c.time_s.back())),
        coordinate(percent(n.to_s / c.time_s.back())));
  }
  text +=
      "set multiplot layout 3,1 title 'a knee of 75 kg over a stride; shaded: negative power'\n"
      "set lmargin 12\nset xrange [0:100]\nset xzeroaxis lc rgb '#404040'\nunset key\n"
      "set xlabel 'stride (%)'\n";
  constexpr std::array<const char*, 3> kLabels{"power (W)", "torque (N m)", "speed (rpm)"};
  for (std::size_t k = 0; k < kLabels.size(); ++k) {
    text += fmt::format("set ylabel '{}'\nplot $stride using 1:{} with lines lw 2 lc rgb '{}'\n",
                        kLabels[k], k + 2, kBlue);
  }
  return text + "unset multiplot\n";
}

std::string electrical_script(const KneeExample& knee) {
  constexpr std::array<const char*, 3> kBlocks{"printed", "equations", "corrected"};
  const double stride = knee.cycle.time_s.back();
  std::string text = plot_prologue(900, 760);
  for (std::size_t k = 0; k < knee.runs.size() && k < kBlocks.size(); ++k) {
    std::string rows;
    for (const actuator::MotorInstant& p : knee.runs[k].duty.instants) {
      rows += fmt::format("{} {} {}\n", coordinate(percent(p.time_s / stride)),
                          coordinate(-p.load_Nm * p.speed_rad_s), coordinate(p.electrical_W));
    }
    text += data_block(kBlocks[k], rows);
  }
  text += kFrame;
  text += fmt::format(
      "set multiplot layout 2,1 title 'SHF-17-120 with EC45 flat at a knee of 75 kg'\n"
      "set lmargin 12\nset xrange [0:100]\nset xzeroaxis lc rgb '#404040'\n"
      "set xlabel 'stride (%)' offset 0,0.6\nset ylabel 'power (W)'\nset key outside top center "
      "horizontal\n"
      "plot $corrected using 1:2 with lines lw 2 lc rgb '{0}' title 'mechanical, of the knee', "
      "\\\n  $equations using 1:3 with lines lw 1.5 lc rgb '{1}' title 'electrical, the paper''s "
      "own equations', \\\n  $corrected using 1:3 with lines lw 2 lc rgb '{2}' title 'electrical, "
      "corrected'\n"
      "plot $printed using 1:3 with lines lw 1.5 lc rgb '#808080' title 'electrical, eqs. 38, 41, "
      "42, 45 as printed', \\\n  $printed using 1:2 with lines lw 2 lc rgb '{0}' title "
      "'mechanical, of the knee'\nunset multiplot\n",
      kBlue, kOrange, kRed);
  return text;
}

/// One law: what a table has over what the law gives.
std::string law_panel(const ScalingLaw& law, std::size_t number) {
  const std::string name = fmt::format("law{}", number);
  std::string rows;
  double least = law.points.front().y;
  double most = least;
  for (const ScalingPoint& p : law.points) {
    rows += point_row(fitted_value(law, p), p.y);
    least = std::min({least, p.y, fitted_value(law, p)});
    most = std::max({most, p.y, fitted_value(law, p)});
  }
  std::string exponents;
  for (const ScalingFactor& f : law.factors) {
    exponents += fmt::format(" {}^{}", f.symbol, fixed(f.exponent, 2));
  }
  const double band = std::exp(2.0 * law.scatter);
  std::string text = data_block(name.c_str(), rows);
  // A tick for every decade, or every second one where there are many.
  text += fmt::format("set tics {}\n", most > 1e4 * least ? 100 : 10);
  text += fmt::format(
      "set title {}\nset xlabel {}\nset ylabel {}\nset xrange [{}:{}]\n"
      "set yrange [{}:{}]\n",
      plot_text(law.quantity + " ~" + exponents),
      plot_text(fmt::format("by the law ({})", law.unit)),
      plot_text(fmt::format("in the table ({})", law.unit)), coordinate(least / 1.5),
      coordinate(1.5 * most), coordinate(least / 1.5), coordinate(1.5 * most));
  text += fmt::format(
      "plot x with lines lw 1.5 lc rgb '#404040', x*{0} with lines dt 2 lc rgb '#909090', x/{0} "
      "with lines dt 2 lc rgb '#909090', ${1} using 1:2 with points pt 7 ps 0.35 lc rgb '{2}'\n",
      coordinate(band), name, kBlue);
  return text;
}

std::string scaling_script(const std::vector<ScalingLaw>& laws) {
  std::string text = plot_prologue(1300, 1300) + kFrame;
  text +=
      "set multiplot layout 4,3 title 'scaling laws: table over fit, dashed twice the scatter'\n"
      "unset key\nset logscale xy\nset format '%.0e'\nset samples 20\n";
  for (std::size_t k = 0; k < laws.size(); ++k) text += law_panel(laws[k], k + 1);
  return text + "unset multiplot\n";
}

}  // namespace

std::vector<report::Plot> backdrivability_figure_plots(const BackdrivabilityFigures& figures) {
  const KneeExample& knee = figures.comparison.knee;
  return {{.name = kBackdrivabilityFigures[0], .script = stiffness_script(figures)},
          {.name = kBackdrivabilityFigures[1], .script = stride_script(knee)},
          {.name = kBackdrivabilityFigures[2], .script = electrical_script(knee)},
          {.name = kBackdrivabilityFigures[3], .script = scaling_script(figures.comparison.laws)}};
}

}  // namespace gear3k::papers
