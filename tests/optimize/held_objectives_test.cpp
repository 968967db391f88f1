#include "optimize/held_objectives.hpp"

#include <gtest/gtest.h>

#include "optimize/refine.hpp"
#include "tests/optimize/least_lost_motion.hpp"

namespace gear3k::optimize::held_objectives_test {
namespace {

/// The least lost motion of a tooth set at any efficiency.
RefinedSet least_lost_motion_of(const Specification& spec) {
  Specification alone = spec;
  alone.objectives = {Objective::kLostMotion};
  return refine(alone,
                {.teeth = {.S = 18, .P1 = 48, .R1 = 114, .P2 = 44, .R2 = 113}, .planets = 3});
}

TEST(HeldObjectives, ADesignOfLeastLostMotionGetsTheEfficiencyThatIsLeftThere) {
  const Specification spec = test::of_least_lost_motion();
  const RefinedSet least = least_lost_motion_of(spec);
  ASSERT_TRUE(has_design(least.status));
  const StopFlag never;
  const auto better = bettered(spec, least, never);
  ASSERT_TRUE(better);
  EXPECT_EQ(better->candidate, least.candidate);
  EXPECT_GT(better->eta_b, least.eta_b + 0.001) << "or this case shows nothing";
  EXPECT_LE(better->lost_motion_rad, least.lost_motion_rad * (1.0 + 3e-6));
}

TEST(HeldObjectives, ADesignThatIsBetteredStaysAsItIs) {
  const Specification spec = test::of_least_lost_motion();
  const StopFlag never;
  const auto once = bettered(spec, least_lost_motion_of(spec), never);
  ASSERT_TRUE(once);
  const auto twice = bettered(spec, *once, never);
  ASSERT_TRUE(twice);
  EXPECT_NEAR(twice->lost_motion_rad, once->lost_motion_rad, 3e-6 * once->lost_motion_rad);
  EXPECT_NEAR(twice->eta_b, once->eta_b, 1e-3) << "what a millionth of lost motion is worth here";
}

TEST(HeldObjectives, StoppedHasNoAnswer) {
  const Specification spec = test::of_least_lost_motion();
  EXPECT_FALSE(bettered(spec, least_lost_motion_of(spec), StopFlag(true)));
}

}  // namespace
}  // namespace gear3k::optimize::held_objectives_test
