#include "actuator/cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gear3k::actuator {

namespace {

/// Rows of a tridiagonal system, solved in place.
struct Tridiagonal {
  std::vector<double> lower, diagonal, upper;

  explicit Tridiagonal(std::size_t size) : lower(size), diagonal(size), upper(size) {}

  [[nodiscard]] std::vector<double> solve(std::vector<double> right) const {
    const std::size_t n = diagonal.size();
    std::vector<double> factor(n);
    double pivot = diagonal[0];
    right[0] /= pivot;
    for (std::size_t k = 1; k < n; ++k) {
      factor[k] = upper[k - 1] / pivot;
      pivot = diagonal[k] - lower[k] * factor[k];
      right[k] = (right[k] - lower[k] * right[k - 1]) / pivot;
    }
    for (std::size_t k = n - 1; k-- > 0;) right[k] -= factor[k + 1] * right[k + 1];
    return right;
  }
};

std::vector<double> differences(const std::vector<double>& values) {
  std::vector<double> result(values.size() - 1);
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = values[k + 1] - values[k];
  return result;
}

/// Slopes at the rows of a periodic spline: a cyclic tridiagonal system, by Sherman and Morrison.
std::vector<double> periodic_slopes(const std::vector<double>& h, const std::vector<double>& d) {
  const std::size_t n = h.size();  // unknown slopes: that of the last row is that of the first
  if (n == 1) return {0.0, 0.0};
  if (n == 2) {
    // Both neighbours of a row are the other one.
    const double s = 3.0 * (h[1] * d[0] + h[0] * d[1]) / (h[0] + h[1]);
    // 2 m0 + m1 = s = m0 + 2 m1
    return {s / 3.0, s / 3.0, s / 3.0};
  }
  Tridiagonal matrix(n);
  std::vector<double> right(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t before = k == 0 ? n - 1 : k - 1;
    matrix.lower[k] = h[k];
    matrix.diagonal[k] = 2.0 * (h[before] + h[k]);
    matrix.upper[k] = h[before];
    right[k] = 3.0 * (h[k] * d[before] + h[before] * d[k]);
  }
  const double corner_top = matrix.lower[0];
  const double corner_bottom = matrix.upper[n - 1];
  const double gamma = -matrix.diagonal[0];
  matrix.diagonal[0] -= gamma;
  matrix.diagonal[n - 1] -= corner_top * corner_bottom / gamma;
  std::vector<double> column(n, 0.0);
  column[0] = gamma;
  column[n - 1] = corner_bottom;
  std::vector<double> slopes = matrix.solve(right);
  const std::vector<double> z = matrix.solve(column);
  const double share = (slopes[0] + corner_top / gamma * slopes[n - 1]) /
                       (1.0 + z[0] + corner_top / gamma * z[n - 1]);
  for (std::size_t k = 0; k < n; ++k) slopes[k] -= share * z[k];
  slopes.push_back(slopes[0]);
  return slopes;
}

/// Slopes at the rows of a spline whose two end pieces are one cubic with their neighbours.
std::vector<double> open_slopes(const std::vector<double>& h, const std::vector<double>& d) {
  const std::size_t n = h.size() + 1;
  if (n == 2) return {d[0], d[0]};
  if (n == 3) {
    const double curvature = (d[1] - d[0]) / (h[0] + h[1]);
    return {d[0] - curvature * h[0], d[0] + curvature * h[0], d[1] + curvature * h[1]};
  }
  Tridiagonal matrix(n);
  std::vector<double> right(n);
  const auto end = [&](std::size_t row, double h0, double h1, double d0, double d1) {
    matrix.diagonal[row] = h1;
    (row == 0 ? matrix.upper : matrix.lower)[row] = h0 + h1;
    right[row] = ((h0 + 2.0 * (h0 + h1)) * h1 * d0 + h0 * h0 * d1) / (h0 + h1);
  };
  end(0, h[0], h[1], d[0], d[1]);
  end(n - 1, h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    matrix.lower[k] = h[k];
    matrix.diagonal[k] = 2.0 * (h[k - 1] + h[k]);
    matrix.upper[k] = h[k - 1];
    right[k] = 3.0 * (h[k] * d[k - 1] + h[k - 1] * d[k]);
  }
  return matrix.solve(std::move(right));
}

bool closes(const std::vector<double>& values) {
  const auto [least, greatest] = std::ranges::minmax(values);
  constexpr double kClosed = 1e-9;
  return std::abs(values.back() - values.front()) <=
         kClosed * std::max(std::abs(least), std::abs(greatest));
}

void require_rows(const Cycle& cycle) {
  const std::size_t rows = cycle.time_s.size();
  if (rows < 2 || cycle.load_Nm.size() != rows || cycle.motion.size() != rows) {
    throw std::invalid_argument(
        fmt::format("cycle: {} times, {} torques, {} of the motion, allowed: two or more of each",
                    rows, cycle.load_Nm.size(), cycle.motion.size()));
  }
  for (std::size_t k = 1; k < rows; ++k) {
    if (cycle.time_s[k] > cycle.time_s[k - 1]) continue;
    throw std::invalid_argument(fmt::format("cycle: time_s = {} after {}, allowed: increasing",
                                            cycle.time_s[k], cycle.time_s[k - 1]));
  }
}

}  // namespace

bool is_periodic(const Cycle& cycle) { return closes(cycle.load_Nm) && closes(cycle.motion); }

std::vector<CyclePiece> pieces_of(const Cycle& cycle) {
  require_rows(cycle);
  const std::vector<double> duration = differences(cycle.time_s);
  const std::vector<double> torque = differences(cycle.load_Nm);
  std::vector<double> step = differences(cycle.motion);
  std::vector<CyclePiece> pieces(duration.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    pieces[k].duration_s = duration[k];
    pieces[k].load_Nm = {cycle.load_Nm[k], torque[k], 0.0};
    pieces[k].speed_rad_s = {cycle.motion[k], step[k], 0.0};
  }
  if (!cycle.angles) return pieces;
  for (std::size_t k = 0; k < step.size(); ++k) step[k] /= duration[k];
  const std::vector<double> slope =
      is_periodic(cycle) ? periodic_slopes(duration, step) : open_slopes(duration, step);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    // The derivative of Hermite's cubic.
    const double sum = slope[k] + slope[k + 1];
    pieces[k].speed_rad_s = {slope[k], 6.0 * step[k] - 2.0 * (sum + slope[k]),
                             3.0 * sum - 6.0 * step[k]};
  }
  return pieces;
}

}  // namespace gear3k::actuator
