#include "optimize/grid_distances.hpp"

#include <algorithm>
#include <cmath>

#include "backlash/lost_motion.hpp"
#include "geometry/involute.hpp"

namespace gear3k::optimize {

namespace {

using train::kMeshCount, train::kS, train::kP1, train::kR1, train::kP2, train::kR2;
using MeshRanges = std::array<std::array<long, 2>, kMeshCount>;

/// More sums than these rule out little, and take long to look through or for.
constexpr std::size_t kMostSums = 10'000, kMostLooks = 4 * kMostSums;
constexpr double kAngleSlack = 1e-9;  ///< of an angle [rad]: rounding

/// Least and greatest backlash of the meshes [m], and the greatest lost motion of them together.
struct BacklashLimits {
  std::array<Interval, kMeshCount> range;
  double most_rad = kInfinity;
};

/// Least backlashes by their rows; the greatest by that of the lost motion, the other meshes at
/// their least.
std::optional<BacklashLimits> backlash_limits(const RefinementProblem& problem,
                                              const train::TrainGeometry<double>& train) {
  BacklashLimits limits;
  auto& range = limits.range;
  range.fill({-kInfinity, kInfinity});
  std::optional<double> most_rad;
  for (const ConstraintRow& row : problem.rows) {
    if (!row.check) continue;
    const double eased = design::kFeasibilitySlack * row.check->scale;
    if (row.check->record->id == design::CheckId::kNormalBacklash) {
      double& least = range[static_cast<std::size_t>(row.check->subject.member)].lo;
      least = std::max(least, row.check->limit - eased);
    } else if (row.check->record->id == design::CheckId::kOutputBacklashMax) {
      most_rad = std::min(most_rad.value_or(kInfinity), row.check->limit + eased);
    }
  }
  if (!most_rad || std::ranges::any_of(range, [](const Interval& j) { return !(j.lo > -1.0); })) {
    return std::nullopt;
  }
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    std::array<double, kMeshCount> least{}, own{};
    own[k] = 1.0;
    const auto model = problem.spec->limits.model;
    const bool paper = model == backlash::LostMotionModel::kPaper;
    for (std::size_t i = 0; i < kMeshCount; ++i) {
      // Of the paper's greater one of two shares each is held by the first one alone.
      const bool adds = i != k && !(paper && k != train::kMeshSP1 && i != train::kMeshSP1);
      least[i] = adds ? range[i].lo : 0.0;
    }
    const double share = paper ? backlash::paper_lost_motion(train, own)[k]
                               : backlash::kinematic_lost_motion(train, own)[k];
    range[k].hi = (*most_rad - backlash::output_lost_motion(train, least, model)) / share;
  }
  limits.most_rad = *most_rad;
  return limits;
}

MeshRanges sums_of(const LatticeBox& box) {
  return {{{box[kS][0] + box[kP1][0], box[kS][1] + box[kP1][1]},
           {box[kR1][0] - box[kP1][1], box[kR1][1] - box[kP1][0]},
           {box[kR2][0] - box[kP2][1], box[kR2][1] - box[kP2][0]}}};
}

/// Confines one axis of a box.
void keep(std::array<long, 2>& axis, long least, long most) {
  axis = {std::max(axis[0], least), std::min(axis[1], most)};
}

/// The same points' shifts, by the sums that are left.
void keep_sums(LatticeBox& box, const MeshRanges& sums) {
  const auto& [sun, ring, ring2] = sums;
  keep(box[kS], sun[0] - box[kP1][1], sun[1] - box[kP1][0]);
  keep(box[kP1], sun[0] - box[kS][1], sun[1] - box[kS][0]);
  keep(box[kP1], box[kR1][0] - ring[1], box[kR1][1] - ring[0]);
  keep(box[kR1], ring[0] + box[kP1][0], ring[1] + box[kP1][1]);
  keep(box[kP2], box[kR2][0] - ring2[1], box[kR2][1] - ring2[0]);
  keep(box[kR2], ring2[0] + box[kP2][0], ring2[1] + box[kP2][1]);
}

bool holds(const MeshRanges& ranges, const std::array<long, kMeshCount>& steps) {
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    if (steps[k] < ranges[k][0] || steps[k] > ranges[k][1]) return false;
  }
  return true;
}

Interval both(const Interval& a, const Interval& b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}

