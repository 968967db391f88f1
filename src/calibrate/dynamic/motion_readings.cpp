#include "calibrate/dynamic/motion_readings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "calibrate/search/order_scan.hpp"
#include "numerics/distributions.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using numerics::square;

constexpr double kIdleShare = 0.05;  // of what slows down: neither motor nor load acts
constexpr std::size_t kMostSampled = 20000;
constexpr std::size_t kFewestSampled = 200;
constexpr double kRippleRate = 0.01;  // of any wave where there is none
constexpr int kMostHarmonic = 12;
constexpr double kLongestReversal_s = 0.5;

double mean_motor(const MotionWindow& w) { return w.motor_Nm / w.term[4]; }
double mean_load(const MotionWindow& w) { return -w.term[3] / w.term[4]; }
double mean_speed(const MotionWindow& w) { return w.term[1] / w.term[4]; }

struct DragPoint {
  double speed = 0.0, drag = 0.0;
};

/// drag = constant + viscous speed by least squares.
RunDownDrag drag_of(const std::vector<DragPoint>& points, int flow) {
  RunDownDrag r{.flow = flow, .windows = points.size()};
  const auto n = static_cast<double>(points.size());
  double x = 0.0, y = 0.0;
  for (const DragPoint& p : points) {
    x += p.speed / n;
    y += p.drag / n;
  }
  double xx = 0.0, xy = 0.0;
  for (const DragPoint& p : points) {
    xx += square(p.speed - x);
    xy += (p.speed - x) * (p.drag - y);
  }
  constexpr double kSpread = 0.2;  // of the mean speed
  const bool sloped = points.size() > 3 && xx > n * square(kSpread * x);
  const double slope = sloped ? xy / xx : 0.0;
  double left = 0.0;
  for (const DragPoint& p : points) left += square(p.drag - y - slope * (p.speed - x));
  const double degrees = n - (sloped ? 2.0 : 1.0);
  const double variance = degrees > 0.0 ? left / degrees : 0.0;
  const double t = degrees > 0.0 ? numerics::student_quantile(0.975, degrees) : 0.0;
  const auto around = [&](double value, double half) {
    return MotionEstimate{.value = value, .low = value - half, .high = value + half};
  };
  r.constant_Nm =
      around(y - slope * x, t * std::sqrt(variance * (1.0 / n + (sloped ? x * x / xx : 0.0))));
  if (sloped) r.viscous_Nms = around(slope, t * std::sqrt(variance / xx));
  return r;
}

/// Whether neither motor nor load is more than a small share of what slows the drive down.
bool coasts(const MotionWindow& w, const std::array<double, 4>& beta) {
  const double slows = -beta[0] * w.term[0] / w.term[4] * w.sense;
  return slows > 0.0 && std::abs(mean_motor(w)) < kIdleShare * slows &&
         std::abs(mean_load(w)) < kIdleShare * slows;
}

void read_run_downs(const std::vector<MotionWindow>& windows, const DriveParameters& drive,
                    MotionReadings& r) {
  std::array<std::vector<DragPoint>, 2> points;
  std::array<std::array<double, 4>, 2> stated{};
  for (std::size_t first = 0; first < windows.size();) {
    const MotionWindow& w = windows[first];
    const auto beta = drive_coefficients(drive, w.flow, w.load_kgm2);
    std::size_t end = first;
    while (end < windows.size() && windows[end].flow == w.flow && windows[end].sense == w.sense &&
           windows[end].session == w.session && windows[end].load_kgm2 == w.load_kgm2 &&
           coasts(windows[end], beta)) {
      ++end;
    }
    // One window alone is a torque that passes through zero.
    if (end - first < 2) {
      first = std::max(end, first + 1);
      continue;
    }
    const std::size_t f = w.flow > 0 ? 0 : 1;
    stated.at(f) = beta;
    const MotionWindow& last = windows[end - 1];
    const double begins = w.time_s - 0.5 * w.duration_s;
    r.run_downs.push_back({.time_s = begins,
                           .duration_s = last.time_s + 0.5 * last.duration_s - begins,
                           .from_rad_s = mean_speed(w),
                           .to_rad_s = mean_speed(last),
                           .windows = end - first});
    for (; first < end; ++first) {
      const MotionWindow& own = windows[first];
      const double root = own.term[4];
      const double drag =
          (own.motor_Nm - beta[0] * own.term[0] - beta[3] * own.term[3]) / root * own.sense;
      points.at(f).push_back({.speed = std::abs(mean_speed(own)), .drag = drag});
    }
  }
  for (std::size_t f = 0; f < 2; ++f) {
    if (points.at(f).size() < 2) continue;
    r.drags.push_back(drag_of(points.at(f), f == 0 ? 1 : -1));
    r.drags.back().stated_constant_Nm = stated.at(f)[2];
    r.drags.back().stated_viscous_Nms = stated.at(f)[1];
  }
}

