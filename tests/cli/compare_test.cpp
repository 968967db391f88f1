// `gear3k compare`: labels, formats, and bad input of several files at once.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::compare_cli_test {
namespace {

using nlohmann::json;
using test::example, test::ProgramResult, test::Workplace;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Compare, PrintsDesignsByNameAndByFileWhereNamesAreAlike) {
  const Workplace place;
  place.write("a.toml", example("designs/bilateral_drive_gear.toml"));
  place.write("b.toml", example("designs/low_backlash_prototype.toml"));
  place.write("c.toml", example("designs/low_backlash_prototype.toml"));
  const ProgramResult table = place.run({"compare", "a.toml", "b.toml"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  for (const char* part : {"bilateral drive gear", "12/39/90/32/81", "14/40/94/36/92",
                           "tooth force per output torque", "change", "checks that fail"}) {
    EXPECT_TRUE(contains(table.out, part)) << part;
  }
  const ProgramResult csv = place.run({"compare", "a.toml", "b.toml", "c.toml", "--format", "csv"});
  EXPECT_EQ(csv.out.substr(0, csv.out.find('\n')), "item,quantity,unit,a.toml,b.toml,c.toml");
  const ProgramResult result =
      place.run({"compare", "a.toml", "b.toml", "--format", "json", "--out", "result.json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const json document = json::parse(place.read("result.json"));
  EXPECT_EQ(document.at("designs").at(1).at("file"), "b.toml");
  EXPECT_EQ(document.at("designs").at(1).at("ok"), false);
}

// Those of `optimize` and `actuator --select`: held_back_test.cpp, actuator_test.cpp.
TEST(Screens, FitTheirColumns) {
  const Workplace place;
  place.write("a.toml", example("designs/ratio_96_tolerances.toml"));
  place.write("b.toml", example("designs/loaded.toml"));
  place.write("p.toml", example("pairs/dry_steel_pair.toml"));
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"analyze", "a.toml"},
                                             {"analyze", "b.toml"},
                                             {"mesh", "p.toml"},
                                             {"compare", "a.toml", "b.toml"}}) {
    for (const std::size_t columns : {80U, 120U}) {
      std::vector<std::string> words = command;
      words.insert(words.end(), {"--columns", std::to_string(columns)});
      const ProgramResult run = place.run(words);
      EXPECT_EQ(run.exit_code, 0) << run.err;
      std::istringstream lines(run.out);
      std::size_t count = 0;
      for (std::string line; std::getline(lines, line); ++count) {
        EXPECT_LE(line.size(), columns) << line;
      }
      EXPECT_GT(count, 10U) << command.front();
      EXPECT_LE(count, command.front() == "analyze" ? 25U : 200U);
    }
  }
}

TEST(Compare, SaysTheErrorsOfAllFilesAtOnce) {
  const Workplace place;
  place.write("a.toml", example("designs/bilateral_drive_gear.toml"));
  place.write("bad.toml", "planets = 0\n");
  const ProgramResult result = place.run({"compare", "a.toml", "bad.toml", "missing.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.out.empty());
  EXPECT_TRUE(contains(result.err, "bad.toml:1:1: planets = 0")) << result.err;
  EXPECT_TRUE(contains(result.err, "missing.toml: cannot be read")) << result.err;
  EXPECT_EQ(place.run({"compare", "a.toml"}).exit_code, 1);
  const std::string help = place.run({"compare", "--help"}).out;
  EXPECT_TRUE(contains(help, "compare [OPTIONS] DESIGN...")) << help;
  EXPECT_TRUE(contains(help, "DESIGN 2 to 32 files")) << help;
  const ProgramResult over = place.run({"compare", "a.toml", "a.toml", "--out", "a.toml"});
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_EQ(place.read("a.toml"), example("designs/bilateral_drive_gear.toml"));
}

}  // namespace
}  // namespace gear3k::compare_cli_test
