// The low-backlash paper's figures from our own models: identities that their points obey.

#include "papers/paper_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/text/csv_table.hpp"
#include "papers/paper_figures_plot.hpp"
#include "papers/paper_figures_report.hpp"
#include "papers/published_sources.hpp"
#include "report/display.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::papers::paper_figures_test {
namespace {

using report::arcmin, report::mm;

const PaperFigures& figures() {
  static const PaperFigures kFigures = paper_figures(published_sources());
  return kFigures;
}

/// A DESIGN file with the allowance, friction and rack of the figures.
std::string design_text(const train::ToothSet& z, const std::array<double, 2>& module_mm,
                        const std::array<double, train::kGearCount>& shift, double distance_mm) {
  std::string text = fmt::format(
      "name = \"point\"\nplanets = 3\npressure_angle_deg = 20.0\ncenter_distance_mm = {}\n"
      "[stage1]\nmodule_mm = {}\n[stage2]\nmodule_mm = {}\n[backlash]\nmodel = \"paper\"\n"
      "[friction]\ncoefficient = 0.1\nloss_model = \"sliding\"\n",
      distance_mm, module_mm[0], module_mm[1]);
  const auto teeth = train::teeth_of(z);
  for (std::size_t i = 0; i < teeth.size(); ++i) {
    text +=
        fmt::format("[gears.{}]\nteeth = {}\nprofile_shift = {}\nmachining_allowance = 0.0491\n",
                    train::kGearNames[i], teeth[i], shift[i]);
  }
  return text;
}

design::Evaluation evaluation_of(const std::string& text) {
  return std::get<design::Evaluation>(design::evaluate(io::parse_design(text, "point.toml")));
}

/// Rounding of sums of angles and lengths through a file in mm.
constexpr double kRounding = 1e-11;

TEST(PaperFigures, EveryPointOfTheScatterIsWhatItsDesignFileEvaluatesTo) {
  const auto& points = figures().scatter.points;
  ASSERT_GT(points.size(), 1000U);
  for (std::size_t k = 0; k < points.size(); k += 7) {
    const ZeroShiftPoint& p = points[k];
    const auto& z = p.candidate.teeth;
    // The distance and the module that close both rings at zero shift, from the teeth alone.
    const double m1 = mm(p.module_m[0]);
    const double d = 0.5 * m1 * (z.R1 - z.P1);
    const double m2 = 2.0 * d / (z.R2 - z.P2);
    const design::Evaluation e = evaluation_of(design_text(z, {m1, m2}, {}, d));
    EXPECT_NEAR(p.ratio, e.ratio, kRounding * std::abs(e.ratio));
    EXPECT_NEAR(p.eta_b, *e.efficiency.backward, kRounding);
    EXPECT_NEAR(p.eta_f, *e.efficiency.forward, kRounding);
    EXPECT_NEAR(p.lost_motion_rad, e.lost_motion.paper_rad, kRounding);
    EXPECT_NEAR(mm(p.center_distance_m), d, kRounding * d);
    for (std::size_t mesh = 0; mesh < train::kMeshCount; ++mesh) {
      EXPECT_NEAR(p.contact_ratio[mesh], e.meshes[mesh].contact_ratio, 1e-9);
      EXPECT_GE(e.meshes[mesh].normal_backlash_m, -1e-12);
      EXPECT_GE(p.contact_ratio[mesh], 1.0);
    }
    const double root =
        std::max(e.gears[train::kR1].root_diameter_m, e.gears[train::kR2].root_diameter_m);
    EXPECT_NEAR(mm(root + 2.0 * figures().rim_m), 80.0, 1e-9);
  }
}

TEST(PaperFigures, TheScatterHoldsEveryToothSetThatABruteForceFinds) {
  const auto& points = figures().scatter.points;
  // A slice of the space: one pair of sun and planet, every ring and second planet.
  constexpr int kSun = 14;
  constexpr int kPlanet = 40;
  std::set<std::array<int, train::kGearCount>> listed;
  for (const ZeroShiftPoint& p : points) {
    const auto& z = p.candidate.teeth;
    if (z.S == kSun && z.P1 == kPlanet) listed.insert(train::teeth_of(z));
  }
  std::set<std::array<int, train::kGearCount>> found;
  for (int r1 = kSun + 2 * kPlanet - 4; r1 <= kSun + 2 * kPlanet + 4; ++r1) {
    if ((kSun + r1) % 3 != 0) continue;
    for (int p2 = 20; p2 <= 60; ++p2) {
      for (int r2 = p2 + 8; r2 <= 120; ++r2) {
        if (kPlanet * r2 == p2 * r1) continue;
        const double i =
            (1.0 + double(r1) / kSun) / (1.0 - double(p2) * r1 / (double(kPlanet) * r2));
        if (std::abs(i / 96.2 - 1.0) > 0.05) continue;
        const double m2 = double(r1 - kPlanet) / (r2 - p2);
        const auto result = design::evaluate(io::parse_design(
            design_text({kSun, kPlanet, r1, p2, r2}, {1.0, m2}, {}, 0.5 * (r1 - kPlanet)), "p"));
        const auto* e = std::get_if<design::Evaluation>(&result);
        const bool meshes =
            e != nullptr && std::ranges::all_of(e->meshes, [](const design::MeshResult& mesh) {
              return mesh.normal_backlash_m >= -1e-12 && mesh.contact_ratio >= 1.0;
            });
        if (meshes) found.insert({kSun, kPlanet, r1, p2, r2});
      }
    }
  }
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(listed, found);
}

TEST(PaperFigures, TheAllowanceGivesThePublishedGearItsStatedLostMotion) {
  const PaperFigures& f = figures();
  const auto e = std::get<design::Evaluation>(design::evaluate(f.published));
  const double stated = 8.0;
  // q has four decimals: half of the last one moves eq. 17 by 0.01 arcmin.
  EXPECT_NEAR(arcmin(e.lost_motion.paper_rad), stated, 0.02);
  EXPECT_NEAR(stated, arcmin(published_sources().low_backlash.stated_lost_motion_rad.value().value),
              1e-9);
}

TEST(PaperFigures, RefinementNeverEndsBelowAZeroShiftThatIsFeasible) {
  const PaperFigures& f = figures();
  std::size_t compared = 0;
  for (const RefinedPoint& set : f.refined) {
    const ZeroShiftPoint& p = f.scatter.points[set.scatter_index];
    if (!set.zero_shift_fails.empty()) continue;
    for (std::size_t i = 0; i < kRefinementLimits_arcmin.size(); ++i) {
      if (arcmin(p.lost_motion_rad) > kRefinementLimits_arcmin[i]) continue;
      ASSERT_EQ(set.refined[i].status, optimize::Status::kOptimal);
      EXPECT_GE(set.refined[i].eta_b, p.eta_b - design::kFeasibilityTolerance);
      ++compared;
    }
  }
  EXPECT_GT(compared, 0U);
}

TEST(PaperFigures, RefinedPointsKeepTheirLimitAndAreWhatTheirDesignFileEvaluatesTo) {
  const PaperFigures& f = figures();
  std::size_t seen = 0;
  for (std::size_t k = 0; k < f.refined.size(); k += 5) {
    for (std::size_t i = 0; i < kRefinementLimits_arcmin.size(); ++i) {
      const optimize::RefinedSet& set = f.refined[k].refined[i];
      if (set.status != optimize::Status::kOptimal) continue;
      const auto& t = set.train;
      const design::Evaluation e =
          evaluation_of(design_text(set.candidate.teeth, {mm(t.module_m[0]), mm(t.module_m[1])},
                                    t.profile_shift, mm(t.center_distance_m)));
      EXPECT_NEAR(set.eta_b, *e.efficiency.backward, kRounding);
      EXPECT_NEAR(f.refined[k].refined_kinematic_rad[i], e.lost_motion.kinematic_rad, kRounding);
      EXPECT_LE(arcmin(e.lost_motion.paper_rad),
                kRefinementLimits_arcmin[i] * (1.0 + 2.0 * design::kFeasibilityTolerance));
      ++seen;
    }
  }
  EXPECT_GT(seen, 100U);
}

TEST(PaperFigures, AWiderLimitNeverCostsTheBestSetEfficiency) {
  double before = 0.0;
  for (std::size_t i = 0; i < kRefinementLimits_arcmin.size(); ++i) {
    const optimize::RefinedSet* best = best_refined(figures(), i);
    ASSERT_NE(best, nullptr);
    EXPECT_GE(best->eta_b, before);
    before = best->eta_b;
  }
}

const FigureMapPoint* point_at(const FigureMap& map, double x, double y) {
  for (std::size_t k = 0; k < map.points.size(); ++k) {
    if (map.x.values[k / map.rows()] != x) continue;
    if (map.y && map.y->values[k % map.rows()] != y) continue;
    return &map.points[k];
  }
  return nullptr;
}

TEST(PaperFigures, ThePublishedPointOfEachMapIsWhatAnalyzeSays) {
  const PaperFigures& f = figures();
  const design::Evaluation e =
      evaluation_of(design_text({14, 40, 94, 36, 92}, {0.59, 0.58}, {0.5, 0.0, 0.45, 0.4, 0.29},
                                mm(f.published_center_distance_m)));
  // Without allowance: the example that `analyze` shows.
  const auto example = std::get<design::Evaluation>(design::evaluate(io::parse_design(
      test::example("designs/low_backlash_prototype.toml"), "low_backlash_prototype.toml")));
  EXPECT_NEAR(f.published_center_distance_m, example.center_distance_m, 1e-15);
  struct Published {
    const FigureMap* map;
    double x, y;
  };
  for (const auto& [map, x, y] :
       {Published{&f.ring_shifts, 0.45, 0.29},
        Published{&f.modules, f.modules.x.published, f.modules.y->published},
        Published{&f.planet_shift, 0.0, 0.0}}) {
    const FigureMapPoint* p = point_at(*map, x, y);
    ASSERT_NE(p, nullptr);
    EXPECT_EQ(p->status, "ok");
    EXPECT_NEAR(p->eta_b, *e.efficiency.backward, kRounding);
    EXPECT_NEAR(p->eta_b, *example.efficiency.backward, kRounding);
    EXPECT_NEAR(p->eta_f, *example.efficiency.forward, kRounding);
    EXPECT_NEAR(p->paper_rad, e.lost_motion.paper_rad, kRounding);
    EXPECT_NEAR(p->kinematic_rad, e.lost_motion.kinematic_rad, kRounding);
  }
  EXPECT_NEAR(mm(f.modules.x.published), 0.59, 1e-15);
  EXPECT_NEAR(mm(f.modules.y->published), 0.58, 1e-15);
}

// Eq. 14: at a fixed distance a ring's shift opens its mesh by 2 m sin(alpha) per unit, eq. 16
// divides by cos(alpha) and the reference radius m zR/2, eq. 17 takes the larger of both meshes.
TEST(PaperFigures, RingShiftsMoveTheLostMotionByTheSlopesOfEqs14To17) {
  const FigureMap& map = figures().ring_shifts;
  const double slope1 = 4.0 * std::tan(20.0 * std::numbers::pi / 180.0) / 94.0;
  const double slope2 = 4.0 * std::tan(20.0 * std::numbers::pi / 180.0) / 92.0;
  std::size_t by1 = 0;
  std::size_t by2 = 0;
  for (std::size_t i = 0; i + 1 < map.x.values.size(); ++i) {
    for (std::size_t j = 0; j + 1 < map.rows(); ++j) {
      const FigureMapPoint& p = map.points[i * map.rows() + j];
      const FigureMapPoint& right = map.points[(i + 1) * map.rows() + j];
      const FigureMapPoint& above = map.points[i * map.rows() + j + 1];
      if (p.status != "ok" || right.status != "ok" || above.status != "ok") continue;
      const double dx = (right.paper_rad - p.paper_rad) / (map.x.values[i + 1] - map.x.values[i]);
      const double dy = (above.paper_rad - p.paper_rad) / (map.y->values[j + 1] - map.y->values[j]);
      const double share1 = dx / slope1;
      const double share2 = dy / slope2;
      // Each in [0, 1], and 1 for the mesh that is the larger one on the whole step.
      EXPECT_GE(share1, -1e-9);
      EXPECT_LE(share1, 1.0 + 1e-9);
      EXPECT_GE(share2, -1e-9);
      EXPECT_LE(share2, 1.0 + 1e-9);
      by1 += share1 > 1.0 - 1e-9 ? 1U : 0U;
      by2 += share2 > 1.0 - 1e-9 ? 1U : 0U;
    }
  }
  EXPECT_GT(by1, 100U);
  EXPECT_GT(by2, 100U);
}

TEST(PaperFigures, InfeasiblePointsNameTheirCheckAndAreBlankInTheCsv) {
  std::size_t blank = 0;
  for (const FigureData& data : figure_data(figures())) {
    if (!data.name.starts_with("fig8")) continue;
    const io::CsvTable table = io::parse_csv(data.csv, data.name);
    for (const auto& row : table.rows) {
      const bool ok = table.text(row, "status") == "ok";
      EXPECT_TRUE(table.text(row, "status").has_value());
      for (const char* column : {"eta_b", "eta_f", "backlash_arcmin", "kinematic_arcmin"}) {
        EXPECT_EQ(table.number(row, column).has_value(), ok) << data.name << ' ' << row.line;
      }
      blank += ok ? 0U : 1U;
    }
  }
  EXPECT_GT(blank, 0U);
  // At a fixed distance a larger module of stage 1 brings sun and planet into interference.
  const FigureMap& map = figures().modules;
  const FigureMapPoint* p = point_at(map, map.x.values.back(), map.y->published);
  ASSERT_NE(p, nullptr);
  EXPECT_EQ(p->status, "normal_backlash S-P1");
}

TEST(PaperFigures, TheDataSayWhatIsHeldFixedAndWhatThePaperLeavesOpen) {
  for (const FigureData& data : figure_data(figures())) {
    const io::CsvTable table = io::parse_csv(data.csv, data.name);
    const std::string notes =
        std::accumulate(table.notes.begin(), table.notes.end(), std::string());
    EXPECT_NE(notes.find("The paper leaves open"), std::string::npos) << data.name;
    if (!data.name.starts_with("fig8")) continue;
    EXPECT_NE(notes.find("the centre distance 16.1813 mm"), std::string::npos) << data.name;
  }
}

TEST(PaperFigures, AMapWithoutAFeasiblePointIsStillAFigure) {
  PaperFigures none = figures();
  for (FigureMap* map : {&none.ring_shifts, &none.modules, &none.planet_shift}) {
    for (FigureMapPoint& p : map->points) p.status = "undefined";
  }
  none.scatter.points.clear();
  none.refined.clear();
  EXPECT_EQ(figure_plots(none).size(), 5U);
  EXPECT_EQ(figure_data(none).size(), 5U);
  EXPECT_NE(figures_table(none).find("no module is feasible"), std::string::npos);
}

}  // namespace
}  // namespace gear3k::papers::paper_figures_test
