#include "calibrate/loops/torque_branch.hpp"

#include <algorithm>
#include <cmath>

namespace gear3k::calibrate {
namespace {

Crossing interpolate(const std::vector<double>& time, const TorqueAngleCurve& curve, std::size_t i,
                     std::size_t j, double level) {
  const double s = (level - curve.torque_Nm[i]) / (curve.torque_Nm[j] - curve.torque_Nm[i]);
  return {.angle_rad = (1.0 - s) * curve.angle_rad[i] + s * curve.angle_rad[j],
          .time_s = (1.0 - s) * time[i] + s * time[j],
          .i = i,
          .j = j,
          .s = s};
}

}  // namespace

std::vector<std::size_t> turning_points(const std::vector<double>& x, double swing_fraction) {
  std::vector<std::size_t> turns;
  if (x.empty()) return turns;
  const auto [least, greatest] = std::minmax_element(x.begin(), x.end());
  const double threshold = swing_fraction * (*greatest - *least);
  std::size_t lowest = 0;
  std::size_t highest = 0;
  int sense = 0;
  turns.reserve(16);
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (x[i] < x[lowest]) lowest = i;
    if (x[i] > x[highest]) highest = i;
    if (sense >= 0 && x[highest] - x[i] > threshold) {
      turns.push_back(highest);
      lowest = i;
      sense = -1;
    } else if (sense <= 0 && x[i] - x[lowest] > threshold) {
      turns.push_back(lowest);
      highest = i;
      sense = 1;
    }
  }
  if (sense > 0) turns.push_back(highest);
  if (sense < 0) turns.push_back(lowest);
  return turns;
}

std::vector<Branch> find_branches(const TorqueAngleCurve& curve,
                                  const std::vector<std::size_t>& turns) {
  std::vector<Branch> branches;
  if (turns.size() < 2) return branches;
  branches.reserve(turns.size() - 1);
  for (std::size_t b = 0; b + 1 < turns.size(); ++b) {
    branches.push_back({.first = turns[b],
                        .last = turns[b + 1],
                        .rising = curve.torque_Nm[turns[b + 1]] > curve.torque_Nm[turns[b]]});
  }
  const auto [low, high] = std::minmax_element(curve.torque_Nm.begin(), curve.torque_Nm.end());
  // A record that stays on one side of zero says so by not crossing it.
  if (*low > 0.0 || *high < 0.0) return branches;
  Branch& begins = branches.front();
  const double start = curve.torque_Nm[begins.first];
  begins.loaded = begins.rising ? start <= kLoadedFraction * std::min(*low, 0.0) && start < 0.0
                                : start >= kLoadedFraction * std::max(*high, 0.0) && start > 0.0;
  return branches;
}

std::optional<Crossing> torque_crossing(const std::vector<double>& time_s,
                                        const TorqueAngleCurve& curve, const Branch& branch,
                                        double torque_Nm) {
  std::optional<Crossing> first;
  std::optional<Crossing> last;
  for (std::size_t i = branch.first; i < branch.last; ++i) {
    if ((curve.torque_Nm[i] >= torque_Nm) == (curve.torque_Nm[i + 1] >= torque_Nm)) continue;
    last = interpolate(time_s, curve, i, i + 1, torque_Nm);
    if (!first) first = last;
  }
  if (!first) return std::nullopt;
  first->spread_rad = std::abs(last->angle_rad - first->angle_rad);
  first->angle_rad = 0.5 * (first->angle_rad + last->angle_rad);
  first->time_s = 0.5 * (first->time_s + last->time_s);
  return first;
}

std::optional<Crossing> zero_torque_crossing(const std::vector<double>& time_s,
                                             const TorqueAngleCurve& curve, const Branch& branch,
                                             const Continuation& continuation) {
  if (auto found = torque_crossing(time_s, curve, branch, 0.0)) return found;
  const double start = curve.torque_Nm[branch.first];
  const double end = curve.torque_Nm[branch.last];
  const bool towards = branch.rising ? start < 0.0 : start > 0.0;
  if (!towards || std::abs(end) > continuation.reach_fraction * std::abs(start)) {
    return std::nullopt;
  }
  const std::size_t from = branch.last - std::min(continuation.secant, branch.last - branch.first);
  if (curve.torque_Nm[from] == end) return std::nullopt;
  Crossing found = interpolate(time_s, curve, from, branch.last, 0.0);
  found.extrapolated_Nm = std::abs(end);
  return found;
}

}  // namespace gear3k::calibrate
