#include "optimize/run_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimize/wider_search.hpp"

namespace gear3k::optimize {

namespace {

using Phase = Progress::Phase;
using Stage = Progress::Stage;

// In units of bounding a stage that has a design: refining a set (5 to 13 measured), sharpening a
// bound (110 to 370).
constexpr double kRefining = 8.0, kSharpening = 250.0;
/// Sets, stages and bounds that count as done at what is expected of them.
constexpr double kSetsExpected = 20.0, kStagesExpected = 20.0, kBoundsExpected = 0.5;
constexpr double kStageExpected_s = 2.5e-4;
/// Sets that a search for the best alone refines, and bounds that a certificate sharpens then.
constexpr double kLeastRefined = 16.0, kMostRefined = 64.0;
constexpr double kLeastSharpened = 0.5, kMostSharpened = 16.0;
/// By how much the estimate of sets to refine from the stages bounded may be off: pairs of modules
/// rule out others.
constexpr double kLeastOpen = 0.3, kMostOpen = 1.2;
/// What follows the search for tooth sets, over it, before anything is known.
constexpr double kLeastOfSearching = 2.0, kMostOfSearching = 30.0;
/// A search of the whole space for the best alone, within limits of a front, and rounding: sets
/// that it refines, and its share of what finding and bounding all sets takes.  Sets cost more
/// within limits than without: before any was refined so, they count for more.
constexpr double kSetsOfSearch = 32.0;
constexpr double kSetsOfFrontSearch = 25.0, kSetsWithoutLimits = 80.0;
constexpr double kFindingOfFrontSearch = 0.2;
constexpr double kSetsOfRounding = 40.0;
/// Whole searches that may follow beyond the ends of ranges, or without limits where no set has a
/// design; the share of those that are counted which is made at least.
constexpr double kSearchesBeyond = 0.5, kSearchesWithoutLimits = 8.0;
/// Of a search with a limit given way, over one for the best alone.
constexpr double kLeastOfAgain = 0.7;
/// Of large tasks only what lies beyond tooth ranges is searched.
constexpr double kSearchesBeyondOfMany = 0.1;
constexpr double kShareOfBeyond = 0.1, kShareOfRelaxed = 0.4;
/// Searches that bring limits which give way nearer, of all of them.
constexpr double kSearchesNearer = 8.0;
/// A range of a front's time has ends so many times its middle, at the end and at first.
constexpr double kWidthOfFront = 1.6, kWidthLater = 3.0, kWidthAtFirst = 4.0;
/// Searches in the gaps of a front get shorter, as what they found bounds the others: later ones
/// take this of the mean of those made.
constexpr std::size_t kFirstInGaps = 8;
constexpr double kLaterInGaps = 0.6;
/// Stages of the second kind, which are bounded after the first, take less: by this share of what
/// all take at the rate of the first.
constexpr double kLessBySecond = 0.3;
constexpr double kLeastOfRest = 0.55;  ///< of the rest of bounding, which gets faster
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
                   .passes_most = progress.passes_most.load(),
                   .built_per_pass = progress.built_per_pass.load(),
                   .built_after = progress.built_after.load()},
          .done = progress.done.load(),
          .total = progress.total.load(),
          .stage_done = progress.stage_done.load(),
          .stage_total = progress.stage_total.load(),
          .searches = progress.searches.load(),
          .sets = progress.sets.load(),
          .first_stages = progress.first_stages.load(),
          .empty_first = progress.empty_first.load(),
          .empty_second = progress.empty_second.load(),
          .open = progress.open.load(),
          .feasible = progress.feasible.load()};
}

