// Designs rounded to what is made against every point of the lattice.

#include "optimize/rounding.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <iostream>

#include "design/evaluation.hpp"
#include "optimize/limit_prices.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/refine.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::rounding_test {
namespace {

/// Multiples of a step within a range, both ends with a hair of room.
std::vector<double> multiples(double step, double least, double most) {
  std::vector<double> values;
  for (long k = std::lround(std::ceil(least / step - 1e-7));
       static_cast<double>(k) <= most / step + 1e-7; ++k) {
    values.push_back(static_cast<double>(k) * step);
  }
  return values;
}

struct Lattice {
  std::vector<double> m1, m2, shift, ring_shift;
};

double center_distance_at(const RefinementProblem& problem, double angle_rad) {
  Point v = problem.lower;
  v[kAngleA] = angle_rad;
  return parameters_at(problem, used(problem, v)).center_distance_m;
}

/// The best objective of all points of the lattice [SI, to be minimised]; empty: none is feasible.
std::optional<double> best_of_all(const Specification& spec, const RefinedSet& set,
                                  const Lattice& lattice) {
  std::optional<double> best;
  std::vector<double> g;
  for (const double m1 : lattice.m1) {
    for (const double m2 : lattice.m2) {
      if (has_same_module(spec) && std::abs(m1 - m2) > 1e-9) continue;
      Specification own = spec;
      const std::array<double, 2> module{m1, m2};
      for (std::size_t stage = 0; stage < 2; ++stage) {
        own.module[stage] = {.range_m = NumberRange{.min = module[stage], .max = module[stage]},
                             .series_m = {}};
      }
      for (const std::size_t gear : {train::kS, train::kP1, train::kR1, train::kP2, train::kR2}) {
        const double m = gear == train::kP2 || gear == train::kR2 ? m2 : m1;
        own.machining_allowance[gear] =
            std::round(spec.machining_allowance[gear] * m / spec.round.allowance_m) *
            spec.round.allowance_m / m;
      }
      const RefinementProblem problem = make_refinement_problem(own, set.candidate, {m1, m2});
      g.resize(problem.rows.size());
      RefinedSet point = set;
      point.train.module_m = module;
      const auto distances = multiples(spec.round.center_distance_m,
                                       center_distance_at(problem, problem.lower[kAngleA]),
                                       center_distance_at(problem, problem.upper[kAngleA]));
      for (const double d : distances) {
        point.train.center_distance_m = d;
        for (const double s : lattice.shift) {
          for (const double p1 : lattice.shift) {
            for (const double r1 : lattice.ring_shift) {
              for (const double p2 : lattice.shift) {
                for (const double r2 : lattice.ring_shift) {
                  point.train.profile_shift = {s, p1, r1, p2, r2};
                  if (r1 < problem.lower[2] - 1e-9 || r2 < problem.lower[4] - 1e-9) continue;
                  const Point v = point_of(problem, train_of(own, point), {});
                  const auto f = evaluate<double>(problem, used(problem, v), g);
                  if (!f || worst_violation(g) > design::kFeasibilityTolerance) continue;
                  const double value = *f * problem.objective_scale;
                  if (!best || value < *best) best = value;
                }
              }
            }
          }
        }
      }
    }
  }
  return best;
}

/// A task with few shifts, and a step of the modules where one is in a range.
Specification coarse(Specification spec) {
  spec.profile_shift = {.min = -0.1, .max = 0.5};
  spec.ring_shift = NumberRange{.min = 0.0, .max = 1.0};
  spec.round.profile_shift = 0.2;
  spec.round.center_distance_m = 0.25e-3;
  spec.round.module_m = 0.05e-3;
  spec.limits.model = backlash::LostMotionModel::kKinematic;  // of one branch
  // Room for points of so coarse a lattice.
  spec.limits[design::CheckId::kOutputBacklashMax] = std::nullopt;
  spec.limits[design::CheckId::kContactRatioMin] = 1.0;
  spec.limits[design::CheckId::kContactRatioMax] = std::nullopt;
  return spec;
}

/// All points whose modules are within steps of the optimum's.
Lattice lattice_of(const Specification& spec, const RefinedSet& set, int steps) {
  Lattice lattice{.m1 = {set.train.module_m[0]},
                  .m2 = {set.train.module_m[1]},
                  .shift = multiples(spec.round.profile_shift, -0.1, 0.5),
                  .ring_shift = multiples(spec.round.profile_shift, 0.0, 1.0)};
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const auto& range = spec.module[stage].range_m;
    if (!range || !(range->min < range->max)) continue;
    const double step = spec.round.module_m;
    const double middle = std::round(set.train.module_m[stage] / step) * step;
    (stage == 0 ? lattice.m1 : lattice.m2) =
        multiples(step, std::max(range->min, middle - steps * step),
                  std::min(range->max, middle + steps * step));
  }
  return lattice;
}

