#include "calibrate/model/row_responses.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

namespace gear3k::calibrate::row_responses_test {
namespace {

constexpr double kCold_K = 290.0;
constexpr double kWarm_K = 320.0;

/// Two loads in turn, each at another temperature in every row.
std::vector<Observation> rows_of(int count) {
  std::vector<Observation> rows(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    Condition& c = rows[static_cast<std::size_t>(k)].condition;
    c.output_torque_Nm = k % 2 == 0 ? 10.0 : 20.0;
    c.temperature_K = kCold_K + (kWarm_K - kCold_K) * k / (count - 1);
    c.output_angle_rad = 0.1 * k;
  }
  return rows;
}

/// As a viscosity falls: by e over 15 K; its derivative by the exponent.
std::optional<Scalar> falling(const Condition& c) {
  const Scalar exponent(-1.0 / 15.0, 0);
  return c.output_torque_Nm * exp(exponent * (c.temperature_K - kCold_K));
}

TEST(RowResponses, SimulatesACaseOnceWhereTheTemperatureDoesNotCount) {
  const auto rows = rows_of(500);
  const RowStates states(rows);
  std::atomic<int> calls = 0;
  const RowResponses responses(states, false, [&](const Condition& c) -> std::optional<Scalar> {
    ++calls;
    if (c.output_torque_Nm > 15.0) return std::nullopt;
    return Scalar(c.output_torque_Nm);
  });
  EXPECT_EQ(calls, 2);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(responses.of_row(k).has_value(), k % 2 == 0);
    if (k % 2 == 0) {
      EXPECT_EQ(responses.of_row(k)->a, 10.0);
    }
  }
}

TEST(RowResponses, SimulatesEveryTemperatureOfAFew) {
  auto rows = rows_of(100);
  rows.insert(rows.end(), rows.begin(), rows.end());
  const RowStates states(rows);
  std::atomic<int> calls = 0;
  const RowResponses responses(states, true, [&](const Condition& c) {
    ++calls;
    return falling(c);
  });
  EXPECT_EQ(calls, 100);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(responses.of_row(k)->a, falling(rows[k].condition)->a);
  }
}

TEST(RowResponses, InterpolatesBetweenManyTemperatures) {
  const auto rows = rows_of(1000);
  const RowStates states(rows);
  std::atomic<int> calls = 0;
  const RowResponses responses(states, true, [&](const Condition& c) {
    ++calls;
    return falling(c);
  });
  EXPECT_EQ(calls, 2 * 17);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Scalar exact = *falling(rows[k].condition);
    EXPECT_NEAR(responses.of_row(k)->a, exact.a, 1e-13 * 20.0);
    EXPECT_NEAR(responses.of_row(k)->v[0], exact.v[0], 1e-13 * 20.0 * (kWarm_K - kCold_K));
  }
}

TEST(RowResponses, SimulatesEveryTemperatureWhereNoPolynomialFollows) {
  const auto rows = rows_of(1000);
  const RowStates states(rows);
  // A kink for one load; for the other the gearbox locks when it is cold.
  const auto kinked = [](const Condition& c) -> std::optional<Scalar> {
    if (c.output_torque_Nm < 15.0) return Scalar(std::abs(c.temperature_K - 311.0));
    if (c.temperature_K < 300.0) return std::nullopt;
    return falling(c);
  };
  const RowResponses responses(states, true, kinked);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto exact = kinked(rows[k].condition);
    ASSERT_EQ(responses.of_row(k).has_value(), exact.has_value());
    if (exact) {
      EXPECT_EQ(responses.of_row(k)->a, exact->a);
    }
  }
}

TEST(RowResponses, TakesARowWithoutTemperatureForItself) {
  auto rows = rows_of(1000);
  rows[500].condition.temperature_K = kUnknown;
  const RowStates states(rows);
  const RowResponses responses(states, true, [&](const Condition& c) {
    return std::isnan(c.temperature_K) ? std::optional(Scalar(-1.0)) : falling(c);
  });
  EXPECT_EQ(responses.of_row(500)->a, -1.0);
  EXPECT_GT(responses.of_row(502)->a, 0.0);
}

}  // namespace
}  // namespace gear3k::calibrate::row_responses_test
