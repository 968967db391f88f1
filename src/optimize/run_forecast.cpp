#include "optimize/run_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
/// Refining all sets, or those of a search for the best alone, over finding and bounding them,
/// before any is refined.
constexpr double kLeastRefiningOfFinding = 1.5, kMostRefiningOfFinding = 6.0;
constexpr double kLeastOfRest = 0.6;  ///< of the rest of finding and bounding, which gets faster
constexpr double kLeastOfFinding = 0.05, kMostOfFinding = 0.8, kOfBestAlone = 0.2;
/// Whole searches that may follow beyond the ends of ranges, or without limits where no set has a
/// design; the share of those that are counted which is made at least.
constexpr double kSearchesBeyond = 0.5, kSearchesWithoutLimits = 8.0;
constexpr double kShareOfBeyond = 0.1, kShareOfRelaxed = 0.4;
/// Searches that bring limits which give way nearer, of all of them.
constexpr double kSearchesNearer = 8.0;
/// A range of a front's time has ends so many times its middle, at the end and at first.
constexpr double kWidthOfFront = 1.3, kWidthAtFirst = 4.0;
/// What is built after the searches for built gearboxes, over what is built in one of them.
constexpr double kBuiltAfter = 8.0;
/// Stages of the second kind, which are bounded after the first, take less: by this share of what
/// all take at the rate of the first.
constexpr double kLessBySecond = 0.3;
/// Sets that count as refined at what is expected of them.
constexpr double kSetsExpected = 60.0;
constexpr double kRefiningOfFinding = 3.5;
/// By how much the ends of a range may be off.
constexpr double kEndsOff = 1.25;
/// A range whose ends are no farther apart is told as its middle.
constexpr double kOneNumber = 2.5;
constexpr double kEndless = std::numeric_limits<double>::infinity();
/// Searches for each design in the gaps, some of which find none, and the share of the designs that
/// are asked for there: the ends, and the optima of the search before, are others.
constexpr double kSearchesPerDesign = 1.6, kDesignsInGaps = 0.6;
/// Searches that count as made at what is expected of one.
constexpr double kExpected = 3.0;
/// A search for the best alone knows how many sets it will refine when it has refined some; in the
/// gaps of a front it is no longer than some times what is expected of one.
constexpr std::size_t kSetsKnown = 64;
constexpr double kLongest = 3.0;

/// Whether a stage searches all sets of the task as stated, or as built gearboxes need it.
bool is_of_all(Stage stage) { return stage == Stage::kOne || stage == Stage::kBuilt; }

}  // namespace

ProgressSeen seen_of(const Progress& progress) {
  return {.phase = progress.phase.load(),
          .stage = progress.stage.load(),
          .plan = {.front_objectives = progress.front_objectives.load(),
                   .front_designs = progress.front_designs.load(),
                   .rounding = progress.rounding.load(),
                   .best_only = progress.best_only.load(),
                   .explains = progress.explains.load(),
                   .passes_least = progress.passes_least.load(),
                   .passes_most = progress.passes_most.load()},
          .done = progress.done.load(),
          .total = progress.total.load(),
          .stage_done = progress.stage_done.load(),
          .stage_total = progress.stage_total.load(),
          .searches = progress.searches.load(),
          .open = progress.open.load(),
          .feasible = progress.feasible.load()};
}

void RunForecast::observe(double now_s, const ProgressSeen& seen) {
  const bool other = !begun_ || seen.phase != last_.phase || seen.stage != last_.stage ||
                     seen.searches != last_.searches || seen.done < last_.done;
  const double passed_s = begun_ ? now_s - last_s_ : 0.0;
  if (begun_) {
    const bool finds = last_.phase == Phase::kSearch || last_.phase == Phase::kBounds;
    if (finds && is_of_all(last_.stage)) finding_s_ += passed_s;
    const bool after = last_.stage_done == last_.stage_total;
    if (last_.stage == Stage::kBuilt && last_.phase == Phase::kGearboxes && !after) {
      built_s_ += passed_s;
    }
    if (!after || last_.stage != Stage::kBuilt) after_began_s_ = now_s;
    if (last_.phase == Phase::kRefinement) refined_in(last_.stage).time_s += passed_s;
    if (last_.stage == Stage::kFrontGaps) gaps_s_ += passed_s;
  }
  if (seen.phase == Phase::kRefinement) {
    refined_in(seen.stage).sets += seen.done - (other ? 0 : last_.done);
  }
  if (seen.stage == Stage::kFrontGaps) gap_searches_ = seen.searches;
  if (!begun_ || seen.stage != last_.stage || seen.searches != last_.searches) {
    if (begun_ && last_.stage == Stage::kBuilt && last_.searches > 0) {
      passes_s_ += now_s - search_began_s_;
    }
    search_began_s_ = now_s;
    if (is_of_all(seen.stage)) finding_s_ = 0.0;
  }
  if (other) {
    rate_.restart(now_s, seen.done);
  } else {
    rate_.observe(now_s, seen.done);
  }
  begun_ = true;
  last_ = seen;
  last_s_ = now_s;
  if (const std::optional<Range> now = range_now()) {
    told_ = now;
    told_at_s_ = now_s;
  }
}

