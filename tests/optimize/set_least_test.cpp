// The least lost motion of single sets against another solver, and against what refinements within
// limits find.

#include "optimize/set_least.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "io/files/specification_file.hpp"

namespace gear3k::optimize::set_least_test {
namespace {

Specification ratio_96() {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
}

Candidate candidate(int s, int p1, int r1, int p2, int r2) {
  return {.teeth = {.S = s, .P1 = p1, .R1 = r1, .P2 = p2, .R2 = r2}, .planets = 3};
}

const std::array<Candidate, 2> kSets{candidate(15, 63, 141, 53, 133),
                                     candidate(24, 51, 126, 53, 140)};

TEST(LeastLostMotion, IsThatOfAnotherSolver) {
  const Specification spec = ratio_96();
  Specification other = spec;
  other.objectives = {Objective::kLostMotion};
  other.solver.refine = Refine::kIpopt;
  LeastLostMotion least(spec);
  const StopFlag never;
  for (const Candidate& set : kSets) {
    const RefinedSet by_ipopt = refine(other, set);
    ASSERT_EQ(by_ipopt.status, Status::kOptimal);
    EXPECT_EQ(least.known(set), nullptr);
    const auto* own = least.of(set, never);
    ASSERT_NE(own, nullptr);
    EXPECT_EQ(least.known(set), own);
    // Both give way by the tolerance of feasibility; Ipopt may stay in a worse basin.
    EXPECT_LT(own->lost_motion_rad, by_ipopt.lost_motion_rad * (1.0 + 1e-5));
    EXPECT_GT(own->lost_motion_rad, by_ipopt.lost_motion_rad * 0.98);
  }
}

TEST(LeastLostMotion, HasADesignThatASearchWithinItMayBeginWith) {
  Specification spec = ratio_96();
  LeastLostMotion least(spec);
  const StopFlag never;
  for (const Candidate& set : kSets) {
    const auto* own = least.of(set, never);
    ASSERT_NE(own, nullptr);
    const auto train = train::make_train_geometry(own->at.train);
    ASSERT_TRUE(train);
    EXPECT_NEAR(backlash::output_lost_motion(*train, backlash::normal_backlashes(*train),
                                             backlash::LostMotionModel::kKinematic),
                own->lost_motion_rad, 1e-12);
    Progress progress;
    const std::array one{set};
    const SetBounds bounds(spec, one, progress);
    const auto within = [&](double share) {
      Specification narrow = spec;
      narrow.limits[design::CheckId::kOutputBacklashMax] = share * own->lost_motion_rad;
      return Refiner(narrow).refine(set, bounds.shifts().of(set.teeth),
                                    std::array{ModuleBound{.pair = {}, .bound = {}}}, never,
                                    {.design = &own->at});
    };
    EXPECT_EQ(within(1.001)->status, Status::kOptimal);
    EXPECT_EQ(within(0.999)->status, Status::kNoFeasibleFound);
  }
}

// By hand: 10 um in each mesh, rings of shift 0 whose root circles are 76 mm.
TEST(LeastLostMotion, BelowWhatSizesLeaveIsProvenToHaveNoDesign) {
  Specification spec = ratio_96();
  for (const Candidate& set : kSets) {
    const train::ToothSet& z = set.teeth;
    const double half_cos = 0.5 * std::cos(20.0 * std::numbers::pi / 180.0);
    const double m1 = 76e-3 / (z.R1 + 2.5), m2 = 76e-3 / (z.R2 + 2.5);
    const double ratio = (1.0 + 1.0 * z.R1 / z.S) / (1.0 - 1.0 * z.P2 * z.R1 / (z.P1 * z.R2));
    const double least_rad =
        10e-6 / half_cos *
        (1.0 / (ratio * m1 * z.S) + (1.0 - 1.0 / ratio) / (m1 * z.R1) + 1.0 / (m2 * z.R2));
    const std::array one{set};
    const auto bound_within = [&](double limit_rad) {
      spec.limits[design::CheckId::kOutputBacklashMax] = limit_rad;
      Progress progress;
      return SetBounds(spec, one, progress).of(0);
    };
    const SetBound below = bound_within(0.999 * least_rad);
    ASSERT_TRUE(below.infeasible);
    EXPECT_EQ(below.infeasible->check, design::CheckId::kOutputBacklashMax);
    EXPECT_NEAR(below.infeasible->miss_si, 0.001 * least_rad, 1e-4 * least_rad);
    EXPECT_FALSE(bound_within(1.001 * least_rad).infeasible);
  }
}

TEST(LeastLostMotion, KnowsNothingOfLists) {
  Specification spec = ratio_96();
  EXPECT_TRUE(LeastLostMotion::knows(spec));
  spec.shift_step = 0.01;
  EXPECT_FALSE(LeastLostMotion::knows(spec));
  Specification modules = ratio_96();
  modules.module[0] = {.range_m = std::nullopt, .series_m = {0.5e-3}};
  EXPECT_TRUE(LeastLostMotion::knows(modules)) << "of one choice";
  modules.module[0].series_m = {0.5e-3, 0.6e-3};
  EXPECT_FALSE(LeastLostMotion::knows(modules));
  Specification cutters = ratio_96();
  cutters.cutter_teeth[train::kR1] = {18};
  EXPECT_TRUE(LeastLostMotion::knows(cutters)) << "of one cutter";
  cutters.cutter_teeth[train::kR1] = {18, 20};
  EXPECT_FALSE(LeastLostMotion::knows(cutters));
}

TEST(LeastLostMotion, IsNotToldWhenItIsStopped) {
  LeastLostMotion least(ratio_96());
  const StopFlag stopped(true);
  EXPECT_EQ(least.of(kSets[0], stopped), nullptr);
}

}  // namespace
}  // namespace gear3k::optimize::set_least_test
