#pragma once
// How much of a box points dominate.

#include <vector>

namespace gear3k::optimize {

/// Volume of the part of the unit cube that points dominate, coordinates 0 = best, 1 = worst.
///
///   V = |∪_p [p, 1]|
///
/// Source: by slices along the last coordinate (exact); cost grows as n^d.
/// @returns 0 for no points; coordinates outside [0, 1] are clipped
double hypervolume(std::vector<std::vector<double>> points);

}  // namespace gear3k::optimize
