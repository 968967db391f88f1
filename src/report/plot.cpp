#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

std::string plot_text(const std::string& text) {
  // At the beginning of a text in single quotes '' is an empty one.
  const std::size_t quotes = std::min(text.find_first_not_of('\''), text.size());
  std::string result = quotes == 0 ? "'" : fmt::format("\"{}\".'", text.substr(0, quotes));
  for (const char c : text.substr(quotes)) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 0x20U ? ' ' : c;
  }
  return result + "'";
}

std::string plot_prologue(int width, int height) {
  return fmt::format(
      "set encoding utf8\n"
      "set decimalsign '.'\n"
      "set terminal svg size {},{} noenhanced font 'sans-serif,14' background '#ffffff'\n"
      "set border lc rgb '#404040'\n"
      "set tics nomirror\n",
      width, height);
}

std::string plot_range(const char* axis, const std::vector<double>& values) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low <= high)) return fmt::format("set {}range [0:1]\n", axis);
  constexpr double kRoom = 0.06;
  double room = kRoom * (high - low);
  if (!(room > 0.0)) room = low != 0.0 ? kRoom * std::abs(low) : kRoom;
  return fmt::format("set {}range [{}:{}]\n", axis, exact(clean(low - room)),
                     exact(clean(high + room)));
}

namespace {

constexpr const char* kPanels = "set grid lc rgb '#e0e0e0'\nset format '%g'\nset samples 2\n";

}  // namespace

std::string panels_beside(const std::string& title) {
  return fmt::format(
      "set multiplot layout 1,2 title {} margins 0.08,0.98,0.12,0.84 spacing 0.1\n{}"
      "set key top left\n",
      plot_text(title), kPanels);
}

std::string panels_below(const std::string& title) {
  return fmt::format(
      "set multiplot layout 2,1 title {}\nset lmargin 13\nset rmargin 3\n{}"
      "set key outside top center horizontal\n",
      plot_text(title), kPanels);
}

}  // namespace gear3k::report
