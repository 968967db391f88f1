#pragma once
// What figures have in common: scripts for gnuplot.

#include <string>
#include <vector>

namespace gear3k::report {

struct Plot {
  std::string name;    ///< of the figure's file, without .svg
  std::string script;  ///< for `gnuplot -d`, which then prints an SVG
};

/// A text for gnuplot, which reads single quotes literally but for '' and line ends.
std::string plot_text(const std::string& text);

/// Settings that decide how an SVG of this size [px] looks.
std::string plot_prologue(int width, int height);

/// Sets the range of an axis, "x" or "y", around values with some room; NaN counts nothing.
std::string plot_range(const char* axis, const std::vector<double>& values);

/// Two panels of points under one title: side by side, the key within the first; or one below the
/// other, the key above.  The panels follow, then "unset multiplot".
std::string panels_beside(const std::string& title);
std::string panels_below(const std::string& title);

}  // namespace gear3k::report
