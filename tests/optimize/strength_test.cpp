// Strength in the optimisation: its checks as constraints, its objectives, torque and face widths
// as variables.

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "design/evaluation.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/check_row.hpp"
#include "optimize/gradients.hpp"
#include "optimize/kkt_residual.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/refine.hpp"
#include "optimize/starting_points.hpp"
#include "tests/strength/steel.hpp"

namespace gear3k::optimize::strength_test {
namespace {

using design::CheckId;

const Candidate kWinner{.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118}, .planets = 3};

/// So narrow that the torques of these tests bind.
constexpr double kWidth_m = 2e-3;

Specification unrated() {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  spec.bodies.density_kgm3 = 7850.0;
  spec.bodies.face_width_m = {kWidth_m, kWidth_m};
  return spec;
}

/// The reference problem under a load, of steel.
Specification loaded(double torque_Nm) {
  Specification spec = unrated();
  strength::RatingTask task;
  task.material.fill(strength::steel_700_290());
  task.torque_Nm = torque_Nm;
  task.face_width_m = {kWidth_m, kWidth_m};
  task.teeth.root_safety_min = 1.5;
  task.teeth.flank_safety_min = 1.2;
  spec.rating = task;
  return spec;
}

Specification small(Specification spec) {
  spec.teeth.S = {.min = 12, .max = 12};
  spec.teeth.P1 = {.min = 52, .max = 55};
  return spec;
}

OptimizeResult run(const Specification& spec, bool best_only = false) {
  Progress progress;
  return optimize(spec, progress, {.best_only = best_only});
}

TEST(StrengthInOptimize, ASmallTorqueLeavesTheOptimum) {
  const RefinedSet without = refine(unrated(), kWinner);
  const RefinedSet with = refine(loaded(1e-3), kWinner);
  ASSERT_EQ(without.status, Status::kOptimal);
  ASSERT_EQ(with.status, Status::kOptimal);
  EXPECT_NEAR(with.eta_b, without.eta_b, 1e-8);
}

TEST(StrengthInOptimize, NoTorqueGivesBackTheSearchWithoutStrength) {
  const OptimizeResult without = run(small(unrated()));
  const OptimizeResult with = run(small(loaded(1e-6)));
  ASSERT_TRUE(without.best && with.best);
  EXPECT_EQ(without.best->candidate, with.best->candidate);
  EXPECT_NEAR(without.best->eta_b, with.best->eta_b, 1e-6);
  ASSERT_EQ(without.refined.size(), with.refined.size());
  for (std::size_t k = 0; k < with.refined.size(); ++k) {
    ASSERT_EQ(without.refined[k].status, with.refined[k].status) << k;
    EXPECT_NEAR(without.refined[k].eta_b, with.refined[k].eta_b, 1e-6) << k;
  }
}

TEST(StrengthInOptimize, MoreTorqueNeverRaisesTheEfficiencyOfAnySet) {
  std::vector<double> before;
  for (const double torque_Nm : {5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0}) {
    Specification spec = small(loaded(torque_Nm));
    spec.bodies.face_width_m = {2e-3, 2e-3};
    spec.free.face_width_m = {NumberRange{2e-3, 5e-3}, NumberRange{2e-3, 5e-3}};
    const OptimizeResult result = run(spec);
    std::vector<double> now(result.search.candidates.size(), 0.0);
    for (const RefinedSet& set : result.refined) {
      if (set.status != Status::kOptimal) continue;
      now[set.index] = set.eta_b;
      EXPECT_LE(set.kkt_residual, kStationary);
    }
    for (std::size_t k = 0; k < before.size(); ++k) {
      EXPECT_LE(now[k], before[k] + 1e-6) << torque_Nm << " set " << k;
    }
    before = now;
  }
  EXPECT_TRUE(std::ranges::any_of(before, [](double eta) { return eta > 0.0; }));
}

TEST(StrengthInOptimize, OptimaUnderLoadAreStationaryByTheStrengthRowsThatAreActive) {
  // So much that the optimum has to give way for it.
  Specification spec = loaded(1e-3);
  const double unloaded = refine(spec, kWinner).eta_b;
  RefinedSet set;
  do {
    spec.rating->torque_Nm = std::max(1.0, 1.1 * spec.rating->torque_Nm);
    set = refine(spec, kWinner);
    ASSERT_EQ(set.status, Status::kOptimal) << spec.rating->torque_Nm;
  } while (set.eta_b > unloaded - 1e-4);
  EXPECT_LE(set.kkt_residual, kStationary);
  // Without the active strength rows the same point is not stationary.
  RefinementProblem p = make_refinement_problem(spec, kWinner, {1e-3, std::nullopt});
  const train::TrainParameters<double> train = train_of(spec, set);
  Point v{};
  for (std::size_t i = 0; i < train::kGearCount; ++i) v[i] = train.profile_shift[i];
  const auto geometry = train::make_train_geometry(train);
  v[kAngleA] = geometry->meshes[static_cast<std::size_t>(p.angle_mesh)].alpha_w_rad;
  v[kAngleB] = geometry->meshes[train::kMeshP2R2].alpha_w_rad;
  EXPECT_LE(kkt_residual(p, v), 2.0 * kStationary);
  std::vector<double> g(p.rows.size());
  ASSERT_TRUE(evaluate<double>(p, used(p, v), g));
  std::vector<std::string_view> active;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const auto& check = p.rows[k].check;
    if (check && check->record->rating && g[k] < 1e-6) active.push_back(p.rows[k].name);
  }
  ASSERT_FALSE(active.empty());
  std::erase_if(p.rows, [&](const ConstraintRow& row) {
    return std::ranges::find(active, row.name) != active.end();
  });
  EXPECT_GT(kkt_residual(p, v), 10.0 * kStationary) << active.front();
}

