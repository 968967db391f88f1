// Time that is left, against simulated work of known durations.

#include "optimize/work_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/rig/deterministic_random.hpp"

namespace gear3k::optimize::work_rate_test {
namespace {

/// Works through items of these durations, seen every 0.2 s, and holds what is said to be left
/// against what is, from a tenth of the time to the last twentieth.
void expect_within_twice(const std::string& what, const std::vector<double>& durations_s) {
  double whole = 0.0;
  for (const double duration : durations_s) whole += duration;
  WorkRate rate;
  rate.restart(5.0, 0);
  EXPECT_FALSE(rate.seconds_left(durations_s.size()));
  std::size_t done = 0;
  double finished = 0.0;
  int judged = 0;
  for (double now = 0.2; now < 0.95 * whole; now += 0.2) {
    while (done < durations_s.size() && finished + durations_s[done] <= now) {
      finished += durations_s[done++];
    }
    rate.observe(5.0 + now, done);
    if (now < 0.1 * whole) continue;
    const auto left = rate.seconds_left(durations_s.size());
    ASSERT_TRUE(left) << what << " at " << now;
    EXPECT_LT(*left, 2.0 * (whole - now)) << what << " at " << now << " of " << whole;
    EXPECT_GT(*left, 0.5 * (whole - now)) << what << " at " << now << " of " << whole;
    ++judged;
  }
  EXPECT_GT(judged, 50) << what;
}

std::vector<double> durations(std::size_t count, const std::function<double(double)>& of_share) {
  std::vector<double> list;
  for (std::size_t k = 0; k < count; ++k) {
    list.push_back(of_share(static_cast<double>(k) / static_cast<double>(count)));
  }
  return list;
}

TEST(WorkRate, TellsWhatIsLeftWithinAFactorOfTwoFromATenthOn) {
  expect_within_twice("even", durations(500, [](double) { return 0.1; }));
  expect_within_twice("growing", durations(500, [](double u) { return 0.05 * (1.0 + 2.0 * u); }));
  expect_within_twice("shrinking", durations(500, [](double u) { return 0.05 * (3.0 - 2.0 * u); }));
  rig::DeterministicRandom random(7);
  for (int n = 0; n < 20; ++n) {
    // A few items take twenty times as long as most, as sets that are refined do.
    expect_within_twice("scattered", durations(2000, [&](double) {
                          return random.uniform() < 0.03 ? 0.4 : 0.02 * (0.5 + random.uniform());
                        }));
  }
  // Waves: 64 items are done at once.
  expect_within_twice(
      "waves", durations(6400, [k = 0](double) mutable { return k++ % 64 == 63 ? 1.28 : 0.0; }));
  // A long run, of which the clock keeps fewer moments.
  expect_within_twice("long", durations(5000, [](double) { return 1.0; }));
}

TEST(WorkRate, ABeginningThatWasSlowIsForgotten) {
  // The first hundredth takes as long as a third of the rest: the mean over all would say 1.3 times
  // as long to the end of it, and 16 times after the first 2 %.
  std::vector<double> list = durations(1000, [](double u) { return u < 0.01 ? 3.0 : 0.1; });
  WorkRate rate;
  rate.restart(0.0, 0);
  double now = 0.0;
  std::size_t done = 0;
  for (const double duration : list) {
    now += duration;
    rate.observe(now, ++done);
    if (now > 70.0) break;
  }
  const double left = 0.1 * static_cast<double>(list.size() - done);
  EXPECT_NEAR(*rate.seconds_left(list.size()), left, 0.02 * left);
}

TEST(WorkRate, WorkThatBeginsAgainHasARateOfItsOwn) {
  WorkRate rate;
  EXPECT_FALSE(rate.per_second());
  rate.restart(0.0, 100);
  rate.observe(1.0, 100);
  EXPECT_FALSE(rate.per_second());
  rate.observe(2.0, 110);
  rate.observe(4.0, 130);
  EXPECT_DOUBLE_EQ(*rate.per_second(), 10.0);
  EXPECT_DOUBLE_EQ(*rate.seconds_left(230), 10.0);
  EXPECT_DOUBLE_EQ(*rate.seconds_left(120), 0.0);  // a total that shrank
  rate.restart(4.0, 0);
  rate.observe(5.0, 1);
  EXPECT_DOUBLE_EQ(*rate.seconds_left(11), 10.0);
}

}  // namespace
}  // namespace gear3k::optimize::work_rate_test
