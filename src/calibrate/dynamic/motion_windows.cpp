#include "calibrate/dynamic/motion_windows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "numerics/median.hpp"
#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using numerics::square;

constexpr std::size_t kHalfWidth = 6;       // samples on each side of a curve that tells the flow
constexpr std::size_t kFewestSamples = 12;  // of a window
constexpr std::size_t kMostSamples = 400;   // of a window
constexpr double kWindowsPerPiece = 2.0;    // of the piece of median length
constexpr double kFewestWindows = 100.0;    // where the samples are enough
constexpr double kDoubtDeviations = 3.0;    // within which a sign is in doubt
constexpr double kDoubtShare = 0.03;        // of the root mean square of the mesh's torque
constexpr int kSettledDegree = 4;           // of speeds whose acceleration is exact
constexpr double kStillShare = 0.02;  // of the root mean square speed: in doubt whether it turns

/// Standard deviation of white noise on a smooth signal, by third divided differences of its own
/// steps of time: blind to parabolas at any sampling, scaled to the variance of one sample.  Even
/// steps: third differences, of variance 20 σ².
double noise_deviation(const std::vector<double>& time, const std::vector<double>& x) {
  if (x.size() < 8) return 0.0;
  double sum = 0.0;
  for (std::size_t k = 3; k < x.size(); ++k) {
    double difference = 0.0, squares = 0.0;
    for (std::size_t i = k - 3; i <= k; ++i) {
      double product = 1.0;
      for (std::size_t j = k - 3; j <= k; ++j) {
        if (j != i) product *= time[i] - time[j];
      }
      difference += x[i] / product;
      squares += 1.0 / square(product);
    }
    sum += square(difference) / squares;
  }
  return std::sqrt(sum / static_cast<double>(x.size() - 3));
}

/// Speed and acceleration at a sample by a parabola (of an angle: a cubic) through its neighbours,
/// which does not take a reversal for later where the speed bends; and their variances by noise.
struct LocalMotion {
  double speed = 0.0, acceleration = 0.0;
  double speed_gain = 0.0, acceleration_gain = 0.0;  ///< variance over that of a sample
};

constexpr std::size_t kLocal = 2 * kHalfWidth + 1;
using LocalWeights = std::array<double, kLocal>;

/// Weights by which the samples about one of them give value, slope and second derivative of their
/// polynomial there.
struct LocalFit {
  std::array<LocalWeights, 3> weight{};
  std::array<double, 3> gain{};  ///< Σ weight²
};

LocalFit local_fit(const MotionStretch& s, std::size_t k, int degree) {
  const std::size_t first = k - kHalfWidth;
  const double scale = s.time_s[k + kHalfWidth] - s.time_s[first];
  LocalWeights t{}, now{}, before{};
  for (std::size_t j = 0; j < kLocal; ++j) {
    t.at(j) = (s.time_s[first + j] - s.time_s[k]) / scale;
    now.at(j) = 1.0;
  }
  // Stieltjes' recurrence of the polynomials that are orthogonal over the samples; here: value and
  // derivatives of the last two at the sample itself.
  LocalFit fit;
  std::array<double, 3> here{1.0, 0.0, 0.0}, here_before{};
  double norm_before = 1.0;
  for (int m = 0; m <= degree; ++m) {
    double norm = 0.0, shift = 0.0;
    for (std::size_t j = 0; j < kLocal; ++j) {
      norm += square(now.at(j));
      shift += t.at(j) * square(now.at(j));
    }
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < kLocal; ++j) {
        fit.weight.at(i).at(j) += here.at(i) * now.at(j) / norm;
      }
      fit.gain.at(i) += square(here.at(i)) / norm;
    }
    shift /= norm;
    const double ratio = m > 0 ? norm / norm_before : 0.0;
    for (std::size_t j = 0; j < kLocal; ++j) {
      const double next = (t.at(j) - shift) * now.at(j) - ratio * before.at(j);
      before.at(j) = now.at(j);
      now.at(j) = next;
    }
    const std::array<double, 3> next{-shift * here[0] - ratio * here_before[0],
                                     here[0] - shift * here[1] - ratio * here_before[1],
                                     2.0 * here[1] - shift * here[2] - ratio * here_before[2]};
    here_before = here;
    here = next;
    norm_before = norm;
  }
  double unit = 1.0;
  for (std::size_t i = 0; i < 3; ++i, unit /= scale) {
    for (double& w : fit.weight.at(i)) w *= unit;
    fit.gain.at(i) *= square(unit);
  }
  return fit;
}

