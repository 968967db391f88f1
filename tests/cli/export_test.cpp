// `gear3k export`: files, what is printed, exit codes.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::export_test {
namespace {

using nlohmann::json;
using test::example, test::ProgramResult, test::read_text, test::replaced, test::Workplace,
    test::write_text;

const std::vector<std::string> kDrawings{"S", "P1", "R1", "P2", "R2", "train", "assembly"};

std::string bilateral() { return example("designs/bilateral_drive_gear.toml"); }
std::string prototype() { return example("designs/low_backlash_prototype.toml"); }

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Export, WritesEveryGearAndTheTrainInBothFormats) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  const ProgramResult result =
      place.run({"export", "gear.toml", "--dxf", "a/dxf", "--svg", "svg", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::vector<std::string> expected{"a", "a/dxf", "gear.toml", "svg"};
  std::vector<std::string> paths;
  for (const std::string& name : kDrawings) paths.push_back("a/dxf/" + name + ".dxf");
  for (const std::string& name : kDrawings) paths.push_back("svg/" + name + ".svg");
  expected.insert(expected.end(), paths.begin(), paths.end());
  std::ranges::sort(expected);
  EXPECT_EQ(place.listing(), expected);

  const json list = json::parse(result.out);
  EXPECT_EQ(list.at("name"), "bilateral drive gear");
  EXPECT_EQ(list.at("chord_error_um"), 1.0);
  EXPECT_TRUE(list.at("notes").is_array());
  EXPECT_TRUE(list.at("tool").contains("version"));
  ASSERT_EQ(list.at("files").size(), paths.size());
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const json& file = list.at("files")[k];
    EXPECT_EQ(file.at("path"), paths[k]);
    EXPECT_EQ(file.at("drawing"), kDrawings[k % 7]);
    EXPECT_EQ(file.at("format"), k < 7 ? "dxf" : "svg");
    EXPECT_EQ(file.at("contours"), k % 7 == 5 ? 9 : k % 7 == 6 ? 5 : 1);
    EXPECT_GE(file.at("points"), k % 7 == 6 ? 20 : 12 * 10);
  }
}

/// As `optimize` holds the folder of its results.
TEST(Export, WritesIntoNoFolderThatAnotherRunIsWriting) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  std::filesystem::create_directory(place.file("svg"));
  const int folder = ::open(place.file("svg").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(folder, LOCK_EX | LOCK_NB), 0);
  const std::vector<std::string> arguments{"export", "gear.toml", "--dxf",  "dxf",
                                           "--svg",  "./svg",     "--quiet"};
  const ProgramResult refused = place.run(arguments);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(contains(refused.err, "--svg ./svg: another run is writing it; allowed: another "))
      << refused.err;
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"gear.toml", "svg"})) << "none or all";
  ::close(folder);
  EXPECT_EQ(place.run(arguments).exit_code, 0);
  // Two options may name one folder, by two names.
  const ProgramResult one = place.run(
      {"export", "gear.toml", "--dxf", "one", "--svg", "svg/../one", "--sheet", "one", "--quiet"});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_TRUE(place.has("one/S.dxf") && place.has("one/S.svg") && place.has("one/S.csv"));
}

