#include "optimize/stage_combination.hpp"

namespace gear3k::optimize {

bool take_best_level(const train::ToothSet& z, const RelaxedStage1& stage1,
                     const RelaxedStage2& stage2, std::size_t levels, bool forward,
                     SetBound& bound) {
  const BestLevels best = best_levels(
      z, levels, forward,
      [&](std::size_t level) -> std::optional<LossRegion> {
        const Stage1Level& at = stage1.level[level];
        if (at.empty) return std::nullopt;
        return LossRegion{.sun = at.sun,
                          .ring = at.ring,
                          .weighted = at.weighted,
                          .sun_weight = stage1.sun_weight};
      },
      [&](std::size_t level) -> std::optional<double> {
        const Stage2Level& at = stage2.level[level];
        return at.empty ? std::nullopt : std::optional(at.ring);
      });
  bound.eta_b = best.eta_b;
  bound.eta_f = best.eta_f;
  if (!best.level) return false;
  const Stage1Level& first = stage1.level[*best.level];
  const Stage2Level& second = stage2.level[levels - 1 - *best.level];
  bound.stage1 = first.point;
  bound.stage2 = second.point;
  bound.losses = {first.sun, std::max(first.ring, first.weighted - stage1.sun_weight * first.sun),
                  second.ring};
  return true;
}

}  // namespace gear3k::optimize
