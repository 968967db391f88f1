#include "calibrate/dynamic/motion_holdout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/dynamic/window_fit.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kLeastLogs = 3;
constexpr std::size_t kParts = 5;

/// Block of each window, and what the blocks are.
struct WindowBlocks {
  std::string name;
  std::vector<std::size_t> of;
  std::size_t count = 0;
};

WindowBlocks window_blocks(const std::vector<MotionWindow>& windows) {
  WindowBlocks blocks;
  std::vector<int> logs;
  for (const MotionWindow& w : windows) {
    if (std::ranges::find(logs, w.log) == logs.end()) logs.push_back(w.log);
  }
  blocks.of.reserve(windows.size());
  if (std::ssize(logs) >= kLeastLogs) {
    blocks.name = "log";
    blocks.count = logs.size();
    for (const MotionWindow& w : windows) {
      blocks.of.push_back(static_cast<std::size_t>(std::ranges::find(logs, w.log) - logs.begin()));
    }
    return blocks;
  }
  blocks.name = "time";
  blocks.count = kParts;
  for (std::size_t k = 0; k < windows.size(); ++k) blocks.of.push_back(k * kParts / windows.size());
  return blocks;
}

/// All windows but those of a block; none follows another across it.
std::vector<MotionWindow> without(const std::vector<MotionWindow>& windows,
                                  const WindowBlocks& blocks, std::size_t block) {
  std::vector<MotionWindow> rest;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (blocks.of[k] == block) continue;
    rest.push_back(windows[k]);
    if (k > 0 && blocks.of[k - 1] == block) rest.back().follows = false;
  }
  return rest;
}

}  // namespace

MotionHoldout hold_out(const std::vector<MotionWindow>& windows, const DriveParameters& stated,
                       const std::vector<std::size_t>& causes) {
  const WindowBlocks blocks = window_blocks(windows);
  MotionHoldout held{.blocks = blocks.name, .residual = {}};
  held.residual.assign(windows.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t block = 0; block < blocks.count; ++block) {
    DriveParameters drive = stated;
    if (!causes.empty()) {
      const auto sums = window_sums(without(windows, blocks, block));
      if (!sums) continue;
      const DriveFit fit = fit_drive(*sums, stated, causes);
      if (!fit.determined) continue;
      drive = changed_drive(stated, fit.changes);
    }
    for (std::size_t k = 0; k < windows.size(); ++k) {
      if (blocks.of[k] == block) held.residual[k] = window_residual(windows[k], drive);
    }
  }
  double baseline = 0.0, extended = 0.0, known = 0.0;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (!std::isfinite(held.residual[k])) continue;
    const double left = window_residual(windows[k], stated);
    baseline += left * left;
    extended += held.residual[k] * held.residual[k];
    known += 1.0;
  }
  if (known == 0.0) {
    held.blocks.clear();
    return held;
  }
  held.baseline_Nm = std::sqrt(baseline / known);
  held.extended_Nm = std::sqrt(extended / known);
  return held;
}

}  // namespace gear3k::calibrate
