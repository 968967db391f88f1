#include "optimize/refinement_problem.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>
#include <random>

#include "io/files/specification_file.hpp"
#include "optimize/kkt_residual.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/solve_outcome.hpp"
#include "optimize/starting_points.hpp"
#include "tests/optimize/rp96_problem.hpp"

namespace gear3k::optimize::refinement_problem_test {
namespace {

Specification rp96_specification() {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
}

/// Every way in which modules can be given, the lost-motion models and the objectives.
struct Variant {
  const char* name;
  std::array<std::optional<double>, 2> fixed_module_m;
  backlash::LostMotionModel model;
  efficiency::LossModel loss;
  Objective objective;
  double ratio;
  bool workshop = false;  ///< sliding, lengths, walls, whole size
  bool same_module = false;
};

class RefinementProblemOf : public testing::TestWithParam<Variant> {
 protected:
  RefinementProblemOf() : spec_(rp96_specification()) {
    const Variant& v = GetParam();
    for (std::size_t stage = 0; stage < 2; ++stage) {
      spec_.module[stage] = {};
      if (v.fixed_module_m[stage]) {
        spec_.module[stage].series_m = {*v.fixed_module_m[stage]};
      } else {
        spec_.module[stage].range_m = NumberRange{0.4e-3, 2e-3};
      }
    }
    spec_.limits.model = v.model;
    spec_.limits[design::CheckId::kOutputBacklashMin] = units::to_si(1.0, units::Unit::kArcmin);
    spec_.limits[design::CheckId::kRingRootDiameter] = 0.12;
    spec_.limits[design::CheckId::kRingTipThickness] = 0.2;
    spec_.machining_allowance.fill(0.02);
    if (v.workshop) add_workshop_limits();
    if (v.same_module) spec_.limits[design::CheckId::kSameModule] = 0.0;
    spec_.friction.model = v.loss;
    spec_.felt = FeltTask{.rotor_inertia_kgm2 = 2e-6,
                          .coulomb_Nm = 0.001,
                          .static_Nm = 0.002,
                          .load_inertia_kgm2 = 0.001,
                          .transparency_torque_Nm = 3.0,
                          .limits = {{FeltQuantity::kInertia, 0.03},
                                     {FeltQuantity::kBreakaway, 0.25},
                                     {FeltQuantity::kTransparency, 0.3}},
                          .sources = {}};
    spec_.objectives = {v.objective};
    spec_.ratio.target = v.ratio;
    Progress progress;
    const auto candidates = search_teeth(spec_, progress).candidates;
    for (std::size_t k = 0; k < candidates.size(); k += 1 + candidates.size() / 25) {
      problems_.push_back(make_refinement_problem(spec_, candidates[k], v.fixed_module_m));
    }
  }

  void add_workshop_limits() {
    using design::CheckId;
    spec_.limits[CheckId::kSpecificSliding] = 3.0;
    spec_.limits[CheckId::kTipThicknessLength] = 0.2e-3;
    spec_.limits[CheckId::kRootClearanceLength] = 0.1e-3;
    spec_.limits[CheckId::kSunRootDiameter] = 8e-3;
    spec_.limits[CheckId::kGearboxDiameter] = 0.13;
    spec_.limits[CheckId::kGearboxLength] = 0.02;
    spec_.limits[CheckId::kWall] = 1e-3;
    spec_.bodies.bore_radius_m = {2e-3, 4e-3, 0.0, 4e-3, 0.0};
    spec_.bodies.ring_rim_m = 2e-3;
    spec_.bodies.density_kgm3 = 7850.0;
    spec_.bodies.face_width_m = {8e-3, 8e-3};
    // No more variables than a jet of these tests has.
    if (GetParam().same_module) {
      spec_.free.face_width_m[1] = NumberRange{.min = 8e-3, .max = 14e-3};
    }
    spec_.objective_limits = {{.objective = Objective::kMass, .value = 3.0}};
    spec_.limits.mesh_backlash_m[train::kMeshP2R2] = 5e-6;
  }

  Specification spec_;
  std::vector<RefinementProblem> problems_;
};

TEST_P(RefinementProblemOf, IsDefinedEverywhereInItsBox) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  ASSERT_GT(problems_.size(), 10U);
  for (const RefinementProblem& p : problems_) {
    std::vector<double> g(p.rows.size());
    for (int trial = 0; trial < 200; ++trial) {
      Point v{};
      for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
        const double u = trial < 2 ? trial : unit(random);
        v[k] = p.lower[k] + u * (p.upper[k] - p.lower[k]);
      }
      EXPECT_TRUE(evaluate<double>(p, used(p, v), g));
      for (const double value : g) EXPECT_TRUE(std::isfinite(value));
    }
  }
}

