#include "io/files/measurement_loops.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "io/text/diagnostics.hpp"
#include "io/text/fnv_hash.hpp"

namespace gear3k::io::measurement_loops_test {
namespace {

using calibrate::Kind;

/// A spring behind Coulomb friction, three loops of torque in triangles about a mean.
std::string wind_up(double mean_Nm = 0.0) {
  std::string text = "# kind: torque_angle\n# locked: sun\ntime_s,angle_deg,torque_nm\n";
  double inside = mean_Nm;
  for (int k = 0; k <= 1300; ++k) {
    const double phase = k / 400.0 + 0.25;
    const double torque = mean_Nm + 5.0 * (1.0 - 4.0 * std::abs(phase - std::floor(phase) - 0.5));
    inside = std::clamp(inside, torque - 0.5, torque + 0.5);
    text += fmt::format("{},{:.9f},{:.9f}\n", 0.1 * k, 0.1 * inside, torque);
  }
  return text;
}

const FileText kLostMotion{.path = "lost.csv",
                           .text =
                               "# kind: lost_motion\noutput_angle_deg,test_torque_nm,"
                               "lost_motion_arcmin\n0,1,20\n90,1,21\n180,1,20.5\n"};

TEST(MeasurementLoops, JoinTheRowsOfLostMotion) {
  Measurements data = parse_measurements({kLostMotion, {.path = "loops.csv", .text = wind_up()}});
  ASSERT_EQ(data.sets.size(), 2U);
  const auto fingerprint = hashed_bytes(data.sets[0].fingerprint, data.sets[1].fingerprint);
  read_loops(data, 96.0);
  ASSERT_EQ(data.sets.size(), 1U);
  const calibrate::MeasurementSet& set = data.sets.front();
  EXPECT_EQ(set.kind, Kind::kLostMotion);
  EXPECT_EQ(set.files, (std::vector<std::string>{"lost.csv", "loops.csv"}));
  EXPECT_GT(set.rows.size(), 3U);
  EXPECT_EQ(set.rows.back().file, 1);
  ASSERT_EQ(set.loops.size(), 1U);
  EXPECT_EQ(set.loops.front().file, 1);
  EXPECT_EQ(set.fingerprint, fingerprint);
  EXPECT_TRUE(data.loops.empty());
}

TEST(MeasurementLoops, KeepTheUnitsOfTheirFiles) {
  Measurements data =
      parse_measurements({{.path = "lost.csv", .text = "# unit: G1\n" + kLostMotion.text},
                          {.path = "loops.csv", .text = "# unit: G2\n" + wind_up()}});
  read_loops(data, 96.0);
  EXPECT_EQ(data.sets.front().units, (std::vector<std::string>{"G1", "G2"}));
}

TEST(MeasurementLoops, ByThemselvesStayASetOfTheirKind) {
  Measurements data = parse_measurements({{.path = "loops.csv", .text = wind_up()}});
  read_loops(data, 96.0);
  ASSERT_EQ(data.sets.size(), 1U);
  EXPECT_EQ(data.sets.front().kind, Kind::kTorqueAngle);
  EXPECT_FALSE(data.sets.front().rows.empty());
}

TEST(MeasurementLoops, WithoutRecordsNothingHappens) {
  Measurements data = parse_measurements({kLostMotion});
  read_loops(data, 96.0);
  ASSERT_EQ(data.sets.size(), 1U);
  EXPECT_EQ(data.sets.front().rows.size(), 3U);
  EXPECT_TRUE(data.sets.front().loops.empty());
}

TEST(MeasurementLoops, ARecordThatNeverPassesZeroIsRefusedWithItsReason) {
  Measurements data = parse_measurements({{.path = "loops.csv", .text = wind_up(20.0)}});
  try {
    read_loops(data, 96.0);
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("loops.csv: no loop could be measured"), 0U) << text;
    EXPECT_NE(text.find("does not reach zero torque"), std::string::npos) << text;
    EXPECT_NE(text.find("\nto measure: lead the torque through zero to both sides"),
              std::string::npos)
        << text;
  }
}

}  // namespace
}  // namespace gear3k::io::measurement_loops_test
