#include "calibrate/fit/fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kSlots = kMaxVariables;
/// From here on rows are simulated in parallel.
constexpr Eigen::Index kManyRows = 2000;

/// Candidates that one pass of derivatives carries.
struct Pass {
  std::vector<std::size_t> index;           // of the candidates
  std::vector<std::vector<Scalar>> values;  // 0 with a derivative slot each
  std::vector<int> first_slot;
  int used = 0;

  bool add(const std::vector<Candidate>& candidates, std::size_t k) {
    const Candidate& candidate = candidates[k];
    const auto count = static_cast<int>(candidate.parameters.size());
    const bool clash =
        candidate.cause->exclusive_forms && std::ranges::any_of(index, [&](std::size_t other) {
          return candidates[other].cause == candidate.cause;
        });
    if (clash || used + count > kSlots) return false;
    std::vector<Scalar> p;
    p.reserve(static_cast<std::size_t>(count));
    for (int j = 0; j < count; ++j) p.emplace_back(0.0, used + j);
    index.push_back(k);
    values.push_back(std::move(p));
    first_slot.push_back(used);
    used += count;
    return true;
  }
};

/// Passes that together carry all candidates of a place.
std::vector<Pass> make_passes(const std::vector<Candidate>& candidates, Place place) {
  std::vector<Pass> passes;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (candidates[k].cause->place != place) continue;
    const bool found = std::ranges::any_of(passes, [&](Pass& p) { return p.add(candidates, k); });
    if (found) continue;
    passes.emplace_back();
    passes.back().add(candidates, k);
  }
  return passes;
}

std::optional<Scalar> simulate(const Problem& problem, const Condition& condition,
                               const Hypothesis& h, const std::vector<Scalar>& own) {
  const Simulation& simulation = problem.simulation;
  Modification m = simulation.unmodified(condition);
  apply(h, own, condition, simulation.kind(), m);
  const auto response = simulation.response(condition, m);
  if (!response) return std::nullopt;
  return simulation.reading(*response, condition, m);
}

}  // namespace

Eigen::VectorXd measured(const MeasurementSet& data) {
  Eigen::VectorXd y(static_cast<Eigen::Index>(data.rows.size()));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    y[static_cast<Eigen::Index>(i)] = data.rows[i].response;
  }
  return y;
}

Eigen::VectorXd winsorised(Eigen::VectorXd residual, double scale) {
  const double bound = kWinsor * scale;
  if (bound > 0.0) residual = residual.cwiseMax(-bound).cwiseMin(bound);
  return residual;
}

Linearisation linearise(const Problem& problem, const Hypothesis& hypothesis,
                        const std::vector<Candidate>& others) {
  const Simulation& simulation = problem.simulation;
  const auto& rows = problem.data.rows;
  const auto n = static_cast<Eigen::Index>(rows.size());
  const auto own_count = static_cast<Eigen::Index>(hypothesis.value.size());
  Eigen::Index other_count = 0;
  std::vector<Eigen::Index> first_column;
  first_column.reserve(others.size());
  for (const Candidate& c : others) {
    first_column.push_back(other_count);
    other_count += static_cast<Eigen::Index>(c.parameters.size());
  }
  Linearisation result{.simulated = Eigen::VectorXd::Zero(n),
                       .own = Eigen::MatrixXd::Zero(n, own_count),
                       .other = Eigen::MatrixXd::Zero(n, other_count)};
  const auto variables = variables_of(hypothesis.value);
  const auto constants = constants_of(hypothesis.value);
  const auto in_gearbox = make_passes(others, Place::kGearbox);
  const auto in_reading = make_passes(others, Place::kMeasurement);
  bool all_run = true;
#pragma omp parallel for schedule(static) reduction(&& : all_run) if (n > kManyRows)
  for (Eigen::Index i = 0; i < n; ++i) {
    const Condition& condition = rows[static_cast<std::size_t>(i)].condition;
    const auto row = [&](const std::vector<Scalar>& own, const Pass* pass, bool reading_only,
                         const Scalar& known) -> std::optional<Scalar> {
      Modification m = simulation.unmodified(condition);
      apply(hypothesis, own, condition, simulation.kind(), m);
      for (std::size_t k = 0; pass != nullptr && k < pass->index.size(); ++k) {
        const Candidate& c = others[pass->index[k]];
        c.cause->apply(c.form, pass->values[k], condition, simulation.kind(), m);
      }
      if (reading_only) return simulation.reading(known, condition, m);
      const auto response = simulation.response(condition, m);
      if (!response) return std::nullopt;
      return simulation.reading(*response, condition, m);
    };
    const auto store = [&](const Pass& pass, const Scalar& y) {
      for (std::size_t k = 0; k < pass.index.size(); ++k) {
        const auto count = static_cast<Eigen::Index>(pass.values[k].size());
        result.other.row(i).segment(first_column[pass.index[k]], count) =
            y.v.segment(pass.first_slot[k], count).transpose();
      }
    };
    const auto y = row(variables, nullptr, false, Scalar(0.0));
    if (!y) {
      all_run = false;
      continue;
    }
    result.simulated[i] = y->a;
    result.own.row(i) = y->v.head(own_count).transpose();
    for (const Pass& pass : in_gearbox) {
      if (const auto z = row(constants, &pass, false, Scalar(0.0))) store(pass, *z);
    }
    if (in_reading.empty()) continue;
    Modification m = simulation.unmodified(condition);
    apply(hypothesis, constants, condition, simulation.kind(), m);
    const auto response = simulation.response(condition, m);
    for (const Pass& pass : in_reading) store(pass, *row(constants, &pass, true, *response));
  }
  result.runs = all_run;
  return result;
}

