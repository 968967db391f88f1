#include "calibrate/series/units.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "calibrate/fit/screen.hpp"
#include "calibrate/model/row_responses.hpp"

namespace gear3k::calibrate {

SeriesUnit::SeriesUnit(const Simulation& simulation, std::string unit_name,
                       MeasurementSet unit_data, std::vector<std::size_t> places)
    : name(std::move(unit_name)),
      data(std::move(unit_data)),
      place(std::move(places)),
      problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)} {}

std::vector<std::string> unit_names(const MeasurementSet& data) {
  std::vector<std::string> names;
  for (const std::string& unit : data.units) {
    if (std::ranges::find(names, unit) == names.end()) names.push_back(unit);
  }
  return names;
}

std::vector<int> units_of_rows(const MeasurementSet& data) {
  const std::vector<std::string> names = unit_names(data);
  std::vector<int> of_file;
  of_file.reserve(data.units.size());
  for (const std::string& unit : data.units) {
    of_file.push_back(static_cast<int>(std::ranges::find(names, unit) - names.begin()));
  }
  std::vector<int> result;
  result.reserve(data.rows.size());
  for (const Observation& row : data.rows) {
    result.push_back(of_file[static_cast<std::size_t>(row.file)]);
  }
  return result;
}

std::vector<Eigen::Index> places_at_random(Eigen::Index rows, double share, std::uint64_t seed) {
  const auto wanted = std::min(
      rows, static_cast<Eigen::Index>(std::ceil(std::min(1.0, share) * static_cast<double>(rows))));
  std::vector<Eigen::Index> kept;
  kept.reserve(static_cast<std::size_t>(wanted));
  RandomBits random(seed);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto missing = static_cast<double>(wanted - static_cast<Eigen::Index>(kept.size()));
    if (random.uniform() * static_cast<double>(rows - i) < missing) kept.push_back(i);
  }
  return kept;
}

bool has_many_rows(const std::deque<SeriesUnit>& units) {
  constexpr std::size_t kMany = 2000;
  std::size_t rows = 0;
  for (const SeriesUnit& unit : units) rows += unit.data.rows.size();
  return rows > kMany;
}

std::deque<SeriesUnit> series_units(const Simulation& simulation, const MeasurementSet& data) {
  const std::vector<std::string> names = unit_names(data);
  const std::vector<int> unit = units_of_rows(data);
  const RowStates states(data.rows);
  const RowResponses responses(states, simulation, simulation.unmodified({}));
  std::deque<SeriesUnit> units;
  for (std::size_t u = 0; u < names.size(); ++u) {
    MeasurementSet own;
    own.kind = data.kind;
    own.files = data.files;
    own.units = data.units;
    own.record_start_s = data.record_start_s;
    for (const Covariate& c : data.covariates)
      own.covariates.push_back({.name = c.name, .value = {}});
    std::vector<std::size_t> places;
    std::map<int, int> run_of;
    for (std::size_t i = 0; i < data.rows.size(); ++i) {
      if (unit[i] != static_cast<int>(u)) continue;
      const std::optional<Scalar> response = responses.of_row(i);
      if (!response || !std::isfinite(response->a)) continue;
      Observation row = data.rows[i];
      if (const int run = row.condition.run; run >= 0) {
        const auto [at, is_new] = run_of.emplace(run, static_cast<int>(own.runs.size()));
        if (is_new) own.runs.push_back(data.runs[static_cast<std::size_t>(run)]);
        row.condition.run = at->second;
      }
      own.rows.push_back(row);
      for (std::size_t k = 0; k < own.covariates.size(); ++k) {
        own.covariates[k].value.push_back(data.covariates[k].value[i]);
      }
      places.push_back(i);
    }
    if (!own.rows.empty())
      units.emplace_back(simulation, names[u], std::move(own), std::move(places));
  }
  return units;
}

}  // namespace gear3k::calibrate
