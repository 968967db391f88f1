#include "optimize/run_forecast.hpp"

#include <algorithm>

namespace gear3k::optimize {

namespace {

using Phase = Progress::Phase;
using Stage = Progress::Stage;

/// A search of the whole space for the best alone, within limits of a front, and rounding: sets
/// that it refines, and its share of what finding and bounding all sets takes.  Sets cost more
/// within limits than without: before any was refined so, they count for more.
constexpr double kSetsOfSearch = 32.0;
constexpr double kSetsOfFrontSearch = 25.0, kSetsWithoutLimits = 80.0;
constexpr double kFindingOfFrontSearch = 0.2;
constexpr double kSetsOfRounding = 40.0;
/// Refining all sets over finding and bounding them, before any is refined.
constexpr double kRefiningOfFinding = 2.0;
/// Searches for each design in the gaps, some of which find none, and the share of the designs that
/// are asked for there: the ends, and the optima of the search before, are others.
constexpr double kSearchesPerDesign = 1.6, kDesignsInGaps = 0.6;
/// Searches that count as made at what is expected of one.
constexpr double kExpected = 3.0;
/// A search for the best alone knows how many sets it will refine when it has refined some; in the
/// gaps of a front it is no longer than some times what is expected of one.
constexpr std::size_t kSetsKnown = 64;
constexpr double kLongest = 3.0;

}  // namespace

ProgressSeen seen_of(const Progress& progress) {
  return {.phase = progress.phase.load(),
          .stage = progress.stage.load(),
          .plan = {.front_objectives = progress.front_objectives.load(),
                   .front_designs = progress.front_designs.load(),
                   .rounding = progress.rounding.load()},
          .done = progress.done.load(),
          .total = progress.total.load(),
          .stage_done = progress.stage_done.load(),
          .stage_total = progress.stage_total.load(),
          .searches = progress.searches.load()};
}

void RunForecast::observe(double now_s, const ProgressSeen& seen) {
  const bool other = !begun_ || seen.phase != last_.phase || seen.stage != last_.stage ||
                     seen.searches != last_.searches || seen.done < last_.done;
  const double passed_s = begun_ ? now_s - last_s_ : 0.0;
  if (begun_) {
    const bool finds = last_.phase == Phase::kSearch || last_.phase == Phase::kBounds;
    if (finds && last_.stage == Stage::kOne) finding_s_ += passed_s;
    if (last_.phase == Phase::kRefinement) refined_in(last_.stage).time_s += passed_s;
    if (last_.stage == Stage::kFrontGaps) gaps_s_ += passed_s;
  }
  if (seen.phase == Phase::kRefinement) {
    refined_in(seen.stage).sets += seen.done - (other ? 0 : last_.done);
  }
  if (seen.stage == Stage::kFrontGaps) gap_searches_ = seen.searches;
  if (!begun_ || seen.stage != last_.stage || seen.searches != last_.searches) {
    search_began_s_ = now_s;
  }
  if (other) {
    rate_.restart(now_s, seen.done);
  } else {
    rate_.observe(now_s, seen.done);
  }
  begun_ = true;
  last_ = seen;
  last_s_ = now_s;
}

double RunForecast::search_s() const { return finding_s_ + kSetsOfSearch * first_.each_s(); }

double RunForecast::front_search_s() const {
  const double sets_s = limited_.sets >= kSetsKnown ? kSetsOfFrontSearch * limited_.each_s()
                                                    : kSetsWithoutLimits * first_.each_s();
  const double expected_s = kFindingOfFrontSearch * finding_s_ + sets_s;
  const auto made = static_cast<double>(gap_searches_);
  return (kExpected * expected_s + gaps_s_) / (kExpected + made);
}

std::optional<double> RunForecast::seconds_left() const {
  if (!begun_ || last_.total == 0) return std::nullopt;
  std::optional<double> left = rate_.seconds_left(last_.total);
  const bool first = last_.stage == Stage::kOne;
  if (!first) {
    const double expected_s = last_.stage == Stage::kBeyond ? search_s() : front_search_s();
    const double rest_s = std::max(0.0, expected_s - (last_s_ - search_began_s_));
    const bool known = last_.phase == Phase::kRefinement && last_.done >= kSetsKnown;
    left = known ? left.value_or(rest_s) : rest_s;
    if (last_.stage == Stage::kFrontGaps) left = std::min(*left, kLongest * expected_s);
  }
  if (!left) return std::nullopt;
  if (first && (last_.phase == Phase::kSearch || last_.phase == Phase::kBounds)) {
    *left += kRefiningOfFinding * (finding_s_ + *left);
  }
  const auto rest = [&](std::size_t ahead) {
    return last_.stage_total > last_.stage_done + ahead
               ? static_cast<double>(last_.stage_total - last_.stage_done - ahead)
               : 0.0;
  };
  const Progress::Plan& plan = last_.plan;
  const auto objectives = static_cast<double>(plan.front_objectives);
  const double designs = kDesignsInGaps * static_cast<double>(plan.front_designs);
  if (plan.front_objectives > 1) {
    const bool in_gaps = last_.stage == Stage::kFrontGaps;
    const double ended = gap_searches_ > 0 ? static_cast<double>(gap_searches_ - 1) : 0.0;
    const double found = in_gaps ? static_cast<double>(last_.stage_done) : 0.0;
    const double gaps_s =
        front_search_s() * (kExpected * kSearchesPerDesign + ended) / (kExpected + found);
    const double end_s = front_search_s();
    if (first) *left += objectives * objectives * end_s + designs * gaps_s;
    if (last_.stage == Stage::kFrontEnds) *left += rest(1) * end_s + designs * gaps_s;
    if (last_.stage == Stage::kFrontGaps) *left += std::max(0.0, rest(0) * gaps_s - *left);
  }
  if (last_.stage == Stage::kBeyond) *left += rest(1) * search_s();
  if (plan.rounding) *left += kSetsOfRounding * first_.each_s();
  return left;
}

}  // namespace gear3k::optimize