LocalMotion local_motion(const MotionStretch& s, std::size_t k) {
  const bool angle = s.speed_rad_s.empty();
  const std::vector<double>& signal = angle ? s.angle_rad : s.speed_rad_s;
  const LocalFit fit = local_fit(s, k, angle ? 3 : 2);
  std::array<double, 3> derivative{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < kLocal; ++j) {
      derivative.at(i) += fit.weight.at(i).at(j) * (signal[k - kHalfWidth + j] - signal[k]);
    }
  }
  derivative[0] += signal[k];
  const std::size_t speed = angle ? 1 : 0;
  return {.speed = derivative.at(speed),
          .acceleration = derivative.at(speed + 1),
          .speed_gain = fit.gain.at(speed),
          .acceleration_gain = fit.gain.at(speed + 1)};
}

/// From weights of a signal those of its rate: Σ c y = Σ b dy/dt where Σ c = 0, by trapezoids.
LocalWeights weights_of_rate(const LocalWeights& c, const double* time) {
  LocalWeights b{};
  double after = 0.0;
  for (std::size_t j = kLocal - 1; j > 0; --j) {
    after += c.at(j);
    const double half = 0.5 * after * (time[j] - time[j - 1]);
    b.at(j) += half;
    b.at(j - 1) += half;
  }
  return b;
}

/// What is left of the motor's torque about a sample, every signal weighed as the acceleration that
/// the parabola there takes for its own is a mean of those about it.
double even_residual(const MotionStretch& s, std::size_t k, int sense,
                     const std::array<double, 4>& beta) {
  const bool angle = s.speed_rad_s.empty();
  const std::vector<double>& signal = angle ? s.angle_rad : s.speed_rad_s;
  const std::size_t first = k - kHalfWidth;
  const double* const time = s.time_s.data() + first;
  const LocalFit fit = local_fit(s, k, angle ? 3 : 2);
  const LocalWeights& rate = fit.weight.at(angle ? 2 : 1);
  const LocalWeights mean =
      angle ? weights_of_rate(weights_of_rate(rate, time), time) : weights_of_rate(rate, time);
  double left = 0.0, acceleration = 0.0, speed = 0.0;
  for (std::size_t j = 0; j < kLocal; ++j) {
    const double load = s.load_Nm.empty() ? 0.0 : s.load_Nm[first + j];
    left += mean.at(j) * (s.motor_Nm[first + j] - beta[2] * sense + beta[3] * load);
    acceleration += rate.at(j) * (signal[first + j] - signal[k]);
    if (!angle) speed += mean.at(j) * signal[first + j];
  }
  if (angle) speed = local_motion(s, k).speed;
  return left - beta[0] * acceleration - beta[1] * speed;
}

/// Samples begin ... end − 1 of one sense and one flow.
struct MotionPiece {
  std::size_t begin = 0, end = 0;
  int sense = 1, flow = 1;
};

/// What is known of a stretch before it is cut.
struct StretchSigns {
  std::vector<double> speed, mesh;  ///< at samples half ... size − half − 1; else NaN
  double speed_doubt = 0.0, mesh_doubt = 0.0;
  double mesh_square = 0.0, speed_square = 0.0;
  std::size_t count = 0;
};

StretchSigns stretch_signs(const MotionStretch& s, const DriveParameters& d) {
  StretchSigns r;
  const std::size_t n = s.time_s.size();
  r.speed.assign(n, std::numeric_limits<double>::quiet_NaN());
  r.mesh = r.speed;
  if (n < 2 * kHalfWidth + 2) return r;
  const double inertia = d.output_inertia_kgm2 + s.load_kgm2;
  double speed_gain = 0.0, acceleration_gain = 0.0;
  for (std::size_t k = kHalfWidth; k + kHalfWidth < n; ++k) {
    const LocalMotion m = local_motion(s, k);
    double load = 0.0;
    if (!s.load_Nm.empty()) {
      for (std::size_t j = k - kHalfWidth; j <= k + kHalfWidth; ++j) load += s.load_Nm[j];
      load /= static_cast<double>(2 * kHalfWidth + 1);
    }
    const double sense = m.speed > 0.0 ? 1.0 : -1.0;
    r.speed[k] = m.speed;
    r.mesh[k] = inertia * m.acceleration + d.output_viscous_Nms * m.speed +
                d.output_coulomb_Nm * sense - load;
    r.mesh_square += square(r.mesh[k]);
    r.speed_square += square(m.speed);
    speed_gain += m.speed_gain;
    acceleration_gain += m.acceleration_gain;
    ++r.count;
  }
  const auto width = static_cast<double>(2 * kHalfWidth + 1), count = static_cast<double>(r.count);
  const double noise =
      noise_deviation(s.time_s, s.speed_rad_s.empty() ? s.angle_rad : s.speed_rad_s);
  const double load_noise = noise_deviation(s.time_s, s.load_Nm) / std::sqrt(width);
  r.speed_doubt = kDoubtDeviations * noise * std::sqrt(speed_gain / count);
  r.mesh_doubt = kDoubtDeviations *
                 std::hypot(inertia * noise * std::sqrt(acceleration_gain / count), load_noise);
  return r;
}

