#include "calibrate/measurement/reading_steps.hpp"

#include <gtest/gtest.h>

#include <cstddef>

namespace gear3k::calibrate::reading_steps_test {
namespace {

TEST(ReadingSteps, AreNoneOfWhatWasSet) {
  // Two and ten loads, twenty rows of each, whose repeats agree to the last digit.
  for (const int loads : {2, 10}) {
    MeasurementSet data;
    data.kind = Kind::kTransmission;
    for (int k = 0; k < 20 * loads; ++k) {
      Observation row;
      row.condition.output_torque_Nm = 10.0 * (1 + k % loads);
      row.response = 0.28 * (1 + k % loads);
      data.rows.push_back(row);
    }
    EXPECT_FALSE(reading_steps(data)) << loads;
    // Of a sensor they are, where repeats differ by one.
    for (std::size_t k = 0; k < data.rows.size(); k += 4) data.rows[k].response += 0.28;
    EXPECT_TRUE(reading_steps(data)) << loads;
  }
}

}  // namespace
}  // namespace gear3k::calibrate::reading_steps_test
