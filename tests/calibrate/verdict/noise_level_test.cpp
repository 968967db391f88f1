#include "calibrate/verdict/noise_level.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <boost/math/distributions/normal.hpp>

namespace gear3k::calibrate::noise_level_test {
namespace {

/// Rows of stated scatter 1 that lie as n normal deviates of another scatter do.
struct StatedRows {
  NoiseModel noise;
  Eigen::VectorXd left;
  LeftOver left_over() const {
    return {.whitened = left,
            .degrees = static_cast<int>(left.size()),
            .scale = robust_deviation(left)};
  }
};
StatedRows stated_rows(int n, double scatter) {
  StatedRows rows;
  rows.noise.source = NoiseSource::kStated;
  rows.noise.weight = Eigen::VectorXd::Ones(n);
  rows.left.resize(n);
  const boost::math::normal law;
  for (int i = 0; i < n; ++i) rows.left[i] = scatter * quantile(law, (i + 0.5) / n);
  return rows;
}

TEST(StatedLevel, HoldsWhereRowsScatterSoWithinAQuarter) {
  for (const double scatter : {0.85, 1.0, 1.2}) {
    const StatedRows rows = stated_rows(60, scatter);
    EXPECT_TRUE(stated_level_holds(rows.noise, rows.left_over(), false)) << scatter;
    EXPECT_TRUE(stated_level_holds(rows.noise, rows.left_over(), true)) << scatter;
  }
}

TEST(StatedLevel, DoesNotHoldWhereItIsFarTooGreat) {
  for (const double scatter : {5e-4, 0.5}) {
    const StatedRows rows = stated_rows(60, scatter);
    EXPECT_FALSE(stated_level_holds(rows.noise, rows.left_over(), false)) << scatter;
    EXPECT_FALSE(stated_level_holds(rows.noise, rows.left_over(), true)) << scatter;
  }
  // Half of it by chance: 20 rows are not enough to say so at 0.8 of it.
  const StatedRows few = stated_rows(20, 0.78);
  EXPECT_TRUE(stated_level_holds(few.noise, few.left_over(), false));
}

TEST(StatedLevel, DoesNotHoldWhereItIsTooSmallUnlessStructureMayBeWhy) {
  const StatedRows rows = stated_rows(60, 2.0);
  EXPECT_FALSE(stated_level_holds(rows.noise, rows.left_over(), false));
  EXPECT_TRUE(stated_level_holds(rows.noise, rows.left_over(), true));
}

TEST(StatedLevel, HoldsForRowsTooFewToSayOtherwise) {
  for (const double scatter : {0.01, 3.0}) {
    const StatedRows rows = stated_rows(12, scatter);
    EXPECT_TRUE(stated_level_holds(rows.noise, rows.left_over(), false)) << scatter;
  }
  StatedRows none = stated_rows(60, 3.0);
  none.noise.source = NoiseSource::kResiduals;
  EXPECT_TRUE(stated_level_holds(none.noise, none.left_over(), false));
}

TEST(NoiseLevel, IsThatOfTheRowsWhereTheStatedOneIsNot) {
  const StatedRows rows = stated_rows(60, 0.5);
  const NoiseLevel stated = noise_level(rows.noise, {}, 0.5, true);
  EXPECT_EQ(stated.source, NoiseSource::kStated);
  EXPECT_EQ(stated.scale, 1.0);
  const NoiseLevel left = noise_level(rows.noise, {}, 0.5, false);
  EXPECT_EQ(left.source, NoiseSource::kResiduals);
  EXPECT_EQ(left.scale, 0.5);
  const NoiseLevel repeats =
      noise_level(rows.noise, {.sum_of_squares = 0.16 * 25, .degrees = 25}, 0.5, false);
  EXPECT_EQ(repeats.source, NoiseSource::kRepeats);
  EXPECT_NEAR(repeats.scale, 0.4, 1e-12);
}

TEST(NoiseLevel, NoteSaysByWhatFactor) {
  EXPECT_NE(note_on_stated_level(2.1).find("scatter by 2.1 times the stated"), std::string::npos);
  EXPECT_NE(note_on_stated_level(0.0005).find("sigma is 2e+03 times what"), std::string::npos);
}

}  // namespace
}  // namespace gear3k::calibrate::noise_level_test
