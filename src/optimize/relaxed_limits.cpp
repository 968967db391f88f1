#include "optimize/relaxed_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "design/evaluation.hpp"
#include "optimize/blocking.hpp"
#include "optimize/slsqp.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// Limits of which pairs are made.
constexpr std::size_t kMostPaired = 5;
/// Sets of a search of which it is asked how far a limit has to give way.
constexpr std::size_t kMostMeasured = 48;
/// Limits that are named for less than this share of what the most named one is are left out
/// together first.
constexpr double kSeldom = 0.05;
/// Searches between the stated value and one that has a design, and the share of the stated one at
/// which they end.
constexpr int kRelaxedHalvings = 4;
constexpr double kShortWay = 0.05;

/// What holds without a preset; empty: nothing.
std::optional<double> bare_limit(CheckId check) {
  // Walls of bores that are stated never vanish.
  constexpr double kLeastWall_m = 1e-6;
  if (check == CheckId::kWall) return kLeastWall_m;
  static const design::Limits bare = design::default_limits();
  return bare[check];
}

Specification without(const Specification& spec, std::span<const LimitOf> limits) {
  Specification own = spec;
  for (const LimitOf& limit : limits) number_of(own.limits, limit) = bare_limit(*limit.check);
  return own;
}

double stated_number(const Specification& spec, const LimitOf& limit) {
  return *number_of(spec.limits, limit);
}

/// Whether a limit is that of a check of a mesh (negative: of none).
bool holds_mesh(const Specification& spec, const LimitOf& limit, int mesh) {
  if (limit.place >= 0) return mesh == limit.place;
  return limit.check != CheckId::kNormalBacklash ||
         !spec.limits.mesh_backlash_m[static_cast<std::size_t>(mesh)];
}

/// A limit rounded to three digits in its unit, towards what is easier to keep; one that is no more
/// than rounding off 0 is 0 where that is easier.
double rounded_looser(const design::CheckRecord& record, double limit_si) {
  constexpr double kNothing = 1e-9;  // in the unit
  const double value = units::from_si(limit_si, record.unit);
  if (value == 0.0 || (std::abs(value) < kNothing && (value > 0.0) == record.at_least)) return 0.0;
  // Of whole numbers of digits: their quotient is the number of few digits next to the value.
  const double exponent = std::floor(std::log10(std::abs(value))) - 2.0;
  const double power = std::pow(10.0, std::abs(exponent));
  // What is a whole number of digits to rounding stays.
  constexpr double kRounding = 1e-6;
  const double digits = exponent < 0.0 ? value * power : value / power;
  const double whole =
      record.at_least ? std::floor(digits + kRounding) : std::ceil(digits - kRounding);
  return units::to_si(exponent < 0.0 ? whole / power : whole * power, record.unit);
}

/// Where a limit has to be that a set has a design near its own, all other limits
/// kept; empty where none was found.
/// @param own  the specification under which it is an optimum
std::optional<double> nearest_limit(const Specification& spec, const Specification& own,
                                    const RefinedSet& set, const LimitOf& limit) {
  constexpr std::string_view kGivesWay = "what gives way";
  const design::CheckRecord& record = design::check_record(*limit.check);
  const double stated = stated_number(spec, limit);
  Specification tight = own;
  number_of(tight.limits, limit) = stated;
  std::optional<SetProblem> problem =
      problem_of(tight, set, std::numeric_limits<double>::infinity());
  if (!problem) return std::nullopt;
  for (ConstraintRow& row : problem->problem.rows) {
    const bool own_row = row.check && row.check->record->id == record.id &&
                         holds_mesh(spec, limit, row.check->subject.member);
    if (own_row) row.name = kGivesWay;
  }
  const SolveOutcome nearest = least_violation(problem->problem, problem->v, {}, kGivesWay);
  std::vector<double> g(problem->problem.rows.size());
  if (!std::isfinite(nearest.violation) ||
      !evaluate<double>(problem->problem, used(problem->problem, nearest.v), g)) {
    return std::nullopt;
  }
  const std::vector<Miss> misses = misses_of(problem->problem, g);
  if (misses.empty()) return stated;
  if (misses.size() > 1 || misses.front().name != kGivesWay) return std::nullopt;
  const double amount = misses.front().amount * units::si_per(record.unit);
  return stated + (record.at_least ? -amount : amount);
}