namespace {

struct Step {
  Eigen::VectorXd residual;  // whitened, winsorised
  Eigen::MatrixXd jacobian;  // whitened
  Linearisation at;
};

Step step_at(const Problem& problem, const Hypothesis& h) {
  Step step{.residual = {}, .jacobian = {}, .at = linearise(problem, h, {})};
  Eigen::MatrixXd columns(step.at.own.rows(), step.at.own.cols() + 1);
  columns << measured(problem.data) - step.at.simulated, step.at.own;
  problem.noise.whiten(columns);
  step.residual = columns.col(0);
  step.jacobian = columns.rightCols(step.at.own.cols());
  return step;
}

/// Whether a parameter stands at a bound that a step would cross.
bool leaves(const ParameterRecord& record, double value, double step) {
  return (value <= record.lower && step < 0.0) || (value >= record.upper && step > 0.0);
}

/// Gauss-Newton step of the parameters that are free to move: those at a bound that the step would
/// take across it stay there, and the others are solved for without them.
Eigen::VectorXd step_inside(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                            const std::vector<ParameterRecord>& records,
                            const std::vector<double>& value) {
  const Eigen::Index p = jacobian.cols();
  std::vector<bool> held(records.size(), false);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(p);
  for (bool again = true; again;) {
    std::vector<Eigen::Index> free;
    free.reserve(records.size());
    for (Eigen::Index k = 0; k < p; ++k) {
      if (!held[static_cast<std::size_t>(k)]) free.push_back(k);
    }
    change.setZero();
    if (free.empty()) break;
    change(free) = numerics::least_squares(jacobian(Eigen::all, free), residual);
    again = false;
    for (const Eigen::Index k : free) {
      const auto i = static_cast<std::size_t>(k);
      if (!leaves(records[i], value[i], change[k])) continue;
      held[i] = true;
      again = true;
    }
  }
  return change;
}

double robust_sum(const Eigen::VectorXd& residual, double scale) {
  double sum = 0.0;
  for (const double r : residual) sum += huber_square(r / scale);
  return sum;
}

}  // namespace

double huber_square(double deviations) {
  const double u = std::abs(deviations);
  return u <= kWinsor ? u * u : kWinsor * (2.0 * u - kWinsor);
}

Fit fit(const Problem& problem, Hypothesis start, double scale) {
  const auto records = parameters_of(start);
  const auto p = static_cast<Eigen::Index>(records.size());
  Fit result;
  result.hypothesis = std::move(start);
  Step step = step_at(problem, result.hypothesis);
  double best = step.at.runs ? robust_sum(step.residual, scale) : HUGE_VAL;
  // Rows far off move a fit by a few deviations a pass only.
  constexpr int kPasses = 60;
  constexpr double kSmall = 1e-4;
  for (int pass = 0; pass < kPasses && p > 0; ++pass) {
    // Far from the fit all rows are off: they are no outliers yet, and clipped they would hold it
    // back.
    const double wide = std::max(scale, robust_deviation(step.residual));
    const Eigen::VectorXd psi = winsorised(step.residual, wide);
    const Eigen::VectorXd change =
        step_inside(step.jacobian, psi, records, result.hypothesis.value);
    bool improved = false;
    double share = 1.0;
    for (int half = 0; half < 6 && !improved; ++half, share *= 0.5) {
      Hypothesis next = result.hypothesis;
      for (Eigen::Index k = 0; k < p; ++k) {
        auto& value = next.value[static_cast<std::size_t>(k)];
        const auto& record = records[static_cast<std::size_t>(k)];
        value = std::clamp(value + share * change[k], record.lower, record.upper);
      }
      Step trial = step_at(problem, next);
      const double sum = trial.at.runs ? robust_sum(trial.residual, scale) : HUGE_VAL;
      if (!(sum <= best)) continue;
      improved = best - sum > kSmall;
      best = sum;
      result.hypothesis = std::move(next);
      step = std::move(trial);
      break;
    }
    if (!improved) break;
  }
  result.simulated = step.at.simulated;
  result.residual = step.residual;
  result.sum_of_squares = best;
  return result;
}

