#include "calibrate/fit/final_fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

/// All rows at the values that Ceres asks for.
class RowsAt : public ceres::EvaluationCallback {
 public:
  RowsAt(const Problem& problem, const Hypothesis& h, const std::vector<double>& values)
      : problem_(problem), h_(h), values_(values) {}
  void PrepareForEvaluation(bool, bool new_evaluation_point) override {
    if (!new_evaluation_point && at_.simulated.size() > 0) return;
    h_.value = values_;
    at_ = linearise(problem_, h_, {});
  }
  [[nodiscard]] const Linearisation& at() const { return at_; }
  [[nodiscard]] const Problem& problem() const { return problem_; }

 private:
  const Problem& problem_;
  Hypothesis h_;
  const std::vector<double>& values_;
  Linearisation at_{.simulated = {}, .own = {}, .other = {}};
};

/// A row of the data as Ceres sees it; the rows are independent (sessions without scatter).
class RowCost : public ceres::CostFunction {
 public:
  RowCost(const RowsAt& rows, std::size_t row, double scale, int parameters)
      : rows_(rows), row_(row), scale_(scale) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(parameters);
  }
  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const Linearisation& at = rows_.at();
    if (!at.runs) return false;
    const auto i = static_cast<Eigen::Index>(row_);
    const double weight = rows_.problem().noise.weight[i] / scale_;
    residuals[0] = weight * (rows_.problem().data.rows[row_].response - at.simulated[i]);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      for (Eigen::Index k = 0; k < at.own.cols(); ++k) jacobians[0][k] = -weight * at.own(i, k);
    }
    return true;
  }

 private:
  const RowsAt& rows_;
  std::size_t row_;
  double scale_;
};

/// From a fit on, by Ceres inside the bounds.
Hypothesis fit_by_ceres(const Problem& problem, const Hypothesis& start,
                        const std::vector<ParameterRecord>& records, double scale) {
  Hypothesis result = start;
  std::vector<double> values = start.value;
  const int p = static_cast<int>(values.size());
  RowsAt rows(problem, start, values);
  ceres::Problem::Options ownership;
  ownership.evaluation_callback = &rows;
  ceres::Problem ceres_problem(ownership);
  ceres_problem.AddParameterBlock(values.data(), p);
  for (std::size_t i = 0; i < problem.data.rows.size(); ++i) {
    ceres_problem.AddResidualBlock(std::make_unique<RowCost>(rows, i, scale, p).release(),
                                   std::make_unique<ceres::HuberLoss>(kWinsor).release(),
                                   values.data());
  }
  for (int k = 0; k < p; ++k) {
    const auto& record = records[static_cast<std::size_t>(k)];
    ceres_problem.SetParameterLowerBound(values.data(), k, record.lower);
    ceres_problem.SetParameterUpperBound(values.data(), k, record.upper);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  options.max_num_iterations = 30;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  // Where no step goes downhill the start, a fit already, is the minimum; Ceres calls that a
  // failure.
  if (summary.IsSolutionUsable()) result.value = values;
  // Ceres cuts a step at the bounds without solving again for the parameters that are free, and
  // ends short of the best of them.
  bool bounded = false;
  for (std::size_t k = 0; k < records.size(); ++k) {
    bounded = bounded || result.value[k] <= records[k].lower || result.value[k] >= records[k].upper;
  }
  return bounded ? fit(problem, result, scale).hypothesis : result;
}

/// How much wider than the covariance of rows that scatter alike each parameter's deviation must be
/// for rows that scatter as their residuals do: √(C₃/C) with MacKinnon and White's estimate
/// C₃ = A⁻¹ (Σ Jᵢ Jᵢᵀ (ψᵢ/(1 − hᵢ))²) A⁻¹, A⁻¹ = C/s², leverage h = diag(J A⁻¹ Jᵀ).  Of rows that
/// scatter alike C₃ has the mean C Σ l²/(1 − h)/Σ l² and the deviation √(2 Σ l⁴)/Σ l² of C with the
/// rows l of J A⁻¹: 1 where it is not above the mean by one deviation.
Eigen::VectorXd widening(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& inverse,
                         const Eigen::VectorXd& psi, double variance) {
  constexpr double kMostLeverage = 0.9;
  const Eigen::MatrixXd lever = jacobian * inverse;  // row i: Jᵢᵀ A⁻¹
  const Eigen::ArrayXd leverage = lever.cwiseProduct(jacobian).rowwise().sum().array();
  const Eigen::ArrayXd deviation = psi.array() / (1.0 - leverage.min(kMostLeverage));
  const Eigen::VectorXd robust = (lever.array().colwise() * deviation).square().colwise().sum();
  Eigen::VectorXd result(inverse.cols());
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const double alike = variance * inverse(k, k);
    const Eigen::ArrayXd squares = lever.col(k).array().square();
    const double luck = std::sqrt(2.0 * squares.square().sum()) / squares.sum();
    constexpr double kClearly = 1.0;
    const double expected = (squares / (1.0 - leverage.min(kMostLeverage))).sum() / squares.sum();
    const double ratio = robust[k] / (alike * expected);
    result[k] = ratio > 1.0 + kClearly * luck ? std::sqrt(ratio * expected) : 1.0;
  }
  return result;
}

