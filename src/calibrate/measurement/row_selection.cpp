#include "calibrate/measurement/row_selection.hpp"

#include <utility>

namespace gear3k::calibrate {

namespace {

template <class Value>
std::vector<Value> at_places(const std::vector<Value>& values,
                             const std::vector<std::size_t>& places) {
  std::vector<Value> selected;
  selected.reserve(places.size());
  for (const std::size_t i : places) selected.push_back(values[i]);
  return selected;
}

}  // namespace

MeasurementSet select_rows(const MeasurementSet& set, const std::vector<std::size_t>& places) {
  MeasurementSet part = set;
  part.rows = at_places(set.rows, places);
  for (Covariate& covariate : part.covariates) {
    covariate.value = at_places(covariate.value, places);
  }
  return part;
}

void drop_empty_runs(MeasurementSet& set) {
  std::vector<int> place(set.runs.size(), -1);
  for (const Observation& row : set.rows) {
    if (row.condition.run >= 0) place[static_cast<std::size_t>(row.condition.run)] = 0;
  }
  std::vector<std::string> runs;
  for (std::size_t k = 0; k < place.size(); ++k) {
    if (place[k] < 0) continue;
    place[k] = static_cast<int>(runs.size());
    runs.push_back(set.runs[k]);
  }
  for (Observation& row : set.rows) {
    int& run = row.condition.run;
    if (run >= 0) run = place[static_cast<std::size_t>(run)];
  }
  set.runs = std::move(runs);
}

}  // namespace gear3k::calibrate