TEST(Export, WritesTheOneFormatThatWasAskedFor) {
  for (const std::string format : {"dxf", "svg"}) {
    const Workplace place;
    place.write("gear.toml", bilateral());
    const ProgramResult result =
        place.run({"export", "gear.toml", "--" + format, "out", "--format", "csv"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(place.listing().size(), 9U);
    const io::CsvTable table = io::parse_csv(result.out, "stdout");
    ASSERT_EQ(table.rows.size(), 7U);
    EXPECT_EQ(table.rows[5].fields[0], "out/train." + format);
    EXPECT_EQ(table.rows[6].fields[0], "out/assembly." + format);
  }
}

TEST(Export, WritesSheetsOfADesignAndOfAPair) {
  const Workplace place;
  place.write("gear.toml", example("designs/ratio_96_tolerances.toml"));
  const ProgramResult design = place.run({"export", "gear.toml", "--sheet", "sheets"});
  EXPECT_EQ(design.exit_code, 0) << design.err;
  for (const char* name : {"S", "P1", "R1", "P2", "R2", "planet"}) {
    const std::string path = "sheets/" + std::string(name);
    EXPECT_TRUE(place.has(path + ".csv")) << path;
    EXPECT_TRUE(place.has(path + ".html")) << path;
    EXPECT_TRUE(contains(design.out, path + ".csv")) << design.out;
  }
  EXPECT_TRUE(contains(place.read("sheets/planet.csv"), "marked tooth of P2"));

  place.write("pair.toml", example("pairs/wind_turbine_sun_planet.toml"));
  const ProgramResult pair = place.run({"export", "pair.toml", "--sheet", "pair"});
  EXPECT_EQ(pair.exit_code, 0) << pair.err;
  EXPECT_TRUE(contains(place.read("pair/gear2.csv"), "W_3"));
  const ProgramResult drawn = place.run({"export", "pair.toml", "--sheet", "no", "--svg", "no"});
  EXPECT_EQ(drawn.exit_code, 2);
  EXPECT_TRUE(contains(drawn.err, "pair.toml: a PAIR has no drawings")) << drawn.err;
  EXPECT_FALSE(place.has("no"));
}

TEST(Export, TableNamesEveryFile) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  const ProgramResult result = place.run({"export", "gear.toml", "--svg", "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const std::string& name : kDrawings) {
    EXPECT_TRUE(contains(result.out, "out/" + name + ".svg")) << result.out;
  }
}

TEST(Export, SameInputGivesTheSameBytesAndReplacesWhatWasThere) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  EXPECT_EQ(place.run({"export", "gear.toml", "--dxf", "1", "--svg", "1"}).exit_code, 0);
  std::filesystem::create_directory(place.file("2"));
  place.write("2/S.dxf", "old");
  place.write("2/mine.txt", "kept");
  const std::vector<std::string> again{"export", "gear.toml", "--dxf",     "2",
                                       "--svg",  "2",         "--threads", "2"};
  EXPECT_EQ(place.run(again).exit_code, 0);
  for (const std::string& name : kDrawings) {
    for (const char* format : {".dxf", ".svg"}) {
      EXPECT_EQ(place.read("1/" + name + format), place.read("2/" + name + format)) << name;
    }
  }
  EXPECT_EQ(place.read("2/mine.txt"), "kept");
}

TEST(Export, ASmallerChordErrorTakesMorePoints) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  const auto points = [&](const std::string& um) {
    const ProgramResult result = place.run(
        {"export", "gear.toml", "--svg", "out", "--chord-error-um", um, "--format", "json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out).at("files").at(5).at("points").get<int>();
  };
  // The sagitta of a chord goes with its square.
  EXPECT_GT(points("0.01"), 5 * points("1"));
  EXPECT_GT(points("1"), points("100"));
}

TEST(Export, DrawsADesignThatFailsChecksAndNamesThem) {
  const Workplace place;
  place.write("gear.toml", prototype());
  const ProgramResult result =
      place.run({"export", "gear.toml", "--svg", "out", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "checks failed")) << result.err;
  EXPECT_TRUE(contains(result.err, "normal backlash (S-P1)")) << result.err;
  EXPECT_TRUE(contains(result.err, "not one part")) << result.err;
  EXPECT_TRUE(contains(result.err, "zero-backlash distance of mesh P1-R1, 16.1813 mm"))
      << result.err;
  EXPECT_TRUE(contains(json::parse(result.out).at("notes").dump(), "normal backlash (S-P1)"));
  EXPECT_TRUE(place.has("out/train.svg"));
}

TEST(Export, DrawsOnePlanetWhereTheyCannotBeEquallySpaced) {
  const Workplace place;
  place.write("gear.toml", replaced(bilateral(), "planets = 3", "planets = 4"));
  const ProgramResult result =
      place.run({"export", "gear.toml", "--dxf", "out", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err,
                       "4 planets cannot be equally spaced (zS + zR1 = 102 is not "
                       "divisible by 4): the train is drawn with planet 1 alone"))
      << result.err;
  EXPECT_EQ(json::parse(result.out).at("files").at(5).at("contours"), 5);
}

TEST(Export, QuietKeepsTheNotesOffStderr) {
  const Workplace place;
  place.write("gear.toml", prototype());
  const ProgramResult result = place.run({"export", "gear.toml", "--svg", "out", "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_FALSE(result.out.empty());
}

TEST(Export, HelpSaysWhatIsDrawnWithUnitsAndRanges) {
  const Workplace place;
  const ProgramResult result = place.run({"export", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part : {"--dxf", "--svg", "--chord-error-um", "0.01 to 100 um", "planet 1 alone",
                           "Keys of DESIGN.toml"}) {
    EXPECT_TRUE(contains(result.out, part)) << part;
  }
}

// --- refusals: exit code, message, nothing left behind

struct Refusal {
  std::string name;
  std::vector<std::string> arguments;  ///< after `export`
  int exit_code;
  std::vector<std::string> messages;
};

void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.name; }

class ExportRefuses : public testing::TestWithParam<Refusal> {};

TEST_P(ExportRefuses, WithItsCodeAndMessageAndLeavesNothing) {
  const Refusal& refusal = GetParam();
  const Workplace place;
  place.write("gear.toml", bilateral());
  place.write("bad.toml", replaced(replaced(bilateral(), "planets = 3", "planets = 0"),
                                   "teeth = 12", "teth = 12"));
  place.write("undefined.toml", "center_distance_mm = 1.0\n" + bilateral());
  place.write("file", "a file");
  std::filesystem::create_directories(place.file("blocked/R2.svg"));
  place.write("blocked/S.svg", "old");
  std::filesystem::create_directory(place.file("own"));
  place.write("own/P1.dxf", bilateral());
  const std::vector<std::string> before = place.listing();

  std::vector<std::string> arguments{"export"};
  arguments.insert(arguments.end(), refusal.arguments.begin(), refusal.arguments.end());
  const ProgramResult result = place.run(arguments);
  EXPECT_EQ(result.exit_code, refusal.exit_code) << result.err;
  EXPECT_EQ(result.out, "");
  for (const std::string& message : refusal.messages) {
    EXPECT_TRUE(contains(result.err, message)) << message << "\nin\n" << result.err;
  }
  EXPECT_EQ(place.listing(), before);
  EXPECT_EQ(place.read("blocked/S.svg"), "old");
  EXPECT_EQ(place.read("own/P1.dxf"), bilateral());
}

std::vector<Refusal> refusals() {
  const std::string range = "allowed: 0.01 to 100 um";
  return {
      {"NoFormat", {"gear.toml"}, 1, {"--dxf DIR, --svg DIR, --sheet DIR: none is given"}},
      {"NoDesign", {"--dxf", "out"}, 1, {"DESIGN"}},
      {"NoFormatAndNoChord",
       {"gear.toml", "--chord-error-um", "0"},
       1,
       {"none is given", "--chord-error-um = 0 um", range}},
      {"ChordTooSmall", {"gear.toml", "--svg", "out", "--chord-error-um", "0.009"}, 1, {range}},
      {"ChordTooLarge", {"gear.toml", "--svg", "out", "--chord-error-um", "101"}, 1, {range}},
      {"ChordNegative", {"gear.toml", "--svg", "out", "--chord-error-um=-1"}, 1, {range}},
      {"ChordNan", {"gear.toml", "--svg", "out", "--chord-error-um", "nan"}, 1, {range}},
      {"ChordNoNumber",
       {"gear.toml", "--svg", "out", "--chord-error-um", "1um"},
       1,
       {"--chord-error-um"}},
      {"EmptyFolder", {"gear.toml", "--svg", ""}, 1, {"--svg"}},
      {"UnknownOption", {"gear.toml", "--dfx", "out"}, 1, {"did you mean --dxf?"}},
      {"MissingDesign", {"none.toml", "--dxf", "out"}, 2, {"none.toml"}},
      {"BadDesign",
       {"bad.toml", "--dxf", "out"},
       2,
       {"planets = 0", "did you mean gears.S.teeth?"}},
      {"UndefinedDesign",
       {"undefined.toml", "--dxf", "out"},
       2,
       {"undefined.toml:1:1: mesh S-P1: center distance = 1 mm"}},
      {"FileInTheWay", {"gear.toml", "--dxf", "new/a", "--svg", "file"}, 2, {"file: cannot be"}},
      {"FilesInTheWayOfBoth",
       {"gear.toml", "--dxf", "file/x", "--svg", "file"},
       2,
       {"file/x: cannot be", "file: cannot be"}},
      {"FolderNamedAsAFile",
       {"gear.toml", "--dxf", "new/a", "--svg", "blocked"},
       2,
       {"blocked/R2.svg: cannot be written: a folder has this name"}},
      {"OverItsOwnInput", {"own/P1.dxf", "--dxf", "own"}, 2, {"own/P1.dxf is an input file"}},
      {"NoPlaceForFolders", {"gear.toml", "--dxf", "/proc/gear3k"}, 2, {"/proc/gear3k"}}};
}

INSTANTIATE_TEST_SUITE_P(Table, ExportRefuses, testing::ValuesIn(refusals()),
                         [](const auto& test) { return test.param.name; });

TEST(Export, StdoutThatCannotBeWrittenIsAnError) {
  const Workplace place;
  place.write("gear.toml", bilateral());
  const ProgramResult result = place.run({"export", "gear.toml", "--svg", "out"}, "/dev/full");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "stdout: cannot be written")) << result.err;
}

TEST(Export, NamesItsOwnArgumentWhereTheFileIsAnotherOne) {
  const Workplace place;
  place.write("spec.toml", test::example("rp96.toml"));
  const ProgramResult run = place.run({"export", "spec.toml", "--svg", "svg"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err,
            "spec.toml: looks like a SPEC: it has [ratio]; export takes a DESIGN, or a PAIR for "
            "--sheet\n");
}

}  // namespace
}  // namespace gear3k::export_test
