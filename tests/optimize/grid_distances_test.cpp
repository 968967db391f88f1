// What limits of backlash rule out of a grid of shifts, against the rows themselves at points of
// the grid, the distance scanned.

#include "optimize/grid_distances.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "io/files/specification_file.hpp"
#include "tests/optimize/grid_task.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::grid_distances_test {
namespace {

using design::CheckId;

/// A grid task whose lost motion and backlashes are limited, by either model.
test::RandomTask limited_task(std::uint64_t seed) {
  test::RandomTask task = test::grid_task(seed, 1);
  task.spec.limits[CheckId::kOutputBacklashMax] = 4e-3 + 4e-3 * static_cast<double>(seed % 3);
  task.spec.limits[CheckId::kNormalBacklash] = seed % 2 == 0 ? 5e-6 : -5e-6;
  task.spec.shift_step = 0.05;
  return task;
}

std::vector<std::uint16_t> backlash_rows(const RefinementProblem& problem) {
  std::vector<std::uint16_t> rows;
  for (std::size_t k = 0; k < problem.rows.size(); ++k) {
    const auto& check = problem.rows[k].check;
    if (check && (check->record->id == CheckId::kNormalBacklash ||
                  check->record->id == CheckId::kOutputBacklashMax)) {
      rows.push_back(static_cast<std::uint16_t>(k));
    }
  }
  return rows;
}

/// A box of up to so many steps to either side of a point, by chance.
LatticeBox box_about(const std::array<long, train::kGearCount>& point, long steps,
                     rig::DeterministicRandom& random) {
  LatticeBox box;
  for (const long k : point) {
    const auto width = static_cast<std::size_t>(steps + 1);
    box.push_back(
        {k - static_cast<long>(random.index(width)), k + static_cast<long>(random.index(width))});
  }
  return box;
}

/// Takes the shifts of the sun and the rings to multiples next to where their meshes have no
/// backlash at a point, on the side where they have some.
void close_meshes(const RefinementProblem& problem, const Multiples& shifts, Point& v) {
  const auto train = train::make_train_geometry(parameters_at(problem, used(problem, v)));
  if (!train) return;
  const auto j = backlash::normal_backlashes(*train);
  const double twice_sine = 2.0 * std::sin(problem.spec->pressure_angle_rad);
  const std::array<std::size_t, 3> gears{train::kS, train::kR1, train::kR2};
  for (std::size_t k = 0; k < gears.size(); ++k) {
    const double module_m = *problem.fixed_module_m[k == 2 ? 1 : 0];
    const double excess = j[k] / (twice_sine * module_m);  // of the shift
    const double x = v[gears[k]];
    v[gears[k]] =
        k == 0 ? shifts.at(shifts.last_to(x + excess)) : shifts.at(shifts.first_from(x - excess));
  }
}

TEST(GridDistances, KeepEveryPointOfABoxThatMeetsTheRowsAndRuleOutOthers) {
  constexpr int kAngles = 40;
  const std::uint64_t wanted = sample(4U, 40U);
  int met_at_random = 0, met_closed = 0, ruled_out = 0, left = 0;
  int boxes_smaller = 0, angles_narrower = 0;  // of boxes that hold a point that meets the rows
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  spec.shift_step = 0.05;
  for (ModuleChoice& choice : spec.module) {
    choice = {.range_m = std::nullopt, .series_m = {0.5e-3, 0.6e-3, 0.8e-3, 1e-3}};
  }
  Progress progress;
  const ToothSearchResult sets = search_teeth(spec, progress);
  const Multiples shifts(*spec.shift_step, units::Unit::kModules);
  // A set with 10^5 such points.
  const auto set = std::ranges::find_if(sets.candidates, [](const Candidate& c) {
    const train::ToothSet& z = c.teeth;
    return z.S == 12 && z.P1 == 44 && z.R1 == 102 && z.P2 == 28 && z.R2 == 72;
  });
  ASSERT_NE(set, sets.candidates.end());
  for (std::uint64_t seed = 0; seed < wanted; ++seed) {
    spec.limits.model =
        seed % 2 == 0 ? backlash::LostMotionModel::kKinematic : backlash::LostMotionModel::kPaper;
    rig::DeterministicRandom random(seed);
    const RefinementProblem problem = make_refinement_problem(spec, *set, {0.6e-3, 0.8e-3});
    const auto distances = GridDistances::of(problem, shifts);
    ASSERT_TRUE(distances);
    const auto rows = backlash_rows(problem);
    ASSERT_GE(rows.size(), 4U);  // the lost motion of the paper is held in two parts
    std::vector<double> g(rows.size());
    for (int n = 0; n < 1000; ++n) {
      std::array<long, train::kGearCount> point{};
      Point v = problem.lower;
      for (std::size_t i = 0; i < point.size(); ++i) {
        const long first = shifts.first_from(problem.lower[i]);
        point[i] = first + static_cast<long>(random.index(static_cast<std::size_t>(
                               shifts.last_to(problem.upper[i]) - first + 1)));
        v[i] = shifts.at(point[i]);
      }
      const double about = random.between(0.26, 0.4);
      if (n % 4 != 0) {
        v[kAngleA] = about;
        close_meshes(problem, shifts, v);
        bool inside = true;
        for (std::size_t i = 0; i < point.size(); ++i) {
          point[i] = shifts.nearest(v[i]);
          inside = inside && v[i] >= problem.lower[i] && v[i] <= problem.upper[i];
        }
        if (!inside) continue;
      }
      LatticeBox alone = box_about(point, 0, random);
      const LatticeBox given = box_about(point, 6, random);
      LatticeBox wide = given;
      const auto own = distances->confine(alone);
      const auto all = distances->confine(wide);
      if (own) {
        ++left;
      } else {
        ++ruled_out;
      }
      bool meets = false;
      for (int k = 0; k <= kAngles; ++k) {
        const double off = 0.1 * (2.0 * k / kAngles - 1.0);
        v[kAngleA] = std::max(problem.lower[kAngleA], about + off * std::abs(off));
        const auto f = evaluate<double>(problem, used(problem, v), rows, g);
        if (!f || worst_violation(g) > design::kFeasibilityTolerance) continue;
        meets = true;
        ++(n % 4 == 0 ? met_at_random : met_closed);
        ASSERT_TRUE(own && all) << seed;
        EXPECT_GE(v[kAngleA], own->lo) << seed;
        EXPECT_LE(v[kAngleA], own->hi) << seed;
        EXPECT_GE(v[kAngleA], all->lo) << seed;
        EXPECT_LE(v[kAngleA], all->hi) << seed;
        for (std::size_t i = 0; i < point.size(); ++i) {
          EXPECT_LE(wide[i][0], point[i]) << seed;
          EXPECT_GE(wide[i][1], point[i]) << seed;
        }
      }
      if (!meets) continue;
      boxes_smaller += wide != given ? 1 : 0;
      const double free = problem.upper[kAngleA] - problem.lower[kAngleA];
      angles_narrower += all->width() < 0.5 * free ? 1 : 0;
    }
  }
  std::cout << met_at_random << " + " << met_closed << " points and distances meet the rows, "
            << ruled_out << " points ruled out, " << left << " left, " << boxes_smaller
            << " boxes smaller, " << angles_narrower << " angles narrower\n";
  EXPECT_GT(met_at_random, 0);
  EXPECT_GT(met_closed, 100);
  EXPECT_GT(boxes_smaller, 10);
  EXPECT_GT(angles_narrower, 10);
  EXPECT_GT(ruled_out, 100);
}

TEST(GridDistances, SayNothingWithoutALimitOfTheLostMotionOrWithFreeModules) {
  test::RandomTask task = limited_task(1);
  ASSERT_FALSE(task.candidates.empty());
  const Multiples shifts(*task.spec.shift_step, units::Unit::kModules);
  const auto says = [&](const Specification& spec, bool given) {
    const std::optional<double> module = given ? std::optional(0.6e-3) : std::nullopt;
    return GridDistances::of(make_refinement_problem(spec, task.candidates[0], {module, module}),
                             shifts)
        .has_value();
  };
  EXPECT_TRUE(says(task.spec, true));
  Specification unlimited = task.spec;
  unlimited.limits[CheckId::kOutputBacklashMax] = std::nullopt;
  EXPECT_FALSE(says(unlimited, true));
  Specification free = task.spec;
  for (ModuleChoice& choice : free.module) {
    choice = {.range_m = NumberRange{.min = 0.5e-3, .max = 1e-3}, .series_m = {}};
  }
  EXPECT_FALSE(says(free, false));
}

}  // namespace
}  // namespace gear3k::optimize::grid_distances_test