void read_reversals(const std::vector<MotionWindow>& windows, MotionReadings& r) {
  for (std::size_t k = 1; k < windows.size(); ++k) {
    const MotionWindow &now = windows[k], &before = windows[k - 1];
    const double apart = now.time_s - before.time_s - 0.5 * (now.duration_s + before.duration_s);
    if (now.session != before.session || !(apart >= 0.0 && apart < kLongestReversal_s)) continue;
    if (now.sense != before.sense) ++r.reversals;
    if (now.sense * now.flow != before.sense * before.flow) ++r.flank_changes;
  }
}

/// Samples among which waves are sought.
struct RippleSeries {
  std::vector<double> angle;
  Eigen::VectorXd left;
  double turns = 0.0;
  std::vector<double> phase_per_order;  ///< |w| h of some of them; empty: waves stay as they are

  /// Mean square of what is seen of waves of an order, over theirs.
  [[nodiscard]] double seen(double order) const {
    if (phase_per_order.empty()) return 1.0;
    double sum = 0.0;
    for (const double phase : phase_per_order) {
      const double x = order * phase;
      constexpr double kSmall = 0.01;
      sum += square(x < kSmall ? 1.0 : 3.0 * (std::sin(x) - x * std::cos(x)) / (x * x * x));
    }
    return sum / static_cast<double>(phase_per_order.size());
  }
};

/// @param even  as the waves of the output want it, whose accelerations are no noise
RippleSeries ripple_series(const std::vector<TorqueSample>& samples, bool even) {
  RippleSeries r;
  std::vector<double> left;
  constexpr std::size_t kPhases = 200;
  for (const TorqueSample& sample : samples) {
    if (even && !sample.even_Nm) continue;
    r.angle.push_back(sample.angle_rad);
    left.push_back(even ? *sample.even_Nm : sample.left_Nm);
  }
  if (left.empty()) return r;
  for (std::size_t k = 0; even && k < samples.size(); k += 1 + samples.size() / kPhases) {
    if (samples[k].even_Nm) {
      r.phase_per_order.push_back(std::abs(samples[k].speed_rad_s) * samples[k].half_s);
    }
  }
  const auto [least, most] = std::ranges::minmax(r.angle);
  r.turns = (most - least) / (2.0 * std::numbers::pi);
  r.left = Eigen::Map<const Eigen::VectorXd>(left.data(), static_cast<Eigen::Index>(left.size()));
  r.left.array() -= r.left.mean();
  return r;
}

double amplitude_in(const RippleSeries& series, double order) {
  const Eigen::MatrixXd wave = waves(series.angle, order);
  const double cc = wave.col(0).squaredNorm(), ss = wave.col(1).squaredNorm();
  const double cs = wave.col(0).dot(wave.col(1));
  const double c = wave.col(0).dot(series.left), s = wave.col(1).dot(series.left);
  const double all = cc * ss - cs * cs;
  return std::hypot((c * ss - s * cs) / all, (s * cc - c * cs) / all) /
         std::sqrt(series.seen(order));
}