/// Number of pairs in contact on either side of each pitch point: where it changes, the loss model
/// sliding has a jump in its second derivative, which differences across it cannot show.
std::vector<int> contact_cell(const RefinementProblem& p, const Point& v) {
  const auto n = static_cast<std::size_t>(p.variables);
  const auto train =
      train::make_train_geometry(parameters_at<double>(p, std::span<const double>(v.data(), n)));
  std::vector<int> cell;
  for (const auto& mesh : train->meshes) {
    for (const double share :
         {mesh.addendum_contact_ratio1, mesh.addendum_contact_ratio2, mesh.contact_ratio}) {
      cell.push_back(static_cast<int>(std::floor(share)));
    }
  }
  return cell;
}

TEST_P(RefinementProblemOf, GradientsAndHessiansEqualCentralDifferences) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst_gradient = 0.0;
  double worst_hessian = 0.0;
  int compared = 0;
  for (const RefinementProblem& p : problems_) {
    const auto n = static_cast<std::size_t>(p.variables);
    Point v = starting_points(p, 1, 1).front();
    for (std::size_t k = 0; k < n; ++k) {
      v[k] = std::clamp(v[k] + 0.02 * unit(random), p.lower[k] + 0.01, p.upper[k] - 0.01);
    }
    std::array<Jet2, kMostUnknowns> jets;
    for (std::size_t k = 0; k < n; ++k) jets[k] = Jet2::variable(v[k], k);
    std::vector<Jet2> g(p.rows.size());
    const auto f = evaluate<Jet2>(p, used(p, jets), g);
    ASSERT_TRUE(f);
    const auto jet1_at = [&](const Point& at) {
      std::array<Jet1, kMostUnknowns> jets1;
      for (std::size_t k = 0; k < n; ++k) jets1[k] = Jet1(at[k], static_cast<int>(k));
      std::vector<Jet1> values(p.rows.size() + 1);
      values.back() =
          evaluate<Jet1>(p, used(p, jets1), std::span<Jet1>(values.data(), p.rows.size())).value();
      return values;
    };
    g.push_back(*f);
    constexpr double kStep = 1e-3;
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<std::vector<Jet1>> at;  // at v - 2h, v - h, v + h, v + 2h
      bool smooth = true;
      for (const double steps : {-2.0, -1.0, 1.0, 2.0}) {
        Point moved = v;
        moved[k] += steps * kStep;
        smooth = smooth && contact_cell(p, moved) == contact_cell(p, v);
        at.push_back(jet1_at(moved));
      }
      if (!smooth) continue;
      ++compared;
      const auto difference = [&](auto of) {
        return (of(at[0]) - 8.0 * of(at[1]) + 8.0 * of(at[2]) - of(at[3])) / (12.0 * kStep);
      };
      for (std::size_t row = 0; row < g.size(); ++row) {
        const double slope = difference([&](const auto& jets1) { return jets1[row].a; });
        worst_gradient = std::max(worst_gradient,
                                  std::abs(slope - g[row].by_column[k]) / (1.0 + std::abs(slope)));
        for (std::size_t l = 0; l < n; ++l) {
          const auto other = static_cast<Eigen::Index>(l);
          const double curvature =
              difference([&](const auto& jets1) { return jets1[row].v[other]; });
          worst_hessian = std::max(worst_hessian, std::abs(curvature - g[row].mixed[k][l]) /
                                                      (1.0 + std::abs(curvature)));
        }
      }
    }
  }
  // Truncation of five-point differences: step^4/30 times fifth (sixth) derivatives.
  EXPECT_GT(compared, 50);
  EXPECT_LT(worst_gradient, 1e-6);
  EXPECT_LT(worst_hessian, 1e-6);
}

constexpr auto kKinematic = backlash::LostMotionModel::kKinematic;
constexpr auto kPaper = backlash::LostMotionModel::kPaper;
constexpr auto kSliding = efficiency::LossModel::kSliding;
constexpr auto kOhlendorf = efficiency::LossModel::kOhlendorf;
constexpr auto kBackward = Objective::kBackwardEfficiency;
constexpr auto kForward = Objective::kForwardEfficiency;

INSTANTIATE_TEST_SUITE_P(
    ModulesAndModels, RefinementProblemOf,
    testing::Values(
        Variant{"BothFixed", {1e-3, 0.93e-3}, kKinematic, kOhlendorf, kBackward, 96.2},
        Variant{"Stage2Free", {1e-3, std::nullopt}, kPaper, kOhlendorf, kBackward, 96.2},
        Variant{"Stage1Free", {std::nullopt, 1e-3}, kKinematic, kSliding, kForward, 96.2},
        Variant{"BothFree", {std::nullopt, std::nullopt}, kPaper, kSliding, kBackward, 96.2},
        Variant{
            "OutputBackwards", {std::nullopt, std::nullopt}, kKinematic, kSliding, kForward, -96.2},
        Variant{
            "Workshop", {std::nullopt, std::nullopt}, kKinematic, kSliding, kBackward, 96.2, true},
        Variant{"OneModule",
                {std::nullopt, std::nullopt},
                kKinematic,
                kSliding,
                kBackward,
                96.2,
                true,
                true}),
    [](const auto& variant) { return std::string(variant.param.name); });

