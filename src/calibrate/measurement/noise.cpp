#include "calibrate/measurement/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/covariate_levels.hpp"
#include "calibrate/measurement/reading_steps.hpp"
#include "calibrate/measurement/response_unit.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "numerics/distributions.hpp"
#include "numerics/median.hpp"

namespace gear3k::calibrate {

namespace {

/// Bins of 2 % of a range; rows on either side of an edge count as different.
constexpr double kSameShare = 0.02;
/// Of a step, over the deviation of what rounding to it takes off.
constexpr double kSqrt12 = 2.0 * std::numbers::sqrt3;

using Key = std::array<long long, 10>;

/// Whole nanometres; not stated: that of 1 mm.
long long module_nm(const Condition& c) {
  constexpr double kNanometre = 1e-9;
  constexpr double kDefault_m = 1e-3;
  return std::llround((c.module_m > 0.0 ? c.module_m : kDefault_m) / kNanometre);
}

long long bin_of(double x, const ValueRange& range) {
  if (!std::isfinite(x)) return -1;
  if (!range.varies()) return 0;
  return std::llround((x - range.low) / (kSameShare * (range.high - range.low)));
}

}  // namespace

Repeats find_repeats(const MeasurementSet& data) {
  const ValueRange speed = range_of(data, &Condition::sun_speed_rad_s);
  const ValueRange load = range_of(data, &Condition::output_torque_Nm);
  const ValueRange test = range_of(data, &Condition::test_torque_Nm);
  const std::vector<Levels> levels = covariate_levels(data);
  const auto temperature = std::ranges::find(levels, "temperature", &Levels::name);
  const bool set_temperature = temperature != levels.end() && !temperature->binned;
  std::map<Key, int> cells;
  Repeats result;
  result.cell.reserve(data.rows.size());
  for (const Observation& row : data.rows) {
    const Condition& c = row.condition;
    const Key key{c.direction == design::Direction::kForward ? 0 : 1,
                  c.rotation,
                  c.reference_sensor ? 1 : 0,
                  c.driving_teeth,
                  c.driven_teeth,
                  module_nm(c),
                  bin_of(c.sun_speed_rad_s, speed),
                  bin_of(c.output_torque_Nm, load),
                  bin_of(c.test_torque_Nm, test),
                  set_temperature ? temperature->of[result.cell.size()] : 0};
    const auto [at, inserted] = cells.emplace(key, static_cast<int>(cells.size()));
    if (!inserted) ++result.degrees;
    result.cell.push_back(at->second);
  }
  result.cells = static_cast<int>(cells.size());
  return result;
}

double resolution_of(const MeasurementSet& data) {
  if (data.readings) return data.readings->resolution;
  const double si = response_unit(data.kind).si;
  constexpr double kFinest = 1e-9;
  constexpr double kSame = 1e-6;
  for (double unit = 1.0; unit > 0.5 * kFinest; unit *= 0.1) {
    const bool multiples = std::ranges::all_of(data.rows, [&](const Observation& row) {
      const double count = row.response / (unit * si);
      return std::abs(count - std::round(count)) < kSame * std::max(1.0, std::abs(count) * kSame);
    });
    if (multiples) return unit * si;
  }
  return 0.0;
}

NoiseModel make_noise_model(const MeasurementSet& data) {
  const auto n = static_cast<Eigen::Index>(data.rows.size());
  NoiseModel noise;
  noise.weight = Eigen::VectorXd::Ones(n);
  // What was set has as few digits as one likes: they say nothing of a sensor.
  if (!is_commanded(data)) {
    noise.rounding = resolution_of(data) / kSqrt12;
    if (const auto steps = reading_steps(data); steps && data.kind != Kind::kTorqueAngle) {
      noise.step = steps->step;
    }
  }
  const bool stated =
      n > 0 && std::ranges::all_of(data.rows, [](const auto& row) { return row.sigma > 0.0; });
  if (stated) {
    noise.source = NoiseSource::kStated;
    for (Eigen::Index i = 0; i < n; ++i) {
      noise.weight[i] = 1.0 / data.rows[static_cast<std::size_t>(i)].sigma;
    }
  }
  const bool in_proportion =
      !stated && n > 0 &&
      std::ranges::all_of(data.rows, [](const auto& row) { return row.scatter > 0.0; });
  if (in_proportion) {
    for (Eigen::Index i = 0; i < n; ++i) {
      noise.weight[i] = 1.0 / data.rows[static_cast<std::size_t>(i)].scatter;
    }
    noise.weight /= root_mean_square(noise.weight);
  }
  noise.order = reading_order(data);
  noise.runs = static_cast<int>(data.runs.size());
  noise.rows_per_run.assign(data.runs.size(), 0.0);
  noise.run.reserve(data.rows.size());
  for (const Observation& row : data.rows) {
    noise.run.push_back(row.condition.run);
    if (row.condition.run >= 0)
      noise.rows_per_run[static_cast<std::size_t>(row.condition.run)] += 1;
  }
  return noise;
}

NoiseModel subset_of(const NoiseModel& noise, const std::vector<std::size_t>& rows) {
  NoiseModel part = noise;
  part.weight.resize(static_cast<Eigen::Index>(rows.size()));
  part.run.clear();
  std::ranges::fill(part.rows_per_run, 0.0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    part.weight[static_cast<Eigen::Index>(k)] = noise.weight[static_cast<Eigen::Index>(rows[k])];
    const int run = noise.run[rows[k]];
    part.run.push_back(run);
    if (run >= 0) part.rows_per_run[static_cast<std::size_t>(run)] += 1.0;
  }
  part.order = subset_of(noise.order, rows);
  return part;
}

Eigen::VectorXd NoiseModel::whitened_ones() const {
  Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(weight.size(), 1);
  if (remembers()) MemoryFilter(order, memory).whiten(ones);
  return ones;
}

std::vector<double> NoiseModel::squares_by_session(const Eigen::VectorXd& ones) const {
  if (!remembers()) return rows_per_run;
  std::vector<double> squares(rows_per_run.size(), 0.0);
  for (Eigen::Index i = 0; i < ones.size(); ++i) {
    const int r = run[static_cast<std::size_t>(i)];
    if (r >= 0) squares[static_cast<std::size_t>(r)] += ones[i] * ones[i];
  }
  return squares;
}

void NoiseModel::whiten(Eigen::MatrixXd& columns) const {
  const Whitening whitening(*this);
  whitening(columns);
}

Whitening::Whitening(const NoiseModel& noise) : noise_(noise) {
  if (noise.remembers()) filter_.emplace(noise.order, noise.memory);
  if (!(noise.session_variance > 0.0) || noise.runs == 0) return;
  ones_ = noise.whitened_ones();
  for (const double n : noise.squares_by_session(ones_)) {
    // (I + q u uᵀ)^(−1/2) = I − (1 − 1/√(1 + n q)) u uᵀ/n, n = uᵀu
    take_off_.push_back(n > 0.0 ? (1.0 - 1.0 / std::sqrt(1.0 + n * noise.session_variance)) / n
                                : 1.0);
  }
}

void Whitening::operator()(Eigen::MatrixXd& columns) const {
  columns.array().colwise() *= noise_.weight.array();
  if (filter_) filter_->whiten(columns);
  if (take_off_.empty()) return;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(noise_.runs, columns.cols());
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const int r = noise_.run[static_cast<std::size_t>(i)];
    if (r >= 0) mean.row(r) += ones_[i] * columns.row(i);
  }
  for (int r = 0; r < noise_.runs; ++r) mean.row(r) *= take_off_[static_cast<std::size_t>(r)];
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const int r = noise_.run[static_cast<std::size_t>(i)];
    if (r >= 0) columns.row(i) -= ones_[i] * mean.row(r);
  }
}

