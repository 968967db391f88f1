#include "optimize/refinement_problem.hpp"

#include <gtest/gtest.h>

#include <random>

#include "io/specification_file.hpp"
#include "optimize/starting_points.hpp"
#include "tests/optimize/rp96_problem.hpp"

namespace gear3k::optimize {
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
    spec_.limits[design::CheckId::kOutputBacklashMin] =
        design::from_unit(1.0, design::Unit::kArcmin);
    spec_.limits[design::CheckId::kRingRootDiameter] = 0.12;
    spec_.limits[design::CheckId::kRingTipThickness] = 0.2;
    spec_.machining_allowance.fill(0.02);
    spec_.friction.model = v.loss;
    spec_.objective = v.objective;
    spec_.ratio.target = v.ratio;
    const std::atomic<bool> stop{false};
    const auto candidates = search_teeth(spec_, stop).candidates;
    for (std::size_t k = 0; k < candidates.size(); k += 1 + candidates.size() / 25) {
      problems_.push_back(make_refinement_problem(spec_, candidates[k], v.fixed_module_m, 1));
    }
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
      double f = 0.0;
      EXPECT_TRUE(evaluate<double>(
          p, std::span<const double>(v.data(), static_cast<std::size_t>(p.variables)), f, g));
      for (const double value : g) EXPECT_TRUE(std::isfinite(value));
    }
  }
}

TEST_P(RefinementProblemOf, GradientsAndHessiansEqualCentralDifferences) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst_gradient = 0.0;
  double worst_hessian = 0.0;
  for (const RefinementProblem& p : problems_) {
    const auto n = static_cast<std::size_t>(p.variables);
    Point v = starting_points(p, 1, 1).front();
    for (std::size_t k = 0; k < n; ++k) {
      v[k] = std::clamp(v[k] + 0.02 * unit(random), p.lower[k] + 0.01, p.upper[k] - 0.01);
    }
    std::array<Jet2, kMaxVariables> jets;
    for (std::size_t k = 0; k < n; ++k) {
      jets[k].a = Jet1(v[k], static_cast<int>(k));
      jets[k].v[static_cast<Eigen::Index>(k)] = Jet1(1.0);
    }
    Jet2 f;
    std::vector<Jet2> g(p.rows.size());
    ASSERT_TRUE(evaluate<Jet2>(p, std::span<const Jet2>(jets.data(), n), f, g));
    const auto jet1_at = [&](const Point& at) {
      std::array<Jet1, kMaxVariables> jets1;
      for (std::size_t k = 0; k < n; ++k) jets1[k] = Jet1(at[k], static_cast<int>(k));
      std::vector<Jet1> values(p.rows.size() + 1);
      EXPECT_TRUE(evaluate<Jet1>(p, std::span<const Jet1>(jets1.data(), n), values.back(),
                                 std::span<Jet1>(values.data(), p.rows.size())));
      return values;
    };
    g.push_back(f);
    constexpr double kStep = 1e-5;
    for (std::size_t k = 0; k < n; ++k) {
      Point up = v;
      Point down = v;
      up[k] += kStep;
      down[k] -= kStep;
      const auto high = jet1_at(up);
      const auto low = jet1_at(down);
      const auto axis = static_cast<Eigen::Index>(k);
      for (std::size_t row = 0; row < g.size(); ++row) {
        const double slope = (high[row].a - low[row].a) / (2.0 * kStep);
        const double scale = 1.0 + std::abs(slope);
        worst_gradient = std::max(worst_gradient, std::abs(slope - g[row].a.v[axis]) / scale);
        for (std::size_t l = 0; l < n; ++l) {
          const auto other = static_cast<Eigen::Index>(l);
          const double curvature = (high[row].v[other] - low[row].v[other]) / (2.0 * kStep);
          worst_hessian = std::max(worst_hessian, std::abs(curvature - g[row].v[axis].v[other]) /
                                                      (1.0 + std::abs(curvature)));
        }
      }
    }
  }
  // Truncation of central differences: step^2 times third (fourth) derivatives of order 10 to 1000
  // near small working angles.  The loss model sliding has jumps in its third derivative.
  EXPECT_LT(worst_gradient, 1e-6);
  EXPECT_LT(worst_hessian, 1e-5);
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
        Variant{"OutputBackwards",
                {std::nullopt, std::nullopt},
                kKinematic,
                kSliding,
                kForward,
                -96.2}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(RefinementProblem, AgreesWithRp96TypedAnew) {
  const Specification spec = rp96_specification();
  const std::atomic<bool> stop{false};
  const auto candidates = search_teeth(spec, stop).candidates;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int feasible = 0;
  for (std::size_t c = 0; c < candidates.size(); c += 3) {
    const RefinementProblem p =
        make_refinement_problem(spec, candidates[c], {1e-3, std::nullopt}, 1);
    for (int trial = 0; trial < 20; ++trial) {
      Point v = starting_points(p, 4, 1)[static_cast<std::size_t>(trial % 4)];
      for (std::size_t k = 0; k < 7; ++k) {
        v[k] = std::clamp(v[k] + 0.05 * (unit(random) - 0.5), p.lower[k], p.upper[k]);
      }
      double f = 0.0;
      std::vector<double> g(p.rows.size());
      ASSERT_TRUE(evaluate<double>(p, std::span<const double>(v.data(), 7), f, g));
      const auto t = parameters_at<double>(p, std::span<const double>(v.data(), 7));
      const auto& z = candidates[c].teeth;
      const rp96::Values expected =
          rp96::evaluate({z.S, z.P1, z.R1, z.P2, z.R2, v[0], v[1], v[2], v[3], v[4],
                          t.module_m[1] * 1e3, t.center_distance_m * 1e3});
      EXPECT_NEAR(-f, expected.eta_b, 1e-12);
      const bool ours = *std::min_element(g.begin(), g.end()) >= 0.0;
      if (std::abs(expected.worst_margin) > 1e-9) EXPECT_EQ(ours, expected.worst_margin >= 0.0);
      feasible += ours ? 1 : 0;
    }
  }
  EXPECT_GT(feasible, 50) << "too few feasible points to compare";
}

TEST(RefinementProblem, KktResidualIsZeroAtAnOptimumAndNotElsewhere) {
  const Specification spec = rp96_specification();
  // Away from every constraint the residual is the gradient itself.
  const RefinementProblem p = make_refinement_problem(
      spec, {.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118}, .planets = 3},
      {1e-3, std::nullopt}, 1);
  const Point v = starting_points(p, 1, 1).front();
  EXPECT_GT(kkt_residual(p, std::span<const double>(v.data(), 7)), 1e-3);
}

}  // namespace
}  // namespace gear3k::optimize
