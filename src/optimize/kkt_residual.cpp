#include "optimize/kkt_residual.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "optimize/gradients.hpp"
#include "optimize/nonnegative_least_squares.hpp"
#include "optimize/solve_outcome.hpp"

namespace gear3k::optimize {

namespace {

constexpr double kActive = 1e-6;
/// A smaller residual needs no kink to explain it.
constexpr double kSmoothResidual = 1e-5;
/// How far from the point the gradients of a kink are met.
constexpr double kKinkReach = 1e-6;
/// Gradients that differ by more than this, relatively, are of two sides of a kink.
constexpr double kKinkShare = 1e-4;
/// A step along one side of a kink, and the share of the decrease it foretells that shows a
/// descent.
constexpr double kSideStep = 1e-5, kSideDescent = 0.1;

using Columns = std::vector<Eigen::VectorXd>;

Eigen::MatrixXd side_by_side(const Columns& first, const Columns& second, Eigen::Index rows) {
  Eigen::MatrixXd a(rows, static_cast<Eigen::Index>(first.size() + second.size()));
  Eigen::Index j = 0;
  for (const Columns* columns : {&first, &second}) {
    for (const Eigen::VectorXd& column : *columns) a.col(j++) = column;
  }
  return a;
}

/// The gradients at a point, and those on the other sides of kinks beside it.
class PointGradients {
 public:
  PointGradients(const RefinementProblem& p, const Point& v)
      : problem_(p), v_(v), n_(static_cast<std::size_t>(p.variables)), rows_(all_rows(p)) {
    if (!evaluate_gradients(p, {v.data(), n_}, rows_, at_)) return;
    defined_ = true;
    objective_ = vector_at(at_.df.data());
    for (std::size_t k = 0; k < at_.g.size(); ++k) {
      if (at_.g[k] <= kActive) pulls_.push_back(row_gradient(at_, k));
    }
    for (std::size_t k = 0; k < n_; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      if (v[k] - p.lower[k] <= kActive) pulls_.push_back(Eigen::VectorXd::Unit(size(), axis));
      if (p.upper[k] - v[k] <= kActive) pulls_.push_back(-Eigen::VectorXd::Unit(size(), axis));
    }
  }
  [[nodiscard]] bool defined() const { return defined_; }

  /// What is left of a gradient of the objective.
  [[nodiscard]] Eigen::VectorXd left_of(const Eigen::VectorXd& gradient) const {
    const Eigen::MatrixXd a = side_by_side(pulls_, {}, size());
    return gradient - a * nonnegative_least_squares(a, gradient);
  }
  [[nodiscard]] double residual() const { return left_of(objective_).norm(); }

  void meet_other_sides() {
    Gradients beside;
    Point w = v_;
    for (std::size_t k = 0; k < n_; ++k) {
      for (const double step : {-kKinkReach, kKinkReach}) {
        w[k] = std::clamp(v_[k] + step, problem_.lower[k], problem_.upper[k]);
        if (evaluate_gradients(problem_, {w.data(), n_}, rows_, beside)) meet(beside);
      }
      w[k] = v_[k];
    }
  }
  /// Of the best mean of the sides; that of the point alone where a side descends.
  [[nodiscard]] double residual_of_sides() const {
    Columns towards;
    towards.reserve(sides_.size());
    for (const Eigen::VectorXd& side : sides_) towards.emplace_back(objective_ - side);
    const Eigen::MatrixXd a = side_by_side(towards, pulls_, size());
    const Eigen::VectorXd weights = nonnegative_least_squares(a, objective_);
    const bool is_mean = weights.head(static_cast<Eigen::Index>(sides_.size())).sum() <= 1.0;
    if (!is_mean || descends(objective_) ||
        std::ranges::any_of(sides_, [&](const auto& side) { return descends(side); })) {
      return residual();
    }
    return (objective_ - a * weights).norm();
  }

 private:
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(n_); }
  [[nodiscard]] Eigen::VectorXd vector_at(const double* values) const {
    return Eigen::Map<const Eigen::VectorXd>(values, size());
  }
  [[nodiscard]] Eigen::VectorXd row_gradient(const Gradients& g, std::size_t row) const {
    return vector_at(g.dg.data() + row * n_);
  }
  static bool differs(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return (a - b).norm() > kKinkShare * (1.0 + b.norm());
  }
  static void add_new(const Eigen::VectorXd& gradient, Columns& columns) {
    if (std::ranges::all_of(columns, [&](const auto& old) { return differs(gradient, old); })) {
      columns.push_back(gradient);
    }
  }
  void meet(const Gradients& beside) {
    const Eigen::VectorXd gradient = vector_at(beside.df.data());
    if (differs(gradient, objective_)) add_new(gradient, sides_);
    for (std::size_t k = 0; k < at_.g.size(); ++k) {
      if (at_.g[k] <= kActive) add_new(row_gradient(beside, k), pulls_);
    }
  }
  /// Whether the objective falls where a gradient, less what the rows take of it, says so.
  [[nodiscard]] bool descends(const Eigen::VectorXd& gradient) const {
    const Eigen::VectorXd left = left_of(gradient);
    const double slope = left.norm();
    if (!(slope > 0.0)) return false;
    Point w = v_;
    for (std::size_t k = 0; k < n_; ++k) {
      w[k] = std::clamp(v_[k] - kSideStep * left[static_cast<Eigen::Index>(k)] / slope,
                        problem_.lower[k], problem_.upper[k]);
    }
    const SolveOutcome outcome = outcome_at(problem_, w);
    return outcome.violation <= kActive &&
           at_.f - outcome.objective > kSideDescent * kSideStep * slope;
  }

  const RefinementProblem& problem_;
  const Point& v_;
  std::size_t n_;
  std::vector<std::uint16_t> rows_;
  Gradients at_;
  bool defined_ = false;
  Eigen::VectorXd objective_;
  Columns pulls_;  ///< gradients of active rows, on all sides that were met, and of bounds
  Columns sides_;  ///< of the objective, other than objective_
};

}  // namespace

double kkt_residual(const RefinementProblem& p, const Point& v) {
  PointGradients gradients(p, v);
  if (!gradients.defined()) return std::numeric_limits<double>::quiet_NaN();
  const double smooth = gradients.residual();
  if (smooth <= kSmoothResidual) return smooth;
  gradients.meet_other_sides();
  return std::min(smooth, gradients.residual_of_sides());
}

}  // namespace gear3k::optimize