/// The value that a limit is of in a design, the worst of its own; empty where it has none.
std::optional<double> value_in_design(const Specification& spec, const RefinedSet& set,
                                      const LimitOf& limit) {
  const auto outcome = design::evaluate(design_of(spec, set));
  const auto* const evaluation = std::get_if<design::Evaluation>(&outcome);
  if (evaluation == nullptr) return std::nullopt;
  std::optional<double> worst;
  for (const design::CheckResult& result : evaluation->checks) {
    if (result.record->id != *limit.check) continue;
    const auto mesh = std::ranges::find(train::kMeshNames, result.mesh) - train::kMeshNames.begin();
    if (!holds_mesh(spec, limit, static_cast<int>(mesh))) continue;
    const bool worse =
        !worst || (result.record->at_least ? result.value < *worst : result.value > *worst);
    if (worse) worst = result.value;
  }
  return worst;
}

class Relaxation {
 public:
  Relaxation(const Specification& spec, const OptimizeResult& blocked, Progress& progress,
             std::size_t most_refined)
      : spec_(spec), blocked_(blocked), progress_(progress), most_refined_(most_refined) {}

  /// @returns empty where no design was found without them, or the search was stopped
  std::optional<Freed> free(std::span<const LimitOf> limits) {
    const Specification own = without(spec_, limits);
    const OptimizeResult result = any_design(own);
    if (!result.best) return limits.size() == 1 ? nearest_blocked(limits.front()) : std::nullopt;
    Freed freed{.limits = {}, .set = *result.best};
    for (const LimitOf& limit : limits) {
      freed.limits.push_back({.of = limit,
                              .stated_si = stated_number(spec_, limit),
                              .relaxed_si = bare_limit(*limit.check)});
    }
    Specification relaxed = own;
    // The last first: the others are as far out as they may be while it is tightened.
    for (std::size_t k = limits.size(); k-- > 0;) {
      tighten(relaxed, result.refined, freed, k);
    }
    if (limits.size() == 1) {
      const bool at_least = limits.front().at_least;
      if (auto nearest = nearest_blocked(limits.front())) {
        const auto& own_limit = freed.limits.front().relaxed_si;
        const double other = *nearest->limits.front().relaxed_si;
        const bool nearer = !own_limit || (at_least ? other > *own_limit : other < *own_limit);
        if (nearer) freed = *std::move(nearest);
      }
      bisect(own, freed);
    }
    return freed;
  }

  /// Whether a design was found with all of them left out.
  bool frees(std::span<const LimitOf> limits) {
    return any_design(without(spec_, limits)).best.has_value();
  }

