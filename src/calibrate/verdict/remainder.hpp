#pragma once
// Structure in residuals that no cause need explain: along each covariate, by levels or by order.

#include <string>
#include <vector>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/search/search.hpp"
#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

/// A term of levels, or of an order of the angle (or of time).
struct EmpiricalTerm {
  std::string along;
  Eigen::MatrixXd columns;  ///< whitened
  double order = 0.0;
  double evidence = 0.0, p_value = 1.0, statistic = 0.0;
};

struct RemainderSearch {
  std::vector<CovariateTest> tests;  ///< along each covariate
  Periodogram periodogram;
  EmpiricalTerm best;
  double p_value = 1.0;        ///< of the best, where there is nothing
  double highest_order = 0.0;  ///< of the angle, where higher ones were not looked through; else 0
};

/// Looks for structure in what a fit leaves.
RemainderSearch search_remainder(const Problem& problem, const Columns& columns,
                                 const std::vector<Levels>& levels, double rate,
                                 std::uint64_t seed);

}  // namespace gear3k::calibrate
