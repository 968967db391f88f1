#include "optimize/objective_value.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numbers>
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

// Mass and density of torque of gears of several materials, by the cylinders of the analysis.
TEST(ObjectiveValue, MassSumsGearsOfTheirOwnDensities) {
  test::RandomTask task = test::random_task(9, 3);
  Specification& spec = task.spec;
  spec.bodies.gear_density_kgm3 = {7830.0, 1415.0, 8500.0, 1420.0, 1140.0};
  EXPECT_FALSE(knows_masses(spec));
  spec.bodies.face_width_m = {0.01, 0.012};
  EXPECT_TRUE(knows_masses(spec));
  spec.bodies.ring_rim_m = 0.002;
  spec.objectives = {Objective::kMass};
  for (const Candidate& candidate : task.candidates) {
    const RefinedSet set = refine(spec, candidate);
    if (set.status != Status::kOptimal) continue;
    const design::Design found = design_of(spec, set);
    const auto gears = train::make_train_gears(found.train);
    double by_hand = 0.0;
    for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
      const auto& g = gears[gear];
      const bool ring = g.gear.kind == geometry::GearKind::kRing;
      const double toothed = 0.5 * (g.tip_radius_m + g.root_radius_m);
      const double outer = ring ? g.root_radius_m + 0.002 : toothed;
      const double inner = ring ? toothed : 0.0;
      const bool step = gear == train::kP1 || gear == train::kP2;
      by_hand +=
          (step ? candidate.planets : 1) * *spec.bodies.gear_density_kgm3[gear] *
          *spec.bodies
               .face_width_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(gear)))] *
          std::numbers::pi * (outer * outer - inner * inner);
    }
    EXPECT_NEAR(objective_of(spec, set, Objective::kMass), by_hand, 1e-9 * by_hand);
    EXPECT_EQ(found.masses.gear_density_kgm3, spec.bodies.gear_density_kgm3);
    return;
  }
  FAIL() << "no set was refined";
}

}  // namespace
}  // namespace gear3k::optimize::objective_value_test
