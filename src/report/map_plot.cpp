#include "report/map_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/display.hpp"
#include "report/map_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::Direction, design::MapPair, design::MapPoint, design::MapStatus, design::MapTorque,
    design::OperatingMap, design::UnloadedTorques;

/// Above as many points on an axis, cells have no text and the axis takes round ticks.
constexpr std::size_t kMostWrittenCells = 15;

/// A range with round ticks.
struct Scale {
  double low, high, step;
};

/// The narrowest range of whole steps around some values, at least a percentage point wide.
Scale percent_scale(const std::vector<double>& values) {
  if (values.empty()) return {.low = 0.0, .high = 100.0, .step = 20.0};
  const auto [least, greatest] = std::ranges::minmax(values);
  const double lack = std::max(0.0, 1.0 - (greatest - least));
  const double low = least - 0.5 * lack;
  const double high = greatest + 0.5 * lack;
  constexpr std::array<double, 8> kSteps{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
  constexpr double kMostSteps = 12.0;
  const auto* const step =
      std::ranges::find_if(kSteps, [&](double s) { return (high - low) / s <= kMostSteps; });
  const double size = step == kSteps.end() ? std::ceil((high - low) / kMostSteps) : *step;
  return {.low = clean(std::floor(low / size) * size),
          .high = clean(std::ceil(high / size) * size),
          .step = size};
}

/// Half the distance of neighbouring points.
double half_cell(const std::vector<double>& axis) {
  const double span = std::abs(axis.back() - axis.front());
  if (span > 0.0) return 0.5 * span / static_cast<double>(axis.size() - 1);
  return axis.front() != 0.0 ? 0.1 * std::abs(axis.front()) : 0.5;
}

/// Ticks at the points while they are few.
std::string axis_text(char axis, const std::vector<double>& points) {
  const double half = half_cell(points);
  const auto [least, greatest] = std::ranges::minmax(points);
  std::string text = fmt::format("set {}range [{}:{}]\nset format {} '%g'\n", axis,
                                 exact(clean(least - half)), exact(clean(greatest + half)), axis);
  if (points.size() > kMostWrittenCells) return text;
  std::vector<std::string> ticks;
  ticks.reserve(points.size());
  for (const double point : points) ticks.push_back(fmt::format("'{0:.5g}' {0}", point));
  return text + fmt::format("set {}tics ({})\n", axis, fmt::join(ticks, ", "));
}

std::vector<double> sun_speeds_rpm(const OperatingMap& map) {
  std::vector<double> speeds(map.sun_speed_rad_s.size());
  std::ranges::transform(map.sun_speed_rad_s, speeds.begin(), rpm);
  return speeds;
}
std::vector<double> output_torques_nm(const OperatingMap& map) {
  std::vector<double> torques(map.output_torque_Nm.size());
  std::ranges::transform(map.output_torque_Nm, torques.begin(), clean);
  return torques;
}

/// The efficiency of a point that has one to show.
std::optional<double> shown_percent(const MapPoint& point) {
  if (point.status != MapStatus::kRuns || !point.operation->efficiency) return std::nullopt;
  return percent(*point.operation->efficiency);
}

Scale efficiency_scale(const OperatingMap& map) {
  std::vector<double> values;
  values.reserve(2 * map.points.size());
  for (const MapPair& pair : map.points) {
    for (const MapPoint* point : {&pair.forward, &pair.backward}) {
      if (const auto value = shown_percent(*point)) values.push_back(*value);
    }
  }
  return percent_scale(values);
}

std::string efficiency_script(const OperatingMap& map, Direction direction, const Scale& scale) {
  const std::vector<double> speeds = sun_speeds_rpm(map);
  const std::vector<double> torques = output_torques_nm(map);
  const double dx = half_cell(speeds);
  const double dy = half_cell(torques);
  const bool written = std::max(speeds.size(), torques.size()) <= kMostWrittenCells;
  const int decimals = scale.step < 0.3 ? 2 : 1;
  std::string cells;   // with a value
  std::string blanks;  // without
  std::string grid;    // for contours
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    for (std::size_t j = 0; j < torques.size(); ++j) {
      const MapPoint& point = point_of(map.points[i * torques.size() + j], direction);
      const auto value = shown_percent(point);
      const std::string box =
          fmt::format("{} {} {} {} {} {}", exact(speeds[i]), exact(torques[j]),
                      exact(clean(speeds[i] - dx)), exact(clean(speeds[i] + dx)),
                      exact(clean(torques[j] - dy)), exact(clean(torques[j] + dy)));
      if (value) {
        cells += fmt::format("{} {} \"{:.{}f}\"\n", box, exact(clean(*value)), *value, decimals);
      } else {
        blanks += fmt::format("{} \"{}\"\n", box, absence(point.status));
      }
      grid += fmt::format("{} {} {}\n", exact(speeds[i]), exact(torques[j]),
                          value ? exact(clean(*value)) : "NaN");
    }
    grid += '\n';
  }
  const bool contours = !written && !cells.empty() && std::min(speeds.size(), torques.size()) > 1;
  const bool forward = direction == Direction::kForward;
  std::string text = plot_prologue(900, 620);
  text += fmt::format(
      "set title {} offset 0,0.5\n"
      "set xlabel 'sun speed (rpm)'\nset ylabel 'torque at R2 (N m)'\n"
      "set x2label 'R2 speed (rpm)'\nset cblabel 'efficiency (%){}' offset 1.5,0\n{}{}"
      "set link x2 via x/{} inverse x*{}\nset x2tics\nset format x2 '%#.3g'\n"
      "set cbrange [{}:{}]\nset cbtics {}\nset format cb '%g'\n"
      "set palette defined (0 '#fff7bc', 0.35 '#fee08b', 0.7 '#a6d96a', 1 '#4bb062')\n"
      "set style fill solid 1.0 {}\n",
      plot_text(fmt::format("{}: efficiency {}", map.name,
                            forward ? "forward (sun drives)" : "backward (R2 drives)")),
      contours ? ", lines at the ticks" : "", axis_text('x', speeds), axis_text('y', torques),
      exact(std::abs(map.ratio)), exact(std::abs(map.ratio)), exact(scale.low), exact(scale.high),
      exact(scale.step), written ? "border rgb '#ffffff'" : "noborder");
  std::vector<std::string> layers;
  const auto add_layer = [&](const char* name, const std::string& data, const char* box,
                             int text_column) {
    if (data.empty()) return;
    text += fmt::format("{} << EOD\n{}EOD\n", name, data);
    layers.push_back(fmt::format("{} using {} notitle", name, box));
    if (!written) return;
    layers.push_back(
        fmt::format("{} using 1:2:(strcol({})) with labels notitle font ',11'", name, text_column));
  };
  add_layer("$cells", cells, "1:2:3:4:5:6:7 with boxxyerror fillcolor palette", 8);
  if (cells.empty()) text += "unset colorbox\n";
  add_layer("$blanks", blanks, "1:2:3:4:5:6 with boxxyerror fillcolor rgb '#d9d9d9'", 7);
  if (contours) {
    text += fmt::format(
        "$grid << EOD\n{}EOD\nset contour base\nunset surface\nset cntrparam levels incremental "
        "{},{},{}\nset table $contours\nsplot $grid using 1:2:3\nunset table\n",
        grid, exact(scale.low), exact(scale.step), exact(scale.high));
    layers.emplace_back("$contours using 1:2 with lines lc rgb '#303030' lw 1 notitle");
  }
  return text + fmt::format("plot {}\n", fmt::join(layers, ", \\\n  "));
}