std::vector<MotionPiece> motion_pieces(const StretchSigns& s, double still, double doubt) {
  std::vector<MotionPiece> pieces;
  MotionPiece now;
  const double still_here = std::max(still, s.speed_doubt);
  const double doubt_here = std::max(doubt, s.mesh_doubt);
  const auto close = [&](std::size_t end) {
    now.end = end;
    if (now.end > now.begin && now.end - now.begin >= kFewestSamples) pieces.push_back(now);
  };
  bool open = false;
  for (std::size_t k = 0; k < s.speed.size(); ++k) {
    const double w = s.speed[k], m = s.mesh[k];
    const bool clear = std::abs(w) > still_here && std::abs(m) > doubt_here;  // false for NaN
    const int sense = w > 0.0 ? 1 : -1;
    const int flow = m * sense > 0.0 ? 1 : -1;
    if (open && (!clear || sense != now.sense || flow != now.flow)) {
      close(k);
      open = false;
    }
    if (clear && !open) {
      now = {.begin = k, .end = k, .sense = sense, .flow = flow};
      open = true;
    }
  }
  if (open) close(s.speed.size());
  return pieces;
}

/// Noise of the signals of a stretch.
struct StretchNoise {
  double motion = 0.0, load = 0.0;
};

/// Weights of a window's samples: φ dt, and those whose sums are ∫ φ a dt and ∫ φ w dt.
struct WindowWeights {
  std::vector<double> phi, rate, speed;
  double total = 0.0, squares = 0.0;  ///< Σ φ dt and Σ (φ dt)²
};

/// A polynomial with its first two derivatives, at the samples of a window.
struct SampledPolynomial {
  std::array<std::vector<double>, 3> derivative;

  explicit SampledPolynomial(std::size_t samples, double value) {
    for (auto& d : derivative) d.assign(samples, 0.0);
    derivative[0].assign(samples, value);
  }
};

/// The next of the orthogonal polynomials: (x − shift) p − ratio q.
SampledPolynomial next_polynomial(const std::vector<double>& x, const SampledPolynomial& now,
                                  const SampledPolynomial& before, double shift, double ratio) {
  SampledPolynomial next(x.size(), 0.0);
  for (std::size_t order = 0; order < 3; ++order) {
    for (std::size_t k = 0; k < x.size(); ++k) {
      double& value = next.derivative[order][k];
      value = (x[k] - shift) * now.derivative[order][k] - ratio * before.derivative[order][k];
      if (order > 0) value += static_cast<double>(order) * now.derivative[order - 1][k];
    }
  }
  return next;
}

/// Adds to weights a multiple of φ by a polynomial, so that for every polynomial y up to a degree,
/// at any sampling, Σ weights y = Σ φ d^n y / dt^n with the φ that weighs the torques.
///
/// By the polynomials p_m that are orthogonal under φ (Stieltjes' recurrence) each error
/// e_m = Σ φ p_m^(n) − Σ weights p_m is taken off by itself: weights += φ p_m e_m / Σ φ p_m².
/// @param x       times over half of the window, from its middle
/// @param factor  (dx/dt)^n
/// Source: docs/theory §69.
void settle_weights(std::vector<double>& weights, const std::vector<double>& phi,
                    const std::vector<double>& x, std::size_t order, double factor, int degree) {
  SampledPolynomial before(x.size(), 0.0), now(x.size(), 1.0);
  double norm_before = 1.0;
  for (int m = 0; m <= degree; ++m) {
    const std::vector<double>& p = now.derivative[0];
    double norm = 0.0, shift = 0.0, error = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      norm += phi[k] * p[k] * p[k];
      shift += phi[k] * x[k] * p[k] * p[k];
      error += factor * phi[k] * now.derivative.at(order)[k] - weights[k] * p[k];
    }
    for (std::size_t k = 0; k < x.size(); ++k) weights[k] += phi[k] * p[k] * error / norm;
    SampledPolynomial next =
        next_polynomial(x, now, before, shift / norm, m > 0 ? norm / norm_before : 0.0);
    before = std::move(now);
    now = std::move(next);
    norm_before = norm;
  }
}