double NoiseModel::log_determinant() const {
  double sum = -2.0 * weight.array().log().sum();
  if (remembers()) sum += MemoryFilter(order, memory).log_determinant();
  if (session_variance > 0.0 && runs > 0) {
    for (const double n : squares_by_session(whitened_ones())) {
      sum += std::log1p(n * session_variance);
    }
  }
  return sum;
}

double NoiseModel::known_scale() const {
  constexpr Eigen::Index kFewRows = 15;
  return source == NoiseSource::kStated && weight.size() < kFewRows ? 1.0 : 0.0;
}

double NoiseModel::least_scale() const {
  constexpr double kLeast = 1e-300;
  return weight.size() == 0 ? kLeast
                            : std::max(std::max(rounding, step / kSqrt12) * weight.mean(), kLeast);
}

double NoiseModel::deviation_of(const Eigen::VectorXd& whitened) const {
  if (!(step > 0.0) || whitened.size() != weight.size()) return robust_deviation(whitened);
  constexpr int kParts = 16;
  Eigen::VectorXd spread(kParts * whitened.size());
  for (int k = 0; k < kParts; ++k) {
    const double place = (2.0 * k + 1.0) / kParts - 1.0;
    spread.segment(k * whitened.size(), whitened.size()) = whitened + place * step * weight;
  }
  const double rounded = step * weight.mean() / kSqrt12, added = 2.0 * rounded;
  const double deviation = robust_deviation(spread);
  return std::sqrt(std::max(deviation * deviation - added * added, rounded * rounded));
}