TEST(RefinementProblem, ViolationIsInfiniteWhereverAConstraintIsNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& g :
       {std::array{nan, -3.0, 2.0}, std::array{-3.0, nan, 2.0}, std::array{0.5, 2.0, nan}}) {
    EXPECT_EQ(worst_violation(g), std::numeric_limits<double>::infinity());
  }
  EXPECT_EQ(worst_violation(std::array{0.5, -3.0, 2.0}), 3.0);
  EXPECT_EQ(worst_violation(std::array{0.5, 2.0}), 0.0);
}

// Of a mesh that would lose more than its power the closed form says nothing.
TEST(RefinementProblem, HasNoOutcomeWhereOhlendorfLeavesAMeshNoPower) {
  Specification spec = rp96_specification();
  Progress progress;
  const auto candidates = search_teeth(spec, progress).candidates;
  const auto violation = [&](efficiency::LossModel model, double coefficient) {
    spec.friction.model = model;
    spec.friction.coefficient = coefficient;
    const RefinementProblem p = make_refinement_problem(spec, candidates.front(), {});
    return outcome_at(p, p.lower).violation;
  };
  // 1 - pi (1/z1 + 1/z2) mu Lambda is below 0 at S-P1 for mu = 10, as Lambda is at least 1/2.
  ASSERT_GT(std::numbers::pi * (1.0 / candidates.front().teeth.S) * 10.0 * 0.5, 1.0);
  EXPECT_TRUE(std::isfinite(violation(kOhlendorf, 0.1)));
  EXPECT_EQ(violation(kOhlendorf, 10.0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(violation(kSliding, 10.0)));
}

TEST(RefinementProblem, AgreesWithRp96TypedAnew) {
  const Specification spec = rp96_specification();
  Progress progress;
  const auto candidates = search_teeth(spec, progress).candidates;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int feasible = 0;
  for (std::size_t c = 0; c < candidates.size(); c += 3) {
    const RefinementProblem p = make_refinement_problem(spec, candidates[c], {1e-3, std::nullopt});
    for (int trial = 0; trial < 20; ++trial) {
      // Half of the points far from, half of them near a point inside the limits.
      const Point start = starting_points(p, 4, 1)[static_cast<std::size_t>(trial % 4)];
      const bool near = trial % 2 == 0;
      Point v = near ? least_violation(p, start, {}).v : start;
      for (std::size_t k = 0; k < 7; ++k) {
        const double spread = near ? 1e-3 : 0.05;
        v[k] = std::clamp(v[k] + spread * (unit(random) - 0.5), p.lower[k], p.upper[k]);
      }
      std::vector<double> g(p.rows.size());
      const auto f = evaluate<double>(p, used(p, v), g);
      ASSERT_TRUE(f);
      const auto t = parameters_at<double>(p, std::span<const double>(v.data(), 7));
      const auto& z = candidates[c].teeth;
      const rp96::Values expected =
          rp96::evaluate({z.S, z.P1, z.R1, z.P2, z.R2, v[0], v[1], v[2], v[3], v[4],
                          t.module_m[1] * 1e3, t.center_distance_m * 1e3});
      EXPECT_NEAR(-*f, expected.eta_b, 1e-12);
      const bool ours = *std::min_element(g.begin(), g.end()) >= 0.0;
      if (std::abs(expected.worst_margin) > 1e-9) {
        EXPECT_EQ(ours, expected.worst_margin >= 0.0);
      }
      feasible += ours ? 1 : 0;
    }
  }
  EXPECT_GT(feasible, 300) << "too few feasible points to compare";
}

TEST(RefinementProblem, KktResidualVanishesAtAnOptimumAndNotAtAStart) {
  const Specification spec = rp96_specification();
  const RefinementProblem p = make_refinement_problem(
      spec, {.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118}, .planets = 3},
      {1e-3, std::nullopt});
  const Point v = starting_points(p, 1, 1).front();
  EXPECT_GT(kkt_residual(p, v), 1e-3);
  const Point end = solve_slsqp(p, v, {}).v;
  EXPECT_LT(kkt_residual(p, end), 1e-6);
}

}  // namespace
}  // namespace gear3k::optimize::refinement_problem_test
