#include "calibrate/measurement/loop_friction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "numerics/distributions.hpp"
#include "numerics/golden_section.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

/// Variance of a travel of which none is known is that at zero torque; less than a nanoradian is
/// read nowhere.
constexpr double kLeastVariance_rad2 = 1e-18;
/// Of the smallest torque that is read.
constexpr double kFrictionReach = 0.9;

/// Readings of a loop, or of the mean of several: θ(0), then the travels; torques in units of the
/// greatest, as all below.
struct LoopPoints {
  std::vector<double> torque, angle_rad, variance_rad2;
};

LoopPoints loop_points(const LoopReading& loop) {
  const double zero = std::max(loop.zero_variance_rad2, kLeastVariance_rad2);
  LoopPoints points{.torque = {0.0}, .angle_rad = {loop.zero_rad}, .variance_rad2 = {zero}};
  for (const TravelReading& travel : loop.travel) {
    const double variance = travel.variance_rad2;
    points.torque.push_back(travel.torque_Nm / loop.travel.back().torque_Nm);
    points.angle_rad.push_back(travel.angle_rad);
    points.variance_rad2.push_back(variance > 0.0 ? std::max(variance, kLeastVariance_rad2) : zero);
  }
  return points;
}

/// By what each reading counts in θ(0) less the least-squares line of the travels at zero torque.
std::vector<double> opening_weights(const std::vector<double>& torque) {
  const auto count = static_cast<double>(torque.size() - 1);
  const double mean = std::accumulate(torque.begin() + 1, torque.end(), 0.0) / count;
  double squares = 0.0;
  for (std::size_t k = 1; k < torque.size(); ++k) squares += numerics::square(torque[k] - mean);
  std::vector<double> weight{1.0};
  for (std::size_t k = 1; k < torque.size(); ++k) {
    weight.push_back(mean * (torque[k] - mean) / squares - 1.0 / count);
  }
  return weight;
}

struct LineOpening {
  double value_rad = 0.0, variance_rad2 = 0.0;
};

LineOpening line_opening(const LoopPoints& points) {
  const std::vector<double> weight = opening_weights(points.torque);
  LineOpening opening;
  for (std::size_t k = 0; k < weight.size(); ++k) {
    opening.value_rad += weight[k] * points.angle_rad[k];
    opening.variance_rad2 += numerics::square(weight[k]) * points.variance_rad2[k];
  }
  return opening;
}

/// The flanks behind a friction.
struct FlankFit {
  double friction = 0.0, hardening = 0.0;
  double offset_rad = 0.0, wind_up_rad = 0.0;  ///< b and C
  double chi_square = HUGE_VAL;

  [[nodiscard]] double wind_up(double torque) const {
    return wind_up_rad * std::pow(torque, 1.0 - hardening);
  }
};

/// θ(0) and travels of a unit C without a dead band.
std::vector<double> unit_readings(const std::vector<double>& torque, double friction,
                                  double hardening) {
  std::vector<double> unit{std::pow(friction, 1.0 - hardening)};
  for (std::size_t k = 1; k < torque.size(); ++k) {
    unit.push_back(std::pow(torque[k] - friction, 1.0 - hardening));
  }
  return unit;
}

/// b and C ≥ 0 by weighted least squares.
FlankFit fit_flanks(const LoopPoints& points, double friction, double hardening) {
  const std::vector<double> unit = unit_readings(points.torque, friction, hardening);
  double weights = 0.0, x = 0.0, y = 0.0;
  for (std::size_t k = 0; k < unit.size(); ++k) {
    const double weight = 1.0 / points.variance_rad2[k];
    weights += weight;
    x += weight * unit[k];
    y += weight * points.angle_rad[k];
  }
  x /= weights;
  y /= weights;
  double xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < unit.size(); ++k) {
    const double weight = 1.0 / points.variance_rad2[k];
    xx += weight * numerics::square(unit[k] - x);
    xy += weight * (unit[k] - x) * (points.angle_rad[k] - y);
  }
  FlankFit fit{.friction = friction, .hardening = hardening};
  fit.wind_up_rad = std::max(0.0, xy / xx);
  fit.offset_rad = y - fit.wind_up_rad * x;
  fit.chi_square = 0.0;
  for (std::size_t k = 0; k < unit.size(); ++k) {
    const double left = points.angle_rad[k] - fit.offset_rad - fit.wind_up_rad * unit[k];
    fit.chi_square += left * left / points.variance_rad2[k];
  }
  return fit;
}

