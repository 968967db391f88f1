#include "calibrate/model/law_doubt.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::law_doubt_test {
namespace {

constexpr double kStatedShare = 0.35;

MeshLosses some_losses() {
  return {{{.share = 0.03, .normal_force_N = 25.0, .sliding_speed_m_s = 0.03, .change = 0.1},
           {.share = 0.05, .normal_force_N = 190.0, .sliding_speed_m_s = 0.007, .change = 0.3},
           {.share = 0.02, .normal_force_N = 215.0, .sliding_speed_m_s = 0.004, .change = 0.3}}};
}

TEST(GainDoubt, IsNoneOfTheGearboxItselfAndOfOneThatOnlyLosesLess) {
  const MeshLosses before = some_losses();
  EXPECT_NEAR(gain_doubt(before, before), 0.0, 1e-9);
  MeshLosses after = before;
  for (MeshLoss& mesh : after) mesh.share *= 0.8;
  EXPECT_NEAR(gain_doubt(before, after), 0.0, 1e-9) << "that the campaign has measured";
}

TEST(GainDoubt, IsNoneWhereTheModelLeavesTheFlanksAlone) {
  MeshLosses before = some_losses();
  for (MeshLoss& mesh : before) mesh.change = 0.0;
  MeshLosses after = before;
  std::swap(after[0].share, after[1].share);
  EXPECT_EQ(gain_doubt(before, after), 0.0);
}

/// By drawing what it is defined by.
TEST(GainDoubt, IsTheScatterOfItsDefinition) {
  const MeshLosses before = some_losses();
  MeshLosses after = before;
  after[0].share = 0.045;
  after[1].share = 0.03;
  after[1].normal_force_N *= 1.5;
  after[2].sliding_speed_m_s *= 0.6;
  rig::DeterministicRandom random(1);
  constexpr int kDraws = 40000;
  double square = 0.0;
  for (int n = 0; n < kDraws; ++n) {
    std::array<double, 3> d_before{};
    std::array<double, 3> d_after{};
    double mean = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double force = std::log(after[k].normal_force_N / before[k].normal_force_N);
      const double speed = std::log(after[k].sliding_speed_m_s / before[k].sliding_speed_m_s);
      const double likeness = std::exp(-0.5 * (force * force + speed * speed));
      const double own = random.normal();
      const double here = random.normal();
      const double there = likeness * here + std::sqrt(1.0 - likeness * likeness) * random.normal();
      d_before[k] = kStatedShare * 0.3 * (own + here);
      d_after[k] = kStatedShare * 0.3 * (own + there);
      mean += before[k].share * d_before[k] / 0.1;
    }
    double gain = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      gain -= after[k].share * (d_after[k] - mean) - before[k].share * (d_before[k] - mean);
    }
    square += gain * gain / kDraws;
  }
  // Four standard errors of a deviation from so many draws.
  EXPECT_NEAR(gain_doubt(before, after), std::sqrt(square),
              4.0 / std::sqrt(2.0 * kDraws) * std::sqrt(square));
  EXPECT_NEAR(gain_doubt(before, after, true), 2.0 * gain_doubt(before, after), 1e-15);
}

}  // namespace
}  // namespace gear3k::calibrate::law_doubt_test
