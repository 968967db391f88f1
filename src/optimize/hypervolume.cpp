#include "optimize/hypervolume.hpp"

#include <algorithm>
#include <cstddef>

namespace gear3k::optimize {

double hypervolume(std::vector<std::vector<double>> points) {
  if (points.empty()) return 0.0;
  const std::size_t last = points.front().size() - 1;
  for (auto& point : points) {
    for (double& x : point) x = std::clamp(x, 0.0, 1.0);
  }
  std::ranges::sort(points, {}, [&](const auto& point) { return point[last]; });
  if (last == 0) return 1.0 - points.front()[0];
  double volume = 0.0;
  std::vector<std::vector<double>> below;
  for (std::size_t k = 0; k < points.size(); ++k) {
    below.emplace_back(points[k].begin(), points[k].end() - 1);
    const double next = k + 1 < points.size() ? points[k + 1][last] : 1.0;
    if (next > points[k][last]) volume += (next - points[k][last]) * hypervolume(below);
  }
  return volume;
}

}  // namespace gear3k::optimize
