#include "report/result_tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>
#include <vector>

#include "report/limits_report.hpp"
#include "report/tooth_set_text.hpp"

namespace gear3k::report {

using optimize::OptimizeResult;
using optimize::RefinedSet;
using optimize::Specification;
using optimize::Status;
using optimize::ToothSearchResult;

namespace {

/// Whether a check of the load is missed.
bool is_of_load(const optimize::Miss& miss) {
  return std::ranges::any_of(design::check_records(), [&](const design::CheckRecord& record) {
    return record.rating && record.name == miss.name;
  });
}

/// Whether little is known of what blocks a set: it takes several constraints, by no known miss; of
/// the load what can be carried is told.
bool is_vague(const RefinedSet& set) {
  const optimize::Miss& first = set.blocked_by.front();
  return set.blocked_together && !(first.violation > 0.0) && !is_of_load(first);
}
/// Of sets that are blocked alike what says more first: a known miss before one that is not, less
/// of it.
std::tuple<bool, double, std::uint32_t> miss_of(const RefinedSet& set) {
  const double miss = set.blocked_by.front().violation;
  return {!(miss > 0.0), miss, set.index};
}

/// Of a ratio from its target.
std::string percent_off(double ratio, double target) {
  const double percent = 100.0 * std::abs(ratio / target - 1.0);
  return percent < 1000.0 ? fmt::format("{:.3g}", percent) : fmt::format("{:.0f}", percent);
}

}  // namespace

ResultTally tally_of(const OptimizeResult& result) {
  ResultTally tally;
  std::map<std::string_view, RefinedSet> nearest;  // by what blocks it, proven sets apart
  const auto offer = [&](const RefinedSet& set) {
    const bool proven = set.status == Status::kInfeasible;
    const auto [own, is_new] = nearest.try_emplace(proven ? reason_of(set) : "", set);
    const auto key = [](const RefinedSet& s) {
      return std::tuple(is_vague(s), s.blocked_together, miss_of(s));
    };
    if (!is_new && key(set) < key(own->second)) own->second = set;
  };
  optimize::for_each_set(result, [&](std::size_t, const std::optional<RefinedSet>& set) {
    if (!set) {
      ++tally.open;
      return;
    }
    const auto status = static_cast<std::size_t>(set->status);
    ++tally.status[status];
    tally.grid_cut += set->grid_cut ? 1 : 0;
    tally.refinements += set->refinements;
    tally.relaxations += set->relaxations;
    if (set->grid_cut && set->status == Status::kNoFeasibleFound) ++tally.cut_without_design;
    if (optimize::has_design(set->status)) return;
    if (!reason_of(*set).empty()) ++tally.reasons[status][std::string(reason_of(*set))];
    if (set->blocked_by.empty()) return;
    offer(*set);
    if (std::ranges::any_of(set->blocked_by, is_of_load)) ++tally.blocked_by_load;
  });
  // Sets that were tried before those proven empty, whose bounds are no distances: of these what
  // blocks most of them, where that is known well.
  constexpr auto kProven = static_cast<std::size_t>(Status::kInfeasible);
  const auto& proven = tally.reasons[kProven];
  const std::size_t proven_count = tally.status[kProven];
  const auto key = [&](const auto& own) {
    const auto alike = proven.find(std::string(own.first));
    const std::size_t sets = alike == proven.end() ? 0 : alike->second;
    return std::tuple(!own.first.empty(), is_vague(own.second), proven_count - sets,
                      miss_of(own.second));
  };
  if (!nearest.empty()) tally.nearest = std::ranges::min_element(nearest, {}, key)->second;
  return tally;
}

bool only_failed(const ResultTally& tally) {
  const auto count = [&](Status status) { return tally.status[static_cast<std::size_t>(status)]; };
  return count(Status::kFailed) > 0 && count(Status::kNoFeasibleFound) == 0;
}

std::string grid_cut_text(const Specification& spec, std::size_t sets) {
  if (sets == 0) return "";
  return fmt::format(
      "the grid of shifts was not searched to the end in {} tooth set{}, at "
      "solver.grid_relaxations = {}: better designs may be left there, a greater number finds them",
      sets, sets == 1 ? "" : "s", spec.solver.grid_relaxations);
}

std::string grid_cuts_text(const Specification& spec, std::size_t refinements,
                           const TextAround& around) {
  if (refinements == 0) return "";
  return fmt::format(
      "{}grids of shifts were not searched to the end in {} refinement{} "
      "(solver.grid_relaxations = {}){}",
      around.before, refinements, refinements == 1 ? "" : "s", spec.solver.grid_relaxations,
      around.after);
}

std::string optimize_counts_text(const OptimizeResult& result, const ResultTally& tally) {
  std::string text = fmt::format("{} of {} tooth sets refined", result.refined.size(),
                                 result.search.candidates.size());
  for (std::size_t k = 0; k < optimize::kStatusCount; ++k) {
    const auto status = static_cast<Status>(k);
    if (tally.status[k] == 0) continue;
    text += fmt::format("; {} {}", tally.status[k], optimize::kStatusNames[k]);
    if (optimize::has_design(status) || status == Status::kBounded) continue;
    std::string reasons;
    for (const auto& [reason, n] : tally.reasons[k]) {
      reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", reason, n);
    }
    if (!reasons.empty()) text += fmt::format(" ({})", reasons);
  }
  return text + "\n";
}

std::string blocking_text(const Specification& spec, const OptimizeResult& result,
                          const ResultTally& tally) {
  const ToothSearchResult& search = result.search;
  if (search.within_ratio == 0) {
    const std::string nearest =
        search.nearest_ratio != 0.0
            ? fmt::format("; the nearest that these tooth ranges reach is {:.6g}:1, {} % off",
                          search.nearest_ratio,
                          percent_off(search.nearest_ratio, spec.ratio.target))
            : std::string(
                  "; teeth.R1_max, teeth.R2_max or max_coaxial_offset leave no ring larger than "
                  "its planet");
    return fmt::format(
        "no feasible design: blocked by ratio: no tooth set within {:g} % of {:g}:1{}",
        100.0 * spec.ratio.tolerance, spec.ratio.target, nearest);
  }
  if (search.candidate_count() == 0) {
    const auto worst = std::ranges::max_element(search.rejected);
    const auto index = static_cast<std::size_t>(worst - search.rejected.begin());
    std::string others;
    for (std::size_t k = 0; k < optimize::kToothRejectionCount; ++k) {
      if (k == index || search.rejected[k] == 0) continue;
      others += fmt::format("{}{} {}", others.empty() ? "; of the others " : ", ",
                            optimize::kToothRejectionNames[k], search.rejected[k]);
    }
    return fmt::format(
        "no feasible design: blocked by {}: it rejects {} of the {} tooth sets within the "
        "ratio{}{}",
        optimize::kToothRejectionNames[index], *worst, search.within_ratio, others,
        index == static_cast<std::size_t>(optimize::ToothRejection::kIdenticalPlanets)
            ? " (identical_planets = false would allow individually phased planets)"
            : "");
  }
  if (!tally.nearest && tally.cut_without_design == 0) {
    return "no feasible design: the solver failed on every tooth set";
  }
  std::map<std::string, std::size_t> reasons =
      tally.reasons[static_cast<std::size_t>(Status::kNoFeasibleFound)];
  for (const auto& [reason, count] : tally.reasons[static_cast<std::size_t>(Status::kInfeasible)]) {
    reasons[reason] += count;
  }
  std::string counts;
  for (const auto& [reason, count] : reasons) {
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", reason, count);
  }
  const std::size_t failures = tally.status[static_cast<std::size_t>(Status::kFailed)];
  const std::string failed =
      failures > 0 ? fmt::format("; the solver failed on {} more, which may have designs", failures)
                   : "";
  if (tally.cut_without_design > 0) {
    return fmt::format(
        "no feasible design was found: the grids of shifts of {} tooth set{} were not searched to "
        "the end and may have one (raise solver.grid_relaxations = {}){}{}{}",
        tally.cut_without_design, tally.cut_without_design == 1 ? "" : "s",
        spec.solver.grid_relaxations,
        counts.empty() ? "" : "; the other sets by the constraint that blocks them: ", counts,
        failed);
  }
  const RefinedSet* nearest = &*tally.nearest;
  const bool proven = nearest->status == Status::kInfeasible;
  std::string misses;
  for (const optimize::Miss& miss : nearest->blocked_by) {
    const char* separator = nearest->blocked_together ? ", " : ", or ";
    misses += fmt::format("{}{}", misses.empty() ? "" : separator, miss.name);
    if (miss.violation > 0.0) {
      misses += fmt::format(" by {}{:.4g}{}{}", proven ? "at least " : "", miss.amount,
                            miss.unit.empty() ? "" : " ", miss.unit);
    }
  }
  std::vector<std::string_view> names;
  names.reserve(reasons.size() + nearest->blocked_by.size());
  for (const auto& [reason, count] : reasons) names.emplace_back(reason);
  for (const optimize::Miss& miss : nearest->blocked_by) names.push_back(miss.name);
  const char* others = ", each with all other limits kept";
  if (nearest->blocked_by.size() == 1) others = " with all other limits kept";
  if (nearest->blocked_together) others = ", together";
  if (proven) others = nearest->blocked_together ? ", together with other limits" : "";
  if (proven && nearest->blocked_by.front().violation > 0.0) {
    others = nearest->blocked_together
                 ? " (a proven bound, its distance may be far more), together with other limits"
                 : " (a proven bound, its distance may be far more)";
  }
  return fmt::format(
      "no feasible design: blocked by {}: the nearest set, {}, misses {}{}; sets by the constraint "
      "that blocks them: {}{}{}",
      reason_of(*nearest), teeth_text(nearest->candidate.teeth), misses, others, counts, failed,
      preset_note(spec.limits, names));
}

}  // namespace gear3k::report