/// examples/ratio-96.toml, 20 N m of steel, for another objective.
Specification heavy(Objective objective) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  spec.objectives = {objective};
  return spec;
}

// The stiffest train has a ring whose root has just become fully round: a kink of the stiffness in
// that ring's shift, with the optimum on it.
TEST(StrengthInOptimize, AnOptimumOnAKinkIsToldFromAPointBesideIt) {
  const Specification spec = heavy(Objective::kTorsionalStiffness);
  const Candidate candidate{.teeth = {.S = 12, .P1 = 60, .R1 = 132, .P2 = 35, .R2 = 88},
                            .planets = 3};
  const RefinedSet set = refine(spec, candidate);
  ASSERT_EQ(set.status, Status::kOptimal);
  EXPECT_LE(set.kkt_residual, kStationary);
  const RefinementProblem p =
      make_refinement_problem(spec, candidate, {std::nullopt, std::nullopt});
  const train::TrainParameters<double> train = train_of(spec, set);
  const auto geometry = train::make_train_geometry(train);
  ASSERT_TRUE(geometry);
  Point v{};
  for (std::size_t i = 0; i < train::kGearCount; ++i) v[i] = train.profile_shift[i];
  v[kAngleA] = geometry->meshes[static_cast<std::size_t>(p.angle_mesh)].alpha_w_rad;
  v[kAngleB] = geometry->meshes[train::kMeshP2R2].alpha_w_rad;
  v[p.scale] = train.module_m[0] / p.length_scale_m;
  std::vector<double> g(p.rows.size());
  const auto best = evaluate<double>(p, used(p, v), g);
  ASSERT_TRUE(best);
  ASSERT_NEAR(-*best * p.objective_scale, *set.torsional_stiffness_Nm_rad,
              1e-9 * *set.torsional_stiffness_Nm_rad);
  // Slopes beside the kink differ by far more than the curvature gives.
  const auto slope = [&](double by) {
    Point w = v;
    w[train::kR2] += by;
    return (*evaluate<double>(p, used(p, w), g) - *best) / by;
  };
  constexpr double kBeside = 1e-5;
  EXPECT_GT(slope(kBeside) - slope(-kBeside), 5e-3);
  // No feasible point near is better: steps of any direction, those out of the limits left out.
  std::mt19937 random(1);
  std::normal_distribution<double> gauss;
  int tried = 0;
  std::vector<Point> beside;
  for (int i = 0; i < 4000; ++i) {
    Point w = v;
    const double reach = std::pow(10.0, -1.0 - i % 5);
    for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
      w[k] = std::clamp(v[k] + reach * gauss(random), p.lower[k], p.upper[k]);
    }
    const auto f = evaluate<double>(p, used(p, w), g);
    if (!f || worst_violation(g) > design::kFeasibilityTolerance) continue;
    ++tried;
    EXPECT_GE(*f, *best - 1e-5);
    if (*f > *best + 1e-3) beside.push_back(w);
  }
  EXPECT_GT(tried, 20);
  // Points beside it are not stationary, on whichever side of the kink they lie.
  ASSERT_GT(beside.size(), 5);
  for (const Point& w : beside) EXPECT_GT(kkt_residual(p, w), 100.0 * kStationary);
}

