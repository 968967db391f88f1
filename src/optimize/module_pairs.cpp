#include "optimize/module_pairs.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <queue>
#include <tuple>

#include "numerics/parallel.hpp"

namespace gear3k::optimize {

namespace {

std::vector<std::optional<double>> module_options(const ModuleChoice& choice) {
  if (choice.range_m) {
    if (choice.range_m->min < choice.range_m->max) return {std::nullopt};
    return {choice.range_m->min};
  }
  return {choice.series_m.begin(), choice.series_m.end()};
}

/// The specification with one module only in a stage, in both where they share it.
Specification with_module(const Specification& spec, std::size_t stage, double m) {
  Specification narrowed = spec;
  const ModuleChoice one{.range_m = std::nullopt, .series_m = {m}};
  narrowed.module[stage] = one;
  if (has_same_module(spec)) narrowed.module = {one, one};
  return narrowed;
}

constexpr RelaxationEffort kOfCell{.weighted = {.boxes = 60, .tolerance = 0.03},
                                   .alone = {.boxes = 12, .tolerance = 0.1}};
constexpr RelaxationEffort kOfStart{.weighted = {.boxes = 200, .tolerance = 0.02},
                                    .alone = {.boxes = 12, .tolerance = 0.1}};
constexpr RelaxationEffort kSharp{.weighted = {.boxes = 2000, .tolerance = 1e-3},
                                  .alone = {.boxes = 200, .tolerance = 1e-2}};

Interval times(const Interval& distance, double module) {
  return {distance.lo * module, distance.hi * module};
}
Interval over(const Interval& distance_m, double module) {
  return {distance_m.lo / module, distance_m.hi / module};
}
/// Both stages' distances are known to kRelaxationSlack.
Interval common(const Interval& a, const Interval& b) {
  return {std::max(a.lo, b.lo) * (1.0 - kRelaxationSlack),
          std::min(a.hi, b.hi) * (1.0 + kRelaxationSlack)};
}

/// Proof that two modules bring the stages to no common centre distance at which both have a
/// design.
Infeasibility no_common_distance() {
  return {.check = design::CheckId::kSameModule, .alone = false, .of_modules = true};
}
/// The same where they have no common distance at all.
Infeasibility modules_apart(const Interval& distance1_m, const Interval& distance2, double m2) {
  // The module of stage 2 has to change by so much at least.
  const double gap =
      std::max(distance1_m.lo / distance2.hi - m2, m2 - distance1_m.hi / distance2.lo);
  return {.check = design::CheckId::kSameModule,
          .miss_si = std::max(0.0, gap),
          .violation = std::max(0.0, gap) / m2,
          .alone = false,
          .of_modules = true};
}

template <class Module>
std::size_t place_of(std::vector<Module>& modules, double m) {
  const auto at = std::ranges::find(modules, m, &Module::m);
  if (at != modules.end()) return static_cast<std::size_t>(at - modules.begin());
  modules.push_back({.m = m, .spec = {}, .relaxer = nullptr, .of = {}});
  return modules.size() - 1;
}

}  // namespace

std::vector<FixedModules> module_combinations(const Specification& spec) {
  std::vector<FixedModules> combinations;
  if (has_same_module(spec)) {
    for (const auto& m : module_options(spec.module[0])) combinations.push_back({m, m});
    return combinations;
  }
  for (const auto& m1 : module_options(spec.module[0])) {
    for (const auto& m2 : module_options(spec.module[1])) combinations.push_back({m1, m2});
  }
  return combinations;
}

bool ModulePairs::ties(const Specification& spec) {
  return has_bounds(spec) &&
         std::ranges::all_of(module_combinations(spec), [](const auto& m) { return m[0] && m[1]; });
}

ModulePairs::ModulePairs(const Specification& spec, std::span<const Candidate> candidates,
                         const StageKeys& keys, std::span<const RelaxedStage1> stage1,
                         std::span<const RelaxedStage2> stage2)
    : spec_(&spec),
      candidates_(candidates),
      keys_(&keys),
      stage1_(stage1),
      stage2_(stage2),
      forward_(first_objective(spec) == Objective::kForwardEfficiency) {
  const std::vector<FixedModules> combinations = module_combinations(spec);
  pairs_.reserve(combinations.size());
  for (std::size_t i = 0; i < combinations.size(); ++i) {
    const double m1 = *combinations[i][0], m2 = *combinations[i][1];
    pairs_.push_back({.combination = i,
                      .place1 = place_of(modules1_, m1),
                      .place2 = place_of(modules2_, m2),
                      .m1 = m1,
                      .m2 = m2});
  }
  for (auto& module : modules1_) {
    module.spec = with_module(spec, 0, module.m);
    module.of.resize(keys.keys[0].size());
  }
  for (auto& module : modules2_) {
    module.spec = with_module(spec, 1, module.m);
    module.of.resize(keys.keys[1].size());
  }
  for (auto& module : modules1_) {
    module.relaxer =
        std::make_unique<StageRelaxer>(module.spec, keys, candidates, std::array{true, false});
    levels_ = module.relaxer->levels();
  }
  for (auto& module : modules2_) {
    module.relaxer =
        std::make_unique<StageRelaxer>(module.spec, keys, candidates, std::array{false, true});
  }
}

Interval ModulePairs::common_distance(std::size_t k, const Pair& pair) const {
  return common(times(stage1_[keys_->of[0][k]].distance, pair.m1),
                times(stage2_[keys_->of[1][k]].distance, pair.m2));
}

Interval ModulePairs::cell_of(const Interval& distances, std::size_t cell) {
  const double width = distances.width() / static_cast<double>(kCells);
  const double lo = distances.lo + static_cast<double>(cell) * width;
  return {lo, cell + 1 == kCells ? distances.hi : lo + width};
}

ModulePairs::Profile1 ModulePairs::profile1(const Module<Profile1>& module, std::size_t key) const {
  Profile1 profile;
  bool empty = true;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    const RelaxedStage1 stage =
        module.relaxer->relax1(key, {.effort = kOfCell,
                                     .sun_weight = stage1_[key].sun_weight,
                                     .distance = cell_of(stage1_[key].distance, cell),
                                     .named = false});
    if (stage.infeasible) {
      profile.infeasible = stage.infeasible;
      return profile;
    }
    for (std::size_t level = 0; level < levels_; ++level) {
      const Stage1Level& at = stage.level[level];
      if (at.empty) continue;
      profile.cell[cell][level] = {.sun = at.sun, .ring = at.ring, .weighted = at.weighted};
      empty = false;
    }
  }
  if (empty) {
    profile.infeasible =
        module.relaxer->relax1(key, {.effort = kOfStart, .sun_weight = stage1_[key].sun_weight})
            .infeasible;
    if (!profile.infeasible)
      profile.infeasible = Infeasibility{.check = design::CheckId::kUndercut, .alone = false};
  }
  return profile;
}

