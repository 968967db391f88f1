#include "backlash/pitch_grade.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace gear3k::backlash::pitch_grade_test {
namespace {

/// A deviation as a report prints it.
double um(double length_m) { return std::round(length_m * 1e7) / 10.0; }

// KISSsoft 03/2017, stage_01 of the wind turbine in tests/golden/kisssoft_stage_01.toml, section
// of ISO 1328:1995 grade 6: module 45; reference diameters 855, 765 and 2520 mm.
TEST(PitchGrade, GivesTheDeviationsThatKisssoftPrints) {
  for (const double d_m : {0.855, 0.765}) {
    const auto t = pitch_grade({.module_m = 0.045, .reference_diameter_m = d_m}, 6);
    ASSERT_TRUE(t);
    EXPECT_EQ(um(t->single_pitch_m), 33.0);
    EXPECT_EQ(um(t->cumulative_pitch_m), 81.0);
    EXPECT_EQ(um(t->runout_m), 65.0);
  }
  const auto ring = pitch_grade({.module_m = 0.045, .reference_diameter_m = 2.52}, 6);
  ASSERT_TRUE(ring);
  EXPECT_EQ(um(ring->single_pitch_m), 38.0);
  EXPECT_EQ(um(ring->cumulative_pitch_m), 132.0);
  EXPECT_EQ(um(ring->runout_m), 105.0);
}

TEST(PitchGrade, DoublesEveryTwoGradesUpToRounding) {
  const GradedSize size{.module_m = 0.5e-3, .reference_diameter_m = 66e-3};
  for (int grade = kFinestGrade; grade + 2 <= kCoarsestGrade; ++grade) {
    const auto fine = pitch_grade(size, grade);
    const auto coarse = pitch_grade(size, grade + 2);
    ASSERT_TRUE(fine && coarse);
    // The finer value is rounded to half a micrometre at worst below 10 µm, else to one.
    const double step = coarse->cumulative_pitch_m > 10e-6 ? 1e-6 : 0.5e-6;
    EXPECT_NEAR(coarse->cumulative_pitch_m, 2.0 * fine->cumulative_pitch_m, 1.5 * step) << grade;
    EXPECT_NEAR(coarse->runout_m, 2.0 * fine->runout_m, 1.5 * step) << grade;
  }
}

// To 1 µm from 10 µm on, to 0.5 µm from 5 µm on, else to 0.1 µm.  At grade 5 f_pt of
// module 0.5 to 2 mm (mean 1) and diameter 50 to 125 mm (79.06) is 0.3 (1 + 0.4 · 8.891) + 4
// = 5.37.
TEST(PitchGrade, RoundsInStepsThatGrowAtFiveAndTenMicrometres) {
  bool seen[3] = {false, false, false};
  for (const double module_m : {1e-3, 3e-3, 5e-3}) {
    for (const double d_m : {10e-3, 40e-3, 100e-3, 200e-3, 400e-3}) {
      for (int grade = kFinestGrade; grade <= kCoarsestGrade; ++grade) {
        const auto t = pitch_grade({.module_m = module_m, .reference_diameter_m = d_m}, grade);
        ASSERT_TRUE(t);
        for (const double length_m : {t->single_pitch_m, t->cumulative_pitch_m, t->runout_m}) {
          const double value_um = 1e6 * length_m;
          const double steps = value_um > 9.99 ? 1.0 : value_um > 4.99 ? 2.0 : 10.0;
          EXPECT_NEAR(value_um * steps, std::round(value_um * steps), 1e-9) << value_um;
          seen[steps == 1.0 ? 0 : steps == 2.0 ? 1 : 2] = true;
        }
      }
    }
  }
  EXPECT_TRUE(seen[0] && seen[1] && seen[2]);
  const auto t = pitch_grade({.module_m = 1e-3, .reference_diameter_m = 100e-3}, 5);
  ASSERT_TRUE(t);
  EXPECT_NEAR(1e6 * t->single_pitch_m, 5.5, 1e-9);
}

TEST(PitchGrade, BelongsToTheRangeAnEndCloses) {
  const auto at_end = pitch_grade({.module_m = 1e-3, .reference_diameter_m = 50e-3}, 6);
  const auto below = pitch_grade({.module_m = 1e-3, .reference_diameter_m = 30e-3}, 6);
  const auto above = pitch_grade({.module_m = 1e-3, .reference_diameter_m = 50.1e-3}, 6);
  ASSERT_TRUE(at_end && below && above);
  EXPECT_EQ(at_end->cumulative_pitch_m, below->cumulative_pitch_m);
  EXPECT_LT(at_end->cumulative_pitch_m, above->cumulative_pitch_m);
}

TEST(PitchGrade, IsEmptyOutsideTheStandardsSizes) {
  EXPECT_FALSE(pitch_grade({.module_m = 0.4e-3, .reference_diameter_m = 66e-3}, 6));
  EXPECT_FALSE(pitch_grade({.module_m = 0.5e-3, .reference_diameter_m = 4.9e-3}, 6));
  EXPECT_FALSE(pitch_grade({.module_m = 71e-3, .reference_diameter_m = 1.0}, 6));
  EXPECT_FALSE(pitch_grade({.module_m = std::nan(""), .reference_diameter_m = 1.0}, 6));
  EXPECT_TRUE(pitch_grade({.module_m = 0.5e-3, .reference_diameter_m = 5e-3}, 6));
}

TEST(PitchGrade, RefusesGradesWithoutTolerances) {
  const GradedSize size{.module_m = 1e-3, .reference_diameter_m = 66e-3};
  EXPECT_THROW(static_cast<void>(pitch_grade(size, kFinestGrade - 1)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(pitch_grade(size, kCoarsestGrade + 1)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash::pitch_grade_test
