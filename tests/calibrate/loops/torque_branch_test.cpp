#include "calibrate/loops/torque_branch.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace gear3k::calibrate::torque_branch_test {
namespace {

using Samples = std::vector<std::size_t>;

/// θ = 2 T, sampled once a second.
struct Straight {
  std::vector<double> time_s;
  TorqueAngleCurve curve;
};

Straight straight(const std::vector<double>& torque_Nm) {
  Straight s{.time_s = {}, .curve = {.torque_Nm = torque_Nm, .angle_rad = {}}};
  s.time_s.reserve(torque_Nm.size());
  s.curve.angle_rad.reserve(torque_Nm.size());
  for (const double torque : torque_Nm) {
    s.time_s.push_back(static_cast<double>(s.time_s.size()));
    s.curve.angle_rad.push_back(2.0 * torque);
  }
  return s;
}

TEST(TorqueBranch, TurnsWhereTheSignalSwingsBackFarEnough) {
  const std::vector<double> x{0.0, 2.0, 1.0, 5.0, 3.0, 4.0, -5.0, -4.0, -4.5, 5.0};
  EXPECT_EQ(turning_points(x, 0.3), (Samples{0, 3, 6, 9}));
  // The swings of 1 and 2 count as well.
  EXPECT_EQ(turning_points(x, 0.06), (Samples{0, 1, 2, 3, 4, 5, 6, 9}));
  EXPECT_EQ(turning_points(std::vector<double>(5, 1.0), 0.3), Samples{});
  EXPECT_EQ(turning_points({}, 0.3), Samples{});
}

TEST(TorqueBranch, FirstOneIsLoadedOnlyWhenItStartsFarOnTheSideItComesFrom) {
  const auto first = [](const std::vector<double>& torque) {
    return find_branches(straight(torque).curve, {0, 1, 2}).at(0);
  };
  EXPECT_TRUE(first({-4.0, 5.0, -5.0}).rising);
  EXPECT_FALSE(first({4.0, -5.0, 5.0}).rising);
  EXPECT_TRUE(first({-2.5, 5.0, -5.0}).loaded);
  EXPECT_FALSE(first({-2.4, 5.0, -5.0}).loaded);
  EXPECT_FALSE(first({1.0, 5.0, -5.0}).loaded);
  EXPECT_TRUE(first({2.5, -5.0, 5.0}).loaded);
  EXPECT_FALSE(first({0.0, -5.0, 5.0}).loaded);
  // Never across zero: not the first branch's fault.
  EXPECT_TRUE(first({1.0, 5.0, 1.0}).loaded);
  EXPECT_TRUE(find_branches(straight({-1.0, 5.0}).curve, {1}).empty());
}

TEST(TorqueBranch, CrossingIsTheMeanOfFirstAndLastPassage) {
  // Passes 1 Nm at 1.5 s, 2.5 s and 3.5 s; the angle wanders meanwhile.
  Straight s = straight({-2.0, 0.0, 2.0, 0.0, 2.0, 4.0});
  s.curve.angle_rad = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0};
  const Branch branch{.first = 0, .last = 5, .rising = true};
  const auto found = torque_crossing(s.time_s, s.curve, branch, 1.0);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->angle_rad, 2.5);
  EXPECT_DOUBLE_EQ(found->time_s, 2.5);
  EXPECT_DOUBLE_EQ(found->spread_rad, 2.0);
  EXPECT_EQ(found->i, 1u);
  EXPECT_EQ(found->j, 2u);
  EXPECT_DOUBLE_EQ(found->s, 0.5);
  EXPECT_FALSE(torque_crossing(s.time_s, s.curve, branch, 4.5));
}

TEST(TorqueBranch, EndingJustShortOfZeroIsContinuedAlongItsSecant) {
  const Straight s = straight({-10.0, -6.0, -3.0, -1.0});
  const Branch branch{.first = 0, .last = 3, .rising = true};
  const auto found =
      zero_torque_crossing(s.time_s, s.curve, branch, {.reach_fraction = 0.2, .secant = 2});
  ASSERT_TRUE(found);
  // The angle is a straight line of the torque.
  EXPECT_NEAR(found->angle_rad, 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(found->extrapolated_Nm, 1.0);
  EXPECT_EQ(found->i, 1u);
  EXPECT_DOUBLE_EQ(found->s, 6.0 / 5.0);
  EXPECT_FALSE(
      zero_torque_crossing(s.time_s, s.curve, branch, {.reach_fraction = 0.09, .secant = 2}));
  // On its way from zero, not to it.
  const Straight away = straight({0.5, 6.0, 10.0});
  EXPECT_FALSE(zero_torque_crossing(away.time_s, away.curve,
                                    {.first = 0, .last = 2, .rising = true},
                                    {.reach_fraction = 0.9, .secant = 2}));
}

}  // namespace
}  // namespace gear3k::calibrate::torque_branch_test
