#pragma once
// Specifications drawn at random from what users can state, each with a few of its tooth sets, and
// a search for feasible designs of them that does not use the bounds.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "optimize/refinement_problem.hpp"
#include "optimize/slsqp.hpp"
#include "optimize/starting_points.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::optimize::test {

using rig::DeterministicRandom;

struct RandomTask {
  Specification spec;
  std::vector<Candidate> candidates;
};

inline int random_integer(DeterministicRandom& random, int least, int most) {
  return least + static_cast<int>(random.index(static_cast<std::size_t>(most - least + 1)));
}
inline bool with_chance(DeterministicRandom& random, double chance) {
  return random.uniform() < chance;
}
template <class Value>
Value one_of(DeterministicRandom& random, const std::vector<Value>& values) {
  return values[random.index(values.size())];
}

/// Tooth numbers with a ratio that a gearbox may have, of either sign.
inline train::ToothSet random_teeth(DeterministicRandom& random) {
  for (;;) {
    train::ToothSet z;
    z.S = random_integer(random, 8, 24);
    z.P1 = random_integer(random, 14, 55);
    z.R1 = z.S + 2 * z.P1 + random_integer(random, -3, 3);
    const int shift = random_integer(random, -12, 12);
    z.P2 = std::max(12, z.P1 + shift);
    z.R2 = z.P2 + z.R1 - z.P1 + random_integer(random, -6, 6);
    if (z.R1 - z.P1 < 8 || z.R2 - z.P2 < 8 || std::abs(train::g2(z) - 1.0) < 1e-9) continue;
    const double ratio = std::abs(train::ratio(z));
    if (ratio > 8.0 && ratio < 250.0) return z;
  }
}

inline void draw_friction(DeterministicRandom& random, Specification& spec) {
  using efficiency::LossModel;
  design::Friction& friction = spec.friction;
  friction.coefficient = random.between(0.02, 0.2);
  friction.model =
      one_of<LossModel>(random, {LossModel::kSliding, LossModel::kSliding, LossModel::kOhlendorf,
                                 LossModel::kCoulombPath, LossModel::kDirectional});
  if (friction.model == LossModel::kDirectional) {
    friction.approach_factor = random.between(0.5, 1.6);
    friction.recess_factor = random.between(0.5, 1.6);
  }
  if (with_chance(random, 0.3)) {
    friction.extension.level = random.between(0.5, 1.5);
    friction.extension.forward = random.between(0.7, 1.3);
    friction.extension.backward = random.between(0.7, 1.3);
    friction.extension.approach = random.between(0.6, 1.8);
    friction.extension.recess = random.between(0.6, 1.8);
  }
}

inline void draw_limits(DeterministicRandom& random, Specification& spec) {
  using design::CheckId;
  design::Limits& limits = spec.limits;
  // Candidates of all phasings; tooth forms are dear, and no bound knows of them.
  for (const CheckId id : {CheckId::kEqualSpacing, CheckId::kIdenticalPlanets, CheckId::kFormCircle,
                           CheckId::kTipFouling, CheckId::kTrochoidInterference, CheckId::kTrimming,
                           CheckId::kRingCutter, CheckId::kBodyGap, CheckId::kCoaxiality,
                           CheckId::kRingTipThickness, CheckId::kOutputBacklashMin}) {
    limits[id] = std::nullopt;
  }
  const auto draw = [&](CheckId id, double chance, double least, double most) {
    limits[id] =
        with_chance(random, chance) ? std::optional(random.between(least, most)) : std::nullopt;
  };
  draw(CheckId::kUndercut, 0.7, -0.2, 0.1);
  draw(CheckId::kTipThickness, 0.7, 0.05, 0.6);
  draw(CheckId::kRingTipOutsideBase, 0.7, 0.0, 0.1);
  draw(CheckId::kInvoluteInterference, 0.7, -0.2, 0.3);
  draw(CheckId::kRootClearance, 0.6, 0.0, 0.25);
  draw(CheckId::kPlanetGap, 0.6, -1.0, 1.0);
  draw(CheckId::kContactRatioMin, 0.85, 0.8, 1.5);
  draw(CheckId::kContactRatioMax, 0.6, 1.6, 2.6);
  draw(CheckId::kRingRootDiameter, 0.3, 0.04, 0.15);
  draw(CheckId::kOutputBacklashMax, 0.8, 2e-4, 6e-3);
  limits[CheckId::kNormalBacklash] =
      one_of<std::optional<double>>(random, {std::nullopt, -20e-6, -5e-6, 0.0, 0.0, 5e-6, 20e-6});
  limits.model = with_chance(random, 0.6) ? backlash::LostMotionModel::kKinematic
                                          : backlash::LostMotionModel::kPaper;
}

