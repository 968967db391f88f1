#pragma once
// Some rows of measurements, and the sessions that they are of.

#include <cstddef>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// The rows at some places, in that order, with their covariates; sessions keep their numbers, so
/// that what is said of a session of all rows holds of these.
MeasurementSet select_rows(const MeasurementSet& set, const std::vector<std::size_t>& places);

/// Sessions that no row is of are none: the others are numbered anew, in their order.
void drop_empty_runs(MeasurementSet& set);

}  // namespace gear3k::calibrate
