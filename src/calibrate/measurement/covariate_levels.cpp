#include "calibrate/measurement/covariate_levels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/noise.hpp"
#include "units/units.hpp"

namespace gear3k::calibrate {

namespace {

constexpr std::size_t kMostLevels = 8;

/// Levels of a variable; none where it does not vary.
Levels levels_of(std::string name, const std::vector<double>& values, double per_unit,
                 double offset) {
  Levels levels{.name = std::move(name), .of = std::vector<int>(values.size(), -1)};
  std::vector<double> sorted;
  for (const double v : values) {
    if (std::isfinite(v)) sorted.push_back(v);
  }
  if (sorted.empty()) return levels;
  std::ranges::sort(sorted);
  const double span = sorted.back() - sorted.front();
  if (!(span > 0.0)) return levels;
  // Values that differ by less than 2 % of the range are one level.
  constexpr double kSame = 0.02;
  std::vector<double> edges;  // lower edges of all levels but the first
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    if (sorted[k] - sorted[k - 1] > kSame * span)
      edges.push_back(0.5 * (sorted[k] + sorted[k - 1]));
  }
  const bool clustered = !edges.empty() && edges.size() < kMostLevels;
  levels.binned = !clustered;
  if (levels.binned) {
    edges.clear();
    const std::size_t bins = std::min<std::size_t>(kMostLevels, sorted.size() / 8);
    // Many rows at the least value are one level, with nothing below it.
    for (std::size_t k = 1; k < bins; ++k) {
      const double edge = sorted[k * sorted.size() / bins];
      if (edge > sorted.front()) edges.push_back(edge);
    }
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
  levels.count = static_cast<int>(edges.size()) + 1;
  levels.at.assign(static_cast<std::size_t>(levels.count), 0.0);
  std::vector<double> rows(levels.at.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const auto level =
        static_cast<std::size_t>(std::ranges::upper_bound(edges, values[i]) - edges.begin());
    levels.of[i] = static_cast<int>(level);
    levels.at[level] += (values[i] - offset) / per_unit;
    rows[level] += 1.0;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] > 0.0) levels.at[k] /= rows[k];
  }
  return levels;
}

/// Time since the first row of each row's session [s].
/// @param times  of the rows [s]
std::vector<double> session_times(const MeasurementSet& data, const std::vector<double>& times) {
  std::vector<double> start(data.runs.size(), HUGE_VAL);
  std::vector<double> since(times.size(), std::nan(""));
  const auto each = [&](const auto& act) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      const int run = data.rows[i].condition.run;
      if (run >= 0 && std::isfinite(times[i])) act(i, start[static_cast<std::size_t>(run)]);
    }
  };
  each([&](std::size_t i, double& first) { first = std::min(first, times[i]); });
  each([&](std::size_t i, double first) { since[i] = times[i] - first; });
  return since;
}

}  // namespace

Eigen::MatrixXd indicators(const Levels& levels) {
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(levels.of.size()), levels.count);
  for (std::size_t i = 0; i < levels.of.size(); ++i) {
    if (levels.of[i] >= 0) columns(static_cast<Eigen::Index>(i), levels.of[i]) = 1.0;
  }
  return columns;
}

Levels crossed(const Levels& a, const Levels& b) {
  Levels result{.name = a.name, .of = std::vector<int>(a.of.size(), -1)};
  std::map<std::pair<int, int>, int> cells;
  for (std::size_t i = 0; i < a.of.size(); ++i) {
    if (a.of[i] < 0 || b.of[i] < 0) continue;
    const auto [at, inserted] =
        cells.emplace(std::pair(a.of[i], b.of[i]), static_cast<int>(cells.size()));
    result.of[i] = at->second;
  }
  result.count = static_cast<int>(cells.size());
  return result;
}

std::vector<double> column_of(const MeasurementSet& data, double Condition::*member) {
  std::vector<double> result;
  result.reserve(data.rows.size());
  for (const Observation& row : data.rows) result.push_back(row.condition.*member);
  return result;
}

std::vector<double> reading_times(const MeasurementSet& data) {
  std::vector<double> times = column_of(data, &Condition::time_s);
  if (data.kind != Kind::kTorqueAngle) return times;
  const auto of_one_loop = [&](std::size_t a, std::size_t b) {
    return data.rows[a].file == data.rows[b].file && data.rows[a].line == data.rows[b].line;
  };
  for (std::size_t first = 0, end = 0; first < times.size(); first = end) {
    double sum = 0.0;
    for (end = first; end < times.size() && of_one_loop(first, end); ++end) sum += times[end];
    std::fill(times.begin() + static_cast<std::ptrdiff_t>(first),
              times.begin() + static_cast<std::ptrdiff_t>(end),
              sum / static_cast<double>(end - first));
  }
  return times;
}

std::vector<Levels> tooth_levels(const MeasurementSet& data) {
  std::vector<Levels> result;
  if (data.kind != Kind::kPairLoss) return result;
  std::vector<double> sum;
  std::vector<double> divisor;
  for (const Observation& row : data.rows) {
    const Condition& c = row.condition;
    sum.push_back(c.driving_teeth + c.driven_teeth);
    divisor.push_back(std::gcd(c.driving_teeth, c.driven_teeth));
  }
  result.push_back(levels_of("tooth sum", sum, 1.0, 0.0));
  result.push_back(levels_of("common divisor", divisor, 1.0, 0.0));
  return result;
}

std::vector<Levels> covariate_levels(const MeasurementSet& data) {
  std::vector<Levels> result;
  const auto add = [&](std::string name, const std::vector<double>& values, double per_unit,
                       double offset) {
    Levels levels = levels_of(std::move(name), values, per_unit, offset);
    if (levels.count > 1) result.push_back(std::move(levels));
  };
  const auto integers = [&](auto get) {
    std::vector<double> values;
    values.reserve(data.rows.size());
    for (const Observation& row : data.rows) values.push_back(get(row.condition));
    return values;
  };
  // Where the load is what scatters, residuals follow it without any structure.
  if (!is_commanded(data)) add("load", column_of(data, &Condition::output_torque_Nm), 1.0, 0.0);
  add("speed", column_of(data, &Condition::sun_speed_rad_s), units::kRpm, 0.0);
  add("test torque", column_of(data, &Condition::test_torque_Nm), 1.0, 0.0);
  add("temperature", column_of(data, &Condition::temperature_K), 1.0, 273.15);
  const std::vector<double> times = reading_times(data);
  add("time", times, 1.0, 0.0);
  add("cycles", column_of(data, &Condition::cycles), 1.0, 0.0);
  add("direction", integers([](const Condition& c) {
        return c.direction == design::Direction::kForward ? 1.0 : -1.0;
      }),
      1.0, 0.0);
  add("rotation", integers([](const Condition& c) { return static_cast<double>(c.rotation); }), 1.0,
      0.0);
  add("driving teeth",
      integers([](const Condition& c) { return static_cast<double>(c.driving_teeth); }), 1.0, 0.0);
  add("driven teeth",
      integers([](const Condition& c) { return static_cast<double>(c.driven_teeth); }), 1.0, 0.0);
  if (data.runs.size() > 1) {
    // What warms up or settles does so anew in every session.
    add("session time", session_times(data, times), 1.0, 0.0);
    add("run", integers([](const Condition& c) { return static_cast<double>(c.run); }), 1.0, 0.0);
  }
  for (const Covariate& c : data.covariates) add(c.name, c.value, 1.0, 0.0);
  return result;
}

}  // namespace gear3k::calibrate