/// Where the work of the time since the last look belongs.
void RunForecast::account(double now_s, const ProgressSeen& seen) {
  const double passed_s = now_s - last_s_;
  const bool after = last_.stage_done == last_.stage_total;
  switch (last_.phase) {
    case Phase::kSearch:
      break;
    case Phase::kBounds:
      if (is_of_all(last_.stage)) stages_.time_s += passed_s;
      break;
    case Phase::kRefinement:
      refined_in(last_.stage).time_s += passed_s;
      break;
    case Phase::kCertificate:
      sharpened_.time_s += passed_s;
      break;
    case Phase::kGearboxes:
      if (last_.stage == Stage::kBuilt && !after) built_s_ += passed_s;
      break;
  }
  const bool finds = last_.phase == Phase::kSearch || last_.phase == Phase::kBounds;
  if (finds && is_of_all(last_.stage)) {
    finding_s_ += passed_s;
    if (seen.phase == Phase::kRefinement) found_s_ = finding_s_;
  }
  if (!after || last_.stage != Stage::kBuilt) after_began_s_ = now_s;
  if (last_.stage == Stage::kFrontGaps) {
    gaps_s_ += passed_s;
    longest_gap_s_ = std::max(longest_gap_s_, now_s - search_began_s_);
  }
}

void RunForecast::observe(double now_s, const ProgressSeen& seen) {
  const bool other = !begun_ || seen.phase != last_.phase || seen.stage != last_.stage ||
                     seen.searches != last_.searches || seen.done < last_.done;
  if (begun_) account(now_s, seen);
  const std::size_t before = other ? 0 : last_.done;
  const std::size_t more = seen.done - before;
  if (seen.phase == Phase::kRefinement) refined_in(seen.stage).items += more;
  if (seen.phase == Phase::kCertificate) sharpened_.items += more;
  if (seen.phase == Phase::kBounds && is_of_all(seen.stage)) {
    // Stages without a design cost next to nothing.
    const std::size_t empty = seen.empty_first + seen.empty_second;
    const std::size_t empty_before = other ? 0 : last_.empty_first + last_.empty_second;
    stages_.items += more - std::min(more, empty - std::min(empty, empty_before));
  }
  if (seen.stage == Stage::kFrontGaps) gap_searches_ = seen.searches;
  if (!begun_ || seen.stage != last_.stage || seen.searches != last_.searches) {
    if (begun_ && last_.stage == Stage::kBuilt && last_.searches > 0 &&
        last_.stage_done < last_.stage_total) {
      passes_s_ += now_s - search_began_s_;
    }
    search_began_s_ = now_s;
    if (is_of_all(seen.stage)) finding_s_ = 0.0;
  }
  if (other) {
    rate_.restart(now_s, seen.done);
    phase_began_s_ = now_s;
  } else {
    rate_.observe(now_s, seen.done);
  }
  if (other || seen.done != last_.done) item_began_s_ = now_s;
  begun_ = true;
  last_ = seen;
  last_s_ = now_s;
  if (const std::optional<Range> now = range_now()) {
    told_ = now;
    told_at_s_ = now_s;
  }
}

double RunForecast::stage_s() const { return stages_.each_s(kStageExpected_s, kStagesExpected); }

double RunForecast::set_s() const {
  if (stages_.items == 0) return first_.each_s();  // nothing is bounded
  return first_.each_s(kRefining * stage_s(), kSetsExpected);
}

double RunForecast::sharpening_s() const {
  return sharpened_.each_s(kSharpening * stage_s(), kBoundsExpected);
}

double RunForecast::search_s() const {
  return (found_s_ > 0.0 ? found_s_ : finding_s_) + kSetsOfSearch * set_s();
}

double RunForecast::front_search_s() const {
  const double sets_s = limited_.items >= kSetsKnown ? kSetsOfFrontSearch * limited_.each_s()
                                                     : kSetsWithoutLimits * first_.each_s();
  const double expected_s = kFindingOfFrontSearch * finding_s_ + sets_s;
  // What the longest search found bounds the others: none like it is foreseen.
  const bool many = gap_searches_ > 2;
  const double longest_s = many ? longest_gap_s_ : 0.0;
  const auto made = static_cast<double>(many ? gap_searches_ - 1 : gap_searches_);
  return (kExpected * expected_s + gaps_s_ - longest_s) / (kExpected + made);
}

/// Whether the search that runs sharpens bounds at its end.
bool RunForecast::certifies() const { return last_.plan.best_only && last_.stage == Stage::kOne; }

