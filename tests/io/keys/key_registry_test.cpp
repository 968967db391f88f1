#include "io/keys/key_registry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/files/actuator_file.hpp"
#include "io/files/design_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/files/specification_file.hpp"
#include "io/keys/limit_keys.hpp"
#include "io/text/toml_value.hpp"
#include "tests/cpu_time.hpp"

namespace gear3k::io::key_registry_test {
namespace {

// --- one record at a time

struct TypeCase {
  std::string name;
  KeyRecord record;
  std::string allowed;
  std::vector<std::string> good, bad;  ///< TOML values
};

void PrintTo(const TypeCase& c, std::ostream* stream) { *stream << c.name; }

std::vector<TypeCase> type_cases() {
  return {
      {"Number",
       {.path = "k",
        .type = KeyType::kNumber,
        .unit = units::Unit::kMillimetre,
        .min = 0.0,
        .max = 2.5},
       "a number in mm, 0 to 2.5",
       {"0", "0.0", "-0.0", "2.5", "1", "1e-9"},
       {"-1e-300", "2.5000001", "nan", "-nan", "inf", "-inf", "\"1\"", "true", "[1]", "{ a = 1 }",
        "1979-05-27"}},
      {"NumberAbove",
       {.path = "k", .type = KeyType::kNumber, .min = 0.0, .min_excluded = true},
       "a number, above 0",
       {"1e-300", "1e300"},
       {"0", "0.0", "-0.0", "-1", "inf", "nan"}},
      {"NumberAtMost",
       {.path = "k", .type = KeyType::kNumber, .max = 3.0},
       "a number, at most 3",
       {"-1e300", "3"},
       {"3.01", "-inf", "nan"}},
      {"NumberOfAnySize",
       {.path = "k", .type = KeyType::kNumber},
       "a number",
       {"-1e300", "1e300", "9223372036854775807"},
       {"inf", "-inf", "nan", "\"\""}},
      {"Integer",
       {.path = "k", .type = KeyType::kInteger, .min = 1, .max = 24},
       "an integer, 1 to 24",
       {"1", "24", "0x10"},
       {"0", "25", "3.0", "3.5", "nan", "true", "\"3\"", "[3]", "9223372036854775807",
        "-9223372036854775808"}},
      {"Boolean",
       {.path = "k", .type = KeyType::kBoolean},
       "true or false",
       {"true", "false"},
       {"0", "1", "\"true\"", "[]", "{}"}},
      {"Text",
       {.path = "k", .type = KeyType::kText},
       "a text in quotes",
       {"\"\"", "\"a\"", "'''b'''"},
       {"1", "true", "[\"a\"]", "1979-05-27"}},
      {"Choice",
       {.path = "k", .type = KeyType::kChoice, .choices = {"khk", "iso21771"}},
       "\"khk\" or \"iso21771\"",
       {"\"khk\"", "\"iso21771\""},
       {"\"KHK\"", "\"\"", "\"khk \"", "1", "[\"khk\"]"}},
      {"NumberRange",
       {.path = "k",
        .type = KeyType::kNumberRange,
        .unit = units::Unit::kModules,
        .min = -5.0,
        .max = 5.0},
       "[low, high], two numbers in modules, -5 to 5, low <= high",
       {"[0, 1]", "[0.5, 0.5]", "[-5.0, 5]"},
       {"[1, 0]", "[0]", "[0, 1, 2]", "[]", "[0, 6]", "[-6, 0]", "[nan, 1]", "[0, nan]",
        "[0, \"1\"]", "0.5", "{ min = 0, max = 1 }"}},
      {"IntegerRange",
       {.path = "k", .type = KeyType::kIntegerRange, .min = 4, .max = 500},
       "[low, high], two integers, 4 to 500, low <= high",
       {"[4, 500]", "[10, 10]"},
       {"[20, 10]", "[10.0, 20.0]", "[3, 10]", "[10, 501]", "[10]", "10", "[10, 20, 30]",
        "[10, 9223372036854775807]"}},
      {"Integers",
       {.path = "k", .type = KeyType::kIntegers, .min = 1, .max = 24},
       "an integer or a list of integers, 1 to 24",
       {"3", "[3]", "[6, 3, 3]"},
       {"[]", "0", "[3, 0]", "[3, 4.0]", "3.0", "\"3\"", "[[3]]"}},
      {"Module",
       {.path = "k",
        .type = KeyType::kModule,
        .unit = units::Unit::kMillimetre,
        .min = 0.0,
        .max = 100.0,
        .min_excluded = true},
       "a number, { min, max } with min <= max, or { series = [..] } in mm, above 0 to 100",
       {"0.5", "1", "{ min = 0.5, max = 1 }", "{ max = 1.0, min = 1.0 }", "{ series = [0.5] }",
        "{ series = [1, 0.8, 0.8] }"},
       {"0",
        "-1",
        "nan",
        "101",
        "{ min = 1.0, max = 0.5 }",
        "{ min = 0.5 }",
        "{ max = 0.5 }",
        "{ min = 0.0, max = 1.0 }",
        "{ min = 0.5, max = inf }",
        "{ min = 0.5, max = 1, step = 0.1 }",
        "{ min = 0.5, maximum = 1 }",
        "{ series = [] }",
        "{ series = 0.5 }",
        "{ series = [0.5, 0] }",
        "{ series = [0.5, \"1\"] }",
        "{ series = [0.5], min = 0.5 }",
        "{}",
        "[0.5, 1.0]",
        "\"0.5\"",
        "true"}},
      {"NumberPerGear",
       {.path = "k", .type = KeyType::kNumberPerGear, .min = 0.0, .max = 1.0},
       "a number, or a table with S, P1, R1, P2, R2, 0 to 1",
       {"0.02", "{ S = 0.02 }", "{ S = 0, P1 = 0, R1 = 0, P2 = 0, R2 = 1 }"},
       {"-0.1", "nan", "{}", "{ P3 = 0.1 }", "{ s = 0.1 }", "{ S = 1.1 }", "{ S = \"0\" }",
        "[0.1, 0.1, 0.1, 0.1, 0.1]", "true"}},
      {"NumberOrSwitch",
       {.path = "k",
        .type = KeyType::kNumberOrSwitch,
        .unit = units::Unit::kModule,
        .min = -2.0,
        .max = 2.0},
       "true, false, or a number in module, -2 to 2",
       {"true", "false", "0", "0.25", "-2"},
       {"3", "nan", "\"off\"", "[0.25]", "{}"}},
      {"NumberOrChoice",
       {.path = "k",
        .type = KeyType::kNumberOrChoice,
        .min = 1.0,
        .max = 2.0,
        .choices = {"m56", "drivetrain"}},
       "a number, 1 to 2, or \"m56\" or \"drivetrain\"",
       {"1", "1.5", "\"m56\"", "\"drivetrain\""},
       {"0.9", "nan", "\"M56\"", "true", "[1]", "{}"}},
  };
}

struct Match {
  std::size_t found;
  std::string errors;
};

Match match(const std::vector<KeyRecord>& records, const std::string& toml,
            const std::vector<std::string>& gears = {}) {
  std::vector<const KeyRecord*> pointers;
  for (const KeyRecord& record : records) pointers.push_back(&record);
  FileReading reading("file.toml");
  const TomlValue document = parse_toml(toml, "file.toml");
  const auto found = match_keys(document, KeyIndex(expand_keys(pointers, gears)), reading);
  try {
    reading.throw_if_invalid();
  } catch (const InvalidInput& error) {
    return {found.size(), error.what()};
  }
  return {found.size(), ""};
}

class KeyTypes : public testing::TestWithParam<TypeCase> {};

TEST_P(KeyTypes, SayInWordsWhatIsAllowed) {
  EXPECT_EQ(allowed_text(GetParam().record), GetParam().allowed);
}

TEST_P(KeyTypes, TakeValuesOfTheirTypeAndRange) {
  for (const std::string& value : GetParam().good) {
    const Match result = match({GetParam().record}, "k = " + value);
    EXPECT_EQ(result.errors, "") << value;
    EXPECT_EQ(result.found, 1U) << value;
  }
}

TEST_P(KeyTypes, RefuseAllOthersAtTheirPlaceWithWhatIsAllowed) {
  for (const std::string& value : GetParam().bad) {
    const Match result = match({GetParam().record}, "\n  k = " + value);
    EXPECT_EQ(result.found, 0U) << value;
    EXPECT_TRUE(result.errors.starts_with("file.toml:2:3: k = ")) << value << ": " << result.errors;
    EXPECT_NE(result.errors.find("allowed: " + GetParam().allowed), std::string::npos)
        << value << ": " << result.errors;
  }
}

INSTANTIATE_TEST_SUITE_P(All, KeyTypes, testing::ValuesIn(type_cases()),
                         [](const auto& param) { return param.param.name; });

// --- matching a document

const KeyRecord kTeeth{.path = "gears.{gear}.teeth",
                       .type = KeyType::kInteger,
                       .min = 3,
                       .max = 100,
                       .required = true,
                       .help = "number of teeth"};
const KeyRecord kPlanets{.path = "planets", .type = KeyType::kInteger, .min = 1, .max = 24};

TEST(MatchKeys, ExpandsGearsInTheirOrder) {
  const auto keys = expand_keys({&kPlanets, &kTeeth}, {"S", "P1"});
  ASSERT_EQ(keys.size(), 3U);
  EXPECT_EQ(keys[0].path, "planets");
  EXPECT_EQ(keys[1].path, "gears.S.teeth");
  EXPECT_EQ(keys[2].path, "gears.P1.teeth");
  EXPECT_EQ(keys[2].key, 1U);
  EXPECT_EQ(keys[2].gear, 1U);
}

TEST(MatchKeys, FindsAKeyInEveryTomlNotation) {
  for (const char* toml :
       {"gears.S.teeth = 12", "[gears.S]\nteeth = 12", "[gears]\nS = { teeth = 12 }",
        "[gears]\nS.teeth = 12", "gears = { S = { teeth = 12 } }", "\"gears\".'S'.teeth = 12"}) {
    const Match result = match({kTeeth}, toml, {"S"});
    EXPECT_EQ(result.errors, "") << toml;
    EXPECT_EQ(result.found, 1U) << toml;
  }
}

TEST(MatchKeys, MissingKeyIsReportedAtItsTableWhereThereIsOne) {
  EXPECT_TRUE(
      match({kTeeth}, "# comment\n\n[gears.S]\n", {"S"}).errors.starts_with("file.toml:3:"));
  const std::string absent = match({kTeeth}, "", {"S"}).errors;
  EXPECT_TRUE(
      absent.starts_with("file.toml:1:1: gears.S.teeth is missing: number of teeth; allowed: "
                         "an integer, 3 to 100"))
      << absent;
}

TEST(MatchKeys, AWrongValueIsNotReportedAsMissingToo) {
  const std::string errors = match({kTeeth}, "gears.S.teeth = \"12\"", {"S"}).errors;
  EXPECT_EQ(errors.find("missing"), std::string::npos) << errors;
}

TEST(MatchKeys, UnknownKeySuggestsAKeyOfTheSameTableFirst) {
  EXPECT_EQ(match({kTeeth, kPlanets}, "gears.S.teeth = 12\ngears.S.theeth = 12", {"S"}).errors,
            "file.toml:2:9: unknown key gears.S.theeth; did you mean gears.S.teeth?");
}

TEST(MatchKeys, UnknownKeySuggestsTheSameWordInAnotherTable) {
  EXPECT_EQ(match({kTeeth, kPlanets}, "gears.S.teeth = 12\ngears.S.planets = 3", {"S"}).errors,
            "file.toml:2:9: unknown key gears.S.planets; did you mean planets?");
}

TEST(MatchKeys, UnknownKeyWithoutALikenessHasNoSuggestion) {
  EXPECT_EQ(match({kPlanets}, "weight_kg = 3").errors, "file.toml:1:1: unknown key weight_kg");
}

TEST(MatchKeys, AShortWordOfALongTablesNameIsNotLikeItsOtherKeys) {
  const KeyRecord k_a{.path = "strength.k_a"}, y_m{.path = "strengths.y_m"};
  EXPECT_EQ(match({k_a, y_m}, "strength.foo = 3").errors,
            "file.toml:1:10: unknown key strength.foo");
  EXPECT_EQ(match({k_a, y_m}, "strength.k_aa = 3").errors,
            "file.toml:1:10: unknown key strength.k_aa; did you mean strength.k_a?");
  // A word and its table both a letter off.
  EXPECT_EQ(match({{.path = "stage1.module_mm"}, k_a}, "[strength]\n[stage2]\nmodul_mm = 3").errors,
            "file.toml:2:2: unknown table [stage2]; did you mean [stage1]?");
}

TEST(MatchKeys, UnknownTableIsOneErrorWhateverItHolds) {
  EXPECT_EQ(match({kTeeth}, "gears.S.teeth = 12\n[gear]\na = 1\nb = 2", {"S"}).errors,
            "file.toml:2:2: unknown table [gear]; did you mean [gears]?");
}

TEST(MatchKeys, ErrorsComeInTheOrderOfTheFile) {
  EXPECT_EQ(
      match({kTeeth, kPlanets}, "zebra = 1\nplanets = 99\n[gears.S]\nteeth = 2\nant = 1\n", {"S"})
          .errors,
      "file.toml:1:1: unknown key zebra\n"
      "file.toml:2:1: planets = 99: allowed: an integer, 1 to 24\n"
      "file.toml:4:1: gears.S.teeth = 2: allowed: an integer, 3 to 100\n"
      "file.toml:5:1: unknown key gears.S.ant");
}

TEST(MatchKeys, ManyUnknownKeysTakeLittleMoreThanReadingThem) {
  constexpr int kKeys = 100'000;
  std::string text;
  for (int k = 0; k < kKeys; ++k) text += fmt::format("k{}=1\n", k);
  std::string message;
  const double reading_s = test::cpu_seconds_of([&] { parse_toml(text, "gear.toml"); });
  const double all_s = test::cpu_seconds_of([&] {
    try {
      parse_design(text, "gear.toml");
    } catch (const InvalidInput& error) {
      message = error.what();
    }
  });
  // 1.2 to 1.7 times.
  EXPECT_LT(all_s, 3.5 * reading_s) << "a suggestion for each would take six times";
  EXPECT_TRUE(message.starts_with("gear.toml:1:1: unknown key k0")) << message.substr(0, 200);
  // With the required keys that are missing.
  const std::size_t last = message.rfind('\n');
  EXPECT_TRUE(message.substr(last + 1).starts_with("gear.toml: and 999")) << message.substr(last);
  EXPECT_TRUE(message.ends_with(" more"));
}

TEST(MatchKeys, LongValuesAreShortened) {
  const std::string errors =
      match({kPlanets}, "planets = \"" + std::string(5000, 'x') + "\"").errors;
  EXPECT_LT(errors.size(), 200U);
  EXPECT_NE(errors.find("xxx..."), std::string::npos);
}

TEST(MatchKeys, LongValuesAreNotCutWithinACharacter) {
  // One byte before, so that two-byte letters end at odd places.
  for (const char* before : {"", "x"}) {
    std::string text = before;
    for (int k = 0; k < 100; ++k) text += "\xc3\xa9";
    const std::string errors = match({kPlanets}, "planets = \"" + text + "\"").errors;
    const auto cut = errors.find("...");
    ASSERT_NE(cut, std::string::npos);
    EXPECT_EQ(errors[cut - 1], '\xa9') << "a letter without its second byte: " << errors;
  }
}

// --- every key of the three files

struct FileKind {
  std::string name;
  std::function<std::string()> table;
  std::vector<std::string> gears;
  std::string minimal;  ///< the required keys, as dotted keys
  std::function<void(const std::string&)> parse;
};

void PrintTo(const FileKind& kind, std::ostream* stream) { *stream << kind.name; }

void parse_pair_text(const std::string& text) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     ("gear3k_pair_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(path, std::ios::binary) << text;
  const std::string name = path.string();
  try {
    static_cast<void>(read_pair(name));
  } catch (...) {
    std::filesystem::remove(path);
    throw;
  }
  std::filesystem::remove(path);
}

std::vector<FileKind> file_kinds() {
  return {{"Design",
           design_key_table,
           {"S", "P1", "R1", "P2", "R2"},
           "stage1.module_mm = 0.8\nstage2.module_mm = 0.8467\ngears.S.teeth = 12\n"
           "gears.P1.teeth = 39\ngears.R1.teeth = 90\ngears.P2.teeth = 32\ngears.R2.teeth = 81\n",
           [](const std::string& text) { static_cast<void>(parse_design(text, "f")); }},
          {"Pair",
           pair_key_table,
           {"gear1", "gear2"},
           "kind = \"internal\"\nmodule_mm = 3.0\ngear1.teeth = 16\ngear2.teeth = 24\n",
           parse_pair_text},
          {"Specification",
           specification_key_table,
           {},
           "ratio.target = 96.2\nteeth.S = [12, 13]\nteeth.P1 = [50, 60]\nteeth.P2 = [40, 60]\n"
           "teeth.R1_max = 120\nteeth.R2_max = 120\nmodule.stage1_mm = 1.0\n"
           "module.stage2_mm = 1.0\n",
           [](const std::string& text) { static_cast<void>(parse_specification(text, "f")); }},
          {"Actuator",
           actuator_key_table,
           {},
           "motor.resistance_ohm = 0.5\nmotor.torque_constant_nm_per_a = 0.05\n"
           "gearbox.ratio = 50.0\ngearbox.efficiency_forward = 0.8\n"
           "gearbox.efficiency_backward = 0.6\n",
           [](const std::string& text) { static_cast<void>(parse_actuator(text, "f")); }},
          {"Scenario",
           scenario_key_table,
           {},
           "duration_s = 1.0\ncontrol.mode = \"torque\"\n",
           [](const std::string& text) { static_cast<void>(parse_scenario(text, "f")); }}};
}

struct Row {
  std::string path, allowed, default_text, help;
};

/// Rows of a Markdown table; a cell may hold `\|`.
std::vector<std::vector<std::string>> cells_of(const std::string& table) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> cells;
  std::string cell;
  for (std::size_t k = 0; k < table.size(); ++k) {
    const char c = table[k];
    if (c == '\\' && k + 1 < table.size() && table[k + 1] == '|') {
      cell += '|';
      ++k;
    } else if (c == '|' || c == '\n') {
      const auto first = cell.find_first_not_of(' ');
      const auto last = cell.find_last_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
      cell.clear();
      if (c == '\n') {
        rows.push_back(cells);
        cells.clear();
      }
    } else {
      cell += c;
    }
  }
  return rows;
}

std::vector<Row> rows_of(const FileKind& kind) {
  std::vector<Row> rows;
  for (const auto& cells : cells_of(kind.table())) {
    // A line begins and ends with a bar: an empty cell before the first and after the last.
    if (cells.size() < 6 || !cells[1].starts_with('`')) continue;
    rows.push_back({.path = cells[1].substr(1, cells[1].size() - 2),
                    .allowed = cells[2],
                    .default_text = cells[3],
                    .help = cells[4]});
  }
  return rows;
}

/// The keys of a row: one for each gear where the path has a list of them.
std::vector<std::string> paths_of(const Row& row, const FileKind& kind) {
  const auto open = row.path.find('<');
  if (open == std::string::npos) return {row.path};
  const auto close = row.path.find('>');
  std::vector<std::string> paths;
  for (const std::string& gear : kind.gears) {
    paths.push_back(row.path.substr(0, open) + gear + row.path.substr(close + 1));
  }
  return paths;
}

/// The minimal file with one key set (replacing the line that sets it).
std::string with_key(const FileKind& kind, const std::string& path, const std::string& value) {
  std::string text = path;
  text += " = " + value + "\n";
  std::size_t begin = 0;
  while (begin < kind.minimal.size()) {
    const auto end = kind.minimal.find('\n', begin) + 1;
    const std::string line = kind.minimal.substr(begin, end - begin);
    if (!line.starts_with(path + " =")) text += line;
    begin = end;
  }
  return text;
}

std::string errors_of(const FileKind& kind, const std::string& text) {
  try {
    kind.parse(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

class EveryKey : public testing::TestWithParam<FileKind> {};

TEST_P(EveryKey, MinimalFileIsSound) { EXPECT_EQ(errors_of(GetParam(), GetParam().minimal), ""); }

TEST_P(EveryKey, HasAMeaningADefaultAndWhatIsAllowed) {
  const auto rows = rows_of(GetParam());
  ASSERT_GT(rows.size(), 20U);
  for (const Row& row : rows) {
    EXPECT_GT(row.help.size(), 5U) << row.path;
    EXPECT_NE(row.allowed, "") << row.path;
    EXPECT_NE(row.default_text, "") << row.path;
  }
}

TEST_P(EveryKey, IsOneRowOfFourCells) {
  for (const auto& cells : cells_of(GetParam().table())) {
    EXPECT_EQ(cells.size(), 6U) << (cells.size() > 1 ? cells[1] : "");
  }
}

TEST_P(EveryKey, OccursOnce) {
  std::vector<std::string> all;
  for (const Row& row : rows_of(GetParam())) {
    for (const std::string& path : paths_of(row, GetParam())) all.push_back(path);
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

TEST_P(EveryKey, CarriesItsUnitAsTheLastWordOfItsName) {
  struct Suffix {
    std::string unit, word;
  };
  std::size_t with_unit = 0;
  for (const Row& row : rows_of(GetParam())) {
    // A limit has its check's name, with the unit in the registry of checks.
    if (row.path.starts_with("limits.")) continue;
    if (row.path.ends_with("_per_um")) continue;
    for (const Suffix& s : {Suffix{" in mm,", "_mm"}, Suffix{" in um,", "_um"},
                            Suffix{" in deg,", "_deg"}, Suffix{" in arcmin,", "_arcmin"},
                            Suffix{" in kg m2,", "_kgm2"}, Suffix{" in kg,", "_kg"}}) {
      const bool measured = row.allowed.find(s.unit) != std::string::npos;
      EXPECT_EQ(row.path.ends_with(s.word), measured) << row.path << ": " << row.allowed;
      with_unit += measured ? 1 : 0;
    }
  }
  EXPECT_GE(with_unit, 4U);
}

TEST_P(EveryKey, RefusesAValueOfAWrongType) {
  for (const Row& row : rows_of(GetParam())) {
    for (const std::string& path : paths_of(row, GetParam())) {
      std::vector<std::string> wrong{"1979-05-27", "[[[]]]", "{ nothing = 1 }"};
      wrong.emplace_back(row.allowed.starts_with("a text in quotes") ? "1"
                                                                     : "\"nothing of the kind\"");
      for (const std::string& value : wrong) {
        const std::string errors = errors_of(GetParam(), with_key(GetParam(), path, value));
        EXPECT_NE(errors.find(":1:"), std::string::npos)
            << path << " = " << value << ": " << errors;
        EXPECT_NE(errors.find(path + " = "), std::string::npos)
            << path << " = " << value << ": " << errors;
        EXPECT_NE(errors.find("allowed: " + row.allowed), std::string::npos)
            << path << " = " << value << ": " << errors;
      }
    }
  }
}

TEST_P(EveryKey, RefusesWhatIsNoFiniteNumberAndWhatIsFarOutOfRange) {
  for (const Row& row : rows_of(GetParam())) {
    for (const std::string& path : paths_of(row, GetParam())) {
      for (const char* value : {"nan", "inf", "-inf", "1e300", "-1e300", "9223372036854775807"}) {
        const std::string errors = errors_of(GetParam(), with_key(GetParam(), path, value));
        EXPECT_NE(errors.find("allowed: " + row.allowed), std::string::npos)
            << path << " = " << value << ": " << errors;
      }
    }
  }
}

TEST_P(EveryKey, TakesTheDefaultThatItsDocumentationStates) {
  for (const Row& row : rows_of(GetParam())) {
    // Words such as "none" describe what an absent key means; a switch without a limit is no value.
    const char first = row.default_text.empty() ? ' ' : row.default_text.front();
    const bool literal = first == '"' || first == '[' || (first >= '0' && first <= '9') ||
                         row.default_text == "true" || row.default_text == "false";
    if (!literal || row.help.starts_with("switch of the check")) continue;
    for (const std::string& path : paths_of(row, GetParam())) {
      EXPECT_EQ(errors_of(GetParam(), with_key(GetParam(), path, row.default_text)), "")
          << path << " = " << row.default_text;
    }
  }
}

TEST_P(EveryKey, IsMissedWhenItIsRequired) {
  std::size_t required = 0;
  for (const Row& row : rows_of(GetParam())) {
    if (row.default_text != "required") continue;
    for (const std::string& path : paths_of(row, GetParam())) {
      ++required;
      const std::string line = path + " = \"\"";
      std::string text = with_key(GetParam(), path, "\"\"");
      text.erase(0, line.size());
      const std::string errors = errors_of(GetParam(), text);
      EXPECT_NE(errors.find(path + " is missing"), std::string::npos) << errors;
      EXPECT_NE(errors.find("allowed: " + row.allowed), std::string::npos) << errors;
    }
  }
  // Of an actuator's gearbox a design may stand in place of the others.
  EXPECT_GE(required, GetParam().name == "Actuator" || GetParam().name == "Scenario" ? 2U : 4U);
}

TEST_P(EveryKey, MisspeltByOneLetterIsSuggested) {
  for (const Row& row : rows_of(GetParam())) {
    for (const std::string& path : paths_of(row, GetParam())) {
      const std::string word = path.substr(path.rfind('.') + 1);
      if (word.size() < 4) continue;  // of S, P1, P2 each is one letter from another
      const std::string errors = errors_of(GetParam(), path + "x = 1\n" + GetParam().minimal);
      EXPECT_NE(errors.find("unknown key " + path + "x; did you mean " + path + "?"),
                std::string::npos)
          << errors;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, EveryKey, testing::ValuesIn(file_kinds()),
                         [](const auto& param) { return param.param.name; });

}  // namespace
}  // namespace gear3k::io::key_registry_test
