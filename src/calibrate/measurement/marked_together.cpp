#include "calibrate/measurement/marked_together.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <string_view>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/level_groups.hpp"
#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

namespace {

bool is_first(std::string_view along) {
  constexpr std::array<std::string_view, 6> kFirst{"run",  "direction", "rotation",
                                                   "load", "speed",     "angle"};
  return std::ranges::find(kFirst, along) != kFirst.end();
}

}  // namespace

double chance_of_marks(int rows, int marked, int size, int hit) {
  if (static_cast<double>(hit) * rows <= static_cast<double>(marked) * size) return 1.0;
  double p = 0.0;
  for (int j = hit; j <= std::min(marked, size); ++j) {
    const double term = numerics::hypergeometric_probability(rows, marked, size, j);
    p += term;
    // Beyond the expected number they fall ever faster.
    if (term <= 1e-12 * p) break;
  }
  return p;
}

std::optional<MarkedTogether> marked_together(const MeasurementSet& set,
                                              const std::vector<char>& marked) {
  struct Found {
    double p = 1.0;
    int looked_at = 0, hit = 0;
    Eigen::Index group = -1;
    int rotation = 0;
  };
  const LevelGroups groups = level_groups(set, covariate_levels(set));
  const auto rows = static_cast<int>(marked.size());
  const auto all = static_cast<int>(std::ranges::count(marked, 1));
  const auto rotation_of = [&](int i) {
    return set.rows[static_cast<std::size_t>(i)].condition.rotation >= 0 ? 1 : -1;
  };
  std::array<Found, 2> best;  // of either family
  for (Eigen::Index g = 0; g < groups.columns.cols(); ++g) {
    // The same rows in another sense are no group of their own.
    if ((groups.columns.col(g).array() < 0.0).any()) continue;
    std::array<int, 2> size{};
    std::array<int, 2> hit{};  // by rotation
    for (int i = 0; i < rows; ++i) {
      if (groups.columns(i, g) == 0.0) continue;
      const std::size_t turning = rotation_of(i) > 0 ? 1 : 0;
      ++size[turning];
      if (marked[static_cast<std::size_t>(i)] != 0) ++hit[turning];
    }
    const auto look = [&](int rotation, int k, int h) {
      if (k == 0 || k == rows) return;
      const bool first = rotation == 0 && is_first(groups.group[static_cast<std::size_t>(g)].along);
      Found& found = best[first ? 0 : 1];
      ++found.looked_at;
      if (h < 2 || 3 * h < k) return;
      const double p = chance_of_marks(rows, all, k, h);
      if (p > found.p || (p == found.p && h <= found.hit)) return;
      found.p = p;
      found.hit = h;
      found.group = g;
      found.rotation = rotation;
    };
    look(0, size[0] + size[1], hit[0] + hit[1]);
    if (size[0] == 0 || size[1] == 0) continue;
    look(1, size[1], hit[1]);
    look(-1, size[0], hit[0]);
  }
  for (Found& found : best) found.p *= found.looked_at;
  const Found& found = best[best[1].p < best[0].p ? 1 : 0];
  if (found.group < 0 || found.p > kChanceTogether) return std::nullopt;
  const LevelGroup& group = groups.group[static_cast<std::size_t>(found.group)];
  MarkedTogether result{.marked = std::vector<char>(marked.size(), 0),
                        .group = level_text(set, group),
                        .along = group.along};
  if (found.rotation != 0) result.group += fmt::format(", rotation {}", found.rotation);
  for (int i = 0; i < rows; ++i) {
    const auto row = static_cast<std::size_t>(i);
    if (marked[row] == 0 || groups.columns(i, found.group) == 0.0) continue;
    if (found.rotation != 0 && rotation_of(i) != found.rotation) continue;
    result.marked[row] = 1;
    ++result.count;
  }
  return result;
}

}  // namespace gear3k::calibrate
