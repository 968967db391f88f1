// What flanks and roots ask of a tooth set, as bounds have it: against random designs, and against
// searches that do not use the bounds.

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "design/loaded_train.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"
#include "strength/mesh_rating.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/strength/steel.hpp"

namespace gear3k::optimize::flank_bounds_test {
namespace {

using design::CheckId;
using rig::DeterministicRandom;
using test::with_chance;

constexpr double kRounding = 1e-9;

strength::GearMaterial random_material(DeterministicRandom& random) {
  strength::GearMaterial material = strength::steel_700_290();
  switch (random.index(4)) {
    case 0:
      material.record.hardness_scale = strength::HardnessScale::kBrinell;
      material.hardness = random.between(140.0, 400.0);
      break;
    case 1:
      material.record.group = strength::MaterialGroup::kCaseHardened;
      material.record.flank_limit.constant_Pa = 1500e6;
      break;
    case 2:
      material = {.record = *strength::find_material("POM")};
      break;
    default:
      break;
  }
  return material;
}

/// Any load, with everything that a flank's rating can depend on.
strength::RatingTask random_rating(DeterministicRandom& random) {
  strength::RatingTask task;
  if (with_chance(random, 0.5)) {
    for (auto& material : task.material) material = random_material(random);
  } else {
    task.material.fill(random_material(random));
  }
  task.torque_Nm = random.between(1.0, 60.0);
  task.face_width_m = {random.between(3e-3, 15e-3), random.between(3e-3, 15e-3)};
  if (with_chance(random, 0.6)) task.speed_rad_s = random.between(5.0, 800.0);
  if (task.speed_rad_s > 0.0 && with_chance(random, 0.5)) {
    task.life_s = random.between(1e5, 1e8);
  } else {
    task.teeth.cycles = std::pow(10.0, random.between(3.0, 10.5));
  }
  if (with_chance(random, 0.5)) {
    task.accuracy_grade = static_cast<int>(5 + random.index(4));
    task.misalignment_m = random.between(0.0, 20e-6);
  }
  if (with_chance(random, 0.5)) task.teeth.flank_roughness_m = random.between(1e-6, 10e-6);
  if (with_chance(random, 0.3)) {
    task.gear_teeth[train::kP1] = {.flank_roughness_m = random.between(1e-6, 10e-6),
                                   .cycles = std::pow(10.0, random.between(3.0, 10.5))};
  }
  if (with_chance(random, 0.5)) task.viscosity40_m2_s = random.between(30e-6, 400e-6);
  if (with_chance(random, 0.3)) task.factors.application = random.between(1.0, 2.0);
  if (with_chance(random, 0.3)) task.factors.dynamic = random.between(1.0, 2.0);
  if (with_chance(random, 0.3)) task.factors.flank_face = random.between(1.0, 2.0);
  if (with_chance(random, 0.3)) task.factors.mesh_load_source = strength::MeshLoadSource::kM56;
  if (with_chance(random, 0.3)) task.teeth.flank_safety_min = random.between(0.8, 2.0);
  if (with_chance(random, 0.3)) {
    task.gear_teeth[random.index(train::kGearCount)].flank_safety_min = random.between(0.8, 2.0);
  }
  task.pitting_allowed = with_chance(random, 0.3);
  task.ambient_K = random.between(260.0, 340.0);
  return task;
}

/// Rated with its losses, each mesh in the direction that loads it more.
/// @returns empty where it cannot be rated: ISO 6336 has no stiffness for such shifts
std::optional<strength::TrainRating<double>> rated(const Specification& spec,
                                                   const train::TrainGeometry<double>& train,
                                                   const strength::RatingTask& task,
                                                   double torque_Nm, bool roots = false) {
  std::array<geometry::ToothForm<double>, train::kGearCount> forms;
  std::ranges::transform(train.gears, forms.begin(), geometry::make_tooth_form<double>);
  auto loaded = design::loaded_train<double>(
      train, forms, task.face_width_m,
      {efficiency::constant_friction<double>(spec.friction, train.teeth, true),
       efficiency::constant_friction<double>(spec.friction, train.teeth, false)},
      spec.friction.model);
  if (!roots) loaded.roots = {};
  try {
    return strength::rate_train(loaded, task, strength::Drive::kEither, torque_Nm,
                                strength::StiffnessPart::kFactors);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// Least S_H − S_H,min of a rating; infinite where none is judged or there is no rating.
double least_margin(const std::optional<strength::TrainRating<double>>& rating,
                    const strength::RatingTask& task) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; rating && k < train::kMeshCount; ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& tooth = rating->mesh[k].teeth[i];
      if (!tooth.flank_limit_stated) continue;
      const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
      least = std::min(least, tooth.flank_safety - strength::least_flank_safety(task, gear));
    }
  }
  return least;
}

TEST(FlankNeeds, NoRatedDesignHasMoreSafetyThanItsModuleAllows) {
  int judged = 0, unbounded = 0, back = 0;
  double closest = 0.0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const test::RandomTask task = test::random_task(seed, 2);
    DeterministicRandom random(1000 + seed);
    for (const Candidate& candidate : task.candidates) {
      const strength::RatingTask load = random_rating(random);
      for (const RefinementProblem& problem : test::problems_of(task.spec, candidate)) {
        for (int trial = 0; trial < 20; ++trial) {
          Point v{};
          for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
            v[k] = random.between(problem.lower[k], problem.upper[k]);
          }
          const auto train = train::make_train_geometry(parameters_at(problem, used(problem, v)));
          if (!train) continue;
          const auto rating = rated(task.spec, *train, load, load.torque_Nm);
          if (!rating) continue;
          strength::FlankExtremes extremes{.teeth = candidate.teeth,
                                           .planets = candidate.planets,
                                           .greatest_face_width_m = load.face_width_m,
                                           .pressure_angle_rad = task.spec.pressure_angle_rad,
                                           .dissipative = friction_is_dissipative(task.spec)};
          const double slack = trial % 2 == 0 ? 1.0 : 1.5;  // a favour never raises the need
          for (std::size_t k = 0; k < train::kMeshCount; ++k) {
            const auto [first, second] = train::kMeshGears[k];
            const auto& gear1 = train->gears[static_cast<std::size_t>(first)];
            const auto& gear2 = train->gears[static_cast<std::size_t>(second)];
            const double module = gear1.gear.module_m;
            extremes.greatest_module_m[static_cast<std::size_t>(train::stage_of(first))] =
                slack * module;
            extremes.greatest_curvature[k] =
                slack * strength::pitch_point_curvature(gear1, gear2, train->meshes[k]).reduced_m /
                module;
          }
          const auto needs = strength::flank_needs(load, extremes);
          for (std::size_t k = 0; k < train::kMeshCount; ++k) {
            for (std::size_t i = 0; i < 2; ++i) {
              const auto& tooth = rating->mesh[k].teeth[i];
              if (!tooth.flank_limit_stated) continue;
              if (needs[k].load_m2[i] == 0.0) {
                ++unbounded;
                continue;
              }
              const auto& flank = rating->mesh[k].flank;
              const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
              const double z = needs[k].single_contact[i]
                                   ? (i == 0 ? flank.single_contact1 : flank.single_contact2).value
                                   : 1.0;
              const double module = train->gears[gear].gear.module_m;
              const double most = strength::least_flank_safety(load, gear) * module /
                                  (z * flank.contact_ratio.value) *
                                  std::sqrt(train->meshes[k].tan_alpha_w / needs[k].load_m2[i]);
              EXPECT_LE(tooth.flank_safety, most * (1.0 + kRounding))
                  << "seed " << seed << " mesh " << k << " member " << i;
              closest = std::max(closest, tooth.flank_safety / most);
              ++judged;
              back += train::g2(candidate.teeth) > 1.0 ? 1 : 0;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(judged, 5000);
  EXPECT_GT(back, 500);
  EXPECT_GT(judged, 10 * unbounded);
  EXPECT_GT(closest, 0.999) << "the bound is not reached where nothing is lost";
}

/// A point: both ends alike.
strength::RootRange root_range_at(const train::TrainGeometry<double>& train, std::size_t mesh,
                                  std::size_t member) {
  const auto& gears = train::kMeshGears[mesh];
  const auto& own = train.gears[static_cast<std::size_t>(gears[member])];
  const auto& mate = train.gears[static_cast<std::size_t>(gears[1 - member])];
  const auto& at = train.meshes[mesh];
  const double m = own.gear.module_m;
  const double tip = geometry::tip_curvature_radius(own) / m;
  const double mate_tip = geometry::tip_curvature_radius(mate) / m;
  const double tangent = std::abs(mate.gear.kind == geometry::GearKind::kRing
                                      ? mate.base_radius_m - own.base_radius_m
                                      : mate.base_radius_m + own.base_radius_m) /
                         m * at.tan_alpha_w;
  const double by_mate =
      at.base_pitch_m / m +
      (mate.gear.kind == geometry::GearKind::kRing ? mate_tip - tangent : tangent - mate_tip);
  return {.least_shift = own.gear.profile_shift,
          .greatest_shift = own.gear.profile_shift,
          .least_tip = tip,
          .greatest_tip = tip,
          .least_by_mate = by_mate - kRounding,
          .greatest_by_mate = by_mate + kRounding,
          .least_contact_ratio = at.contact_ratio,
          .greatest_contact_ratio = at.contact_ratio};
}

TEST(RootNeeds, NoRatedToothHasMoreSafetyThanItsModuleAllows) {
  int judged = 0, plastic = 0, unbounded = 0;
  double closest = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const test::RandomTask task = test::random_task(seed, 2);
    DeterministicRandom random(3000 + seed);
    for (const Candidate& candidate : task.candidates) {
      strength::RatingTask load = random_rating(random);
      if (with_chance(random, 0.5)) load.teeth.load_reversal = false;
      if (with_chance(random, 0.5)) load.teeth.root_roughness_m = random.between(0.5e-6, 20e-6);
      if (with_chance(random, 0.3)) load.teeth.root_safety_min = random.between(0.8, 2.5);
      for (const RefinementProblem& problem : test::problems_of(task.spec, candidate)) {
        for (int trial = 0; trial < 10; ++trial) {
          Point v{};
          for (std::size_t k = 0; k < static_cast<std::size_t>(problem.variables); ++k) {
            v[k] = random.between(problem.lower[k], problem.upper[k]);
          }
          const auto train = train::make_train_geometry(parameters_at(problem, used(problem, v)));
          if (!train) continue;
          const auto rating = rated(task.spec, *train, load, load.torque_Nm, true);
          if (!rating) continue;
          strength::FlankExtremes extremes{.teeth = candidate.teeth,
                                           .planets = candidate.planets,
                                           .greatest_face_width_m = load.face_width_m,
                                           .pressure_angle_rad = task.spec.pressure_angle_rad,
                                           .dissipative = friction_is_dissipative(task.spec)};
          extremes.greatest_curvature.fill(1.0);
          for (const std::size_t gear : {train::kP1, train::kP2}) {
            extremes.greatest_module_m[gear == train::kP1 ? 0 : 1] =
                train->gears[gear].gear.module_m;
          }
          const auto needs = strength::root_needs(load, extremes);
          for (std::size_t k = 0; k < train::kMeshCount; ++k) {
            for (std::size_t i = 0; i < 2; ++i) {
              const auto& tooth = rating->mesh[k].teeth[i];
              const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
              const auto& geometry = train->gears[gear];
              if (!tooth.root_limit_stated || geometry.gear.kind == geometry::GearKind::kRing) {
                EXPECT_EQ(needs[k][i].load_m2, 0.0);
                continue;
              }
              const strength::RootTable table =
                  strength::make_root_table(geometry, geometry.gear.profile_shift);
              const double least =
                  strength::least_root_module2(table, needs[k][i], root_range_at(*train, k, i));
              if (least == 0.0) {
                ++unbounded;
                continue;
              }
              const double module = geometry.gear.module_m;
              const double most = strength::least_root_safety(load, gear) * module * module / least;
              EXPECT_LE(tooth.root_safety, most * (1.0 + kRounding))
                  << "seed " << seed << " mesh " << k << " member " << i;
              closest = std::max(closest, tooth.root_safety / most);
              plastic += tooth.plastic ? 1 : 0;
              ++judged;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(judged, 2000);
  EXPECT_GT(plastic, 200);
  EXPECT_GT(judged, 3 * unbounded);
  EXPECT_GT(closest, 0.999) << "the bound is not reached where nothing is lost";
}

class RandomLoads : public testing::TestWithParam<int> {};

TEST_P(RandomLoads, NoTrainThatCarriesItsLoadIsRuledOutAndNoMissIsOverstated) {
  int carried = 0, ruled_out = 0;
  for (int n = 0; n < 12; ++n) {
    const auto seed = static_cast<std::uint64_t>(12 * GetParam() + n + 1);
    test::RandomTask task = test::random_task(seed, 2);
    DeterministicRandom random(2000 + seed);
    for (const Candidate& candidate : task.candidates) {
      strength::RatingTask load = random_rating(random);
      const auto problems = test::problems_of(task.spec, candidate);
      int left = 4;  // designs of a set
      test::search_designs(
          problems, 3, seed, [&](const RefinementProblem& p, const SolveOutcome& design) {
            if (left-- <= 0) return;
            const auto train = train::make_train_geometry(parameters_at(p, used(p, design.v)));
            // The greatest torque that its flanks carry, by bisection.
            const auto margin = [&](double torque_Nm) {
              return least_margin(rated(task.spec, *train, load, torque_Nm), load);
            };
            double low = 1e-6, high = 1e5;
            if (!std::isfinite(margin(low)) || margin(low) < 0.0 || margin(high) >= 0.0) return;
            while (high > low * (1.0 + 1e-9)) {
              const double middle = std::sqrt(low * high);
              (margin(middle) >= 0.0 ? low : high) = middle;
            }
            Specification spec = task.spec;
            for (const CheckId id :
                 {CheckId::kRootSafety, CheckId::kToothTemperature, CheckId::kToothWear,
                  CheckId::kRimThickness, CheckId::kNotchRange}) {
              spec.limits[id] = std::nullopt;
            }
            spec.limits[CheckId::kFlankSafety] = 0.0;
            const std::array one{candidate};
            Progress progress;
            load.torque_Nm = low;
            spec.rating = load;
            const SetBounds at_capacity(spec, one, progress);
            for (const SetBound& bound : {at_capacity.of(0), at_capacity.sharpened(0)}) {
              EXPECT_FALSE(bound.infeasible)
                  << "seed " << seed << " " << design::check_record(bound.infeasible->check).name;
              EXPECT_LE(-design.objective,
                        (first_objective(spec) == Objective::kForwardEfficiency ? bound.eta_f
                                                                                : bound.eta_b) +
                            kRounding)
                  << "seed " << seed;
            }
            ++carried;
            const double torque_Nm = low * std::pow(10.0, random.uniform());
            load.torque_Nm = torque_Nm;
            spec.rating = load;
            const SetBounds beyond(spec, one, progress);
            const auto proof = beyond.of(0).infeasible;
            if (!proof) return;
            ++ruled_out;
            EXPECT_EQ(proof->check, CheckId::kFlankSafety)
                << "seed " << seed << " " << proof->miss_si << " " << proof->alone << " torque "
                << torque_Nm << " of " << low << " violation " << design.violation;
            EXPECT_LE(proof->miss_si, -margin(torque_Nm) + kRounding) << "seed " << seed;
          });
    }
  }
  EXPECT_GT(carried, 0);
  EXPECT_GT(ruled_out, 0);
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomLoads, testing::Range(0, 4));

/// A small space with loads that some of its sets cannot carry.
Specification small_loaded(double torque_Nm, double ratio) {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
  spec.ratio.target = ratio;
  spec.teeth.S = {.min = 12, .max = 13};
  spec.teeth.P1 = {.min = 20, .max = 40};
  strength::RatingTask task;
  task.material.fill(strength::steel_700_290());
  task.torque_Nm = torque_Nm;
  task.face_width_m = {8e-3, 8e-3};
  task.teeth.root_safety_min = 1.5;
  task.teeth.flank_safety_min = 1.2;
  spec.rating = task;
  return spec;
}

/// A load that decides, and the check that rules out by it.
struct DecidingLoad {
  double ratio = 0.0, torque_Nm = 60.0, root_safety = 1.5, flank_safety = 1.2;
  CheckId check = CheckId::kFlankSafety;
};
constexpr std::array<DecidingLoad, 3> kDecidingLoads{
    {{.ratio = 96.2},
     {.ratio = -96.2},
     {.ratio = 96.2, .root_safety = 2.5, .flank_safety = 0.5, .check = CheckId::kRootSafety}}};

TEST(CertifiedUnderLoad, AgreesWithRefiningEverySetWithoutBounds) {
  for (const auto& [ratio, torque_Nm, root_safety, flank_safety, check] : kDecidingLoads) {
    Specification spec = small_loaded(torque_Nm, ratio);
    spec.rating->teeth.root_safety_min = root_safety;
    spec.rating->teeth.flank_safety_min = flank_safety;
    Progress progress;
    const OptimizeResult certified = optimize(spec, progress, {.best_only = true});
    ASSERT_TRUE(certified.best && certified.certificate);
    const Refiner refiner(spec);
    const ShiftTable shifts(spec, certified.search.candidates);
    const StopFlag never;
    double best = 0.0;
    std::size_t carried = 0, ruled_out = 0;
    for (std::size_t k = 0; k < certified.search.candidates.size(); ++k) {
      const Candidate& candidate = certified.search.candidates[k];
      const auto set =
          refiner.refine(candidate, shifts.of(candidate.teeth), std::array{ModuleBound{}}, never);
      const SetBound bound = certified.bounds->of(k);
      if (bound.infeasible && bound.infeasible->check == check) ++ruled_out;
      if (set->status != Status::kOptimal) continue;
      ++carried;
      best = std::max(best, set->eta_b);
      EXPECT_FALSE(bound.infeasible) << k;
      EXPECT_LE(set->eta_b, bound.eta_b + kRounding) << k;
    }
    EXPECT_NEAR(certified.best->eta_b, best, 1e-8) << ratio;
    EXPECT_GE(certified.certificate->global_bound, best - kRounding);
    EXPECT_GT(carried, 0U);
    EXPECT_GT(ruled_out, 0U) << ratio;
    const auto& bounded = certified.certificate->strength_bounded;
    EXPECT_TRUE(std::ranges::count(bounded, "flank_safety"));
    EXPECT_TRUE(std::ranges::count(bounded, "root_safety"));
    EXPECT_TRUE(
        std::ranges::count(certified.certificate->strength_not_bounded, "root_safety of rings"));
  }
}

TEST(CertifiedUnderLoad, GivesTheSameAtOneAndFourThreads) {
  const Specification spec = small_loaded(60.0, 96.2);
  const int before = omp_get_max_threads();
  const auto run = [&](int threads) {
    omp_set_num_threads(threads);
    Progress progress;
    return optimize(spec, progress, {.best_only = true});
  };
  const OptimizeResult one = run(1);
  const OptimizeResult four = run(4);
  omp_set_num_threads(before);
  ASSERT_EQ(one.refined.size(), four.refined.size());
  for (std::size_t k = 0; k < one.refined.size(); ++k) {
    EXPECT_EQ(one.refined[k].eta_b, four.refined[k].eta_b);
    EXPECT_EQ(one.refined[k].train.profile_shift, four.refined[k].train.profile_shift);
    EXPECT_EQ(reason_of(one.refined[k]), reason_of(four.refined[k]));
  }
  EXPECT_EQ(one.certificate->global_bound, four.certificate->global_bound);
  for (std::size_t k = 0; k < one.search.candidates.size(); ++k) {
    EXPECT_EQ(one.bounds->of(k).eta_b, four.bounds->of(k).eta_b);
  }
}

}  // namespace
}  // namespace gear3k::optimize::flank_bounds_test
