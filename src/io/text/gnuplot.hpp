#pragma once
// Runs gnuplot, which draws figures.

#include <string>

namespace gear3k::io {

/// What gnuplot prints for a script, e.g. an SVG.  Settings of the user's own are not read, and no
/// shell is involved.  The program is looked up in PATH.
/// @throws InvalidInput where it is missing, fails (with what it says) or prints nothing
std::string run_gnuplot(const std::string& script);

}  // namespace gear3k::io