/// Limits of a workshop and of the whole gearbox, of sizes that gears about these may have.
inline void draw_workshop(DeterministicRandom& random, Specification& spec) {
  using design::CheckId;
  const auto draw = [&](CheckId id, double chance, double least, double most) {
    if (with_chance(random, chance)) spec.limits[id] = random.between(least, most);
  };
  draw(CheckId::kSpecificSliding, 0.6, 0.8, 8.0);
  draw(CheckId::kTipThicknessLength, 0.5, 0.05e-3, 0.4e-3);
  draw(CheckId::kRootClearanceLength, 0.5, 0.02e-3, 0.2e-3);
  draw(CheckId::kSunRootDiameter, 0.3, 3e-3, 14e-3);
  draw(CheckId::kGearboxDiameter, 0.4, 0.05, 0.15);
  draw(CheckId::kWall, 0.5, 0.2e-3, 3e-3);
  spec.bodies.ring_rim_m = random.between(0.5e-3, 4e-3);
  if (with_chance(random, 0.4)) {
    spec.bodies.bore_radius_m[train::kS] = random.between(0.5e-3, 4e-3);
    spec.bodies.bore_radius_m[train::kP1] = spec.bodies.bore_radius_m[train::kP2] =
        random.between(1e-3, 8e-3);
  }
  for (auto& least : spec.limits.mesh_backlash_m) {
    if (with_chance(random, 0.3)) least = random.between(-10e-6, 40e-6);
  }
  if (with_chance(random, 0.3)) {
    spec.limits[CheckId::kSameModule] = 0.0;
    spec.module[1] = spec.module[0];
  }
}

inline ModuleChoice random_module(DeterministicRandom& random) {
  ModuleChoice choice;
  switch (random.index(3)) {
    case 0:
      choice.range_m = NumberRange{.min = 0.5e-3, .max = random.between(0.55e-3, 1.2e-3)};
      break;
    case 1:
      choice.series_m = {0.5e-3, 0.8e-3};
      break;
    default:
      choice.range_m = NumberRange{.min = 0.6e-3, .max = 0.6e-3};
      break;
  }
  return choice;
}

/// A specification and at most `most` of its tooth sets.
inline RandomTask random_task(std::uint64_t seed, std::size_t most) {
  DeterministicRandom random(seed);
  RandomTask task;
  Specification& spec = task.spec;
  const train::ToothSet z = random_teeth(random);
  spec.planets = {random_integer(random, 3, 6)};
  spec.pressure_angle_rad = random.between(15.0, 25.0) * 3.14159265358979 / 180.0;
  spec.objectives = {with_chance(random, 0.5) ? Objective::kBackwardEfficiency
                                              : Objective::kForwardEfficiency};
  spec.ratio = {.target = train::ratio(z), .tolerance = 0.05};
  const auto about = [](int teeth) { return IntegerRange{.min = teeth - 2, .max = teeth + 2}; };
  spec.teeth.S = about(z.S);
  spec.teeth.P1 = about(z.P1);
  spec.teeth.P2 = about(z.P2);
  spec.teeth.R1_max = z.R1 + 3;
  spec.teeth.R2_max = z.R2 + 3;
  spec.module = {random_module(random), random_module(random)};
  // A stage 2 that fits stage 1's centre distance more often than a drawn one does.
  if (with_chance(random, 0.7)) spec.module[1].range_m = NumberRange{.min = 0.3e-3, .max = 2e-3};
  if (spec.module[1].range_m) spec.module[1].series_m.clear();
  spec.profile_shift = {.min = random.between(-0.6, 0.1), .max = random.between(0.5, 1.8)};
  spec.rack.addendum = random.between(0.8, 1.2);
  spec.rack.dedendum = spec.rack.addendum + 0.25;
  spec.rack.root_radius = 0.2;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    if (with_chance(random, 0.3)) spec.tip_shortening[gear] = random.between(0.0, 0.3);
    if (with_chance(random, 0.4)) spec.machining_allowance[gear] = random.between(0.0, 0.05);
  }
  for (const std::size_t gear : {train::kS, train::kP1}) {
    spec.khk_tip[gear] = with_chance(random, 0.3);
    if (spec.khk_tip[gear]) spec.tip_shortening[gear] = 0.0;
  }
  draw_limits(random, spec);
  draw_friction(random, spec);
  spec.solver.starts = 6;
  spec.solver.seed = seed;
  Progress progress;
  task.candidates = search_teeth(spec, progress).candidates;
  random.shuffle(task.candidates);
  if (task.candidates.size() > most) task.candidates.resize(most);
  return task;
}

