#include "optimize/optimizer.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <map>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "io/files/specification_file.hpp"
#include "tests/optimize/rp96_problem.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::optimizer_test {
namespace {

Specification example(const std::string& name) {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/" + name);
}

/// Every tooth set of a run that was not interrupted.
std::vector<RefinedSet> sets_of(const OptimizeResult& result) {
  std::vector<RefinedSet> sets;
  for_each_set(result, [&](std::size_t k, const std::optional<RefinedSet>& set) {
    EXPECT_TRUE(set) << k;
    if (set) sets.push_back(*set);
  });
  return sets;
}

const Specification& rp96_specification(Refine refine) {
  static std::map<Refine, Specification> specifications;
  if (!specifications.contains(refine)) {
    specifications[refine] = example("rp96.toml");
    specifications[refine].solver.refine = refine;
  }
  return specifications[refine];
}

const OptimizeResult& rp96_result(Refine refine) {
  static std::map<Refine, OptimizeResult> results;
  if (!results.contains(refine)) {
    Progress progress;
    results.emplace(refine, optimize(rp96_specification(refine), progress));
  }
  return results.at(refine);
}

/// The sets of rp96 with suns of 12 and 13 teeth, every set in the long sample.
Specification few_suns(Refine refine) {
  Specification spec = rp96_specification(refine);
  if (!long_samples()) spec.teeth.S = {.min = 12, .max = 13};
  return spec;
}

const RefinedSet& same_teeth(const std::vector<RefinedSet>& sets, const RefinedSet& of) {
  return *std::ranges::find(sets, of.candidate, &RefinedSet::candidate);
}

rp96::Values typed_anew(const RefinedSet& s) {
  const auto& z = s.candidate.teeth;
  const auto& x = s.train.profile_shift;
  return rp96::evaluate({z.S, z.P1, z.R1, z.P2, z.R2, x[0], x[1], x[2], x[3], x[4],
                         s.train.module_m[1] / s.train.module_m[0],
                         s.train.center_distance_m / s.train.module_m[0]});
}

/// Largest violation that counts as feasible (docs/interface.md), as the typed-anew problem scales.
constexpr double kFeasible = 1.01e-6;

TEST(OptimizeRp96, ReachesWhatSciPyFinds) {
  const OptimizeResult& r = rp96_result(Refine::kSlsqp);
  const std::vector<RefinedSet> sets = sets_of(r);
  ASSERT_EQ(sets.size(), 654U);
  std::size_t optimal = 0;
  for (const RefinedSet& s : sets) optimal += s.status == Status::kOptimal ? 1 : 0;
  EXPECT_GE(optimal, 428U);
  ASSERT_TRUE(r.best);
  const RefinedSet& best = *r.best;
  const train::ToothSet expected{.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118};
  EXPECT_EQ(best.candidate.teeth, expected);
  const double half_digit = 0.5e-5;
  EXPECT_GE(best.eta_b, 0.94340);
  EXPECT_NEAR(best.eta_f, 0.94493, half_digit);
  const auto set_with = [&](const train::ToothSet& z) {
    return *std::ranges::find_if(sets, [&](const RefinedSet& s) { return s.candidate.teeth == z; });
  };
  EXPECT_GE(set_with({.S = 12, .P1 = 52, .R1 = 117, .P2 = 45, .R2 = 114}).eta_b,
            0.94183 - half_digit);
}

TEST(OptimizeRp96, EveryOptimumIsFeasibleInTheProblemTypedAnew) {
  for (const RefinedSet& s : rp96_result(Refine::kSlsqp).refined) {
    if (s.status != Status::kOptimal) continue;
    const rp96::Values v = typed_anew(s);
    EXPECT_GE(v.worst_margin, -kFeasible);
    EXPECT_NEAR(v.eta_b, s.eta_b, 1e-12);
    EXPECT_NEAR(v.eta_f, s.eta_f, 1e-12);
    EXPECT_LT(s.kkt_residual, 1e-5);
  }
}

TEST(OptimizeRp96, SlsqpAndIpoptAgreeOnEveryFeasibleSet) {
  const auto slsqp = sets_of(rp96_result(Refine::kSlsqp));
  Specification spec = few_suns(Refine::kIpopt);
  spec.solver.starts = 1;
  Progress progress;
  std::size_t compared = 0;
  for (const RefinedSet& ipopt : sets_of(optimize(spec, progress))) {
    const RefinedSet& other = same_teeth(slsqp, ipopt);
    EXPECT_EQ(other.status, ipopt.status);
    if (other.status != Status::kOptimal) continue;
    ++compared;
    EXPECT_NEAR(other.eta_b, ipopt.eta_b, 2e-6);
    EXPECT_GE(typed_anew(ipopt).worst_margin, -kFeasible);
  }
  EXPECT_GT(compared, sample(40U, 428U - 1U));
}

TEST(OptimizeRp96, PolishingByIpoptLosesNothing) {
  const auto slsqp = sets_of(rp96_result(Refine::kSlsqp));
  Progress progress;
  std::size_t compared = 0;
  for (const RefinedSet& both : sets_of(optimize(few_suns(Refine::kBoth), progress))) {
    const RefinedSet& other = same_teeth(slsqp, both);
    if (other.status != Status::kOptimal) continue;
    ++compared;
    EXPECT_GE(both.eta_b, other.eta_b - 2e-9);
    EXPECT_LE(both.kkt_residual, std::max(1e-6, other.kkt_residual));
  }
  EXPECT_GT(compared, sample(40U, 428U - 1U));
}

TEST(OptimizeRp96, PublishedTeethReachTheValuesOfTheReference) {
  Specification spec = example("rp96.toml");
  const Candidate proposed{.teeth = {.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92},
                           .planets = 3};
  const Candidate bilateral{.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81},
                            .planets = 3};
  const double half_digit = 0.5e-4;
  EXPECT_GE(refine(spec, proposed).eta_b, 0.9091 - half_digit);
  EXPECT_GE(refine(spec, bilateral).eta_b, 0.9093 - half_digit);
  spec.profile_shift.max = 2.0;
  EXPECT_GE(refine(spec, proposed).eta_b, 0.9218 - half_digit);
  EXPECT_GE(refine(spec, bilateral).eta_b, 0.9224 - half_digit);
}

