#include "papers/scaling_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "numerics/distributions.hpp"

namespace gear3k::papers {

namespace {

/// Logarithms of a point: y, then one or two factors.
using Logarithms = std::array<double, 3>;

struct SeriesMean {
  Logarithms mean{};
  double count = 0.0;
};

Logarithms logarithms_of(const ScalingPoint& p) {
  Logarithms logs{std::log(p.y)};
  for (std::size_t k = 0; k < p.x.size(); ++k) logs[k + 1] = std::log(p.x[k]);
  return logs;
}

std::size_t series_of(const ScalingLaw& law, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(law.series, name, &ScalingLaw::Series::name) -
                                  law.series.begin());
}

/// Means of the logarithms of every series, which it appends to the law.
std::vector<SeriesMean> series_means(ScalingLaw& law) {
  std::vector<SeriesMean> means;
  for (const ScalingPoint& p : law.points) {
    const std::size_t at = series_of(law, p.series);
    if (at == law.series.size()) {
      law.series.push_back({.name = p.series, .intercept = 0.0});
      means.emplace_back();
    }
    const Logarithms logs = logarithms_of(p);
    for (std::size_t k = 0; k < logs.size(); ++k) means[at].mean[k] += logs[k];
    means[at].count += 1.0;
  }
  for (SeriesMean& m : means) {
    for (double& value : m.mean) value /= m.count;
  }
  return means;
}

/// Inverse of the normal equations' matrix; of one factor, its reciprocal alone.
struct Inverse {
  double a11, a12, a22;
};

Inverse inverse_of(double s11, double s12, double s22, bool two) {
  const double determinant = two ? s11 * s22 - s12 * s12 : s11;
  if (!(determinant > 1e-12 * (two ? s11 * s22 : 1e-300))) {
    throw std::invalid_argument("scaling law: its factors do not vary independently");
  }
  if (!two) return {.a11 = 1.0 / s11, .a12 = 0.0, .a22 = 0.0};
  return {.a11 = s22 / determinant, .a12 = -s12 / determinant, .a22 = s11 / determinant};
}

/// Sums of residual times deviation of each factor, by frame.
class FrameScores {
 public:
  void add(const std::string& frame, double of_first, double of_second) {
    const auto at = frame.empty() ? names_.end() : std::ranges::find(names_, frame);
    const auto k = static_cast<std::size_t>(at - names_.begin());
    if (at == names_.end()) {
      names_.push_back(frame);
      sums_.push_back({});
    }
    sums_[k][0] += of_first;
    sums_[k][1] += of_second;
  }
  [[nodiscard]] std::size_t frames() const { return sums_.size(); }
  /// Diagonal of factor A⁻¹ Σ g gᵀ A⁻¹.
  [[nodiscard]] std::array<double, 2> variances(const Inverse& a, double factor) const {
    std::array<double, 2> result{};
    for (const auto& g : sums_) {
      const double first = a.a11 * g[0] + a.a12 * g[1];
      const double second = a.a12 * g[0] + a.a22 * g[1];
      result[0] += factor * first * first;
      result[1] += factor * second * second;
    }
    return result;
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::array<double, 2>> sums_;
};

}  // namespace

void fit(ScalingLaw& law) {
  const std::size_t factors = law.factors.size();
  if (factors < 1 || factors > 2) {
    throw std::invalid_argument(
        fmt::format("scaling law {}: {} factors, allowed: 1 or 2", law.name, factors));
  }
  law.series.clear();
  const std::vector<SeriesMean> means = series_means(law);
  std::array<std::array<double, 3>, 3> sums{};  // of products of deviations
  for (const ScalingPoint& p : law.points) {
    const Logarithms logs = logarithms_of(p);
    const Logarithms& mean = means[series_of(law, p.series)].mean;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) sums[i][j] += (logs[i] - mean[i]) * (logs[j] - mean[j]);
    }
  }
  const double freedom =
      static_cast<double>(law.points.size()) - static_cast<double>(law.series.size() + factors);
  if (!(freedom >= 1.0)) {
    throw std::invalid_argument(fmt::format("scaling law {}: {} points in {} series: too few",
                                            law.name, law.points.size(), law.series.size()));
  }
  const Inverse inverse = inverse_of(sums[1][1], sums[1][2], sums[2][2], factors == 2);
  const std::array<double, 2> exponent{inverse.a11 * sums[0][1] + inverse.a12 * sums[0][2],
                                       inverse.a12 * sums[0][1] + inverse.a22 * sums[0][2]};
  double squares = 0.0;
  FrameScores scores;
  for (const ScalingPoint& p : law.points) {
    const Logarithms logs = logarithms_of(p);
    const Logarithms& mean = means[series_of(law, p.series)].mean;
    const std::array<double, 2> of_factors{logs[1] - mean[1], logs[2] - mean[2]};
    const double rest =
        logs[0] - mean[0] - exponent[0] * of_factors[0] - exponent[1] * of_factors[1];
    squares += rest * rest;
    scores.add(p.frame, rest * of_factors[0], rest * of_factors[1]);
  }
  law.scatter = std::sqrt(squares / freedom);
  law.frames = scores.frames();
  const bool alone = law.frames == law.points.size();
  const auto frames = static_cast<double>(law.frames);
  const auto points = static_cast<double>(law.points.size());
  const double quantile = numerics::student_quantile(0.975, alone ? freedom : frames - 1.0);
  const std::array<double, 2> variance =
      alone ? std::array{law.scatter * law.scatter * inverse.a11,
                         law.scatter * law.scatter * inverse.a22}
            : scores.variances(inverse, frames / (frames - 1.0) * (points - 1.0) / freedom);
  for (std::size_t k = 0; k < factors; ++k) {
    law.factors[k].exponent = exponent[k];
    law.factors[k].band = quantile * std::sqrt(variance[k]);
  }
  for (std::size_t k = 0; k < means.size(); ++k) {
    const Logarithms& mean = means[k].mean;
    law.series[k].intercept = mean[0] - exponent[0] * mean[1] - exponent[1] * mean[2];
  }
}