/// Friction that differs by the mesh and by the gear that drives in it, often less in all of them.
inline void draw_friction_by_mesh(DeterministicRandom& random, Specification& spec) {
  if (!with_chance(random, 0.5)) return;
  const double most = with_chance(random, 0.7) ? 0.7 : 1.6;
  spec.friction.extension.inner_drives = random.between(0.4, most);
  spec.friction.extension.outer_drives = random.between(0.4, most);
  spec.friction.extension.ring_meshes = random.between(0.4, most);
}

/// A task with limits of a workshop besides, and friction by mesh.
inline RandomTask random_workshop_task(std::uint64_t seed, std::size_t most) {
  RandomTask task = random_task(seed, most);
  DeterministicRandom random(seed + 50'000);
  draw_workshop(random, task.spec);
  draw_friction_by_mesh(random, task.spec);
  return task;
}

/// The programmes of a tooth set, every check a row: one for each choice of modules and branch.
inline std::vector<RefinementProblem> problems_of(const Specification& spec,
                                                  const Candidate& candidate) {
  const auto options = [](const ModuleChoice& choice) {
    std::vector<std::optional<double>> modules(choice.series_m.begin(), choice.series_m.end());
    if (choice.range_m) {
      modules = {choice.range_m->min < choice.range_m->max ? std::nullopt
                                                           : std::optional(choice.range_m->min)};
    }
    return modules;
  };
  std::vector<RefinementProblem> problems;
  for (const auto& m1 : options(spec.module[0])) {
    for (const auto& m2 : options(spec.module[1])) {
      if (has_same_module(spec) && m1 != m2) continue;
      problems.push_back(make_refinement_problem(spec, candidate, {m1, m2}));
    }
  }
  return problems;
}

struct FoundDesign {
  double objective = 0.0;
  Point v{};
  const char* how = "";
};

/// The best feasible design that SLSQP finds from a number of starts, after a phase of least
/// violation where it is needed; the starts themselves count.
/// @param visit  called with every feasible point on the way, and its problem
template <class Visit>
std::optional<FoundDesign> search_designs(const std::vector<RefinementProblem>& problems,
                                          int starts, std::uint64_t seed, const Visit& visit) {
  std::optional<FoundDesign> best;
  for (const RefinementProblem& problem : problems) {
    const auto offer = [&](const SolveOutcome& outcome, const char* how) {
      if (!(outcome.violation <= design::kFeasibilityTolerance)) return false;
      visit(problem, outcome);
      if (!best || -outcome.objective > best->objective)
        best = {-outcome.objective, outcome.v, how};
      return true;
    };
    for (const Point& start : starting_points(problem, starts, seed)) {
      offer(outcome_at(problem, start), "start");
      if (offer(solve_slsqp(problem, start, {}), "slsqp")) continue;
      const SolveOutcome nearest = least_violation(problem, start, {});
      if (offer(nearest, "least violation")) offer(solve_slsqp(problem, nearest.v, {}), "second");
    }
  }
  return best;
}

}  // namespace gear3k::optimize::test
