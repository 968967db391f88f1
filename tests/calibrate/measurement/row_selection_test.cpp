#include "calibrate/measurement/row_selection.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calibrate/measurement/left_out_rows.hpp"

namespace gear3k::calibrate::row_selection_test {
namespace {

/// Rows of sessions, numbered by their response and by a covariate.
MeasurementSet rows_of(const std::vector<int>& runs) {
  MeasurementSet set;
  set.runs = {"a", "b", "c"};
  Covariate oil{.name = "oil", .value = {}};
  for (const int run : runs) {
    Observation row;
    row.condition.run = run;
    row.response = static_cast<double>(set.rows.size());
    oil.value.push_back(row.response);
    set.rows.push_back(row);
  }
  set.covariates.push_back(oil);
  return set;
}

TEST(SelectedRows, AreThoseAtThePlacesWithTheirCovariatesAndSessions) {
  const MeasurementSet part = select_rows(rows_of({0, 1, 2, 1}), {3, 0});
  ASSERT_EQ(part.rows.size(), 2U);
  EXPECT_EQ(part.rows[0].response, 3.0);
  EXPECT_EQ(part.rows[1].response, 0.0);
  EXPECT_EQ(part.covariates[0].value, (std::vector<double>{3.0, 0.0}));
  EXPECT_EQ(part.runs.size(), 3U);
  EXPECT_EQ(part.rows[0].condition.run, 1);
}

TEST(LeftOutRows, TakeSessionsWithThemThatHaveNoOthers) {
  MeasurementSet set = rows_of({0, 1, 2, 1, -1, 2});
  leave_out(set, {0, 1, 0, 1, 0, 1});
  EXPECT_EQ(set.runs, (std::vector<std::string>{"a", "c"}));
  ASSERT_EQ(set.rows.size(), 3U);
  EXPECT_EQ(set.covariates[0].value, (std::vector<double>{0.0, 2.0, 4.0}));
  EXPECT_EQ(set.rows[0].condition.run, 0);
  EXPECT_EQ(set.rows[1].condition.run, 1);
  EXPECT_EQ(set.rows[1].response, 2.0);
  EXPECT_EQ(set.rows[2].condition.run, -1);
}

TEST(LeftOutRows, LeaveASessionThatHasOthers) {
  MeasurementSet set = rows_of({0, 1, 1, 2});
  leave_out(set, {0, 1, 0, 0});
  EXPECT_EQ(set.runs.size(), 3U);
  EXPECT_EQ(set.rows[1].condition.run, 1);
}

}  // namespace
}  // namespace gear3k::calibrate::row_selection_test
