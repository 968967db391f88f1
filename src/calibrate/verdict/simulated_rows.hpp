#pragma once
// The rows of measurements that a diagnosis goes by.

#include <string>
#include <utility>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "calibrate/model/simulation.hpp"

namespace gear3k::calibrate {

/// Rows that the baseline simulates.
struct SimulatedRows {
  MeasurementSet data;
  std::vector<std::size_t> place;  ///< of each in the data as given
  /// Rows that are taken for typing errors and left out, by place, and what is simulated there.
  std::vector<std::pair<std::size_t, double>> wild;
};

/// The rows that do not run and those that look like typing errors (wild_rows()) are left out, and
/// named in the notes.
SimulatedRows simulated_rows(const Simulation& simulation, const MeasurementSet& data,
                             std::vector<std::string>& notes);

}  // namespace gear3k::calibrate
