#include "calibrate/fit/fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "numerics/linear_algebra.hpp"

namespace gear3k::calibrate {

namespace {

/// Gauss-Newton step of the parameters that are free to move: those at a bound that the step would
/// take across it stay there, and the others are solved for without them.
Eigen::VectorXd step_inside(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                            const std::vector<ParameterRecord>& records,
                            const std::vector<double>& value) {
  const Eigen::Index p = jacobian.cols();
  std::vector<bool> held(records.size(), false);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(p);
  for (bool again = true; again;) {
    std::vector<Eigen::Index> free;
    free.reserve(records.size());
    for (Eigen::Index k = 0; k < p; ++k) {
      if (!held[static_cast<std::size_t>(k)]) free.push_back(k);
    }
    change.setZero();
    if (free.empty()) break;
    change(free) = numerics::least_squares(jacobian(Eigen::all, free), residual);
    again = false;
    for (const Eigen::Index k : free) {
      const auto i = static_cast<std::size_t>(k);
      if (!leaves_range(records[i], value[i], change[k])) continue;
      held[i] = true;
      again = true;
    }
  }
  return change;
}

double robust_sum(const Eigen::VectorXd& residual, double scale) {
  double sum = 0.0;
  for (const double r : residual) sum += huber_square(r / scale);
  return sum;
}

/// huber_square() of all rows; infinite where some row has no simulation.
double misfit(const WhitenedRows& rows, double scale) {
  return rows.runs ? robust_sum(rows.residual, scale) : HUGE_VAL;
}

/// Values a step further, inside their bounds.
std::vector<double> moved(std::vector<double> value, const Eigen::VectorXd& step,
                          const std::vector<ParameterRecord>& records) {
  // A linearisation says nothing of values further away: at an end of its range a factor of
  // friction may make the gearbox lock, where no derivative leads back.
  constexpr double kMostOfRange = 0.25;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const ParameterRecord& record = records[k];
    const double most = kMostOfRange * (record.upper - record.lower);
    const double to = value[k] + std::clamp(step[static_cast<Eigen::Index>(k)], -most, most);
    value[k] = std::clamp(to, record.lower, record.upper);
  }
  return value;
}

Eigen::Map<const Eigen::VectorXd> as_vector(const std::vector<double>& x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

/// Values with what they come to.
struct Spot {
  std::vector<double> value;
  WhitenedRows rows;
  double sum = 0.0;  ///< misfit()
};

/// Less of the misfit than this is none.
constexpr double kSmall = 1e-4;
/// A step is halved so often.
constexpr int kHalves = 6;

/// Gauss-Newton step from a place on.
/// @param scale  standard deviation of the whitened rows
Eigen::VectorXd step_from(const Spot& from, const std::vector<ParameterRecord>& records,
                          double scale) {
  // Far from the fit all rows are off: they are no outliers yet, and clipped they would hold it
  // back.
  const double wide = std::max(scale, robust_deviation(from.rows.residual));
  return step_inside(from.rows.jacobian, winsorised(from.rows.residual, wide), records, from.value);
}

/// Downhill, while the gearbox is that of the rows nearby; up to where a whole step leaves them.
Spot downhill(const NearbyRows& nearby, Spot at, const std::vector<ParameterRecord>& records,
              double scale) {
  // Rows far off move a fit by a few deviations a pass only.
  constexpr int kPasses = 60;
  bool improved = true;
  for (int pass = 0; pass < kPasses && improved; ++pass) {
    const Eigen::VectorXd step = step_from(at, records, scale);
    improved = false;
    double share = 1.0;
    for (int half = 0; half < kHalves; ++half, share *= 0.5) {
      Spot next{.value = moved(at.value, share * step, records), .rows = {}};
      next.rows = nearby.whitened_at(next.value);
      if (half == 0 && !next.rows.runs) return at;
      next.sum = misfit(next.rows, scale);
      if (!(next.sum <= at.sum)) continue;
      improved = at.sum - next.sum > kSmall;
      at = std::move(next);
      break;
    }
  }
  return at;
}

}  // namespace

Eigen::VectorXd winsorised(Eigen::VectorXd residual, double scale) {
  const double bound = kWinsor * scale;
  if (bound > 0.0) residual = residual.cwiseMax(-bound).cwiseMin(bound);
  return residual;
}

double huber_square(double deviations) {
  const double u = std::abs(deviations);
  return u <= kWinsor ? u * u : kWinsor * (2.0 * u - kWinsor);
}

bool leaves_range(const ParameterRecord& record, double value, double step) {
  return (value <= record.lower && step < 0.0) || (value >= record.upper && step > 0.0);
}

Fit fit(const Problem& problem, Hypothesis start, double scale) {
  const auto records = parameters_of(start);
  Hypothesis h = std::move(start);
  // Levels of friction move by no more than this in most of the passes.
  constexpr double kRoom = 0.12;
  std::optional<NearbyRows> nearby(std::in_place, problem, h, kRoom);
  Spot at{.value = h.value, .rows = nearby->whitened_at(h.value)};
  at.sum = misfit(at.rows, scale);
  constexpr int kPasses = 60;
  bool improved = !records.empty();
  for (int pass = 0; pass < kPasses && improved; ++pass) {
    // Where nothing nearby is lower a step of Gauss and Newton has the last word.
    std::optional<Eigen::VectorXd> step;
    if (at.rows.runs) {
      Spot below = downhill(*nearby, at, records, scale);
      const bool is_lower = at.sum - below.sum > kSmall;
      if (nearby->is_exact_at(below.value)) {
        at = std::move(below);
      } else if (is_lower) {
        step = as_vector(below.value) - as_vector(at.value);
      }
    }
    if (!step) step = step_from(at, records, scale);
    improved = false;
    double share = 1.0;
    for (int half = 0; half < kHalves; ++half, share *= 0.5) {
      h.value = moved(at.value, share * *step, records);
      std::optional<NearbyRows> there;
      Spot trial{.value = h.value, .rows = {}};
      if (nearby->is_exact_at(h.value)) trial.rows = nearby->whitened_at(h.value);
      if (trial.rows.residual.size() == 0 || !trial.rows.runs) {
        there.emplace(problem, h, kRoom);
        trial.rows = there->whitened_at(h.value);
      }
      trial.sum = misfit(trial.rows, scale);
      if (!(trial.sum <= at.sum)) continue;
      improved = at.sum - trial.sum > kSmall;
      at = std::move(trial);
      if (there) nearby.emplace(std::move(*there));
      break;
    }
  }
  h.value = std::move(at.value);
  return {.hypothesis = std::move(h),
          .simulated = std::move(at.rows.simulated),
          .residual = std::move(at.rows.residual),
          .sum_of_squares = at.sum};
}

}  // namespace gear3k::calibrate
