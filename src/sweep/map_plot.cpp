#include "sweep/map_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "report/text_table.hpp"

namespace gear3k::sweep {

report::Plot map_plot(const Map& map, const std::string& name) {
  constexpr std::array<const char*, 8> kColours{"#1f5fa8", "#e08e0b", "#3a8f5c", "#b03a2e",
                                                "#7d5ba6", "#707070", "#17a2a2", "#8c6d31"};
  constexpr double kWide = 8.0;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (const Map::Line& line : map.lines) {
    least = std::min(least, line.points.front().first);
    greatest = std::max(greatest, line.points.back().first);
  }
  std::string script = report::plot_prologue(760, 480);
  script += fmt::format(
      "set title {}\nset xlabel {}\nset ylabel {}\nset grid lc rgb '#e0e0e0'\nset format '%g'\n"
      "set key outside right top\nset offsets graph 0.02, graph 0.02, graph 0.04, graph 0.04\n",
      report::plot_text(map.title), report::plot_text(map.x), report::plot_text(map.y));
  if (least > 0.0 && greatest > kWide * least) script += "set logscale x\n";
  for (std::size_t k = 0; k < map.lines.size(); ++k) {
    script += fmt::format("$line{} << EOD\n", k);
    for (const auto& [x, y] : map.lines[k].points) {
      script += fmt::format("{} {}\n", report::exact(x), report::exact(y));
    }
    script += "EOD\n";
  }
  for (std::size_t k = 0; k < map.lines.size(); ++k) {
    const std::string title = map.by.empty() ? "" : fmt::format("{} {}", map.by, map.lines[k].name);
    script += fmt::format("{}$line{} using 1:2 with linespoints pt 7 ps 0.5 lw 1.5 lc rgb '{}' {}",
                          k == 0 ? "plot " : ", ", k, kColours[k % kColours.size()],
                          map.by.empty() ? "notitle" : "title " + report::plot_text(title));
  }
  return {.name = name, .script = script + "\n"};
}

}  // namespace gear3k::sweep
