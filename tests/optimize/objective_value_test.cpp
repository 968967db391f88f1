#include "optimize/objective_value.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/refine.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/sample.hpp"
#include "tests/strength/steel.hpp"

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
    spec.bodies.bore_radius_m = {0.5e-3, 1e-3, 0.0, 1e-3, 0.0};
    spec.limits[design::CheckId::kWall] = 0.2e-3;
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

/// Gears of five materials, with bores.
GearBodySizes bodies_of_five_materials() {
  return {.density_kgm3 = {},
          .gear_density_kgm3 = {7830.0, 1415.0, 8500.0, 1420.0, 1140.0},
          .face_width_m = {0.01, 0.012},
          .ring_rim_m = 0.002,
          .bore_radius_m = {0.5e-3, 1e-3, 0.0, 1e-3, 0.0}};
}

/// Volume of each gear's cylinder times its own density.
double mass_by_hand_kg(const GearBodySizes& bodies, const design::Design& found) {
  const auto gears = train::make_train_gears(found.train);
  double sum_kg = 0.0;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    const auto& g = gears[gear];
    const bool ring = g.gear.kind == geometry::GearKind::kRing;
    const double toothed = 0.5 * (g.tip_radius_m + g.root_radius_m);
    const double outer = ring ? g.root_radius_m + bodies.ring_rim_m : toothed;
    const double inner = ring ? toothed : bodies.bore_radius_m[gear];
    const bool step = gear == train::kP1 || gear == train::kP2;
    const bool first = gear == train::kS || gear == train::kP1 || gear == train::kR1;
    sum_kg += (step ? found.train.planets : 1) * *bodies.gear_density_kgm3[gear] *
              *bodies.face_width_m[first ? 0 : 1] * std::numbers::pi *
              (outer * outer - inner * inner);
  }
  return sum_kg;
}

TEST(ObjectiveValue, MassSumsGearsOfTheirOwnDensities) {
  test::RandomTask task = test::random_task(9, 3);
  Specification& spec = task.spec;
  spec.bodies = bodies_of_five_materials();
  spec.bodies.face_width_m = {};
  EXPECT_FALSE(knows_masses(spec));
  spec.bodies = bodies_of_five_materials();
  EXPECT_TRUE(knows_masses(spec));
  spec.objectives = {Objective::kMass};
  for (const Candidate& candidate : task.candidates) {
    const RefinedSet set = refine(spec, candidate);
    if (set.status != Status::kOptimal) continue;
    const design::Design found = design_of(spec, set);
    const double by_hand = mass_by_hand_kg(spec.bodies, found);
    EXPECT_NEAR(objective_of(spec, set, Objective::kMass), by_hand, 1e-9 * by_hand);
    EXPECT_EQ(found.masses.gear_density_kgm3, spec.bodies.gear_density_kgm3);
    return;
  }
  FAIL() << "no set was refined";
}

TEST(ObjectiveValue, TorqueDensityIsOverTheMassOfGearsOfTheirOwnDensities) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  spec.bodies = bodies_of_five_materials();
  strength::RatingTask task;
  task.material.fill(strength::steel_700_290());
  task.torque_Nm = 5.0;
  task.face_width_m = {*spec.bodies.face_width_m[0], *spec.bodies.face_width_m[1]};
  spec.rating = task;
  spec.objectives = {Objective::kTorqueDensity};
  const RefinedSet set =
      refine(spec, {.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118}, .planets = 3});
  ASSERT_EQ(set.status, Status::kOptimal);
  const double by_hand =
      *set.torque_capacity_Nm / mass_by_hand_kg(spec.bodies, design_of(spec, set));
  EXPECT_NEAR(objective_of(spec, set, Objective::kTorqueDensity), by_hand, 1e-9 * by_hand);
}

}  // namespace
}  // namespace gear3k::optimize::objective_value_test