double RunForecast::search_s() const { return finding_s_ + kSetsOfSearch * first_.each_s(); }

double RunForecast::front_search_s() const {
  const double sets_s = limited_.sets >= kSetsKnown ? kSetsOfFrontSearch * limited_.each_s()
                                                    : kSetsWithoutLimits * first_.each_s();
  const double expected_s = kFindingOfFrontSearch * finding_s_ + sets_s;
  const auto made = static_cast<double>(gap_searches_);
  return (kExpected * expected_s + gaps_s_) / (kExpected + made);
}

std::optional<double> RunForecast::rest_of_search_s() const {
  const std::optional<double> left = rate_.seconds_left(last_.total);
  double expected_s = 0.0, longest_s = kEndless;
  switch (last_.stage) {
    case Stage::kOne:
      return rest_of_first_s(left);
    case Stage::kBeyond:
    case Stage::kRelaxed:
      expected_s = search_s();
      break;
    case Stage::kBuilt:
      if (last_.stage_done == last_.stage_total) {
        const auto passes = static_cast<double>(std::max<std::size_t>(1, last_.searches));
        return std::max(0.0, kBuiltAfter * built_s_ / passes - (last_s_ - after_began_s_));
      }
      if (passes_s_ == 0.0) return rest_of_first_s(left);
      expected_s = passes_s_ / static_cast<double>(std::max<std::size_t>(1, last_.searches - 1));
      break;
    case Stage::kFrontEnds:
      expected_s = front_search_s();
      break;
    case Stage::kFrontGaps:
      expected_s = front_search_s();
      longest_s = kLongest * expected_s;
      break;
  }
  const double rest_s = std::max(0.0, expected_s - (last_s_ - search_began_s_));
  const bool known = last_.phase == Phase::kRefinement && last_.done >= kSetsKnown;
  return std::min(known ? left.value_or(rest_s) : rest_s, longest_s);
}

std::optional<double> RunForecast::rest_of_first_s(const std::optional<double>& left) const {
  const auto total = static_cast<double>(last_.total), done = static_cast<double>(last_.done);
  if (last_.phase == Phase::kBounds) {
    if (!left) return left;
    return *left * (1.0 - kLessBySecond * std::max(0.0, 1.0 - done / total));
  }
  if (last_.phase != Phase::kRefinement) return left;
  if (last_.plan.best_only || last_.stage == Stage::kBuilt) {
    // How many may still win is not known before some are refined.
    if (last_.done >= kSetsKnown) return left;
    return std::min(left.value_or(kEndless), kOfBestAlone * finding_s_);
  }
  const double expected_s = kRefiningOfFinding * finding_s_ / std::max(1.0, total);
  const double each_s =
      (kSetsExpected * expected_s + done / rate_.per_second().value_or(kEndless)) /
      (kSetsExpected + done);
  return done > kSetsKnown * 4 && left ? *left : (total - done) * each_s;
}

void RunForecast::add_passes(Range& left) const {
  const Progress::Plan& plan = last_.plan;
  if (last_.stage != Stage::kBuilt) return;
  const std::size_t begun = std::max<std::size_t>(1, last_.searches);
  const double pass_s = begun > 1 ? passes_s_ / static_cast<double>(begun - 1)
                                  : (last_s_ - search_began_s_) + left.least_s;
  if (last_.stage_done < last_.stage_total) {
    const std::size_t most = std::max(begun, plan.passes_most);
    const std::size_t least = std::clamp(plan.passes_least, begun, most);
    left.least_s += pass_s * static_cast<double>(least - begun);
    left.most_s += pass_s * static_cast<double>(most - begun);
    const double built_s = kBuiltAfter * built_s_ / std::max(1.0, static_cast<double>(begun - 1));
    left.least_s += built_s;
    left.most_s += built_s;
  }
  // Then the search under the limits found.
  const double own_s =
      plan.best_only ? pass_s : finding_s_ + static_cast<double>(last_.open) * first_.each_s();
  left.least_s += 0.5 * own_s;
  left.most_s += own_s;
}