ModulePairs::Profile2 ModulePairs::profile2(const Module<Profile2>& module, std::size_t key) const {
  Profile2 profile;
  for (auto& cell : profile.cell) cell.fill(kInfinity);
  bool empty = true;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    const RelaxedStage2 stage = module.relaxer->relax2(
        key, {.effort = kOfCell, .distance = cell_of(stage2_[key].distance, cell), .named = false},
        most_distance_);
    if (stage.infeasible) {
      profile.infeasible = stage.infeasible;
      return profile;
    }
    for (std::size_t level = 0; level < levels_; ++level) {
      const Stage2Level& at = stage.level[level];
      if (at.empty) continue;
      profile.cell[cell][level] = at.ring;
      empty = false;
    }
  }
  if (empty) {
    profile.infeasible =
        module.relaxer->relax2(key, {.effort = kOfStart}, most_distance_).infeasible;
    if (!profile.infeasible)
      profile.infeasible = Infeasibility{.check = design::CheckId::kUndercut, .alone = false};
  }
  return profile;
}

bool ModulePairs::prepare(std::span<const std::uint32_t> sets, double most_distance,
                          Progress& progress, bool counted) {
  most_distance_ = most_distance;
  struct Need {
    std::size_t stage, place, key;
    auto operator<=>(const Need&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  std::vector<std::vector<char>> needed1(modules1_.size()), needed2(modules2_.size());
  for (auto& needed : needed1) needed.resize(keys_->keys[0].size());
  for (auto& needed : needed2) needed.resize(keys_->keys[1].size());
  for (const std::uint32_t k : sets) {
    for (const Pair& pair : pairs_) {
      if (common_distance(k, pair).empty()) continue;
      needed1[pair.place1][keys_->of[0][k]] = 1;
      needed2[pair.place2][keys_->of[1][k]] = 1;
    }
  }
  std::vector<Need> needs;
  const auto add = [&](std::size_t stage, const auto& modules, const auto& needed) {
    for (std::size_t place = 0; place < modules.size(); ++place) {
      for (std::size_t key = 0; key < needed[place].size(); ++key) {
        if (needed[place][key] != 0 && !modules[place].of[key]) {
          needs.push_back({.stage = stage, .place = place, .key = key});
        }
      }
    }
  };
  add(0, modules1_, needed1);
  add(1, modules2_, needed2);
  if (counted) progress.total += needs.size();
  std::atomic<bool> all = true;
  numerics::parallel_for(needs.size(), [&](std::size_t i) {
    if (progress.stop.load(std::memory_order_relaxed)) {
      all = false;
      return;
    }
    const Need& need = needs[i];
    if (need.stage == 0) {
      auto& module = modules1_[need.place];
      module.of[need.key] = std::make_unique<Profile1>(profile1(module, need.key));
    } else {
      auto& module = modules2_[need.place];
      module.of[need.key] = std::make_unique<Profile2>(profile2(module, need.key));
    }
    if (counted) ++progress.done;
  });
  return all;
}

ModulePairs::PairResult ModulePairs::result_of(std::size_t k, const Pair& pair) const {
  PairResult result;
  const std::size_t key1 = keys_->of[0][k], key2 = keys_->of[1][k];
  const Interval& distance1 = stage1_[key1].distance;
  const Interval& distance2 = stage2_[key2].distance;
  if (common_distance(k, pair).empty()) {
    result.infeasible = modules_apart(times(distance1, pair.m1), distance2, pair.m2);
    return result;
  }
  const Profile1& first = *modules1_[pair.place1].of[key1];
  const Profile2& second = *modules2_[pair.place2].of[key2];
  for (const auto& proof : {first.infeasible, second.infeasible}) {
    if (proof && (!result.infeasible || proof->violation > result.infeasible->violation)) {
      result.infeasible = proof;
    }
  }
  if (result.infeasible) return result;
  const train::ToothSet& z = candidates_[k].teeth;
  bool together = false;
  double greatest = -1.0;
  for (std::size_t i = 0; i < kCells; ++i) {
    const Interval cell1 = times(cell_of(distance1, i), pair.m1);
    for (std::size_t j = 0; j < kCells; ++j) {
      const Interval both = common(cell1, times(cell_of(distance2, j), pair.m2));
      if (both.empty()) continue;
      const BestLevels best = best_levels(
          z, levels_, forward_,
          [&](std::size_t level) -> std::optional<LossRegion> {
            const Losses& at = first.cell[i][level];
            if (at.sun == kInfinity) return std::nullopt;
            return LossRegion{.sun = at.sun,
                              .ring = at.ring,
                              .weighted = at.weighted,
                              .sun_weight = stage1_[key1].sun_weight};
          },
          [&](std::size_t level) -> std::optional<double> {
            const double loss = second.cell[j][level];
            return loss == kInfinity ? std::nullopt : std::optional(loss);
          });
      if (!best.level) continue;
      together = true;
      result.eta_b = std::max(result.eta_b, best.eta_b);
      result.eta_f = std::max(result.eta_f, best.eta_f);
      const double value = forward_ ? best.eta_f : best.eta_b;
      if (value > greatest) {
        greatest = value;
        result.distance_m = both;
      }
    }
  }
  if (!together) result.infeasible = no_common_distance();
  return result;
}

TiedBound ModulePairs::bound(std::size_t k) const {
  TiedBound tied;
  tied.known = true;
  bool feasible = false, one_check = true;
  for (const Pair& pair : pairs_) {
    const PairResult result = result_of(k, pair);
    if (!result.infeasible) {
      feasible = true;
      tied.eta_b = std::max(tied.eta_b, result.eta_b);
      tied.eta_f = std::max(tied.eta_f, result.eta_f);
      continue;
    }
    const Infeasibility& proof = *result.infeasible;
    one_check = one_check && !proof.of_modules &&
                (!tied.infeasible || proof.check == tied.infeasible->check);
    if (!tied.infeasible || proof.violation < tied.infeasible->violation) tied.infeasible = proof;
  }
  if (feasible) {
    tied.infeasible.reset();
  } else if (!one_check && !tied.infeasible->of_modules) {
    // Another pair may open with less of this check.
    tied.infeasible->miss_si = tied.infeasible->violation = 0.0;
  }
  return tied;
}

SetBound ModulePairs::relaxed(std::size_t k, const Pair& pair, const Interval& distance_m,
                              const RelaxationEffort& effort) const {
  const std::size_t key1 = keys_->of[0][k], key2 = keys_->of[1][k];
  const RelaxedStage1 first =
      modules1_[pair.place1].relaxer->relax1(key1, {.effort = effort,
                                                    .sun_weight = stage1_[key1].sun_weight,
                                                    .distance = over(distance_m, pair.m1),
                                                    .named = false});
  const RelaxedStage2 second = modules2_[pair.place2].relaxer->relax2(
      key2, {.effort = effort, .distance = over(distance_m, pair.m2), .named = false},
      most_distance_);
  SetBound bound;
  bound.known = true;
  const bool together =
      !first.infeasible && !second.infeasible &&
      take_best_level(candidates_[k].teeth, first, second, levels_, forward_, bound);
  if (!together) {
    bound.infeasible = no_common_distance();
    bound.eta_b = bound.eta_f = 0.0;
  }
  return bound;
}

std::vector<ModuleBound> ModulePairs::in_order(std::size_t k) const {
  std::vector<ModuleBound> bounds;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const PairResult result = result_of(k, pairs_[i]);
    if (result.infeasible) continue;
    SetBound bound = relaxed(k, pairs_[i], result.distance_m, kOfStart);
    // Where the best cells are empty after all, the middle of what the stages share.
    if (bound.infeasible) bound.stage1.center_distance = result.distance_m.middle() / pairs_[i].m1;
    bound.infeasible.reset();
    bound.known = true;
    bound.eta_b = result.eta_b;
    bound.eta_f = result.eta_f;
    bounds.push_back({.pair = pairs_[i].combination, .bound = bound});
  }
  std::ranges::stable_sort(bounds, [&](const ModuleBound& a, const ModuleBound& b) {
    const auto rank = [&](const ModuleBound& m) {
      const Pair& pair = pairs_[*m.pair];
      return std::tuple(forward_ ? m.bound.eta_f : m.bound.eta_b, pair.m1, pair.m2);
    };
    return rank(a) > rank(b);
  });
  return bounds;
}

SetBound ModulePairs::sharpened(std::size_t k, double enough) const {
  constexpr int kSplits = 64;
  constexpr double kNarrow = 1e-3;  // of the distance
  struct Part {
    const Pair* pair;
    Interval distance_m;
    SetBound bound;
  };
  const auto value = [&](const SetBound& b) { return forward_ ? b.eta_f : b.eta_b; };
  const auto lower = [&](const Part& a, const Part& b) { return value(a.bound) < value(b.bound); };
  std::priority_queue<Part, std::vector<Part>, decltype(lower)> parts(lower);
  const auto add = [&](const Pair& pair, const Interval& distance_m) {
    const SetBound bound = relaxed(k, pair, distance_m, kSharp);
    if (!bound.infeasible) parts.push({.pair = &pair, .distance_m = distance_m, .bound = bound});
  };
  for (const Pair& pair : pairs_) {
    if (const Interval both = common_distance(k, pair); !both.empty()) add(pair, both);
  }
  for (int split = 0; split < kSplits && !parts.empty(); ++split) {
    const Part top = parts.top();
    if (value(top.bound) <= enough || top.distance_m.width() <= kNarrow * top.distance_m.hi) break;
    parts.pop();
    add(*top.pair, {top.distance_m.lo, top.distance_m.middle()});
    add(*top.pair, {top.distance_m.middle(), top.distance_m.hi});
  }
  if (parts.empty()) {
    SetBound none;
    none.known = true;
    none.eta_b = none.eta_f = 0.0;
    none.infeasible = no_common_distance();
    return none;
  }
  SetBound sharp = parts.top().bound;
  // The other efficiency may be greater elsewhere: only the one that decides is sharpened.
  (forward_ ? sharp.eta_b : sharp.eta_f) = 1.0;
  return sharp;
}

}  // namespace gear3k::optimize
