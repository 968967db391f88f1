#include "calibrate/model/levelled_responses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gear3k::calibrate {

namespace {

constexpr std::size_t kMostPoints = 9;

double log_of(double level) {
  // Friction at or below 0 is no level: what asks for it is met at the least one.
  constexpr double kLeast = 0.01;
  return std::log(std::max(level, kLeast));
}

std::vector<double> points_of(const LevelRange& levels) {
  if (!levels.varies()) return {0.0};
  const double middle = 0.5 * (levels.log_low + levels.log_high);
  const double half = 0.5 * (levels.log_high - levels.log_low);
  constexpr double kNarrow = 0.04, kWide = 0.2;
  const std::size_t count = half < kNarrow ? 5 : half < kWide ? 7 : kMostPoints;
  std::vector<double> points(count);
  for (std::size_t j = 0; j < count; ++j) {
    const double turn = static_cast<double>(j) / static_cast<double>(count - 1);
    points[j] = middle - half * std::cos(std::numbers::pi * turn);
  }
  // Exactly, so that about 1 nothing changes what stands at 1.
  points[count / 2] = middle;
  return points;
}

/// Lagrange's polynomials of some points, and their slopes, at x.
struct Lagrange {
  std::array<double, kMostPoints> value{}, slope{};

  Lagrange(const std::vector<double>& points, double x) {
    const std::size_t n = points.size();
    for (std::size_t j = 0; j < n; ++j) {
      double v = 1.0;
      double s = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        if (k == j) continue;
        const double span = points[j] - points[k];
        s = (s * (x - points[k]) + v) / span;
        v *= (x - points[k]) / span;
      }
      value[j] = v;
      slope[j] = s;
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
                                     const Modification& gearbox, const LevelRange& levels)
    : log_level_(points_of(levels)) {
  at_.reserve(log_level_.size());
  for (const double log_level : log_level_) {
    Modification m = gearbox;
    m.gearbox.friction.level = m.gearbox.friction.level * std::exp(log_level);
    at_.emplace_back(states, simulation, m);
  }
}

std::optional<Scalar> LevelledResponses::of_row(std::size_t row, const Scalar& level) const {
  if (at_.size() == 1) return at_.front().of_row(row);
  const double x =
      std::clamp(std::log(std::max(level.a, 1e-300)), log_level_.front(), log_level_.back());
  const Lagrange basis(log_level_, x);
  Scalar result(0.0);
  double slope = 0.0;
  for (std::size_t j = 0; j < at_.size(); ++j) {
    const std::optional<Scalar> y = at_[j].of_row(row);
    if (!y) return std::nullopt;
    result.a += basis.value[j] * y->a;
    result.v += basis.value[j] * y->v;
    slope += basis.slope[j] * y->a;
  }
  result.v += slope / std::exp(x) * level.v;
  return result;
}

std::optional<Scalar> LevelledResponses::by_level(std::size_t row, const Scalar& level) const {
  if (at_.size() == 1) {
    const std::optional<Scalar> y = at_.front().of_row(row);
    return y ? std::optional(Scalar(y->a)) : std::nullopt;
  }
  Scalar plain(level.a);
  const std::optional<Scalar> y = of_row(row, level);
  const std::optional<Scalar> inner = y ? of_row(row, plain) : std::nullopt;
  if (!inner) return std::nullopt;
  Scalar result(y->a);
  result.v = y->v - inner->v;
  return result;
}

}  // namespace gear3k::calibrate
