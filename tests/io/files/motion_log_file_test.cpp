// Logs of motion: what is cut, what is turned to the output, and what is refused.
#include "io/files/motion_log_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "io/text/diagnostics.hpp"

namespace gear3k::motion_log_file_test {
namespace {

using io::InvalidInput, io::MotionLogScale, io::parse_motion_log;

const std::string kHead = "# kind: dynamic\ntime_s,speed_rad_s,motor_current_a,output_torque_nm\n";
const MotionLogScale kScale{.ratio = -10.0, .torque_constant_Nm_A = 0.05, .load_kgm2 = 0.3};

std::string rows(int from, int to, double shift = 0.0) {
  std::string text;
  for (int k = from; k < to; ++k)
    text += fmt::format("{:.3f},{},{},2\n", 0.01 * k + shift, k, k + 1);
  return text;
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(parse_motion_log("m.csv", text, kScale));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(MotionLogFile, TorquesAreTurnedToTheOutput) {
  const auto record = parse_motion_log("m.csv", kHead + rows(0, 60), kScale);
  ASSERT_EQ(record.stretches.size(), 1U);
  const auto& s = record.stretches[0];
  EXPECT_EQ(s.time_s.size(), 60U);
  EXPECT_DOUBLE_EQ(s.motor_Nm[3], -10.0 * 0.05 * 4.0);
  EXPECT_DOUBLE_EQ(s.load_Nm[3], 2.0);
  EXPECT_DOUBLE_EQ(s.load_kgm2, 0.3);
  EXPECT_TRUE(s.angle_rad.empty());
  const auto turned = parse_motion_log(
      "m.csv", "# torque: actuator\n# load_inertia_kgm2: 0\n" + kHead + rows(0, 60), kScale);
  EXPECT_DOUBLE_EQ(turned.stretches[0].load_Nm[3], -2.0);
  EXPECT_DOUBLE_EQ(turned.stretches[0].load_kgm2, 0.0);
}

TEST(MotionLogFile, GapsAndClippedRowsCutTheLog) {
  const auto gap = parse_motion_log("m.csv", kHead + rows(0, 40) + rows(40, 80, 0.5), kScale);
  ASSERT_EQ(gap.stretches.size(), 2U);
  EXPECT_EQ(gap.stretches[0].time_s.size(), 40U);
  ASSERT_EQ(gap.notes.size(), 1U);
  EXPECT_TRUE(has(gap.notes[0], "1 gap in the sampling")) << gap.notes[0];
  EXPECT_TRUE(has(gap.notes[0], "line 43")) << gap.notes[0];
  std::string flat;
  for (int k = 40; k < 50; ++k) flat += fmt::format("{:.3f},{},99,2\n", 0.01 * k, k);
  const auto clipped = parse_motion_log("m.csv", kHead + rows(0, 40) + flat + rows(50, 90), kScale);
  ASSERT_EQ(clipped.stretches.size(), 2U);
  EXPECT_EQ(clipped.stretches[0].time_s.size() + clipped.stretches[1].time_s.size(), 80U);
  EXPECT_TRUE(has(clipped.notes.at(0), "10 rows left out: motor_current_a stays at its limit"));
}

TEST(MotionLogFile, EveryErrorIsToldWithItsPlace) {
  const std::string error =
      error_of(kHead + rows(0, 50) + "0.1,1,1,1\n0.9,x,1,1\n1,1,nan,1\n1,1\n");
  EXPECT_TRUE(has(error, "m.csv:53:1: time_s = 0.1 after 0.49 in line 52")) << error;
  EXPECT_TRUE(has(error, "m.csv:54:5: speed_rad_s = \"x\": allowed: a number")) << error;
  EXPECT_TRUE(has(error, "m.csv:55:5: motor_current_a = \"nan\"")) << error;
  EXPECT_TRUE(has(error, "m.csv:56:1: 2 fields, allowed: 4")) << error;
}

TEST(MotionLogFile, ColumnsAndNotesThatAreMissingOrWrong) {
  const std::string none = error_of("# kind: dynamic\ntime_s,speed_rad,motor_torque_nm\n1,2,3\n");
  EXPECT_TRUE(has(none, "m.csv:2:1: column speed_rad_s or angle_rad is missing")) << none;
  EXPECT_TRUE(has(none, "speed_rad_s was meant?")) << none;
  // Of another kind nothing else is told.
  EXPECT_EQ(error_of("# kind: transmission\ndirection,sun_speed_rpm\n" + rows(0, 2)),
            "m.csv:1:1: # kind: transmission: allowed: dynamic (other kinds are diagnosed apart "
            "from logs of motion)");
  EXPECT_EQ(error_of("# kind: dynamic\ntime_s;speed_rad_s;motor_torque_nm\n1;2;3\n"),
            "m.csv:2:1: the header is one field: allowed: fields parted by commas");
  EXPECT_TRUE(has(error_of("# kind: dynamic\n"), "m.csv: no header: allowed: columns time_s"));
  EXPECT_TRUE(
      has(error_of("# torque: motor\n" + kHead + rows(0, 60)), "m.csv:1:1: # torque: motor"));
  EXPECT_TRUE(has(error_of("# load_inertia_kgm2: -1\n" + kHead + rows(0, 60)),
                  "m.csv:1:1: # load_inertia_kgm2: -1: allowed: a number, at least 0"));
  EXPECT_TRUE(has(error_of(kHead + rows(0, 20)), "20 rows, allowed: at least 50"));
  std::string flat = kHead + rows(0, 20);
  for (int k = 20; k < 60; ++k) flat += fmt::format("{:.3f},{},99,2\n", 0.01 * k, k);
  EXPECT_TRUE(has(error_of(flat), "motor_current_a is at its limit in 40 of 60 rows"));
}

TEST(MotionLogFile, AByteOrderMarkAndEndsOfLinesOfAnotherSystemChangeNothing) {
  std::string text;
  for (const char c : kHead + rows(0, 60)) {
    if (c == '\n') text += '\r';
    text += c;
  }
  const auto record = parse_motion_log("m.csv", "\xEF\xBB\xBF" + text, kScale);
  ASSERT_EQ(record.stretches.size(), 1U);
  EXPECT_EQ(record.stretches[0].motor_Nm,
            parse_motion_log("m.csv", kHead + rows(0, 60), kScale).stretches[0].motor_Nm);
}

TEST(MotionLogFile, ARunOfItsOwnMayBeginItsClockAnew) {
  std::string text = "# kind: dynamic\ntime_s,angle_rad,motor_torque_nm,run\n";
  for (const char* run : {"a", "b"}) {
    for (int k = 0; k < 40; ++k) text += fmt::format("{:.3f},{},{},{}\n", 0.01 * k, k, k, run);
  }
  const auto record = parse_motion_log("m.csv", text, kScale);
  EXPECT_EQ(record.stretches.size(), 2U);
  EXPECT_TRUE(record.stretches[0].speed_rad_s.empty());
  EXPECT_DOUBLE_EQ(record.stretches[1].motor_Nm[2], -20.0);
}

}  // namespace
}  // namespace gear3k::motion_log_file_test