// Ends that SLSQP cuts off in a long valley (torque over mass hardly depends on the size), and ends
// that are better by the tolerance of feasibility only.
TEST(StrengthInOptimize, SetsWithALongValleyEndStationary) {
  const RefinedSet density =
      refine(heavy(Objective::kTorqueDensity),
             {.teeth = {.S = 14, .P1 = 35, .R1 = 85, .P2 = 29, .R2 = 76}, .planets = 3});
  EXPECT_EQ(density.status, Status::kOptimal) << density.kkt_residual;
  const RefinedSet capacity =
      refine(heavy(Objective::kTorqueCapacity),
             {.teeth = {.S = 12, .P1 = 58, .R1 = 132, .P2 = 30, .R2 = 78}, .planets = 3});
  EXPECT_EQ(capacity.status, Status::kOptimal) << capacity.kkt_residual;
}

TEST(StrengthInOptimize, MoreTorqueNeverRaisesTheEfficiencyAndWhatForbidsItIsNamed) {
  double before = 1.0;
  int binding = 0;
  std::ptrdiff_t blocked = 0;
  bool infeasible = false;
  for (const double torque_Nm : {5.0, 10.0, 15.0, 20.0, 30.0, 40.0}) {
    const OptimizeResult result = run(small(loaded(torque_Nm)));
    if (!result.best) {
      infeasible = true;
      for (const RefinedSet& set : result.refined) {
        EXPECT_TRUE(reason_of(set) == "flank_safety" || reason_of(set) == "root_safety" ||
                    set.blocked_together)
            << reason_of(set);
      }
      continue;
    }
    EXPECT_FALSE(infeasible) << torque_Nm;
    EXPECT_LE(result.best->eta_b, before + 1e-6) << torque_Nm;
    before = result.best->eta_b;
    RecordProperty("eta_b_" + std::to_string(static_cast<int>(torque_Nm)), std::to_string(before));
    EXPECT_LE(result.best->kkt_residual, kStationary);
    const auto e = std::get<design::Evaluation>(
        design::evaluate(design_of(small(loaded(torque_Nm)), *result.best)));
    for (const design::CheckResult& check : e.checks) {
      EXPECT_TRUE(check.ok) << torque_Nm << " " << check.record->name << " " << check.margin;
      binding += check.record->rating && std::abs(check.margin) < 1e-5 ? 1 : 0;
    }
    for (const RefinedSet& set : result.refined) {
      if (set.status != Status::kNoFeasibleFound) continue;
      blocked += std::ranges::count_if(set.blocked_by, [](const Miss& miss) {
        return miss.name == "flank_safety" || miss.name == "root_safety";
      });
    }
  }
  EXPECT_GT(binding, 0) << "no strength row was active";
  EXPECT_GT(blocked, 0) << "no set was blocked by strength";
}

