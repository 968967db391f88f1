#include "io/files/measurement_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "io/text/diagnostics.hpp"
#include "tests/cpu_time.hpp"
#include "tests/temporary_folder.hpp"

namespace gear3k::io::measurement_file_test {
namespace {

using calibrate::Kind;
using calibrate::MeasurementSet;
using design::Direction;

constexpr double kPi = 3.14159265358979323846;

const std::string kTransmission =
    "# kind: transmission\n"
    "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm\n";  // lines 1 and 2
const std::string kLoop = "# kind: torque_angle\n# locked: sun\ntime_s,angle_deg,torque_nm\n";
const std::string kPairs = "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor\n";

Measurements measured(const std::string& text) { return parse_measurements({{"data.csv", text}}); }

MeasurementSet set_of(const std::string& text) {
  const Measurements m = measured(text);
  EXPECT_EQ(m.sets.size(), 1U);
  return m.sets.at(0);
}

std::string errors_of(const std::vector<FileText>& files) {
  try {
    static_cast<void>(parse_measurements(files));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

std::string errors_of(const std::string& text) { return errors_of({{"data.csv", text}}); }

std::string notes_of(const MeasurementSet& set) {
  return fmt::format("{}", fmt::join(set.notes, "\n"));
}

void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << "expected: " << part << "\nin: " << text;
}

std::size_t lines_in(const std::string& text) {
  return text.empty() ? 0U : 1U + static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

/// Rows of a transmission that differ in load: 10 Nm + 1 Nm each.
std::string forward_rows(int count) {
  std::string text;
  for (int k = 0; k < count; ++k) text += fmt::format("forward,200,{},0.{}\n", 10 + k, 12 + k);
  return text;
}

// Layouts and units

TEST(Measurements, TransmissionIsReadInSiUnits) {
  const auto set = set_of(
      "# kind: transmission\n"
      "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,rotation,output_angle_deg,"
      "temperature_c,time_s,run,sigma_nm\n"
      "forward,600,20,0.25,+1,-90,25,1.5,morning,0.002\n"
      "backward,60,5.5,1e-2,-1,720,-10.5,2.5,evening,0.003\n");
  EXPECT_EQ(set.kind, Kind::kTransmission);
  ASSERT_EQ(set.rows.size(), 2U);
  const auto& a = set.rows[0];
  EXPECT_EQ(a.condition.direction, Direction::kForward);
  EXPECT_DOUBLE_EQ(a.condition.sun_speed_rad_s, 20.0 * kPi);  // ten turns a second
  EXPECT_EQ(a.condition.output_torque_Nm, 20.0);
  EXPECT_EQ(a.response, 0.25);
  EXPECT_EQ(a.condition.rotation, 1);
  EXPECT_DOUBLE_EQ(a.condition.output_angle_rad, -0.5 * kPi);
  EXPECT_DOUBLE_EQ(a.condition.temperature_K, 298.15);
  EXPECT_EQ(a.condition.time_s, 1.5);
  EXPECT_EQ(a.sigma, 0.002);
  EXPECT_EQ(a.line, 3);
  EXPECT_EQ(a.file, 0);
  EXPECT_FALSE(a.condition.reference_sensor);
  const auto& b = set.rows[1];
  EXPECT_EQ(b.condition.direction, Direction::kBackward);
  EXPECT_EQ(b.condition.rotation, -1);
  EXPECT_DOUBLE_EQ(b.condition.output_angle_rad, 4.0 * kPi);
  EXPECT_DOUBLE_EQ(b.condition.temperature_K, 262.65);
  EXPECT_EQ(set.runs, (std::vector<std::string>{"morning", "evening"}));
  EXPECT_EQ(a.condition.run, 0);
  EXPECT_EQ(b.condition.run, 1);
  EXPECT_TRUE(set.notes.empty()) << notes_of(set);
}

TEST(Measurements, AbsentOptionalColumnsAreUnknownAndRotationPositive) {
  const auto set = set_of(kTransmission + "forward,200,5,0.06\n");
  const auto& c = set.rows.at(0).condition;
  EXPECT_EQ(c.rotation, 1);
  EXPECT_EQ(c.run, -1);
  for (const double x : {c.output_angle_rad, c.temperature_K, c.time_s, c.cycles}) {
    EXPECT_TRUE(std::isnan(x));
  }
  EXPECT_TRUE(std::isnan(set.rows[0].sigma));
}

TEST(Measurements, LostMotionIsReadInSiUnits) {
  const auto set = set_of(
      "# kind: lost_motion\n"
      "output_angle_deg,test_torque_nm,lost_motion_arcmin,temperature_c,cycles,sigma_arcmin\n"
      "180,2,5400,0,1000,60\n");
  EXPECT_EQ(set.kind, Kind::kLostMotion);
  const auto& o = set.rows.at(0);
  EXPECT_DOUBLE_EQ(o.condition.output_angle_rad, kPi);
  EXPECT_EQ(o.condition.test_torque_Nm, 2.0);
  EXPECT_DOUBLE_EQ(o.response, 0.5 * kPi);  // 90 degrees
  EXPECT_DOUBLE_EQ(o.condition.temperature_K, 273.15);
  EXPECT_EQ(o.condition.cycles, 1000.0);
  EXPECT_DOUBLE_EQ(o.sigma, kPi / 180.0);  // 1 degree
}

TEST(Measurements, PairLossIsReadWithItsSign) {
  const auto set = set_of(
      "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,module_mm,sigma\n"
      "16,80,0.037,0.5,0.01\n20,100,-0.004,,0.01\n");
  EXPECT_EQ(set.kind, Kind::kPairLoss);
  ASSERT_EQ(set.rows.size(), 2U);
  EXPECT_EQ(set.rows[0].condition.driving_teeth, 16);
  EXPECT_EQ(set.rows[0].condition.driven_teeth, 80);
  EXPECT_DOUBLE_EQ(set.rows[0].condition.module_m, 0.0005);
  EXPECT_EQ(set.rows[1].condition.module_m, 0.0);  // blank: not stated
  EXPECT_EQ(set.rows[1].response, -0.004);
}

TEST(Measurements, ThePublishedPairLossesAreRead) {
  const auto m = read_measurements({GEAR3K_SOURCE_DIR "/data/spur_pair_loss_dry_steel.csv"});
  ASSERT_EQ(m.sets.size(), 1U);
  EXPECT_EQ(m.sets[0].kind, Kind::kPairLoss);
  EXPECT_EQ(m.sets[0].rows.size(), 31U);  // Table 3.1: 16 pairs both ways, one was not measured
  EXPECT_TRUE(m.sets[0].notes.empty()) << notes_of(m.sets[0]);
}

TEST(Measurements, TorqueAngleKeepsItsSamplesInOrder) {
  const auto m = measured(
      "# kind: torque_angle\n# locked: output\ntime_s,angle_deg,torque_nm,run\n"
      "0,-180,0.5,a\n0.1,90,-0.25,a\n0,45,0,b\n");
  ASSERT_EQ(m.loops.size(), 1U);
  const TorqueAngleFile& loop = m.loops[0];
  EXPECT_EQ(loop.path, "data.csv");
  EXPECT_FALSE(loop.sun_locked);
  EXPECT_EQ(loop.time_s, (std::vector<double>{0.0, 0.1, 0.0}));
  ASSERT_EQ(loop.angle_rad.size(), 3U);
  EXPECT_DOUBLE_EQ(loop.angle_rad[0], -kPi);
  EXPECT_DOUBLE_EQ(loop.angle_rad[2], 0.25 * kPi);
  EXPECT_EQ(loop.torque_Nm, (std::vector<double>{0.5, -0.25, 0.0}));
  EXPECT_EQ(loop.run, (std::vector<std::string>{"a", "a", "b"}));
  ASSERT_EQ(m.sets.size(), 1U);
  EXPECT_EQ(m.sets[0].kind, Kind::kTorqueAngle);
  EXPECT_TRUE(m.sets[0].rows.empty());
  EXPECT_EQ(m.sets[0].files, std::vector<std::string>{"data.csv"});
}

TEST(Measurements, ByteOrderMarkLineEndsBlanksAndSpreadsheetCommasDoNotMatter) {
  const auto plain = set_of(kTransmission + "forward,200,5,0.06\n");
  const auto other = set_of(
      "\xEF\xBB\xBF# kind: transmission,,,\r\n\r\n"
      "direction, sun_speed_rpm ,output_torque_nm,sun_torque_nm\r\n"
      "\"forward\", 200 , +5,6e-2\r\n# a remark, \"quoted\r\n   \r\n");
  ASSERT_EQ(other.rows.size(), 1U);
  EXPECT_EQ(other.rows[0].condition.sun_speed_rad_s, plain.rows[0].condition.sun_speed_rad_s);
  EXPECT_EQ(other.rows[0].condition.output_torque_Nm, 5.0);
  EXPECT_EQ(other.rows[0].response, 0.06);
  EXPECT_EQ(other.rows[0].line, 4);
}

TEST(Measurements, OrderOfColumnsDoesNotMatter) {
  const auto set = set_of(
      "# kind: transmission\nsun_torque_nm,output_torque_nm,direction,sun_speed_rpm\n"
      "0.06,5,backward,200\n");
  EXPECT_EQ(set.rows.at(0).response, 0.06);
  EXPECT_EQ(set.rows[0].condition.direction, Direction::kBackward);
}

TEST(Measurements, NoteOfAReferenceSensorHoldsForTheFilesRows) {
  const std::string rows = "forward,200,5,0.06\n";
  const auto m = parse_measurements(
      {{"a.csv", kTransmission + rows}, {"b.csv", "# sensor: reference\n" + kTransmission + rows}});
  ASSERT_EQ(m.sets.at(0).rows.size(), 2U);
  EXPECT_FALSE(m.sets[0].rows[0].condition.reference_sensor);
  EXPECT_TRUE(m.sets[0].rows[1].condition.reference_sensor);
  expect_in("data.csv:1:1: # sensor: master: allowed: reference",
            errors_of("# sensor: master\n" + kTransmission + rows));
}

// Covariates

TEST(Measurements, FurtherNumericColumnsAreCovariates) {
  const auto set = set_of(
      "# kind: transmission\n"
      "direction,sun_speed_rpm,humidity_percent,output_torque_nm,sun_torque_nm,operator\n"
      "forward,200,40.5,5,0.06,ann\nforward,200,,6,0.07,bob\n");
  ASSERT_EQ(set.covariates.size(), 1U);
  EXPECT_EQ(set.covariates[0].name, "humidity_percent");
  ASSERT_EQ(set.covariates[0].value.size(), 2U);
  EXPECT_EQ(set.covariates[0].value[0], 40.5);
  EXPECT_TRUE(std::isnan(set.covariates[0].value[1]));
  expect_in("data.csv: column operator holds no number in line 3: ignored", notes_of(set));
}

TEST(Measurements, CovariatesKeepToTheirRowsAcrossFilesAndRowsLeftOut) {
  const std::string head = "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,";
  const auto m = parse_measurements(
      {{"a.csv", head + "sun_torque_nm,oil_mm\nforward,200,5,0.06,1\nforward,200,5,0.06,1\n"
                        "forward,200,6,,2\nforward,200,7,0.08,3\nforward,200,8,0.09,4\n"
                        "forward,200,9,0.1,5\n"},
       {"b.csv", head + "sun_torque_nm\nforward,200,5,0.06\n"},
       {"c.csv", head + "sun_torque_nm,noise_db,oil_mm\nforward,200,5,0.06,70,9\n"}});
  const MeasurementSet& set = m.sets.at(0);
  ASSERT_EQ(set.rows.size(), 6U);
  ASSERT_EQ(set.covariates.size(), 2U);
  for (const auto& covariate : set.covariates) ASSERT_EQ(covariate.value.size(), 6U);
  const auto& oil = set.covariates[0].value;
  EXPECT_EQ(oil[0], 1.0);
  EXPECT_EQ(oil[1], 3.0);
  EXPECT_EQ(oil[3], 5.0);
  EXPECT_TRUE(std::isnan(oil[4]));
  EXPECT_EQ(oil[5], 9.0);
  EXPECT_TRUE(std::isnan(set.covariates[1].value[3]));
  EXPECT_EQ(set.covariates[1].value[5], 70.0);
}

TEST(Measurements, BlankColumnsAreIgnoredAndSaidSo) {
  const auto set = set_of(
      "# kind: transmission\n"
      "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,temperature_c,sigma_nm,spare\n"
      "forward,200,5,0.06,,,\nforward,200,6,0.07,,,\n");
  EXPECT_TRUE(set.covariates.empty());
  EXPECT_TRUE(std::isnan(set.rows.at(0).condition.temperature_K));
  for (const char* name : {"temperature_c", "sigma_nm", "spare"}) {
    expect_in(fmt::format("column {} is blank throughout: ignored", name), notes_of(set));
  }
}

TEST(Measurements, SingleBlanksOfOptionalColumnsAreUnknown) {
  const auto set = set_of(
      "# kind: transmission\n"
      "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,temperature_c\n"
      "forward,200,5,0.06,\nforward,200,6,0.07,20\n");
  EXPECT_TRUE(std::isnan(set.rows.at(0).condition.temperature_K));
  EXPECT_DOUBLE_EQ(set.rows.at(1).condition.temperature_K, 293.15);
}

// Several files

TEST(Measurements, FilesOfAKindArePooledAndKindsComeInTheirOrder) {
  const auto m = parse_measurements(
      {{"p.csv", kPairs + "16,80,0.03\n"},
       {"l.csv", kLoop + "0,1,2\n1,2,3\n"},
       {"t1.csv", kTransmission + "forward,200,5,0.06\n"},
       {"m.csv",
        "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin\n0,1,7\n"},
       {"t2.csv", kTransmission + "backward,200,5,0.04\n"}});
  ASSERT_EQ(m.sets.size(), 4U);
  EXPECT_EQ(m.sets[0].kind, Kind::kTransmission);
  EXPECT_EQ(m.sets[1].kind, Kind::kLostMotion);
  EXPECT_EQ(m.sets[2].kind, Kind::kTorqueAngle);
  EXPECT_EQ(m.sets[3].kind, Kind::kPairLoss);
  EXPECT_EQ(m.sets[0].files, (std::vector<std::string>{"t1.csv", "t2.csv"}));
  ASSERT_EQ(m.sets[0].rows.size(), 2U);
  EXPECT_EQ(m.sets[0].rows[1].file, 1);
  EXPECT_EQ(m.sets[0].rows[1].line, 3);
}

const std::string kRunHead =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,run\n";

TEST(Measurements, EqualLabelsOfTwoFilesAreTwoSessions) {
  const auto m = parse_measurements({{"a.csv", kRunHead + "forward,200,5,0.06,1\n"},
                                     {"b.csv", kRunHead + "forward,200,6,0.07,1\n"}});
  EXPECT_EQ(m.sets.at(0).runs, (std::vector<std::string>{"1", "1 (b.csv)"}));
  EXPECT_EQ(m.sets[0].rows.at(1).condition.run, 1);
}

TEST(Measurements, EqualLabelsAreOneSessionWhereTheFilesStateIt) {
  const std::string shared = "# runs: shared\n" + kRunHead;
  const auto m = parse_measurements({{"a.csv", shared + "forward,200,5,0.06,1\n"},
                                     {"b.csv", shared + "forward,200,6,0.07,2\n"
                                                        "forward,200,7,0.08,1\n"}});
  EXPECT_EQ(m.sets.at(0).runs, (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(m.sets[0].rows.at(1).condition.run, 1);
  EXPECT_EQ(m.sets[0].rows.at(2).condition.run, 0);
  expect_in("data.csv:1:1: # runs: all: allowed: shared",
            errors_of("# runs: all\n" + kRunHead + "forward,200,5,0.06,1\n"));
}

TEST(Measurements, FilesWithoutRunsAreSessionsOfTheirOwn) {
  const auto m = parse_measurements({{"a.csv", kTransmission + "forward,200,5,0.06\n"},
                                     {"b.csv", kTransmission + "forward,200,6,0.07\n"}});
  EXPECT_EQ(m.sets.at(0).runs, (std::vector<std::string>{"a.csv", "b.csv"}));
  EXPECT_EQ(m.sets[0].rows.at(0).condition.run, 0);
  EXPECT_EQ(m.sets[0].rows.at(1).condition.run, 1);
}

TEST(Measurements, TheSameFileTwiceIsRefused) {
  const std::string text = kTransmission + "forward,200,5,0.06\n";
  expect_in("b.csv: holds the same bytes as a.csv: allowed: each file once",
            errors_of({{"a.csv", text}, {"b.csv", text}}));
}

TEST(Measurements, CopiesOfTimedRowsInAnotherFileAreLeftOut) {
  const std::string head =
      "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,time_s\n";
  const auto m = parse_measurements(
      {{"a.csv", head + "forward,200,5,0.06,1\nforward,200,6,0.07,2\n"},
       {"b.csv", head + "forward,200,6,0.07,2\nforward,200,7,0.07,2\nforward,200,6,0.07,3\n"}});
  EXPECT_EQ(m.sets.at(0).rows.size(), 4U);
  expect_in("b.csv: line 3: row left out, a copy of a row of an earlier file", notes_of(m.sets[0]));
}

TEST(Measurements, SigmaInOneFileOnlyIsRefused) {
  expect_in("b.csv: has no column of standard deviations (sigma) and a.csv has",
            errors_of({{"a.csv",
                        "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,"
                        "sun_torque_nm,sigma_nm\nforward,200,5,0.06,0.001\n"},
                       {"b.csv", kTransmission + "forward,200,5,0.06\n"}}));
}

TEST(Measurements, ErrorsOfAllFilesComeAtOnce) {
  const std::string errors = errors_of({{"a.csv", kTransmission + "forward,200,5,x\n"},
                                        {"b.csv", ""},
                                        {"c.csv", kTransmission + "forward,-1,5,0.06\n"}});
  expect_in("a.csv:3:15: sun_torque_nm = x", errors);
  expect_in("b.csv: is empty", errors);
  expect_in("c.csv:3:9: sun_speed_rpm = -1", errors);
  EXPECT_EQ(lines_in(errors), 3U) << errors;
}

TEST(Measurements, FingerprintIsFnv1aOfTheBytesInOrder) {
  const auto fnv = [](const std::string& bytes) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : bytes) {
      hash ^= static_cast<unsigned char>(c);
      hash *= 0x100000001b3U;
    }
    return hash;
  };
  // The published vector for "foobar".
  EXPECT_EQ(fnv("foobar"), 0x85944171f73967e8U);
  const std::string a = kTransmission + "forward,200,5,0.06\n";
  const std::string b = "\xEF\xBB\xBF" + kTransmission + "forward,200,6,0.07\n";
  const std::string p = kPairs + "16,80,0.03\n";
  const auto m = parse_measurements({{"a.csv", a}, {"p.csv", p}, {"b.csv", b}});
  EXPECT_EQ(m.sets.at(0).fingerprint, fnv(a + b));
  EXPECT_EQ(m.sets.at(1).fingerprint, fnv(p));
}

TEST(Measurements, FilesThatCannotBeReadAreNamedAllAtOnce) {
  const test::TemporaryFolder temporary;
  const std::string folder = temporary.path().string();
  try {
    static_cast<void>(read_measurements({folder + "/no_such_file.csv", folder}));
    FAIL() << "no exception";
  } catch (const InvalidInput& error) {
    expect_in("no_such_file.csv: cannot be read: No such file or directory", error.what());
    expect_in(folder + ": is a directory, allowed: a CSV file", error.what());
  }
}

TEST(Measurements, FilesAreReadAsTheirTexts) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "data.csv").string();
  test::write_text(path, kTransmission + "forward,200,5,0.06\n");
  const auto m = read_measurements({path});
  EXPECT_EQ(m.sets.at(0).rows.at(0).response, 0.06);
  EXPECT_EQ(m.sets[0].files, std::vector<std::string>{path});
}

// Long files

TEST(Measurements, HundredThousandRowsKeepEveryValue) {
  constexpr int kRows = 100000;
  std::string text =
      "# kind: transmission\n"
      "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,time_s,run,level\n";
  for (int k = 0; k < kRows; ++k) {
    text += fmt::format("{},{},{},{},{},{},{}\n", k % 2 == 0 ? "forward" : "backward", 200 + k % 7,
                        5.0 + k % 11, 0.05 + 1e-7 * k, 0.25 * k, k / 25000, -k);
  }
  const auto set = set_of(text);
  ASSERT_EQ(set.rows.size(), static_cast<std::size_t>(kRows));
  ASSERT_EQ(set.covariates.at(0).value.size(), static_cast<std::size_t>(kRows));
  EXPECT_EQ(set.runs.size(), 4U);
  for (int k = 0; k < kRows; ++k) {
    const auto& o = set.rows[static_cast<std::size_t>(k)];
    ASSERT_EQ(o.line, k + 3);
    ASSERT_EQ(o.response, std::stod(fmt::format("{}", 0.05 + 1e-7 * k)));
    ASSERT_EQ(o.condition.time_s, 0.25 * k);
    ASSERT_EQ(o.condition.run, k / 25000);
    ASSERT_EQ(set.covariates[0].value[static_cast<std::size_t>(k)], -k);
  }
  EXPECT_TRUE(set.notes.empty()) << notes_of(set);
}

// Kinds and columns that are not there

TEST(Measurements, AMissingKindIsToldFromTheColumns) {
  expect_in(
      "data.csv: the note \"# kind: ...\" is missing, allowed: transmission, lost_motion, "
      "torque_angle, pair_loss, dynamic (of an ACTUATOR); the columns are those of pair_loss",
      errors_of("driving_teeth,driven_teeth,loss_factor\n16,80,0.03\n"));
  expect_in("\"# kinds:\" was meant?", errors_of("# kinds: losses\na,b\n"));
}

TEST(Measurements, AnUnknownKindHasADidYouMean) {
  expect_in(
      "data.csv:2:1: # kind: transmision: allowed: transmission or lost_motion or "
      "torque_angle or pair_loss or dynamic; did you mean transmission?",
      errors_of("# source: x\n# kind: transmision\na,b\n1,2\n"));
}

TEST(Measurements, TwoKindsInAFileAreRefused) {
  expect_in("data.csv:2:1: # kind: pair_loss after # kind: transmission: allowed: one of them",
            errors_of("# kind: transmission\n# kind: pair_loss\na\n1\n"));
}

TEST(Measurements, LockedMustBeStatedForTorqueAngle) {
  expect_in(
      "data.csv: the note \"# locked: ...\" is missing, allowed: sun (measured at the output)",
      errors_of("# kind: torque_angle\ntime_s,angle_deg,torque_nm\n0,1,2\n"));
  expect_in("data.csv:2:1: # locked: ring: allowed: sun or output",
            errors_of("# kind: torque_angle\n# locked: ring\ntime_s,angle_deg,torque_nm\n0,1,2\n"));
  expect_in("data.csv:2:1: # locked: output: allowed: sun",
            errors_of("# kind: lost_motion\n# locked: output\n"
                      "output_angle_deg,test_torque_nm,lost_motion_arcmin\n0,1,2\n"));
}

TEST(Measurements, MissingColumnsAreNamedWithWhatIsAllowed) {
  const std::string errors =
      errors_of("# kind: transmission\ndirection,sun_speed_rpm\nforward,200\n");
  expect_in("data.csv:2:1: column output_torque_nm is missing: a finite number, at least 0",
            errors);
  expect_in("data.csv:2:1: column sun_torque_nm is missing", errors);
  EXPECT_EQ(lines_in(errors), 2U) << errors;
}

struct WrongName {
  const char *written, *expected;
  bool other_unit;
};

class ColumnNames : public testing::TestWithParam<WrongName> {};

TEST_P(ColumnNames, AreRefusedWithTheColumnThatIsMeant) {
  const WrongName& p = GetParam();
  std::string header = "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm";
  const auto at = header.find(p.expected);
  int column = static_cast<int>(header.size()) + 2;
  std::string row = "forward,200,5,0.06";
  if (at == std::string::npos) {
    header += fmt::format(",{}", p.written);
    row += ",1";
  } else {
    column = static_cast<int>(at) + 1;
    header.replace(at, std::string(p.expected).size(), p.written);
  }
  const std::string errors = errors_of("# kind: transmission\n" + header + "\n" + row + "\n");
  expect_in(fmt::format("data.csv:2:{}: column {}: {} {}", column, p.written,
                        p.other_unit ? "expected" : "did you mean", p.expected),
            errors);
  EXPECT_EQ(lines_in(errors), 1U) << errors;
}

INSTANTIATE_TEST_SUITE_P(Transmission, ColumnNames,
                         testing::Values(WrongName{"sun_torque_Nm", "sun_torque_nm", false},
                                         WrongName{"sun_tork_nm", "sun_torque_nm", false},
                                         WrongName{"Direction", "direction", false},
                                         WrongName{"sun_speed_rad_s", "sun_speed_rpm", true},
                                         WrongName{"sun_speed [rad/s]", "sun_speed_rpm", true},
                                         WrongName{"output_torque_mnm", "output_torque_nm", true},
                                         WrongName{"output_torque", "output_torque_nm", true},
                                         WrongName{"sun_torque_mNm", "sun_torque_nm", true},
                                         WrongName{"temperature_k", "temperature_c", true},
                                         WrongName{"temperature", "temperature_c", true},
                                         WrongName{"output_angle_rad", "output_angle_deg", true},
                                         WrongName{"time_ms", "time_s", true},
                                         WrongName{"sigma", "sigma_nm", true},
                                         WrongName{"sigma_arcmin", "sigma_nm", true},
                                         WrongName{"temprature_c", "temperature_c", false},
                                         WrongName{"rotaton", "rotation", false},
                                         WrongName{"runs", "run", false}));

TEST(Measurements, QuantitiesOfOtherNamesAreCovariatesAndNotRefused) {
  const auto set = set_of(
      "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,"
      "oil_temperature_c,sun_speed_rad_s,output_torque_setpoint_nm,rotation_deg\n"
      "forward,200,5,0.06,40,20.9,5,1\n");
  EXPECT_EQ(set.covariates.size(), 4U);
}

TEST(Measurements, ColumnsThatStandTwiceOrHaveNoNameAreRefused) {
  const std::string errors = errors_of(
      "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,driving_teeth,\n16,80,0.03,16,\n");
  expect_in("data.csv:2:40: column driving_teeth stands twice, first as column 1", errors);
  expect_in("data.csv:2:54: column 5 has no name", errors);
}

TEST(Measurements, OtherSeparatorsAreToldFromTheHeader) {
  expect_in("data.csv:2:1: the header is one field: allowed: fields parted by commas",
            errors_of("# kind: pair_loss\ndriving_teeth;driven_teeth;loss_factor\n16;80;0,03\n"));
}

TEST(Measurements, RowsInPlaceOfAHeaderAreToldSo) {
  expect_in(
      "data.csv:2:1: a row before the header, allowed: columns driving_teeth, driven_teeth, "
      "loss_factor, and optionally module_mm",
      errors_of("# kind: pair_loss\n16,80,0.03\n"));
}

TEST(Measurements, EmptyFilesAndFilesWithoutRowsAreRefused) {
  expect_in("data.csv: is empty", errors_of(""));
  expect_in("data.csv: is empty", errors_of(" \r\n\n"));
  expect_in("data.csv: has no header", errors_of("# kind: pair_loss\n"));
  expect_in("data.csv: has no rows of measurements", errors_of(kPairs));
  expect_in("data.csv:1:2: the control character U+0000 is no text",
            errors_of(std::string("a\0b\0", 4)));
}

TEST(Measurements, WhatIsNoPrintableUtf8IsRefusedWithItsPlace) {
  expect_in("data.csv:3:1: the byte 0xb5 is no text in UTF-8",
            errors_of("# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,run\n\xb5"));
  expect_in("data.csv:2:5: the control character U+001B is no text",
            errors_of("# kind: transmission\nrun,\x1b[2J\n"));
}

/// What reading many sessions, and many columns, takes of processors [s].
double seconds_of_many(int many) {
  std::string text = "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,run\n";
  for (int k = 0; k < many; ++k) text += fmt::format("16,80,0.03,{}\n", k);
  std::string wide = "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor";
  for (int k = 0; k < many; ++k) wide += fmt::format(",c{}", k);
  wide += '\n';
  return test::cpu_seconds_of([&] {
    const Measurements data = measured(text);
    EXPECT_EQ(data.sets.at(0).runs.size(), static_cast<std::size_t>(many));
    expect_in("data.csv: has no rows of measurements", errors_of(wide));
  });
}

TEST(Measurements, AHundredThousandSessionsAndColumnsAreReadInProportion) {
  const double tenth_s = seconds_of_many(10'000);
  // Ten times, and up to 25 with what no longer fits the caches.
  EXPECT_LT(seconds_of_many(100'000), 60.0 * tenth_s) << "a quadratic search takes a hundredfold";
}

// Bad values

struct BadValue {
  const char *header, *row, *message;
};

class BadValues : public testing::TestWithParam<BadValue> {};

TEST_P(BadValues, AreReportedWithTheirPlaceAndWhatIsAllowed) {
  const BadValue& p = GetParam();
  const std::string errors = errors_of(fmt::format("{}\n{}\n", p.header, p.row));
  expect_in(p.message, errors);
  EXPECT_EQ(lines_in(errors), 1U) << errors;
}

constexpr const char* kPlain =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm";
constexpr const char* kRotation =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,rotation";
constexpr const char* kSigma =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,sigma_nm";
constexpr const char* kWarm =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,temperature_c";
constexpr const char* kLost =
    "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin,cycles";
constexpr const char* kPair = "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,module_mm";

INSTANTIATE_TEST_SUITE_P(
    All, BadValues,
    testing::Values(
        BadValue{kPlain, "forwards,200,5,0.06",
                 "data.csv:3:1: direction = forwards: allowed: forward or backward; did you mean "
                 "forward?"},
        BadValue{kPlain, "up,200,5,0.06",
                 "data.csv:3:1: direction = up: allowed: forward or backward"},
        BadValue{kPlain, "forward,-200,5,0.06",
                 "data.csv:3:9: sun_speed_rpm = -200: allowed: a finite number, at least 0 (speeds "
                 "and torques are magnitudes; direction and rotation give the signs)"},
        BadValue{kPlain, "forward,200,-5,0.06", "data.csv:3:13: output_torque_nm = -5: allowed"},
        BadValue{kPlain, "backward,200,5,-0.06",
                 "data.csv:3:16: sun_torque_nm = -0.06: allowed: a finite number, at least 0 "
                 "(speeds and torques are magnitudes"},
        BadValue{kPlain, "forward,200,5,0.06x", "data.csv:3:15: sun_torque_nm = 0.06x: allowed"},
        BadValue{kPlain, "forward,200,5,nan",
                 "data.csv:3:15: sun_torque_nm = nan: allowed: a finite number"},
        BadValue{kPlain, "forward,inf,5,0.06", "data.csv:3:9: sun_speed_rpm = inf: allowed"},
        BadValue{kPlain, "forward,1e999,5,0.06", "data.csv:3:9: sun_speed_rpm = 1e999: allowed"},
        BadValue{kPlain, "forward,0x10,5,0.06", "data.csv:3:9: sun_speed_rpm = 0x10: allowed"},
        BadValue{kPlain, "forward,+-2,5,0.06", "data.csv:3:9: sun_speed_rpm = +-2: allowed"},
        BadValue{kPlain, "forward,200,5", "data.csv:3:1: 3 fields, allowed: 4 as in the header"},
        BadValue{kPlain, "forward,200,5,0,06",
                 "data.csv:3:1: 5 fields, allowed: 4 as in the header"},
        BadValue{kPlain, "forward,200,5,\"0.06", "data.csv:3:1: a quote is left open"},
        BadValue{kRotation, "forward,200,5,0.06,0",
                 "data.csv:3:20: rotation = 0: allowed: +1 or -1"},
        BadValue{kRotation, "forward,200,5,0.06,cw", "data.csv:3:20: rotation = cw: allowed"},
        BadValue{kSigma, "forward,200,5,0.06,0",
                 "data.csv:3:20: sigma_nm = 0: allowed: a finite number, above 0 (one standard "
                 "deviation)"},
        BadValue{kSigma, "forward,200,5,0.06,-0.001", "data.csv:3:20: sigma_nm = -0.001: allowed"},
        BadValue{kWarm, "forward,200,5,0.06,-273.16",
                 "data.csv:3:20: temperature_c = -273.16: allowed: a finite number, -273.15 to "
                 "400 (degrees Celsius)"},
        BadValue{kLost, "0,-1,7,0", "data.csv:3:3: test_torque_nm = -1: allowed"},
        BadValue{kLost, "0,1,-7,0", "data.csv:3:5: lost_motion_arcmin = -7: allowed"},
        BadValue{kLost, "0,1,7,-1",
                 "data.csv:3:7: cycles = -1: allowed: a finite number, at least "
                 "0"},
        BadValue{kPair, "2,80,0.03,1",
                 "data.csv:3:1: driving_teeth = 2: allowed: an integer, 3 to 2000"},
        BadValue{kPair, "16,80.5,0.03,1",
                 "data.csv:3:4: driven_teeth = 80.5: allowed: an integer, 3 to 2000"},
        BadValue{kPair, "16,80,3.7,1",
                 "data.csv:3:7: loss_factor = 3.7: allowed: a finite number above -1 and below 1 "
                 "(a fraction, not per cent)"},
        BadValue{kPair, "16,80,-1,1", "data.csv:3:7: loss_factor = -1: allowed"},
        BadValue{kPair, "16,80,0.03,0", "data.csv:3:12: module_mm = 0: allowed"}));

TEST(Measurements, EveryBadValueOfARowIsReported) {
  const std::string errors = errors_of(kTransmission + "forward,200,5,0.06\nfore,x,-5,inf\n");
  EXPECT_EQ(lines_in(errors), 4U) << errors;
  for (const char* place :
       {"data.csv:4:1: ", "data.csv:4:6: ", "data.csv:4:8: ", "data.csv:4:11: "}) {
    expect_in(place, errors);
  }
}

TEST(Measurements, PlacesCountNotesBlankLinesAndQuotes) {
  expect_in("data.csv:6:18: sun_torque_nm = x",
            errors_of(kTransmission + "forward,200,5,0.06\n\n# note\n\"forward\", 200,5, x\n"));
}

TEST(Measurements, MessagesOfAFileEndAtFiftyWithTheirNumber) {
  std::string text = kTransmission;
  for (int k = 0; k < 60; ++k) text += "forward,200,5,x\n";
  const std::string errors = errors_of({{"data.csv", text}, {"b.csv", ""}});
  EXPECT_EQ(lines_in(errors), 52U) << errors;
  expect_in("data.csv:52:15: ", errors);
  EXPECT_EQ(errors.find("data.csv:53:"), std::string::npos);
  expect_in("\ndata.csv: and 10 more\nb.csv: is empty", errors);
}

TEST(Measurements, RunSigmaAndRotationStandInEveryRowOrInNone) {
  for (const char* name : {"run", "sigma_nm", "rotation"}) {
    const std::string errors =
        errors_of(fmt::format("# kind: transmission\n"
                              "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,{}\n"
                              "forward,200,5,0.06,1\nforward,200,6,0.07,\nforward,200,7,0.08,1\n"
                              "forward,200,8,0.09,\n",
                              name));
    expect_in(fmt::format("data.csv:4:1: {} is blank in lines 4, 6 and stated in others: allowed: "
                          "in every row or in none",
                          name),
              errors);
  }
}

// Time

const std::string kTimed =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,time_s,run\n";

TEST(Measurements, TimeThatGoesBackWithinARunIsRefusedWithBothLines) {
  expect_in(
      "data.csv:5:1: time_s = 1 after 20 in line 4: allowed: not below the time before within "
      "a run",
      errors_of(kTimed + "forward,200,5,0.06,10,a\nforward,200,6,0.07,20,a\n"
                         "forward,200,7,0.08,1,a\nforward,200,8,0.09,11,a\n"));
}

TEST(Measurements, EachRunHasItsOwnClock) {
  const auto set = set_of(kTimed +
                          "forward,200,5,0.06,10,a\nforward,200,6,0.07,20,a\n"
                          "forward,200,7,0.08,1,b\nforward,200,8,0.09,20,a\n");
  EXPECT_EQ(set.rows.size(), 4U);
  EXPECT_TRUE(set.notes.empty()) << notes_of(set);
}

TEST(Measurements, RowsPlainlyNotInTheOrderOfTimeAreTakenAtTheirTime) {
  std::string text = kTimed;
  for (int k = 0; k < 20; ++k) {
    text += fmt::format("forward,200,{},0.{},{},a\n", 10 + k, 12 + k, (7 * k) % 20);
  }
  const auto set = set_of(text);
  EXPECT_EQ(set.rows.size(), 20U);
  EXPECT_EQ(set.rows[3].condition.time_s, 1.0);
  expect_in(
      "data.csv: rows are not in the order of time_s (1 after 14 in lines 5 and 6, the first "
      "of 6)",
      notes_of(set));
}

TEST(Measurements, TimeOfATorqueAngleRecordMustIncrease) {
  expect_in("data.csv:5:1: time_s = 0 after 0 in line 4: allowed: above the time before",
            errors_of(kLoop + "0,1,2\n0,1,3\n1,2,3\n"));
  std::string shuffled = kLoop;
  for (int k = 0; k < 20; ++k) shuffled += fmt::format("{},{},1\n", (7 * k) % 20, k);
  EXPECT_EQ(lines_in(errors_of(shuffled)), 6U);
}

// Missing values, repetitions, saturation

TEST(Measurements, RowsWithoutARequiredValueAreLeftOutAndNamed) {
  const auto set = set_of(kTransmission + forward_rows(8) + "forward,200,30,\n,200,31,0.3\n");
  EXPECT_EQ(set.rows.size(), 8U);
  expect_in(
      "data.csv: 2 rows left out, a required value is blank: lines 11 (sun_torque_nm), 12 "
      "(direction)",
      notes_of(set));
}

TEST(Measurements, TenMissingRowsAreNamedAndTheRestCounted) {
  std::string text = kTransmission + forward_rows(80);
  for (int k = 0; k < 12; ++k) text += fmt::format("forward,200,{},\n", 100 + k);
  const auto set = set_of(text);
  expect_in("data.csv: 12 rows left out", notes_of(set));
  expect_in("92 (sun_torque_nm) and 2 more", notes_of(set));
  EXPECT_EQ(notes_of(set).find("93 ("), std::string::npos);
}

TEST(Measurements, MoreThanAFifthMissingIsRefused) {
  expect_in(
      "data.csv: 3 of 11 rows lack a required value (lines 11, 12, 13): allowed: at most 20 %",
      errors_of(kTransmission + forward_rows(8) +
                "forward,200,30,\nforward,200,31,\nforward,200,32,\n"));
  EXPECT_EQ(errors_of(kTransmission + forward_rows(8) + "forward,200,30,\nforward,200,31,\n"), "");
}

/// Rows of a transmission, with one more column.
std::string transmission_with(const std::string& column, const std::string& rows) {
  return "# kind: transmission\n"
         "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm," +
         column + "\n" + rows;
}

TEST(Measurements, RepetitionsOfATimedRowAreLeftOutOnceAndNamed) {
  const auto set = set_of(
      transmission_with("time_s",
                        "forward,200,5,0.06,1\nforward,200,6,0.07,2\nforward,200.0,5,6e-2,1\n"
                        "backward,200,5,0.06,3\nforward,200,5,0.06,1.0\n"));
  ASSERT_EQ(set.rows.size(), 3U);
  EXPECT_EQ(set.rows[0].line, 3);
  EXPECT_EQ(set.rows[2].line, 6);
  expect_in("data.csv: lines 5, 7: rows left out, the same in every column as a row before",
            notes_of(set));
}

TEST(Measurements, EqualReadingsOfACoarseSensorAreRepeatsAndCounted) {
  std::string rows;
  for (int k = 0; k < 60; ++k) rows += fmt::format("forward,200,20,0.{}\n", 240 + k % 5);
  const auto set = set_of(kTransmission + rows);
  EXPECT_EQ(set.rows.size(), 60U);
  expect_in(
      "data.csv: 55 rows are the same in every column as one before, kept as repeats: no time_s or "
      "output_angle_deg tells copies from repeats",
      notes_of(set));
  // Neither does a column that stays as it is.
  std::string warm;
  for (int k = 0; k < 60; ++k) warm += fmt::format("forward,200,20,0.{},45\n", 240 + k % 5);
  EXPECT_EQ(set_of(transmission_with("humidity", warm)).rows.size(), 60U);
}

TEST(Measurements, AnAngleOrACountOfItsOwnTellsCopiesFromRepeats) {
  for (const char* column : {"output_angle_deg", "sample"}) {
    std::string rows;
    for (int k = 0; k < 40; ++k) rows += fmt::format("forward,200,20,0.24,{}\n", 3 * (k % 30));
    const auto set = set_of(transmission_with(column, rows));
    EXPECT_EQ(set.rows.size(), 30U) << column;
    expect_in("rows left out, the same in every column as a row before", notes_of(set));
  }
}

TEST(Measurements, AnglesThatAreSetAgainDoNotMakeRepeatsCopies) {
  std::string text = "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin\n";
  for (int k = 0; k < 40; ++k) text += fmt::format("{},5,{}\n", 90 * (k % 4), 8 + k / 4 % 3);
  EXPECT_EQ(set_of(text).rows.size(), 40U);
}

TEST(Measurements, RowsThatDifferInAnyColumnAreNoRepetitions) {
  EXPECT_EQ(set_of("# kind: transmission\n"
                   "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,run,remark,level\n"
                   "forward,200,5,0.06,1,first,1\nforward,200,5,0.06,1,second,1\n"
                   "forward,200,5,0.06,1.0,first,1\nforward,200,5,0.06,1,first,2\n")
                .rows.size(),
            4U);
}

TEST(Measurements, RepeatedSamplesOfATorqueAngleRecordAreLeftOut) {
  const auto m = measured(kLoop + "0,1,2\n1,2,3\n1,2,3\n2,3,4\n");
  EXPECT_EQ(m.loops.at(0).time_s, (std::vector<double>{0.0, 1.0, 2.0}));
  expect_in("data.csv: line 6: row left out", notes_of(m.sets.at(0)));
}

/// A sensor that reads to 0.001 Nm and no further than `limit`, load 5 to 50 Nm, 10 rows each.
std::string clipped(double limit) {
  std::string text = kTransmission;
  for (int k = 0; k < 100; ++k) {
    const double load = 5.0 * (1 + k / 10);
    const double torque = std::min(load / 88.0 + 0.001 * (k % 10), limit);
    text += fmt::format("forward,{},{},{:.3f}\n", 200 + k, load, torque);
  }
  return text;
}

TEST(Measurements, RowsAtTheSensorsLimitAreLeftOutAndNamed) {
  const auto set = set_of(clipped(0.45));  // 40 Nm: 0.4545 Nm
  EXPECT_EQ(set.rows.size(), 70U);
  for (const auto& o : set.rows) EXPECT_LT(o.response, 0.45);
  expect_in(
      "data.csv: lines 73, 74, 75, 76, 77, 78, 79, 80, 81, 82 and 20 more: 30 rows hold the "
      "greatest sun_torque_nm, 0.45, at loads from 40 to 50 N m: the sensor is at its limit; "
      "left out",
      notes_of(set));
}

TEST(Measurements, ASensorThatReadsNothingBelowALimitIsNamed) {
  std::string text = kTransmission;
  for (int k = 0; k < 30; ++k) {
    text += fmt::format("forward,{},{},{:.3f}\n", 200 + k, 5 + k,
                        k < 8 ? 0.0 : 0.013 * k + 0.001 * (k % 3));
  }
  const auto set = set_of(text);
  EXPECT_EQ(set.rows.size(), 22U);
  expect_in("8 rows hold the least sun_torque_nm, 0, at loads from 5 to 12 N m", notes_of(set));
}

TEST(Measurements, TheEndOfARequiredNameIsMeantWhereOneEndsSo) {
  expect_in("column speed_rpm: did you mean sun_speed_rpm?",
            errors_of("# kind: transmission\n"
                      "direction,speed_rpm,output_torque_nm,sun_torque_nm\nforward,1,1,1\n"));
  // Either torque, or a column of its own beside all that are asked for.
  const std::string either =
      errors_of("# kind: transmission\ndirection,sun_speed_rpm,torque_nm\nforward,1,1\n");
  EXPECT_EQ(either.find("did you mean"), std::string::npos) << either;
  EXPECT_EQ(set_of("# kind: transmission\n"
                   "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm,speed_rpm,angle_deg\n"
                   "forward,200,5,0.06,3,1\n")
                .covariates.size(),
            2U);
}

TEST(Measurements, LoadedRowsOfExactlyNothingAreNamed) {
  const auto with_zeros = [](int zeros, const char* load, const char* format) {
    std::string text = kTransmission + forward_rows(30);
    for (int k = 0; k < zeros; ++k) {
      text += fmt::format("backward,{},{},{}\n", 200 + k, load, format);
    }
    return notes_of(set_of(text));
  };
  expect_in("6 loaded rows hold a sun_torque_nm of exactly 0", with_zeros(6, "50", "0"));
  EXPECT_EQ(with_zeros(4, "50", "0").find("exactly 0"), std::string::npos);
  EXPECT_EQ(with_zeros(6, "0", "0").find("exactly 0"), std::string::npos) << "nothing to hold";
  EXPECT_EQ(with_zeros(6, "50", "0.0001").find("exactly 0"), std::string::npos);
}

TEST(Measurements, MoreThanHalfAtTheLimitIsRefused) {
  expect_in("that is 80 of 100 rows, allowed: at most half", errors_of(clipped(0.17)));
  expect_in("that is 100 of 100 rows", errors_of(clipped(0.01)));
}

TEST(Measurements, RepeatsOfACoarseSensorAreNoSaturation) {
  // 0.05 Nm steps: the greatest reading stands for 47 to 50 Nm, which the step may hide.
  std::string text = kTransmission;
  for (int k = 0; k < 46; ++k) {
    const double load = 5.0 + k;
    text +=
        fmt::format("forward,{},{},{:.2f}\n", 200 + k, load, 0.05 * std::round(load / 88.0 / 0.05));
  }
  EXPECT_EQ(set_of(text).rows.size(), 46U);
}

TEST(Measurements, RepeatsAtOneLoadAreNoSaturation) {
  std::string text = kTransmission + forward_rows(5);
  for (int k = 0; k < 6; ++k) text += fmt::format("forward,{},50,0.57\n", 200 + k);
  EXPECT_EQ(set_of(text).rows.size(), 11U);
}

TEST(MeasurementUnits, AreThoseOfTheFiles) {
  const auto m = parse_measurements(
      {{"a.csv", "# unit: G1\n" + kTransmission + "forward,100,5,0.1\n"},
       {"b.csv", "# unit: gearbox no. 2 ,,,\n" + kTransmission + "forward,100,5,0.1\n"},
       {"c.csv", "# unit: G1\n# unit: G1\n" + kTransmission + "forward,200,5,0.1\n"}});
  EXPECT_EQ(m.sets.at(0).units, (std::vector<std::string>{"G1", "gearbox no. 2", "G1"}));
  EXPECT_TRUE(set_of(kTransmission + "forward,100,5,0.1\n").units.empty());
}

TEST(MeasurementUnits, ThatAreBlankTwoOrMissingAreToldAllAtOnce) {
  const std::string row = "forward,100,5,0.1\n";
  const std::string errors =
      errors_of({{"a.csv", "# unit: G1\n" + kTransmission + row},
                 {"b.csv", "# unit:\n" + kTransmission + "forward,100,6,0.1\n"},
                 {"c.csv", "# unit: G1\n# unit: G2\n" + kTransmission + "forward,100,7,0.1\n"},
                 {"d.csv", kTransmission + "forward,100,8,0.1\n"}});
  EXPECT_NE(errors.find("b.csv:1:1: # unit: is blank, allowed: the name of the gearbox"),
            std::string::npos)
      << errors;
  EXPECT_NE(errors.find("c.csv:2:1: # unit: G2 after # unit: G1: allowed: one of them"),
            std::string::npos)
      << errors;
  EXPECT_NE(
      errors.find("d.csv: has no note \"# unit: ...\" and a.csv has (line 1): allowed: in all "
                  "files of a kind or in none"),
      std::string::npos)
      << errors;
}

TEST(MeasurementUnits, OfAnotherKindMayBeMissing) {
  EXPECT_EQ(errors_of({{"a.csv", "# unit: G1\n" + kTransmission + "forward,100,5,0.1\n"},
                       {"b.csv", kPairs + "20,40,0.03\n"}}),
            "");
  // Records of torque and angle become rows of lost motion.
  const std::string lost =
      "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin\n0,1,20\n";
  EXPECT_NE(errors_of({{"a.csv", "# unit: G1\n" + kLoop + "0,0,0\n1,1,1\n"}, {"b.csv", lost}})
                .find("b.csv: has no note \"# unit: ...\" and a.csv has (line 1)"),
            std::string::npos);
}

TEST(MeasurementUnits, TheSameReadingOfAnotherGearboxIsNoCopy) {
  const std::string header =
      "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,time_s\n";
  const std::string rows = "forward,100,5,0.1,3\nforward,100,6,0.2,5\n";
  const auto rows_of = [&](const std::string& second) {
    const std::string other = "forward,100,7,0.3,8\n";
    return parse_measurements({{"a.csv", "# unit: G1\n" + header + rows},
                               {"b.csv", "# unit: " + second + "\n" + header + rows + other}})
        .sets.at(0)
        .rows.size();
  };
  EXPECT_EQ(rows_of("G2"), 5U);
  EXPECT_EQ(rows_of("G1"), 3U);
}

}  // namespace
}  // namespace gear3k::io::measurement_file_test
