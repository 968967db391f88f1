#include "calibrate/model/row_responses.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <span>

#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

/// Fewer simulations than these are not worth threads: one takes 2 to 12 microseconds
/// (benchmarks/many_rows), and on a machine with other work threads wait milliseconds for each
/// other.
constexpr std::size_t kManySimulations = 512;
constexpr std::size_t kManyTemperatures = 64;
constexpr std::size_t kPoints = 17;

using CaseKey = std::array<std::uint64_t, 9>;
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
          bits(c.module_m),
          bits(c.rotation),
          bits(c.reference_sensor)};
}

/// Places of the Chebyshev-Lobatto points, from 1 down to −1.
const std::array<double, kPoints>& lobatto_points() {
  static const std::array<double, kPoints> points = [] {
    std::array<double, kPoints> x{};
    for (std::size_t j = 0; j < kPoints; ++j) {
      x[j] = std::cos(std::numbers::pi * static_cast<double>(j) / (kPoints - 1));
    }
    return x;
  }();
  return points;
}

/// Polynomial through every `stride`-th point, at x: the second barycentric formula, whose weights
/// at these points alternate in sign and are halved at both ends.
/// Source: Berrut and Trefethen, Barycentric Lagrange interpolation, SIAM Review 46(3), 2004.
Scalar interpolated(const std::array<Scalar, kPoints>& value, double x, std::size_t stride) {
  const std::array<double, kPoints>& points = lobatto_points();
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
bool is_resolved(const std::array<Scalar, kPoints>& value) {
  constexpr double kMost = 1e-6;
  Scalar greatest(0.0);
  for (std::size_t j = 0; j < kPoints; ++j) {
    greatest.a = std::max(greatest.a, std::abs(value[j].a));
    greatest.v = greatest.v.cwiseMax(value[j].v.cwiseAbs());
  }
  for (std::size_t j = 1; j < kPoints; j += 2) {
    const Scalar half = interpolated(value, lobatto_points()[j], 2);
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

namespace {

/// result(k) = response(condition(k)), in threads where they are many.
template <class ConditionOf, class ResultOf>
void simulate(std::size_t count, const ResponseAt& response, ConditionOf condition,
              ResultOf result) {
  numerics::parallel_for(
      count, [&](std::size_t k) { result(k) = response(condition(k)); }, count > kManySimulations);
}

}  // namespace

template <class PlaceOf, class ConditionOf>
void RowResponses::simulate_all(std::size_t count, const ResponseAt& response, PlaceOf place,
                                ConditionOf condition, MissingRow missing) {
  std::atomic<bool> ends = false;
  simulate(
      count,
      [&](const Condition& c) -> std::optional<Scalar> {
        if (ends) return std::nullopt;
        auto value = response(c);
        if (!value && missing == MissingRow::kEndsAll) ends = true;
        return value;
      },
      condition, [&](std::size_t k) -> auto& { return value_[place(k)]; });
}

RowResponses::RowResponses(const RowStates& states, const Simulation& simulation,
                           const Modification& gearbox, MissingRow missing)
    : RowResponses(states, simulation.reads_temperature(gearbox), simulation.responses(gearbox),
                   missing) {}

RowResponses::RowResponses(const RowStates& states, bool reads_temperature,
                           const ResponseAt& response, MissingRow missing)
    : states_(states), reads_temperature_(reads_temperature), of_case_(states.cases.size()) {
  if (!reads_temperature) {
    value_.resize(states.cases.size());
    simulate_all(
        value_.size(), response, [](std::size_t k) { return k; },
        [&](std::size_t k) -> const Condition& { return states.cases[k]; }, missing);
    return;
  }
  interpolate_temperatures(response);
  std::vector<std::size_t> left;
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    const bool between = of_case_[states.case_of_state[s]].has_value() &&
                         std::isfinite(states.states[s].temperature_K);
    if (!between) left.push_back(s);
  }
  if (left.empty()) return;
  value_.resize(states.states.size());
  simulate_all(
      left.size(), response, [&](std::size_t k) { return left[k]; },
      [&](std::size_t k) -> const Condition& { return states.states[left[k]]; }, missing);
}

void RowResponses::interpolate_temperatures(const ResponseAt& response) {
  const auto& along = states_.interpolations;
  std::vector<std::optional<Scalar>> at_point(kPoints * along.size());
  simulate(
      at_point.size(), response,
      [&](std::size_t k) {
        const RowStates::Interpolation& one = along[k / kPoints];
        Condition c = states_.cases[one.of_case];
        c.temperature_K = one.middle_K + one.half_range_K * lobatto_points()[k % kPoints];
        return c;
      },
      [&](std::size_t k) -> auto& { return at_point[k]; });
  for (std::size_t i = 0; i < along.size(); ++i) {
    const auto of_points = std::span(at_point).subspan(i * kPoints, kPoints);
    if (!std::ranges::all_of(of_points, [](const auto& y) { return y.has_value(); })) continue;
    Interpolant interpolant{
        .middle_K = along[i].middle_K, .half_range_K = along[i].half_range_K, .value = {}};
    std::ranges::transform(of_points, interpolant.value.begin(), [](const auto& y) { return *y; });
    if (is_resolved(interpolant.value)) of_case_[along[i].of_case] = interpolant;
  }
}

std::optional<Scalar> RowResponses::of_row(std::size_t row) const {
  const std::size_t state = states_.state_of_row[row];
  const std::size_t in_case = states_.case_of_state[state];
  if (!reads_temperature_) return value_[in_case];
  const double temperature_K = states_.states[state].temperature_K;
  const std::optional<Interpolant>& between = of_case_[in_case];
  if (!between || !std::isfinite(temperature_K)) return value_[state];
  return interpolated(between->value, (temperature_K - between->middle_K) / between->half_range_K,
                      1);
}

}  // namespace gear3k::calibrate
