#include "calibrate/model/levelled_responses.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gear3k::calibrate {

namespace {

constexpr std::size_t kSimulatedLevels = 3;

double log_of(double level) {
  // Friction at or below 0 is no level: what asks for it is met at the least one.
  constexpr double kLeast = 0.01;
  return std::log(std::max(level, kLeast));
}

/// Least, middle and greatest in logarithms; about 1 the middle is 1 exactly, so that nothing
/// changes what stands there.
std::vector<double> points_of(const LevelRange& levels) {
  if (!levels.varies()) return {1.0};
  const double middle = 0.5 * (levels.log_low + levels.log_high);
  return {std::exp(levels.log_low), std::exp(middle), std::exp(levels.log_high)};
}

/// Lagrange's polynomials ℓ_j of some points at x, and Hermite's with their slopes: h_j is 1 at its
/// point with slope 0 at all, k_j has slope 1 at its point and is 0 at all.
struct Polynomials {
  std::array<double, kSimulatedLevels> lagrange{}, h{}, h_slope{}, k{}, k_slope{};

  Polynomials(const std::vector<double>& points, double x) {
    for (std::size_t j = 0; j < kSimulatedLevels; ++j) {
      double value = 1.0;
      double slope = 0.0;
      double own_slope = 0.0;  // ℓ'_j(x_j)
      for (std::size_t i = 0; i < kSimulatedLevels; ++i) {
        if (i == j) continue;
        const double span = points[j] - points[i];
        slope = (slope * (x - points[i]) + value) / span;
        value *= (x - points[i]) / span;
        own_slope += 1.0 / span;
      }
      const double square = value * value;
      const double square_slope = 2.0 * value * slope;
      const double from = x - points[j];
      const double tilt = 1.0 - 2.0 * own_slope * from;
      lagrange[j] = value;
      h[j] = tilt * square;
      h_slope[j] = tilt * square_slope - 2.0 * own_slope * square;
      k[j] = from * square;
      k_slope[j] = from * square_slope + square;
    }
  }
};

}  // namespace

void LevelRange::include(double level) {
  constexpr double kRoom = 0.005;
  const double at = log_of(level);
  log_low = std::min(log_low, at - kRoom);
  log_high = std::max(log_high, at + kRoom);
}

bool LevelRange::holds(double level) const {
  const double at = log_of(level);
  return !varies() || (at >= log_low && at <= log_high);
}

LevelledResponses::LevelledResponses(const RowStates& states, const Simulation& simulation,
                                     const Modification& gearbox, const LevelRange& levels,
                                     MissingRow missing)
    : level_(points_of(levels)) {
  at_.reserve(level_.size());
  for (const double level : level_) {
    Modification m = gearbox;
    // Slopes are of use where there is something to interpolate.
    const Scalar own = levels.varies() ? Scalar(level, kSlotsBesideLevel) : Scalar(level);
    m.gearbox.friction.level = m.gearbox.friction.level * own;
    at_.emplace_back(states, simulation, m, missing);
  }
}

Scalar LevelledResponse::at(const Scalar& level, bool with_gearbox) const {
  Scalar result(value, by_level * level.v);
  if (with_gearbox) result.v += by_gearbox;
  return result;
}

std::optional<LevelledResponse> LevelledResponses::of_row(std::size_t row, double level) const {
  if (at_.size() == 1) {
    const std::optional<Scalar> y = at_.front().of_row(row);
    if (!y) return std::nullopt;
    return LevelledResponse{.value = y->a, .by_gearbox = y->v};
  }
  const double x = std::clamp(level, level_.front(), level_.back());
  const Polynomials at(level_, x);
  LevelledResponse result{.by_gearbox = decltype(result.by_gearbox)::Zero()};
  for (std::size_t j = 0; j < at_.size(); ++j) {
    const std::optional<Scalar> y = at_[j].of_row(row);
    if (!y) return std::nullopt;
    const double slope = y->v[kSlotsBesideLevel];
    result.value += at.h[j] * y->a + at.k[j] * slope;
    result.by_gearbox += at.lagrange[j] * y->v;
    result.by_level += at.h_slope[j] * y->a + at.k_slope[j] * slope;
  }
  result.by_gearbox[kSlotsBesideLevel] = 0.0;
  if (x != level) result.by_level = 0.0;
  return result;
}

}  // namespace gear3k::calibrate