bool same_bits(const RefinedSet& a, const RefinedSet& b) {
  return a.candidate == b.candidate && a.status == b.status && reason_of(a) == reason_of(b) &&
         a.eta_b == b.eta_b && a.eta_f == b.eta_f &&
         a.train.profile_shift == b.train.profile_shift && a.train.module_m == b.train.module_m &&
         a.train.center_distance_m == b.train.center_distance_m && a.kkt_residual == b.kkt_residual;
}

TEST(Optimize, ResultsDoNotDependOnTheNumberOfThreads) {
  Specification spec = example("ratio-96.toml");
  spec.teeth.S = {.min = 12, .max = sample(12, 13)};
  std::optional<OptimizeResult> first;
  for (const int threads : sample(std::vector{1, 4}, std::vector{1, 2, 4})) {
    omp_set_num_threads(threads);
    Progress progress;
    OptimizeResult result = optimize(spec, progress);
    if (!first) {
      first = std::move(result);
      ASSERT_GT(first->refined.size(), 20U);
      continue;
    }
    const auto sets = sets_of(result), first_sets = sets_of(*first);
    ASSERT_EQ(sets.size(), first_sets.size());
    for (std::size_t k = 0; k < sets.size(); ++k) {
      EXPECT_TRUE(same_bits(sets[k], first_sets[k]));
      EXPECT_EQ(result.bounds->of(k).eta_b, first->bounds->of(k).eta_b);
    }
    ASSERT_TRUE(result.best && first->best);
    EXPECT_TRUE(same_bits(*result.best, *first->best));
    EXPECT_EQ(result.pareto, first->pareto);
  }
  omp_set_num_threads(omp_get_num_procs());
}

