// `gear3k reproduce --figures`: files, figures with and without gnuplot, exit codes.

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::paper_figures_test {
namespace {

using test::example, test::OtherPath, test::ProgramResult, test::Workplace;

const std::vector<std::string> kLowBacklash{"fig6", "fig7", "fig8a", "fig8b", "fig8c"};
const std::vector<std::string> kNames{"backdrivability_fig10",
                                      "backdrivability_fig11",
                                      "backdrivability_fig8",
                                      "backdrivability_scaling",
                                      "directional_bench",
                                      "directional_braking",
                                      "directional_felt",
                                      "directional_transparency",
                                      "fig6",
                                      "fig7",
                                      "fig8a",
                                      "fig8b",
                                      "fig8c"};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string teeth_of(const io::CsvTable& table, const io::CsvTable::Row& row) {
  std::string text;
  for (const char* gear : {"zS", "zP1", "zR1", "zP2", "zR2"})
    text += table.text(row, gear).value_or("") + "/";
  return text;
}

/// Of `reproduce --figures f`, the points of Figs. 6 and 7 in `f`: the specification behind the
/// figures is an example, and `search` and `optimize` on it give the same points.
void expect_points_of_search_and_optimize(const Workplace& place) {
  place.write("spec.toml", example("paper-figures.toml"));
  const io::CsvTable figure = io::parse_csv(place.read("f/fig7.csv"), "fig7.csv");
  std::map<std::string, const io::CsvTable::Row*> zero_shift;
  std::map<std::string, const io::CsvTable::Row*> refined;
  for (const auto& row : figure.rows) {
    if (figure.text(row, "state") == "zero_shift") zero_shift[teeth_of(figure, row)] = &row;
    if (figure.number(row, "limit_arcmin") == 8.0) refined[teeth_of(figure, row)] = &row;
  }
  const io::CsvTable search =
      io::parse_csv(place.run({"search", "spec.toml", "--format", "csv"}).out, "search");
  std::size_t meshing = 0;
  for (const auto& row : search.rows) {
    const auto at = zero_shift.find(teeth_of(search, row));
    ASSERT_EQ(at != zero_shift.end(), search.text(row, "meshes") == "true")
        << teeth_of(search, row);
    if (at == zero_shift.end()) continue;
    ++meshing;
    for (const char* column : {"ratio", "eta_b", "eta_f", "backlash_arcmin", "eps2"}) {
      EXPECT_EQ(search.text(row, column), figure.text(*at->second, column));
    }
  }
  EXPECT_EQ(meshing, zero_shift.size());
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "o", "--quiet"}).exit_code, 0);
  const io::CsvTable sets = io::parse_csv(place.read("o/refined.csv"), "refined.csv");
  std::size_t compared = 0;
  for (const auto& row : sets.rows) {
    const auto at = refined.find(teeth_of(sets, row));
    if (at == refined.end()) continue;
    ++compared;
    EXPECT_EQ(sets.text(row, "status"), figure.text(*at->second, "status"));
    const auto eta_b = sets.number(row, "eta_b");
    ASSERT_EQ(eta_b.has_value(), figure.number(*at->second, "eta_b").has_value());
    if (!eta_b) continue;
    EXPECT_NEAR(*eta_b, *figure.number(*at->second, "eta_b"), 1e-5);
  }
  EXPECT_EQ(compared, refined.size());
}

/// Of `reproduce --figures f --format json`: the trapezoid over Fig. 11's points between changes of
/// sign comes near the energies of the JSON; the points of Fig. 10 are those of the data file by
/// hand at two places.
void expect_backdrivability_points(const Workplace& place, const nlohmann::json& json) {
  const io::CsvTable power =
      io::parse_csv(place.read("f/backdrivability_fig11.csv"), "backdrivability_fig11.csv");
  double drawn = 0.0;
  const io::CsvTable::Row* before = nullptr;
  for (const auto& row : power.rows) {
    if (power.text(row, "numbers") != "corrected") continue;
    if (before != nullptr) {
      const double mean =
          0.5 * (*power.number(row, "electrical_w") + *power.number(*before, "electrical_w"));
      drawn +=
          std::max(0.0, mean) * (*power.number(row, "time_s") - *power.number(*before, "time_s"));
    }
    before = &row;
  }
  const auto& runs = json.at("backdrivability_paper").at("knee").at("runs");
  ASSERT_EQ(runs.at(2).at("name"), "corrected");
  EXPECT_NEAR(drawn, runs.at(2).at("drawn_j").get<double>(), 0.01 * drawn);
  const io::CsvTable stride =
      io::parse_csv(place.read("f/backdrivability_fig10.csv"), "backdrivability_fig10.csv");
  ASSERT_EQ(stride.rows.size(), 201U);
  // At 17 %, between 16.13906: 0.45616 and 17.15659: 0.46045 N m/kg.
  const double at_17 = 0.45616 + (0.46045 - 0.45616) * (17.0 - 16.13906) / (17.15659 - 16.13906);
  EXPECT_NEAR(*stride.number(stride.rows[34], "stride_percent"), 17.0, 1e-12);
  EXPECT_NEAR(*stride.number(stride.rows[34], "torque_nm"), 75.0 * at_17, 1e-9);
}

