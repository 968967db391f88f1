#include "optimize/set_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "design/evaluation.hpp"
#include "efficiency/train_efficiency.hpp"
#include "io/files/specification_file.hpp"
#include "optimize/optimizer.hpp"
#include "optimize/refine.hpp"
#include "tests/optimize/random_specification.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::set_bounds_test {
namespace {

using rig::DeterministicRandom;
using test::problems_of;
using test::random_task;
using test::random_workshop_task;
using test::RandomTask;
using test::search_designs;

constexpr double kRounding = 1e-12;

// ---- What the bounds of a train rest on ----------------------------------------------------

/// Mesh efficiencies with which a train runs backwards.
efficiency::MeshEfficiencies<double> random_efficiencies(DeterministicRandom& random,
                                                         const train::ToothSet& z) {
  for (;;) {
    const double least = random.between(0.2, 0.99);
    const efficiency::MeshEfficiencies<double> eta{
        random.between(least, 1.0), random.between(least, 1.0), random.between(least, 1.0)};
    if (efficiency::backdriving_margin(z, eta) > 1e-6) return eta;
  }
}

template <class Combine>
efficiency::MeshEfficiencies<double> combined(const efficiency::MeshEfficiencies<double>& a,
                                              const efficiency::MeshEfficiencies<double>& b,
                                              const Combine& combine) {
  return {combine(a[0], b[0]), combine(a[1], b[1]), combine(a[2], b[2])};
}

class TrainOfMeshes : public testing::TestWithParam<bool> {
 protected:
  /// Teeth with G2 on the side that the parameter names.
  train::ToothSet teeth(DeterministicRandom& random) {
    for (;;) {
      const train::ToothSet z = test::random_teeth(random);
      if ((train::g2(z) < 1.0) == GetParam()) return z;
    }
  }
};

TEST_P(TrainOfMeshes, EfficienciesRiseWithThatOfEachMesh) {
  DeterministicRandom random(31);
  for (int n = 0; n < 4000; ++n) {
    const train::ToothSet z = teeth(random);
    const auto eta = random_efficiencies(random, z);
    auto better = eta;
    const std::size_t mesh = random.index(3);
    better[mesh] = random.between(eta[mesh], 1.0);
    EXPECT_GE(efficiency::backward_efficiency(z, better),
              efficiency::backward_efficiency(z, eta) - kRounding);
    EXPECT_GE(efficiency::forward_efficiency(z, better),
              efficiency::forward_efficiency(z, eta) - kRounding);
  }
}

TEST_P(TrainOfMeshes, ReciprocalBackwardEfficiencyIsConvexInStage1sLosses) {
  DeterministicRandom random(32);
  for (int n = 0; n < 4000; ++n) {
    const train::ToothSet z = teeth(random);
    const auto a = random_efficiencies(random, z);
    auto b = random_efficiencies(random, z);
    b[2] = a[2];  // stage 2's loss stays
    if (efficiency::backdriving_margin(z, b) <= 1e-6) continue;
    const double share = random.uniform();
    const auto between =
        combined(a, b, [&](double x, double y) { return share * x + (1.0 - share) * y; });
    const double chord = share / efficiency::backward_efficiency(z, a) +
                         (1.0 - share) / efficiency::backward_efficiency(z, b);
    EXPECT_LE(1.0 / efficiency::backward_efficiency(z, between), chord * (1.0 + 1e-10));
  }
}

TEST_P(TrainOfMeshes, LogarithmOfForwardEfficiencyIsConvexInLogarithmsOfMeshEfficiencies) {
  DeterministicRandom random(33);
  for (int n = 0; n < 4000; ++n) {
    const train::ToothSet z = teeth(random);
    const auto a = random_efficiencies(random, z);
    const auto b = random_efficiencies(random, z);
    const double share = random.uniform();
    const auto between = combined(a, b, [&](double x, double y) {
      return std::exp(share * std::log(x) + (1.0 - share) * std::log(y));
    });
    const double chord = share * std::log(efficiency::forward_efficiency(z, a)) +
                         (1.0 - share) * std::log(efficiency::forward_efficiency(z, b));
    EXPECT_LE(std::log(efficiency::forward_efficiency(z, between)), chord + 1e-10);
  }
}

INSTANTIATE_TEST_SUITE_P(Ratios, TrainOfMeshes, testing::Bool(), [](const auto& positive) {
  return std::string(positive.param ? "OutputTurnsWithInput" : "OutputTurnsBack");
});

// ---- Over random specifications ------------------------------------------------------------

/// Blocks of specifications, by number.
class RandomSpecifications : public testing::TestWithParam<int> {
 protected:
  static constexpr int kPerBlock = 8;
  template <class Visit>
  void for_each_task(const Visit& visit) const {
    for (int n = 0; n < kPerBlock; ++n) {
      const auto seed = static_cast<std::uint64_t>(kPerBlock * GetParam() + n + 1);
      for (const auto make : {random_task, random_workshop_task}) {
        const RandomTask task = make(seed, 3);
        if (task.candidates.empty()) continue;
        Progress progress;
        SetBounds bounds(task.spec, task.candidates, progress);
        std::vector<std::uint32_t> all(task.candidates.size());
        std::iota(all.begin(), all.end(), 0U);
        bounds.tie(all, progress);
        visit(seed, task, bounds);
      }
    }
  }
};

double efficiency_bound(const SetBound& bound, Objective objective) {
  return objective == Objective::kForwardEfficiency ? bound.eta_f : bound.eta_b;
}

void expect_below(const SetBound& bound, double eta, Objective objective, const std::string& what) {
  EXPECT_FALSE(bound.infeasible) << what << " is called infeasible by "
                                 << design::check_record(bound.infeasible->check).name;
  EXPECT_LE(eta, efficiency_bound(bound, objective) + kRounding) << what;
}

TEST_P(RandomSpecifications, NoDesignThatIsFoundLiesAboveItsBound) {
  int found = 0;
  for_each_task([&](std::uint64_t seed, const RandomTask& task, const SetBounds& bounds) {
    const Objective objective = first_objective(task.spec);
    for (std::size_t k = 0; k < task.candidates.size(); ++k) {
      const std::string what = "seed " + std::to_string(seed) + " set " + std::to_string(k);
      const SetBound usual = bounds.of(k);
      const SetBound sharp = bounds.sharpened(k);
      EXPECT_LE(sharp.eta_b, usual.eta_b) << what;
      EXPECT_LE(sharp.eta_f, usual.eta_f) << what;
      // Every check a row, no start and no box from the bounds.
      const auto best =
          search_designs(problems_of(task.spec, task.candidates[k]), 5, seed,
                         [&](const RefinementProblem&, const SolveOutcome& design) {
                           if (-design.objective > efficiency_bound(sharp, objective) + kRounding ||
                               sharp.infeasible) {
                             expect_below(sharp, -design.objective, objective, what + " sharpened");
                           }
                         });
      if (!best) continue;
      ++found;
      expect_below(usual, best->objective, objective, what + " " + best->how);
      expect_below(sharp, best->objective, objective, what + " sharpened " + best->how);
    }
  });
  EXPECT_GT(found, 0);
}

TEST_P(RandomSpecifications, RefinedSetsLieBelowTheBoundsOfBothDirections) {
  for_each_task([&](std::uint64_t seed, const RandomTask& task, const SetBounds& bounds) {
    const Refiner refiner(task.spec);
    const StopFlag never;
    for (std::size_t k = 0; k < task.candidates.size(); ++k) {
      const SetBound bound = bounds.of(k);
      if (bound.infeasible) continue;
      const auto set =
          refiner.refine(task.candidates[k], bounds.shifts().of(task.candidates[k].teeth),
                         bounds.by_modules(k), never);
      if (set->status != Status::kOptimal) continue;
      const std::string what = "seed " + std::to_string(seed) + " set " + std::to_string(k);
      EXPECT_LE(set->eta_b, bound.eta_b + kRounding) << what;
      EXPECT_LE(set->eta_f, bound.eta_f + kRounding) << what;
    }
  });
}

TEST_P(RandomSpecifications, AmountThatALimitHasToGiveWayIsALeastOne) {
  using design::CheckId;
  for_each_task([&](std::uint64_t seed, const RandomTask& task, const SetBounds& bounds) {
    for (std::size_t k = 0; k < task.candidates.size(); ++k) {
      const auto proof = bounds.of(k).infeasible;
      if (!proof || !proof->alone || proof->miss_si <= 0.0) continue;
      const double eased_by = 0.95 * proof->miss_si;
      const bool least = design::check_record(proof->check).at_least;
      Specification eased = task.spec;
      if (auto& limit = eased.limits[proof->check]) *limit += least ? -eased_by : eased_by;
      for (auto& limit : eased.limits.mesh_backlash_m) {
        if (proof->check == CheckId::kNormalBacklash && limit) *limit -= eased_by;
      }
      const auto found = search_designs(problems_of(eased, task.candidates[k]), 3, seed,
                                        [](const RefinementProblem&, const SolveOutcome&) {});
      EXPECT_FALSE(found) << "seed " << seed << " set " << k << " "
                          << design::check_record(proof->check).name;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomSpecifications, testing::Range(1, sample(4, 7)));

TEST(RandomSpecification, WorkshopLimitsAreNamedInProofs) {
  using design::CheckId;
  std::set<CheckId> named;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const RandomTask task = random_workshop_task(seed, 3);
    if (task.candidates.empty()) continue;
    Progress progress;
    const SetBounds bounds(task.spec, task.candidates, progress);
    for (std::size_t k = 0; k < task.candidates.size(); ++k) {
      if (const auto proof = bounds.of(k).infeasible) named.insert(proof->check);
    }
  }
  for (const CheckId id :
       {CheckId::kSpecificSliding, CheckId::kTipThicknessLength, CheckId::kSunRootDiameter,
        CheckId::kGearboxDiameter, CheckId::kWall, CheckId::kSameModule}) {
    EXPECT_TRUE(named.contains(id)) << design::check_record(id).name;
  }
}

TEST(RandomSpecification, DrawsEveryKindOfWhichBoundsKnow) {
  std::set<std::string> seen;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    const RandomTask task = random_task(seed, 3);
    const Specification& spec = task.spec;
    if (task.candidates.empty()) continue;
    const auto saw = [&](bool yes, const char* what) {
      if (yes) seen.insert(what);
    };
    saw(spec.ratio.target > 0.0, "turns with");
    saw(spec.ratio.target < 0.0, "turns back");
    saw(spec.limits.model == backlash::LostMotionModel::kPaper, "paper");
    saw(spec.limits.model == backlash::LostMotionModel::kKinematic, "kinematic");
    saw(spec.khk_tip[train::kS] && spec.khk_tip[train::kP1], "khk both");
    saw(spec.khk_tip[train::kS] && !spec.khk_tip[train::kP1], "khk S");
    saw(!spec.khk_tip[train::kS] && spec.khk_tip[train::kP1], "khk P1");
    const auto& backlash = spec.limits[design::CheckId::kNormalBacklash];
    saw(!backlash, "backlash free");
    saw(backlash && *backlash < 0.0, "backlash negative");
    saw(backlash && *backlash > 0.0, "backlash positive");
    const auto& most = spec.limits[design::CheckId::kContactRatioMax];
    saw(most && *most < 2.0, "epsilon below 2");
    saw(most && *most > 2.0, "epsilon above 2");
    saw(efficiency::depends_on_mesh(random_workshop_task(seed, 3).spec.friction.extension),
        "friction by mesh");
    seen.insert("loss " + std::to_string(static_cast<int>(spec.friction.model)));
    seen.insert("planets " + std::to_string(spec.planets.front()));
    seen.insert("objective " + std::to_string(static_cast<int>(first_objective(spec))));
  }
  EXPECT_EQ(seen.size(), 4U + 3U + 3U + 2U + 4U + 4U + 2U + 1U);
}

// ---- Best only -----------------------------------------------------------------------------

Specification example(const std::string& name) {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name);
}

OptimizeOptions best_only() {
  OptimizeOptions options;
  options.best_only = true;
  return options;
}

struct Task {
  const char* name;
  Specification (*make)();
};

class BestOnly : public testing::TestWithParam<Task> {};

bool same_bits(const RefinedSet& a, const RefinedSet& b) {
  return a.index == b.index && a.candidate == b.candidate && a.status == b.status &&
         a.eta_b == b.eta_b && a.eta_f == b.eta_f &&
         a.train.profile_shift == b.train.profile_shift && a.train.module_m == b.train.module_m &&
         a.train.center_distance_m == b.train.center_distance_m && a.kkt_residual == b.kkt_residual;
}

TEST_P(BestOnly, FindsTheDesignThatRefiningEverySetFindsAndCertifiesIt) {
  const Specification spec = GetParam().make();
  Progress all_progress, best_progress;
  const OptimizeResult all = optimize(spec, all_progress);
  const OptimizeResult best = optimize(spec, best_progress, best_only());
  ASSERT_TRUE(all.best && best.best);
  EXPECT_TRUE(same_bits(*all.best, *best.best));
  EXPECT_FALSE(all.certificate);
  ASSERT_TRUE(best.certificate);
  const Certificate& c = *best.certificate;
  EXPECT_EQ(c.best, merit_of(spec, *all.best));
  EXPECT_EQ(c.refined, best.refined.size());
  EXPECT_EQ(c.refined + c.bounded + c.infeasible, best.search.candidates.size());
  EXPECT_LT(c.refined, all.refined.size()) << "the bounds spared nothing";
  EXPECT_GE(c.global_bound, c.best);
  EXPECT_EQ(c.largest_unrefined_bound.has_value(), c.bounded > 0);
  EXPECT_LT(c.largest_unrefined_bound.value_or(0.0), c.best);
  std::set<std::uint32_t> refined;
  for (const RefinedSet& set : best.refined) refined.insert(set.index);
  std::size_t open = 0;
  for (const RefinedSet& set : all.refined) {
    const SetBound bound = all.bounds->of(set.index);
    const double value = efficiency_bound(bound, first_objective(spec));
    if (set.status == Status::kOptimal) {
      EXPECT_LE(merit_of(spec, set), value + kRounding) << set.index;
      EXPECT_LE(merit_of(spec, set), c.global_bound + kRounding) << set.index;
    }
    if (!refined.contains(set.index)) {
      EXPECT_LE(value, *c.largest_unrefined_bound) << set.index;
      continue;
    }
    const double sharp = efficiency_bound(all.bounds->sharpened(set.index), first_objective(spec));
    EXPECT_LE(sharp, value) << set.index;
    if (set.status == Status::kOptimal) {
      EXPECT_LE(merit_of(spec, set), sharp + kRounding) << set.index;
    }
    open += sharp > c.best + kProven ? 1 : 0;
    EXPECT_LE(sharp, std::max(c.global_bound, c.best) + kRounding) << set.index;
  }
  EXPECT_EQ(c.open, open);
}

Specification one_sun(const std::string& name) {
  Specification spec = example(name);
  spec.teeth.S = {.min = 12, .max = 12};
  return spec;
}

INSTANTIATE_TEST_SUITE_P(Tasks, BestOnly,
                         testing::Values(Task{"Rp96", [] { return one_sun("rp96.toml"); }},
                                         Task{"Rp96Forward",
                                              [] {
                                                Specification spec = one_sun("rp96.toml");
                                                spec.objectives = {Objective::kForwardEfficiency};
                                                return spec;
                                              }},
                                         Task{"Kinematic", [] { return one_sun("ratio-96.toml"); }},
                                         Task{"TurnsBack",
                                              [] {
                                                Specification spec = one_sun("ratio-96.toml");
                                                spec.ratio.target = -96.2;
                                                return spec;
                                              }},
                                         Task{"SlidingWithHighContactRatios",
                                              [] {
                                                Specification spec = one_sun("rp96.toml");
                                                spec.friction.model =
                                                    efficiency::LossModel::kSliding;
                                                spec.limits[design::CheckId::kContactRatioMax] =
                                                    3.0;
                                                return spec;
                                              }},
                                         Task{"MayInterfere",
                                              [] {
                                                Specification spec = one_sun("rp96.toml");
                                                spec.limits.model =
                                                    backlash::LostMotionModel::kKinematic;
                                                spec.limits[design::CheckId::kNormalBacklash] =
                                                    -20e-6;
                                                return spec;
                                              }}),
                         [](const auto& task) { return std::string(task.param.name); });

TEST(BestOnlySearch, RefusesToJudgeByACalibratedModel) {
  Specification spec = one_sun("rp96.toml");
  spec.model.emplace();
  spec.operating_point.emplace();
  Progress progress;
  EXPECT_THROW(optimize(spec, progress, best_only()), std::invalid_argument);
}

/// Limits of 0 and below are no scale: the module is.
TEST(EmptyStages, MissALengthThatIsNoScaleByPartsOfTheModule) {
  Specification spec = io::read_specification(GEAR3K_SOURCE_DIR "/examples/rp96.toml");
  spec.teeth.S = {.min = 12, .max = 12};
  spec.rack.dedendum = 0.6;
  spec.limits[design::CheckId::kRootClearance] = std::nullopt;
  Progress progress;
  const ToothSearchResult search = search_teeth(spec, progress);
  for (const double limit_m : {0.0, -0.02e-3}) {
    spec.limits[design::CheckId::kRootClearanceLength] = limit_m;
    const SetBounds bounds(spec, search.candidates, progress);
    int proven = 0;
    for (std::size_t k = 0; k < search.candidates.size(); ++k) {
      const auto infeasible = bounds.of(k).infeasible;
      if (!infeasible || infeasible->check != design::CheckId::kRootClearanceLength) continue;
      if (!infeasible->alone) continue;
      ++proven;
      EXPECT_NEAR(infeasible->violation, infeasible->miss_si / length_scale_m(spec), 1e-12);
    }
    EXPECT_GT(proven, 0) << limit_m;
  }
}

/// A gap that no gearbox has: the proven miss is of its size, and leaves room for what designs
/// have.
TEST(EmptyStages, MissALimitThatIsFarOffByMuch) {
  Specification spec = io::read_specification(GEAR3K_SOURCE_DIR "/examples/rp96.toml");
  spec.teeth.S = {.min = 12, .max = 12};
  Progress progress;
  const OptimizeResult free = optimize(spec, progress);
  ASSERT_TRUE(free.best);
  spec.limits[design::CheckId::kPlanetGap] = 60.0;
  const ToothSearchResult search = search_teeth(spec, progress);
  const SetBounds bounds(spec, search.candidates, progress);
  int proven = 0;
  for (std::size_t k = 0; k < search.candidates.size(); ++k) {
    const auto infeasible = bounds.of(k).infeasible;
    if (!infeasible || infeasible->check != design::CheckId::kPlanetGap) continue;
    if (!infeasible->alone) continue;  // no amount is proven
    ++proven;
    EXPECT_GT(infeasible->miss_si, 5.0);
    for (const RefinedSet& set : free.refined) {
      if (set.status != Status::kOptimal || set.candidate != search.candidates[k]) continue;
      const auto e = std::get<design::Evaluation>(design::evaluate(design_of(spec, set)));
      double least = kInfinity;
      for (const design::CheckResult& c : e.checks) {
        if (c.record->id == design::CheckId::kPlanetGap) least = std::min(least, c.value);
      }
      EXPECT_LE(least, 60.0 - infeasible->miss_si + 1e-6);
    }
  }
  EXPECT_GT(proven, 0);
}

}  // namespace
}  // namespace gear3k::optimize::set_bounds_test
