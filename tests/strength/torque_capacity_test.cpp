#include "strength/torque_capacity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/random_train.hpp"

namespace gear3k::strength::torque_capacity_test {
namespace {

/// Safeties whose load factor 1 + a/(1 + T/T0) falls with the load, as factors with deviations of a
/// fixed size do, or rises: 1 + a T/(T + T0).
struct Member {
  double strength = 1.0;  ///< torque at which the ratio would be 1 without the factor
  int exponent = 1;
  double share = 0.0, scale = 1.0;
  bool rising = false;
};
template <class T>
SafetyRatio<T> ratio_of(const Member& m, const T& strength, const T& torque) {
  using std::sqrt;
  const T factor = m.rising ? T(1.0 + m.share * torque / (torque + m.scale))
                            : T(1.0 + m.share / (1.0 + torque / m.scale));
  const T ratio = strength / (torque * factor);
  return {.ratio = m.exponent == 2 ? T(sqrt(ratio)) : ratio, .exponent = m.exponent};
}

std::vector<Member> random_members(RandomTrain& random) {
  std::vector<Member> members(static_cast<std::size_t>(random.count(1, 6)));
  for (Member& m : members) {
    m = {.strength = std::exp(random.between(-3.0, 8.0)),
         .exponent = random.count(1, 2),
         .share = random.between(0.0, 3.0),
         .scale = std::exp(random.between(-3.0, 8.0)),
         .rising = random.count(0, 1) == 1};
  }
  return members;
}

std::vector<SafetyRatio<double>> ratios(const std::vector<Member>& members, double torque) {
  std::vector<SafetyRatio<double>> items;
  items.reserve(members.size());
  for (const Member& m : members) items.push_back(ratio_of<double>(m, m.strength, torque));
  return items;
}

double least_ratio(const std::vector<Member>& members, double torque) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& item : ratios(members, torque)) least = std::min(least, item.ratio);
  return least;
}

TEST(TorqueCapacity, LeastRatioIs1AndBelow1FromThereOn) {
  RandomTrain random(91);
  for (int n = 0; n < 1000; ++n) {
    const auto members = random_members(random);
    const auto capacity = torque_capacity([&](double t) { return ratios(members, t); },
                                          {.start_Nm = std::exp(random.between(-9.0, 12.0))});
    ASSERT_TRUE(capacity) << n;
    EXPECT_NEAR(least_ratio(members, capacity->torque_Nm), 1.0, 1e-9) << n;
    EXPECT_NEAR(ratios(members, capacity->torque_Nm)[capacity->governing].ratio, 1.0, 1e-9) << n;
    for (const double more : {1e-6, 1e-3, 0.1, 1.0, 100.0}) {
      EXPECT_LT(least_ratio(members, capacity->torque_Nm * (1.0 + more)), 1.0) << n;
    }
  }
}

TEST(TorqueCapacity, TakesTheLargestOfSeveralTorques) {
  // Up and down about 1 until ln T = 2, less than in proportion to the torque.
  const auto logarithm = [](double x) {
    return -0.15 * std::sin(3.0 * x) - 0.5 * std::max(0.0, x - 2.0);
  };
  const auto items = [&](double t) {
    return std::vector<SafetyRatio<double>>{{.ratio = std::exp(logarithm(std::log(t)))}};
  };
  double largest = 0.0;
  for (double x = 8.0; x > -2.0 && largest == 0.0; x -= 1e-5) {
    if (logarithm(x) >= 0.0) largest = std::exp(x);
  }
  ASSERT_GT(largest, 1.0);
  for (const double start : {0.01, 0.9, 2.5, 100.0}) {
    const auto capacity = torque_capacity(items, {.start_Nm = start});
    ASSERT_TRUE(capacity);
    EXPECT_NEAR(capacity->torque_Nm, largest, 2e-5 * largest) << start;
  }
}

TEST(TorqueCapacity, ScannedIsTheLeastOfSeveralTorques) {
  RandomTrain random(93);
  int dips = 0;
  for (int n = 0; n < 300; ++n) {
    // Falls through 1 at ln T = 3, and before that dips below it over a third of an octave and
    // more.
    const double middle = random.between(1.3, 2.6), depth = random.between(0.0, 1.0);
    const double width = random.between(0.3, 0.6);
    const auto logarithm = [&](double x) {
      const double off = (x - middle) / width;
      return 0.4 * (3.0 - x) - depth * std::exp(-off * off);
    };
    const auto items = [&](double t) {
      return std::vector<SafetyRatio<double>>{{.ratio = std::exp(logarithm(std::log(t)))}};
    };
    // Where it first comes down to 1, and how wide it stays below there.
    double first = 0.0, width_below = 0.0;
    for (double x = 0.0; x < 3.5; x += 1e-4) {
      if (first == 0.0 && logarithm(x) < 0.0) first = x;
      if (first != 0.0 && logarithm(x) < 0.0) width_below += 1e-4;
      if (first != 0.0 && logarithm(x) >= 0.0) break;
    }
    if (width_below < 0.26 * std::log(2.0)) continue;
    const auto capacity = torque_capacity(
        items, {.start_Nm = std::exp(random.between(-2.0, 5.0)), .scanned_octaves = 3});
    ASSERT_TRUE(capacity) << n;
    EXPECT_NEAR(std::log(capacity->torque_Nm), first, 2e-4) << n;
    dips += first < 2.9 ? 1 : 0;
  }
  EXPECT_GT(dips, 30);
}

