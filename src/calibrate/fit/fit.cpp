#include "calibrate/fit/fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <span>

#include "calibrate/model/levelled_responses.hpp"
#include "numerics/linear_algebra.hpp"
#include "numerics/parallel.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kSlots = kMaxVariables;
/// From here on rows are simulated in parallel.
constexpr Eigen::Index kManyRows = 2000;

/// Candidates that one pass of derivatives carries.
struct Pass {
  /// As many parameters of a candidate as the pass had room for.
  struct Part {
    std::size_t candidate;
    std::vector<Scalar> values;  ///< of all its parameters: 0, the part's with a slot each
    Eigen::Index first, count;   ///< of the candidate's parameters
    int slot;                    ///< of the first
  };
  std::vector<Part> parts;
  int used = 0;

  bool add(const std::vector<Candidate>& candidates, std::size_t k, Eigen::Index first,
           Eigen::Index count) {
    const Candidate& candidate = candidates[k];
    const bool clash =
        candidate.cause->exclusive_forms && std::ranges::any_of(parts, [&](const Part& other) {
          return candidates[other.candidate].cause == candidate.cause;
        });
    if (clash || used + count > kSlots) return false;
    std::vector<Scalar> p(candidate.parameters.size(), Scalar(0.0));
    for (Eigen::Index j = 0; j < count; ++j) {
      p[static_cast<std::size_t>(first + j)] = Scalar(0.0, used + static_cast<int>(j));
    }
    parts.push_back(
        {.candidate = k, .values = std::move(p), .first = first, .count = count, .slot = used});
    used += static_cast<int>(count);
    return true;
  }
};

/// Passes that together carry all candidates of a place.
std::vector<Pass> make_passes(const std::vector<Candidate>& candidates, Place place) {
  std::vector<Pass> passes;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    // A friction that differs by row is read row by row, whatever the cause.
    const Place own =
        changes_row_friction(candidates[k]) ? Place::kMeasurement : candidates[k].cause->place;
    if (own != place) continue;
    const auto all = static_cast<Eigen::Index>(candidates[k].parameters.size());
    for (Eigen::Index first = 0; first < all; first += kSlots) {
      const Eigen::Index count = std::min<Eigen::Index>(kSlots, all - first);
      const bool found =
          std::ranges::any_of(passes, [&](Pass& p) { return p.add(candidates, k, first, count); });
      if (found) continue;
      passes.emplace_back();
      passes.back().add(candidates, k, first, count);
    }
  }
  return passes;
}

/// The gearbox under a hypothesis, in any row.
Modification gearbox_under(const Simulation& simulation, const Hypothesis& h,
                           const std::vector<Scalar>& values) {
  Modification m = simulation.unmodified({});
  apply(h, values, {}, simulation.kind(), m);
  return m;
}

/// Levels of friction that a hypothesis gives the rows, or a model under the simulation.
template <class ReadingUnder>
LevelRange levels_of(const Problem& problem, const Hypothesis& h,
                     const ReadingUnder& reading_under) {
  LevelRange levels;
  if (!problem.simulation.has_models() && std::ranges::none_of(h.effects, changes_row_friction)) {
    return levels;
  }
  const auto constants = constants_of(h.value);
  for (const Observation& row : problem.data.rows) {
    const double level = reading_under(constants, row.condition).friction_level.a;
    if (level != 1.0) levels.include(level);
  }
  // A hypothesis at 1 has derivatives by the level all the same.
  if (std::ranges::any_of(h.effects, changes_row_friction)) levels.include(1.0);
  return levels;
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
  const auto constants = constants_of(hypothesis.value);
  const Kind kind = simulation.kind();
  const auto reading_under = [&](std::span<const Scalar> values, const Condition& condition) {
    Modification m = simulation.unmodified(condition);
    apply_to_reading(hypothesis, values, condition, kind, m);
    return m;
  };
  const LevelRange levels = levels_of(problem, hypothesis, reading_under);
  const auto for_rows = [&](const auto& work) {
    constexpr Eigen::Index kChunk = 512;
    numerics::parallel_for(
        static_cast<std::size_t>((n + kChunk - 1) / kChunk),
        [&](std::size_t chunk) {
          const Eigen::Index first = static_cast<Eigen::Index>(chunk) * kChunk;
          for (Eigen::Index i = first; i < std::min(n, first + kChunk); ++i) work(i);
        },
        n > kManyRows);
  };

  // The hypothesis itself, as many parameters at a time as a Scalar has slots.
  std::atomic<bool> all_run = true;
  for (Eigen::Index begin = 0; begin == 0 || begin < own_count; begin += kSlots) {
    const auto variables = variables_of(hypothesis.value, static_cast<std::size_t>(begin));
    const LevelledResponses own(problem.states, simulation,
                                gearbox_under(simulation, hypothesis, variables), levels);
    const Eigen::Index slots = std::min<Eigen::Index>(kSlots, own_count - begin);
    for_rows([&](Eigen::Index i) {
      const auto at = static_cast<std::size_t>(i);
      const Condition& condition = rows[at].condition;
      const Modification reading = reading_under(variables, condition);
      const std::optional<Scalar> response = own.of_row(at, reading.friction_level);
      if (!response) {
        all_run = false;
        return;
      }
      const Scalar y = simulation.reading(*response, condition, reading);
      result.simulated[i] = y.a;
      if (slots > 0) result.own.row(i).segment(begin, slots) = y.v.head(slots).transpose();
    });
  }
  result.runs = all_run;
  if (others.empty()) return result;

  // The others beside it, each at 0.
  const auto in_gearbox = make_passes(others, Place::kGearbox);
  const auto in_reading = make_passes(others, Place::kMeasurement);
  const auto add_pass = [&](const Pass& pass, const Condition& condition, Modification& m) {
    for (const Pass::Part& part : pass.parts) {
      const Candidate& c = others[part.candidate];
      c.cause->apply(c.form, part.values, condition, kind, m);
    }
  };
  const Modification known = gearbox_under(simulation, hypothesis, constants);
  LevelRange with_others = levels;
  if (std::ranges::any_of(others, changes_row_friction)) with_others.include(1.0);
  const LevelledResponses plain(problem.states, simulation, known, with_others);
  std::vector<LevelledResponses> of_pass;
  of_pass.reserve(in_gearbox.size());
  for (const Pass& pass : in_gearbox) {
    Modification m = known;
    add_pass(pass, {}, m);
    of_pass.emplace_back(problem.states, simulation, m, levels);
  }
  for_rows([&](Eigen::Index i) {
    const auto at = static_cast<std::size_t>(i);
    const Condition& condition = rows[at].condition;
    const auto store = [&](const Pass& pass, const Scalar& y) {
      for (const Pass::Part& part : pass.parts) {
        result.other.row(i).segment(first_column[part.candidate] + part.first, part.count) =
            y.v.segment(part.slot, part.count).transpose();
      }
    };
    const Modification reading = reading_under(constants, condition);
    for (std::size_t k = 0; k < in_gearbox.size(); ++k) {
      const std::optional<Scalar> response = of_pass[k].of_row(at, reading.friction_level);
      if (!response) continue;
      Modification m = reading;
      // Of pairs a loss beside the mesh is read with it.
      if (kind == Kind::kPairLoss) add_pass(in_gearbox[k], condition, m);
      store(in_gearbox[k], simulation.reading(*response, condition, m));
    }
    for (const Pass& pass : in_reading) {
      Modification m = reading;
      add_pass(pass, condition, m);
      const std::optional<Scalar> response = plain.by_level(at, m.friction_level);
      if (response) store(pass, simulation.reading(*response, condition, m));
    }
  });
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
  // A linearisation says nothing of values further away: at an end of its range a factor of
  // friction may make the gearbox lock, where no derivative leads back.
  constexpr double kMostOfRange = 0.25;
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
        const double most = kMostOfRange * (record.upper - record.lower);
        const double moved = value + std::clamp(share * change[k], -most, most);
        value = std::clamp(moved, record.lower, record.upper);
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

}  // namespace

