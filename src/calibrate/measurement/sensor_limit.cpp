#include "calibrate/measurement/sensor_limit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/left_out_rows.hpp"
#include "calibrate/measurement/noise.hpp"
#include "numerics/median.hpp"

namespace gear3k::calibrate {

namespace {

constexpr std::size_t kSaturatedRows = 5;      // from which a repeated extreme is suspicious
constexpr double kSaturatedLoadSpread = 0.05;  // relative
constexpr double kMostSaturated = 0.5;         // of a file's rows

/// Of the rows of a file.
struct SunTorques {
  double least = 0.0, greatest = 0.0;
  double resolution = 0.0;  ///< least difference of two; 0 where all are the same
  double slope = 0.0;       ///< sun torque by output torque, the middle one
};

/// @returns empty when no row is loaded
std::optional<SunTorques> sun_torques(const std::vector<Observation>& rows) {
  std::vector<double> values, slopes;
  values.reserve(rows.size());
  slopes.reserve(rows.size());
  for (const Observation& o : rows) {
    values.push_back(o.response);
    if (o.condition.output_torque_Nm > 0.0) {
      slopes.push_back(o.response / o.condition.output_torque_Nm);
    }
  }
  if (slopes.empty()) return std::nullopt;
  std::ranges::sort(values);
  double resolution = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double gap = values[k] - values[k - 1];
    if (gap > 0.0) resolution = std::min(resolution, gap);
  }
  if (!std::isfinite(resolution)) resolution = 0.0;
  return SunTorques{.least = values.front(),
                    .greatest = values.back(),
                    .resolution = resolution,
                    .slope = numerics::upper_median(std::move(slopes))};
}

struct RowsAtLimit {
  std::vector<char> marked;
  std::size_t count = 0;
  double least_load_Nm = std::numeric_limits<double>::infinity(), greatest_load_Nm = 0.0;
};

RowsAtLimit rows_at_limit(const std::vector<Observation>& rows, double sun_torque_Nm) {
  RowsAtLimit at{.marked = std::vector<char>(rows.size(), 0)};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].response != sun_torque_Nm) continue;
    at.marked[k] = 1;
    ++at.count;
    at.least_load_Nm = std::min(at.least_load_Nm, rows[k].condition.output_torque_Nm);
    at.greatest_load_Nm = std::max(at.greatest_load_Nm, rows[k].condition.output_torque_Nm);
  }
  return at;
}

bool is_saturated(const RowsAtLimit& at, const SunTorques& torques) {
  const double spread = at.greatest_load_Nm - at.least_load_Nm;
  return at.count >= kSaturatedRows && !(spread <= kSaturatedLoadSpread * at.greatest_load_Nm) &&
         !(torques.slope * spread <= 2.0 * torques.resolution);
}

/// Notes loaded rows that read exactly 0 where the sensor shows far smaller torques than the least
/// other one: they were cut off at 0, or the gearbox holds its load by itself.
void note_zeros(MeasurementSet& set, const SunTorques& torques) {
  std::vector<char> marked(set.rows.size(), 0);
  std::size_t count = 0;
  double least_other = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < set.rows.size(); ++k) {
    const Observation& o = set.rows[k];
    if (o.response > 0.0) least_other = std::min(least_other, o.response);
    if (o.response != 0.0 || !(o.condition.output_torque_Nm > 0.0)) continue;
    marked[k] = 1;
    ++count;
  }
  constexpr double kFiner = 10.0;
  if (count < kSaturatedRows || !(kFiner * torques.resolution < least_other)) return;
  set.notes.push_back(fmt::format(
      "{}: {} loaded rows hold a sun_torque_nm of exactly 0: readings that were cut off at 0 are "
      "no "
      "measurements, leave them out; a gearbox that holds its load by itself reads so, too",
      places_of(set, marked), count));
}

}  // namespace

std::optional<std::string> leave_out_saturated(MeasurementSet& set) {
  const std::vector<Observation>& rows = set.rows;
  if (set.kind != Kind::kTransmission || rows.size() < kSaturatedRows) return std::nullopt;
  // What was set takes equal values at any load.
  if (is_commanded(set)) {
    set.notes.emplace_back(
        "the sun torque takes few exact values: it was set, and what scatters is "
        "the output torque");
    return std::nullopt;
  }
  const std::optional<SunTorques> torques = sun_torques(rows);
  if (!torques) return std::nullopt;
  std::vector<std::pair<const char*, double>> ends{{"greatest", torques->greatest}};
  if (torques->least < torques->greatest) ends.emplace_back("least", torques->least);
  std::vector<char> marked(rows.size(), 0);
  std::vector<std::string> found;
  std::size_t count = 0;
  for (const auto& [name, value] : ends) {
    const RowsAtLimit at = rows_at_limit(rows, value);
    if (!is_saturated(at, *torques)) continue;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (at.marked[k] != 0) marked[k] = 1;
    }
    count += at.count;
    found.push_back(fmt::format(
        "{}: {} rows hold the {} sun_torque_nm, {:g}, at loads from {:g} to {:g} N m: the sensor "
        "is at its limit",
        places_of(set, at.marked), at.count, name, value, at.least_load_Nm, at.greatest_load_Nm));
  }
  if (count == 0) {
    note_zeros(set, *torques);
    return std::nullopt;
  }
  if (static_cast<double>(count) > kMostSaturated * static_cast<double>(rows.size())) {
    return fmt::format("{}; that is {} of {} rows, allowed: at most half", fmt::join(found, "; "),
                       count, rows.size());
  }
  for (const std::string& text : found) set.notes.push_back(text + "; left out");
  leave_out(set, marked);
  return std::nullopt;
}

}  // namespace gear3k::calibrate