/// The fit of least χ² between two bounds of one quantity: a scan, then golden sections about it.
template <typename FitAt>
FlankFit least_between(double low, double high, const FitAt& fit_at) {
  constexpr int kScan = 12, kSections = 24;
  const double step = (high - low) / kScan;
  FlankFit best;
  int at = 0;
  for (int k = 0; k <= kScan; ++k) {
    const FlankFit fit = fit_at(low + k * step);
    if (fit.chi_square < best.chi_square) {
      best = fit;
      at = k;
    }
  }
  int sections = 0;
  numerics::golden_sections(
      low + std::max(0, at - 1) * step, low + std::min(kScan, at + 1) * step,
      [&](double x) {
        const FlankFit fit = fit_at(x);
        if (fit.chi_square < best.chi_square) best = fit;
        return fit.chi_square;
      },
      [&](double, double) { return sections++ == kSections; });
  return best;
}

FlankFit curved_flanks(const LoopPoints& points, double friction) {
  constexpr double kSofter = -0.2, kHarder = 0.5;
  return least_between(kSofter, kHarder, [&](double h) { return fit_flanks(points, friction, h); });
}

/// @param degrees  readings less parameters
bool friction_shows(const FlankFit& with, const FlankFit& without, double degrees) {
  constexpr double kDeviations = 3.0, kChance = 2.7e-3, kMisses = 1e-3;
  const double gain = without.chi_square - with.chi_square;
  if (!(gain > numerics::square(kDeviations))) return false;
  if (numerics::gamma_upper(0.5 * degrees, 0.5 * with.chi_square) > kMisses) return true;
  return numerics::f_upper_tail(gain / (with.chi_square / degrees), 1.0, degrees) < kChance;
}

/// Loops that are read at as many torques as any, and what they have in common.
struct CommonLoops {
  std::vector<std::size_t> place;  ///< of each among all loops
  std::vector<LineOpening> opening;
  double weights = 0.0, opening_rad = 0.0;
  LoopPoints mean;
};

CommonLoops common_of(const std::vector<LoopReading>& loops) {
  constexpr std::size_t kFewestTravels = 3;
  CommonLoops common;
  std::size_t most = kFewestTravels;
  for (const LoopReading& loop : loops) {
    if (loop.tells_zero) most = std::max(most, loop.travel.size());
  }
  std::vector<LoopPoints> points;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (!loops[k].tells_zero || loops[k].travel.size() != most) continue;
    points.push_back(loop_points(loops[k]));
    if (points.back().torque != points.front().torque) {
      points.pop_back();
      continue;
    }
    common.place.push_back(k);
    common.opening.push_back(line_opening(points.back()));
    common.weights += 1.0 / common.opening.back().variance_rad2;
  }
  if (points.empty()) return common;
  common.mean = {.torque = points.front().torque,
                 .angle_rad = std::vector<double>(most + 1, 0.0),
                 .variance_rad2 = std::vector<double>(most + 1, 0.0)};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double share = 1.0 / (common.opening[k].variance_rad2 * common.weights);
    common.opening_rad += share * common.opening[k].value_rad;
    for (std::size_t j = 0; j <= most; ++j) {
      common.mean.angle_rad[j] += share * points[k].angle_rad[j];
      common.mean.variance_rad2[j] += share * share * points[k].variance_rad2[j];
    }
  }
  return common;
}

