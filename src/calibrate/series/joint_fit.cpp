#include "calibrate/series/joint_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/fit/columns.hpp"
#include "calibrate/search/free_shapes.hpp"
#include "numerics/linear_algebra.hpp"
#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

Eigen::VectorXd vector_of(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// The bracket of JointFit::score at deviations τ, with the best μ.
double deviance_at(const std::vector<Eigen::VectorXd>& value,
                   const std::vector<Eigen::MatrixXd>& information, const Eigen::VectorXd& tau) {
  const Eigen::Index p = tau.size();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(p);
  double squares = 0.0;
  double log_ratio = 0.0;
  for (std::size_t u = 0; u < value.size(); ++u) {
    // With M = C⁻¹ and R = T^½: (C + T)⁻¹ = M − M R (I + R M R)⁻¹ R M, |C + T|/|C| = |I + R M R|.
    const Eigen::MatrixXd& m = information[u];
    const Eigen::MatrixXd rm = tau.asDiagonal() * m;
    Eigen::MatrixXd inner = rm * tau.asDiagonal();
    inner.diagonal().array() += 1.0;
    Eigen::MatrixXd solved(p, p);
    for (Eigen::Index k = 0; k < p; ++k)
      solved.col(k) = numerics::solve_symmetric(inner, rm.col(k));
    const Eigen::MatrixXd w = m - rm.transpose() * solved;
    sum += w;
    const Eigen::VectorXd wy = w * value[u];
    moment += wy;
    squares += value[u].dot(wy);
    log_ratio += numerics::symmetric_eigenvalues(inner).array().max(1e-300).log().sum();
  }
  // In units in which every mean is determined equally well.
  const Eigen::VectorXd unit = sum.diagonal().unaryExpr(
      [](double weight) { return weight > 0.0 ? 1.0 / std::sqrt(weight) : 1.0; });
  const Eigen::VectorXd scaled_moment = unit.cwiseProduct(moment);
  const Eigen::VectorXd mean =
      numerics::least_norm_solution(unit.asDiagonal() * sum * unit.asDiagonal(), scaled_moment);
  return std::max(0.0, squares - scaled_moment.dot(mean)) + log_ratio;
}

void judge(const SeriesUnit& unit, UnitFit& f) {
  const Columns at = columns_at(unit.problem, f.fit.hypothesis, {}, f.scale);
  const double rows = static_cast<double>(at.residual.size());
  const double squares = std::max(f.fit.sum_of_squares * f.scale * f.scale, 1e-300);
  const double degrees = std::max(1.0, rows - static_cast<double>(at.own.cols()));
  const double known = unit.problem.noise.known_scale();
  const double variance = known > 0.0 ? known * known : squares / degrees;
  f.scale = std::max(std::sqrt(variance), unit.problem.noise.least_scale());
  f.information = at.own.transpose() * at.own / (f.scale * f.scale);
}

}  // namespace

double random_effects_deviance(const std::vector<Eigen::VectorXd>& value,
                               const std::vector<Eigen::MatrixXd>& information) {
  const Eigen::Index p = value.front().size();
  if (p == 0) return 0.0;
  // Deviations to start at: those of the values, errors and all; by what each says of them.
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(p, 1e-300);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(p);
  for (std::size_t u = 0; u < value.size(); ++u) {
    weights += information[u].diagonal();
    mean += information[u].diagonal().cwiseProduct(value[u]);
  }
  mean = mean.cwiseQuotient(weights);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(p);
  for (std::size_t u = 0; u < value.size(); ++u) {
    spread += information[u].diagonal().cwiseProduct((value[u] - mean).cwiseAbs2());
  }
  spread = spread.cwiseQuotient(weights);
  spread = spread.cwiseSqrt();
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(p);
  double best = deviance_at(value, information, tau);
  constexpr int kSweeps = 5;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double before = best;
    for (Eigen::Index k = 0; k < p; ++k) {
      const double now = tau[k];
      for (const double factor : {0.0, 0.5, 0.75, 0.9, 1.0, 1.1, 1.4, 2.0}) {
        Eigen::VectorXd trial = tau;
        trial[k] = factor * (now > 0.0 ? now : spread[k]);
        const double deviance = deviance_at(value, information, trial);
        if (deviance < best) {
          best = deviance;
          tau = trial;
        }
      }
    }
    constexpr double kEnough = 0.01;
    if (before - best < kEnough) break;
  }
  return best;
}

JointStart unfitted(const std::deque<SeriesUnit>& units) {
  JointStart start;
  std::vector<double> all;
  for (const SeriesUnit& unit : units) {
    const Columns at = columns_at(unit.problem, {}, {}, 0.0);
    all.insert(all.end(), at.raw.begin(), at.raw.end());
  }
  const double scale = robust_deviation(vector_of(all));
  for (const SeriesUnit& unit : units) {
    const NoiseModel& noise = unit.problem.noise;
    start.hypothesis.emplace_back();
    start.scale.push_back(std::max({scale, noise.known_scale(), noise.least_scale()}));
  }
  return start;
}

JointStart start_at(const JointFit& fit) {
  JointStart start;
  for (const UnitFit& unit : fit.units) {
    start.hypothesis.push_back(unit.fit.hypothesis);
    start.scale.push_back(unit.scale);
  }
  return start;
}

JointStart start_with(JointStart start, const Candidate& candidate) {
  for (Hypothesis& h : start.hypothesis) h = with(std::move(h), candidate);
  return start;
}

JointStart start_without(JointStart start, std::size_t effect) {
  for (Hypothesis& h : start.hypothesis) h = without(h, effect);
  return start;
}

JointFit joint_fit(const std::deque<SeriesUnit>& units, const JointStart& start) {
  JointFit result;
  result.effects = start.hypothesis.front().effects;
  result.units.resize(units.size());
  numerics::parallel_for(
      units.size(),
      [&](std::size_t u) {
        UnitFit& f = result.units[u];
        f.scale = start.scale[u];
        f.fit = fit(units[u].problem, start.hypothesis[u], f.scale);
        judge(units[u], f);
      },
      has_many_rows(units));
  std::vector<Eigen::VectorXd> value;
  std::vector<Eigen::MatrixXd> information;
  double rows = 0.0;
  for (std::size_t u = 0; u < units.size(); ++u) {
    const UnitFit& f = result.units[u];
    const auto n = static_cast<double>(f.fit.residual.size());
    rows += n;
    const double squares = std::max(f.fit.sum_of_squares * start.scale[u] * start.scale[u], 1e-300);
    // Of the σ² of the information; rounding bounds it, and with it what a fit can gain.
    const double variance = f.scale * f.scale;
    result.score += n * std::log(variance) + squares / variance;
    value.push_back(vector_of(f.fit.hypothesis.value));
    information.push_back(f.information);
  }
  result.score += random_effects_deviance(value, information);
  result.score += static_cast<double>(value.front().size()) *
                  (std::log(rows) + std::log(static_cast<double>(units.size())));
  // The level of friction is a parameter, and preferred at a tie: by e^1.5 and χ² 4, as in the
  // search of one gearbox.
  constexpr double kOfParameter = 3.5;
  for (const Candidate& c : result.effects) {
    const bool parameter = c.cause->remedy == Remedy::kFrictionValue;
    result.score -= 2.0 * (log_weight_of(c) + (parameter ? kOfParameter : 0.0));
  }
  if (!std::isfinite(result.score)) result.score = std::numeric_limits<double>::infinity();
  return result;
}

}  // namespace gear3k::calibrate
