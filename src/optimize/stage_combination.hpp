#pragma once
// What two relaxed stages make of a tooth set.

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "optimize/efficiency_bound.hpp"
#include "optimize/shift_range.hpp"
#include "optimize/stage_relaxer.hpp"

namespace gear3k::optimize {

struct SetBound {
  bool known = false;  ///< else nothing is known of the set but a proof of infeasible shifts
  std::optional<Infeasibility> infeasible;
  double eta_b = 1.0, eta_f = 1.0;  ///< no feasible design of the set has more; 0 = cannot run so
  /// Where both stages come nearest to it: shifts, and both distances in modules.
  StagePoint stage1, stage2;
  std::array<double, train::kMeshCount> losses{};  ///< of the meshes about there
};

/// Greatest efficiencies over the ways in which stages share the lost motion.
struct BestLevels {
  double eta_b = 0.0, eta_f = 0.0;
  /// The level of stage 1 with the greatest of the efficiency that decides; empty: no level of both
  /// stages together has a design.
  std::optional<std::size_t> level;
};

/// Stage 1 has at most the share of its level, stage 2 what the level below leaves.
/// @param first   (level) → the region of stage 1's losses, empty where it has no design
/// @param second  (level) → the loss of stage 2, likewise
template <class First, class Second>
BestLevels best_levels(const train::ToothSet& z, std::size_t levels, bool forward, First first,
                       Second second) {
  BestLevels best;
  double greatest = -1.0;
  for (std::size_t level = 0; level < levels; ++level) {
    const std::optional<LossRegion> region = first(level);
    const std::optional<double> loss = second(levels - 1 - level);
    if (!region || !loss) continue;
    const double eta_b = most_backward(z, *region, *loss);
    const double eta_f = most_forward(z, *region, *loss);
    best.eta_b = std::max(best.eta_b, eta_b);
    best.eta_f = std::max(best.eta_f, eta_f);
    const double value = forward ? eta_f : eta_b;
    if (value > greatest) {
      greatest = value;
      best.level = level;
    }
  }
  return best;
}

/// A bound without proof of infeasibility: the best levels of two relaxed stages.
/// @returns whether they have one together
bool take_best_level(const train::ToothSet& z, const RelaxedStage1& stage1,
                     const RelaxedStage2& stage2, std::size_t levels, bool forward,
                     SetBound& bound);

}  // namespace gear3k::optimize
