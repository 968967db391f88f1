#include "calibrate/verdict/wild_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calibrate/verdict/diagnosis.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::wild_rows_test {
namespace {

constexpr double kNoise_Nm = 0.002;

class WildRows : public Bench {
 protected:
  WildRows() {
    data_ = measured_grid({.repeats = 2});
    data_.files = {"data.csv"};
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].line = static_cast<int>(i) + 2;
    }
    measure({}, kNoise_Nm, 11);
  }
  /// Places that are taken for typing errors.
  [[nodiscard]] std::vector<std::size_t> places() const {
    const auto wild = wild_rows(data_, clean_, covariate_levels(data_));
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < wild.size(); ++i) {
      if (wild[i] != 0) result.push_back(i);
    }
    return result;
  }
  Observation& row(std::size_t place) { return data_.rows[place]; }
};

TEST_F(WildRows, AreReadingsWithASlippedPoint) {
  EXPECT_TRUE(places().empty());
  row(8).response *= 10.0;
  row(30).response *= 0.1;
  row(55).response *= 10.0;
  EXPECT_EQ(places(), (std::vector<std::size_t>{8, 30, 55}));
}

TEST_F(WildRows, AreNoneThatAnOutlierMayBe) {
  // Fifty deviations, and yet a fifth of the reading.
  row(11).response *= 1.2;
  EXPECT_TRUE(places().empty());
}

TEST_F(WildRows, AreNoneOfOneSessionOrOfManyRows) {
  data_.runs = {"a", "b", "c", "d", "e", "f"};
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    row(i).condition.run = static_cast<int>(i / 12);
    if (row(i).condition.run == 4) row(i).response *= 3.0;
  }
  EXPECT_TRUE(places().empty());
  measure({}, kNoise_Nm, 11);
  for (std::size_t i = 0; i < data_.rows.size(); i += 5) row(i).response *= i % 2 == 0 ? 3.0 : 0.2;
  EXPECT_TRUE(places().empty());
}

TEST_F(WildRows, AreNoneOfOnePartOfTheTurn) {
  // Rows 20 degrees apart; the teeth of a window of the turn are worn.
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    row(i).condition.output_angle_rad = static_cast<double>(i) * 0.35;
  }
  std::size_t worn = 0;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const double turn = std::fmod(row(i).condition.output_angle_rad, 2.0 * std::numbers::pi);
    if (turn < 4.2 || turn > 4.7) continue;
    row(i).response *= 3.0;
    ++worn;
  }
  ASSERT_GE(worn, 3U);
  EXPECT_TRUE(places().empty());
}

TEST_F(WildRows, OfFewRowsAreNotTold) {
  data_.rows.resize(7);
  measure({}, kNoise_Nm, 11);
  row(3).response *= 10.0;
  EXPECT_TRUE(places().empty());
}

TEST_F(WildRows, HideNoCauseAndAreNamedByTheirLines) {
  for (Observation& o : data_.rows) {
    o.response += o.condition.direction == design::Direction::kForward ? 0.012 : -0.012;
  }
  row(8).response *= 10.0;
  row(31).response *= 10.0;
  const Diagnosis d = diagnose(simulation_, data_, {}).value();
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects[0].id, "drag_constant");
  EXPECT_NEAR(d.effects[0].parameters[0].value, 0.012, 0.002);
  EXPECT_TRUE(std::ranges::any_of(d.notes, [](const std::string& note) {
    return note.starts_with("data.csv: lines 10, 33: far from all other rows");
  }));
  ASSERT_EQ(d.rows.size(), data_.rows.size());
  EXPECT_TRUE(d.rows[8].outlier);
  EXPECT_TRUE(std::isnan(d.rows[8].extended));
  EXPECT_NEAR(d.rows[8].baseline, clean_[8], 1e-9);
  EXPECT_FALSE(std::isnan(d.rows[9].extended));
}

}  // namespace
}  // namespace gear3k::calibrate::wild_rows_test