/// Central differences of all rows and of the objective against their gradients.
void expect_gradients(const RefinementProblem& p, Point v) {
  const auto n = static_cast<std::size_t>(p.variables);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double room = std::min(0.02, 0.1 * (p.upper[k] - p.lower[k]));
    v[k] = std::clamp(v[k] + room * unit(random), p.lower[k] + 0.5 * room, p.upper[k] - 0.5 * room);
  }
  Gradients at;
  ASSERT_TRUE(evaluate_gradients(p, {v.data(), n}, all_rows(p), at));
  constexpr double kStep = 1e-4;
  std::vector<std::vector<double>> g(4, std::vector<double>(p.rows.size()));
  for (std::size_t j = 0; j < n; ++j) {
    std::array<double, 4> f{};
    for (std::size_t i = 0; i < 4; ++i) {
      Point moved = v;
      moved[j] += kStep * std::array{-2.0, -1.0, 1.0, 2.0}[i];
      const auto value = evaluate<double>(p, used(p, moved), g[i]);
      ASSERT_TRUE(value);
      f[i] = *value;
    }
    const auto slope = [&](double a, double b, double c, double d) {
      return (a - 8.0 * b + 8.0 * c - d) / (12.0 * kStep);
    };
    const double df = slope(f[0], f[1], f[2], f[3]);
    EXPECT_NEAR(at.df[j], df, 1e-6 * (1.0 + std::abs(df))) << "objective by " << j;
    for (std::size_t k = 0; k < p.rows.size(); ++k) {
      const double dg = slope(g[0][k], g[1][k], g[2][k], g[3][k]);
      EXPECT_NEAR(at.dg[k * n + j], dg, 1e-6 * (1.0 + std::abs(dg)))
          << p.rows[k].name << " by variable " << j;
    }
  }
}

/// Everything that a rating can depend on.
Specification loaded_in_full() {
  Specification spec = loaded(20.0);
  strength::RatingTask& task = *spec.rating;
  task.speed_rad_s = 100.0;
  task.life_s = 3.6e6;
  task.accuracy_grade = 7;
  task.misalignment_m = 5e-6;
  task.teeth.root_roughness_m = 10e-6;
  task.teeth.flank_roughness_m = 4e-6;
  task.viscosity40_m2_s = 220e-6;
  task.supports = strength::PlanetSupports{
      .position_m = {0.0, 0.03}, .plane_m = {0.01, 0.02}, .stiffness_N_m = 1e8};
  task.pin_diameter_m = 8e-3;
  spec.limits[CheckId::kBearingLoad] = 2000.0;
  spec.limits[CheckId::kPinStress] = 200e6;
  return spec;
}

TEST(StrengthInOptimize, GradientsAreCentralDifferences) {
  for (const Specification& spec : {loaded(20.0), loaded_in_full()}) {
    const RefinementProblem p = make_refinement_problem(spec, kWinner, {1e-3, std::nullopt});
    EXPECT_GT(std::ranges::count_if(
                  p.rows, [](const auto& row) { return row.check && row.check->record->rating; }),
              11);
    expect_gradients(p, starting_points(p, 1, 1).front());
  }
}

TEST(StrengthInOptimize, GradientsByTorqueAndFaceWidthsAreCentralDifferences) {
  for (const Objective objective : {Objective::kTorqueCapacity, Objective::kTorqueDensity,
                                    Objective::kTorsionalStiffness, Objective::kMass}) {
    Specification spec = loaded(20.0);
    spec.objectives = {objective};
    spec.free.face_width_m = {NumberRange{4e-3, 12e-3}, NumberRange{5e-3, 10e-3}};
    const RefinementProblem p = make_refinement_problem(spec, kWinner, {1e-3, std::nullopt});
    const bool torque =
        objective == Objective::kTorqueCapacity || objective == Objective::kTorqueDensity;
    ASSERT_EQ(p.variables, torque ? 10 : 9);
    expect_gradients(p, starting_points(p, 1, 1).front());
  }
}

TEST(StrengthInOptimize, RowsByThemselvesEqualAllRows) {
  const Specification spec = loaded_in_full();
  const RefinementProblem p = make_refinement_problem(spec, kWinner, {1e-3, std::nullopt});
  const Point v = starting_points(p, 1, 1).front();
  std::vector<double> all(p.rows.size());
  ASSERT_TRUE(evaluate<double>(p, used(p, v), all));
  for (std::uint16_t k = 0; k < p.rows.size(); ++k) {
    double one = 0.0;
    const std::array selection{k};
    ASSERT_TRUE(evaluate<double>(p, used(p, v), selection, std::span<double>(&one, 1)));
    EXPECT_EQ(one, all[k]) << p.rows[k].name;
  }
}

TEST(StrengthInOptimize, WhatCannotBeRatedIsUndefinedAndDoesNotThrow) {
  Specification spec = loaded(20.0);
  spec.rating->rim_radius_m[train::kR1] = 0.05;  // inside the ring's root circle
  spec.rating->rim_radius_m[train::kS] = 0.02;
  const RefinementProblem p = make_refinement_problem(spec, kWinner, {1e-3, std::nullopt});
  std::vector<double> g(p.rows.size());
  EXPECT_FALSE(evaluate<double>(p, used(p, starting_points(p, 1, 1).front()), g));
  EXPECT_NE(refine(spec, kWinner).status, Status::kOptimal);
}

