#include "optimize/kkt_residual.hpp"

#include <limits>

#include "optimize/gradients.hpp"
#include "optimize/nonnegative_least_squares.hpp"

namespace gear3k::optimize {

double kkt_residual(const RefinementProblem& p, const Point& v) {
  constexpr double kActive = 1e-6;
  const auto n = static_cast<std::size_t>(p.variables);
  Gradients at;
  if (!evaluate_gradients(p, {v.data(), n}, all_rows(p), at)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  using Column = Eigen::Map<const Eigen::VectorXd>;
  const Eigen::Index rows = p.variables;
  Eigen::MatrixXd gradients(rows, static_cast<Eigen::Index>(at.g.size() + 2 * n));
  Eigen::Index active = 0;
  for (std::size_t k = 0; k < at.g.size(); ++k) {
    if (at.g[k] <= kActive) gradients.col(active++) = Column(at.dg.data() + k * n, rows);
  }
  for (std::size_t k = 0; k < n; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    if (v[k] - p.lower[k] <= kActive) gradients.col(active++) = Eigen::VectorXd::Unit(rows, axis);
    if (p.upper[k] - v[k] <= kActive) gradients.col(active++) = -Eigen::VectorXd::Unit(rows, axis);
  }
  const Eigen::MatrixXd a = gradients.leftCols(active);
  const Eigen::VectorXd b = Column(at.df.data(), rows);
  return (a * nonnegative_least_squares(a, b) - b).norm();
}

}  // namespace gear3k::optimize
