#include "optimize/objective_value.hpp"

#include <gtest/gtest.h>

#include "optimize/optimizer.hpp"
#include "optimize/refine.hpp"
#include "tests/optimize/random_specification.hpp"

namespace gear3k::optimize::objective_value_test {
namespace {

TEST(BestValue, NoRefinedSetIsBetter) {
  int refined = 0;
  // The last seeds have KHK tips on gears at negative shifts.
  for (const std::uint64_t seed : {9U, 11U, 12U, 17U, 22U, 28U, 31U, 32U, 34U, 36U, 39U, 209U}) {
    test::RandomTask task = test::random_task(seed, 3);
    Specification& spec = task.spec;
    spec.bodies.density_kgm3 = 7850.0;
    spec.bodies.face_width_m = {0.01, 0.012};
    spec.bodies.ring_rim_m = 0.002;
    for (const Objective objective : {Objective::kMass, Objective::kInertia,
                                      Objective::kOuterDiameter, Objective::kLostMotion}) {
      spec.objectives = {objective};
      for (const Candidate& candidate : task.candidates) {
        const RefinedSet set = refine(spec, candidate);
        if (set.status != Status::kOptimal) continue;
        ++refined;
        // What misses of all limits by the feasibility tolerance may bring.
        const double slack = 4e-6 * objective_scale(objective, spec);
        EXPECT_GE(objective_of(spec, set, objective),
                  best_value(objective, spec, candidate.teeth, candidate.planets) - slack)
            << "seed " << seed << " " << objective_record(objective).name;
      }
    }
  }
  EXPECT_GT(refined, 40);
}

}  // namespace
}  // namespace gear3k::optimize::objective_value_test
