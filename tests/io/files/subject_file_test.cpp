#include "io/files/subject_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "io/text/diagnostics.hpp"
#include "tests/temporary_folder.hpp"

namespace gear3k::io::subject_file_test {
namespace {

using calibrate::BlackBox;

const std::string kBox =
    "[gearbox]\nratio = 120.0\nefficiency_forward = 0.75\nefficiency_backward = 0.7\n";

std::string errors_of(const std::string& text) {
  try {
    static_cast<void>(parse_black_box(text, "box.toml"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << "expected: " << part << "\nin: " << text;
}

calibrate::Subject subject_of(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "subject.toml").string();
  test::write_text(path, text);
  return read_subject(path);
}

TEST(BlackBox, IsReadFromItsCatalogueValues) {
  const BlackBox box =
      parse_black_box("name = \"strain wave\"\n" + kBox + "backlash_arcmin = 60\n", "box.toml");
  EXPECT_EQ(box.name, "strain wave");
  EXPECT_EQ(box.ratio, 120.0);
  EXPECT_EQ(box.efficiency_forward, 0.75);
  EXPECT_EQ(box.efficiency_backward, 0.7);
  EXPECT_DOUBLE_EQ(box.backlash_rad, std::acos(-1.0) / 180.0);  // 1 degree
}

TEST(BlackBox, NeedsNeitherNameNorBacklash) {
  const BlackBox box = parse_black_box(kBox, "box.toml");
  EXPECT_EQ(box.name, "");
  EXPECT_TRUE(std::isnan(box.backlash_rad));
}

TEST(BlackBox, MissingKeysAreNamedAllAtOnce) {
  const std::string errors = errors_of("[gearbox]\n");
  for (const char* key : {"ratio", "efficiency_forward", "efficiency_backward"}) {
    expect_in(std::string("box.toml:1:2: gearbox.") + key + " is missing", errors);
  }
}

TEST(BlackBox, ValuesOutOfRangeAreRefusedWithPlaceAndRange) {
  const std::string errors = errors_of(
      "[gearbox]\nratio = 0.5\nefficiency_forward = 1.2\nefficiency_backward = 0\n"
      "backlash_arcmin = -1\n");
  expect_in("box.toml:2:1: gearbox.ratio = 0.5: allowed: a number, 1 to 1000000", errors);
  expect_in("box.toml:3:1: gearbox.efficiency_forward = 1.2: allowed: a number, above 0 to 1",
            errors);
  expect_in("box.toml:4:1: gearbox.efficiency_backward = 0: allowed", errors);
  expect_in("box.toml:5:1: gearbox.backlash_arcmin = -1: allowed: a number in arcmin, 0 to 21600",
            errors);
}

TEST(BlackBox, KeysThatNothingReadsAreRefused) {
  for (const char* key : {"input_inertia_kgm2", "stiffness_nm_per_rad", "backdriving_torque_nm",
                          "viscous_nms_per_rad"}) {
    expect_in(std::string("box.toml:5:1: unknown key gearbox.") + key,
              errors_of(kBox + key + " = 1.0\n"));
  }
  expect_in("unknown table [motor]", errors_of(kBox + "[motor]\nresistance_ohm = 0.4\n"));
  expect_in(
      "box.toml:5:1: unknown key gearbox.backlash_armin; did you mean "
      "gearbox.backlash_arcmin?",
      errors_of(kBox + "backlash_armin = 7\n"));
}

TEST(Subject, ATableGearboxMakesABlackBox) {
  const auto subject = subject_of(kBox);
  ASSERT_TRUE(std::holds_alternative<BlackBox>(subject));
  EXPECT_EQ(std::get<BlackBox>(subject).ratio, 120.0);
}

TEST(Subject, AKeyKindMakesAPair) {
  const auto subject = subject_of(
      "kind = \"external\"\nmodule_mm = 0.5\n[gear1]\nteeth = 16\n[gear2]\nteeth = 80\n");
  ASSERT_TRUE(std::holds_alternative<design::PairDesign>(subject));
  EXPECT_EQ(std::get<design::PairDesign>(subject).gear2.teeth, 80);
}

TEST(Subject, AnythingElseIsADesign) {
  const auto subject = subject_of(
      "[stage1]\nmodule_mm = 0.8\n[stage2]\nmodule_mm = 0.8467\n[gears]\n"
      "S = { teeth = 12, profile_shift = 0.476 }\nP1 = { teeth = 39, profile_shift = 0.762 }\n"
      "R1 = { teeth = 90, profile_shift = 2.0 }\nP2 = { teeth = 32, profile_shift = 0.536 }\n"
      "R2 = { teeth = 81, profile_shift = 1.21 }\n");
  ASSERT_TRUE(std::holds_alternative<design::Design>(subject));
  EXPECT_EQ(std::get<design::Design>(subject).train.teeth.R2, 81);
}

TEST(Subject, ErrorsNameTheFile) {
  try {
    static_cast<void>(subject_of("[gearbox]\nratio = 120\n"));
    FAIL() << "no exception";
  } catch (const InvalidInput& error) {
    expect_in(".toml:1:2: gearbox.efficiency_forward is missing", error.what());
  }
}

TEST(Subject, TheKeyTableListsEveryKey) {
  const std::string table = black_box_key_table();
  for (const char* key : {"`name`", "`gearbox.ratio`", "`gearbox.efficiency_forward`",
                          "`gearbox.efficiency_backward`", "`gearbox.backlash_arcmin`"}) {
    expect_in(key, table);
  }
}

}  // namespace
}  // namespace gear3k::io::subject_file_test