double fitted_value(const ScalingLaw& law, const ScalingPoint& point) {
  double logarithm = law.series.at(series_of(law, point.series)).intercept;
  for (std::size_t k = 0; k < law.factors.size(); ++k) {
    logarithm += law.factors[k].exponent * std::log(point.x[k]);
  }
  return std::exp(logarithm);
}

namespace {

constexpr const char* kMegaflux = "Allied Motion Megaflux";
// With T ~ L d^2.5 (eq. 35) and J ~ L d^4 (eq. 23) at L ~ d: J ~ T^(5/3.5).
constexpr double kInertiaOverTorque = 5.0 / 3.5;

ScalingFactor factor(const char* name, std::optional<double> paper,
                     std::optional<double> equations) {
  struct Symbol {
    const char *name, *symbol;
  };
  constexpr std::array<Symbol, 6> kSymbols{{{"diameter", "d"},
                                            {"length", "L"},
                                            {"torque", "T"},
                                            {"mass", "m"},
                                            {"ratio", "i"},
                                            {"radius", "r"}}};
  const auto* const at = std::ranges::find(kSymbols, std::string_view(name), &Symbol::name);
  return {.name = name,
          .symbol = at == kSymbols.end() ? name : at->symbol,
          .paper = paper,
          .equations = equations};
}

/// Eqs. 35 and 36 are of the stall torque, which the catalogue has not: the continuous one, K_t
/// times the nominal current, takes its place.
void append_frameless_motors(const std::vector<MotorFrame>& motors, std::vector<ScalingLaw>& laws) {
  ScalingLaw inertia{.name = "motor_inertia",
                     .quantity = "rotor inertia",
                     .unit = "kg m2",
                     .source = "eq. 23 (eq. 22: L d^3)",
                     .data = kMegaflux,
                     .factors = {factor("diameter", 4.0, {}), factor("length", 1.0, {})}};
  ScalingLaw torque{.name = "motor_torque",
                    .quantity = "continuous torque",
                    .unit = "N m",
                    .source = "eq. 35 (stall torque)",
                    .data = kMegaflux,
                    .factors = {factor("diameter", 2.5, {}), factor("length", 1.0, {})}};
  ScalingLaw quotient{.name = "motor_torque_per_inertia",
                      .quantity = "torque over inertia",
                      .unit = "1/s2",
                      .source = "eq. 36 (stall torque)",
                      .data = kMegaflux,
                      .factors = {factor("diameter", -1.5, -1.5), factor("length", 0.0, 0.0)}};
  for (const MotorFrame& m : motors) {
    if (!m.diameter_m || m.series != kMegaflux) continue;
    const std::vector<double> size{*m.diameter_m, *m.length_m};
    inertia.points.push_back({.series = m.series, .y = m.inertia_kgm2, .x = size});
    torque.points.push_back({.series = m.series, .y = m.torque_Nm, .x = size});
    quotient.points.push_back({.series = m.series, .y = m.torque_Nm / m.inertia_kgm2, .x = size});
  }
  laws.push_back(std::move(inertia));
  laws.push_back(std::move(torque));
  laws.push_back(std::move(quotient));
}

/// Fig. 9 takes 2.5 times the nominal torque for that of acceleration, which leaves the exponent.
void append_motor_inertia(const std::vector<MotorFrame>& motors, double paper,
                          std::vector<ScalingLaw>& laws) {
  ScalingLaw all{.name = "motor_inertia_over_torque",
                 .quantity = "rotor inertia",
                 .unit = "kg m2",
                 .source = "Fig. 9 (2.5 nominal torque)",
                 .data = "motor catalogue",
                 .factors = {factor("torque", paper, kInertiaOverTorque)}};
  for (const MotorFrame& m : motors) {
    all.points.push_back({.series = m.series, .y = m.inertia_kgm2, .x = {m.torque_Nm}});
  }
  laws.push_back(std::move(all));
}

void append_planetary(const ScalingTables& tables, std::vector<ScalingLaw>& laws) {
  // T ~ L d^2 (what eqs. 20 and 27 come from) is T ~ mass at one density.
  ScalingLaw torque{.name = "planetary_torque",
                    .quantity = "intermittent torque",
                    .unit = "N m",
                    .source = "eqs. 20, 27",
                    .data = "planetary catalogue",
                    .factors = {factor("mass", 1.0, {})}};
  for (const PlanetaryFrame& p : tables.planetary_frames) {
    torque.points.push_back({.series = p.series, .y = p.torque_Nm, .x = {p.mass_kg}});
  }
  // J/T ~ d^2 i^2 and, for similar shapes, T ~ d^3: J ~ T^(5/3) i^2.
  ScalingLaw inertia{.name = "planetary_inertia",
                     .quantity = "inertia at the output",
                     .unit = "kg m2",
                     .source = "eq. 27",
                     .data = "planetary catalogue",
                     .factors = {factor("torque", 5.0 / 3.0, {}), factor("ratio", 2.0, {})}};
  for (const PlanetaryGearbox& p : tables.planetary) {
    inertia.points.push_back({.series = p.series,
                              .y = p.ratio * p.ratio * p.input_inertia_kgm2,
                              .x = {p.torque_Nm, p.ratio},
                              .frame = p.frame});
  }
  laws.push_back(std::move(torque));
  laws.push_back(std::move(inertia));
}

void append_strain_waves(const std::vector<StrainWaveFrame>& frames,
                         std::vector<ScalingLaw>& laws) {
  constexpr const char* kSeries = "Schaeffler RT1, i = 100";
  // The catalogue has the rated torque, and none for acceleration.
  const auto add = [&](ScalingLaw law, auto y, auto x) {
    law.data = kSeries;
    for (const StrainWaveFrame& f : frames) {
      law.points.push_back({.series = kSeries, .y = f.*y, .x = {f.*x}});
    }
    laws.push_back(std::move(law));
  };
  using Frame = StrainWaveFrame;
  add({.name = "strain_wave_torque",
       .quantity = "rated torque",
       .unit = "N m",
       .source = "eq. 29",
       .factors = {factor("radius", 3.0, {})}},
      &Frame::torque_Nm, &Frame::radius_m);
  // Eq. 25 as printed L d^4, as eq. 18 gives it d^4/L; similar shapes.
  add({.name = "strain_wave_stiffness",
       .quantity = "stiffness K1",
       .unit = "N m/rad",
       .source = "eq. 25",
       .factors = {factor("radius", 5.0, 3.0)}},
      &Frame::first_stiffness_Nm_rad, &Frame::radius_m);
  add({.name = "strain_wave_last_stiffness",
       .quantity = "stiffness K3",
       .unit = "N m/rad",
       .source = "eq. 25",
       .factors = {factor("radius", 5.0, 3.0)}},
      &Frame::last_stiffness_Nm_rad, &Frame::radius_m);
  // Eq. 31 as printed K/T ~ L d, corrected d/L; similar shapes have T ~ d^3.
  add({.name = "stiffness_over_torque",
       .quantity = "stiffness K3",
       .unit = "N m/rad",
       .source = "Fig. 8 (acceleration torque; eq. 31: 5/3)",
       .factors = {factor("torque", 1.0, 1.0)}},
      &Frame::last_stiffness_Nm_rad, &Frame::torque_Nm);
}

}  // namespace

std::vector<ScalingLaw> scaling_laws(const ScalingTables& tables, double fig9_exponent) {
  std::vector<ScalingLaw> laws;
  append_frameless_motors(tables.motors, laws);
  append_motor_inertia(tables.motors, fig9_exponent, laws);
  append_planetary(tables, laws);
  append_strain_waves(tables.strain_waves, laws);
  for (ScalingLaw& law : laws) fit(law);
  return laws;
}

}  // namespace gear3k::papers
