#include "calibrate/verdict/rows_off.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrate/verdict/diagnosis.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::rows_off_test {
namespace {

constexpr double kNoise_Nm = 0.002;

class RowsOff : public Bench {
 protected:
  /// Six sessions of six rows, all at other conditions each.
  RowsOff() {
    data_ = measured_grid({});
    constexpr std::size_t kRows = 6;
    for (int run = 0; run < 6; ++run) data_.runs.push_back("s" + std::to_string(run + 1));
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      // Every session goes through all directions, rotations and loads.
      data_.rows[i * 7 % data_.rows.size()].condition.run = static_cast<int>(i / kRows);
    }
    data_.files = {"data.csv"};
  }
  template <class Change>
  void change(Change change) {
    for (Observation& row : data_.rows) row.response += change(row.condition);
  }
  [[nodiscard]] Diagnosis told() const { return diagnose(simulation_, data_, {}).value(); }
  static bool names(const Diagnosis& d, const std::string& id) {
    return std::ranges::any_of(d.effects, [&](const Effect& e) { return e.id == id; });
  }
};

TEST_F(RowsOff, OfTheLastSessionAreAStepHoweverStrong) {
  // A drag at the sun: more torque forward, less backward.
  for (const double deviations : {8.0, 60.0}) {
    measure({}, kNoise_Nm, 5);
    change([&](const Condition& c) {
      const double drag = c.direction == design::Direction::kForward ? 1.0 : -1.0;
      return c.run == 5 ? deviations * kNoise_Nm * drag : 0.0;
    });
    const Diagnosis d = told();
    EXPECT_TRUE(names(d, "run_step")) << deviations;
    EXPECT_EQ(d.verdict, Verdict::kExplained) << deviations;
  }
}

TEST_F(RowsOff, OfOneSessionAmongOthersAreAStep) {
  for (const double deviations : {10.0, 60.0}) {
    measure({}, kNoise_Nm, 3);
    change([&](const Condition& c) { return c.run == 2 ? deviations * kNoise_Nm : 0.0; });
    const Diagnosis d = told();
    EXPECT_TRUE(names(d, "run_step")) << deviations;
  }
}

TEST_F(RowsOff, OfOneSpeedInOneDirectionAreStructureThere) {
  measure({}, kNoise_Nm, 4);
  change([&](const Condition& c) {
    const bool there = c.direction == design::Direction::kBackward &&
                       std::abs(c.sun_speed_rad_s - 62.8) < 1.0 && c.output_torque_Nm < 30.0;
    return there ? 40.0 * kNoise_Nm : 0.0;
  });
  const Diagnosis d = told();
  EXPECT_NE(d.verdict, Verdict::kNoDiscrepancy);
}

TEST_F(RowsOff, OnePerSessionAreOutliers) {
  int found = 0;
  constexpr int kCampaigns = 2;
  for (int seed = 1; seed <= kCampaigns; ++seed) {
    measure({}, kNoise_Nm, static_cast<std::uint64_t>(seed));
    // Rows 5, 18 and 29 lie in three sessions.
    for (const std::size_t i : {5U, 18U, 29U}) {
      data_.rows[i].response += (i % 2 == 0 ? 15.0 : -15.0) * kNoise_Nm;
    }
    if (told().verdict != Verdict::kNoDiscrepancy) ++found;
  }
  EXPECT_EQ(found, 0);
}

TEST_F(RowsOff, ASessionOfOneRowIsNoStep) {
  measure({}, kNoise_Nm, 6);
  data_.runs.push_back("alone");
  data_.rows.back().condition.run = 6;
  data_.rows.back().response += 30.0 * kNoise_Nm;
  const Diagnosis d = told();
  EXPECT_FALSE(names(d, "run_step"));
  EXPECT_TRUE(d.rows.back().outlier);
}

TEST_F(RowsOff, ALevelIsNamedWhereNothingElseTellsOfIt) {
  measure({}, kNoise_Nm, 8);
  change([](const Condition& c) { return c.run == 4 ? 20.0 * kNoise_Nm : 0.0; });
  const Problem p = problem();
  const Columns columns = columns_at(p, {}, {}, kNoise_Nm);
  RemainderSearch search;
  const auto text = take_level_off(p, columns, covariate_levels(data_), 0.005, search);
  ASSERT_TRUE(text.has_value());
  EXPECT_NE(text->find("6 of the 6 rows of session s5"), std::string::npos) << *text;
  EXPECT_EQ(search.best.along, "run");
  EXPECT_LT(search.p_value, 0.005);
  // What was found already stays.
  search.p_value = 0.001;
  EXPECT_FALSE(take_level_off(p, columns, covariate_levels(data_), 0.005, search).has_value());
}

TEST(Outliers, OfMoreThanAThirdOfTheRowsAreNone) {
  EXPECT_GT(chance_of_outliers(6, 60), 0.5);
  EXPECT_LT(chance_of_outliers(21, 60), 1e-3);
  EXPECT_DOUBLE_EQ(chance_of_outliers(0, 60), 1.0);
  // Two of two: 0.15².
  EXPECT_NEAR(chance_of_outliers(2, 2), 0.0225, 1e-12);
}

}  // namespace
}  // namespace gear3k::calibrate::rows_off_test
