#include "calibrate/loops/zero_before_jump.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "calibrate/loops/correlated_noise.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {
namespace {

/// Share of the jump that the filter may add.
constexpr double kJumpShare = 0.002;
/// Of the lost motion: smaller differences of readings are let be, greater ones tell an edge.
constexpr double kSameFraction = 0.001, kEdgeFraction = 0.002;
constexpr double kSameDeviations = 3.0;
/// One of many windows may disagree by chance: what tells an edge.
constexpr double kEdgeDeviations = 4.5;
/// Of the noise's correlation.
constexpr double kShownDeviations = 3.0;
/// Samples that agree reach this far from zero, in distances of the jump.
constexpr double kClearOfEdge = 2.0;
/// Of a branch's first torque: samples beyond are not used.
constexpr double kFarthestTorque = 0.25;
/// Between the first and the last passage of zero torque, of the lost motion.
constexpr double kManyPassages = 0.05;
constexpr std::array<std::size_t, 10> kWindows{4, 6, 8, 12, 16, 24, 32, 48, 64, 96};

/// A branch whose jump is near.
struct NearJump {
  std::size_t place = 0;  ///< among the branches
  std::size_t last = 0;   ///< sample before zero torque
  double outward = 1.0;   ///< sign of the angle by which it widens the loop
  double jump_Nm = 0.0;   ///< ≥ 0, from zero torque to the jump
};

/// By the samples last - m + 1 ... last.
struct FlankEnd {
  double angle_rad = 0.0;
  double compliance = 0.0;       ///< dθ/dT
  std::vector<double> weight{};  ///< of those samples
};

/// From here on a jump adds less than kJumpShare of itself, in samples.
double filter_reach(const std::vector<double>& response) {
  double tail = 0.0;
  std::size_t k = response.size();
  while (k > 0 && std::abs(tail + response[k - 1]) <= kJumpShare) tail += response[--k];
  return static_cast<double>(k);
}

double crossing_place(const Crossing& at) { return static_cast<double>(at.i) + at.s; }

/// Where the filtered angle passes the middle of the loop, in samples; empty where it does not.
std::optional<double> jump_place(const std::vector<double>& angle, const Branch& branch,
                                 std::size_t from, double middle) {
  for (std::size_t i = from; i < branch.last; ++i) {
    if ((angle[i] >= middle) == (angle[i + 1] >= middle)) continue;
    return static_cast<double>(i) + (middle - angle[i]) / (angle[i + 1] - angle[i]);
  }
  return std::nullopt;
}

std::vector<NearJump> near_jumps(const FilteredRecord& f, const std::vector<Branch>& branches,
                                 const std::vector<BranchZero>& zeros) {
  const double reach = filter_reach(f.response);
  std::vector<NearJump> found;
  for (std::size_t b = 0; b < zeros.size(); ++b) {
    const BranchZero& zero = zeros[b];
    if (!zero.at || zero.at->extrapolated_Nm > 0.0) continue;
    const std::size_t other = b + 1 < zeros.size() && zeros[b + 1].at ? b + 1 : b - 1;
    if (other >= zeros.size() || !zeros[other].at) continue;
    const double lost = std::abs(zero.at->angle_rad - zeros[other].at->angle_rad);
    if (zero.at->spread_rad > kManyPassages * lost) continue;
    const double middle = 0.5 * (zero.at->angle_rad + zeros[other].at->angle_rad);
    // Noise of the torque may put zero after the jump.
    const std::size_t from =
        std::max(branches[b].first, zero.at->i - std::min(zero.at->i, f.secant));
    const auto jump = jump_place(f.once.angle_rad, branches[b], from, middle);
    if (!jump || *jump > crossing_place(*zero.at) + reach) continue;
    found.push_back({.place = b,
                     .last = zero.at->i,
                     .outward = f.angle_sense * (zero.rising ? -1.0 : 1.0),
                     .jump_Nm = std::abs(f.once.torque_Nm[static_cast<std::size_t>(*jump)])});
  }
  return found;
}

/// Empty where the torque's line does not lead to zero there.
std::optional<FlankEnd> flank_end(const FilteredRecord& f, std::size_t last, std::size_t count) {
  constexpr double kEarliest = -2.0, kLatest = 4.0;  // of zero torque, in samples after `last`
  const std::size_t first = last + 1 - count;
  const double mean_x = -0.5 * static_cast<double>(count - 1);
  double xx = 0.0, torque = 0.0, xt = 0.0, xa = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = static_cast<double>(k) + mean_x;
    xx += x * x;
    torque += f.raw.torque_Nm[first + k] / static_cast<double>(count);
    xt += x * f.raw.torque_Nm[first + k];
    xa += x * f.raw.angle_rad[first + k];
  }
  if (xt == 0.0) return std::nullopt;
  const double zero = -torque * xx / xt;  // from the middle of the samples
  if (!(zero + mean_x >= kEarliest && zero + mean_x <= kLatest)) return std::nullopt;
  FlankEnd end{.compliance = xa / xt};
  end.weight.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = static_cast<double>(k) + mean_x;
    end.weight.push_back(1.0 / static_cast<double>(count) + x * zero / xx);
    end.angle_rad += end.weight.back() * f.raw.angle_rad[first + k];
  }
  return end;
}