/// What follows the bounds of a search of all sets.
RunForecast::Range RunForecast::after_bounds() const {
  if (!last_.plan.best_only && last_.stage != Stage::kBuilt) {
    const auto share = [](std::size_t empty, std::size_t done) {
      return done > 0 ? 1.0 - static_cast<double>(empty) / static_cast<double>(done) : 1.0;
    };
    const std::size_t firsts = std::min(last_.done, last_.first_stages);
    const double open = static_cast<double>(last_.sets) * share(last_.empty_first, firsts) *
                        share(last_.empty_second, last_.done - firsts);
    return {.least_s = kLeastOpen * open * set_s(), .most_s = kMostOpen * open * set_s()};
  }
  Range after{.least_s = kLeastRefined * set_s(), .most_s = kMostRefined * set_s()};
  if (certifies()) {
    after.least_s += kLeastSharpened * sharpening_s();
    after.most_s += kMostSharpened * sharpening_s();
  }
  return after;
}

std::optional<RunForecast::Range> RunForecast::rest_of_search() const {
  const std::optional<double> left = rate_.seconds_left(last_.total);
  double expected_s = 0.0, longest_s = kEndless;
  switch (last_.stage) {
    case Stage::kOne:
      return rest_of_first();
    case Stage::kBeyond:
    case Stage::kRelaxed:
      expected_s = search_s();
      break;
    case Stage::kBuilt:
      if (last_.stage_done == last_.stage_total) {
        const double passed_s = last_s_ - after_began_s_;
        double whole_s = built_after_s();
        const double made = static_cast<double>(last_.done) / static_cast<double>(last_.total);
        if (last_.done > 0) whole_s = (item_began_s_ - after_began_s_) / made;
        const double rest_s = std::max(whole_s - passed_s, 0.2 * (1.0 - made) * whole_s);
        return Range{.least_s = rest_s, .most_s = rest_s};
      }
      if (passes_s_ == 0.0) return rest_of_first();
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
  if (last_.phase == Phase::kRefinement && last_.done >= kSetsKnown && left) {
    return Range{.least_s = std::min(*left, longest_s), .most_s = *left};
  }
  const double rest_s =
      std::min(std::max(0.0, expected_s - (last_s_ - search_began_s_)), longest_s);
  return Range{.least_s = rest_s, .most_s = rest_s};
}

std::optional<RunForecast::Range> RunForecast::rest_of_first() const {
  const std::optional<double> left = rate_.seconds_left(last_.total);
  const auto total = static_cast<double>(last_.total), done = static_cast<double>(last_.done);
  const bool best_only = last_.plan.best_only || last_.stage == Stage::kBuilt;
  Range rest;
  switch (last_.phase) {
    case Phase::kSearch: {
      if (!left) return std::nullopt;
      const double whole_s = finding_s_ + *left;
      return Range{.least_s = *left + kLeastOfSearching * whole_s,
                   .most_s = *left + kMostOfSearching * whole_s};
    }
    case Phase::kBounds: {
      if (!left) return std::nullopt;
      const double rest_s = *left * (1.0 - kLessBySecond * std::max(0.0, 1.0 - done / total));
      rest = after_bounds();
      rest.least_s += kLeastOfRest * rest_s;
      rest.most_s += rest_s;
      return rest;
    }
    case Phase::kRefinement:
      if (!best_only) {
        const bool known = last_.done > kSetsKnown * 4 && left;
        const double rest_s = known ? *left : (total - done) * set_s();
        return Range{.least_s = rest_s, .most_s = rest_s};
      }
      // How many may still win is not known before some are refined.
      rest = last_.done >= kSetsKnown && left
                 ? Range{.least_s = 0.5 * *left, .most_s = *left}
                 : Range{.least_s = std::max(0.0, kLeastRefined - done) * set_s(),
                         .most_s = std::max(kLeastRefined, kMostRefined - done) * set_s()};
      if (certifies()) {
        rest.least_s += kLeastSharpened * sharpening_s();
        rest.most_s += kMostSharpened * sharpening_s();
      }
      return rest;
    case Phase::kCertificate: {
      const double rest_s = std::max((total - done) * sharpening_s() - (last_s_ - item_began_s_),
                                     0.3 * (total - done) * sharpening_s());
      return Range{.least_s = rest_s, .most_s = rest_s};
    }
    case Phase::kGearboxes:
      return left ? std::optional(Range{.least_s = *left, .most_s = *left}) : std::nullopt;
  }
  return std::nullopt;
}

/// What is built after the searches for built gearboxes, at what one costs in them.
double RunForecast::built_after_s() const {
  const Progress::Plan& plan = last_.plan;
  const bool after = last_.stage_done == last_.stage_total;
  const std::size_t passes =
      after ? last_.searches : last_.searches - std::min<std::size_t>(1, last_.searches);
  const double built = static_cast<double>(std::max<std::size_t>(1, passes)) *
                       static_cast<double>(plan.built_per_pass);
  const double number =
      static_cast<double>(after && last_.total > 0 ? last_.total : plan.built_after);
  return built > 0.0 ? number * built_s_ / built : 0.0;
}

void RunForecast::add_passes(Range& left) const {
  const Progress::Plan& plan = last_.plan;
  if (last_.stage != Stage::kBuilt) return;
  const std::size_t begun = std::max<std::size_t>(1, last_.searches);
  const Range pass = begun > 1 ? Range{.least_s = passes_s_ / static_cast<double>(begun - 1),
                                       .most_s = passes_s_ / static_cast<double>(begun - 1)}
                               : Range{.least_s = last_s_ - search_began_s_ + left.least_s,
                                       .most_s = last_s_ - search_began_s_ + left.most_s};
  if (last_.stage_done < last_.stage_total) {
    const std::size_t most = std::max(begun, plan.passes_most);
    const std::size_t least = std::clamp(plan.passes_least, begun, most);
    // Before any is built a gearbox counts as so small a part of a pass.
    constexpr double kLeastBuilt = 2.0, kMostBuilt = 8.0;
    const double built_s = built_after_s();
    left.least_s += pass.least_s * static_cast<double>(least - begun) +
                    (built_s > 0.0 ? built_s : kLeastBuilt * pass.least_s);
    left.most_s += pass.most_s * static_cast<double>(most - begun) +
                   (built_s > 0.0 ? built_s : kMostBuilt * pass.most_s);
  }
  // Then the search under the limits found.
  if (plan.best_only) {
    left.least_s += pass.least_s + kLeastSharpened * sharpening_s();
    left.most_s += pass.most_s + kMostSharpened * sharpening_s();
  } else if (last_.phase == Phase::kSearch || last_.phase == Phase::kBounds) {
    const Range found{.least_s = found_s_ > 0.0 ? found_s_ : 0.6 * pass.least_s,
                      .most_s = found_s_ > 0.0 ? found_s_ : pass.most_s};
    const double open = static_cast<double>(last_.open > 0 ? last_.open : last_.sets);
    left.least_s += found.least_s + 0.5 * open * set_s();
    left.most_s += found.most_s + open * set_s();
  } else {
    const double own_s = found_s_ + static_cast<double>(last_.open) * set_s();
    left.least_s += own_s;
    left.most_s += own_s;
  }
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
  const bool later = in_gaps && gap_searches_ > kFirstInGaps;
  if (in_gaps) {
    more_s = std::max(0.0, (later ? kLaterInGaps : 1.0) * rest(0) * gaps_s - left.least_s);
  }
  left.least_s += more_s;
  left.most_s += more_s;
  // Single searches of a front may cost as much as all others: the more of them are to come, the
  // less is known.
  const double open =
      in_gaps && last_.stage_total > 0 ? rest(0) / static_cast<double>(last_.stage_total) : 1.0;
  const double width =
      kWidthOfFront + ((later ? kWidthLater : kWidthAtFirst) - kWidthOfFront) * open;
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
  const std::optional<Range> rest = rest_of_search();
  if (!rest) return std::nullopt;
  Range left = *rest;
  const Progress::Plan& plan = last_.plan;
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
    const bool many = last_.sets > kMostSearchedAgain;
    const double beyond = many ? kSearchesBeyondOfMany : kSearchesBeyond;
    left.most_s += (none ? kSearchesWithoutLimits : beyond) * search_s();
    // With the dearest limit given way.
    if (!none && !many && plan.passes_most == 0) {
      left.least_s += kLeastOfAgain * search_s();
      left.most_s += search_s();
    }
  }
  if (plan.rounding) {
    left.least_s += 0.5 * kSetsOfRounding * set_s();
    left.most_s += 2.0 * kSetsOfRounding * set_s();
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
