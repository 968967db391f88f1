#include "calibrate/measurement/level_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace gear3k::calibrate::level_groups_test {
namespace {

/// Rows of many sessions, both directions.
MeasurementSet sessions_of(int rows, int sessions) {
  MeasurementSet data;
  data.kind = Kind::kTransmission;
  for (int k = 0; k < sessions; ++k) data.runs.push_back("s" + std::to_string(k));
  for (int k = 0; k < rows; ++k) {
    Observation row;
    row.condition.direction =
        k % 2 == 0 ? design::Direction::kForward : design::Direction::kBackward;
    row.condition.run = k / 2 % sessions;
    data.rows.push_back(row);
  }
  return data;
}

std::ptrdiff_t groups_of_sessions(const LevelGroups& groups) {
  return std::ranges::count(groups.group, "run", &LevelGroup::along);
}

TEST(LevelGroups, AreEachSessionInTwoSensesAndEitherDirection) {
  const MeasurementSet data = sessions_of(80, 20);
  const LevelGroups groups = level_groups(data, covariate_levels(data));
  EXPECT_EQ(groups_of_sessions(groups), 20 * 4);
  ASSERT_EQ(groups.columns.cols(), static_cast<Eigen::Index>(groups.group.size()));
  for (Eigen::Index g = 0; g < groups.columns.cols(); ++g) {
    const LevelGroup& group = groups.group[static_cast<std::size_t>(g)];
    if (group.along != "run") continue;
    for (Eigen::Index i = 0; i < groups.columns.rows(); ++i) {
      const Condition& c = data.rows[static_cast<std::size_t>(i)].condition;
      const bool forward = c.direction == design::Direction::kForward;
      const bool inside =
          c.run == group.level && (group.direction == 0 || (group.direction > 0) == forward);
      EXPECT_EQ(groups.columns(i, g) != 0.0, inside);
    }
  }
  EXPECT_EQ(level_text(data, groups.group.front()).substr(0, 9), "direction");
}

TEST(LevelGroups, AreNoneOfSessionsThatWouldFillTheMemory) {
  // 4000 rows of 2000 sessions in two senses and two directions are 32 million entries.
  const MeasurementSet data = sessions_of(4000, 2000);
  const LevelGroups groups = level_groups(data, covariate_levels(data));
  EXPECT_EQ(groups_of_sessions(groups), 0);
  EXPECT_GT(groups.columns.cols(), 0);
}

}  // namespace
}  // namespace gear3k::calibrate::level_groups_test
