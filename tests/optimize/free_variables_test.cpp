// Variables that a task may open: tips, pressure angle, shifts of the rings.

#include <gtest/gtest.h>

#include <numbers>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/gradients.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/starting_points.hpp"

namespace gear3k::optimize::free_variables_test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const Candidate kWinner{.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118}, .planets = 3};

Specification reference_problem() {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
}

/// Five tip shortenings and the pressure angle, 14 variables with both modules in ranges.
Specification everything_free() {
  Specification spec = reference_problem();
  spec.module[0].range_m = NumberRange{0.5e-3, 2e-3};
  spec.rack.addendum = 1.2;
  spec.free = {.tip_shortening = NumberRange{0.0, 0.4},
               .pressure_angle_rad = NumberRange{15.0 * kDegree, 28.0 * kDegree},
               .face_width_m = {}};
  spec.ring_shift = NumberRange{0.0, 2.0};
  return spec;
}

TEST(FreeVariables, GradientsOfFourteenVariablesAreCentralDifferences) {
  const Specification spec = everything_free();
  const RefinementProblem p = make_refinement_problem(spec, kWinner, {std::nullopt, std::nullopt});
  constexpr std::size_t kVariables = 14;
  ASSERT_EQ(p.variables, static_cast<int>(kVariables));
  Point v = starting_points(p, 1, 1).front();
  for (std::size_t k = 0; k < kVariables; ++k) {
    v[k] = std::clamp(v[k], p.lower[k] + 0.01, p.upper[k] - 0.01);
  }
  Gradients at;
  ASSERT_TRUE(evaluate_gradients(p, v, all_rows(p), at));
  constexpr double kStep = 1e-6;
  std::vector<double> low(p.rows.size()), high(p.rows.size());
  for (std::size_t j = 0; j < kVariables; ++j) {
    Point moved = v;
    moved[j] = v[j] - kStep;
    const auto f_low = evaluate<double>(p, used(p, moved), low);
    moved[j] = v[j] + kStep;
    const auto f_high = evaluate<double>(p, used(p, moved), high);
    ASSERT_TRUE(f_low && f_high);
    // Rounding eps/step and truncation step² of functions of order 10.
    EXPECT_NEAR(at.df[j], (*f_high - *f_low) / (2.0 * kStep), 1e-8) << j;
    for (std::size_t k = 0; k < p.rows.size(); ++k) {
      EXPECT_NEAR(at.dg[k * kVariables + j], (high[k] - low[k]) / (2.0 * kStep), 1e-6)
          << p.rows[k].name << " by variable " << j;
    }
  }
}

TEST(FreeVariables, SlsqpAndIpoptAgree) {
  Specification spec = everything_free();
  const RefinedSet slsqp = refine(spec, kWinner);
  spec.solver.refine = Refine::kIpopt;
  spec.solver.starts = 2;
  const RefinedSet ipopt = refine(spec, kWinner);
  ASSERT_EQ(slsqp.status, Status::kOptimal);
  ASSERT_EQ(ipopt.status, Status::kOptimal);
  EXPECT_NEAR(slsqp.eta_b, ipopt.eta_b, 2e-6);
}

/// The design as its file says it, analysed.
design::Evaluation read_back(const Specification& spec, const RefinedSet& set) {
  const design::Design design =
      io::parse_design(io::design_text(design_of(spec, set)), "best.toml");
  return std::get<design::Evaluation>(design::evaluate(design));
}

