#include "calibrate/series/random_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "calibrate/measurement/noise.hpp"
#include "numerics/distributions.hpp"
#include "numerics/golden_section.hpp"

namespace gear3k::calibrate {

namespace {

/// Sums over the units at a variance between them.
struct AtVariance {
  double weights = 0.0, mean = 0.0, q = 0.0, log_sum = 0.0;
};
AtVariance at_variance(const std::vector<UnitEstimate>& units, double variance) {
  AtVariance at;
  for (const UnitEstimate& u : units) {
    const double w = 1.0 / (u.sd * u.sd + variance);
    at.weights += w;
    at.mean += w * u.value;
    at.log_sum -= std::log(w);
  }
  at.mean /= at.weights;
  for (const UnitEstimate& u : units) {
    const double d = u.value - at.mean;
    at.q += d * d / (u.sd * u.sd + variance);
  }
  return at;
}

/// A variance above which the units differ by less than it: Q there is below `q`.
double variance_beyond(const std::vector<UnitEstimate>& units, double q) {
  double variance = 0.0;
  for (const UnitEstimate& u : units) variance = std::max(variance, u.sd * u.sd);
  while (at_variance(units, variance).q > q) variance *= 4.0;
  return variance;
}

/// The variance at which Q, which falls with it, is q; 0 where Q(0) is below.
double variance_at(const std::vector<UnitEstimate>& units, double q) {
  if (at_variance(units, 0.0).q <= q) return 0.0;
  double low = 0.0;
  double high = variance_beyond(units, q);
  constexpr int kHalvings = 200;
  for (int k = 0; k < kHalvings && high - low > 1e-14 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (at_variance(units, middle).q > q ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The least of the restricted deviance: at 0, or between neighbours of the best of a fine ladder.
double restricted_variance(const std::vector<UnitEstimate>& units) {
  double least = units.front().sd * units.front().sd;
  for (const UnitEstimate& u : units) least = std::min(least, u.sd * u.sd);
  // Far beyond any τ² at which Q is what chance leaves, the likelihood only falls.
  const double most = variance_beyond(units, 0.02);
  constexpr double kStep = 1.25;
  double best = 0.0;
  double best_deviance = restricted_deviance(units, 0.0);
  for (double v = 1e-4 * least; v < most; v *= kStep) {
    const double deviance = restricted_deviance(units, v);
    if (deviance < best_deviance) {
      best_deviance = deviance;
      best = v;
    }
  }
  if (!(best > 0.0)) return 0.0;
  const auto [low, high] = numerics::golden_sections(
      best / kStep, best * kStep, [&](double v) { return restricted_deviance(units, v); },
      [](double a, double b) { return b - a <= 1e-9 * b; });
  return 0.5 * (low + high);
}

}  // namespace

double restricted_deviance(const std::vector<UnitEstimate>& units, double variance) {
  const AtVariance at = at_variance(units, variance);
  return at.log_sum + std::log(at.weights) + at.q;
}

RandomEffects random_effects(const std::vector<UnitEstimate>& units) {
  if (units.size() < 2) {
    throw std::invalid_argument(
        fmt::format("random_effects: {} units, allowed: at least 2", units.size()));
  }
  for (const UnitEstimate& u : units) {
    if (!std::isfinite(u.value) || !(u.sd > 0.0) || !std::isfinite(u.sd)) {
      throw std::invalid_argument(fmt::format(
          "random_effects: value = {}, sd = {}: allowed: numbers, sd above 0", u.value, u.sd));
    }
  }
  const auto degrees = static_cast<double>(units.size() - 1);
  RandomEffects r;
  const double variance = restricted_variance(units);
  r.deviation = std::sqrt(variance);
  const auto chi_square_point = [&](double upper_tail) {
    double low = 0.0;
    double high = 100.0 + 10.0 * degrees;
    while (high - low > 1e-12 * high) {
      const double middle = 0.5 * (low + high);
      (numerics::gamma_upper(0.5 * degrees, 0.5 * middle) > upper_tail ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  constexpr double kTail = 0.025;
  r.deviation_low = std::sqrt(variance_at(units, chi_square_point(kTail)));
  r.deviation_high = std::sqrt(variance_at(units, chi_square_point(1.0 - kTail)));
  r.p_between = numerics::gamma_upper(0.5 * degrees, 0.5 * at_variance(units, 0.0).q);
  const AtVariance at = at_variance(units, variance);
  r.mean = at.mean;
  r.mean_sd = std::sqrt(std::max(1.0, at.q / degrees) / at.weights);
  const double half = numerics::student_quantile(1.0 - kTail, degrees) * r.mean_sd;
  r.mean_low = r.mean - half;
  r.mean_high = r.mean + half;
  const double t = r.mean / r.mean_sd;
  r.p_mean = f_tail(t * t, 1, static_cast<int>(degrees));
  return r;
}

std::vector<double> holm_adjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return p[k]; });
  std::vector<double> adjusted(p.size());
  double last = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    last = std::max(last, std::min(1.0, static_cast<double>(p.size() - k) * p[order[k]]));
    adjusted[order[k]] = last;
  }
  return adjusted;
}

}  // namespace gear3k::calibrate
