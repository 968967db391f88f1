// A search for gearboxes that run from cold to hot, and one whose thinning is a length.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/gradients.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/set_bounds.hpp"
#include "optimize/starting_points.hpp"
#include "tests/optimize/small_task.hpp"

namespace gear3k::optimize::thermal_search_test {
namespace {

/// Some tooth sets.
const std::string kTask = test::small_task({.S = {13, 14}, .P1 = {26, 30}, .P2 = {18, 24}}) +
                          R"([friction]
coefficient = 0.06
[backlash]
max_output_arcmin = 12.0
machining_allowance = 0.02
)";
/// Plastic gears in a carrier of metal; P1 and P2 take up water.
const std::string kThermal = R"([thermal]
temperature_c = [-30.0, 80.0]
S.expansion_1_k = 1.1e-5
P1 = { expansion_1_k = 9e-5, swelling = [0.0, 1e-3] }
R1.expansion_1_k = 7e-5
P2 = { expansion_1_k = 9e-5, swelling = [0.0, 1e-3] }
R2.expansion_1_k = 7e-5
carrier.expansion_1_k = 2.3e-5
)";

Specification task(const std::string& text) {
  Specification spec = io::parse_specification(text, "spec.toml");
  spec.solver.starts = 1;
  return spec;
}

design::Evaluation evaluated(const design::Design& design) {
  return std::get<design::Evaluation>(design::evaluate(design));
}

OptimizeResult run(const Specification& spec) {
  Progress progress;
  return optimize(spec, progress);
}

TEST(ThermalSearch, FindsDesignsThatHoldAtBothEndsWhereTheColdOnesDoNot) {
  const Specification hot = task(kTask + kThermal);
  const OptimizeResult found = run(hot);
  ASSERT_TRUE(found.best);
  const RefinedSet& best = *found.best;
  const design::Design design = io::as_written(design_of(hot, best));
  const design::Evaluation e = evaluated(design);
  EXPECT_TRUE(design::all_ok(e.checks));
  ASSERT_TRUE(e.thermal);
  double tightest_m = 1.0;
  for (const design::ThermalStateResult& at : e.thermal->states) {
    for (const design::ThermalMesh& mesh : at.meshes) {
      EXPECT_GE(mesh.least_backlash_m, -1e-9);
      tightest_m = std::min(tightest_m, mesh.least_backlash_m);
    }
  }

  const Specification cold = task(kTask);
  const OptimizeResult without = run(cold);
  ASSERT_TRUE(without.best);
  design::Design jams = design_of(cold, *without.best);
  jams.thermal = hot.thermal;
  jams.limits = hot.limits;
  EXPECT_FALSE(design::all_ok(evaluated(jams).checks));
  EXPECT_LE(best.eta_b, without.best->eta_b + 1e-9);
}

/// Gradients of all rows at a point inside the box.
void expect_gradients(const Specification& spec, const Candidate& candidate) {
  const RefinementProblem p =
      make_refinement_problem(spec, candidate, {std::nullopt, std::nullopt});
  const auto n = static_cast<std::size_t>(p.variables);
  Point v = starting_points(p, 1, 1).front();
  for (std::size_t k = 0; k < n; ++k) {
    v[k] = std::clamp(v[k], p.lower[k] + 0.01, p.upper[k] - 0.01);
  }
  Gradients at;
  ASSERT_TRUE(evaluate_gradients(p, v, all_rows(p), at));
  constexpr double kStep = 1e-6;
  std::vector<double> low(p.rows.size()), high(p.rows.size());
  for (std::size_t j = 0; j < n; ++j) {
    Point moved = v;
    moved[j] = v[j] - kStep;
    ASSERT_TRUE(evaluate<double>(p, used(p, moved), low));
    moved[j] = v[j] + kStep;
    ASSERT_TRUE(evaluate<double>(p, used(p, moved), high));
    for (std::size_t k = 0; k < p.rows.size(); ++k) {
      EXPECT_NEAR(at.dg[k * n + j], (high[k] - low[k]) / (2.0 * kStep), 1e-6)
          << p.rows[k].name << " by variable " << j;
    }
  }
}

TEST(ThermalSearch, HasARowForEachMeshAtEachEndWithItsGradient) {
  const Specification spec = task(kTask + kThermal + "[limits]\nthermal_lost_motion = 40.0\n");
  Progress progress;
  const auto candidates = search_teeth(spec, progress).candidates;
  ASSERT_FALSE(candidates.empty());
  const RefinementProblem p =
      make_refinement_problem(spec, candidates.front(), {std::nullopt, std::nullopt});
  std::map<std::string_view, int> rows;
  for (const ConstraintRow& row : p.rows) ++rows[row.name];
  EXPECT_EQ(rows["thermal_backlash"], 12);  // three meshes; cold and hot, dry and wet
  EXPECT_EQ(rows["thermal_root_clearance"], 24);
  EXPECT_EQ(rows["thermal_lost_motion"], 4);
  for (std::size_t k = 0; k < candidates.size(); k += 1 + candidates.size() / 3) {
    expect_gradients(spec, candidates[k]);
  }
}

std::string with_lengths() {
  std::string text = kTask;
  const std::string stated = "machining_allowance = 0.02\n";
  return text.replace(text.find(stated), stated.size(),
                      "S.A_sn_um = [-40.0, -20.0]\nP1.A_sn_um = [-50.0, -30.0]\n"
                      "R1.A_sn_um = [-50.0, -30.0]\nP2.A_sn_um = [-50.0, -30.0]\n"
                      "R2.A_sn_um = [-50.0, -30.0]\n");
}

TEST(ThinningByLength, HasGradientsByTheModuleAndNoBounds) {
  const Specification spec = task(with_lengths());
  EXPECT_FALSE(has_bounds(spec));
  Progress progress;
  const auto candidates = search_teeth(spec, progress).candidates;
  ASSERT_FALSE(candidates.empty());
  expect_gradients(spec, candidates.front());
}

TEST(ThinningByLength, IsWhatTheBestDesignStates) {
  const Specification spec = task(with_lengths());
  const OptimizeResult found = run(spec);
  ASSERT_TRUE(found.best);
  const design::Design design = io::as_written(design_of(spec, *found.best));
  EXPECT_TRUE(design::all_ok(evaluated(design).checks));
  const std::array<double, train::kGearCount> middle_um{30.0, 40.0, 40.0, 40.0, 40.0};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const double module_m =
        design.train.module_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(i)))];
    EXPECT_NEAR(design.train.machining_allowance[i] * module_m * 1e6,
                middle_um[i] * std::cos(design.train.pressure_angle_rad), 1e-9);
    EXPECT_TRUE(design.thickness_allowance_m[i]);
  }
}

}  // namespace
}  // namespace gear3k::optimize::thermal_search_test
