#pragma once
// Structure in residuals that no cause need explain: along each covariate, by levels or by order.

#include <string>
#include <vector>

#include "calibrate/diagnosis.hpp"
#include "calibrate/search.hpp"

namespace gear3k::calibrate {

/// A covariate of the rows and its levels: the values themselves while they are few, else bins of
/// equal counts.
struct Levels {
  std::string name;     ///< "load", "speed", "temperature", ...
  std::vector<int> of;  ///< of each row
  int count = 0;
  std::vector<double> at = {};  ///< mean value of each level, in the column's unit
};

/// Covariates along which these rows differ.
std::vector<Levels> covariate_levels(const MeasurementSet& data);

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
  double p_value = 1.0;  ///< of the best, where there is nothing
};

/// Looks for structure in what a fit leaves.
RemainderSearch search_remainder(const Problem& problem, const Columns& columns,
                                 const std::vector<Levels>& levels, double rate,
                                 std::uint64_t seed);

}  // namespace gear3k::calibrate