/// What a specification asks for must hold in the analysis of the design that it gets.
void expect_design_keeps_its_limits(const Specification& spec, const RefinedSet& set) {
  const auto evaluation = design::evaluate(design_of(spec, set));
  ASSERT_TRUE(std::holds_alternative<design::Evaluation>(evaluation));
  const auto& e = std::get<design::Evaluation>(evaluation);
  for (const design::CheckResult& c : e.checks) {
    EXPECT_TRUE(c.ok) << c.record->name << " " << c.mesh << c.gear << " margin " << c.margin;
  }
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const ModuleChoice& choice = spec.module[stage];
    const double m = set.train.module_m[stage];
    if (choice.range_m) {
      const double rounding = 1e-6 * length_scale_m(spec);
      EXPECT_GE(m, choice.range_m->min - rounding);
      EXPECT_LE(m, choice.range_m->max + rounding);
    } else {
      EXPECT_NE(std::ranges::find(choice.series_m, m), choice.series_m.end());
    }
  }
}

/// Expects it of every optimum.  @returns how many there are
std::size_t optima_within_limits(const Specification& spec, const OptimizeResult& result) {
  std::size_t optimal = 0;
  for (const RefinedSet& s : result.refined) {
    if (s.status != Status::kOptimal) continue;
    ++optimal;
    expect_design_keeps_its_limits(spec, s);
  }
  return optimal;
}

struct ModuleCase {
  const char* name;
  ModuleChoice stage1, stage2;
};

class OptimizeModules : public testing::TestWithParam<ModuleCase> {};

TEST_P(OptimizeModules, EveryOptimumKeepsItsLimits) {
  Specification spec = example("ratio-96.toml");
  spec.teeth.S = {.min = 12, .max = sample(12, 14)};
  spec.teeth.P1 = {.min = 40, .max = 64};
  spec.module = {GetParam().stage1, GetParam().stage2};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress);
  EXPECT_GT(optima_within_limits(spec, result), 3U);
}

INSTANTIATE_TEST_SUITE_P(
    Choices, OptimizeModules,
    testing::Values(
        ModuleCase{"BothRanges", {NumberRange{0.5e-3, 1e-3}, {}}, {NumberRange{0.5e-3, 1e-3}, {}}},
        ModuleCase{"BothSeries", {{}, {0.5e-3, 0.6e-3}}, {{}, {0.5e-3, 0.55e-3, 0.6e-3}}},
        ModuleCase{"SeriesAndRange", {{}, {0.5e-3, 0.6e-3}}, {NumberRange{0.4e-3, 1e-3}, {}}},
        ModuleCase{"RangeAndSeries", {NumberRange{0.4e-3, 1e-3}, {}}, {{}, {0.5e-3, 0.6e-3}}}),
    [](const auto& variant) { return std::string(variant.param.name); });

TEST(Optimize, OutputThatTurnsBackwardsIsRefinedToo) {
  Specification spec = example("ratio-96.toml");
  spec.ratio.target = -96.2;
  spec.teeth.S = {.min = 12, .max = 13};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress);
  ASSERT_TRUE(result.best);
  const RefinedSet& best = *result.best;
  EXPECT_LT(train::ratio(best.candidate.teeth), 0.0);
  EXPECT_GT(train::g2(best.candidate.teeth), 1.0);
  EXPECT_GT(best.eta_b, 0.8);
  expect_design_keeps_its_limits(spec, best);
}

TEST(Optimize, LowerLimitOfThePapersLostMotionHolds) {
  Specification spec = example("rp96.toml");
  spec.limits[design::CheckId::kOutputBacklashMin] = units::to_si(6.0, units::Unit::kArcmin);
  spec.teeth.S = {.min = 12, .max = 12};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress);
  ASSERT_TRUE(result.best);
  for (const RefinedSet& s : sets_of(result)) {
    if (s.status == Status::kOptimal) expect_design_keeps_its_limits(spec, s);
  }
}

