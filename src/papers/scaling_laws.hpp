#pragma once
// Power laws of motors and gearboxes, fitted to makers' tables.

#include <optional>
#include <string>
#include <vector>

namespace gear3k::papers {

/// One frame of a series.
struct ScalingPoint {
  std::string series;
  double y = 0.0;
  std::vector<double> x{};  ///< one or two factors, > 0
  std::string frame{};      ///< rows of one frame are not independent; empty: a frame of its own
};

/// A factor of a law with the exponents that the paper and its corrected equations give it.
struct ScalingFactor {
  std::string name, symbol;
  std::optional<double> paper{}, equations{};
  double exponent = 0.0, band = 0.0;  ///< fitted, and half of its 95 % band
};

struct ScalingLaw {
  std::string name{};      ///< as in files: motor_inertia, ...
  std::string quantity{};  ///< y
  std::string unit{};      ///< of y
  std::string source{};    ///< where the paper has it
  std::string data{};      ///< what it is fitted to
  std::vector<ScalingFactor> factors{};
  struct Series {
    std::string name;
    double intercept;  ///< ln y = intercept + Σ exponent ln x
  };
  std::vector<Series> series{};  ///< in the order of their first points
  std::size_t frames = 0;        ///< of the points, those that are independent
  double scatter = 0.0;          ///< standard deviation of ln y about the law
  std::vector<ScalingPoint> points{};
};

/// Fits a law with one intercept per series.
///
///   ln y = b_series + Σ_k e_k ln x_k,  least squares;  band = t_{0.975, ν} s_k,
///   ν = points − series − factors
///
/// Where frames have several points, s_k by frame: with d the deviations of ln x from their means
/// of the series, r the residuals, A = Σ d dᵀ, G frames, n points and p = series + factors,
///
///   s² = G/(G − 1) (n − 1)/(n − p) A⁻¹ Σ_frames g gᵀ A⁻¹,  g = Σ_frame d r,  ν = G − 1
///
/// Source: linear regression with common slopes, own derivation: deviations from the means of the
/// series leave the slopes' normal equations; the covariance that heeds clusters is White's of sums
/// over them.
/// Valid: one or two factors.
/// @throws std::invalid_argument for other numbers of factors, without a degree of freedom, or
///         where the factors do not vary independently
void fit(ScalingLaw& law);

/// What a fitted law gives at a point of one of its series.
double fitted_value(const ScalingLaw& law, const ScalingPoint& point);

/// One row per frame: of windings of the same frame the one with the largest torque.
struct MotorFrame {
  std::string series;
  double inertia_kgm2, torque_Nm;                  ///< torque: continuous, K_t I at nominal current
  std::optional<double> diameter_m{}, length_m{};  ///< of a frameless motor
};
struct PlanetaryFrame {
  std::string series;  ///< maker and number of stages
  double mass_kg, torque_Nm;
};
struct PlanetaryGearbox {
  std::string series;
  double ratio, input_inertia_kgm2, torque_Nm;  ///< torque: intermittent
  std::string frame;                            ///< the same of all its ratios
};
struct StrainWaveFrame {
  /// Torque: rated.
  double radius_m, torque_Nm, first_stiffness_Nm_rad, last_stiffness_Nm_rad;
};
struct ScalingTables {
  std::vector<MotorFrame> motors;
  std::vector<PlanetaryFrame> planetary_frames;
  std::vector<PlanetaryGearbox> planetary;
  std::vector<StrainWaveFrame> strain_waves;
};

/// The paper's laws as far as the tables reach.
std::vector<ScalingLaw> scaling_laws(const ScalingTables& tables, double fig9_exponent);

}  // namespace gear3k::papers