/// Probability of as much of an order by chance: its neighbours tell how much is no wave.
std::optional<double> chance_of_order(const RippleSeries& series, double order) {
  constexpr int kAside = 20;
  constexpr double kLeastSeen = 0.2;  // of squares
  if (series.seen(order) < kLeastSeen) return std::nullopt;
  NoiseModel even;
  even.weight = Eigen::VectorXd::Ones(series.left.size());
  const FreeResidual residual{
      .noise = even, .own_basis = Eigen::MatrixXd(series.left.size(), 0), .left = series.left};
  const double width = std::max(1.5 / series.turns, 0.01 * order);
  const double first = std::max(order - kAside * width, 0.25 * width);
  const auto count = static_cast<int>(std::floor((order + kAside * width - first) / width)) + 1;
  const OrderScan scan = scan_orders(series.angle, first, width, count, residual);
  const OrderScan own = scan_orders(series.angle, order, 1.0, 1, residual);
  double background = 0.0, kept = 0.0;
  for (std::size_t k = 0; k < scan.order.size(); ++k) {
    const double seen = series.seen(scan.order[k]);
    if (std::abs(scan.order[k] - order) < 1.2 * width || seen < kLeastSeen) continue;
    background += scan.share[k] / seen;
    kept += 1.0;
  }
  if (!(kept > 4.0) || !(background > 0.0)) return std::nullopt;
  // Powers of noise are exponential: of one over the mean of n the F distribution.
  const double f = own.share[0] / series.seen(order) * kept / background;
  return numerics::f_upper_tail(f, 2.0, 2.0 * kept);
}

void read_ripple(const MotionRecord& record, const DriveParameters& drive, double ratio,
                 MotionReadings& r) {
  const std::vector<TorqueSample> samples = torque_samples(record, drive, kMostSampled);
  if (samples.size() < kFewestSampled) return;
  double fastest = 0.0;
  for (const TorqueSample& sample : samples) {
    fastest = std::max(fastest, std::abs(sample.speed_rad_s));
  }
  double step_s = 0.0, steps = 0.0;
  for (const MotionStretch& s : record.stretches) {
    step_s += s.time_s.back() - s.time_s.front();
    steps += static_cast<double>(s.time_s.size()) - 1.0;
  }
  r.highest_order = fastest > 0.0 ? std::numbers::pi * steps / (step_s * fastest) : 0.0;
  const RippleSeries of_motor = ripple_series(samples, false),
                     of_output = ripple_series(samples, true);
  struct Place {
    const char* shaft;
    int harmonic;
    double order;
    const RippleSeries* series;
  };
  std::vector<Place> places;
  for (int harmonic = 1; harmonic <= kMostHarmonic; ++harmonic) {
    places.push_back({"motor", harmonic, harmonic * std::abs(ratio), &of_motor});
    if (harmonic <= 2 && std::abs(ratio) > 4.0)
      places.push_back({"output", harmonic, 1.0 * harmonic, &of_output});
  }
  // Two turns of a shaft, and orders that the sampling does not fold.
  std::erase_if(places, [&](const Place& p) {
    return p.order > 0.8 * r.highest_order || p.series->turns * p.order < 2.0 ||
           p.series->angle.size() < kFewestSampled;
  });
  for (const Place& p : places) {
    const std::optional<double> one = chance_of_order(*p.series, p.order);
    if (!one) continue;
    const double chance = *one * static_cast<double>(places.size());
    if (!(chance < kRippleRate)) continue;
    r.ripple.push_back({.shaft = p.shaft,
                        .harmonic = p.harmonic,
                        .order = p.order,
                        .amplitude_Nm = amplitude_in(*p.series, p.order),
                        .p_value = std::min(1.0, chance)});
  }
}

}  // namespace

MotionReadings motion_readings(const MotionRecord& record, const DriveParameters& drive,
                               const std::vector<MotionWindow>& windows, double ratio) {
  MotionReadings r;
  if (windows.empty()) return r;
  read_run_downs(windows, drive, r);
  read_reversals(windows, r);
  read_ripple(record, drive, ratio, r);
  return r;
}

}  // namespace gear3k::calibrate
