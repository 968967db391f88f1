#pragma once
// Rows that no gearbox explains: typing errors.

#include <Eigen/Core>
#include <vector>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Marks rows that are singly farther from the simulation than a cause takes single rows: by more
/// than 20 robust standard deviations of all rows, and by more than half of the greater of measured
/// and simulated value, as a slipped decimal point or a wrong digit does.
///
/// Rows that are off together (rows_together(), 1 %) are structure, and so are more than three
/// and 5 % of the rows: they stay.  No row of torque_angle, which nobody typed, and none of fewer
/// than 8.
/// @param simulated  as given, of each row
/// @param levels     of the data
/// @returns 1 for each such row
std::vector<char> wild_rows(const MeasurementSet& data, const Eigen::VectorXd& simulated,
                            const std::vector<Levels>& levels);

}  // namespace gear3k::calibrate
