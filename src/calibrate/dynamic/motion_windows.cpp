#include "calibrate/dynamic/motion_windows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numerics/square.hpp"

namespace gear3k::calibrate {

namespace {

using numerics::square;

constexpr std::size_t kHalfWidth = 6;       // samples on each side of a line that tells the flow
constexpr std::size_t kFewestSamples = 12;  // of a window
constexpr std::size_t kMostSamples = 400;   // of a window
constexpr double kWindowsPerPiece = 2.0;    // of the piece of median length
constexpr double kFewestWindows = 100.0;    // where the samples are enough
constexpr double kDoubtDeviations = 3.0;    // within which a sign is in doubt
constexpr double kDoubtShare = 0.03;        // of the root mean square of the mesh's torque
constexpr double kStillShare = 0.02;  // of the root mean square speed: in doubt whether it turns

/// Standard deviation of white noise on a smooth signal, by third differences (variance 20 σ²).
double noise_deviation(const std::vector<double>& x) {
  if (x.size() < 8) return 0.0;
  double sum = 0.0;
  for (std::size_t k = 3; k < x.size(); ++k) {
    sum += square(x[k] - 3.0 * x[k - 1] + 3.0 * x[k - 2] - x[k - 3]);
  }
  return std::sqrt(sum / (20.0 * static_cast<double>(x.size() - 3)));
}

/// Speed and acceleration at a sample by lines (of an angle: parabolas) through its neighbours.
struct LocalMotion {
  double speed = 0.0, acceleration = 0.0;
};

LocalMotion local_motion(const MotionStretch& s, std::size_t k, std::size_t half) {
  const bool angle = s.speed_rad_s.empty();
  const std::vector<double>& x = angle ? s.angle_rad : s.speed_rad_s;
  double n = 0.0, t2 = 0.0, t4 = 0.0, y0 = 0.0, y1 = 0.0, y2 = 0.0;
  const double scale = s.time_s[k + half] - s.time_s[k - half];
  double t1 = 0.0, t3 = 0.0;
  for (std::size_t j = k - half; j <= k + half; ++j) {
    const double t = (s.time_s[j] - s.time_s[k]) / scale, y = x[j] - x[k];
    n += 1.0;
    t1 += t;
    t2 += t * t;
    t3 += t * t * t;
    t4 += t * t * t * t;
    y0 += y;
    y1 += t * y;
    y2 += t * t * y;
  }
  if (!angle) {
    const double slope = (n * y1 - t1 * y0) / (n * t2 - t1 * t1);
    return {.speed = x[k] + (y0 - slope * t1) / n, .acceleration = slope / scale};
  }
  // Evenly spaced within a stretch to a good part: t1 and t3 are about 0.
  const double curve = (n * y2 - t2 * y0) / (n * t4 - t2 * t2);
  const double slope = (y1 - curve * t3) / t2;
  return {.speed = slope / scale, .acceleration = 2.0 * curve / (scale * scale)};
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

double mean_step(const MotionStretch& s) {
  return (s.time_s.back() - s.time_s.front()) / static_cast<double>(s.time_s.size() - 1);
}

StretchSigns stretch_signs(const MotionStretch& s, const DriveParameters& d) {
  StretchSigns r;
  const std::size_t n = s.time_s.size();
  r.speed.assign(n, std::numeric_limits<double>::quiet_NaN());
  r.mesh = r.speed;
  if (n < 2 * kHalfWidth + 2) return r;
  const double inertia = d.output_inertia_kgm2 + s.load_kgm2;
  for (std::size_t k = kHalfWidth; k + kHalfWidth < n; ++k) {
    const LocalMotion m = local_motion(s, k, kHalfWidth);
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
    ++r.count;
  }
  const double width = static_cast<double>(2 * kHalfWidth + 1), dt = mean_step(s);
  const double moment = width * (width * width - 1.0) / 12.0;  // Σ j²
  double slope_noise = 0.0;
  if (s.speed_rad_s.empty()) {
    const double noise = noise_deviation(s.angle_rad);
    const double fourth = width * (width * width - 1.0) * (3.0 * width * width - 7.0) / 240.0;
    slope_noise = 2.0 * noise / (dt * dt) / std::sqrt(fourth - moment * moment / width);
    r.speed_doubt = kDoubtDeviations * noise / (dt * std::sqrt(moment));
  } else {
    const double noise = noise_deviation(s.speed_rad_s);
    slope_noise = noise / (dt * std::sqrt(moment));
    r.speed_doubt = kDoubtDeviations * noise / std::sqrt(width);
  }
  const double load_noise = noise_deviation(s.load_Nm) / std::sqrt(width);
  r.mesh_doubt = kDoubtDeviations * std::hypot(inertia * slope_noise, load_noise);
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
  double total = 0.0;
};

/// Makes weights blind to what is constant (to angles: moving evenly too), and right for an even
/// rise, whatever the sampling.
/// @param rise  signal of which the weights must give `total`
void settle_weights(std::vector<double>& weights, const std::vector<double>& phi,
                    const std::vector<double>& rise, double total) {
  double sum = 0.0, gain = 0.0;
  for (const double w : weights) sum += w;
  for (std::size_t k = 0; k < phi.size(); ++k) {
    weights[k] -= phi[k] * sum / total;
    gain += weights[k] * rise[k];
  }
  for (double& w : weights) w *= total / gain;
}

WindowWeights window_weights(const MotionStretch& s, const MotionPiece& p) {
  const bool angle = s.speed_rad_s.empty();
  const double half = 0.5 * (s.time_s[p.end - 1] - s.time_s[p.begin]);
  const double middle = s.time_s[p.begin] + half;
  WindowWeights r;
  std::vector<double> line, parabola;
  for (std::size_t k = p.begin; k < p.end; ++k) {
    const double before = k > p.begin ? s.time_s[k - 1] : s.time_s[k];
    const double after = k + 1 < p.end ? s.time_s[k + 1] : s.time_s[k];
    const double dt = 0.5 * (after - before), t = s.time_s[k] - middle, x = t / half;
    const double rest = std::max(0.0, 1.0 - x * x);
    const double phi = (angle ? rest * rest * rest * rest : rest * rest * rest) * dt;
    r.total += phi;
    r.phi.push_back(phi);
    line.push_back(t);
    parabola.push_back(0.5 * t * t);
    if (angle) {
      r.speed.push_back(8.0 * x * rest * rest * rest / half * dt);
      r.rate.push_back((48.0 * x * x * rest * rest - 8.0 * rest * rest * rest) / (half * half) *
                       dt);
    } else {
      r.rate.push_back(6.0 * x * rest * rest / half * dt);
    }
  }
  settle_weights(r.rate, r.phi, angle ? parabola : line, r.total);
  if (angle) {
    settle_weights(r.speed, r.phi, line, r.total);
  } else {
    r.speed = r.phi;
  }
  return r;
}

MotionWindow window_of(const MotionStretch& s, const MotionPiece& p, const StretchNoise& noise) {
  const WindowWeights weights = window_weights(s, p);
  const bool angle = s.speed_rad_s.empty();
  const std::vector<double>& signal = angle ? s.angle_rad : s.speed_rad_s;
  // Of an angle the even part is taken off first, as its weights sum to 0 for even sampling only.
  const std::size_t last = p.end - 1;
  const double span = s.time_s[last] - s.time_s[p.begin];
  const double even = angle ? (signal[last] - signal[p.begin]) / span : 0.0;
  double motor = 0.0, speed = 0.0, rate = 0.0, load = 0.0;
  double rate_variance = 0.0, load_variance = 0.0;
  for (std::size_t j = 0; j < weights.phi.size(); ++j) {
    const std::size_t k = p.begin + j;
    const double value =
        angle ? signal[k] - signal[p.begin] - even * (s.time_s[k] - s.time_s[p.begin]) : signal[k];
    motor += weights.phi[j] * s.motor_Nm[k];
    if (!s.load_Nm.empty()) load += weights.phi[j] * s.load_Nm[k];
    speed += weights.speed[j] * value;
    rate += weights.rate[j] * value;
    load_variance += square(weights.phi[j] * noise.load);
    rate_variance += square(weights.rate[j] * noise.motion);
  }
  speed += even * weights.total;
  const double root = std::sqrt(static_cast<double>(p.end - p.begin));
  const double scale = root / weights.total;
  return {.term = {rate * scale, speed * scale, root * p.sense, -load * scale, root},
          .variance = {rate_variance * scale * scale, load_variance * scale * scale},
          .motor_Nm = motor * scale,
          .time_s = 0.5 * (s.time_s[last] + s.time_s[p.begin]),
          .duration_s = span,
          .load_kgm2 = s.load_kgm2,
          .flow = p.flow,
          .sense = p.sense};
}

double median_samples(const std::vector<std::vector<MotionPiece>>& pieces) {
  std::vector<double> lengths;
  for (const auto& of_stretch : pieces) {
    for (const MotionPiece& p : of_stretch) lengths.push_back(static_cast<double>(p.end - p.begin));
  }
  if (lengths.empty()) return 0.0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

}  // namespace

std::vector<MotionWindow> motion_windows(const MotionRecord& record, const DriveParameters& drive) {
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
        .motion = noise_deviation(s.speed_rad_s.empty() ? s.angle_rad : s.speed_rad_s),
        .load = noise_deviation(s.load_Nm)};
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
