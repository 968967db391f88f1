#pragma once
// Covariates of measurements, cut into levels.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// A covariate of the rows and its levels: the values themselves while they are few, else bins of
/// equal counts.
struct Levels {
  std::string name;     ///< "load", "speed", "temperature", ...
  std::vector<int> of;  ///< of each row; -1: not stated
  int count = 0;
  bool binned = false;          ///< bins of equal counts
  std::vector<double> at = {};  ///< mean value of each level, in the column's unit
};

/// Covariates along which these rows differ.
std::vector<Levels> covariate_levels(const MeasurementSet& data);

/// Of pairs: what of both numbers of teeth together could matter, the sum and the greatest common
/// divisor (the same teeth meet again and again).  No covariates of their own: empty elsewhere.
std::vector<Levels> tooth_levels(const MeasurementSet& data);

/// Levels of two covariates together.
Levels crossed(const Levels& a, const Levels& b);

/// 1 where a row is of a level, a column for each.
Eigen::MatrixXd indicators(const Levels& levels);

/// A quantity of the rows' conditions.
std::vector<double> column_of(const MeasurementSet& data, double Condition::*member);

/// When each row was read, as structure along the time sees it [s]: of loops the mean of all rows
/// of the loop, as within one nothing tells the time from the torque.
std::vector<double> reading_times(const MeasurementSet& data);

}  // namespace gear3k::calibrate
