#pragma once
// Marked rows that fall together.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// The most chance that a group, or any of several, may have where its marks are no luck.
inline constexpr double kChanceTogether = 0.025;

/// P(X >= hit) of the hypergeometric distribution where more of a group are marked than expected;
/// else 1.
double chance_of_marks(int rows, int marked, int size, int hit);

struct MarkedTogether {
  std::vector<char> marked;  ///< of the group
  std::size_t count = 0;
  std::string group;  ///< in words
  std::string along;  ///< name of the covariate that it is a level of
};

/// The group of rows into which the marked ones fall as random places seldom do:
///
///   Σ_(j ≥ h) C(k, j) C(n − k, m − j) / C(n, m) · groups ≤ 2.5 %
///
/// for h of the m marked among the k rows of the group, h ≥ 2 and h ≥ k/3; empty where none is.
/// Groups are one session, direction, rotation, load, speed or twelfth of a turn, or of one in one
/// direction; and, paid for apart, one of temperature, time, cycles or another column, and any of
/// all these of one rotation.
std::optional<MarkedTogether> marked_together(const MeasurementSet& set,
                                              const std::vector<char>& marked);

}  // namespace gear3k::calibrate
