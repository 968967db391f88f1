// Time left over all phases of a run, against simulated runs of known durations.

#include "optimize/run_forecast.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <vector>

namespace gear3k::optimize::run_forecast_test {
namespace {

using Phase = Progress::Phase;
using Stage = Progress::Stage;

/// A part of a run: so many items in a time, as progress shows them.
struct Part {
  ProgressSeen seen;
  std::size_t items = 0;
  double time_s = 0.0;
};

void expect_within(double factor, const std::vector<Part>& parts, const Progress::Plan& plan) {
  double whole = 0.0;
  for (const Part& part : parts) whole += part.time_s;
  RunForecast forecast;
  EXPECT_FALSE(forecast.seconds_left());
  double began = 0.0;
  int judged = 0;
  for (const Part& part : parts) {
    constexpr double kLook_s = 0.05;
    for (double t = 0.0; t < part.time_s; t += kLook_s) {
      ProgressSeen seen = part.seen;
      seen.plan = plan;
      seen.total = part.items;
      seen.done = static_cast<std::size_t>(static_cast<double>(part.items) * t / part.time_s);
      forecast.observe(began + t, seen);
      const double now = began + t;
      const auto left = forecast.seconds_left();
      if (!left || now < 0.1 * whole || now > 0.95 * whole) continue;
      EXPECT_LT(*left, factor * (whole - now)) << now << " of " << whole;
      EXPECT_GT(*left * factor, whole - now) << now << " of " << whole;
      ++judged;
      const auto told = forecast.range_left();
      if (!told->is_bound()) {
        EXPECT_LE(told->most_s, 4.001 * told->least_s) << now << " of " << whole;
      }
    }
    began += part.time_s;
  }
  EXPECT_GT(judged, 50);
}

ProgressSeen at(Phase phase, Stage stage = Stage::kOne) {
  ProgressSeen seen;
  seen.phase = phase;
  seen.stage = stage;
  return seen;
}

/// Bounds of 1000 stages, half of them of each kind and all with a design, of so many sets.
ProgressSeen bounds_of(std::size_t sets, Stage stage = Stage::kOne) {
  ProgressSeen seen = at(Phase::kBounds, stage);
  seen.sets = sets;
  seen.total = 1000;
  seen.first_stages = 500;
  return seen;
}

TEST(RunForecast, OfOneSearchIsThatOfItsRefinement) {
  expect_within(2.0,
                {{at(Phase::kSearch), 100, 0.1},
                 {bounds_of(1000), 1000, 0.9},
                 {at(Phase::kRefinement), 1000, 6.0}},
                {});
}

/// Bounds of stages in looks, of which so many have a design and so many none, each at its time.
struct Look {
  std::size_t full = 0, empty = 0;
};

double left_after(const std::vector<Look>& looks, double full_s, double empty_s) {
  RunForecast forecast;
  ProgressSeen seen = bounds_of(1000);
  double now_s = 0.0;
  forecast.observe(now_s, seen);
  for (const Look& look : looks) {
    now_s += full_s * static_cast<double>(look.full) + empty_s * static_cast<double>(look.empty);
    seen.done += look.full + look.empty;
    seen.empty_first += look.empty;
    forecast.observe(now_s, seen);
  }
  return *forecast.seconds_left();
}

// Where four of five have none, a set takes as long whatever those without one take, and a fifth
// of the sets are open.
TEST(RunForecast, LearnsWhatAStageWithoutADesignTakes) {
  const std::vector<Look> mixed{{5, 95}, {35, 65}, {10, 90}, {30, 70}, {20, 80}};
  const double nothing_s = left_after(mixed, 1e-3, 0.0);
  const double tenth_s = left_after(mixed, 1e-3, 1e-4);
  const double half_s = left_after(mixed, 1e-3, 5e-4);
  // What differs is the bounding that is left: 500 stages of the second kind, as those so far.
  EXPECT_NEAR(tenth_s - nothing_s, 0.0, 0.1 * nothing_s);
  EXPECT_NEAR(half_s - nothing_s, 0.0, 0.4 * nothing_s);
  const std::vector<Look> full(5, {100, 0});
  EXPECT_NEAR(left_after(full, 1e-3, 0.0) / nothing_s, 5.0, 1.5);
  const std::vector<Look> none(5, {0, 100});
  EXPECT_LT(left_after(none, 1e-3, 1e-3), 0.5 * left_after(full, 1e-3, 1e-3));
}

// Passes with gearboxes, what is built after them, and the search under the limits found.
TEST(RunForecast, HoldsForBuiltGearboxes) {
  constexpr std::size_t kPasses = 5;
  std::vector<Part> parts;
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    const auto add = [&](Part part) {
      part.seen.stage = Stage::kBuilt;
      part.seen.stage_done = pass;
      part.seen.stage_total = kPasses;
      part.seen.searches = pass + 1;
      part.seen.open = 800;
      parts.push_back(part);
    };
    add({bounds_of(1000), 1000, 1.0});
    add({at(Phase::kRefinement), 30, 0.25});
    add({at(Phase::kGearboxes), 30, 0.2});
  }
  Part built{at(Phase::kGearboxes, Stage::kBuilt), 10'000'000, 10.0};
  built.seen.stage_done = built.seen.stage_total = built.seen.searches = kPasses;
  built.seen.open = 800;
  parts.push_back(built);
  ProgressSeen found = bounds_of(1000);
  found.searches = kPasses;
  parts.push_back({found, 1000, 1.0});
  ProgressSeen refined = at(Phase::kRefinement);
  refined.searches = kPasses;
  parts.push_back({refined, 800, 6.4});
  expect_within(2.0, parts,
                {.passes_least = kPasses,
                 .passes_most = kPasses,
                 .built_per_pass = 200'000,
                 .built_after = 10'000'000});
}

// What is to come of it follows from the searches made, though they take a tenth of what was
// expected.
TEST(RunForecast, LearnsFromTheSearchesOfAFront) {
  constexpr std::size_t kDesigns = 40;
  RunForecast forecast;
  ProgressSeen first = at(Phase::kRefinement);
  first.plan = {.front_objectives = 2, .front_designs = kDesigns, .front_lost_motion = true};
  first.total = 100;
  forecast.observe(0.0, first);
  first.done = 100;
  forecast.observe(20.0, first);
  const auto search = [&](Stage stage, std::size_t number, std::size_t total, double now_s) {
    ProgressSeen seen = at(Phase::kRefinement, stage);
    seen.plan = first.plan;
    seen.searches = number + 1;
    seen.stage_done = number;
    seen.stage_total = total;
    seen.total = 10;
    forecast.observe(now_s, seen);
  };
  constexpr double kSearch_s = 0.25;
  double now_s = 20.0;
  for (std::size_t k = 0; k < 4; ++k, now_s += kSearch_s) search(Stage::kFrontEnds, k, 4, now_s);
  EXPECT_GT(*forecast.seconds_left(), 50.0);
  for (std::size_t k = 0; k < kDesigns / 2; ++k, now_s += kSearch_s) {
    search(Stage::kFrontGaps, k, kDesigns, now_s);
  }
  const double left_s = kSearch_s * static_cast<double>(kDesigns) / 2.0;
  EXPECT_LT(*forecast.seconds_left(), 2.0 * left_s);
  EXPECT_GT(*forecast.seconds_left(), 0.5 * left_s);
}

/// Searches of a stage one after the other, from a time on; the next one has begun then.
double run_searches(RunForecast& forecast, ProgressSeen seen, const std::vector<double>& times_s,
                    double began_s) {
  for (std::size_t k = 0; k <= times_s.size(); ++k) {
    seen.searches = k + 1;
    seen.stage_done = k;
    forecast.observe(began_s, seen);
    if (k < times_s.size()) began_s += times_s[k];
  }
  return began_s;
}

/// A search of all sets: bounds in 1 s, refinement in 19 s.
void run_search_of_all(RunForecast& forecast, const Progress::Plan& plan) {
  ProgressSeen seen = bounds_of(1000);
  seen.plan = plan;
  forecast.observe(0.0, seen);
  seen.done = seen.total;
  forecast.observe(1.0, seen);
  seen.phase = Phase::kRefinement;
  seen.feasible = 1;
  seen.done = 0;
  forecast.observe(1.0, seen);
  seen.done = seen.total;
  forecast.observe(20.0, seen);
}

// What is told of the ends still to come, and of the gaps, follows from those made, some of which
// take far less.
TEST(RunForecast, LearnsFromTheEndsOfAFront) {
  const Progress::Plan plan{.front_objectives = 3, .front_designs = 30, .front_lost_motion = true};
  ProgressSeen seen = at(Phase::kRefinement, Stage::kFrontEnds);
  seen.plan = plan;
  seen.total = 10;
  seen.stage_total = 9;
  const auto least_after = [&](const std::vector<double>& times_s) {
    RunForecast forecast;
    run_search_of_all(forecast, plan);
    run_searches(forecast, seen, times_s, 20.0);
    return forecast.range_left()->least_s;
  };
  // Means of 0.2 and 8 s, with three searches at the ends to come, and those in the gaps, no more
  // than one for each design.
  const double more_s =
      least_after({12.0, 0.0, 12.0, 3.0, 15.0, 6.0}) - least_after({0.1, 0.0, 0.4, 0.3, 0.3, 0.1});
  EXPECT_GT(more_s, 0.5 * 3.0 * (8.0 - 0.2));
  EXPECT_LT(more_s, (3.0 + 30.0) * (8.0 - 0.2));
}

TEST(RunForecast, LearnsFromTheSearchesBeyondRanges) {
  const Progress::Plan plan{.explains = true};
  ProgressSeen seen = at(Phase::kSearch, Stage::kBeyond);
  seen.plan = plan;
  seen.total = 10;
  seen.stage_total = 10;
  RunForecast forecast;
  run_search_of_all(forecast, plan);
  forecast.observe(20.0, seen);
  // As many as there are to come, of 0.1 s on average.
  run_searches(forecast, seen, {0.01, 0.25, 0.01, 0.03, 0.2}, 20.0);
  const double after_s = *forecast.seconds_left();
  EXPECT_GT(after_s, 0.5 * 5.0 * 0.1);
  RunForecast slow;
  run_search_of_all(slow, plan);
  run_searches(slow, seen, {4.0, 6.0, 8.0, 10.0, 12.0}, 20.0);
  EXPECT_GT(*slow.seconds_left(), 0.5 * 5.0 * 8.0);
  EXPECT_LT(*slow.seconds_left(), 2.0 * 5.0 * 8.0);
  EXPECT_LT(after_s, 0.3 * *slow.seconds_left());
}

/// The first of five passes for built gearboxes, in which so many sets are refined: bounds take
/// 0.1 s, a set as long.
double left_in_first_pass(std::size_t refined, std::size_t built_per_pass) {
  RunForecast forecast;
  ProgressSeen seen = bounds_of(1000, Stage::kBuilt);
  seen.plan = {.best_only = true,
               .passes_least = 5,
               .passes_most = 5,
               .built_per_pass = built_per_pass,
               .built_after = 1'000'000};
  seen.searches = 1;
  seen.stage_total = 5;
  forecast.observe(0.0, seen);
  seen.done = seen.total;
  forecast.observe(0.1, seen);
  seen.phase = Phase::kRefinement;
  seen.total = 1000;
  for (seen.done = 0; seen.done < refined; ++seen.done) {
    forecast.observe(0.1 + 0.1 * static_cast<double>(seen.done), seen);
  }
  forecast.observe(0.1 + 0.1 * static_cast<double>(refined), seen);
  return *forecast.seconds_left();
}

// A search that goes on beyond the fewest sets has not ended: its pass takes no less than before.
TEST(RunForecast, OfAPassDoesNotFallWhereItRefinesMoreThanTheFewest) {
  double before_s = left_in_first_pass(14, 0);
  for (const std::size_t refined : {15U, 16U, 17U, 24U, 40U}) {
    const double now_s = left_in_first_pass(refined, 0);
    // Within its first wave it has some sets less to go.
    EXPECT_GT(now_s, 0.94 * before_s) << refined;
    before_s = now_s;
  }
}

// A pass builds gearboxes: a fifth of those after the passes, which take four passes.
TEST(RunForecast, CountsTheGearboxesOfTheFirstPass) {
  EXPECT_GT(left_in_first_pass(10, 200'000), 1.3 * left_in_first_pass(10, 0));
}

// Where ranges and limits gave way only rounding is to come.
TEST(RunForecast, ForeseesNoSearchAfterTheLast) {
  RunForecast forecast;
  ProgressSeen seen = bounds_of(1000);
  seen.plan = {.explains = true};
  forecast.observe(0.0, seen);
  seen.done = 1000;
  forecast.observe(1.0, seen);
  ProgressSeen refined = at(Phase::kRefinement);
  refined.plan = seen.plan;
  refined.total = refined.done = refined.feasible = 100;
  forecast.observe(1.5, refined);
  EXPECT_GT(*forecast.seconds_left(), 0.5);
  ProgressSeen beyond = bounds_of(1000, Stage::kBeyond);
  beyond.plan = seen.plan;
  beyond.searches = beyond.stage_total = 1;
  forecast.observe(2.0, beyond);
  EXPECT_NEAR(*forecast.seconds_left(), 1.5, 0.5);  // as long as search and bounds took
  forecast.observe(3.0, refined);
  EXPECT_EQ(*forecast.seconds_left(), 0.0);
}

TEST(RunForecast, TellsAFrontThatIsStillToComeWhileSetsAreRefined) {
  // As the fronts of docs/theory §12 ("Time left"): ends in as long as the search before, gaps in
  // some times as long.
  std::vector<Part> parts{{bounds_of(1000), 1000, 1.0}, {at(Phase::kRefinement), 1000, 6.0}};
  const auto add = [&](Stage stage, std::size_t done, std::size_t total, std::size_t searches) {
    Part part{at(Phase::kRefinement, stage), 35, 1.6};
    part.seen.stage_done = done;
    part.seen.stage_total = total;
    part.seen.searches = searches;
    parts.push_back(part);
  };
  for (std::size_t n = 0; n < 4; ++n) add(Stage::kFrontEnds, n, 4, n + 1);
  for (std::size_t n = 0; n < 30; ++n) add(Stage::kFrontGaps, n, 30, n + 1);
  expect_within(2.0, parts,
                {.front_objectives = 2, .front_designs = 30, .front_lost_motion = true});
  RunForecast alone;
  alone.observe(0.0, at(Phase::kRefinement));
  ProgressSeen half = at(Phase::kRefinement);
  half.total = 100;
  half.done = 50;
  alone.observe(5.0, half);
  const double without = *alone.seconds_left();
  half.plan = {.front_objectives = 2, .front_designs = 30, .front_lost_motion = true};
  alone.observe(5.0, half);
  EXPECT_GT(*alone.seconds_left(), 10.0 * without);
}

/// A certified run of four numbers of planets: a stage takes 2 ms, a set 10 ms and a bound 0.3 s.
/// Of 32 sets refined for each number so many bounds are sharpened.
void expect_proofs_within(double factor, const std::array<std::size_t, 4>& bounds) {
  const auto of = [](Phase phase, std::size_t number, std::size_t to_sharpen) {
    ProgressSeen seen = at(phase, number == 0 ? Stage::kOne : Stage::kPlanets);
    seen.searches = number;
    seen.stage_done = number;
    seen.stage_total = 4;
    seen.to_sharpen = to_sharpen;
    seen.later_sets = 32 * (3 - number);
    return seen;
  };
  std::vector<Part> parts{{bounds_of(20000), 1000, 2.0}};
  for (std::size_t number = 0; number < 4; ++number) {
    const std::size_t own = bounds[number];
    parts.push_back({of(Phase::kRefinement, number, 0), 32, 0.32});
    if (own == 0) continue;
    parts.push_back({of(Phase::kCertificate, number, own), own, 0.3 * static_cast<double>(own)});
  }
  Progress::Plan plan;
  plan.best_only = true;
  plan.planets = plan.told = 4;
  expect_within(factor, parts, plan);
}

TEST(RunForecast, ForeseesTheProofsOfNumbersOfPlanets) { expect_proofs_within(2.5, {10, 5, 3, 2}); }

// Nobody knows while stages are bounded how many bounds will be sharpened: from there on it is
// what the sets refined so far have above the best.
TEST(RunForecast, GoesByTheBoundsThatAreAboveTheBest) {
  for (const std::size_t above : {0U, 1U, 20U, 150U}) {
    RunForecast forecast;
    ProgressSeen seen = bounds_of(20000);
    seen.plan.best_only = true;
    forecast.observe(0.0, seen);
    seen.done = 500;
    forecast.observe(1.0, seen);
    seen.done = seen.total;
    forecast.observe(2.0, seen);
    seen.phase = Phase::kRefinement;
    seen.done = 0;
    seen.total = 5000;
    forecast.observe(2.0, seen);
    seen.done = seen.total = 32;
    seen.to_sharpen = above;
    forecast.observe(2.32, seen);
    seen.phase = Phase::kCertificate;
    seen.done = 0;
    seen.total = above;
    // As long as 110 stages of 2 ms.
    const double left_s = 0.22 * static_cast<double>(above);
    forecast.observe(2.32, seen);
    EXPECT_NEAR(forecast.seconds_left().value_or(0.0), left_s, 0.3 * left_s + 0.05) << above;
  }
}

// Stages of the first kind keep no limit of the pass: there is no design, and nothing is built.
TEST(RunForecast, OfAPassThatFindsNothingIsItsBounds) {
  RunForecast forecast;
  ProgressSeen seen = bounds_of(1000, Stage::kBuilt);
  seen.plan = {.passes_least = 2, .passes_most = 5, .built_per_pass = 100, .built_after = 1000};
  seen.searches = 1;
  seen.stage_total = 5;
  forecast.observe(0.0, seen);
  seen.done = 400;
  forecast.observe(0.4, seen);
  EXPECT_GT(*forecast.seconds_left(), 1.0);
  seen.empty_first = 400;
  forecast.observe(0.4, seen);
  EXPECT_NEAR(*forecast.seconds_left(), 0.5, 0.2);
}

// A search with a limit given way is of the best alone, which ties modules of few sets.
TEST(RunForecast, OfSearchesBeyondIsWithoutTheModulesOfAllSets) {
  const auto left_after_ties = [](double tied_s) {
    RunForecast forecast;
    ProgressSeen seen = bounds_of(1000);
    seen.plan.explains = true;
    seen.second_stages = 500;
    forecast.observe(0.0, seen);
    seen.done = 1000;
    forecast.observe(1.0, seen);
    seen.total = seen.done = 5000;
    forecast.observe(1.0 + tied_s, seen);
    seen.phase = Phase::kRefinement;
    seen.feasible = 1;
    seen.done = seen.total = 100;
    forecast.observe(1.0 + tied_s, seen);
    return *forecast.seconds_left();
  };
  EXPECT_NEAR(left_after_ties(4.0), left_after_ties(0.0), 0.1);
}

// Many sets may win, and none is found to rule the others out.
TEST(RunForecast, OfALongSearchInAFrontGoesByItsSets) {
  RunForecast forecast;
  ProgressSeen seen = at(Phase::kRefinement, Stage::kFrontGaps);
  seen.plan.front_objectives = 2;
  seen.plan.front_designs = 1;
  seen.searches = seen.stage_total = 1;
  seen.total = 400;
  constexpr double kSet_s = 0.05;
  for (std::size_t done = 0; done <= seen.total; ++done) {
    seen.done = done;
    forecast.observe(kSet_s * static_cast<double>(done), seen);
    const double left_s = kSet_s * static_cast<double>(seen.total - done);
    const auto told = forecast.range_left();
    if (done == 0 || done == seen.total) continue;
    ASSERT_TRUE(told);
    EXPECT_GE(told->most_s, 0.99 * left_s) << done;
    if (done < 32) continue;
    EXPECT_TRUE(told->is_one());
    EXPECT_NEAR(told->middle_s(), left_s, 0.01 * left_s) << done;
  }
}

}  // namespace
}  // namespace gear3k::optimize::run_forecast_test
