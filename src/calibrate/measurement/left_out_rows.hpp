#pragma once
// Rows of measurements that are left out, and how they are named.

#include <string>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// "line 4" or "lines 4, 9, 13"; the first ten, then "and 5 more".
std::string line_list(const std::vector<int>& lines);

/// The marked rows by file: "a.csv: lines 4, 9; b.csv: line 3".
std::string places_of(const MeasurementSet& set, const std::vector<char>& marked);

/// Removes the marked rows with their covariates, and sessions that no other row is of.
void leave_out(MeasurementSet& set, const std::vector<char>& marked);

}  // namespace gear3k::calibrate
