#include "optimize/objective_value.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "optimize/optimizer.hpp"
#include "optimize/refine.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::objective_value_test {
namespace {

TEST(BestValue, NoRefinedSetIsBetter) {
  int refined = 0;
  // The last seeds have KHK tips on gears at negative shifts.
  const std::vector<std::uint64_t> all{9, 11, 12, 17, 22, 28, 31, 32, 34, 36, 39, 209};
  for (const std::uint64_t seed : sample(std::vector<std::uint64_t>{9, 22, 39, 209}, all)) {
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
  EXPECT_GT(refined, sample(13, 40));
}

}  // namespace
}  // namespace gear3k::optimize::objective_value_test
