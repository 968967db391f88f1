#include "calibrate/model/row_responses.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

/// Fewer simulations than these are not worth threads.
constexpr std::size_t kManySimulations = 200;
constexpr std::size_t kManyTemperatures = 64;
constexpr std::size_t kPoints = 17;

using CaseKey = std::array<std::uint64_t, 7>;
CaseKey case_key(const Condition& c) {
  const auto bits = [](auto value) {
    return std::bit_cast<std::uint64_t>(static_cast<double>(value));
  };
  return {bits(static_cast<int>(c.direction)),
          bits(c.sun_speed_rad_s),
          bits(c.output_torque_Nm),
          bits(c.test_torque_Nm),
          bits(c.driving_teeth),
          bits(c.driven_teeth),
          bits(c.module_m)};
}

/// Places of the Chebyshev-Lobatto points, from 1 down to −1.
std::array<double, kPoints> lobatto_points() {
  std::array<double, kPoints> points{};
  for (std::size_t j = 0; j < kPoints; ++j) {
    points[j] = std::cos(std::numbers::pi * static_cast<double>(j) / (kPoints - 1));
  }
  return points;
}

/// Polynomial through every `stride`-th point, at x: the second barycentric formula, whose weights
/// at these points alternate in sign and are halved at both ends.
/// Source: Berrut and Trefethen, Barycentric Lagrange interpolation, SIAM Review 46(3), 2004.
Scalar interpolated(const std::array<double, kPoints>& points, const Scalar* value, double x,
                    std::size_t stride) {
  Scalar sum(0.0);
  double weights = 0.0;
  double sign = 1.0;
  for (std::size_t j = 0; j < kPoints; j += stride, sign = -sign) {
    if (x == points[j]) return value[j];
    const double end = j == 0 || j == kPoints - 1 ? 0.5 : 1.0;
    const double weight = sign * end / (x - points[j]);
    weights += weight;
    sum.a += weight * value[j].a;
    sum.v += weight * value[j].v;
  }
  sum.a /= weights;
  sum.v /= weights;
  return sum;
}

/// Whether the points without every second one tell those between them.
bool is_resolved(const std::array<double, kPoints>& points, const Scalar* value) {
  constexpr double kMost = 1e-8;
  Scalar greatest(0.0);
  for (std::size_t j = 0; j < kPoints; ++j) {
    greatest.a = std::max(greatest.a, std::abs(value[j].a));
    greatest.v = greatest.v.cwiseMax(value[j].v.cwiseAbs());
  }
  for (std::size_t j = 1; j < kPoints; j += 2) {
    const Scalar half = interpolated(points, value, points[j], 2);
    if (!(std::abs(half.a - value[j].a) <= kMost * greatest.a)) return false;
    if (!((half.v - value[j].v).cwiseAbs().array() <= kMost * greatest.v.array()).all()) {
      return false;
    }
  }
  return true;
}

}  // namespace

RowStates::RowStates(const std::vector<Observation>& rows) {
  std::map<CaseKey, std::size_t> case_at;
  std::vector<std::map<std::uint64_t, std::size_t>> state_at;  // of each case, by temperature
  state_of_row.reserve(rows.size());
  for (const Observation& row : rows) {
    const Condition& c = row.condition;
    const auto [in_case, new_case] = case_at.emplace(case_key(c), cases.size());
    if (new_case) {
      cases.push_back(c);
      state_at.emplace_back();
    }
    const auto [state, new_state] = state_at[in_case->second].emplace(
        std::bit_cast<std::uint64_t>(c.temperature_K), states.size());
    if (new_state) {
      states.push_back(c);
      case_of_state.push_back(in_case->second);
    }
    state_of_row.push_back(state->second);
  }
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (state_at[k].size() <= kManyTemperatures) continue;
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (const auto& [bits, state] : state_at[k]) {
      low = std::min(low, states[state].temperature_K);
      high = std::max(high, states[state].temperature_K);
    }
    interpolations.push_back(
        {.of_case = k, .middle_K = 0.5 * (low + high), .half_range_K = 0.5 * (high - low)});
  }
}

RowResponses::RowResponses(const RowStates& states, bool reads_temperature,
                           const ResponseAt& response)
    : states_(states), reads_temperature_(reads_temperature) {
  const auto simulate = [&](std::size_t count, const auto& condition, const auto& result) {
    numerics::parallel_for(
        count, [&](std::size_t k) { result(k) = response(condition(k)); },
        count > kManySimulations);
  };
  if (!reads_temperature) {
    value_.resize(states.cases.size());
    simulate(
        value_.size(), [&](std::size_t k) -> const Condition& { return states.cases[k]; },
        [&](std::size_t k) -> auto& { return value_[k]; });
    return;
  }
  value_.resize(states.states.size());
  static const std::array<double, kPoints> points = lobatto_points();
  std::vector<std::optional<Scalar>> at_point(kPoints * states.interpolations.size());
  simulate(
      at_point.size(),
      [&](std::size_t k) {
        const RowStates::Interpolation& along = states.interpolations[k / kPoints];
        Condition c = states.cases[along.of_case];
        c.temperature_K = along.middle_K + along.half_range_K * points[k % kPoints];
        return c;
      },
      [&](std::size_t k) -> auto& { return at_point[k]; });
  // Of each case: its interpolation where there is a good one.
  std::vector<const RowStates::Interpolation*> interpolation(states.cases.size(), nullptr);
  std::vector<std::array<Scalar, kPoints>> known(states.cases.size());
  for (std::size_t i = 0; i < states.interpolations.size(); ++i) {
    const std::size_t k = states.interpolations[i].of_case;
    const auto* of_case = &at_point[i * kPoints];
    if (!std::all_of(of_case, of_case + kPoints, [](const auto& y) { return y.has_value(); })) {
      continue;
    }
    std::transform(of_case, of_case + kPoints, known[k].begin(), [](const auto& y) { return *y; });
    if (is_resolved(points, known[k].data())) interpolation[k] = &states.interpolations[i];
  }
  std::vector<std::size_t> left;
  for (std::size_t s = 0; s < value_.size(); ++s) {
    const std::size_t k = states.case_of_state[s];
    if (interpolation[k] == nullptr || !std::isfinite(states.states[s].temperature_K)) {
      left.push_back(s);
      continue;
    }
    const double x = (states.states[s].temperature_K - interpolation[k]->middle_K) /
                     interpolation[k]->half_range_K;
    value_[s] = interpolated(points, known[k].data(), x, 1);
  }
  simulate(
      left.size(), [&](std::size_t k) -> const Condition& { return states.states[left[k]]; },
      [&](std::size_t k) -> auto& { return value_[left[k]]; });
}

}  // namespace gear3k::calibrate