  /// The set of the search that a limit's check blocks alone by least, with the limit given way by
  /// that; empty where there is none, or it has no design then.
  [[nodiscard]] std::optional<Freed> nearest_blocked(const LimitOf& limit) const {
    const design::CheckRecord& record = design::check_record(*limit.check);
    const RefinedSet* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const RefinedSet& set : blocked_.refined) {
      if (set.status != Status::kNoFeasibleFound || set.blocked_together) continue;
      for (const Miss& miss : set.blocked_by) {
        if (miss.name != record.name || !(miss.amount > 0.0) || miss.amount >= least) continue;
        nearest = &set;
        least = miss.amount;
      }
    }
    if (nearest == nullptr || progress_.stop.load()) return std::nullopt;
    const double stated = stated_number(spec_, limit);
    const double miss_si = least * units::si_per(record.unit);
    const double given_way =
        rounded_looser(record, record.at_least ? stated - miss_si : stated + miss_si);
    Specification tried = spec_;
    number_of(tried.limits, limit) = given_way;
    RefinedSet set = refine(tried, nearest->candidate);
    if (!has_design(set.status)) return std::nullopt;
    return Freed{.limits = {{.of = limit, .stated_si = stated, .relaxed_si = given_way}},
                 .set = std::move(set)};
  }

 private:
  OptimizeResult any_design(const Specification& spec) {
    ++progress_.searches;
    return optimize(
        spec, progress_,
        {.best_only = true, .certify = false, .any = true, .most_refined = most_refined_});
  }

  /// Searches anew half way to the stated limit while that has a design, or the way is short.
  void bisect(const Specification& own, Freed& freed) {
    RelaxedLimit& limit = freed.limits.front();
    const design::CheckRecord& record = design::check_record(*limit.of.check);
    double refused = limit.stated_si;
    for (int k = 0; k < kRelaxedHalvings && limit.relaxed_si && !progress_.stop.load(); ++k) {
      const double middle = rounded_looser(record, 0.5 * (refused + *limit.relaxed_si));
      const double way = std::abs(*limit.relaxed_si - refused);
      if (way <= kShortWay * std::abs(limit.stated_si) || middle == *limit.relaxed_si) break;
      Specification tried = own;
      number_of(tried.limits, limit.of) = middle;
      const OptimizeResult result = any_design(tried);
      if (!result.best) {
        refused = middle;
        continue;
      }
      limit.relaxed_si = middle;
      freed.set = *result.best;
      tighten(tried, result.refined, freed, 0);
    }
  }

  /// Brings the limit back to the nearest value at which one of the sets has a design.
  void tighten(Specification& relaxed, const std::vector<RefinedSet>& sets, Freed& freed,
               std::size_t place) const {
    RelaxedLimit& limit = freed.limits[place];
    const design::CheckRecord& record = design::check_record(*limit.of.check);
    const double sense = record.at_least ? 1.0 : -1.0;  // limits that are harder to keep are more
    struct Near {
      const RefinedSet* set;
      double limit;
    };
    std::vector<Near> near;
    const auto measure = [&](const RefinedSet& set) {
      if (const auto value = nearest_limit(spec_, relaxed, set, limit.of)) {
        near.push_back({.set = &set, .limit = *value});
      }
      // Where it is without being asked to be nearer.
      if (const auto value = value_in_design(relaxed, set, limit.of)) {
        near.push_back({.set = &set, .limit = *value});
      }
    };
    if (place + 1 == freed.limits.size()) {
      std::size_t measured = 0;
      for (const RefinedSet& set : sets) {
        if (!has_design(set.status) || measured == kMostMeasured) continue;
        if (progress_.stop.load()) return;
        measure(set);
        ++measured;
      }
    } else {
      measure(freed.set);
    }
    std::ranges::stable_sort(
        near, [&](const Near& a, const Near& b) { return sense * a.limit > sense * b.limit; });
    constexpr std::size_t kTries = 4;
    for (std::size_t k = 0; k < std::min(kTries, near.size()); ++k) {
      Specification tried = relaxed;
      const double value = rounded_looser(record, near[k].limit);
      if (!(sense * value < sense * limit.stated_si)) continue;
      if (limit.relaxed_si && !(sense * value > sense * *limit.relaxed_si)) break;
      number_of(tried.limits, limit.of) = value;
      RefinedSet set = refine(tried, near[k].set->candidate);
      if (!has_design(set.status)) continue;
      limit.relaxed_si = value;
      relaxed = std::move(tried);
      freed.set = std::move(set);
      return;
    }
  }

  const Specification& spec_;
  const OptimizeResult& blocked_;
  Progress& progress_;
  std::size_t most_refined_;
};

bool has_walls(const Specification& spec) {
  const auto& bores_m = spec.bodies.bore_radius_m;
  return spec.bodies.ring_rim_m > 0.0 ||
         std::ranges::any_of(bores_m, [](double radius_m) { return radius_m > 0.0; });
}

/// Sets that each limit is named for.
std::vector<std::size_t> sets_named(const OptimizeResult& blocked,
                                    std::span<const LimitOf> limits) {
  std::vector<std::size_t> counts(limits.size(), 0);
  for_each_set(blocked, [&](std::size_t, const std::optional<RefinedSet>& set) {
    if (!set) return;
    for (const Miss& miss : set->blocked_by) {
      for (std::size_t k = 0; k < limits.size(); ++k) {
        counts[k] += design::check_record(*limits[k].check).name == miss.name ? 1 : 0;
      }
    }
  });
  return counts;
}

}  // namespace

