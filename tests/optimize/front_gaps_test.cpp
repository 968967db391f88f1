#include "optimize/front_gaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "optimize/hypervolume.hpp"

namespace gear3k::optimize::front_gaps_test {
namespace {

using Point = std::vector<double>;

/// The least first cost of a list within limits, as a search has it.
std::optional<Point> best_within(const std::vector<Point>& designs, const Point& limits) {
  const Point* best = nullptr;
  for (const Point& design : designs) {
    bool within = true;
    for (std::size_t k = 0; k < limits.size(); ++k) within = within && design[k + 1] <= limits[k];
    if (within && (best == nullptr || design[0] < (*best)[0])) best = &design;
  }
  return best == nullptr ? std::nullopt : std::optional(*best);
}

bool dominated(const Point& a, const std::vector<Point>& designs) {
  return std::ranges::any_of(designs, [&](const Point& b) {
    return b != a && std::ranges::equal(b, a, std::ranges::less_equal{});
  });
}

class FrontGapsOf : public testing::TestWithParam<std::size_t> {};

TEST_P(FrontGapsOf, FindEveryDesignThatNoOtherOneBeats) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> cost(0.0, 1.0);
  for (int trial = 0; trial < 10; ++trial) {
    // One design is best in each objective, as the ends of a front are.
    std::vector<Point> designs;
    for (std::size_t k = 0; k < GetParam(); ++k) {
      Point end(GetParam());
      for (double& c : end) c = cost(random);
      end[k] = 0.0;
      designs.push_back(end);
    }
    for (int n = 0; n < 40; ++n) {
      Point design(GetParam());
      for (double& c : design) c = 0.05 + 0.9 * cost(random);
      designs.push_back(design);
    }
    const double whole = hypervolume(designs);
    FrontGaps gaps(GetParam());
    std::vector<Point> found;
    double missing = gaps.missing();
    EXPECT_EQ(missing, 1.0);
    int searches = 0;
    // Steps of a surface take cells without end; those of a curve do not.
    const double enough = GetParam() == 2 ? 1e-9 : 0.02;
    while (const auto limits = gaps.next(enough)) {
      ASSERT_LT(++searches, 20000);
      const std::optional<Point> best = best_within(designs, *limits);
      gaps.found(best);
      if (best) found.push_back(*best);
      EXPECT_LE(gaps.missing(), missing + 1e-12);
      missing = gaps.missing();
      // What is missing is never more than is said.
      EXPECT_LE(whole - hypervolume(found), missing + 1e-9);
    }
    EXPECT_NEAR(hypervolume(found), whole, std::max(enough, 1e-3));
    if (GetParam() > 2) continue;
    for (const Point& design : designs) {
      if (dominated(design, designs) || design[0] == 0.0) continue;
      EXPECT_NE(std::ranges::find(found, design), found.end()) << design[0] << " " << design[1];
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Objectives, FrontGapsOf, testing::Values(2U, 3U));

TEST(FrontGaps, SearchWhereAFrontBends) {
  // c1 = (1 - c2)^8: flat over most of c2, steep near 0.
  FrontGaps gaps(2);
  gaps.add(Point{0.0, 1.0});
  gaps.add(Point{1.0, 0.0});
  std::vector<double> at{0.0, 1.0};
  std::vector<Point> found{{0.0, 1.0}, {1.0, 0.0}};
  for (int k = 0; k < 14; ++k) {
    const auto limits = gaps.next(0.0);
    ASSERT_TRUE(limits);
    const double c2 = limits->front();
    found.push_back({std::pow(1.0 - c2, 8.0), c2});
    at.push_back(c2);
    gaps.found(found.back());
  }
  // Of as many even steps the largest change of c1 from design to design is 0.42.
  std::ranges::sort(at);
  double largest = 0.0;
  for (std::size_t k = 1; k < at.size(); ++k) {
    largest = std::max(largest, std::pow(1.0 - at[k - 1], 8.0) - std::pow(1.0 - at[k], 8.0));
  }
  EXPECT_LT(largest, 0.25);
  // 1 - 1/9 lies above the curve.
  EXPECT_GT(hypervolume(found), 8.0 / 9.0 - gaps.missing());
  EXPECT_LT(gaps.missing(), 0.03);
}

TEST(FrontGaps, LeaveWhatWiderLimitsHaveAnswered) {
  FrontGaps gaps(2);
  auto limits = gaps.next(0.0);
  ASSERT_TRUE(limits);
  EXPECT_EQ(limits->front(), 0.5);
  gaps.found(std::nullopt);  // nothing at or below a half: nothing below a quarter
  limits = gaps.next(0.0);
  ASSERT_TRUE(limits);
  EXPECT_EQ(limits->front(), 0.75);
  EXPECT_DOUBLE_EQ(gaps.missing(), 0.5);
  gaps.found(Point{0.2, 0.6});  // nor anything below 0.2 up to 0.75
  EXPECT_DOUBLE_EQ(gaps.missing(), 0.1 * 0.8 + 0.25 * 0.2);
}

}  // namespace
}  // namespace gear3k::optimize::front_gaps_test
