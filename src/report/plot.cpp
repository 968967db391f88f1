#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace gear3k::report