WindowWeights window_weights(const MotionStretch& s, const MotionPiece& p) {
  const bool angle = s.speed_rad_s.empty();
  const double half = 0.5 * (s.time_s[p.end - 1] - s.time_s[p.begin]);
  const double middle = s.time_s[p.begin] + half;
  WindowWeights r;
  std::vector<double> place;
  for (std::size_t k = p.begin; k < p.end; ++k) {
    const double before = k > p.begin ? s.time_s[k - 1] : s.time_s[k];
    const double after = k + 1 < p.end ? s.time_s[k + 1] : s.time_s[k];
    const double dt = 0.5 * (after - before), t = s.time_s[k] - middle, x = t / half;
    const double rest = std::max(0.0, 1.0 - x * x);
    const double phi = (angle ? rest * rest * rest * rest : rest * rest * rest) * dt;
    r.total += phi;
    r.squares += phi * phi;
    r.phi.push_back(phi);
    place.push_back(x);
    if (angle) {
      r.speed.push_back(8.0 * x * rest * rest * rest / half * dt);
      r.rate.push_back((48.0 * x * x * rest * rest - 8.0 * rest * rest * rest) / (half * half) *
                       dt);
    } else {
      r.rate.push_back(6.0 * x * rest * rest / half * dt);
    }
  }
  if (angle) {
    settle_weights(r.speed, r.phi, place, 1, 1.0 / half, kSettledDegree + 1);
    settle_weights(r.rate, r.phi, place, 2, 1.0 / (half * half), kSettledDegree + 1);
  } else {
    r.speed = r.phi;
    settle_weights(r.rate, r.phi, place, 1, 1.0 / half, kSettledDegree);
  }
  return r;
}

MotionWindow window_of(const MotionStretch& s, const MotionPiece& p, const StretchNoise& noise) {
  const WindowWeights weights = window_weights(s, p);
  const bool angle = s.speed_rad_s.empty();
  const std::vector<double>& signal = angle ? s.angle_rad : s.speed_rad_s;
  // Of an angle the even part is taken off first, for its digits.
  const std::size_t last = p.end - 1;
  const double span = s.time_s[last] - s.time_s[p.begin];
  const double even = angle ? (signal[last] - signal[p.begin]) / span : 0.0;
  double motor = 0.0, speed = 0.0, rate = 0.0, load = 0.0;
  double rate_variance = 0.0, load_variance = 0.0, windup = 0.0;
  for (std::size_t j = 0; j < weights.phi.size(); ++j) {
    const std::size_t k = p.begin + j;
    const double value =
        angle ? signal[k] - signal[p.begin] - even * (s.time_s[k] - s.time_s[p.begin]) : signal[k];
    motor += weights.phi[j] * s.motor_Nm[k];
    if (!s.load_Nm.empty()) load += weights.phi[j] * s.load_Nm[k];
    speed += weights.speed[j] * value;
    rate += weights.rate[j] * value;
    if (!s.windup_rad.empty()) windup += weights.phi[j] * s.windup_rad[k];
    load_variance += square(weights.phi[j] * noise.load);
    rate_variance += square(weights.rate[j] * noise.motion);
  }
  speed += even * weights.total;
  const double root = weights.total / std::sqrt(weights.squares);
  const double scale = root / weights.total;
  return {.term = {rate * scale, speed * scale, root * p.sense, -load * scale, root},
          .variance = {rate_variance * scale * scale, load_variance * scale * scale},
          .motor_Nm = motor * scale,
          .time_s = 0.5 * (s.time_s[last] + s.time_s[p.begin]),
          .duration_s = span,
          .load_kgm2 = s.load_kgm2,
          .flow = p.flow,
          .sense = p.sense,
          .windup_rad = s.windup_rad.empty() ? std::nullopt : std::optional(windup / weights.total),
          .windup_drifts = s.windup_drifts,
          .session = s.session,
          .log = s.log};
}

double median_samples(const std::vector<std::vector<MotionPiece>>& pieces) {
  std::vector<double> lengths;
  for (const auto& of_stretch : pieces) {
    for (const MotionPiece& p : of_stretch) lengths.push_back(static_cast<double>(p.end - p.begin));
  }
  if (lengths.empty()) return 0.0;
  return numerics::upper_median(std::move(lengths));
}

}  // namespace