// One run for all that it writes: they take seconds.
TEST(ReproduceFigures, EveryFigureIsWrittenWithThePointsOfTheOtherCommands) {
  const Workplace place;
  const ProgramResult result = place.run({"reproduce", "--figures", "a/figures", "--threads", "4"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  std::vector<std::string> expected{"a", "a/figures"};
  for (const std::string& name : kNames) {
    expected.push_back("a/figures/" + name + ".csv");
    expected.push_back("a/figures/" + name + ".svg");
    EXPECT_TRUE(contains(result.out, "a/figures/" + name + ".svg")) << result.out;
    const std::string svg = place.read("a/figures/" + name + ".svg");
    std::istringstream stream(svg);
    boost::property_tree::ptree tree;
    ASSERT_NO_THROW(boost::property_tree::read_xml(stream, tree)) << name;
    EXPECT_EQ(tree.count("svg"), 1U) << name;
    if (std::ranges::find(kLowBacklash, name) == kLowBacklash.end()) continue;
    for (const char* part : {"backward efficiency (%)", "(arcmin)", "mu = 0.1"}) {
      EXPECT_TRUE(contains(svg, part)) << name << ": " << part;
    }
  }
  EXPECT_EQ(place.listing(), expected);
  // The table is that of `reproduce` alone, with the figures below it.
  const std::string alone = place.run({"reproduce"}).out;
  EXPECT_EQ(result.out.substr(0, alone.size()), alone);
  EXPECT_TRUE(contains(result.out, "Figures of the low-backlash paper"));
  EXPECT_TRUE(contains(result.out, "Figures of the backdrivability-factors paper"));
  EXPECT_TRUE(contains(result.out, "Figures of the directional-impedance thesis"));

  // From one thread the same bytes; the JSON is that of `reproduce` alone.
  const ProgramResult one = place.run(
      {"reproduce", "--figures", "f", "--format", "json", "--out", "result", "--threads", "1"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(one.out, "");
  for (const std::string& name : kNames) {
    for (const char* type : {".csv", ".svg"}) {
      EXPECT_EQ(place.read("a/figures/" + name + type), place.read("f/" + name + type)) << name;
    }
  }
  const std::string json = place.run({"reproduce", "--format", "json"}).out;
  EXPECT_EQ(place.read("result"), json);
  expect_backdrivability_points(place, nlohmann::json::parse(json));
  expect_points_of_search_and_optimize(place);

  // Without gnuplot the data are there, and old figures are not; the CSV is that of `reproduce`
  // alone.
  const std::string data = place.read("f/fig6.csv");
  place.write("f/fig6.csv", "old");
  ProgramResult bare;
  {
    const OtherPath path("");
    bare = place.run({"reproduce", "--figures", "f", "--format", "csv", "--out", "result"});
  }
  EXPECT_EQ(bare.exit_code, 0);
  EXPECT_TRUE(contains(bare.err, "gnuplot: not found in PATH; figures need it")) << bare.err;
  EXPECT_TRUE(contains(bare.err, "written without figures: f/fig6.csv, f/fig7.csv")) << bare.err;
  EXPECT_EQ(bare.out, "");
  EXPECT_EQ(place.read("result"), place.run({"reproduce", "--format", "csv"}).out);
  EXPECT_EQ(place.read("f/fig6.csv"), data);
  for (const std::string& name : kNames) {
    EXPECT_FALSE(place.has("f/" + name + ".svg")) << name;
    EXPECT_TRUE(place.has("f/" + name + ".svg.previous")) << name;
  }
}

TEST(ReproduceFigures, AFolderThatCannotBeMadeLeavesNothingBehind) {
  const Workplace place;
  place.write("file", "");
  const ProgramResult result = place.run({"reproduce", "--figures", "file"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "file: cannot be made a folder")) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(place.listing(), (std::vector<std::string>{"file"}));
}

TEST(ReproduceFigures, AResultThatCannotBeWrittenLeavesNoFigures) {
  const Workplace place;
  const ProgramResult result =
      place.run({"reproduce", "--figures", "f", "--out", "absent/result.txt"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "absent/result.txt: cannot be written: No such file or directory\n");
  EXPECT_TRUE(place.listing().empty());
  const OtherPath path("");  // the table has the figures without gnuplot too
  EXPECT_EQ(place.run({"reproduce", "--figures", "f", "--out", "f/result.txt"}).exit_code, 0);
  EXPECT_TRUE(contains(place.read("f/result.txt"), "Figures of the low-backlash paper"));
}

TEST(ReproduceFigures, TheResultsFileMayNotBeAFigure) {
  const Workplace place;
  for (const char* file : {"f/fig7.csv", "f/../f/fig8a.svg"}) {
    const ProgramResult result = place.run({"reproduce", "--figures", "f", "--out", file});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_TRUE(contains(result.err, "is a file of --figures, allowed: another file"))
        << result.err;
    EXPECT_TRUE(place.listing().empty());
  }
}

TEST(ReproduceFigures, AnInterruptLeavesNothing) {
  const Workplace place;
  test::RunningProgram program = place.start({"reproduce", "--figures", "f"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGTERM, std::chrono::seconds(10)));
  program.send(SIGTERM);
  const auto result = program.wait(std::chrono::seconds(5));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->exit_code, 130);
  EXPECT_EQ(result->err, "interrupted: nothing is kept\n");
  EXPECT_TRUE(place.listing().empty());
}

TEST(ReproduceFigures, UsageErrors) {
  const Workplace place;
  EXPECT_EQ(place.run({"reproduce", "--figures"}).exit_code, 1);
  EXPECT_EQ(place.run({"reproduce", "--figures", ""}).exit_code, 1);
  const ProgramResult typo = place.run({"reproduce", "--figurs", "f"});
  EXPECT_EQ(typo.exit_code, 1);
  EXPECT_TRUE(contains(typo.err, "did you mean --figures?")) << typo.err;
  EXPECT_TRUE(contains(place.run({"reproduce", "--help"}).out, "--figures DIR"));
}

}  // namespace
}  // namespace gear3k::paper_figures_test
