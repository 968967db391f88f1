#pragma once
// The gearboxes of a series, each with its own rows.

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "calibrate/fit/linearisation.hpp"

namespace gear3k::calibrate {

/// One gearbox of a series.  Its sessions are numbered anew, its files as in all data.
struct SeriesUnit {
  SeriesUnit(const Simulation& simulation, std::string unit_name, MeasurementSet unit_data,
             std::vector<std::size_t> places);
  SeriesUnit(const SeriesUnit&) = delete;  // the problem refers to the data
  SeriesUnit& operator=(const SeriesUnit&) = delete;

  std::string name;
  MeasurementSet data;
  std::vector<std::size_t> place;  ///< of each row in all data
  Problem problem;
};

/// Names of the gearboxes, in order of first appearance; empty where no file states one.
std::vector<std::string> unit_names(const MeasurementSet& data);

/// Which of those names each row is of.
std::vector<int> units_of_rows(const MeasurementSet& data);

/// Rows that the simulation runs at, by gearbox; those without any are not among them.
/// @returns in a deque, as units stay where they are
std::deque<SeriesUnit> series_units(const Simulation& simulation, const MeasurementSet& data);

/// Places of a share of rows, at random, in their order; all where the share is 1 or more.
std::vector<Eigen::Index> places_at_random(Eigen::Index rows, double share, std::uint64_t seed);

/// Whether there are so many rows that threads are worth their while.
bool has_many_rows(const std::deque<SeriesUnit>& units);

}  // namespace gear3k::calibrate
