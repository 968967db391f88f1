#include "calibrate/measurement/reading_steps.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "calibrate/measurement/noise.hpp"

namespace gear3k::calibrate {
namespace {

/// Off whole numbers by rounding of the file alone.
bool are_multiples(const std::vector<double>& values, double origin, double step) {
  constexpr double kOff = 0.02;
  return std::ranges::all_of(values, [&](double v) {
    const double count = (v - origin) / step;
    return std::abs(count - std::round(count)) < kOff;
  });
}

/// Whether the sensor makes the steps, and not the conditions that were set: rows of one condition
/// lie a step apart, or none was repeated and there are more values than a test plan has levels.
/// @param distinct  values of all rows
bool are_of_the_sensor(const MeasurementSet& data, double step, std::size_t distinct) {
  constexpr int kFewestRepeats = 8;
  constexpr int kFewestApart = 3;           // two may be one typing error
  constexpr std::size_t kFewestValues = 8;  // covariate_levels() has as many levels at most
  const Repeats repeats = find_repeats(data);
  if (repeats.degrees < kFewestRepeats) return distinct >= kFewestValues;
  std::vector<std::set<long long>> read(static_cast<std::size_t>(repeats.cells));
  const auto count = [&](std::size_t i) {
    return std::llround((data.rows[i].response - data.rows.front().response) / step);
  };
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    read[static_cast<std::size_t>(repeats.cell[i])].insert(count(i));
  }
  int apart = 0;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (read[static_cast<std::size_t>(repeats.cell[i])].contains(count(i) - 1)) ++apart;
  }
  return apart >= kFewestApart;
}

}  // namespace

std::optional<ReadingSteps> reading_steps(const MeasurementSet& data) {
  std::vector<double> values;
  values.reserve(data.rows.size());
  for (const Observation& row : data.rows) values.push_back(row.response);
  std::ranges::sort(values);
  // So few may have equal distances by chance, or as they were made.
  constexpr std::size_t kFewest = 30;
  if (values.size() < kFewest) return std::nullopt;
  const double range = values.back() - values.front();
  // Apart by more than the digits of a file.
  const double same = 1e-7 * std::max(std::abs(values.front()), std::abs(values.back()));
  double least = range;
  std::size_t distinct = 1;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double gap = values[i] - values[i - 1];
    if (!(gap > same)) continue;
    ++distinct;
    least = std::min(least, gap);
  }
  // Values that hardly repeat are as good as without steps.
  constexpr double kMostDistinct = 0.9;
  if (distinct < 2 ||
      static_cast<double>(distinct) > kMostDistinct * static_cast<double>(values.size())) {
    return std::nullopt;
  }
  for (const int parts : {1, 2, 3}) {
    double step = least / parts;
    // Each value farther away knows the step better.
    for (const double v : values) {
      const double count = std::round((v - values.front()) / step);
      if (count > 0.0) step = (v - values.front()) / count;
    }
    if (are_multiples(values, values.front(), step) && are_of_the_sensor(data, step, distinct)) {
      return ReadingSteps{.origin = values.front(), .step = step};
    }
  }
  return std::nullopt;
}

}  // namespace gear3k::calibrate