TEST(StrengthInOptimize, IsDefinedEverywhereInTheBox) {
  const Specification spec = loaded(20.0);
  const RefinementProblem p = make_refinement_problem(spec, kWinner, {1e-3, std::nullopt});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> g(p.rows.size());
  int defined = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Point v{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
      const double u = trial < 2 ? trial : unit(random);
      v[k] = p.lower[k] + u * (p.upper[k] - p.lower[k]);
    }
    defined += evaluate<double>(p, used(p, v), g) ? 1 : 0;
  }
  EXPECT_GT(defined, 450);
}

TEST(StrengthInOptimize, GivesTheSameAtOneAndFourThreads) {
  const Specification spec = small(loaded(20.0));
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const OptimizeResult one = run(spec);
  omp_set_num_threads(4);
  const OptimizeResult four = run(spec);
  omp_set_num_threads(before);
  ASSERT_EQ(one.refined.size(), four.refined.size());
  for (std::size_t k = 0; k < one.refined.size(); ++k) {
    const RefinedTrain& a = one.refined[k].train;
    const RefinedTrain& b = four.refined[k].train;
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << k;
    EXPECT_EQ(one.refined[k].eta_b, four.refined[k].eta_b);
  }
}

TEST(StrengthInOptimize, TheCertifiedSearchFindsWhatRefiningAllSetsFinds) {
  const Specification spec = small(loaded(15.0));
  const OptimizeResult all = run(spec);
  const OptimizeResult certified = run(spec, true);
  ASSERT_TRUE(all.best && certified.best);
  EXPECT_EQ(all.best->candidate, certified.best->candidate);
  EXPECT_EQ(all.best->eta_b, certified.best->eta_b);
  ASSERT_TRUE(certified.certificate);
  EXPECT_TRUE(certified.certificate->objective_bounded);
  EXPECT_GE(certified.certificate->global_bound, all.best->eta_b);
  for (const RefinedSet& set : all.refined) {
    if (set.status != Status::kOptimal) continue;
    EXPECT_LE(set.eta_b, all.bounds->of(set.index).eta_b);
  }
}

TEST(TorqueCapacityObjective, IsTheCapacityOfTheRefinedTrainAndBeatsTheMostEfficientOne) {
  Specification spec = loaded(5.0);
  const RefinedSet efficient = refine(spec, kWinner);
  spec.objectives = {Objective::kTorqueCapacity};
  const RefinedSet strong = refine(spec, kWinner);
  ASSERT_EQ(strong.status, Status::kOptimal) << strong.kkt_residual;
  EXPECT_LE(strong.kkt_residual, kStationary);
  EXPECT_GT(*strong.torque_capacity_Nm, 5.0);
  EXPECT_EQ(objective_of(spec, strong, Objective::kTorqueCapacity), *strong.torque_capacity_Nm);
  // A task at that torque is met, one at a thousandth more by no design of the set.
  Specification at = loaded(*strong.torque_capacity_Nm * (1.0 - 1e-5));
  EXPECT_EQ(refine(at, kWinner).status, Status::kOptimal);
  at = loaded(*strong.torque_capacity_Nm * 1.001);
  EXPECT_NE(refine(at, kWinner).status, Status::kOptimal);
  EXPECT_GE(efficient.eta_b, strong.eta_b);
}

TEST(TorqueCapacityObjective, DoesNotDependOnTheTorqueThatIsStatedNorFails) {
  Specification spec = small(loaded(1.0));
  spec.objectives = {Objective::kTorqueCapacity};
  std::vector<double> first;
  for (const double stated : {1.0, 3.0}) {
    spec.rating->torque_Nm = stated;
    const OptimizeResult result = run(spec);
    std::vector<double> capacities;
    for (const RefinedSet& set : result.refined) {
      EXPECT_EQ(set.status, Status::kOptimal) << stated;
      capacities.push_back(set.torque_capacity_Nm.value_or(0.0));
    }
    if (first.empty()) first = capacities;
    ASSERT_EQ(capacities.size(), first.size());
    for (std::size_t k = 0; k < first.size(); ++k) {
      EXPECT_NEAR(capacities[k], first[k], 1e-5 * first[k]) << stated << " " << k;
    }
  }
}