struct TorquePanel {
  const char* label;
  const char* running;
  MapTorque UnloadedTorques::*torque;
};

std::string torque_panel(const OperatingMap& map, const TorquePanel& panel, int number) {
  std::string data;
  double greatest = 0.0;
  for (std::size_t i = 0; i < map.running.size(); ++i) {
    const MapTorque& torque = map.running[i].*panel.torque;
    if (!torque.torque_Nm) {
      data += '\n';  // interrupts the line
      continue;
    }
    data +=
        fmt::format("{} {}\n", exact(rpm(map.sun_speed_rad_s[i])), exact(clean(*torque.torque_Nm)));
    greatest = std::max(greatest, *torque.torque_Nm);
  }
  const bool runs = std::ranges::any_of(
      map.running, [&](const auto& at) { return (at.*panel.torque).torque_Nm.has_value(); });
  const MapTorque& breakaway = map.breakaway.*panel.torque;
  if (breakaway.torque_Nm) greatest = std::max(greatest, *breakaway.torque_Nm);
  std::string text = fmt::format("set ylabel '{}'\nset yrange [0:{}]\nunset label\n", panel.label,
                                 exact(greatest > 0.0 ? 1.2 * greatest : 1.0));
  std::vector<std::string> layers;
  if (runs) {
    text += fmt::format("$running{} << EOD\n{}EOD\n", number, data);
    layers.push_back(fmt::format(
        "$running{} using 1:2 with linespoints lw 2 pt 7 ps 0.5 lc rgb '#1f5fa8' title '{}'",
        number, panel.running));
  }
  if (breakaway.torque_Nm) {
    text +=
        fmt::format("$breakaway{} << EOD\n0 {}\nEOD\n", number, exact(clean(*breakaway.torque_Nm)));
    layers.push_back(fmt::format(
        "$breakaway{} using 1:2 with points pt 7 ps 0.9 lc rgb '#c0392b' title 'breakaway'",
        number));
  } else {
    text += fmt::format("set label 1 {} at graph 0.03,0.09 left\n",
                        plot_text("no breakaway torque: " + breakaway.reason));
  }
  if (!runs) {
    const auto& reason = (map.running.front().*panel.torque).reason;
    text += fmt::format("set label 2 {} at graph 0.03,0.18 left\n",
                        plot_text("no running torque: " + reason));
  }
  if (layers.empty()) layers.emplace_back("NaN notitle");
  return text + fmt::format("plot {}\n", fmt::join(layers, ", \\\n  "));
}