/// All near jumps by windows of one length.
struct WindowReading {
  std::size_t count = 0;
  std::vector<FlankEnd> ends{};
  double span_Nm = 0.0;  ///< from zero, mean
};

std::vector<WindowReading> window_readings(const FilteredRecord& f,
                                           const std::vector<Branch>& branches,
                                           const std::vector<NearJump>& near) {
  std::vector<WindowReading> windows;
  for (const std::size_t count : kWindows) {
    WindowReading window{.count = count};
    bool leads_to_zero = true;
    for (const NearJump& jump : near) {
      const Branch& branch = branches[jump.place];
      if (jump.last + 1 < branch.first + f.secant + count) return windows;
      const double from = std::abs(f.once.torque_Nm[jump.last + 1 - count]);
      if (windows.size() > 1 && from > kFarthestTorque * std::abs(f.once.torque_Nm[branch.first])) {
        return windows;
      }
      auto end = flank_end(f, jump.last, count);
      leads_to_zero = end.has_value();
      if (!leads_to_zero) break;
      window.ends.push_back(std::move(*end));
      window.span_Nm += from / static_cast<double>(near.size());
    }
    // Noise of the torque may hide it in few samples.
    if (leads_to_zero) windows.push_back(std::move(window));
  }
  return windows;
}

/// Mean difference of two windows' readings, outward, and its deviation.
struct WindowStep {
  double mean_rad = 0.0, deviation_rad = 0.0;
};

WindowStep step_between(const WindowReading& small, const WindowReading& large,
                        const std::vector<NearJump>& near, const CorrelatedNoise& noise) {
  WindowStep step;
  double variance = 0.0;
  const auto branches = static_cast<double>(near.size());
  for (std::size_t k = 0; k < near.size(); ++k) {
    step.mean_rad +=
        near[k].outward * (large.ends[k].angle_rad - small.ends[k].angle_rad) / branches;
    std::vector<double> weight = large.ends[k].weight;
    const std::size_t before = large.count - small.count;
    for (std::size_t i = 0; i < small.count; ++i) weight[before + i] -= small.ends[k].weight[i];
    variance += variance_of_sum(noise, weight) / numerics::square(branches);
  }
  step.deviation_rad = std::sqrt(variance);
  return step;
}

struct WindowChoice {
  std::size_t window = 0;
  double step_rad = 0.0;  ///< to it from the next smaller
  bool stopped = false;   ///< greater ones disagree, beyond chance
};

/// Whether two windows differ by so many deviations and this angle.
bool differ(const WindowStep& step, double deviations, double least_rad) {
  return std::abs(step.mean_rad) > std::max(deviations * step.deviation_rad, least_rad);
}

