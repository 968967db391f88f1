#pragma once
// One set of causes in all gearboxes of a series, with values for each of them.

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "calibrate/fit/fit.hpp"
#include "calibrate/series/units.hpp"

namespace gear3k::calibrate {

/// A set of causes as fitted in one gearbox.
struct UnitFit {
  Fit fit;
  Eigen::MatrixXd information;  ///< inverse of the covariance of the values, Jᵀ J/σ²
  double scale = 0.0;           ///< standard deviation of the whitened rows about the fit
};

/// A set of causes, fitted in each gearbox by itself.
struct JointFit {
  std::vector<Candidate> effects;
  std::vector<UnitFit> units;
  /// −2 ln of its likelihood with random effects, less what its causes weigh, plus what its
  /// parameters cost; the less the better:
  ///
  ///   Σ_u (n_u ln σ_u² + S_u/σ_u²) + min over μ, T of Σ_u [(θ_u − μ)ᵀ (C_u + T)⁻¹ (θ_u − μ) + ln
  ///   |C_u + T|/|C_u|]
  ///     + p (ln Σ n_u + ln U) − 2 Σ ln w
  ///
  /// θ_u, C_u: values and their covariance in gearbox u, T = diag(τ_j²): a parameter costs as one
  /// mean and one deviation, and a value for each gearbox only where they differ.  S_u: squares
  /// left; σ_u²: their variance S_u/(n_u − p) that C_u is made with, or the known one.
  double score = 0.0;
};

/// The fits at which a gearbox's values start; scales of the whitened rows by which outliers count.
struct JointStart {
  std::vector<Hypothesis> hypothesis;
  std::vector<double> scale;
};

/// Of values at 0, with one scale for all gearboxes unless they state theirs: the robust deviation
/// of what the simulation misses.
JointStart unfitted(const std::deque<SeriesUnit>& units);
/// From a fit's values and scales on.
JointStart start_at(const JointFit& fit);
JointStart start_with(JointStart start, const Candidate& candidate);
JointStart start_without(JointStart start, std::size_t effect);

/// Fits each gearbox; in parallel where there are many rows.
JointFit joint_fit(const std::deque<SeriesUnit>& units, const JointStart& start);

/// min over μ, T of the bracket above: what the values of the gearboxes say against one value for
/// all, or against one deviation.
double random_effects_deviance(const std::vector<Eigen::VectorXd>& value,
                               const std::vector<Eigen::MatrixXd>& information);

}  // namespace gear3k::calibrate
