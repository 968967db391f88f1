#include "optimize/run_forecast.hpp"

#include <algorithm>
#include <cmath>

#include "optimize/relaxed_limits.hpp"
#include "optimize/wider_search.hpp"

namespace gear3k::optimize {

namespace {

/// What is expected of a run before it shows it, and by what factor it may be more or less.
struct Foreseen {
  double expected, factor;
};

// A number with a range in brackets beside it was measured, on the first nine tasks of
// benchmarks/time_left (others in docs/peers.md, "The time left"); the number itself was chosen
// with that in sight.  All others, and every factor, were chosen so that what is told of these
// tasks comes near: no measurement is behind them, and other tasks may be farther off.

/// Over bounding a stage of the first kind that has a design: refining a set (5 to 14), sharpening
/// a bound (100 to 260), and a stage of the second kind (0.4 to 0.9).
constexpr double kRefining = 5.0, kSharpening = 150.0, kSecondStage = 0.55;
/// A stage without a design, over one with a design (0 to 0.7, half of them below 0.1).
constexpr double kEmptyStage = 0.05;
/// What the rest of bounding may be off by: chosen.
constexpr double kBoundingFactor = 1.5;
/// Sets and bounds that count as done at that: chosen.
constexpr double kSetsExpected = 20.0, kBoundsExpected = 1.0;
/// Of the sets whose stages have a design those to refine (0.92 to 1): pairs of modules rule out
/// others.
constexpr Foreseen kOpen{.expected = 0.8, .factor = 1.5};
/// Of a search for the best alone: sets refined (0 to 32, 16 to 64 are told), bounds sharpened (1
/// to 18, 0.75 to 12 are told).
constexpr Foreseen kSetsOfBest{.expected = 32.0, .factor = 2.0};
constexpr Foreseen kSharpened{.expected = 3.0, .factor = 4.0};
/// Of the proof of the best of a number of planets: sets refined (27 to 32), bounds sharpened (0 to
/// 13).
constexpr Foreseen kSetsOfPlanets{.expected = 30.0, .factor = 1.5};
constexpr Foreseen kSharpenedOfPlanets{.expected = 1.0, .factor = 5.0};
/// Sets as many as which it costs to tell what holds the best of a number of planets back: chosen.
constexpr double kHeldBack = 6.0;
/// Sets that rounding costs: chosen.
constexpr Foreseen kRounding{.expected = 30.0, .factor = 2.0};
/// What is built after the passes for built gearboxes, over a pass, before any is built (8, by one
/// task).
constexpr Foreseen kBuiltAfter{.expected = 4.0, .factor = 2.0};
/// Sets refined as many as which a search of a front takes, at its ends or in its gaps.  A narrow
/// limit on lost motion leaves many sets without a design, and finding none costs some ten times
/// finding one (490 to 590).  Where a third objective is limited too, its bounds leave most of them
/// out (85 to 190); without lost motion few are left (25 to 50, of tasks outside of the nine).
constexpr Foreseen kLostMotionAlone{.expected = 500.0, .factor = 3.0};
constexpr Foreseen kLostMotionAndOthers{.expected = 130.0, .factor = 2.5};
constexpr Foreseen kWithoutLostMotion{.expected = 40.0, .factor = 2.5};
const Foreseen& front_search(const Progress::Plan& plan) {
  if (!plan.front_lost_motion) return kWithoutLostMotion;
  return plan.front_objectives > 2 ? kLostMotionAndOthers : kLostMotionAlone;
}
/// Ends of a front as many as which what is expected of a search counts when all are made: chosen.
constexpr double kExpectedAsEnds = 2.0;
/// Searches in the gaps, over the designs asked for: most of them may be known before (0.7 to
/// 0.95).
constexpr double kInGaps = 0.8;
/// What a search in the gaps takes may be more or less than one at the ends by (0.5 to 2.8 of it).
constexpr double kGapsOverEnds = 2.5;
/// Searches in the gaps as many as which the ends count; after twice as many the rest costs this
/// share of those so far, as what they found bounds the others: chosen.
constexpr double kEndsCountAs = 4.0, kLaterInGaps = 0.6;
/// Standard deviation of what a search in the gaps takes, over its mean, before they show it (1.2
/// to 1.9), and the greatest factor that follows from it: chosen.
constexpr double kScatter = 1.5, kMostScatter = 5.0;
/// Whole searches with ranges or limits given way: where there is a design (one or two, of 0.5
/// to 1.3 of finding the sets; none with more than kMostSearchedAgain sets or robust limits), and
/// where there is none (25).
constexpr Foreseen kBeyond{.expected = 1.2, .factor = 1.5};
constexpr Foreseen kRelaxed{.expected = 15.0, .factor = 3.0};
/// Searches for each limit left out, and items that count as done at it: chosen.
constexpr double kForLimit = 2.5, kItemsExpected = 4.0;
/// What takes longer than expected goes on for this part of the time that it took: chosen.
constexpr double kGoesOn = 1.0 / 3.0;
/// A search for the best alone that has refined more than is expected at most goes by its rate.
constexpr auto kSetsKnown = static_cast<std::size_t>(kSetsOfBest.expected * kSetsOfBest.factor);
/// A range whose ends are no farther apart is told as its middle: chosen.
constexpr double kOneNumber = 2.5;

using Range = RunForecast::Range;

void add(Range& left, double time_s, double factor = 1.0) {
  left.least_s += time_s / factor;
  left.most_s += time_s * factor;
}
void add(Range& left, const Foreseen& items, double each_s) {
  add(left, items.expected * each_s, items.factor);
}

double number_left(std::size_t done, std::size_t total) {
  return total > done ? static_cast<double>(total - done) : 0.0;
}

double time_left(double expected_s, double elapsed_s) {
  return std::max(expected_s - elapsed_s, kGoesOn * elapsed_s);
}

/// Whether sets cost in a stage what they do in the search of all: with or without a design.
bool tells_of_sets(Progress::Stage stage) {
  using Stage = Progress::Stage;
  return stage == Stage::kOne || stage == Stage::kBuilt || stage == Stage::kPlanets ||
         stage == Stage::kRelaxed;
}

bool is_of_all(Progress::Stage stage) {
  return stage == Progress::Stage::kOne || stage == Progress::Stage::kBuilt;
}

}  // namespace

ProgressSeen seen_of(const Progress& progress) {
  return {.phase = progress.phase.load(),
          .stage = progress.stage.load(),
          .plan = {.front_objectives = progress.front_objectives.load(),
                   .front_designs = progress.front_designs.load(),
                   .front_lost_motion = progress.front_lost_motion.load(),
                   .rounding = progress.rounding.load(),
                   .best_only = progress.best_only.load(),
                   .planets = progress.planets.load(),
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

bool RunForecast::builds_after() const {
  return last_.stage == Stage::kBuilt && last_.stage_done == last_.stage_total;
}

bool RunForecast::is_over() const { return last_.stage == Stage::kOne && is_explained_; }

/// Where the time since the last look belongs.
void RunForecast::account(double passed_s, const ProgressSeen& seen) {
  if (last_.phase == Phase::kCertificate) bounds_.time_s += passed_s;
  if (is_over()) return;
  if (last_.phase == Phase::kRefinement && tells_of_sets(last_.stage)) sets_.time_s += passed_s;
  if (!is_of_all(last_.stage)) return;
  if (last_.phase == Phase::kSearch || last_.phase == Phase::kBounds) {
    finding_s_ += passed_s;
    if (seen.phase == Phase::kRefinement) found_s_ = finding_s_;
  }
  if (last_.phase == Phase::kBounds) stages_.time_s += passed_s;
  if (last_.phase == Phase::kGearboxes && !builds_after()) built_s_ += passed_s;
}

/// The items that were done since the last look.
void RunForecast::count(const ProgressSeen& seen, bool other) {
  const std::size_t more = seen.done - (other ? 0 : last_.done);
  if (seen.phase == Phase::kCertificate) bounds_.items += static_cast<double>(more);
  if (seen.phase == Phase::kRefinement && tells_of_sets(seen.stage)) {
    sets_.items += static_cast<double>(more);
  }
  if (!is_of_all(seen.stage)) return;
  if (seen.phase == Phase::kBounds) {
    const std::size_t empty = seen.empty_first + seen.empty_second;
    const std::size_t before = other ? 0 : last_.empty_first + last_.empty_second;
    const auto emptied = static_cast<double>(std::min(more, empty - std::min(empty, before)));
    stages_.items += static_cast<double>(more) - (1.0 - kEmptyStage) * emptied;
  }
}

/// A search ends, and another one begins.
void RunForecast::end_search(double now_s, const ProgressSeen& seen) {
  const double took_s = now_s - search_began_s_;
  if (begun_ && last_.searches > 0 && !builds_after()) {
    Work& over = searches(last_.stage);
    over.time_s += took_s;
    over.items += 1.0;
    over.squared_s2 += took_s * took_s;
    over.longest_s = std::max(over.longest_s, took_s);
  }
  search_began_s_ = now_s;
  if (is_of_all(seen.stage)) finding_s_ = 0.0;
  is_explained_ = is_explained_ ||
                  (begun_ && (last_.stage == Stage::kBeyond || last_.stage == Stage::kRelaxed));
}

void RunForecast::observe(double now_s, const ProgressSeen& seen) {
  const bool search = !begun_ || seen.stage != last_.stage || seen.searches != last_.searches;
  const bool other = search || seen.phase != last_.phase || seen.done < last_.done;
  const bool passes_end = begun_ && seen.stage == Stage::kBuilt && !builds_after() &&
                          seen.stage_done == seen.stage_total;
  if (begun_) account(now_s - last_s_, seen);
  count(seen, other);
  if (search || passes_end) end_search(now_s, seen);
  if (other) {
    rate_.restart(now_s, seen.done);
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

double RunForecast::set_s() const {
  if (stages_.items == 0.0) return sets_.mean_s(0.0, 0.0);  // nothing is bounded
  return sets_.mean_s(kRefining * stages_.mean_s(0.0, 0.0), kSetsExpected);
}

double RunForecast::sharpening_s() const {
  const double expected_s = kSharpening * stages_.mean_s(0.0, 0.0);
  Work own = bounds_;
  if (last_.phase == Phase::kCertificate && last_.done < last_.total) {
    // The one that runs tells nothing until it takes longer than the others.
    const double running_s = last_s_ - item_began_s_;
    own.time_s -= running_s;
    const double mean_s = own.mean_s(expected_s, kBoundsExpected);
    if (running_s <= mean_s) return mean_s;
    own.time_s += running_s;
    own.items += 1.0;
  }
  return own.mean_s(expected_s, kBoundsExpected);
}

/// Of the bounds that are being sharpened, less what the one that runs took.
double RunForecast::sharpenings_s() const {
  const double each_s = sharpening_s();
  return std::max(0.0, number_left(last_.done, last_.total) * each_s -
                           std::min(each_s, last_s_ - item_began_s_));
}

/// What a search of a front takes, as far as its ends tell: those that are not made yet count as
/// expected, as the ends differ among themselves.  Factors, not times, are averaged: either may be
/// far off.
double RunForecast::front_search_s() const {
  Work ends = searches(Stage::kFrontEnds);
  const double running_s = last_s_ - search_began_s_;
  if (last_.stage == Stage::kFrontEnds && running_s > ends.mean_s(0.0, 0.0)) {
    ends.time_s += running_s;
    ends.items += 1.0;
  }
  const double expected_s = front_search(last_.plan).expected * set_s();
  const double ends_s = ends.mean_s(0.0, 0.0);
  if (!(ends_s > 0.0 && expected_s > 0.0)) return std::max(ends_s, expected_s);
  const auto objectives = static_cast<double>(last_.plan.front_objectives);
  const double weight = std::max(kExpectedAsEnds, objectives * objectives - ends.items);
  return std::exp((weight * std::log(expected_s) + ends.items * std::log(ends_s)) /
                  (weight + ends.items));
}

/// By what factor the searches that are to come in the gaps may take more or less: the mean of
/// those made and the sum of those to come scatter each by itself.
double RunForecast::scatter_of_gaps(double to_come) const {
  const Work& made = searches(Stage::kFrontGaps);
  const double mean_s = made.mean_s(0.0, 0.0);
  const double own = mean_s > 0.0 ? made.squared_s2 / (mean_s * mean_s) - made.items : 0.0;
  const double squared = (kEndsCountAs * kScatter * kScatter + own) / (kEndsCountAs + made.items);
  return std::min(kMostScatter, std::exp(std::sqrt(squared * (1.0 / (kEndsCountAs + made.items) +
                                                              1.0 / std::max(1.0, to_come)))));
}

/// What a search of a stage takes, on average of those to come.
double RunForecast::search_s(Stage stage) const {
  const double found_s = found_s_ > 0.0 ? found_s_ : finding_s_;
  switch (stage) {
    case Stage::kOne:
      break;
    case Stage::kBuilt:
      return searches(stage).mean_s(0.0, 0.0);
    case Stage::kPlanets:
      return kSetsOfPlanets.expected * set_s() + kSharpenedOfPlanets.expected * sharpening_s();
    case Stage::kFrontEnds:
      return front_search_s();
    case Stage::kFrontGaps: {
      Work made = searches(stage);
      if (made.items > 2.0) {
        // What the longest one found bounds the others: none like it is foreseen.
        made.time_s -= made.longest_s;
        made.items -= 1.0;
      }
      const double later = searches(stage).items >= 2.0 * kEndsCountAs ? kLaterInGaps : 1.0;
      return later * made.mean_s(front_search_s(), kEndsCountAs);
    }
    case Stage::kBeyond:
      // Beyond a range of tooth numbers there are few sets, with a limit given way all of them.
      return searches(stage).mean_s(found_s, kItemsExpected);
    case Stage::kRelaxed:
      // It ends with the first wave that has a design, which may be long in coming.
      return searches(stage).mean_s(found_s + kSetsOfBest.expected * set_s(), 1.0);
  }
  return found_s;
}

/// Searches of the stage that are to come after the one that runs.
double RunForecast::searches_left() const {
  const double items = number_left(last_.stage_done, last_.stage_total);
  const bool gaps = last_.stage == Stage::kFrontGaps;
  if (!gaps && last_.stage != Stage::kRelaxed) return items - 1.0;
  const double expected = gaps ? kInGaps * static_cast<double>(last_.plan.front_designs) /
                                     std::max(1.0, static_cast<double>(last_.stage_total))
                               : kForLimit;
  return items * (kItemsExpected * expected + searches(last_.stage).items) /
             (kItemsExpected + static_cast<double>(last_.stage_done)) -
         1.0;
}

/// What follows the bounds of a search of all sets, where it refines all of them.
Range RunForecast::rest_of_all() const {
  const auto share = [](std::size_t empty, std::size_t done) {
    return done > 0 ? 1.0 - static_cast<double>(empty) / static_cast<double>(done) : 1.0;
  };
  const std::size_t firsts = std::min(last_.done, last_.first_stages);
  Range left;
  add(left, kOpen,
      static_cast<double>(last_.sets) * share(last_.empty_first, firsts) *
          share(last_.empty_second, last_.done - firsts) * set_s());
  return left;
}

/// Where it refines only what may win, and has refined so many.
Range RunForecast::rest_of_best(double refined) const {
  const double least = kSetsOfBest.expected / kSetsOfBest.factor;
  // Another one at least, however many it has refined.
  Range left{
      .least_s = std::max(1.0, least - refined) * set_s(),
      .most_s = std::max(least, kSetsOfBest.expected * kSetsOfBest.factor - refined) * set_s()};
  if (last_.stage == Stage::kOne) add(left, kSharpened, sharpening_s());
  return left;
}

/// Of the search of all sets that runs.
std::optional<Range> RunForecast::rest_of_first() const {
  const bool best_only = last_.plan.best_only || last_.stage == Stage::kBuilt;
  const std::optional<double> left_s = rate_.seconds_left(last_.total);
  Range left;
  switch (last_.phase) {
    case Phase::kSearch:
      return std::nullopt;
    case Phase::kBounds: {
      if (!left_s) return std::nullopt;
      left = best_only ? rest_of_best(0.0) : rest_of_all();
      const double firsts = number_left(last_.done, last_.first_stages);
      const double seconds = number_left(last_.done, last_.total) - firsts;
      add(left,
          firsts > 0.0 ? *left_s * (firsts + kSecondStage * seconds) / (firsts + seconds) : *left_s,
          kBoundingFactor);
      return left;
    }
    case Phase::kRefinement:
      if (!best_only) {
        add(left, number_left(last_.done, last_.total) * set_s());
      } else if (last_.done < kSetsKnown || !left_s) {
        left = rest_of_best(static_cast<double>(last_.done));
      } else {
        add(left, *left_s);
        if (last_.stage == Stage::kOne) add(left, kSharpened, sharpening_s());
      }
      return left;
    case Phase::kCertificate:
      add(left, sharpenings_s());
      return left;
    case Phase::kGearboxes:
      if (!left_s) return std::nullopt;
      add(left, *left_s);
      return left;
  }
  return std::nullopt;
}

/// Of the proof of the best of a number of planets that runs.
Range RunForecast::rest_of_planets() const {
  Range left;
  if (last_.stage_done == last_.stage_total) return left;
  const double items = number_left(last_.done, last_.total);
  if (last_.phase == Phase::kCertificate) {
    add(left, sharpenings_s());
    return left;
  }
  const double sets = std::max(1.0, kSetsOfPlanets.expected - static_cast<double>(last_.done));
  add(left, std::min(items, last_.done < kSetsKnown ? sets : items) * set_s());
  add(left, kSharpenedOfPlanets, sharpening_s());
  return left;
}

/// Of the search that runs.
std::optional<Range> RunForecast::rest_of_search() const {
  const double elapsed_s = last_s_ - search_began_s_;
  Range left;
  if (builds_after()) {
    add(left, time_left(built_after_s(), elapsed_s));
    return left;
  }
  const bool of_all = is_of_all(last_.stage);
  if (of_all && searches(last_.stage).items == 0.0) return rest_of_first();
  if (last_.stage == Stage::kOne) return rest_of_first();
  if (last_.stage == Stage::kPlanets) return rest_of_planets();
  double left_s = time_left(search_s(last_.stage), elapsed_s);
  const bool many = !of_all && last_.phase == Phase::kRefinement && last_.done >= kSetsKnown;
  if (many && last_.stage == Stage::kRelaxed) {
    // The next wave may have a design, or none until it is given up.
    const double most_s =
        rate_.seconds_left(std::min(kMostRefinedWithout, last_.total)).value_or(left_s);
    left.least_s += std::min(kGoesOn * elapsed_s, most_s);
    left.most_s += most_s;
    return left;
  }
  const double all_s = rate_.seconds_left(last_.total).value_or(left_s);
  const bool front = last_.stage == Stage::kFrontEnds || last_.stage == Stage::kFrontGaps;
  if (front && last_.phase == Phase::kRefinement && last_.done > 0) {
    // What the first wave finds may rule out the other sets, or none of them.
    const bool waved = static_cast<double>(last_.done) >= kSetsOfBest.expected;
    left.least_s += waved ? all_s : left_s;
    left.most_s += waved ? all_s : std::max(left_s, all_s);
    return left;
  }
  if (many) left_s = all_s;
  add(left, left_s);
  return left;
}

/// What a pass takes to build its gearboxes; 0 before any is built.
double RunForecast::built_in_pass_s() const {
  double passes = searches(Stage::kBuilt).items, all_s = built_s_;
  if (last_.stage == Stage::kBuilt && last_.phase == Phase::kGearboxes && !builds_after()) {
    passes += 1.0;
    all_s += rate_.seconds_left(last_.total).value_or(0.0);
  }
  return passes > 0.0 ? all_s / passes : 0.0;
}

/// What is built after the passes, at what one costs in them.
double RunForecast::built_after_s() const {
  const auto& plan = last_.plan;
  if (plan.built_per_pass == 0) return 0.0;
  return built_in_pass_s() * static_cast<double>(plan.built_after) /
         static_cast<double>(plan.built_per_pass);
}

/// What follows the pass for built gearboxes that runs.
void RunForecast::add_passes(Range& left) const {
  const Progress::Plan& plan = last_.plan;
  double pass_s = search_s(Stage::kBuilt);
  if (searches(Stage::kBuilt).items == 0.0) {
    pass_s = last_s_ - search_began_s_ + left.middle_s();
    if (last_.phase != Phase::kGearboxes && plan.built_after > 0) {
      // Its own gearboxes, at what is expected of those built after the passes.
      const double built_s = kBuiltAfter.expected * pass_s *
                             static_cast<double>(plan.built_per_pass) /
                             static_cast<double>(plan.built_after);
      add(left, built_s, kBuiltAfter.factor);
      pass_s += built_s;
    }
  }
  if (!builds_after()) {
    const std::size_t begun = std::max<std::size_t>(1, last_.searches);
    left.least_s += pass_s * number_left(begun, plan.passes_least);
    left.most_s += pass_s * number_left(begun, plan.passes_most);
    const double built_s = built_after_s();
    if (built_s > 0.0) {
      add(left, built_s);
    } else {
      add(left, kBuiltAfter, pass_s);
    }
  }
  // Then the search under the limits found.
  if (plan.best_only) {
    add(left, pass_s);
    add(left, kSharpened, sharpening_s());
  } else {
    add(left, found_s_ > 0.0 ? found_s_ : pass_s);
    if (last_.open > 0) {
      add(left, static_cast<double>(last_.open) * set_s());
    } else {
      add(left, kOpen, static_cast<double>(last_.sets) * set_s());
    }
  }
}

/// What follows the searches of the stage that runs.
void RunForecast::add_later(Range& left) const {
  const Progress::Plan& plan = last_.plan;
  const bool planets = last_.stage == Stage::kPlanets;
  const bool of_all = is_of_all(last_.stage) || planets;
  if (of_all && plan.planets > 0) {
    add(left, kHeldBack * static_cast<double>(plan.planets) * set_s());
    // That of the best of all is proven with it.
    const double others = planets ? number_left(last_.stage_done + 1, last_.stage_total)
                                  : static_cast<double>(plan.planets - 1);
    add(left, kSetsOfPlanets, others * set_s());
    add(left, kSharpenedOfPlanets, others * sharpening_s());
  }
  if (plan.front_objectives > 1) {
    const auto objectives = static_cast<double>(plan.front_objectives);
    const double in_gaps = kInGaps * static_cast<double>(plan.front_designs);
    if (of_all) {
      add(left, (objectives * objectives + in_gaps) * front_search_s(), front_search(plan).factor);
    } else if (last_.stage == Stage::kFrontEnds) {
      add(left, in_gaps * front_search_s(), kGapsOverEnds);
    }
  }
  if (plan.explains && last_.stage != Stage::kBeyond && last_.stage != Stage::kRelaxed) {
    const bool none = last_.feasible == 0 && last_.phase == Phase::kRefinement &&
                      2 * last_.done > std::min(last_.total, 4 * kSetsKnown);
    const bool few = last_.sets > kMostSearchedAgain || plan.passes_most > 0;
    if (none || !few) add(left, none ? kRelaxed : kBeyond, search_s(Stage::kBeyond));
  }
}

std::optional<Range> RunForecast::range_now() const {
  if (!begun_ || last_.total == 0) return std::nullopt;
  Range left;
  const Progress::Plan& plan = last_.plan;
  const double rounding_s = plan.rounding ? kRounding.expected * set_s() : 0.0;
  if (is_over()) {
    if (rounding_s > 0.0) add(left, time_left(rounding_s, last_s_ - search_began_s_));
    return left;
  }
  const std::optional<Range> running = rest_of_search();
  if (!running) return std::nullopt;
  left = *running;
  if (last_.stage == Stage::kBuilt) add_passes(left);
  if (!is_of_all(last_.stage) && last_.stage != Stage::kPlanets) {
    const bool gaps = last_.stage == Stage::kFrontGaps;
    const bool limits = last_.stage == Stage::kRelaxed;
    const double to_come = std::max(0.0, searches_left());
    add(left, to_come * search_s(last_.stage),
        gaps     ? scatter_of_gaps(to_come)
        : limits ? kRelaxed.factor
                 : 1.0);
  }
  add_later(left);
  add(left, rounding_s, kRounding.factor);
  return left;
}

std::optional<Range> RunForecast::range_left() const {
  const std::optional<Range> now = range_now();
  if (now || !told_) return now;
  // Between two phases what was told before holds, less the time that passed.
  const double passed_s = last_s_ - told_at_s_;
  return Range{.least_s = std::max(0.0, told_->least_s - passed_s),
               .most_s = std::max(0.0, told_->most_s - passed_s)};
}

std::optional<double> RunForecast::seconds_left() const {
  if (const std::optional<Range> now = range_now()) return now->middle_s();
  if (!told_) return std::nullopt;
  return std::max(0.0, told_->middle_s() - (last_s_ - told_at_s_));
}

bool RunForecast::Range::is_one() const { return most_s <= kOneNumber * least_s; }

double RunForecast::Range::middle_s() const { return std::sqrt(least_s * most_s); }

}  // namespace gear3k::optimize