/// The backlash of each mesh over v[kAngleA] and the sum of its shifts.
class BacklashAt {
 public:
  BacklashAt(const RefinementProblem& problem, const train::TrainGeometry<double>& train,
             const Multiples& shifts)
      : shifts_(&shifts) {
    const auto parameters = parameters_at(problem, used(problem, problem.upper));
    const double alpha = parameters.pressure_angle_rad;
    involute_ = geometry::involute(alpha);
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto first = static_cast<std::size_t>(train::kMeshGears[k][0]);
      const auto second = static_cast<std::size_t>(train::kMeshGears[k][1]);
      const double m = parameters.module_m[k == train::kMeshP2R2 ? 1 : 0];
      sign_[k] = k == train::kMeshSP1 ? 1.0 : -1.0;
      base_m_[k] = train.gears[second].base_radius_m + sign_[k] * train.gears[first].base_radius_m;
      per_shift_m_[k] = 2.0 * m * std::sin(alpha);
      allowance_m_[k] =
          m * (parameters.machining_allowance[first] + parameters.machining_allowance[second]);
    }
    base_a_m_ = base_m_[static_cast<std::size_t>(problem.angle_mesh)];
  }

  /// [m]
  [[nodiscard]] double at(std::size_t k, long steps, double angle_rad) const {
    const double working = std::acos(std::min(1.0, base_m_[k] * std::cos(angle_rad) / base_a_m_));
    const double opened = 2.0 * base_m_[k] * (geometry::involute(working) - involute_);
    return allowance_m_[k] + sign_[k] * (opened - per_shift_m_[k] * shifts_->at(steps));
  }

  /// The angle at which it has a value; minus infinity where it has none.
  [[nodiscard]] double angle_of(std::size_t k, long steps, double backlash_m) const {
    const double involute = involute_ + (sign_[k] * (backlash_m - allowance_m_[k]) +
                                         per_shift_m_[k] * shifts_->at(steps)) /
                                            (2.0 * base_m_[k]);
    if (!(involute > 0.0)) return -kInfinity;
    const double distance_m = base_m_[k] / std::cos(geometry::inverse_involute(involute));
    return distance_m > base_a_m_ ? std::acos(base_a_m_ / distance_m) : 0.0;
  }

 private:
  const Multiples* shifts_;
  double involute_ = 0.0, base_a_m_ = 0.0;
  std::array<double, kMeshCount> sign_{}, base_m_{}, per_shift_m_{}, allowance_m_{};
};

/// For each sum of the shifts of a mesh the angles v[kAngleA] that its backlash leaves.
using Windows = std::array<std::vector<Interval>, kMeshCount>;
Windows windows_of(const RefinementProblem& problem, const BacklashAt& backlash,
                   const BacklashLimits& limits, const MeshRanges& sums) {
  const Interval all{problem.lower[kAngleA] - kAngleSlack, problem.upper[kAngleA] + kAngleSlack};
  Windows windows;
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    for (long n = sums[k][0]; n <= sums[k][1]; ++n) {
      double lo = backlash.angle_of(k, n, limits.range[k].lo);
      double hi = backlash.angle_of(k, n, limits.range[k].hi);
      if (k != train::kMeshSP1) std::swap(lo, hi);
      windows[k].push_back(both(all, {lo - kAngleSlack, hi + kAngleSlack}));
    }
  }
  return windows;
}

/// What the meshes' lost motion together leaves of the angles that each of them leaves by itself.
/// Towards greater distances the backlash of S-P1 rises and the rings' fall: between two angles
/// each is at least that of one end.
class LostMotionTogether {
 public:
  LostMotionTogether(const train::TrainGeometry<double>& train, const BacklashAt& backlash,
                     const BacklashLimits& limits, backlash::LostMotionModel model)
      : train_(train), backlash_(backlash), limits_(limits), model_(model) {}

  [[nodiscard]] Interval keep(const Interval& angle_rad,
                              const std::array<long, kMeshCount>& steps) const {
    constexpr int kParts = 8;
    Meshes below = at(steps, angle_rad.lo);
    const Meshes end = at(steps, angle_rad.hi);
    if (least(end, below) <= limits_.most_rad) return angle_rad;  // nothing is beyond it
    Interval kept{kInfinity, -kInfinity};
    const double width = angle_rad.width() / kParts;
    for (int part = 0; part < kParts; ++part) {
      const double lo = angle_rad.lo + part * width;
      const double hi = part + 1 == kParts ? angle_rad.hi : lo + width;
      const Meshes above = part + 1 == kParts ? end : at(steps, hi);
      if (least(below, above) <= limits_.most_rad) {
        kept = {std::min(kept.lo, lo), std::max(kept.hi, hi)};
      }
      below = above;
    }
    return kept;
  }