namespace {

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

}  // namespace

Eigen::MatrixXd inverse_normal(const Problem& problem, const Hypothesis& h) {
  return ScaledNormal(step_at(problem, h).jacobian).inverse();
}

FinalFit final_fit(const Problem& problem, const Hypothesis& start, double scale) {
  FinalFit result;
  result.hypothesis = start;
  const auto records = parameters_of(start);
  const auto p = static_cast<Eigen::Index>(records.size());
  const auto n = static_cast<Eigen::Index>(problem.data.rows.size());
  result.degrees = static_cast<int>(n - p);
  result.at_bound.assign(records.size(), false);
  result.beyond.assign(records.size(), 0.0);
  result.determined.assign(records.size(), true);
  // Ceres knows no correlated rows: where sessions scatter or the noise remembers, the search's fit
  // is the last one.
  if (p > 0 && !(problem.noise.session_variance > 0.0) && !problem.noise.remembers()) {
    std::vector<double> values = start.value;
    RowsAt rows(problem, start, values);
    ceres::Problem::Options ownership;
    ownership.evaluation_callback = &rows;
    ceres::Problem ceres_problem(ownership);
    ceres_problem.AddParameterBlock(values.data(), static_cast<int>(p));
    for (Eigen::Index i = 0; i < n; ++i) {
      ceres_problem.AddResidualBlock(
          std::make_unique<RowCost>(rows, static_cast<std::size_t>(i), scale, static_cast<int>(p))
              .release(),
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
    const ScaledNormal normal(step.jacobian);
    const Eigen::MatrixXd inverse = normal.inverse();
    const Eigen::VectorXd free_step = inverse * (step.jacobian.transpose() * psi);
    for (std::size_t k = 0; k < records.size(); ++k) {
      const double change = free_step[static_cast<Eigen::Index>(k)];
      if (result.at_bound[k] && leaves(records[k], result.hypothesis.value[k], change)) {
        result.beyond[k] = change;
      }
    }
    // The projection on what the rows determine; what rounding leaves of the rest has an inverse
    // beyond all digits.
    constexpr double kMostInverse = 1e10;
    const Eigen::VectorXd share = (normal.scaled_inverse * normal.scaled).diagonal();
    for (std::size_t k = 0; k < records.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      result.determined[k] = share[i] > 1.0 - 1e-6 && normal.scaled_inverse(i, i) < kMostInverse;
    }
    result.covariance =
        0.5 * result.scale * result.scale * (inverse + Eigen::MatrixXd(inverse.transpose()));
    if (!result.scale_is_known) {
      const Eigen::VectorXd wider = widening(step.jacobian, inverse, psi / std::max(inside, 0.5),
                                             result.scale * result.scale);
      result.covariance = wider.asDiagonal() * result.covariance * wider.asDiagonal();
    }
  }
  return result;
}

}  // namespace gear3k::calibrate
