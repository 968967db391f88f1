#include <fmt/format.h>

#include <cmath>

#include "papers/directional_bench_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::papers {

namespace {

using motion::MotionRow;
using report::exact, report::plot_prologue;

constexpr const char* kDriving = "#1f5fa8";
constexpr const char* kDriven = "#c0392b";
constexpr const char* kBenchGrid = "set grid lc rgb '#e6e6e6' lt 1\nset format '%g'\n";

std::string named_block(const char* name, const std::string& rows) {
  return fmt::format("${} << EOD\n{}EOD\n", name, rows);
}

std::string felt_script(const DirectionalBench& bench) {
  std::string rows;
  for (const FeltGears& g : bench.felt) {
    rows += fmt::format(
        "{}/{} {} {} {} {}\n", g.gear, g.pinion, exact(g.speeding_up_kgm2 / g.plain_kgm2),
        exact(g.slowing_down_kgm2 / g.plain_kgm2), exact(g.pushed_in()), exact(g.let_out()));
  }
  return plot_prologue(1000, 620) + kBenchGrid + named_block("felt", rows) +
         "set title 'felt at the output, over what it is without losses' offset 0,0.3\n"
         "set xtics rotate by -45\nset xlabel 'teeth at the output / on the motor' offset 0,-0.5\n"
         "set yrange [0.8:1.3]\nset key outside top center horizontal\n" +
         fmt::format(
             "set xrange [-0.5:{2} - 0.5]\n"
             "plot $felt using 0:2:xtic(1) with points pt 7 ps 1.2 lc rgb '{1}' title 'inertia "
             "sped up', $felt using 0:3 with points pt 7 ps 1.2 lc rgb '{0}' title 'inertia "
             "slowed', $felt using 0:4 with points pt 6 ps 1.8 lw 2 lc rgb '{1}' title 'spring "
             "pushed in', $felt using 0:5 with points pt 6 ps 1.8 lw 2 lc rgb '{0}' title 'spring "
             "let out', 1 with lines lc rgb '#404040' notitle\n",
             kDriving, kDriven, bench.felt.size());
}

std::string transparency_script(const DirectionalBench& bench) {
  std::string text = plot_prologue(900, 560) + kBenchGrid;
  std::string plots;
  std::string rows;
  int block = 0;
  const auto close = [&](const HeldTorque& h) {
    text += named_block(fmt::format("band{}", block).c_str(), rows);
    plots += fmt::format(
        "{}$band{} using 1:2:3 with filledcurves fs transparent solid 0.4 noborder lc rgb '{}' "
        "title '{}/{}'",
        block == 0 ? "" : ", ", block, block == 0 ? kDriving : kDriven, h.gear, h.pinion);
    rows.clear();
    ++block;
  };
  for (std::size_t k = 0; k < bench.held.size(); ++k) {
    const HeldTorque& h = bench.held[k];
    rows += fmt::format("{} {} {}\n", exact(h.motor_Nm), exact(h.moving_with_Nm),
                        exact(h.pushed_back_Nm));
    const bool last = k + 1 == bench.held.size() || bench.held[k + 1].gear != h.gear ||
                      bench.held[k + 1].pinion != h.pinion;
    if (last) close(h);
  }
  return text +
         "set title 'torque at the output, from moving with the motor to pushed back'\n"
         "set xlabel 'torque of the motor (N m)'\nset ylabel 'torque at the output (N m)'\n"
         "set key top left Left reverse\nplot " +
         plots + "\n";
}

std::string bench_script(const DirectionalBench& bench) {
  std::string forward, backward;
  for (const MotionRow& row : bench.load.rows) {
    (row.mode.flow > 0 ? forward : backward) += fmt::format(
        "{} {}\n", exact(std::abs(row.outside.load_Nm)), exact(std::abs(row.outside.reflected_Nm)));
  }
  return plot_prologue(900, 560) + kBenchGrid + named_block("forward", forward) +
         named_block("backward", backward) +
         "set title 'constant speed: the motor''s torque over the load''s'\n"
         "set xlabel 'torque of the load (N m)'\nset ylabel 'torque of the motor, times ratio (N "
         "m)'\nset key top left Left reverse\n" +
         fmt::format(
             "plot $forward using 1:2 with lines lw 2 lc rgb '{}' title '16 drive 100', $backward "
             "using 1:2 with lines lw 2 lc rgb '{}' title '100 drive 16', x with lines dt 2 lc rgb "
             "'#404040' title 'without loss'\n",
             kDriving, kDriven);
}

std::string braking_script(const DirectionalBench& bench) {
  const auto rows_of = [](const motion::Motion& motion) {
    std::string rows;
    for (const MotionRow& row : motion.rows) {
      rows += fmt::format("{} {} {}\n", exact(row.time_s), exact(row.sides.output_rad_s),
                          row.mode.flow < 0 ? 1 : 0);
    }
    return rows;
  };
  return plot_prologue(900, 560) + kBenchGrid +
         named_block("directional", rows_of(bench.braking.directional)) +
         named_block("fixed", rows_of(bench.braking.fixed)) +
         "set title 'a load sped up and braked; shaded: the mesh drives back'\n"
         "set xlabel 'time (s)'\nset ylabel 'speed at the output (rad/s)'\nset xzeroaxis lc rgb "
         "'#404040'\nset key outside top center horizontal\n"
         "set y2range [0:1]\nunset y2tics\n" +
         fmt::format(
             "plot $directional using 1:3 axes x1y2 with fillsteps fs solid noborder lc rgb "
             "'#f6dcd8' notitle, $directional using 1:2 with lines lw 2 lc rgb '{}' title "
             "'efficiency of either direction', $fixed using 1:2 with lines lw 2 dt 2 lc rgb '{}' "
             "title 'their mean for both'\n",
             kDriving, kDriven);
}

}  // namespace

std::vector<report::Plot> directional_figure_plots(const DirectionalBench& bench) {
  return {{.name = kDirectionalFigures[0], .script = felt_script(bench)},
          {.name = kDirectionalFigures[1], .script = transparency_script(bench)},
          {.name = kDirectionalFigures[2], .script = bench_script(bench)},
          {.name = kDirectionalFigures[3], .script = braking_script(bench)}};
}

}  // namespace gear3k::papers
