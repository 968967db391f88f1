#include "backlash/turn_yield.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <stdexcept>

#include "backlash/random_teeth.hpp"
#include "tests/backlash/toleranced_train.hpp"

namespace gear3k::backlash::turn_yield_test {
namespace {

TEST(TurnYield, CountsGearboxesThatKeepTheLimitAtEveryAngle) {
  const auto p = thinned_bilateral_drive_gear(0.02);
  const ClearanceModel model = *clearance_model(p, all_tolerances());
  const RandomGearbox random(model, {}, 5);
  const TurnWindow window = turn_window(p.teeth);
  constexpr std::uint64_t kGearboxes = 40;
  // Each gearbox's greatest lost motion; the limit splits them.
  std::vector<double> greatest;
  std::uint64_t jammed = 0;
  for (std::uint64_t i = 0; i < kGearboxes; ++i) {
    const Turn one = turn(model.levers,
                          TurningPlays(model, p.teeth, random.deviations(i),
                                       random_teeth(model, p.teeth, {.seed = 5, .gearbox = i})),
                          window);
    if (one.jams()) {
      ++jammed;
      continue;
    }
    double most = 0.0;
    for (const TurnPoint& point : one.points) most = std::max(most, point.lost_motion_rad());
    greatest.push_back(most);
  }
  ASSERT_GT(greatest.size(), 10U);
  std::ranges::sort(greatest);
  const std::size_t kept = greatest.size() / 2;
  const double limit_rad = 0.5 * (greatest[kept - 1] + greatest[kept]);
  const TurnYield counted =
      turn_yield(model, p.teeth, {.gearboxes = kGearboxes, .seed = 5, .limit_rad = limit_rad});
  EXPECT_EQ(counted.assembled.count, kGearboxes - jammed);
  EXPECT_EQ(counted.yield.count, kept);
}

TEST(TurnYield, DoesNotDependOnTheNumberOfThreads) {
  const auto p = thinned_bilateral_drive_gear(0.01);
  const ClearanceModel model = *clearance_model(p, all_tolerances());
  const int threads = omp_get_max_threads();
  const auto counted = [&](int n) {
    omp_set_num_threads(n);
    const TurnYield yield = turn_yield(model, p.teeth, {.gearboxes = 30, .limit_rad = 4e-3});
    return std::pair{yield.assembled.count, yield.yield.count};
  };
  const auto one = counted(1);
  const auto four = counted(4);
  omp_set_num_threads(threads);
  EXPECT_EQ(one, four);
}

TEST(TurnYield, IsNoMoreThanThatOfOnePosition) {
  const auto p = thinned_bilateral_drive_gear(0.01);
  const ClearanceModel model = *clearance_model(p, all_tolerances());
  const auto series = monte_carlo(model, {.samples = 10'000});
  const TurnYield yield = turn_yield(model, p.teeth, {.gearboxes = 200});
  EXPECT_LE(yield.assembled.lower, series.assembled.upper);
  EXPECT_EQ(yield.yield.count, yield.assembled.count) << "without a limit";
}

TEST(TurnYield, RefusesAnEmptySeries) {
  const auto p = thinned_bilateral_drive_gear(0.01);
  const ClearanceModel model = *clearance_model(p, all_tolerances());
  EXPECT_THROW(static_cast<void>(turn_yield(model, p.teeth, {.gearboxes = 0})),
               std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash::turn_yield_test