std::vector<LimitOf> limits_that_may_give_way(const Specification& spec) {
  std::vector<LimitOf> limits;
  for (const design::CheckRecord& record : design::check_records()) {
    const bool of_teeth =
        record.id == CheckId::kHuntingTooth || record.id == CheckId::kAllowedTeeth;
    if (!record.threshold || record.rating || of_teeth || !spec.limits[record.id]) continue;
    if (record.id == CheckId::kWall && !has_walls(spec)) continue;
    const double sense = record.at_least ? 1.0 : -1.0;
    const auto bare = bare_limit(record.id);
    const auto add = [&](int place) {
      const LimitOf limit{.check = record.id, .place = place, .at_least = record.at_least};
      const double stated = stated_number(spec, limit);
      if (!bare || sense * stated > sense * *bare) limits.push_back(limit);
    };
    const auto& of_mesh = spec.limits.mesh_backlash_m;
    const bool backlash = record.id == CheckId::kNormalBacklash;
    if (!backlash || std::ranges::any_of(of_mesh, [](const auto& own) { return !own; })) add(-1);
    for (int mesh = 0; backlash && mesh < train::kMeshCount; ++mesh) {
      if (of_mesh[static_cast<std::size_t>(mesh)]) add(mesh);
    }
  }
  return limits;
}

RelaxedLimits relax_limits(const Specification& spec, const OptimizeResult& blocked,
                           Progress& progress, std::size_t most_refined) {
  RelaxedLimits result;
  const std::vector<LimitOf> limits = limits_that_may_give_way(spec);
  progress.stage = Progress::Stage::kRelaxed;
  progress.stage_done = 0;
  progress.searches = 0;
  progress.stage_total = limits.size();
  Relaxation relaxation(spec, blocked, progress, most_refined);
  const auto try_to_free = [&](std::span<const LimitOf> together) {
    if (auto freed = relaxation.free(together)) result.freed.push_back(*std::move(freed));
    ++progress.stage_done;
    return !progress.stop.load();
  };
  const std::vector<std::size_t> counts = sets_named(blocked, limits);
  const std::size_t most = limits.empty() ? 0 : std::ranges::max(counts);
  std::vector<LimitOf> seldom;
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const bool rare = static_cast<double>(counts[k]) < kSeldom * static_cast<double>(most);
    if (rare) seldom.push_back(limits[k]);
  }
  // Where a search without all of them finds none, none is made without each: the sets that miss
  // one of them alone are left.
  const bool none_of_seldom = seldom.size() > 1 && !relaxation.frees(seldom);
  if (none_of_seldom) progress.stage_total -= seldom.size();
  const auto try_nearest = [&](const LimitOf& limit) {
    if (auto freed = relaxation.nearest_blocked(limit)) result.freed.push_back(*std::move(freed));
    return !progress.stop.load();
  };
  for (const LimitOf& limit : limits) {
    const bool skipped = none_of_seldom && std::ranges::find(seldom, limit) != seldom.end();
    if (!(skipped ? try_nearest(limit) : try_to_free(std::array{limit}))) break;
    result.alone.push_back(limit);
  }
  if (result.freed.empty() && !progress.stop.load()) {
    std::vector<std::size_t> order(limits.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::stable_sort(order, std::ranges::greater(),
                             [&](std::size_t k) { return counts[k]; });
    order.resize(std::min(order.size(), kMostPaired));
    progress.stage_total += order.size() * (order.size() - (order.empty() ? 0 : 1)) / 2;
    for (std::size_t b = 1; b < order.size() && !progress.stop.load(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        const std::array pair{limits[order[a]], limits[order[b]]};
        if (!try_to_free(pair)) break;
        result.paired.push_back(pair);
      }
    }
  }
  result.interrupted = progress.stop.load();
  progress.stage = Progress::Stage::kOne;
  return result;
}

}  // namespace gear3k::optimize