bool NoiseModel::within_rounding(const Eigen::VectorXd& whitened) const {
  constexpr double kMost = 1.3;
  return rounding > 0.0 && root_mean_square(whitened) <= kMost * rounding * weight.mean();
}

bool NoiseModel::mixes_rows() const { return remembers() || (session_variance > 0.0 && runs > 0); }

bool NoiseModel::counts_rows_alike() const {
  return weight.size() > 0 && (weight.array() == weight[0]).all() && !mixes_rows();
}

PureError pure_error(const Repeats& repeats, const Eigen::VectorXd& weighted) {
  std::vector<double> sum(static_cast<std::size_t>(repeats.cells), 0.0);
  std::vector<double> count(sum.size(), 0.0);
  for (std::size_t i = 0; i < repeats.cell.size(); ++i) {
    const auto cell = static_cast<std::size_t>(repeats.cell[i]);
    sum[cell] += weighted[static_cast<Eigen::Index>(i)];
    count[cell] += 1.0;
  }
  PureError error{.sum_of_squares = 0.0, .degrees = repeats.degrees};
  for (std::size_t i = 0; i < repeats.cell.size(); ++i) {
    const auto cell = static_cast<std::size_t>(repeats.cell[i]);
    const double d = weighted[static_cast<Eigen::Index>(i)] - sum[cell] / count[cell];
    error.sum_of_squares += d * d;
  }
  return error;
}

LackOfFit lack_of_fit(const Repeats& repeats, const Eigen::VectorXd& weighted, int parameters) {
  const PureError pure = pure_error(repeats, weighted);
  const int degrees = repeats.cells - parameters;
  if (degrees < 1 || pure.degrees < 1 || !(pure.sum_of_squares > 0.0)) return {};
  const double f = (weighted.squaredNorm() - pure.sum_of_squares) / degrees /
                   (pure.sum_of_squares / pure.degrees);
  return {.f = f,
          .p_value = f_tail(f, degrees, pure.degrees),
          .degrees = degrees,
          .pure_degrees = pure.degrees};
}

double f_tail(double f, int degrees1, int degrees2) {
  if (!(f > 0.0) || degrees1 < 1 || degrees2 < 1) return 1.0;
  return numerics::f_upper_tail(f, degrees1, degrees2);
}

double root_mean_square(const Eigen::VectorXd& x) {
  return x.size() == 0 ? 0.0 : std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

double robust_deviation(const Eigen::VectorXd& x) {
  if (x.size() == 0) return 0.0;
  std::vector<double> sizes(static_cast<std::size_t>(x.size()));
  for (std::size_t i = 0; i < sizes.size(); ++i)
    sizes[i] = std::abs(x[static_cast<Eigen::Index>(i)]);
  constexpr double kNormalMedian = 0.674489750196082;
  return numerics::upper_median(std::move(sizes)) / kNormalMedian;
}

}  // namespace gear3k::calibrate
