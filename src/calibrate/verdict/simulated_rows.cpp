#include "calibrate/verdict/simulated_rows.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/measurement/row_selection.hpp"
#include "calibrate/model/row_responses.hpp"
#include "calibrate/verdict/wild_rows.hpp"

namespace gear3k::calibrate {

namespace {

/// Leaves out rows that look like typing errors, and names them in the notes.
/// @param simulated  of each of the rows
void leave_out_wild(const std::vector<double>& simulated, const MeasurementSet& given,
                    SimulatedRows& rows, std::vector<std::string>& notes) {
  const Eigen::Map<const Eigen::VectorXd> values(simulated.data(),
                                                 static_cast<Eigen::Index>(simulated.size()));
  const std::vector<char> wild = wild_rows(rows.data, values, covariate_levels(rows.data));
  if (std::ranges::count(wild, 1) == 0) return;
  std::vector<std::size_t> kept;
  std::vector<char> marked(given.rows.size(), 0);
  for (std::size_t k = 0; k < wild.size(); ++k) {
    if (wild[k] == 0) {
      kept.push_back(rows.place[k]);
      continue;
    }
    rows.wild.emplace_back(rows.place[k], simulated[k]);
    marked[rows.place[k]] = 1;
  }
  rows.place = std::move(kept);
  rows.data = select_rows(given, rows.place);
  drop_empty_runs(rows.data);
  notes.push_back(fmt::format(
      "{}: far from all other rows, more than twice or less than half of what is expected: left "
      "out, look for a typing error",
      places_of(given, marked)));
}

}  // namespace

SimulatedRows simulated_rows(const Simulation& simulation, const MeasurementSet& data,
                             std::vector<std::string>& notes) {
  SimulatedRows result;
  std::vector<int> lines;
  std::vector<double> simulated;
  const RowStates states(data.rows);
  const RowResponses responses(states, simulation, simulation.unmodified({}));
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const std::optional<Scalar> response = responses.of_row(i);
    if (response && std::isfinite(response->a)) {
      result.place.push_back(i);
      simulated.push_back(response->a);
    } else {
      lines.push_back(data.rows[i].line);
    }
  }
  result.data = select_rows(data, result.place);
  leave_out_wild(simulated, data, result, notes);
  if (lines.empty()) return result;
  drop_empty_runs(result.data);
  notes.push_back(fmt::format(
      "{} of {} rows are left out, as the simulation does not run there (the first in line {})",
      lines.size(), data.rows.size(), lines.front()));
  return result;
}

}  // namespace gear3k::calibrate