TEST(TorqueCapacity, IsTheEdgeOfFeasibility) {
  Specification spec = loaded(10.0);
  spec.objectives = {Objective::kTorqueCapacity};
  const RefinedSet most = refine(spec, kWinner);
  ASSERT_EQ(most.status, Status::kOptimal);
  EXPECT_EQ(refine(loaded(0.9999 * *most.torque_capacity_Nm), kWinner).status, Status::kOptimal);
  EXPECT_NE(refine(loaded(1.001 * *most.torque_capacity_Nm), kWinner).status, Status::kOptimal);
}

TEST(RefinedSet, CarriesWhatTheAnalysisOfItsDesignSays) {
  Specification spec = loaded(2.0);
  spec.operating_point = {.sun_speed_rad_s = 300.0, .output_torque_Nm = 2.0};
  spec.rating->speed_rad_s = 300.0;
  for (const bool plastic : {false, true}) {
    if (plastic) {
      spec.rating->material.fill(
          strength::GearMaterial{.record = *strength::find_material("POM"), .hardness = {}});
      spec.rating->teeth.cycles = 1e6;
      spec.rating->torque_Nm = 0.2;
    }
    const RefinedSet set = refine(spec, kWinner);
    ASSERT_EQ(set.status, Status::kOptimal) << plastic;
    const auto result = design::evaluate(design_of(spec, set));
    const auto& evaluation = std::get<design::Evaluation>(result);
    const auto least = evaluation.strength.value().least_capacity();
    ASSERT_TRUE(least && set.torque_capacity_Nm);
    EXPECT_NEAR(*set.torque_capacity_Nm, least->capacity.torque_Nm,
                1e-9 * least->capacity.torque_Nm);
    const double K_out = evaluation.strength->forward.stiffness.value().output_Nm_rad;
    EXPECT_NEAR(set.torsional_stiffness_Nm_rad.value(), K_out, 1e-9 * K_out);
  }
}

TEST(ConstraintOfASafety, HasTheMarginsSlopeAtItsLimitAndGivesBackTheMiss) {
  for (const auto id : {design::CheckId::kRootSafety, design::CheckId::kFlankSafety}) {
    const design::CheckInstance check{.record = &design::check_record(id),
                                      .subject = {.member = 0, .which = 1},
                                      .limit = 1.5,
                                      .scale = 1.0};
    std::array<strength::MeshRating<double>, 1> rating;
    design::Gearing<double> gearing{};
    gearing.rating = rating;
    const auto at = [&](double safety) {
      rating[0].teeth[0].root_safety = rating[0].teeth[0].flank_safety = safety;
      return constraint_of(check, gearing);
    };
    EXPECT_EQ(at(1.5), 0.0);
    EXPECT_NEAR((at(1.5 + 1e-6) - at(1.5 - 1e-6)) / 2e-6, 1.0, 1e-6);
    // Rising everywhere, also where nothing of the strength is left.
    for (double safety = -2.0; safety < 5.0; safety += 0.01)
      EXPECT_LT(at(safety), at(safety + 0.01));
    for (const double safety : {1.4999, 1.2, 0.4, 0.16, 0.15, 0.14, 0.0, -1.0}) {
      EXPECT_NEAR(miss_of_constraint(check, -at(safety)), 1.5 - safety, 1e-9) << safety;
    }
  }
}

TEST(TorqueDensityObjective, IsStationaryAndNoLessThanTheStrongestTrains) {
  Specification spec = loaded(5.0);
  spec.objectives = {Objective::kTorqueDensity};
  const RefinedSet dense = refine(spec, kWinner);
  ASSERT_EQ(dense.status, Status::kOptimal) << dense.kkt_residual;
  spec.objectives = {Objective::kTorqueCapacity};
  const RefinedSet strong = refine(spec, kWinner);
  EXPECT_GE(objective_of(spec, dense, Objective::kTorqueDensity),
            objective_of(spec, strong, Objective::kTorqueDensity) * (1.0 - 1e-6));
  EXPECT_GE(*strong.torque_capacity_Nm, *dense.torque_capacity_Nm * (1.0 - 1e-6));
}

