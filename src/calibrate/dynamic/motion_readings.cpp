#include "calibrate/dynamic/motion_readings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

void read_ripple(const MotionRecord& record, const DriveParameters& drive, double ratio,
                 MotionReadings& r) {
  const std::vector<TorqueSample> samples = torque_samples(record, drive, kMostSampled);
  if (samples.size() < kFewestSampled) return;
  std::vector<double> angle;
  double fastest = 0.0, least = samples.front().angle_rad, most = least;
  Eigen::VectorXd left(static_cast<Eigen::Index>(samples.size()));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    angle.push_back(samples[k].angle_rad);
    left(static_cast<Eigen::Index>(k)) = samples[k].left_Nm;
    fastest = std::max(fastest, std::abs(samples[k].speed_rad_s));
    least = std::min(least, samples[k].angle_rad);
    most = std::max(most, samples[k].angle_rad);
  }
  left.array() -= left.mean();
  double step_s = 0.0, steps = 0.0;
  for (const MotionStretch& s : record.stretches) {
    step_s += s.time_s.back() - s.time_s.front();
    steps += static_cast<double>(s.time_s.size()) - 1.0;
  }
  const double turns = (most - least) / (2.0 * std::numbers::pi);
  r.highest_order = fastest > 0.0 ? std::numbers::pi * steps / (step_s * fastest) : 0.0;
  NoiseModel even;
  even.weight = Eigen::VectorXd::Ones(left.size());
  const FreeResidual residual{
      .noise = even, .own_basis = Eigen::MatrixXd(left.size(), 0), .left = left};
  struct Place {
    const char* shaft;
    int harmonic;
    double order;
  };
  std::vector<Place> places;
  for (int harmonic = 1; harmonic <= kMostHarmonic; ++harmonic) {
    places.push_back({"motor", harmonic, harmonic * std::abs(ratio)});
    if (harmonic <= 2 && std::abs(ratio) > 4.0)
      places.push_back({"output", harmonic, 1.0 * harmonic});
  }
  // Two turns of a shaft, and orders that the sampling does not fold.
  std::erase_if(places, [&](const Place& p) {
    return p.order > 0.8 * r.highest_order || turns * p.order < 2.0;
  });
  for (const Place& p : places) {
    // Its neighbours tell how much is no wave of this shaft.
    constexpr int kAside = 20;
    const double width = std::max(1.5 / turns, 0.01 * p.order);
    const double first = std::max(p.order - kAside * width, 0.25 * width);
    const auto count = static_cast<int>(std::floor((p.order + kAside * width - first) / width)) + 1;
    const OrderScan scan = scan_orders(angle, first, width, count, residual);
    const OrderScan own = scan_orders(angle, p.order, 1.0, 1, residual);
    double background = 0.0, kept = 0.0;
    for (std::size_t k = 0; k < scan.order.size(); ++k) {
      if (std::abs(scan.order[k] - p.order) < 1.2 * width) continue;
      background += scan.share[k];
      kept += 1.0;
    }
    if (!(kept > 4.0) || !(background > 0.0)) continue;
    // Powers of noise are exponential: of one over the mean of n the F distribution.
    const double f = own.share[0] * kept / background;
    const double chance =
        numerics::f_upper_tail(f, 2.0, 2.0 * kept) * static_cast<double>(places.size());
    if (!(chance < kRippleRate)) continue;
    const Eigen::MatrixXd wave = waves(angle, p.order);
    const double cc = wave.col(0).squaredNorm(), ss = wave.col(1).squaredNorm();
    const double cs = wave.col(0).dot(wave.col(1));
    const double c = wave.col(0).dot(left), s = wave.col(1).dot(left), all = cc * ss - cs * cs;
    const double amplitude = std::hypot((c * ss - s * cs) / all, (s * cc - c * cs) / all);
    r.ripple.push_back({.shaft = p.shaft,
                        .harmonic = p.harmonic,
                        .order = p.order,
                        .amplitude_Nm = amplitude,
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
