#include "report/turn_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using backlash::Turn, backlash::TurnPoint;

struct TurnCurve {
  const char* name;   ///< of its data block
  const char* title;  ///< in the key
  const char* color;
  double (*value)(const Turn& turn, const TurnPoint& point);
};
constexpr TurnCurve kLostMotion{
    .name = "lost",
    .title = "lost motion",
    .color = "#1f5fa8",
    .value = [](const Turn&, const TurnPoint& p) { return p.lost_motion_rad(); }};
constexpr TurnCurve kLostMotionSwing{.name = "swing",
                                     .title = "lost motion less its mean",
                                     .color = "#1f5fa8",
                                     .value = [](const Turn& turn, const TurnPoint& p) {
                                       return turn.error_backward_rad(p) -
                                              turn.error_forward_rad(p);
                                     }};
constexpr TurnCurve kForward{
    .name = "forward",
    .title = "transmission error forward",
    .color = "#2e7d32",
    .value = [](const Turn& turn, const TurnPoint& p) { return turn.error_forward_rad(p); }};
constexpr TurnCurve kBackward{
    .name = "backward",
    .title = "transmission error backward",
    .color = "#c0392b",
    .value = [](const Turn& turn, const TurnPoint& p) { return turn.error_backward_rad(p); }};

std::string plotted(double value) { return exact(clean(value)); }

/// The first `count` angles of a series as a data block, and what plots it.
struct TurnLayer {
  std::string data, plot;
};
TurnLayer layer_of(const Turn& turn, const TurnCurve& series, std::size_t count, int panel) {
  const std::size_t bin = (count + kMostTurnPoints - 1) / kMostTurnPoints;
  std::string rows;
  bool gap = false;
  for (std::size_t from = 0; from < count; from += bin) {
    bool any = false;
    double least = 0.0;
    double greatest = 0.0;
    for (std::size_t i = from; i < std::min(count, from + bin); ++i) {
      const TurnPoint& point = turn.points[i];
      if (!point.range.assembles()) continue;
      const double value = arcmin(series.value(turn, point));
      least = any ? std::min(least, value) : value;
      greatest = any ? std::max(greatest, value) : value;
      any = true;
    }
    if (any) {
      rows += fmt::format("{} {} {}\n", plotted(degrees(turn.points[from].angle_rad)),
                          plotted(least), plotted(greatest));
    } else if (!gap) {
      rows += '\n';  // interrupts the line where it jams
    }
    gap = !any;
  }
  if (rows.find_first_not_of('\n') == std::string::npos) return {};
  const std::string block = fmt::format("${}{}", series.name, panel);
  const std::string style =
      bin > 1 ? fmt::format("1:2:3 with filledcurves fs transparent solid 0.6 lc rgb '{}'",
                            series.color)
              : fmt::format("1:2 with lines lw 1.2 lc rgb '{}'", series.color);
  return {.data = fmt::format("{} << EOD\n{}EOD\n", block, rows),
          .plot = fmt::format("{} using {} title '{}'", block, style, series.title)};
}

std::string panel_script(const Turn& turn, const std::vector<TurnCurve>& all, std::size_t count,
                         int panel) {
  const double end = degrees(turn.window.revolutions * 2.0 * std::numbers::pi) *
                     static_cast<double>(count) / static_cast<double>(turn.points.size());
  std::string text = fmt::format("set xrange [0:{}]\n", plotted(end));
  std::vector<std::string> plots;
  plots.reserve(all.size());
  for (const TurnCurve& series : all) {
    const TurnLayer layer = layer_of(turn, series, count, panel);
    text += layer.data;
    if (!layer.plot.empty()) plots.push_back(layer.plot);
  }
  if (plots.empty()) {
    return text +
           "set yrange [0:1]\nset label 1 'jams at every angle' at graph 0.5,0.5 center\n"
           "plot NaN notitle\n";
  }
  return text + fmt::format("plot {}\n", fmt::join(plots, ", \\\n  "));
}

}  // namespace

Plot turn_plot(const TurnResult& result, double carrier_order) {
  const Turn& turn = result.turn;
  const std::size_t count = turn.points.size();
  const double part = 1.0 / (std::abs(carrier_order) * turn.window.revolutions);
  const auto beginning =
      static_cast<std::size_t>(std::ceil(std::min(1.0, part) * static_cast<double>(count)));
  std::string title = fmt::format("{}: one built gearbox over a turn", result.name);
  if (turn.jams()) {
    title += fmt::format(
        "; jams at {} % of the angles",
        fixed(percent(static_cast<double>(turn.jammed) / static_cast<double>(count)), 1));
  }
  std::string text = plot_prologue(1000, 900);
  text += fmt::format(
      "set multiplot layout 3,1 title {}\nset lmargin 11\nset rmargin 3\nset grid lc rgb "
      "'#e0e0e0'\nset key above right horizontal\nset format '%g'\nset samples 2\nset offsets "
      "0,0,graph 0.02,graph 0.02\nset ylabel 'lost motion (arcmin)'\n",
      plot_text(title));
  text += panel_script(turn, {kLostMotion}, count, 1);
  text += "set ylabel 'error (arcmin)'\n";
  text += panel_script(turn, {kForward, kBackward}, count, 2);
  text += "set ylabel '(arcmin)'\nset xlabel 'angle of R2 (deg)'\n";
  text += panel_script(turn, {kLostMotionSwing, kForward, kBackward}, beginning, 3);
  return {.name = "turn", .script = text + "unset multiplot\n"};
}

}  // namespace gear3k::report