TEST(Rounding, FindsTheBestPointOfTheWholeLattice) {
  const int wanted = sample(3, 12);
  int compared = 0, none = 0;
  std::size_t relaxations = 0;
  for (std::uint64_t seed = 1; seed <= 400 && compared < wanted; ++seed) {
    test::RandomTask task = test::random_task(seed, 3);
    task.spec = coarse(task.spec);
    for (const Candidate& candidate : task.candidates) {
      const RefinedSet set = refine(task.spec, candidate);
      if (set.status != Status::kOptimal) continue;
      constexpr int kSteps = 1;
      const Lattice lattice = lattice_of(task.spec, set, kSteps);
      const StopFlag stop;
      const Rounding rounding = round_design(task.spec, set, stop, {.module_steps = kSteps});
      EXPECT_TRUE(rounding.complete);
      relaxations += rounding.relaxations;
      const std::optional<double> best = best_of_all(task.spec, set, lattice);
      EXPECT_EQ(best.has_value(), rounding.best.has_value()) << seed;
      ++compared;
      if (!best) {
        ++none;
        EXPECT_TRUE(!rounding.nearest || rounding.nearest->missed.size() > 0);
        break;
      }
      if (rounding.best) {
        const double f = -sense_of(first_objective(task.spec)) * rounding.best->objective;
        EXPECT_NEAR(f, *best, 2e-7) << seed;
      }
      break;
    }
  }
  EXPECT_EQ(compared, wanted);
  std::cout << compared << " lattices, " << none << " without a feasible point; "
            << static_cast<double>(relaxations) / compared << " relaxations each\n";
}

// Each choice of modules has a scale of its own there.
TEST(Rounding, ComparesSizesOfDifferentModules) {
  const int wanted = sample(4, 12);
  constexpr int kSteps = 1;
  int compared = 0;
  for (std::uint64_t seed = 12; seed <= 2000 && compared < wanted; ++seed) {
    test::RandomTask task = test::random_task(seed, 1);
    if (task.candidates.empty()) continue;
    Specification spec = coarse(task.spec);
    spec.objectives = {compared % 2 == 1 ? Objective::kMass : Objective::kOuterDiameter};
    spec.bodies.ring_rim_m = 2e-3;
    spec.bodies.face_width_m = {5e-3, 5e-3};
    spec.bodies.density_kgm3 = 7800.0;
    spec.round.profile_shift = 0.25;
    for (auto& choice : spec.module) {
      choice = {.range_m = NumberRange{.min = 0.4e-3, .max = 0.8e-3}, .series_m = {}};
    }
    const RefinedSet set = refine(spec, task.candidates.front());
    if (set.status != Status::kOptimal) continue;
    const Lattice lattice = lattice_of(spec, set, kSteps);
    const std::optional<double> best = best_of_all(spec, set, lattice);
    if (!best) continue;
    ++compared;
    const StopFlag stop;
    const Rounding rounding = round_design(spec, set, stop, {.module_steps = kSteps});
    EXPECT_TRUE(rounding.complete) << seed;
    ASSERT_TRUE(rounding.best) << seed;
    EXPECT_NEAR(rounding.best->objective, *best, 2e-7 * *best) << seed;
  }
  EXPECT_EQ(compared, wanted);
}

}  // namespace
}  // namespace gear3k::optimize::rounding_test