namespace {

/// The pieces of every stretch.
std::vector<std::vector<MotionPiece>> all_pieces(const MotionRecord& record,
                                                 const DriveParameters& drive) {
  std::vector<StretchSigns> signs;
  signs.reserve(record.stretches.size());
  double mesh = 0.0, speed = 0.0, count = 0.0;
  for (const MotionStretch& s : record.stretches) {
    signs.push_back(stretch_signs(s, drive));
    mesh += signs.back().mesh_square;
    speed += signs.back().speed_square;
    count += static_cast<double>(signs.back().count);
  }
  if (count == 0.0) return {};
  const double still = kStillShare * std::sqrt(speed / count);
  const double doubt = kDoubtShare * std::sqrt(mesh / count);
  std::vector<std::vector<MotionPiece>> pieces;
  pieces.reserve(signs.size());
  for (const StretchSigns& s : signs) pieces.push_back(motion_pieces(s, still, doubt));
  return pieces;
}

}  // namespace

std::vector<TorqueSample> torque_samples(const MotionRecord& record, const DriveParameters& drive,
                                         std::size_t most) {
  const auto pieces = all_pieces(record, drive);
  std::size_t longest = 0;
  for (std::size_t k = 0; k < record.stretches.size(); ++k) {
    if (record.stretches[k].time_s.size() > record.stretches[longest].time_s.size()) longest = k;
  }
  std::vector<TorqueSample> samples;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const MotionStretch& s = record.stretches[k];
    const bool summed = s.angle_rad.empty();
    if (summed && k != longest) continue;
    std::vector<double> angle = s.angle_rad;
    for (std::size_t j = 0; summed && j < s.time_s.size(); ++j) {
      angle.push_back(j == 0 ? 0.0
                             : angle.back() + 0.5 * (s.speed_rad_s[j] + s.speed_rad_s[j - 1]) *
                                                  (s.time_s[j] - s.time_s[j - 1]));
    }
    for (const MotionPiece& p : pieces[k]) {
      const auto beta = drive_coefficients(drive, p.flow, s.load_kgm2);
      for (std::size_t j = p.begin; j < p.end && samples.size() < most; ++j) {
        const LocalMotion m = local_motion(s, j);
        const double load = s.load_Nm.empty() ? 0.0 : s.load_Nm[j];
        samples.push_back({.angle_rad = angle[j],
                           .speed_rad_s = m.speed,
                           .left_Nm = s.motor_Nm[j] - beta[0] * m.acceleration - beta[1] * m.speed -
                                      beta[2] * p.sense + beta[3] * load});
        if (j < p.begin + kHalfWidth || j + kHalfWidth >= p.end) continue;
        samples.back().even_Nm = even_residual(s, j, p.sense, beta);
        samples.back().half_s = 0.5 * (s.time_s[j + kHalfWidth] - s.time_s[j - kHalfWidth]);
      }
    }
  }
  return samples;
}

double window_residual(const MotionWindow& window, const DriveParameters& drive) {
  const auto beta = drive_coefficients(drive, window.flow, window.load_kgm2);
  double left = window.motor_Nm;
  for (std::size_t j = 0; j < 4; ++j) left -= beta.at(j) * window.term.at(j);
  return left / window.term[4];
}

std::vector<MotionWindow> motion_windows(const MotionRecord& record, const DriveParameters& drive) {
  const std::vector<std::vector<MotionPiece>> pieces = all_pieces(record, drive);
  double samples = 0.0;
  for (const auto& of_stretch : pieces) {
    for (const MotionPiece& p : of_stretch) samples += static_cast<double>(p.end - p.begin);
  }
  const double length =
      std::clamp(std::min(median_samples(pieces) / kWindowsPerPiece, samples / kFewestWindows),
                 static_cast<double>(kFewestSamples), static_cast<double>(kMostSamples));
  std::vector<MotionWindow> windows;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const MotionStretch& s = record.stretches[k];
    const StretchNoise noise{
        .motion = noise_deviation(s.time_s, s.speed_rad_s.empty() ? s.angle_rad : s.speed_rad_s),
        .load = noise_deviation(s.time_s, s.load_Nm)};
    for (const MotionPiece& p : pieces[k]) {
      const std::size_t size = p.end - p.begin;
      const auto parts =
          static_cast<std::size_t>(std::max(1.0, std::floor(static_cast<double>(size) / length)));
      for (std::size_t j = 0; j < parts; ++j) {
        MotionPiece part = p;
        part.begin = p.begin + j * size / parts;
        // Neighbours share a sample, which has no weight in either.
        part.end = std::min(p.begin + (j + 1) * size / parts + 1, p.end);
        windows.push_back(window_of(s, part, noise));
        windows.back().follows = j > 0;
      }
    }
  }
  return windows;
}

}  // namespace gear3k::calibrate