void RunForecast::add_front(Range& left) const {
  const Progress::Plan& plan = last_.plan;
  if (plan.front_objectives < 2) return;
  const auto rest = [&](std::size_t ahead) {
    return last_.stage_total > last_.stage_done + ahead
               ? static_cast<double>(last_.stage_total - last_.stage_done - ahead)
               : 0.0;
  };
  const auto objectives = static_cast<double>(plan.front_objectives);
  const double designs = kDesignsInGaps * static_cast<double>(plan.front_designs);
  const bool in_gaps = last_.stage == Stage::kFrontGaps;
  const double ended = gap_searches_ > 0 ? static_cast<double>(gap_searches_ - 1) : 0.0;
  const double found = in_gaps ? static_cast<double>(last_.stage_done) : 0.0;
  const double gaps_s =
      front_search_s() * (kExpected * kSearchesPerDesign + ended) / (kExpected + found);
  const double end_s = front_search_s();
  double more_s = 0.0;
  if (is_of_all(last_.stage)) more_s = objectives * objectives * end_s + designs * gaps_s;
  if (last_.stage == Stage::kFrontEnds) more_s = rest(1) * end_s + designs * gaps_s;
  if (in_gaps) more_s = std::max(0.0, rest(0) * gaps_s - left.least_s);
  left.least_s += more_s;
  left.most_s += more_s;
  // Single searches of a front may cost as much as all others: the more of them are to come, the
  // less is known.
  const double open =
      in_gaps && last_.stage_total > 0 ? rest(0) / static_cast<double>(last_.stage_total) : 1.0;
  const double width = kWidthOfFront + (kWidthAtFirst - kWidthOfFront) * open;
  left.least_s /= width;
  left.most_s *= width;
}

std::optional<RunForecast::Range> RunForecast::range_left() const {
  const std::optional<Range> now = range_now();
  if (now || !told_) return now;
  // Between two phases what was told before holds, less the time that passed.
  const double passed_s = last_s_ - told_at_s_;
  return Range{.least_s = std::max(0.0, told_->least_s - passed_s),
               .most_s = std::max(0.0, told_->most_s - passed_s)};
}

std::optional<RunForecast::Range> RunForecast::range_now() const {
  if (!begun_ || last_.total == 0) return std::nullopt;
  const std::optional<double> rest_s = rest_of_search_s();
  if (!rest_s) return std::nullopt;
  Range left{.least_s = *rest_s, .most_s = *rest_s};
  const Progress::Plan& plan = last_.plan;
  const bool finds = last_.phase == Phase::kSearch || last_.phase == Phase::kBounds;
  if (finds && is_of_all(last_.stage) && passes_s_ == 0.0) {
    // Nothing is refined yet; of all sets more than of the best alone.
    const double whole_s = finding_s_ + *rest_s;
    left.least_s *= kLeastOfRest;
    const bool best_only = plan.best_only || last_.stage == Stage::kBuilt;
    left.least_s += (best_only ? kLeastOfFinding : kLeastRefiningOfFinding) * whole_s;
    left.most_s += (best_only ? kMostOfFinding : kMostRefiningOfFinding) * whole_s;
  }
  add_passes(left);
  add_front(left);
  const double stage_rest_s =
      last_.stage_total > last_.stage_done + 1
          ? search_s() * static_cast<double>(last_.stage_total - last_.stage_done - 1)
          : 0.0;
  if (last_.stage == Stage::kBeyond || last_.stage == Stage::kRelaxed) {
    left.least_s +=
        (last_.stage == Stage::kBeyond ? kShareOfBeyond : kShareOfRelaxed) * stage_rest_s;
    left.most_s += stage_rest_s;
    if (last_.stage == Stage::kRelaxed) left.most_s += kSearchesNearer * search_s();
  } else if (plan.explains) {
    const bool none = last_.feasible == 0 && last_.phase == Phase::kRefinement &&
                      2 * last_.done > std::min(last_.total, 4 * kSetsKnown);
    left.most_s += (none ? kSearchesWithoutLimits : kSearchesBeyond) * search_s();
  }
  if (plan.rounding) {
    left.least_s += 0.5 * kSetsOfRounding * first_.each_s();
    left.most_s += 2.0 * kSetsOfRounding * first_.each_s();
  }
  if (!left.is_one()) {
    left.least_s /= kEndsOff;
    left.most_s *= kEndsOff;
  }
  return left;
}

std::optional<double> RunForecast::seconds_left() const {
  const std::optional<Range> left = range_left();
  return left ? std::optional(left->middle_s()) : std::nullopt;
}

bool RunForecast::Range::is_one() const { return most_s <= kOneNumber * least_s; }

double RunForecast::Range::middle_s() const { return std::sqrt(least_s * most_s); }

}  // namespace gear3k::optimize
