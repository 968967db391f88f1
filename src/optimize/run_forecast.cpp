#include "optimize/run_forecast.hpp"

#include <algorithm>
#include <cmath>

#include "optimize/optimizer.hpp"
#include "optimize/relaxed_limits.hpp"
#include "optimize/run_expectations.hpp"
#include "optimize/wider_search.hpp"

namespace gear3k::optimize {

namespace {

using Range = RunForecast::Range;

void add(Range& left, double time_s, double factor = 1.0) {
  left.least_s += time_s / factor;
  left.most_s += time_s * factor;
}
void add(Range& left, const Foreseen& items, double each_s) {
  add(left, items.expected * each_s, items.factor);
}

/// Mean over the next so many numbers of planets, over the one that runs.
double share_of_later(double numbers) {
  const double sum = kShareOfNext * (1.0 - std::pow(kShareOfNext, numbers)) / (1.0 - kShareOfNext);
  return numbers > 0.0 ? sum / numbers : 0.0;
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

bool RunForecast::builds_after() const {
  return last_.stage == Stage::kBuilt && last_.stage_done == last_.stage_total;
}

bool RunForecast::is_over() const { return last_.stage == Stage::kOne && is_explained_; }

/// Whether a pass for built gearboxes goes by limits that no stage of so many keeps: it is the
/// last.
bool RunForecast::finds_nothing() const {
  constexpr std::size_t kMany = 5;  // times as few tell it
  return last_.stage == Stage::kBuilt && last_.phase == Phase::kBounds &&
         kMany * last_.empty_first >= last_.first_stages && last_.empty_first > 0 &&
         last_.empty_first >= std::min(last_.done, last_.first_stages);
}

/// Where the time since the last look belongs.
void RunForecast::account(double passed_s, const ProgressSeen& seen) {
  if (is_over() || !is_of_all(last_.stage)) return;
  // Modules of two stages are tied where all sets are sought, or a few at a time.
  const bool ties = last_.phase == Phase::kBounds && last_.second_stages > 0 &&
                    last_.done >= last_.first_stages + last_.second_stages;
  if ((last_.phase == Phase::kSearch || last_.phase == Phase::kBounds) && !ties) {
    finding_s_ += passed_s;
  }
  if (last_.phase != Phase::kRefinement && seen.phase == Phase::kRefinement) {
    found_s_ = finding_s_;
  }
  if (last_.phase == Phase::kGearboxes && !builds_after()) built_s_ += passed_s;
}

/// The items that were done since the last look, in the same phase of the same search, and their
/// time: what passed from one phase to another is of neither.
void RunForecast::count(double passed_s, const ProgressSeen& seen) {
  const std::size_t more = seen.done - last_.done;
  const auto take = [&](Work& work) {
    work.time_s += passed_s;
    work.items += static_cast<double>(more);
  };
  if (seen.phase == Phase::kCertificate) take(bounds_);
  if (seen.phase == Phase::kRefinement && tells_of_sets(seen.stage) && !is_over()) take(sets_);
  if (!is_of_all(seen.stage) || seen.phase != Phase::kBounds) return;
  if (last_.done >= seen.first_stages) return;
  const std::size_t empty = seen.empty_first + seen.empty_second;
  const std::size_t before = last_.empty_first + last_.empty_second;
  const auto emptied = static_cast<double>(std::min(more, empty - std::min(empty, before)));
  const double full = static_cast<double>(more) - emptied;
  stages_.nn += full * full;
  stages_.nm += full * emptied;
  stages_.mm += emptied * emptied;
  stages_.nt += full * passed_s;
  stages_.mt += emptied * passed_s;
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
  if (!other) count(now_s - last_s_, seen);
  if (begun_ && last_.phase == Phase::kRefinement && seen.phase == Phase::kCertificate) {
    contest_sets_ += static_cast<double>(last_.done);
    contest_bounds_ += static_cast<double>(seen.to_sharpen);
  }
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

/// What bounding a stage that has a design takes: by least squares from the looks, those without
/// one at what they took.
double RunForecast::stage_s() const {
  // That an empty one takes kEmptyStage of it counts as a look at a share of those without.
  const double k = kEmptyStage, w = kEmptyCountsAs * (stages_.mm + stages_.nn);
  const double aa = stages_.nn + w * k * k, ab = stages_.nm - w * k, bb = stages_.mm + w;
  const double det = aa * bb - ab * ab;
  if (!(det > 0.0)) return 0.0;
  const double full_s = (stages_.nt * bb - stages_.mt * ab) / det;
  const double empty_s = (stages_.mt * aa - stages_.nt * ab) / det;
  if (full_s > 0.0 && empty_s >= 0.0) return full_s;
  // One of the two takes no time.
  if (full_s > 0.0) return stages_.nt / stages_.nn;
  return stages_.mm > 0.0 ? stages_.mt / stages_.mm / k : 0.0;
}

double RunForecast::set_s() const {
  const double expected_s = kRefining * stage_s();
  return sets_.mean_s(expected_s, expected_s > 0.0 ? kSetsExpected : 0.0);
}

double RunForecast::sharpening_s() const {
  const double expected_s = kSharpening * stage_s();
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
    case Stage::kHeldBack:
      return searches(stage).mean_s(kHeldBack * set_s(), 1.0);
    case Stage::kPlanets:
      return kSetsOfPlanets.expected * (set_s() + sharpened_share() * sharpening_s());
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

/// Whether a wave of the contest that runs is over: what its certificate takes is known so far.
bool RunForecast::is_waved() const {
  return last_.phase == Phase::kCertificate ||
         (last_.phase == Phase::kRefinement && last_.done >= std::min(kFirstWave, last_.total));
}

/// Sets that the wave which runs still refines.
double RunForecast::left_of_wave() const {
  std::size_t wave = std::min(kFirstWave, last_.total), size = kFirstWave;
  while (wave <= last_.done && wave < last_.total) {
    size = std::min(2 * size, kWave);
    wave = std::min(wave + size, last_.total);
  }
  return std::max(1.0, number_left(last_.done, wave));
}

/// Of the sets that are refined those whose bounds are sharpened after it.
double RunForecast::sharpened_share() const {
  double sets = kShareCountsAs + contest_sets_;
  double bounds = share_sharpened(last_.plan) * kShareCountsAs + contest_bounds_;
  if (last_.phase == Phase::kRefinement && is_waved()) {
    sets += static_cast<double>(last_.done);
    bounds += static_cast<double>(last_.to_sharpen);
  }
  return bounds / sets;
}

/// A search for the best alone that has not begun to refine.
Range RunForecast::rest_of_best() const {
  Range left;
  add(left, kSetsOfBest, set_s());
  if (last_.stage == Stage::kOne) add(left, sharpened(last_.plan), sharpening_s());
  return left;
}

/// A search for the best alone, or of a number of planets, that refines or sharpens: the wave that
/// runs is refined to its end, at most all that may win as the best stands.
Range RunForecast::rest_of_contest() const {
  Range left;
  if (last_.phase == Phase::kCertificate) {
    add(left, sharpenings_s());
    return left;
  }
  const bool first = last_.done < kFirstWave;
  const double least = left_of_wave();
  const std::size_t end = first ? std::min<std::size_t>(last_.total, 2 * kFirstWave) : last_.total;
  const double most = std::max(least, number_left(last_.done, end));
  left = {.least_s = least * set_s(), .most_s = most * set_s()};
  if (last_.stage == Stage::kBuilt) return left;
  const double share = sharpened_share();
  if (is_waved() || last_.stage == Stage::kPlanets) {
    const auto known = static_cast<double>(last_.to_sharpen);
    left.least_s += (known + share * least / 2.0) * sharpening_s();
    left.most_s += (known + share * most) * sharpening_s();
  } else {
    add(left, sharpened(last_.plan), sharpening_s());
  }
  return left;
}

/// The proofs of the numbers of planets whose turn is to come.
void RunForecast::add_contests(Range& left) const {
  const bool planets = last_.stage == Stage::kPlanets;
  if (planets && last_.stage_done == last_.stage_total) return;
  if (planets || (is_waved() && last_.stage == Stage::kOne)) {
    const auto sets = static_cast<double>(last_.later_sets);
    const double to_come = planets ? number_left(last_.stage_done + 1, last_.stage_total)
                                   : static_cast<double>(last_.plan.planets - 1);
    const double share = sharpened_share() * share_of_later(to_come);
    add(left, sets * set_s(), kSetsOfPlanets.factor);
    add(left, (static_cast<double>(last_.later_bounds) + share * sets) * sharpening_s(),
        kSetsOfPlanets.factor);
    return;
  }
  // That of the best of all is proven with it.
  const auto others = static_cast<double>(last_.plan.planets - 1);
  add(left, kSetsOfPlanets, others * set_s());
  add(left,
      kSetsOfPlanets.expected * sharpened_share() * share_of_later(others) * others *
          sharpening_s(),
      sharpened(last_.plan).factor);
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
      left = best_only ? rest_of_best() : rest_of_all();
      const double firsts = number_left(last_.done, last_.first_stages);
      const double seconds = number_left(last_.done, last_.total) - firsts;
      add(left,
          firsts > 0.0 ? *left_s * (firsts + kSecondStage * seconds) / (firsts + seconds) : *left_s,
          kBoundingFactor);
      return left;
    }
    case Phase::kRefinement:
      if (best_only) return rest_of_contest();
      add(left, number_left(last_.done, last_.total) * set_s());
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
  if (last_.stage == Stage::kPlanets) {
    return last_.stage_done == last_.stage_total ? left : rest_of_contest();
  }
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
    const bool waved = last_.done >= kFirstWave;
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
    add(left, sharpened(plan), sharpening_s());
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
    add_contests(left);
  }
  if (of_all) add(left, static_cast<double>(plan.told) * search_s(Stage::kHeldBack));
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
  if (last_.stage == Stage::kBuilt && !finds_nothing()) add_passes(left);
  if (!is_of_all(last_.stage) && last_.stage != Stage::kPlanets) {
    const bool gaps = last_.stage == Stage::kFrontGaps;
    const bool limits = last_.stage == Stage::kRelaxed;
    const double to_come = std::max(0.0, searches_left());
    add(left, to_come * search_s(last_.stage),
        gaps     ? scatter_of_gaps(to_come)
        : limits ? kRelaxed.factor
                 : 1.0);
  }
  if (!finds_nothing()) {
    add_later(left);
    add(left, rounding_s, kRounding.factor);
  }
  return left;
}

std::optional<Range> RunForecast::range_left() const {
  const std::optional<Range> now = range_now();
  if (now) return now->told();
  if (!told_) return std::nullopt;
  // Between two phases what was told before holds, less the time that passed.
  const double passed_s = last_s_ - told_at_s_;
  return Range{.least_s = std::max(0.0, told_->least_s - passed_s),
               .most_s = std::max(0.0, told_->most_s - passed_s)}
      .told();
}

std::optional<double> RunForecast::seconds_left() const {
  if (const std::optional<Range> now = range_now()) return now->middle_s();
  if (!told_) return std::nullopt;
  return std::max(0.0, told_->middle_s() - (last_s_ - told_at_s_));
}

bool RunForecast::Range::is_one() const { return most_s <= kOneNumber * least_s; }

Range RunForecast::Range::told() const {
  if (is_one() || is_bound()) return *this;
  return {.least_s = middle_s() / kHalfToldRange, .most_s = middle_s() * kHalfToldRange};
}

bool RunForecast::Range::is_bound() const { return most_s > kOneBound * least_s; }

double RunForecast::Range::middle_s() const { return std::sqrt(least_s * most_s); }

}  // namespace gear3k::optimize