 private:
  using Meshes = std::array<double, kMeshCount>;
  [[nodiscard]] Meshes at(const std::array<long, kMeshCount>& steps, double angle_rad) const {
    Meshes j{};
    for (std::size_t k = 0; k < kMeshCount; ++k) j[k] = backlash_.at(k, steps[k], angle_rad);
    return j;
  }
  /// With the sun's backlash of one angle and those of the rings of another.
  [[nodiscard]] double least(const Meshes& of_sun, const Meshes& of_rings) const {
    Meshes j{of_sun[train::kMeshSP1], of_rings[train::kMeshP1R1], of_rings[train::kMeshP2R2]};
    for (std::size_t k = 0; k < kMeshCount; ++k) j[k] = std::max(j[k], limits_.range[k].lo);
    return backlash::output_lost_motion(train_, j, model_);
  }

  const train::TrainGeometry<double>& train_;
  const BacklashAt& backlash_;
  const BacklashLimits& limits_;
  backlash::LostMotionModel model_;
};

}  // namespace

std::optional<GridDistances> GridDistances::of(const RefinementProblem& problem,
                                               const Multiples& shifts) {
  if (problem.pressure_angle > 0 || !problem.fixed_module_m[0] || !problem.fixed_module_m[1]) {
    return std::nullopt;
  }
  const auto train =
      train::make_train_geometry(parameters_at(problem, used(problem, problem.upper)));
  if (!train) return std::nullopt;
  const auto limits = backlash_limits(problem, *train);
  if (!limits) return std::nullopt;

  LatticeBox whole;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    whole.push_back({shifts.first_from(problem.lower[i]), shifts.last_to(problem.upper[i])});
  }
  const MeshRanges sums = sums_of(whole);
  const BacklashAt backlash(problem, *train, shifts);
  const Windows windows = windows_of(problem, backlash, *limits, sums);
  const LostMotionTogether together(*train, backlash, *limits, problem.spec->limits.model);
  GridDistances distances;
  const auto window = [&](std::size_t k, long n) {
    return windows[k][static_cast<std::size_t>(n - sums[k][0])];
  };
  std::size_t looks = 0;
  for (long n1 = sums[0][0]; n1 <= sums[0][1]; ++n1) {
    for (long n2 = sums[1][0]; n2 <= sums[1][1]; ++n2) {
      const Interval stage1 = both(window(0, n1), window(1, n2));
      if (stage1.empty()) continue;
      for (long n3 = sums[2][0]; n3 <= sums[2][1]; ++n3) {
        Interval angle = both(stage1, window(2, n3));
        if (angle.empty()) continue;
        if (++looks > kMostLooks) return std::nullopt;
        angle = together.keep(angle, {n1, n2, n3});
        if (angle.empty()) continue;
        if (distances.left_.size() == kMostSums) return std::nullopt;
        distances.left_.push_back({.steps = {n1, n2, n3}, .angle_rad = angle});
      }
    }
  }
  return distances;
}

std::optional<Interval> GridDistances::confine(LatticeBox& box) const {
  for (;;) {
    const MeshRanges ranges = sums_of(box);
    Interval angle_rad{kInfinity, -kInfinity};
    MeshRanges hull = ranges;
    bool any = false;
    for (const Sums& sums : left_) {
      if (!holds(ranges, sums.steps)) continue;
      for (std::size_t k = 0; k < kMeshCount; ++k) {
        hull[k] = any ? std::array{std::min(hull[k][0], sums.steps[k]),
                                   std::max(hull[k][1], sums.steps[k])}
                      : std::array{sums.steps[k], sums.steps[k]};
      }
      any = true;
      angle_rad = {std::min(angle_rad.lo, sums.angle_rad.lo),
                   std::max(angle_rad.hi, sums.angle_rad.hi)};
    }
    if (!any) return std::nullopt;
    const LatticeBox before = box;
    keep_sums(box, hull);
    if (std::ranges::any_of(box, [](const auto& axis) { return axis[0] > axis[1]; })) {
      return std::nullopt;
    }
    if (box == before) return angle_rad;
  }
}

}  // namespace gear3k::optimize