TEST(Optimize, LowerLimitOfZeroIsMetByEitherBranchOfThePapersMaximum) {
  // With interference allowed a mesh may fall below zero while the other one holds the limit.
  Specification spec = example("rp96.toml");
  spec.limits[design::CheckId::kNormalBacklash] = -20e-6;
  const Candidate candidate{.teeth = {.S = 12, .P1 = 36, .R1 = 87, .P2 = 42, .R2 = 111},
                            .planets = 3};
  spec.solver.starts = 8;
  const double without_limit = refine(spec, candidate).eta_b;
  spec.limits[design::CheckId::kOutputBacklashMin] = 0.0;
  EXPECT_NEAR(refine(spec, candidate).eta_b, without_limit, 1e-8);
}

TEST(Optimize, ForwardObjectiveBeatsTheBackwardOneForward) {
  Specification spec = example("rp96.toml");
  const Candidate candidate{.teeth = {.S = 12, .P1 = 54, .R1 = 120, .P2 = 47, .R2 = 118},
                            .planets = 3};
  const RefinedSet backward = refine(spec, candidate);
  spec.objectives = {Objective::kForwardEfficiency};
  const RefinedSet forward = refine(spec, candidate);
  EXPECT_GE(forward.eta_f, backward.eta_f - 1e-9);
  EXPECT_LE(forward.eta_b, backward.eta_b + 1e-9);
}

TEST(Optimize, ProvenInfeasibleSetsHaveNoFeasiblePointInTheBox) {
  Specification spec = example("ratio-96.toml");
  spec.limits[design::CheckId::kRingRootDiameter] = 0.055;
  spec.teeth.S = {.min = 12, .max = 13};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress);
  std::size_t proven = 0;
  for (const RefinedSet& s : sets_of(result)) {
    if (s.status != Status::kInfeasible || reason_of(s) != "ring_root_diameter") continue;
    ++proven;
    // At the least module and shift the larger ring is too large already.
    const double m = 0.5e-3;
    const int teeth = std::max(s.candidate.teeth.R1, s.candidate.teeth.R2);
    const double diameter = m * (teeth + 2.0 * 1.25);
    EXPECT_GT(diameter, 0.055);
    // Rings of the same module: the miss is that of the larger one, in mm.
    EXPECT_NEAR(s.blocked_by.front().amount, 1e3 * (diameter - 0.055), 1e-9);
  }
  EXPECT_GT(proven, 10U);
}

TEST(Optimize, SetsWithoutFeasiblePointNameTheConstraintAndItsMiss) {
  Specification spec = example("rp96.toml");
  spec.limits[design::CheckId::kContactRatioMin] = 1.99;
  spec.limits[design::CheckId::kContactRatioMax] = 2.0;
  spec.teeth.S = {.min = 12, .max = 12};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress);
  EXPECT_FALSE(result.best);
  std::size_t known = 0;
  for (const RefinedSet& s : sets_of(result)) {
    EXPECT_TRUE(s.status == Status::kNoFeasibleFound || s.status == Status::kInfeasible);
    ASSERT_FALSE(s.blocked_by.empty());
    EXPECT_FALSE(reason_of(s).empty());
    known += s.blocked_by.front().amount > 0.0 ? 1 : 0;
  }
  EXPECT_GT(2 * known, result.search.candidates.size()) << "most misses are known";
}

TEST(Optimize, TipsAreThickEnoughWhereLargeAndSmallShiftsThinThem) {
  // Without the undercut limit, tips are thin at both ends of this range.
  Specification spec = example("rp96.toml");
  spec.profile_shift = {.min = -2.0, .max = 1.0};
  spec.limits[design::CheckId::kUndercut] = std::nullopt;
  spec.teeth.S = {.min = 10, .max = 11};
  spec.objectives = {Objective::kOuterDiameter};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress);
  EXPECT_GT(optima_within_limits(spec, result), 20U);
}