TEST(TorsionalStiffnessObjective, BeatsTheMostEfficientTrain) {
  Specification spec = loaded(5.0);
  spec.objectives = {Objective::kTorsionalStiffness};
  const RefinedSet stiff = refine(spec, kWinner);
  ASSERT_EQ(stiff.status, Status::kOptimal) << stiff.kkt_residual;
  EXPECT_GT(*stiff.torsional_stiffness_Nm_rad, 0.0);
  spec.objectives = {Objective::kBackwardEfficiency, Objective::kTorsionalStiffness};
  const RefinedSet efficient = refine(spec, kWinner);
  ASSERT_EQ(efficient.status, Status::kOptimal);
  EXPECT_GT(*stiff.torsional_stiffness_Nm_rad, *efficient.torsional_stiffness_Nm_rad);
}

TEST(ObjectivesOfTheLoad, HaveNoBoundAndTheCertificateSaysSo) {
  Specification spec = small(loaded(5.0));
  spec.teeth.P1 = {.min = 54, .max = 54};
  spec.objectives = {Objective::kTorqueCapacity};
  EXPECT_EQ(best_value(Objective::kTorqueCapacity, spec, kWinner.teeth, 3),
            std::numeric_limits<double>::infinity());
  const OptimizeResult all = run(spec);
  const OptimizeResult certified = run(spec, true);
  ASSERT_TRUE(all.best && certified.best && certified.certificate);
  EXPECT_EQ(certified.refined.size(), all.refined.size());
  EXPECT_EQ(all.best->torque_capacity_Nm, certified.best->torque_capacity_Nm);
  EXPECT_FALSE(certified.certificate->objective_bounded);
}

TEST(FaceWidths, AreAsWideAsTheLoadNeedsAndNoWider) {
  Specification spec = loaded(10.0);
  spec.objectives = {Objective::kMass};
  spec.bodies.face_width_m = {0.5e-3, 0.5e-3};
  spec.free.face_width_m = {NumberRange{0.5e-3, 20e-3}, NumberRange{0.5e-3, 20e-3}};
  const RefinedSet light = refine(spec, kWinner);
  ASSERT_EQ(light.status, Status::kOptimal) << light.kkt_residual;
  spec.rating->torque_Nm = 15.0;
  const RefinedSet heavy = refine(spec, kWinner);
  ASSERT_EQ(heavy.status, Status::kOptimal) << heavy.kkt_residual;
  EXPECT_GT(heavy.mass_kg, light.mass_kg);
  EXPECT_GT(heavy.train.face_width_m[0], light.train.face_width_m[0]);
  EXPECT_GE(light.mass_kg, best_value(Objective::kMass, spec, kWinner.teeth, 3));
  const design::Design design = design_of(spec, light);
  EXPECT_EQ(design.masses.face_width_m[0], light.train.face_width_m[0]);
  EXPECT_EQ(design.rating->face_width_m[1], light.train.face_width_m[1]);
}

TEST(FaceWidths, OfOneValueAreNoVariable) {
  Specification spec = loaded(10.0);
  const RefinedSet fixed = refine(spec, kWinner);
  spec.free.face_width_m = {NumberRange{kWidth_m, kWidth_m}, NumberRange{kWidth_m, kWidth_m}};
  const RefinedSet same = refine(spec, kWinner);
  EXPECT_EQ(fixed.eta_b, same.eta_b);
  EXPECT_EQ(same.train.face_width_m[0], kWidth_m);
}

TEST(FaceWidths, MoreFreedomIsNeverWorse) {
  Specification spec = loaded(10.0);
  const RefinedSet fixed = refine(spec, kWinner);
  spec.free.face_width_m = {NumberRange{1e-3, 3e-3}, NumberRange{1e-3, 3e-3}};
  const RefinedSet free = refine(spec, kWinner);
  ASSERT_EQ(free.status, Status::kOptimal);
  ASSERT_EQ(fixed.status, Status::kOptimal);
  EXPECT_GE(free.eta_b, fixed.eta_b - 1e-8);
}

}  // namespace
}  // namespace gear3k::optimize::strength_test