namespace {

/// A row of the data as Ceres sees it; the rows are independent (sessions without scatter).
class RowCost : public ceres::CostFunction {
 public:
  RowCost(const Problem& problem, const Hypothesis& h, std::size_t row, double scale)
      : problem_(problem), h_(h), row_(row), scale_(scale) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(h.value.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const std::vector<double> values(parameters[0], parameters[0] + h_.value.size());
    const Observation& row = problem_.data.rows[row_];
    const auto y = simulate(problem_, row.condition, h_, variables_of(values));
    if (!y) return false;
    const double weight = problem_.noise.weight[static_cast<Eigen::Index>(row_)] / scale_;
    residuals[0] = weight * (row.response - y->a);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      for (std::size_t k = 0; k < h_.value.size(); ++k) {
        jacobians[0][k] = -weight * y->v[static_cast<Eigen::Index>(k)];
      }
    }
    return true;
  }

 private:
  const Problem& problem_;
  const Hypothesis& h_;
  std::size_t row_;
  double scale_;
};

}  // namespace

FinalFit final_fit(const Problem& problem, const Hypothesis& start, double scale) {
  FinalFit result;
  result.hypothesis = start;
  const auto records = parameters_of(start);
  const auto p = static_cast<Eigen::Index>(records.size());
  const auto n = static_cast<Eigen::Index>(problem.data.rows.size());
  result.degrees = static_cast<int>(n - p);
  result.at_bound.assign(records.size(), false);
  // Ceres knows no correlated rows: where sessions scatter, the search's fit is the last one.
  if (p > 0 && !(problem.noise.session_variance > 0.0)) {
    std::vector<double> values = start.value;
    ceres::Problem::Options ownership;
    ceres::Problem ceres_problem(ownership);
    ceres_problem.AddParameterBlock(values.data(), static_cast<int>(p));
    for (Eigen::Index i = 0; i < n; ++i) {
      ceres_problem.AddResidualBlock(
          std::make_unique<RowCost>(problem, start, static_cast<std::size_t>(i), scale).release(),
          std::make_unique<ceres::HuberLoss>(kWinsor).release(), values.data());
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
    if (summary.IsSolutionUsable()) result.hypothesis.value = values;
    // Ceres cuts a step at the bounds without solving again for the parameters that are free, and
    // ends short of the best of them.
    bool bounded = false;
    for (std::size_t k = 0; k < records.size(); ++k) {
      const double value = result.hypothesis.value[k];
      bounded = bounded || value <= records[k].lower || value >= records[k].upper;
    }
    if (bounded) result.hypothesis = fit(problem, result.hypothesis, scale).hypothesis;
  }
  const Step step = step_at(problem, result.hypothesis);
  result.simulated = step.at.simulated;
  const Eigen::VectorXd psi = winsorised(step.residual, scale);
  // Huber's proposal: variance of ψ over the square of the share of rows inside.
  double inside = 0.0;
  for (const double r : step.residual) inside += std::abs(r) <= kWinsor * scale ? 1.0 : 0.0;
  inside /= static_cast<double>(std::max<Eigen::Index>(n, 1));
  const double degrees = std::max(1, result.degrees);
  result.scale = std::max(std::sqrt(psi.squaredNorm() / degrees) / std::max(inside, 0.5),
                          problem.noise.least_scale());
  if (const double known = problem.noise.known_scale(); known > 0.0) {
    result.scale = known;
    result.scale_is_known = true;
  }
  for (std::size_t k = 0; k < records.size(); ++k) {
    const double margin = 1e-6 * (records[k].upper - records[k].lower);
    const double value = result.hypothesis.value[k];
    result.at_bound[k] = value <= records[k].lower + std::min(margin, 1e-9) ||
                         value >= records[k].upper - std::min(margin, 1e-9);
  }
  if (p > 0) {
    const Eigen::MatrixXd normal = step.jacobian.transpose() * step.jacobian;
    result.covariance = numerics::pseudo_inverse(normal) * (result.scale * result.scale);
  }
  return result;
}

}  // namespace gear3k::calibrate