// Most of the wider range is no gear.
TEST(Optimize, AWiderRangeOfShiftsLosesNoDesign) {
  Specification spec = example("ratio-96.toml");
  spec.module = {ModuleChoice{NumberRange{0.5e-3, 1e-3}, {}},
                 ModuleChoice{NumberRange{0.5e-3, 1e-3}, {}}};
  spec.limits[design::CheckId::kTipThickness] = 0.03;
  spec.teeth.S = {.min = 13, .max = 14};
  spec.teeth.P1 = {.min = 55, .max = 59};
  spec.teeth.P2 = {.min = 50, .max = 56};
  Progress progress;
  const auto with_shifts_to = [&](double greatest) {
    spec.profile_shift = {.min = 0.0, .max = greatest};
    return sets_of(optimize(spec, progress));
  };
  const std::vector<RefinedSet> wide = with_shifts_to(5.0);
  int designs = 0;
  for (const RefinedSet& narrow : with_shifts_to(2.0)) {
    if (!has_design(narrow.status)) continue;
    ++designs;
    const RefinedSet& same = same_teeth(wide, narrow);
    EXPECT_TRUE(has_design(same.status));
    EXPECT_GE(same.eta_b, narrow.eta_b - 1e-6);
  }
  EXPECT_GT(designs, 5);
}

TEST(Optimize, WithTheKhkTipRuleNoStartIsSpared) {
  // The same four starts without a bound to lead or to spare them.
  Specification spec = example("rp96.toml");
  spec.khk_tip[train::kS] = spec.khk_tip[train::kP1] = true;
  spec.teeth.S = {.min = 17, .max = 17};
  Progress progress;
  const OptimizeResult led = optimize(spec, progress);
  Specification unbounded = spec;
  unbounded.free.pressure_angle_rad = NumberRange{spec.pressure_angle_rad, spec.pressure_angle_rad};
  const OptimizeResult all = optimize(unbounded, progress);
  std::size_t compared = 0;
  for (const RefinedSet& s : all.refined) {
    const auto ours = set_at(led, s.index);
    if (s.status != Status::kOptimal || !ours || ours->status != Status::kOptimal) continue;
    ++compared;
    EXPECT_GE(ours->eta_b, s.eta_b - 1e-6);
  }
  EXPECT_GT(compared, 10U);
}

TEST(Optimize, MassesWithoutARimGiveADesignThatCanBeReadBack) {
  Specification spec = example("rp96.toml");
  spec.teeth.S = {.min = 12, .max = 12};
  spec.bodies = {.density_kgm3 = 7850.0,
                 .gear_density_kgm3 = {},
                 .face_width_m = {0.01, 0.01},
                 .ring_rim_m = 0.0};
  spec.objectives = {Objective::kMass};
  Progress progress;
  const OptimizeResult result = optimize(spec, progress, {.best_only = true});
  ASSERT_TRUE(result.best);
  const design::Design design =
      io::parse_design(io::design_text(design_of(spec, *result.best)), "best.toml");
  EXPECT_EQ(design.train.teeth, result.best->candidate.teeth);
}

TEST(Optimize, StopKeepsWhatIsDone) {
  const Specification& spec = rp96_specification(Refine::kSlsqp);
  const OptimizeResult& whole = rp96_result(Refine::kSlsqp);
  Progress progress;
  const auto end = [&](std::span<const RefinedSet>) { progress.stop = true; };
  const OptimizeResult part = optimize(spec, progress, {.on_wave = end});
  EXPECT_TRUE(part.interrupted);
  EXPECT_FALSE(part.refined.empty());
  EXPECT_LT(part.refined.size(), whole.refined.size());
  for (const RefinedSet& set : part.refined) {
    const std::optional<RefinedSet> same = set_at(whole, set.index);
    ASSERT_TRUE(same) << set.index;
    EXPECT_EQ(set.candidate, same->candidate);
    EXPECT_EQ(set.status, same->status);
    EXPECT_EQ(set.train.profile_shift, same->train.profile_shift);
    EXPECT_EQ(set.eta_b, same->eta_b);
  }
}