std::string torque_script(const OperatingMap& map) {
  const double greatest = rpm(std::ranges::max(map.sun_speed_rad_s));
  return plot_prologue(900, 680) +
         fmt::format(
             "set multiplot layout 2,1 title {}\nset lmargin 12\nset rmargin 4\nset grid lc rgb "
             "'#e0e0e0'\nset key bottom right\nset xlabel 'sun speed (rpm)'\nset xrange "
             "[{}:{}]\nset format '%g'\nset samples 2\n",
             plot_text(map.name + ": torques without load"), exact(-0.02 * greatest),
             exact(greatest > 0.0 ? 1.02 * greatest : 1.0)) +
         torque_panel(map,
                      {.label = "torque at the sun (N m)",
                       .running = "no-load, sun drives",
                       .torque = &UnloadedTorques::sun},
                      1) +
         torque_panel(map,
                      {.label = "torque at R2 (N m)",
                       .running = "back-driving, sun free",
                       .torque = &UnloadedTorques::output},
                      2) +
         "unset multiplot\n";
}

}  // namespace

std::vector<Plot> map_plots(const OperatingMap& map) {
  const Scale scale = efficiency_scale(map);
  return {
      {.name = "efficiency_forward", .script = efficiency_script(map, Direction::kForward, scale)},
      {.name = "efficiency_backward",
       .script = efficiency_script(map, Direction::kBackward, scale)},
      {.name = "torques", .script = torque_script(map)}};
}

}  // namespace gear3k::report