/// JᵀJ in units in which every parameter is determined equally well, and its pseudoinverse.
struct ScaledNormal {
  Eigen::VectorXd unit;
  Eigen::MatrixXd scaled, scaled_inverse;

  explicit ScaledNormal(const Eigen::MatrixXd& jacobian) {
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    unit = normal.diagonal().unaryExpr(
        [](double square) { return square > 0.0 ? 1.0 / std::sqrt(square) : 1.0; });
    scaled = unit.asDiagonal() * normal * unit.asDiagonal();
    scaled_inverse = numerics::pseudo_inverse(scaled);
  }
  [[nodiscard]] Eigen::MatrixXd inverse() const {
    return unit.asDiagonal() * scaled_inverse * unit.asDiagonal();
  }
};

/// Where each parameter stands in its range.
void set_bounds_met(FinalFit& result, const std::vector<ParameterRecord>& records) {
  for (std::size_t k = 0; k < records.size(); ++k) {
    const double margin = std::min(1e-6 * (records[k].upper - records[k].lower), 1e-9);
    const double value = result.hypothesis.value[k];
    result.at_bound[k] = value <= records[k].lower + margin || value >= records[k].upper - margin;
  }
}

/// Covariance, what the rows determine, and where they would have parameters at their bounds.
/// @param psi     residuals, winsorised
/// @param inside  share of the rows that are not
void set_covariance(FinalFit& result, const std::vector<ParameterRecord>& records,
                    const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& psi, double inside) {
  const ScaledNormal normal(jacobian);
  const Eigen::MatrixXd inverse = normal.inverse();
  const Eigen::VectorXd free_step = inverse * (jacobian.transpose() * psi);
  // The projection on what the rows determine; what rounding leaves of the rest has an inverse
  // beyond all digits.
  constexpr double kMostInverse = 1e10;
  const Eigen::VectorXd share = (normal.scaled_inverse * normal.scaled).diagonal();
  for (std::size_t k = 0; k < records.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (result.at_bound[k] && leaves_range(records[k], result.hypothesis.value[k], free_step[i])) {
      result.beyond[k] = free_step[i];
    }
    result.determined[k] = share[i] > 1.0 - 1e-6 && normal.scaled_inverse(i, i) < kMostInverse;
  }
  const double variance = result.scale * result.scale;
  result.covariance = 0.5 * variance * (inverse + Eigen::MatrixXd(inverse.transpose()));
  if (result.scale_is_known) return;
  const Eigen::VectorXd wider = widening(jacobian, inverse, psi / std::max(inside, 0.5), variance);
  result.covariance = wider.asDiagonal() * result.covariance * wider.asDiagonal();
}

}  // namespace

InverseNormal inverse_normal(const Problem& problem, const Hypothesis& h) {
  const ScaledNormal normal(whitened_rows(problem, h).jacobian);
  return {.variance = normal.inverse().diagonal(), .inflation = normal.scaled_inverse.diagonal()};
}

FinalFit final_fit(const Problem& problem, const Hypothesis& start, double scale) {
  FinalFit result;
  result.hypothesis = start;
  const auto records = parameters_of(start);
  const std::size_t n = problem.data.rows.size();
  result.degrees = static_cast<int>(n) - static_cast<int>(records.size());
  result.at_bound.assign(records.size(), false);
  result.beyond.assign(records.size(), 0.0);
  result.determined.assign(records.size(), true);
  // Ceres knows no correlated rows: where sessions scatter or the noise remembers, the search's fit
  // is the last one.
  if (!records.empty() && !(problem.noise.session_variance > 0.0) && !problem.noise.remembers()) {
    result.hypothesis = fit_by_ceres(problem, start, records, scale);
  }
  WhitenedRows rows = whitened_rows(problem, result.hypothesis);
  result.simulated = std::move(rows.simulated);
  const Eigen::VectorXd psi = winsorised(rows.residual, scale);
  // Huber's proposal: variance of ψ over the square of the share of rows inside.
  double inside = 0.0;
  for (const double r : rows.residual) inside += std::abs(r) <= kWinsor * scale ? 1.0 : 0.0;
  inside /= static_cast<double>(std::max<std::size_t>(n, 1));
  const double degrees = std::max(1, result.degrees);
  result.scale = std::max(std::sqrt(psi.squaredNorm() / degrees) / std::max(inside, 0.5),
                          problem.noise.least_scale());
  if (const double known = problem.noise.known_scale(); known > 0.0) {
    result.scale = known;
    result.scale_is_known = true;
  }
  set_bounds_met(result, records);
  if (!records.empty()) set_covariance(result, records, rows.jacobian, psi, inside);
  return result;
}

}  // namespace gear3k::calibrate