TEST(FreeVariables, AddendaFarBelowTheGreatestAreStatedWithinTheKeys) {
  Specification spec = reference_problem();
  spec.rack.addendum = 2.0;
  spec.free.tip_shortening = NumberRange{0.0, 1.8};
  spec.rack.dedendum = 1.25;
  for (const double most : {1.4, 1.5, 1.5676}) {
    RefinedSet set;
    set.candidate = kWinner;
    set.train = {.profile_shift = {0.5, 0.5, 0.5, 0.5, 0.5},
                 .module_m = {1e-3, 0.93e-3},
                 .center_distance_m = 33.5e-3,
                 .tip_shortening = {},
                 .pressure_angle_rad = 20.0 * kDegree};
    set.train.tip_shortening = {0.8, 0.9, most, 1.1, 1.2};
    const design::Design design = design_of(spec, set);
    const design::Design read = io::parse_design(io::design_text(design), "best.toml");
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      const double addendum = spec.rack.addendum - set.train.tip_shortening[i];
      EXPECT_DOUBLE_EQ(read.train.rack[i].addendum - read.train.tip_shortening[i], addendum) << i;
      if (most > 1.5) continue;
      EXPECT_EQ(read.train.tip_shortening[i], set.train.tip_shortening[i]) << i;
    }
  }
}

TEST(FreeVariables, MoreFreedomIsNeverWorseAndKeepsEveryLimit) {
  double fixed = 0.0;
  for (int variant = 0; variant < 4; ++variant) {
    Specification spec = reference_problem();
    if (variant == 1) spec.ring_shift = NumberRange{0.0, 2.0};
    if (variant >= 2) {
      spec.rack.addendum = 1.2;
      spec.free.tip_shortening = NumberRange{0.0, 0.4};
    }
    if (variant == 3) spec.free.pressure_angle_rad = NumberRange{15.0 * kDegree, 28.0 * kDegree};
    const RefinedSet set = refine(spec, kWinner);
    ASSERT_EQ(set.status, Status::kOptimal) << variant;
    if (variant == 0) {
      fixed = set.eta_b;
    } else {
      EXPECT_GT(set.eta_b, fixed + 1e-3) << variant;
    }
    const design::Evaluation e = read_back(spec, set);
    EXPECT_NEAR(*e.efficiency.backward, set.eta_b, 1e-12);
    for (const design::CheckResult& c : e.checks) {
      EXPECT_TRUE(c.ok) << variant << " " << c.record->name << " " << c.margin;
    }
    for (std::size_t i = 0; i < train::kGearCount; ++i) {
      EXPECT_GE(set.train.tip_shortening[i], 0.0);
      EXPECT_LE(set.train.tip_shortening[i], variant >= 2 ? 0.4 : 0.0);
    }
  }
}

TEST(FreeVariables, BoundsHoldWithFreeTipsAndBestOnlyFindsTheSameDesign) {
  Specification spec = reference_problem();
  spec.teeth.S = {.min = 12, .max = 12};
  spec.rack.addendum = 1.2;
  spec.free.tip_shortening = NumberRange{0.0, 0.4};
  spec.ring_shift = NumberRange{0.0, 1.5};
  Progress progress;
  const OptimizeResult all = optimize(spec, progress);
  const OptimizeResult best = optimize(spec, progress, {.best_only = true});
  for (const RefinedSet& set : all.refined) {
    if (set.status != Status::kOptimal) continue;
    EXPECT_LE(set.eta_b, all.bounds->of(set.index).eta_b);
    EXPECT_LE(set.eta_b, all.bounds->sharpened(set.index).eta_b);
  }
  ASSERT_TRUE(all.best && best.best);
  EXPECT_EQ(all.best->candidate, best.best->candidate);
  EXPECT_EQ(all.best->eta_b, best.best->eta_b);
  EXPECT_LT(best.refined.size(), all.refined.size());
}

TEST(FreeVariables, APressureAngleHasNoBoundsAndBestOnlyIsRefused) {
  const Specification spec = everything_free();
  Progress progress;
  EXPECT_THROW(optimize(spec, progress, {.best_only = true}), std::invalid_argument);
  const std::array one{kWinner};
  const SetBound bound = SetBounds(spec, one, progress).of(0);
  EXPECT_FALSE(bound.known);
  EXPECT_EQ(bound.eta_b, 1.0);
}

}  // namespace
}  // namespace gear3k::optimize::free_variables_test
