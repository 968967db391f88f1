#include "sweep/atlas.hpp"

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "io/text/csv_table.hpp"
#include "tests/sweep/small_sweep.hpp"

namespace gear3k::atlas_test {
namespace {

using sweep::AtlasPoint;
using test::ProgramResult, test::refusal_of, test::Workplace;

/// Of the sun's speed over the output's, from the teeth: (1 + G1)/(1 - G2).
double ratio_of(const train::ToothSet& teeth) {
  const double g1 = static_cast<double>(teeth.R1) / teeth.S;
  const double g2 = static_cast<double>(teeth.P2 * teeth.R1) / (teeth.P1 * teeth.R2);
  return (1.0 + g1) / (1.0 - g2);
}

TEST(Atlas, ItsDesignsKeepWhatTheirTasksAsk) {
  ASSERT_EQ(sweep::atlas().size(), 13U * 4U * 3U * 2U);
  for (const AtlasPoint& point : sweep::atlas()) {
    SCOPED_TRACE(testing::Message() << point.ratio_target << ":1, " << point.planets << " planets");
    ASSERT_TRUE(point.best);
    const AtlasPoint::Best& best = *point.best;
    EXPECT_NEAR(ratio_of(best.teeth) / point.ratio_target, 1.0, 0.003 + 1e-12);
    // Both meshes of the sun's stage assemble.
    EXPECT_EQ((best.teeth.S + best.teeth.R1) % point.planets, 0);
    constexpr double kOfScale = 1e-6;  // limits are kept to this share of their scale
    EXPECT_LE(best.ring_root_diameter_mm, 76.0 * (1.0 + kOfScale));
    EXPECT_GE(best.torque_capacity_nm, 20.0 * (1.0 - kOfScale));
    EXPECT_LE(best.eta_b, best.bound + kOfScale);
  }
}

TEST(Atlas, LooserLimitsAndLessFrictionAreNoWorse) {
  int compared = 0;
  for (const AtlasPoint& tight : sweep::atlas()) {
    for (const AtlasPoint& loose : sweep::atlas()) {
      if (tight.ratio_target != loose.ratio_target || tight.planets != loose.planets ||
          loose.backlash_arcmin < tight.backlash_arcmin || loose.friction > tight.friction) {
        continue;
      }
      ++compared;
      ASSERT_TRUE(loose.best) << loose.ratio_target << " " << loose.planets;
      // What is proven of the looser task holds for the tighter one; what was found of it is a
      // local optimum, at most as far off as its bound.
      EXPECT_LE(tight.best->eta_b, loose.best->bound + 1e-6)
          << loose.ratio_target << " " << loose.planets;
    }
  }
  // Of two limits, or the same twice, in six ways of three; of two frictions in three.
  EXPECT_EQ(compared, 13 * 4 * 6 * 3);
}

TEST(Atlas, AnswersNearAndRefusesFar) {
  const auto points =
      sweep::atlas_near({.ratio = 96.2, .planets = 4, .backlash_arcmin = 12.0, .friction = 0.08});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(std::log(points[0].ratio_target / 96.2), 0.0, std::log(300.0 / 20.0) / 24.0);
  EXPECT_EQ(points[0].backlash_arcmin, 8.0);
  EXPECT_EQ(points[0].friction, 0.1);
  EXPECT_EQ(sweep::atlas_near({.ratio = 100.0}).size(), 24U);
  EXPECT_EQ(refusal_of([] { sweep::atlas_near({.ratio = 10.0}); }),
            "atlas 10: allowed: a ratio from 20 to 300");
  EXPECT_NE(refusal_of([] { sweep::atlas_near({.ratio = std::nan("")}); }), "");
  EXPECT_EQ(refusal_of([] { sweep::atlas_near({.ratio = 50.0, .planets = 7}); }),
            "--planets 7: allowed: 3 to 6");
  EXPECT_EQ(refusal_of([] { sweep::atlas_near({.ratio = 50.0, .backlash_arcmin = 1.0}); }),
            "--backlash 1: allowed: at least 5, the atlas's least limit in arcmin");
}

TEST(Atlas, ItsTaskHasTheResultThatItTells) {
  const Workplace place;
  // Where tasks are cheapest: also a check that the atlas is of these models.
  ASSERT_EQ(place
                .run({"atlas", "300", "--planets", "6", "--backlash", "20", "--friction", "0.1",
                      "--task", "spec.toml"})
                .exit_code,
            0);
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--certify", "--out", "out"}).exit_code, 0);
  const io::CsvTable table = io::parse_csv(place.read("out/pareto.csv"), "pareto.csv");
  double best = 0.0;
  for (const io::CsvTable::Row& row : table.rows) {
    best = std::max(best, *table.number(row, "eta_b"));
  }
  const auto points =
      sweep::atlas_near({.ratio = 300.0, .planets = 6, .backlash_arcmin = 20.0, .friction = 0.1});
  ASSERT_TRUE(points.at(0).best);
  EXPECT_NEAR(best, points[0].best->eta_b, 1e-6);
  EXPECT_EQ(place.run({"atlas", "300", "--task", "spec.toml"}).exit_code, 2);
  EXPECT_EQ(place.run({"atlas", "300", "--task", "new", "--out", "./new"}).exit_code, 2);
  EXPECT_FALSE(place.has("new"));
}

TEST(Atlas, SaysWhichOfItsValuesItTakes) {
  const auto text = [](const sweep::AtlasQuestion& question) {
    return sweep::atlas_snap_text(question, sweep::atlas_near(question));
  };
  const sweep::AtlasPoint& own = sweep::atlas().front();
  EXPECT_EQ(text({.ratio = own.ratio_target,
                  .backlash_arcmin = own.backlash_arcmin,
                  .friction = own.friction}),
            "");
  const std::string taken = text({.ratio = 43.0, .backlash_arcmin = 7.0, .friction = 0.12});
  EXPECT_NE(taken.find("(43 was asked for)"), std::string::npos) << taken;
  EXPECT_NE(taken.find("lost motion within 5 arcmin (7 was asked for)"), std::string::npos)
      << taken;
  EXPECT_NE(taken.find("friction 0.1 (0.12 was asked for)"), std::string::npos) << taken;
}

TEST(Atlas, TaskHasWhatWasAskedForItself) {
  const std::string task =
      sweep::atlas_task({.ratio = 43.0, .backlash_arcmin = 7.0, .friction = 0.12});
  for (const char* line : {"target = 43", "max_output_arcmin = 7", "coefficient = 0.12"}) {
    EXPECT_NE(task.find(line), std::string::npos) << task;
  }
}

// The low-backlash prototype has 7.1 arcmin and 76 mm, the bilateral drive gear 24 arcmin and 94
// mm.
TEST(Atlas, FiguresHaveNoPublishedGearboxThatBreaksTheirLimitsAndJoinNoTasks) {
  const std::map<std::string, bool> has_low_backlash{
      {"atlas_5_arcmin", false}, {"atlas_8_arcmin", true}, {"atlas_20_arcmin", true}};
  const std::vector<report::Plot> plots = sweep::atlas_plots();
  ASSERT_EQ(plots.size(), has_low_backlash.size());
  for (const report::Plot& plot : plots) {
    const auto has = [&](const char* words) {
      return plot.script.find(words) != std::string::npos;
    };
    EXPECT_EQ(has("title 'measured: low backlash proposed, 7.1 arcmin, 76 mm'"),
              has_low_backlash.at(plot.name))
        << plot.script;
    EXPECT_FALSE(has("bilateral"));
    EXPECT_FALSE(has("lines")) << plot.script;
    EXPECT_FALSE(has("labels"));
    // As many points as tasks whose best can be driven backwards, and the measured one.
    std::size_t driven = has_low_backlash.at(plot.name) ? 1 : 0;
    for (const AtlasPoint& point : sweep::atlas()) {
      const bool of_figure =
          plot.name ==
          "atlas_" + std::to_string(static_cast<int>(point.backlash_arcmin)) + "_arcmin";
      driven += of_figure && point.best->eta_b > 0.0 ? 1 : 0;
    }
    std::size_t rows = 0;
    std::istringstream lines(plot.script);
    for (std::string line; std::getline(lines, line);) {
      rows += line.find_first_not_of("0123456789. e-") == std::string::npos ? 1 : 0;
    }
    EXPECT_EQ(rows, driven);
  }
}

}  // namespace
}  // namespace gear3k::atlas_test
