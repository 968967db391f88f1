#pragma once
// What figures have in common: scripts for gnuplot.

#include <string>

namespace gear3k::report {

struct Plot {
  std::string name;    ///< of the figure's file, without .svg
  std::string script;  ///< for `gnuplot -d`, which then prints an SVG
};

/// A text for gnuplot, which reads single quotes literally but for '' and line ends.
std::string plot_text(const std::string& text);

/// Settings that decide how an SVG of this size [px] looks.
std::string plot_prologue(int width, int height);

}  // namespace gear3k::report