TEST(TorqueCapacity, ComesBackFromTorquesThatLeaveNoSafetyAtAll) {
  const auto items = [](double t) {
    return std::vector<SafetyRatio<double>>{{.ratio = std::exp(5.0 - t)}};
  };
  for (const double start : {1e-3, 1.0, 1e6}) {
    const auto capacity = torque_capacity(items, {.start_Nm = start});
    ASSERT_TRUE(capacity);
    EXPECT_NEAR(capacity->torque_Nm, 5.0, 1e-9) << start;
  }
}

TEST(TorqueCapacity, FewEvaluationsWhenFactorsHardlyDependOnTheLoad) {
  int calls = 0;
  const Member m{.strength = 27.0, .exponent = 2, .share = 0.1, .scale = 10.0};
  const auto capacity = torque_capacity(
      [&](double t) {
        ++calls;
        return ratios({m}, t);
      },
      {.start_Nm = 20.0});
  ASSERT_TRUE(capacity);
  EXPECT_LE(calls, 30);
}

TEST(TorqueCapacity, HasNoneWhereTheRatiosDoNotCross1) {
  const auto always = [](double ratio) {
    return [ratio](double) {
      return std::vector<SafetyRatio<double>>{{.ratio = ratio, .exponent = 1}};
    };
  };
  EXPECT_FALSE(torque_capacity(always(2.0)));
  EXPECT_FALSE(torque_capacity(always(0.5)));
  EXPECT_FALSE(torque_capacity(always(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_THROW(torque_capacity(always(1.0), {.start_Nm = 0.0}), std::invalid_argument);
  EXPECT_THROW(torque_capacity([](double) { return std::vector<SafetyRatio<double>>{}; }),
               std::invalid_argument);
  EXPECT_THROW(torque_capacity([](double) {
                 return std::vector<SafetyRatio<double>>{{.ratio = 1.0, .exponent = 0}};
               }),
               std::invalid_argument);
}

TEST(TorqueCapacity, AStrengthThatIsUsedUpIsTooMuchTorque) {
  // A plastic that the torque heats: (30 − T)/T, nothing left from 30 on.
  const auto heated = [](double torque) {
    return std::vector<SafetyRatio<double>>{{.ratio = (30.0 - torque) / torque, .exponent = 1}};
  };
  for (double start = 1e-3; start < 1e4; start *= 1.7) {
    const auto capacity = torque_capacity(heated, {.start_Nm = start});
    ASSERT_TRUE(capacity) << start;
    EXPECT_NEAR(capacity->torque_Nm, 15.0, 1e-10) << start;
  }
}

TEST(TorqueCapacity, GradientIsThatOfDifferences) {
  RandomTrain random(92);
  for (int n = 0; n < 300; ++n) {
    const auto members = random_members(random);
    const auto scaled = [&](std::size_t item, double scale) {
      std::vector<Member> moved = members;
      moved[item].strength *= scale;
      return torque_capacity([&](double t) { return ratios(moved, t); })->torque_Nm;
    };
    const auto capacity = torque_capacity([&](double t) { return ratios(members, t); });
    ASSERT_TRUE(capacity);
    const auto exact = capacity_with_derivatives(
        [&](const Jet1& t) {
          std::vector<SafetyRatio<Jet1>> items;
          items.reserve(members.size());
          for (std::size_t i = 0; i < members.size(); ++i) {
            items.push_back(
                ratio_of<Jet1>(members[i], Jet1(members[i].strength, static_cast<int>(i)), t));
          }
          return items;
        },
        *capacity);
    EXPECT_EQ(exact.torque_Nm.a, capacity->torque_Nm);
    EXPECT_EQ(exact.governing, capacity->governing);
    // Away from ties.
    double second = std::numeric_limits<double>::infinity();
    const auto at = ratios(members, capacity->torque_Nm);
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (i != capacity->governing) second = std::min(second, at[i].ratio);
    }
    if (second < 1.001) continue;
    const double h = 1e-4;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const double slope = (scaled(i, 1.0 + h) - scaled(i, 1.0 - h)) / (2.0 * h);
      EXPECT_NEAR(exact.torque_Nm.v[static_cast<int>(i)] * members[i].strength, slope,
                  1e-6 * capacity->torque_Nm)
          << n << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace gear3k::strength::torque_capacity_test
