#include "report/torque_angle_plot.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::TorqueAngleCurve, design::TorqueAnglePoint;

std::string curve_rows(const std::vector<TorqueAnglePoint>& points) {
  std::string rows;
  for (const TorqueAnglePoint& point : points) {
    rows += fmt::format("{} {}\n", exact(clean(point.torque_Nm)),
                        exact(clean(arcmin(point.angle_rad))));
  }
  return rows;
}

std::string curve_block(const char* name, const std::string& rows) {
  return fmt::format("${} << EOD\n{}EOD\n", name, rows);
}

}  // namespace

Plot torque_angle_plot(const std::string& name, const TorqueAngleCurve& curve) {
  const auto& [loading, unloading, reverse_loading, reverse_unloading] = curve.branch;
  std::string text = plot_prologue(900, 700);
  text += curve_block("loading", curve_rows(loading) + '\n' + curve_rows(reverse_loading));
  text += curve_block("unloading", curve_rows(unloading) + '\n' + curve_rows(reverse_unloading));
  const double half = 0.5 * arcmin(curve.lost_motion_rad);
  text += curve_block("lost", fmt::format("0 {}\n0 {}\n", exact(clean(-half)), exact(clean(half))));
  std::string elastic;
  for (const double sign : {-1.0, 1.0}) {
    elastic += fmt::format("0 {}\n", exact(clean(sign * half)));
    for (const design::StiffnessAtTorque& point : curve.stiffness) {
      const double windup = arcmin(point.torque_Nm / point.output_Nm_rad);
      elastic += fmt::format("{} {}\n", exact(clean(sign * point.torque_Nm)),
                             exact(clean(sign * (half + windup))));
    }
    elastic += '\n';
  }
  text += curve_block("elastic", elastic);
  text += fmt::format(
      "set title {}\nset grid lc rgb '#e0e0e0'\nset key top left\nset format '%g'\n"
      "set xlabel 'torque on the output (N m)'\n"
      "set ylabel 'angle of the output, input locked (arcmin)'\n"
      "set offsets graph 0.03,graph 0.03,graph 0.03,graph 0.03\n"
      "plot $elastic using 1:2 with lines lw 1 dt 3 lc rgb '#808080' title 'without friction', \\\n"
      "  $lost using 1:2 with lines lw 2 lc rgb '#808080' title 'lost motion', \\\n"
      "  $loading using 1:2 with lines lw 1.6 lc rgb '#1f5fa8' title 'loading', \\\n"
      "  $unloading using 1:2 with lines lw 1.6 dt 2 lc rgb '#c0392b' title 'unloading'\n",
      plot_text((name.empty() ? "gearbox" : name) + ": torque and angle of the output"));
  return {.name = "torque_angle", .script = text};
}

}  // namespace gear3k::report