TEST(Optimize, StoppedAtOnceHasNothing) {
  const Specification spec = example("rp96.toml");
  Progress progress;
  progress.stop = true;
  const OptimizeResult result = optimize(spec, progress);
  EXPECT_TRUE(result.interrupted);
  EXPECT_TRUE(result.refined.empty());
  EXPECT_FALSE(result.best);
}

TEST(ParetoFront, HoldsExactlyTheSetsThatNothingDominates) {
  const auto& r = rp96_result(Refine::kSlsqp);
  const auto costs = [](const RefinedSet& s) {
    return std::array{cost_in_steps(Objective::kBackwardEfficiency, s.eta_b),
                      cost_in_steps(Objective::kForwardEfficiency, s.eta_f),
                      cost_in_steps(Objective::kLostMotion, s.lost_motion_rad),
                      cost_in_steps(Objective::kOuterDiameter, s.ring_root_diameter_m)};
  };
  const auto dominates = [&](const RefinedSet& a, const RefinedSet& b) {
    return std::ranges::equal(costs(a), costs(b), std::less_equal<>()) &&
           (costs(a) != costs(b) || a.index < b.index);
  };
  for (std::size_t k = 0; k < r.refined.size(); ++k) {
    if (!has_design(r.refined[k].status)) {
      EXPECT_EQ(std::ranges::find(r.pareto, k), r.pareto.end()) << k;
      continue;
    }
    const bool dominated = std::ranges::any_of(r.refined, [&](const RefinedSet& s) {
      return has_design(s.status) && dominates(s, r.refined[k]);
    });
    const bool on_front = std::ranges::find(r.pareto, k) != r.pareto.end();
    EXPECT_EQ(on_front, !dominated);
  }
}

TEST(ParetoFront, TakesWhatRoundingLeavesOfALimitForEqual) {
  RefinedSet set;
  set.status = Status::kOptimal;
  set.eta_b = set.eta_f = 0.9;
  set.lost_motion_rad = 2.327e-3;
  set.ring_root_diameter_m = 0.076;
  std::vector<RefinedSet> sets(3, set);
  for (std::size_t k = 0; k < sets.size(); ++k) {
    sets[k].index = static_cast<std::uint32_t>(k);
    sets[k].lost_motion_rad -= 1e-13 * static_cast<double>(k);
    sets[k].eta_b -= 1e-12 * static_cast<double>(k);
  }
  EXPECT_EQ(pareto_front(sets), std::vector<std::size_t>{0});
  sets[2].eta_f += 1e-6;
  EXPECT_EQ(pareto_front(sets), std::vector<std::size_t>{2});
  sets[2].ring_root_diameter_m += 1e-6;
  EXPECT_EQ(pareto_front(sets), (std::vector<std::size_t>{0, 2}));
}

// Between the search of the tooth sets and their bounds.
TEST(KnownSets, AreOfARunThatIsStoppedBeforeItComesToThem) {
  const Specification spec = few_suns(Refine::kSlsqp);
  Progress progress;
  const OptimizeResult whole = optimize(spec, progress);
  Progress second;
  const OptimizeResult run =
      optimize(spec, second, {.known = whole.refined, .bound_before = [&](const Candidate&) {
                                second.stop = true;
                                return kInfinity;
                              }});
  EXPECT_TRUE(run.interrupted);
  ASSERT_EQ(run.refined.size(), whole.refined.size());
  for (std::size_t k = 0; k < run.refined.size(); ++k) {
    EXPECT_EQ(run.refined[k].index, whole.refined[k].index);
    EXPECT_EQ(run.refined[k].eta_b, whole.refined[k].eta_b);
  }
  ASSERT_TRUE(run.best);
  EXPECT_EQ(run.best->index, whole.best->index);
  EXPECT_EQ(run.pareto, whole.pareto);
}

}  // namespace
}  // namespace gear3k::optimize::optimizer_test