/// Empty where the two smallest disagree.
std::optional<WindowChoice> choose_window(const std::vector<WindowReading>& windows,
                                          const std::vector<NearJump>& near,
                                          const CorrelatedNoise& noise, double lost_rad) {
  if (windows.size() < 2) return std::nullopt;
  const double edge = kEdgeFraction * std::abs(lost_rad);
  const double same = kSameFraction * std::abs(lost_rad);
  const WindowStep first = step_between(windows[0], windows[1], near, noise);
  if (differ(first, kSameDeviations, edge)) return std::nullopt;
  WindowChoice choice{.step_rad = first.mean_rad};
  bool open = true;
  for (std::size_t k = 1; k < windows.size() && !choice.stopped; ++k) {
    WindowStep step;
    for (std::size_t j = 0; j < k && !choice.stopped; ++j) {
      step = step_between(windows[j], windows[k], near, noise);
      open = open && !differ(step, kSameDeviations, same);
      choice.stopped = differ(step, kEdgeDeviations, same);
    }
    if (!open) continue;
    choice.window = k;
    choice.step_rad = step.mean_rad;
  }
  return choice;
}

/// Between falling and rising branches.
double lost_motion(const WindowReading& window, const std::vector<NearJump>& near,
                   const std::vector<BranchZero>& zeros) {
  double mean[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  for (std::size_t k = 0; k < near.size(); ++k) {
    mean[zeros[near[k].place].rising] += window.ends[k].angle_rad;
    count[zeros[near[k].place].rising] += 1.0;
  }
  return count[0] > 0.0 && count[1] > 0.0 ? mean[0] / count[0] - mean[1] / count[1] : 0.0;
}

/// Each branch's own, short of zero by the reach of the smoother curve, and the mean of all.
CorrelatedNoise noise_before_zero(const FilteredRecord& f, const std::vector<Branch>& branches,
                                  const std::vector<NearJump>& near, const WindowReading& window) {
  std::vector<double> scatter;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const std::size_t from = branches[near[k].place].first + f.secant;
    const std::size_t to = near[k].last - std::min(near[k].last, f.scatter_reach);
    if (to <= from) continue;
    const std::vector<double> more = angle_scatter(f, from, to, window.ends[k].compliance);
    scatter.insert(scatter.end(), more.begin(), more.end());
  }
  return scatter.empty() ? CorrelatedNoise{}
                         : noise_of_left_out(scatter, f.left_out, kShownDeviations);
}

}  // namespace

std::vector<BranchZero> zeros_before_jumps(const FilteredRecord& f,
                                           const std::vector<Branch>& branches,
                                           std::vector<BranchZero> zeros) {
  const std::vector<NearJump> near = near_jumps(f, branches, zeros);
  if (near.empty()) return zeros;
  const std::vector<WindowReading> windows = window_readings(f, branches, near);
  std::optional<WindowChoice> choice;
  CorrelatedNoise noise;
  if (!windows.empty()) {
    noise = noise_before_zero(f, branches, near, windows.back());
    choice = choose_window(windows, near, noise, lost_motion(windows.front(), near, zeros));
  }
  if (choice && choice->stopped) {
    double jump_Nm = 0.0;
    for (const NearJump& jump : near) jump_Nm += jump.jump_Nm / static_cast<double>(near.size());
    if (windows[choice->window].span_Nm < kClearOfEdge * jump_Nm) choice.reset();
  }
  for (std::size_t k = 0; k < near.size(); ++k) {
    BranchZero& zero = zeros[near[k].place];
    zero.at_edge = !choice;
    if (!choice) continue;
    const FlankEnd& end = windows[choice->window].ends[k];
    zero.at->angle_rad = end.angle_rad;
    zero.at->spread_rad = 0.0;
    zero.at_double = zero.at;
    zero.noise = noise;
    zero.noise_variance_rad2 = variance_of_sum(noise, end.weight);
    zero.variance_rad2 = zero.noise_variance_rad2 + 2.0 * numerics::square(choice->step_rad);
  }
  return zeros;
}

}  // namespace gear3k::calibrate
