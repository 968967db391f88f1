// Limits of what is felt at the output as constraints of a search: against η's own limits, random
// designs, and searches without bounds.
#include "optimize/felt_limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/files/specification_file.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"
#include "tests/random_numbers.hpp"

namespace gear3k::optimize::felt_limits_test {
namespace {

constexpr double kRotor_kgm2 = 2e-5, kStatic_Nm = 0.004;

Specification small_task(const std::string& more = "") {
  return io::parse_specification(
      "objective = \"outer_diameter\"\n[ratio]\ntarget = 45.0\ntolerance = 0.5\n"
      "[teeth]\nS = [14, 15]\nP1 = [29, 30]\nP2 = [30, 33]\nR1_max = 90\nR2_max = 90\n"
      "[module]\nstage1_mm = { min = 0.5, max = 0.8 }\nstage2_mm = { min = 0.5, max = 0.8 }\n"
      "[backlash]\nmax_output_arcmin = 12.0\nmin_normal_um = 5.0\nmachining_allowance = 0.02\n"
      "[friction]\ncoefficient = 0.1\n" +
          more,
      "task.toml");
}

FeltTask motor(std::vector<FeltLimit> limits) {
  return {.rotor_inertia_kgm2 = kRotor_kgm2,
          .coulomb_Nm = 0.8 * kStatic_Nm,
          .static_Nm = kStatic_Nm,
          .load_inertia_kgm2 = 0.002,
          .transparency_torque_Nm = 2.0,
          .limits = std::move(limits),
          .sources = {}};
}

/// What is felt with these efficiencies, from the two flows of a gear without mass.
struct FeltByHand {
  double inertia, breakaway, transparency;
};
FeltByHand felt_by_hand(double ratio, double eta_f, double eta_b) {
  const double i = std::abs(ratio), c1 = i * 0.8 * kStatic_Nm;
  const double with = eta_f * (2.0 - c1), against = (2.0 + c1) / eta_b;
  return {.inertia = 0.002 + i * i * kRotor_kgm2 / eta_b,
          .breakaway = i * kStatic_Nm / eta_b,
          .transparency = (against - with) / (0.5 * (against + with))};
}

OptimizeResult found(const Specification& spec, bool best_only) {
  Progress progress;
  return optimize(spec, progress, {.best_only = best_only});
}

TEST(FeltLimits, MarginsAreZeroWhereTheValueIsItsLimitAndMissesTellTheExcess) {
  RandomNumbers random(3);
  for (int k = 0; k < 200; ++k) {
    const double ratio = random.between(10.0, 90.0) * (k % 2 == 0 ? 1.0 : -1.0);
    const double eta_f = random.between(0.5, 1.0), eta_b = random.between(0.2, 1.0);
    const FeltByHand felt = felt_by_hand(ratio, eta_f, eta_b);
    const FeltGearbox<double> gearbox{.ratio = ratio, .forward = eta_f, .backward = eta_b};
    const std::array<double, 3> values{felt.inertia, felt.breakaway, felt.transparency};
    for (const FeltRecord& record : kFeltRecords) {
      const double value = values.at(static_cast<std::size_t>(record.quantity));
      FeltLimit limit{.quantity = record.quantity, .value = value};
      const FeltTask task = motor({limit});
      EXPECT_NEAR(felt_margin(task, limit, gearbox), 0.0, 1e-13) << record.name;
      const double h = 1e-5 * value;
      FeltLimit more = limit, less = limit;
      more.value += h;
      less.value -= h;
      EXPECT_NEAR(felt_slope(limit) * value,
                  (felt_margin(task, more, gearbox) - felt_margin(task, less, gearbox)) / (2e-5),
                  1e-7)
          << record.name;
      limit.value *= 0.7;
      const double g = felt_margin(task, limit, gearbox);
      EXPECT_LT(g, 0.0);
      EXPECT_NEAR(felt_miss(task, limit, -g), value - limit.value, 1e-11 * value) << record.name;
    }
  }
}

// With one ratio the limits are limits of η_b, which the objective limits hold by themselves.
TEST(FeltLimits, FindTheDesignThatALimitOfTheEfficiencyFinds) {
  Specification spec = small_task();
  spec.teeth.S = {.min = 15, .max = 15};
  spec.teeth.P1 = {.min = 30, .max = 30};
  spec.teeth.P2 = {.min = 32, .max = 32};
  const OptimizeResult free = found(spec, false);
  ASSERT_TRUE(free.best);
  const double ratio = train::ratio(free.best->candidate.teeth);
  const double wanted = free.best->eta_b + 0.02;
  const FeltByHand felt = felt_by_hand(ratio, 1.0, wanted);
  Specification by_efficiency = spec;
  by_efficiency.objective_limits = {{.objective = Objective::kBackwardEfficiency, .value = wanted}};
  const OptimizeResult expected = found(by_efficiency, false);
  for (const FeltLimit& limit : {FeltLimit{FeltQuantity::kInertia, felt.inertia},
                                 FeltLimit{FeltQuantity::kBreakaway, felt.breakaway}}) {
    Specification limited = spec;
    limited.felt = motor({limit});
    const OptimizeResult result = found(limited, false);
    ASSERT_TRUE(result.best);
    ASSERT_TRUE(expected.best);
    EXPECT_GE(result.best->eta_b, wanted - 2e-6);
    EXPECT_NEAR(objective_of(spec, *result.best, Objective::kOuterDiameter),
                objective_of(spec, *expected.best, Objective::kOuterDiameter), 2e-9)
        << felt_record(limit.quantity).name;
  }
}

/// The three limits so that about half of what the sets reach is refused.
Specification limited_task() {
  Specification spec = small_task();
  const OptimizeResult free = found(spec, false);
  std::vector<double> inertia;
  for (const RefinedSet& set : free.refined) {
    if (set.status != Status::kOptimal) continue;
    inertia.push_back(
        felt_by_hand(train::ratio(set.candidate.teeth), set.eta_f, set.eta_b).inertia);
  }
  std::ranges::sort(inertia);
  const RefinedSet& best = *free.best;
  const FeltByHand felt = felt_by_hand(train::ratio(best.candidate.teeth), best.eta_f, best.eta_b);
  spec.felt = motor({{FeltQuantity::kInertia, inertia.at(inertia.size() / 2)},
                     {FeltQuantity::kBreakaway, 1.02 * felt.breakaway},
                     {FeltQuantity::kTransparency, 0.99 * felt.transparency}});
  return spec;
}

TEST(FeltLimits, BoundsLoseNothingAndRandomDesignsAreNoBetter) {
  const Specification spec = limited_task();
  const OptimizeResult all = found(spec, false), certified = found(spec, true);
  ASSERT_TRUE(all.best);
  ASSERT_TRUE(certified.best);
  const double best = objective_of(spec, *all.best, Objective::kOuterDiameter);
  EXPECT_NEAR(objective_of(spec, *certified.best, Objective::kOuterDiameter), best, 2e-9);
  // Every optimum keeps the limits, by hand.
  const auto& limits = spec.felt->limits;
  int optima = 0, ruled_out = 0;
  for (const RefinedSet& set : all.refined) {
    if (set.status != Status::kOptimal) continue;
    ++optima;
    const FeltByHand felt = felt_by_hand(train::ratio(set.candidate.teeth), set.eta_f, set.eta_b);
    EXPECT_LE(felt.inertia, limits[0].value * (1.0 + 2e-6));
    EXPECT_LE(felt.breakaway, limits[1].value * (1.0 + 2e-6));
    EXPECT_LE(felt.transparency, limits[2].value * (1.0 + 2e-6));
  }
  // A set that bounds rule out has no design among random ones, nor by a solver without bounds.
  RandomNumbers random(11);
  int feasible_designs = 0;
  for (std::size_t k = 0; k < all.search.candidates.size(); ++k) {
    const auto proof = all.bounds->of(k).infeasible;
    const bool by_felt = proof && proof->felt;
    if (by_felt) ++ruled_out;
    const RefinementProblem p =
        make_refinement_problem(spec, all.search.candidates[k], {std::nullopt, std::nullopt});
    const SolveOutcome solved =
        by_felt ? solve_slsqp(p, starting_points(p, 1, 1).front(), {}) : SolveOutcome{};
    if (by_felt) {
      EXPECT_GT(solved.violation, design::kFeasibilityTolerance) << k;
    }
    std::vector<double> g(p.rows.size());
    for (int trial = 0; trial < 30; ++trial) {
      Point v{};
      for (std::size_t j = 0; j < static_cast<std::size_t>(p.variables); ++j) {
        v[j] = random.between(p.lower[j], p.upper[j]);
      }
      const auto f = evaluate<double>(p, used(p, v), g);
      if (!f || worst_violation(g) > 0.0) continue;
      ++feasible_designs;
      EXPECT_FALSE(proof) << k;
      EXPECT_GE(*f * p.objective_scale, best - 1e-9) << k;
    }
  }
  EXPECT_GT(optima, 3);
  EXPECT_GT(ruled_out, 2);
  RecordProperty("feasible_random_designs", feasible_designs);
}

TEST(FeltLimits, WithGearsOfMassTheirInertiaCounts) {
  Specification spec = small_task();
  spec.bodies.density_kgm3 = 7800.0;
  spec.bodies.ring_rim_m = 3e-3;
  spec.bodies.face_width_m = {8e-3, 8e-3};
  spec.teeth.S = {.min = 15, .max = 15};
  spec.teeth.P1 = {.min = 30, .max = 30};
  spec.teeth.P2 = {.min = 32, .max = 32};
  ASSERT_TRUE(knows_masses(spec));
  const OptimizeResult free = found(spec, false);
  ASSERT_TRUE(free.best);
  const double ratio = train::ratio(free.best->candidate.teeth);
  const double motor_alone = felt_by_hand(ratio, 1.0, free.best->eta_b).inertia;
  // A limit that the motor keeps alone and the gears, of at least 40 % of their lossless inertia
  // with any sign of losses, do not.
  spec.felt = motor({{FeltQuantity::kInertia, motor_alone + 0.4 * free.best->inertia_kgm2}});
  const OptimizeResult result = found(spec, false);
  if (result.best) {
    EXPECT_GT(result.best->eta_b, free.best->eta_b);
  }
  const OptimizeResult certified = found(spec, true);
  EXPECT_EQ(certified.best.has_value(), result.best.has_value());
}

TEST(FeltLimits, NameWhatBlocksWithItsAmount) {
  Specification spec = small_task();
  spec.felt = motor({{FeltQuantity::kBreakaway, 0.01}});
  const OptimizeResult result = found(spec, false);
  EXPECT_FALSE(result.best);
  ASSERT_GT(result.search.candidates.size(), 0U);
  for (std::size_t k = 0; k < result.search.candidates.size(); ++k) {
    const auto set = set_at(result, k);
    ASSERT_TRUE(set);
    ASSERT_FALSE(set->blocked_by.empty());
    const auto felt = std::ranges::find(set->blocked_by, "breakaway", &Miss::name);
    if (felt == set->blocked_by.end()) continue;  // other limits leave it nothing either
    const double i = std::abs(train::ratio(set->candidate.teeth));
    EXPECT_GE(felt->amount, i * kStatic_Nm - 0.01);
    EXPECT_LE(felt->amount, i * kStatic_Nm / 0.5 - 0.01);
    EXPECT_EQ(felt->unit, "N m");
  }
}

}  // namespace
}  // namespace gear3k::optimize::felt_limits_test
