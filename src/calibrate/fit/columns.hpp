#pragma once
// A fit's linearisation as columns in which every row counts alike.

#include <Eigen/Core>
#include <vector>

#include "calibrate/fit/fit.hpp"
#include "calibrate/fit/screen.hpp"

namespace gear3k::calibrate {

/// Columns of a hypothesis and of candidates, whitened, and the residual, whitened and winsorised.
struct Columns {
  Eigen::VectorXd residual;
  Eigen::VectorXd raw;  ///< the residual, whitened only
  Eigen::MatrixXd own, other;
};
Columns columns_at(const Problem& problem, const Hypothesis& hypothesis,
                   const std::vector<Candidate>& others, double scale);

/// Blocks of candidates, in their order.
std::vector<Block> blocks_of(const std::vector<Candidate>& candidates);

/// Positions of the candidates that gain anything, the best evidence first, at most `forms` forms
/// of a cause.
std::vector<std::size_t> ranked(const std::vector<Candidate>& candidates,
                                const std::vector<Gain>& gains, int forms);

}  // namespace gear3k::calibrate
