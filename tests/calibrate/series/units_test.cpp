#include "calibrate/series/units.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "calibrate/series/series.hpp"

namespace gear3k::calibrate::units_test {
namespace {

/// Rows in turn of three files on two gearboxes of a black box.
MeasurementSet two_gearboxes(int rows) {
  MeasurementSet data;
  data.files = {"a.csv", "b.csv", "c.csv"};
  data.units = {"G2", "G1", "G2"};
  data.runs = {"first", "second", "third"};
  data.covariates = {{.name = "humidity", .value = {}}};
  for (int k = 0; k < rows; ++k) {
    Observation row;
    row.condition.sun_speed_rad_s = 10.0;
    row.condition.output_torque_Nm = 5.0 + k;
    row.condition.run = 2 - k % 3;
    row.response = 1.0 + k;
    row.file = k % 3;
    row.line = k;
    data.rows.push_back(row);
    data.covariates[0].value.push_back(k);
  }
  return data;
}

const BlackBox kBox{
    .name = "box", .ratio = 50.0, .efficiency_forward = 0.9, .efficiency_backward = 0.8};

TEST(SeriesUnits, HaveTheirRowsSessionsAndCovariates) {
  const MeasurementSet data = two_gearboxes(9);
  const Simulation simulation(kBox, Kind::kTransmission);
  EXPECT_EQ(unit_names(data), (std::vector<std::string>{"G2", "G1"}));
  EXPECT_EQ(units_of_rows(data), (std::vector<int>{0, 1, 0, 0, 1, 0, 0, 1, 0}));
  const auto units = series_units(simulation, data);
  ASSERT_EQ(units.size(), 2U);
  EXPECT_EQ(units[0].name, "G2");
  EXPECT_EQ(units[0].place, (std::vector<std::size_t>{0, 2, 3, 5, 6, 8}));
  EXPECT_EQ(units[1].place, (std::vector<std::size_t>{1, 4, 7}));
  // G1 was measured in the second session only, which is its first.
  EXPECT_EQ(units[1].data.runs, (std::vector<std::string>{"second"}));
  EXPECT_EQ(units[0].data.runs, (std::vector<std::string>{"third", "first"}));
  for (const SeriesUnit& unit : units) {
    for (std::size_t k = 0; k < unit.place.size(); ++k) {
      const Observation& row = data.rows[unit.place[k]];
      EXPECT_EQ(unit.data.rows[k].line, row.line);
      EXPECT_EQ(unit.data.runs[static_cast<std::size_t>(unit.data.rows[k].condition.run)],
                data.runs[static_cast<std::size_t>(row.condition.run)]);
      EXPECT_EQ(unit.data.covariates[0].value[k], static_cast<double>(unit.place[k]));
    }
  }
}

TEST(SeriesUnits, OfFewRowsAreNamedWithTheirFiles) {
  const auto lines = units_of_few_rows(two_gearboxes(12));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0],
            "b.csv: unit G1 has 4 rows of transmission, allowed: at least 8 of each gearbox of a "
            "series");
  EXPECT_TRUE(units_of_few_rows(two_gearboxes(24)).empty());
  EXPECT_EQ(units_of_few_rows(two_gearboxes(9)).size(), 2U);
}

}  // namespace
}  // namespace gear3k::calibrate::units_test
