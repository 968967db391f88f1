#include "io/text/diagnostics.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace gear3k::io::diagnostics_test {
namespace {

Diagnostic at(int line, int column, const std::string& message) {
  return {.position = {.line = line, .column = column}, .message = message};
}

TEST(FormatDiagnostics, GivesFileLineColumnAndMessage) {
  EXPECT_EQ(format_diagnostics("gear.toml", {at(12, 7, "wrong")}), "gear.toml:12:7: wrong");
}

TEST(FormatDiagnostics, LeavesOutThePlaceOfTheFileAsAWhole) {
  EXPECT_EQ(format_diagnostics("gear.toml", {at(0, 0, "too short")}), "gear.toml: too short");
}

TEST(FormatDiagnostics, SortsByLineAsNumbersThenByColumn) {
  EXPECT_EQ(format_diagnostics("f", {at(10, 1, "d"), at(9, 20, "c"), at(9, 3, "b"), at(0, 0, "a")}),
            "f: a\nf:9:3: b\nf:9:20: c\nf:10:1: d");
}

TEST(FormatDiagnostics, KeepsTheOrderOfMessagesAtOnePlace) {
  EXPECT_EQ(format_diagnostics("f", {at(2, 1, "z"), at(2, 1, "a"), at(1, 1, "m")}),
            "f:1:1: m\nf:2:1: z\nf:2:1: a");
}

TEST(FormatDiagnostics, IsEmptyWithoutMessages) { EXPECT_EQ(format_diagnostics("f", {}), ""); }

struct Guess {
  std::string written, meant;
};

void PrintTo(const Guess& guess, std::ostream* stream) { *stream << guess.written; }

class ClosestWord : public testing::TestWithParam<Guess> {};

TEST_P(ClosestWord, IsTheOneWithinThreeEditsAndHalfTheWord) {
  static const std::vector<std::string> kKnown{"planets", "teeth", "module_mm", "face_width_mm",
                                               "khk"};
  EXPECT_EQ(closest_word(GetParam().written, kKnown), GetParam().meant);
}

INSTANTIATE_TEST_SUITE_P(Distances, ClosestWord,
                         testing::Values(Guess{"planets", "planets"},   // none
                                         Guess{"planet", "planets"},    // one left out
                                         Guess{"plannets", "planets"},  // one too many
                                         Guess{"plamets", "planets"},   // one other
                                         Guess{"plantes", "planets"},   // two swapped: two edits
                                         Guess{"module",
                                               "module_mm"},           // three, half of six letters
                                         Guess{"modul", "module_mm"},  // four, of its beginning
                                         Guess{"face_wdth", ""},       // four
                                         Guess{"tooth", "teeth"},      // two, half of five letters
                                         Guess{"toot", ""},            // three of four letters
                                         Guess{"kh", "khk"},           // one, half of two letters
                                         Guess{"k", ""},               // two of one letter
                                         Guess{"", ""}, Guess{"weight", ""}));

TEST(ClosestWord, OfTwoAtTheSameDistanceIsTheFirst) {
  EXPECT_EQ(closest_word("P3", {"P1", "P2"}), "P1");
  EXPECT_EQ(closest_word("P3", {"P2", "P1"}), "P2");
}

TEST(ClosestWord, PrefersTheNearerToTheEarlier) {
  EXPECT_EQ(closest_word("min_normals_um", {"min_normal", "min_normal_um"}), "min_normal_um");
}

TEST(ClosestWord, OfABeginningIsTheOnlyWordThatGoesOn) {
  EXPECT_EQ(closest_word("backward_eff", {"forward_efficiency", "backward_efficiency"}),
            "backward_efficiency");
  EXPECT_EQ(closest_word("torque", {"torque_capacity", "torque_density", "mass"}), "");
  EXPECT_EQ(closest_word("ba", {"backward_efficiency"}), "");
}

TEST(ClosestWord, OfAnotherUnitIsTheOnlyWordOfThatQuantity) {
  EXPECT_EQ(closest_word("no_load_speed_rpm", {"no_load_current_a", "no_load_speed_rad_s"}),
            "no_load_speed_rad_s");
  EXPECT_EQ(closest_word("output_torque_kgfcm", {"output_torque_nm", "output_torque_nmm"}), "");
  EXPECT_EQ(closest_word("face_depth", {"face_width_mm"}), "") << "half of it is another word";
}

TEST(ClosestWord, IsEmptyWithoutKnownWords) { EXPECT_EQ(closest_word("teeth", {}), ""); }

}  // namespace
}  // namespace gear3k::io::diagnostics_test
