#include "report/search_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>

#include "io/files/specification_file.hpp"
#include "report/front_plot.hpp"

namespace gear3k::report::search_report_test {
namespace {

const std::string kHeader =
    "zS,zP1,zR1,zP2,zR2,status,reason,ratio,eta_b,eta_f,backlash_arcmin,xS,xP1,xR1,xP2,xR2,m1_mm,"
    "m2_mm,center_distance_mm,eps1,eps2,eps3,eta_b_bound,kkt_residual,planets,"
    "ring_root_diameter_mm,violation";

TEST(SearchReport, RefinedSetsHaveTheColumnsOfTheInterfaceAlsoWhereThereIsNoSet) {
  const optimize::OptimizeResult nothing{};
  EXPECT_EQ(pareto_csv(nothing, {}), kHeader + "\n");
  EXPECT_EQ(
      pareto_csv(nothing, {.model = true, .tips = true, .pressure_angle = true, .masses = true}),
      kHeader +
          ",eta_b_model,eta_f_model,kS,kP1,kR1,kP2,kR2,pressure_angle_deg,mass_kg,"
          "inertia_kgm2\n");
}

TEST(SearchReport, ObjectivesFollowTheColumnsOfTheFront) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency, optimize::Objective::kLostMotion};
  optimize::ParetoFront front;
  const std::string header = pareto_csv(spec, front);
  EXPECT_EQ(header.find(kHeader + ",objective_"), 0U) << header;
  front.points.push_back({.set = {}, .values = {0.9, 0.001}});
  front.points.back().set.candidate.teeth = {.S = 12, .P1 = 64, .R1 = 141, .P2 = 52, .R2 = 132};
  const std::string text = pareto_csv(spec, front);
  const std::string row = text.substr(header.size());
  EXPECT_TRUE(row.starts_with("12,64,141,52,132,failed,,96.5")) << row;
  EXPECT_EQ(std::ranges::count(row, ','), std::ranges::count(header, ','));
}

TEST(SearchReport, AxesOfTheFrontAreInPerCentOrTheirUnit) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency, optimize::Objective::kLostMotion};
  optimize::ParetoFront front;
  front.points.push_back({.set = {}, .values = {0.75, std::numbers::pi / 10800.0}});
  const std::string script = pareto_plot(spec, front).script;
  EXPECT_NE(script.find("set ylabel 'eta backward (%)'"), std::string::npos) << script;
  EXPECT_NE(script.find("set xlabel 'lost motion (arcmin)'"), std::string::npos) << script;
  EXPECT_NE(script.find("\n75 1 \n"), std::string::npos) << script;
}

TEST(SearchReport, TellsTheBestOfAnObjectiveThatTheTableOfADesignHasNot) {
  optimize::Specification spec;
  optimize::RefinedSet best;
  best.ring_root_diameter_m = 0.0621;
  spec.bodies.ring_rim_m = 0.003;
  EXPECT_EQ(objective_line(spec, best), "") << "backward efficiency";
  spec.objectives = {optimize::Objective::kOuterDiameter};
  EXPECT_NE(objective_line(spec, best).find("68.1 mm"), std::string::npos)
      << objective_line(spec, best);
}

TEST(SearchReport, WhatIsSaidOfAFrontFitsAHundredColumnsAndTellsOfGridsThatWereCutShort) {
  optimize::Specification spec;
  spec.objectives = {optimize::Objective::kBackwardEfficiency, optimize::Objective::kLostMotion};
  spec.pareto_points = 30;
  optimize::ParetoFront front;
  front.searches = 120;
  front.ended = optimize::ParetoFront::Ended::kSearches;
  const auto longest = [](const std::string& text) {
    std::size_t most = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) most = std::max(most, line.size());
    return most;
  };
  EXPECT_EQ(pareto_table(spec, front).find("grids"), std::string::npos);
  front.grid_cut = 2;
  const std::string text = pareto_table(spec, front);
  EXPECT_LE(longest(text), 100U) << text;
  EXPECT_NE(text.find("grids of shifts were not searched to the end in 2 refinements"),
            std::string::npos);
  const optimize::OptimizeResult nothing{};
  EXPECT_EQ(pareto_csv(nothing, {.grid = true}), kHeader + ",grid_cut\n");
}

std::string search_csv(optimize::ZeroShiftRanking& ranking) {
  std::string text;
  write_search_csv(ranking, [&](std::string_view piece) { text += piece; });
  return text;
}

TEST(SearchReport, ToothSetsWithoutAnyHaveAHeader) {
  const optimize::Specification spec =
      io::read_specification(GEAR3K_SOURCE_DIR "/examples/ratio-96.toml");
  optimize::ZeroShiftRanking ranking(spec);
  EXPECT_EQ(search_csv(ranking),
            "zS,zP1,zR1,zP2,zR2,planets,ratio,module_ratio,meshes,eta_b,eta_f,backlash_arcmin,"
            "sun_backlash_modules,eps1,eps2,eps3\n");
  ranking.add(std::array{optimize::Candidate{
      .teeth = {.S = 40, .P1 = 70, .R1 = 170, .P2 = 70, .R2 = 180}, .planets = 5}});
  const std::string csv = search_csv(ranking);
  EXPECT_EQ(csv.substr(csv.find('\n') + 1),
            "40,70,170,70,180,5,94.5,0.9090909090909091,false,,,,,,,\n")
      << "empty where no working angle is defined";
}

TEST(SearchReport, CountsOfASearchThatWasStoppedSaySo) {
  const optimize::Specification spec =
      io::read_specification(GEAR3K_SOURCE_DIR "/examples/ratio-96.toml");
  optimize::Progress progress;
  const auto counts = [&] {
    return search_counts_text(spec, optimize::search_teeth(spec, progress));
  };
  EXPECT_EQ(counts().find("stopped"), std::string::npos);
  progress.stop = true;
  EXPECT_TRUE(counts().ends_with("; so far: stopped before all tooth numbers were searched\n"));
}

}  // namespace
}  // namespace gear3k::report::search_report_test
