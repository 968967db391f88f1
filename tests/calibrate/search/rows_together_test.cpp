#include "calibrate/search/rows_together.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::rows_together_test {
namespace {

/// Columns of groups of equal size, one after the other.
Eigen::MatrixXd groups_of(Eigen::Index rows, Eigen::Index size) {
  Eigen::MatrixXd groups = Eigen::MatrixXd::Zero(rows, rows / size);
  for (Eigen::Index i = 0; i < groups.cols() * size; ++i) groups(i, i / size) = 1.0;
  return groups;
}

Eigen::VectorXd noise(Eigen::Index rows, rig::DeterministicRandom& random) {
  Eigen::VectorXd r(rows);
  for (double& x : r) x = random.normal();
  return r;
}

TEST(RowsTogether, HaveTheChanceThatAllPlacesAndSignsGive) {
  // Every choice of 3 of 8 rows and every sign of them, by counting.
  constexpr int kRows = 8, kSize = 4;
  for (int hit = 2; hit <= 3; ++hit) {
    int cases = 0, with = 0;
    for (int a = 0; a < kRows; ++a) {
      for (int b = a + 1; b < kRows; ++b) {
        for (int c = b + 1; c < kRows; ++c) {
          for (int signs = 0; signs < 8; ++signs) {
            int above = 0, below = 0, k = 0;
            for (const int row : {a, b, c}) {
              if (row < kSize) ++((signs >> k & 1) != 0 ? above : below);
              ++k;
            }
            ++cases;
            if (above >= hit || below >= hit) ++with;
          }
        }
      }
    }
    EXPECT_NEAR(chance_together(kRows, 3, kSize, hit), static_cast<double>(with) / cases, 1e-12);
  }
}

TEST(RowsTogether, OfOneGroupAreFoundThere) {
  rig::DeterministicRandom random(1);
  Eigen::VectorXd r = noise(40, random);
  r.segment(35, 5).array() -= 10.0;
  const auto found = rows_together(r, 1.0, groups_of(40, 5));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->group, 7);
  EXPECT_EQ(found->off, 5);
  EXPECT_EQ(found->rows, 5);
  EXPECT_LT(found->p_value, 1e-4);
}

TEST(RowsTogether, OfAGroupThatIsOffInItsSenseAreFound) {
  // Up in the one row and down in the next: so a torque acts on readings of either direction.
  rig::DeterministicRandom random(2);
  Eigen::VectorXd r = noise(40, random);
  Eigen::MatrixXd groups = groups_of(40, 5);
  for (Eigen::Index i = 0; i < 40; i += 2) groups.row(i) *= -1.0;
  r.segment(35, 5) += 10.0 * groups.col(7).segment(35, 5);
  const auto found = rows_together(r, 1.0, groups);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(found->p_value, 1e-4);
  const auto blind = rows_together(r, 1.0, groups_of(40, 5));
  EXPECT_TRUE(!blind || blind->p_value > 0.01);
}

TEST(RowsTogether, AreRareWhereOutliersFallAtRandom) {
  // A tenth of the rows far off, anywhere and of any sign.
  int found = 0;
  constexpr int kCampaigns = 2000;
  for (int seed = 1; seed <= kCampaigns; ++seed) {
    rig::DeterministicRandom random(static_cast<std::uint64_t>(seed));
    Eigen::VectorXd r = noise(60, random);
    for (double& x : r) {
      if (random.between(0.0, 1.0) < 0.1) x *= 12.0;
    }
    const auto together = rows_together(r, 1.0, groups_of(60, 6));
    if (together && together->p_value <= 0.05) ++found;
  }
  EXPECT_LE(found, kCampaigns / 20);
}

TEST(RowsTogether, AreNoneWithTwoRowsNorInMoreThanHalf) {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(12);
  r.head(2).setConstant(50.0);
  EXPECT_FALSE(rows_together(r, 1.0, groups_of(12, 4)).has_value());
  r.head(8).setConstant(50.0);
  EXPECT_FALSE(rows_together(r, 1.0, groups_of(12, 8)).has_value());
  EXPECT_FALSE(rows_together(r, 0.0, groups_of(12, 4)).has_value());
}

}  // namespace
}  // namespace gear3k::calibrate::rows_together_test
