#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "report/motion_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using motion::Mode, motion::MotionRow, motion::Phase;

struct Shade {
  const char* name;
  const char* color;
};
constexpr std::array<Shade, 4> kShades{{{"sticks", "#d0d0d0"},
                                        {"forward flow", "#dbe9f6"},
                                        {"backward flow", "#f6dcd8"},
                                        {"gap", "#fbf1c7"}}};

std::size_t shade_of(const Mode& mode) {
  if (mode.phase == Phase::kStick) return 0;
  if (mode.phase == Phase::kGap) return 3;
  return mode.flow > 0 ? 1 : 2;
}

/// A mode for as long as it is seen; what is too short to be seen goes to the one before.
struct Stretch {
  double from_s, to_s;
  std::size_t shade;
};
std::vector<Stretch> stretches_of(const MotionResult& result) {
  constexpr double kSeen = 1.0 / 2000.0;
  const double least = kSeen * result.motion.end.time_s;
  std::vector<Stretch> stretches;
  for (const MotionRow& row : result.motion.rows) {
    const std::size_t shade = shade_of(row.mode);
    if (!stretches.empty()) stretches.back().to_s = row.time_s;
    if (!stretches.empty() && stretches.back().shade == shade) continue;
    if (!stretches.empty() && stretches.back().to_s - stretches.back().from_s < least) {
      stretches.back().shade = shade;
      continue;
    }
    stretches.push_back({.from_s = row.time_s, .to_s = row.time_s, .shade = shade});
  }
  return stretches;
}

std::string shading(const MotionResult& result) {
  std::string text;
  for (const Stretch& s : stretches_of(result)) {
    text += fmt::format(
        "set object rectangle from first {}, graph 0 to first {}, graph 1 behind fc rgb '{}' "
        "fillstyle solid noborder\n",
        exact(s.from_s), exact(s.to_s), kShades[s.shade].color);
  }
  return text;
}

/// Rows, few enough for a figure.
std::string plotted_rows(const MotionResult& result) {
  constexpr std::size_t kMostRows = 5000;
  const auto& rows = result.motion.rows;
  const std::size_t stride = rows.size() / kMostRows + 1;
  std::string data;
  for (std::size_t k = 0; k < rows.size(); k += stride) {
    const MotionRow& r = rows[k];
    data += fmt::format("{} {} {} {} {} {}\n", exact(r.time_s), exact(r.sides.output_rad),
                        exact(r.sides.output_rad_s), exact(r.sides.fast_rad_s),
                        exact(r.outside.reflected_Nm), exact(r.outside.load_Nm));
  }
  return data;
}

/// Colours of the shades in the key.
std::string shade_key() {
  std::string text;
  for (const Shade& shade : kShades) {
    text += fmt::format(", NaN with boxes fillstyle solid noborder fc rgb '{}' title '{}'",
                        shade.color, shade.name);
  }
  return text;
}

}  // namespace

Plot motion_plot(const MotionResult& result) {
  const std::string& name = result.scenario.name;
  std::string script = plot_prologue(900, 900);
  script += fmt::format(
      "set multiplot layout 3,1 title {}\nset lmargin 12\nset format '%g'\n"
      "set xrange [0:{}]\nset xzeroaxis lc rgb '#404040'\nset key outside top center "
      "horizontal\n$motion << EOD\n{}EOD\n{}",
      plot_text(name.empty() ? "motion of the output" : name), exact(result.motion.end.time_s),
      plotted_rows(result), shading(result));
  script +=
      "set ylabel 'angle (rad)'\n"
      "plot $motion using 1:2 with lines lw 2 lc rgb '#1f5fa8' title 'output'\n"
      "set ylabel 'speed (rad/s)'\nplot ";
  if (result.actuator.gearbox.backlash_rad.value_or(0.0) > 0.0) {
    script += "$motion using 1:4 with lines lw 1 lc rgb '#e08e0b' title \"motor's side\", ";
  }
  script += "$motion using 1:3 with lines lw 2 lc rgb '#1f5fa8' title 'output'\n";
  script +=
      "set xlabel 'time (s)'\nset ylabel 'torque at the output (N m)'\n"
      "plot $motion using 1:5 with lines lw 2 lc rgb '#2e7d32' title 'motor, times ratio', "
      "$motion using 1:6 with lines lw 2 lc rgb '#c0392b' title 'load'" +
      shade_key() + "\nunset multiplot\n";
  return {.name = "motion", .script = script};
}

}  // namespace gear3k::report