/// Variance between the loops' openings beyond their own; 0 where they do not differ.
double variance_between(const CommonLoops& common) {
  constexpr double kDiffer = 1e-3;
  const auto degrees = static_cast<double>(common.place.size()) - 1.0;
  if (!(degrees > 0.0)) return 0.0;
  double chi_square = 0.0, squares = 0.0;
  for (const LineOpening& opening : common.opening) {
    const double weight = 1.0 / opening.variance_rad2;
    chi_square += weight * numerics::square(opening.value_rad - common.opening_rad);
    squares += weight * weight;
  }
  if (numerics::gamma_upper(0.5 * degrees, 0.5 * chi_square) > kDiffer) return 0.0;
  return std::max(0.0, (chi_square - degrees) / (common.weights - squares / common.weights));
}

/// Of each loop, in units of the greatest torque; `fit` is that of all.
std::vector<double> frictions_of(const CommonLoops& common, const FlankFit& fit,
                                 std::size_t loops) {
  constexpr double kDeviations = 3.0;
  std::vector<double> friction(loops, fit.friction);
  const double between = variance_between(common);
  if (!(between > 0.0)) return friction;
  const auto opening_at = [&](double f) {
    LoopPoints unit = common.mean;
    unit.angle_rad = unit_readings(unit.torque, f, fit.hardening);
    return fit.wind_up_rad * line_opening(unit).value_rad;
  };
  const double slope = (opening_at(fit.friction) - opening_at(0.0)) / fit.friction;
  if (!(slope > 0.0)) return friction;
  for (std::size_t k = 0; k < common.place.size(); ++k) {
    const LineOpening& opening = common.opening[k];
    const double share = between / (between + opening.variance_rad2);
    const double own = fit.friction + share * (opening.value_rad - common.opening_rad) / slope;
    const double deviation = std::sqrt(share * opening.variance_rad2) / slope;
    // What is read at the smallest torque must still be beyond the friction.
    friction[common.place[k]] =
        own > kDeviations * deviation ? std::min(own, kFrictionReach * common.mean.torque[1]) : 0.0;
  }
  return friction;
}

}  // namespace

std::vector<FrictionShare> friction_shares(const std::vector<LoopReading>& loops) {
  constexpr std::size_t kParameters = 4;  // b, C, h and T_f
  std::vector<FrictionShare> shares(loops.size());
  for (std::size_t k = 0; k < loops.size(); ++k) {
    shares[k].travel_rad.assign(loops[k].travel.size(), 0.0);
  }
  const CommonLoops common = common_of(loops);
  if (common.place.empty()) return shares;
  const double greatest_Nm = loops[common.place.front()].travel.back().torque_Nm;
  const std::size_t readings = common.mean.torque.size();
  const bool tells_curvature = readings > kParameters;
  const FlankFit without = curved_flanks(common.mean, 0.0);
  const FlankFit fit =
      least_between(0.0, kFrictionReach * common.mean.torque[1], [&](double friction) {
        return tells_curvature ? curved_flanks(common.mean, friction)
                               : fit_flanks(common.mean, friction, 0.0);
      });
  const std::size_t parameters = tells_curvature ? kParameters : kParameters - 1;
  if (!friction_shows(fit, without, static_cast<double>(readings - parameters))) return shares;
  const std::vector<double> friction = frictions_of(common, fit, loops.size());
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (!(friction[k] > 0.0)) continue;
    shares[k].friction_Nm = friction[k] * greatest_Nm;
    shares[k].zero_rad = fit.wind_up(friction[k]);
    for (std::size_t j = 0; j < loops[k].travel.size(); ++j) {
      const double torque = loops[k].travel[j].torque_Nm / greatest_Nm;
      shares[k].travel_rad[j] =
          fit.wind_up(torque) - fit.wind_up(std::max(0.0, torque - friction[k]));
    }
  }
  return shares;
}

}  // namespace gear3k::calibrate
