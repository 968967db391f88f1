// `gear3k new` and `gear3k keys WORD`: what one begins a file with.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::first_file_cli_test {

namespace {

using test::lines_of;
using test::ProgramResult;
using test::Workplace;

bool is_choice(const std::string& line) {
  return line.size() > 1 && line[0] == '#' && line[1] != ' ';
}

std::string with_all_choices(const std::string& text) {
  std::string all;
  for (const std::string& line : lines_of(text)) {
    all += (is_choice(line) ? line.substr(1) : line) + "\n";
  }
  return all;
}

class FirstFile : public testing::TestWithParam<bool> {
 protected:
  /// The file of a kind, as printed or with all of its choices taken, in the workplace.
  std::string written(const std::string& kind) const {
    const ProgramResult printed = place.run({"new", kind});
    EXPECT_EQ(printed.exit_code, 0) << printed.err;
    EXPECT_EQ(printed.err, "");
    place.write(kind + ".toml", GetParam() ? with_all_choices(printed.out) : printed.out);
    return kind + ".toml";
  }
  Workplace place;
};

TEST_P(FirstFile, OfATaskGivesADesignThatKeepsEveryCheck) {
  const ProgramResult result = place.run({"optimize", written("task"), "--out", "out", "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(place.run({"analyze", "out/best.toml", "--strict"}).exit_code, 0);
  EXPECT_EQ(result.out.find("asked for") != std::string::npos, GetParam());
}

TEST_P(FirstFile, OfADesignKeepsEveryCheckAndCanBeBuilt) {
  const std::string file = written("design");
  const ProgramResult result = place.run({"analyze", file, "--strict"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_EQ(result.out.find("asked for") != std::string::npos, GetParam());
  if (!GetParam()) return;
  const ProgramResult built = place.run({"tolerances", file, "--samples", "1000", "--quiet"});
  EXPECT_EQ(built.exit_code, 0) << built.err;
  EXPECT_NE(built.out.find("it always assembles"), std::string::npos) << built.out;
}

TEST_P(FirstFile, OfAPairKeepsEveryCheck) {
  const ProgramResult result = place.run({"mesh", written("pair"), "--strict"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_EQ(result.out.find("asked for") != std::string::npos, GetParam());
}

TEST_P(FirstFile, OfAnActuatorRuns) {
  const ProgramResult result = place.run({"actuator", written("actuator")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.find("10000") != std::string::npos, GetParam()) << "the stiffness";
}

TEST_P(FirstFile, OfAScenarioMovesTheFirstActuator) {
  const std::string actuator = written("actuator");
  const ProgramResult result = place.run({"simulate", actuator, written("scenario"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("backward"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Choices, FirstFile, testing::Bool(),
                         [](const auto& p) { return p.param ? "AllTaken" : "AsPrinted"; });

TEST(NewFile, WrittenToAFileIsWhatIsPrintedAndReplacesNone) {
  const Workplace place;
  EXPECT_EQ(place.run({"new", "task", "--out", "task.toml"}).exit_code, 0);
  const std::string text = place.read("task.toml");
  EXPECT_EQ(text, place.run({"new", "task"}).out);
  const ProgramResult again = place.run({"new", "design", "--out", "task.toml"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("task.toml: is there already"), std::string::npos) << again.err;
  EXPECT_EQ(place.read("task.toml"), text);
}

bool holds(const std::string& line, const std::string& word) {
  return line.find(word) != std::string::npos;
}

TEST(KeysOfAWord, AreTheRowsOfAllKeysThatHoldItUnderTheirHeadings) {
  const Workplace place;
  const std::vector<std::string> all = lines_of(place.run({"keys"}).out);
  for (const std::string word : {"sigma_f_lim", "backlash.m", "tooth thickness", "gearbox."}) {
    std::vector<std::string> expected;
    std::string heading;
    for (const std::string& line : all) {
      if (line.starts_with("## ")) heading = line;
      if (!line.starts_with("| `") || !holds(line, word)) continue;
      if (!heading.empty()) expected.push_back(heading);
      heading.clear();
      expected.push_back(line);
    }
    const ProgramResult result = place.run({"keys", word});
    std::vector<std::string> printed;
    for (const std::string& line : lines_of(result.out)) {
      if (line.starts_with("## ") || line.starts_with("| `")) printed.push_back(line);
    }
    EXPECT_EQ(result.exit_code, expected.empty() ? 1 : 0) << word;
    EXPECT_EQ(printed, expected) << word;
  }
  EXPECT_EQ(place.run({"keys", "SIGMA_F_lim"}).out, place.run({"keys", "sigma_f_lim"}).out);
}

TEST(KeysOfAWord, ThatNoneHoldsNameTheNearest) {
  const Workplace place;
  const ProgramResult result = place.run({"keys", "modul_mn"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("did you mean module_mm?"), std::string::npos) << result.err;
}

}  // namespace

}  // namespace gear3k::first_file_cli_test
