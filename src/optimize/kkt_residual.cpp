#include "optimize/kkt_residual.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "optimize/nonnegative_least_squares.hpp"
#include "optimize/refined_set.hpp"

namespace gear3k::optimize {

namespace {

constexpr double kActive = 1e-6;
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
  PointGradients(const GradientFunction& function, std::span<const double> v,
                 std::span<const double> lower, std::span<const double> upper)
      : function_(function), v_(v.begin(), v.end()), lower_(lower), upper_(upper) {
    if (!function(v, at_)) return;
    defined_ = true;
    objective_ = vector_at(at_.df.data());
    for (std::size_t k = 0; k < at_.g.size(); ++k) {
      if (at_.g[k] <= kActive) pulls_.push_back(row_gradient(at_, k));
    }
    for (std::size_t k = 0; k < v_.size(); ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      if (v_[k] - lower[k] <= kActive) pulls_.push_back(Eigen::VectorXd::Unit(size(), axis));
      if (upper[k] - v_[k] <= kActive) pulls_.push_back(-Eigen::VectorXd::Unit(size(), axis));
    }
  }
  [[nodiscard]] bool defined() const { return defined_; }

  /// What the rows leave of a gradient of the objective.
  [[nodiscard]] Eigen::VectorXd left_of(const Eigen::VectorXd& gradient) const {
    const Eigen::MatrixXd a = side_by_side(pulls_, {}, size());
    return gradient - a * nonnegative_least_squares(a, gradient);
  }
  [[nodiscard]] double residual() const { return left_of(objective_).norm(); }

  void meet_other_sides() {
    Gradients beside;
    std::vector<double> w = v_;
    for (std::size_t k = 0; k < v_.size(); ++k) {
      for (const double step : {-kKinkReach, kKinkReach}) {
        w[k] = std::clamp(v_[k] + step, lower_[k], upper_[k]);
        if (function_(w, beside)) meet(beside);
      }
      w[k] = v_[k];
    }
  }
  /// Of the best mean of the sides; that of the point alone where a side descends.
  ///
  /// Non-negative least squares with one more row, w Σκ = w: as what is left grows in proportion to
  /// Σκ, the solution over its Σκ is the least one with Σκ = 1, whatever w is.
  [[nodiscard]] double residual_of_sides() const {
    Columns sides{objective_};
    sides.insert(sides.end(), sides_.begin(), sides_.end());
    if (std::ranges::any_of(sides, [&](const auto& side) { return descends(side); })) {
      return residual();
    }
    const auto count = static_cast<Eigen::Index>(sides.size());
    const Eigen::MatrixXd hull = side_by_side(sides, {}, size());
    const Eigen::MatrixXd cone = side_by_side(pulls_, {}, size());
    const double weight = hull.norm();
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size() + 1, count + cone.cols());
    a.topLeftCorner(size(), count) = hull;
    a.topRightCorner(size(), cone.cols()) = -cone;
    a.bottomLeftCorner(1, count).setConstant(weight);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size() + 1);
    b[size()] = weight;
    const Eigen::VectorXd x = nonnegative_least_squares(a, b);
    const double sum = x.head(count).sum();
    if (!(sum > 0.0)) return residual();
    return (a * x).head(size()).norm() / sum;
  }

 private:
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(v_.size()); }
  [[nodiscard]] Eigen::VectorXd vector_at(const double* values) const {
    return Eigen::Map<const Eigen::VectorXd>(values, size());
  }
  [[nodiscard]] Eigen::VectorXd row_gradient(const Gradients& g, std::size_t row) const {
    return vector_at(g.dg.data() + row * v_.size());
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
    std::vector<double> w = v_;
    for (std::size_t k = 0; k < w.size(); ++k) {
      w[k] = std::clamp(v_[k] - kSideStep * left[static_cast<Eigen::Index>(k)] / slope, lower_[k],
                        upper_[k]);
    }
    Gradients there;
    if (!function_(w, there)) return false;
    return std::ranges::all_of(there.g, [](double g) { return g >= -kActive; }) &&
           at_.f - there.f > kSideDescent * kSideStep * slope;
  }

  const GradientFunction& function_;
  std::vector<double> v_;
  std::span<const double> lower_, upper_;
  Gradients at_;
  bool defined_ = false;
  Eigen::VectorXd objective_;
  Columns pulls_;  ///< gradients of active rows, on all sides that were met, and of bounds
  Columns sides_;  ///< of the objective, other than objective_
};

}  // namespace

double kkt_residual(const GradientFunction& function, std::span<const double> v,
                    std::span<const double> lower, std::span<const double> upper) {
  PointGradients gradients(function, v, lower, upper);
  if (!gradients.defined()) return std::numeric_limits<double>::quiet_NaN();
  const double smooth = gradients.residual();
  if (smooth <= kStationary) return smooth;
  gradients.meet_other_sides();
  return std::min(smooth, gradients.residual_of_sides());
}

double kkt_residual(const RefinementProblem& p, const Point& v) {
  const auto n = static_cast<std::size_t>(p.variables);
  return kkt_residual(
      [&, rows = all_rows(p)](std::span<const double> at, Gradients& result) {
        return evaluate_gradients(p, at, rows, result);
      },
      {v.data(), n}, {p.lower.data(), n}, {p.upper.data(), n});
}

}  // namespace gear3k::optimize
