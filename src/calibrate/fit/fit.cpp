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
constexpr double kNoGain = 1e-4;
/// A step that gains less than this is not taken.
constexpr double kNoStep = 1e-6;
/// A step is halved so often.
constexpr int kStepHalves = 6;

/// A step, and by how much the misfit falls at least where responses are linear along it.
struct Step {
  Eigen::VectorXd change;
  double gain = 0.0;
};

/// Gauss-Newton step from a fit far off, where all rows are: they are no outliers yet.
Step far_step(const Spot& from, const std::vector<ParameterRecord>& records, double scale) {
  const double wide = std::max(scale, robust_deviation(from.rows.residual));
  return {.change = step_inside(from.rows.jacobian, winsorised(from.rows.residual, wide), records,
                                from.value),
          .gain = HUGE_VAL};
}

/// Step to the least of the square that has Huber's function below it and touches it at every
/// residual, Σ w_i (r_i − J_i Δ)² with w_i = min(1, b/|r_i|), b = kWinsor σ.
/// Source: own derivation, 2 |x| ≤ x²/|r| + |r| with equality at x = r, times b.
Step near_step(const Spot& from, const std::vector<ParameterRecord>& records, double scale) {
  const Eigen::VectorXd& residual = from.rows.residual;
  const double bound = kWinsor * scale;
  Eigen::VectorXd root = Eigen::VectorXd::Ones(residual.size());
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const double size = std::abs(residual[i]);
    if (size > bound) root[i] = std::sqrt(bound / size);
  }
  const Eigen::MatrixXd jacobian = root.asDiagonal() * from.rows.jacobian;
  const Eigen::VectorXd weighted = root.cwiseProduct(residual);
  Step step{.change = step_inside(jacobian, weighted, records, from.value)};
  step.gain = (weighted.squaredNorm() - (weighted - jacobian * step.change).squaredNorm()) /
              (scale * scale);
  return step;
}

/// Chooses the steps of a descent.
class Steps {
 public:
  Steps(const std::vector<ParameterRecord>& records, double scale)
      : records_(records), scale_(scale) {}
  [[nodiscard]] bool is_far() const { return far_; }
  [[nodiscard]] Step from(const Spot& at) const {
    return far_ ? far_step(at, records_, scale_) : near_step(at, records_, scale_);
  }
  /// What a step gained: far off are those that gain much.
  void learn(double before, double after) {
    constexpr double kMuch = 0.1;
    far_ = far_ && after < (1.0 - kMuch) * before;
  }

 private:
  const std::vector<ParameterRecord>& records_;
  double scale_;
  bool far_ = true;
};

/// Downhill, while the gearbox is that of the rows nearby; up to where a whole step leaves them.
Spot downhill(const NearbyRows& nearby, Spot at, const std::vector<ParameterRecord>& records,
              double scale, Steps steps) {
  // Rows far off move a fit by a few deviations a pass only.
  constexpr int kPasses = 60;
  bool improved = true;
  for (int pass = 0; pass < kPasses && improved; ++pass) {
    const Step step = steps.from(at);
    if (step.gain < kNoStep) break;
    const double before = at.sum;
    improved = false;
    double share = 1.0;
    for (int half = 0; half < kStepHalves; ++half, share *= 0.5) {
      Spot next{.value = moved(at.value, share * step.change, records), .rows = {}};
      next.rows = nearby.whitened_at(next.value);
      if (half == 0 && !next.rows.runs) return at;
      next.sum = misfit(next.rows, scale);
      if (!(next.sum <= at.sum)) {
        if (steps.is_far()) break;
        continue;
      }
      improved = at.sum - next.sum > kNoGain;
      at = std::move(next);
      break;
    }
    const bool was_far = steps.is_far();
    steps.learn(before, at.sum);
    improved = improved || (was_far && !steps.is_far());
  }
  return at;
}

/// Where a fit stands, and the gearbox as simulated there.
class Descent {
 public:
  Descent(const Problem& problem, Hypothesis start, double scale)
      : problem_(problem),
        records_(parameters_of(start)),
        scale_(scale),
        steps_(records_, scale),
        h_(std::move(start)),
        nearby_(simulated_at(h_)),
        at_{.value = h_.value, .rows = nearby_.whitened_at(h_.value)} {
    at_.sum = misfit(at_.rows, scale_);
  }

  /// A pass.
  /// @returns whether it gained
  bool improve() {
    const double before = at_.sum;
    const bool was_far = steps_.is_far();
    const bool gained = pass();
    steps_.learn(before, at_.sum);
    return gained || (was_far && !steps_.is_far());
  }

  Fit result() && {
    h_.value = std::move(at_.value);
    return {.hypothesis = std::move(h_),
            .simulated = std::move(at_.rows.simulated),
            .residual = std::move(at_.rows.residual),
            .sum_of_squares = at_.sum};
  }

 private:
  bool pass() {
    if (at_.rows.runs) {
      Spot below = downhill(nearby_, at_, records_, scale_, steps_);
      const bool is_lower = at_.sum - below.sum > kNoGain;
      if (nearby_.is_exact_at(below.value)) {
        at_ = std::move(below);
      } else if (is_lower && advance(as_vector(below.value) - as_vector(at_.value))) {
        return true;
      }
    }
    // Where what is lower nearby is not so in truth, and in the end, by a step of Gauss and Newton.
    const Step step = steps_.from(at_);
    return !(step.gain < kNoStep) && advance(step.change);
  }

  /// With room for levels of friction to move in, unless the gearbox locks at some of these.
  [[nodiscard]] NearbyRows simulated_at(const Hypothesis& h) const {
    constexpr double kRoom = 0.12;
    NearbyRows with_room(problem_, h, kRoom);
    if (with_room.at(h.value).runs) return with_room;
    return {problem_, h};
  }

  /// Along a step, or as much of it as leads downhill.
  /// @returns whether it gained
  bool advance(const Eigen::VectorXd& step) {
    double share = 1.0;
    for (int half = 0; half < kStepHalves; ++half, share *= 0.5) {
      Hypothesis next{.effects = h_.effects, .value = moved(at_.value, share * step, records_)};
      std::optional<NearbyRows> there;
      Spot trial{.value = next.value,
                 .rows = {.residual = {}, .jacobian = {}, .simulated = {}, .runs = false}};
      if (nearby_.is_exact_at(next.value)) trial.rows = nearby_.whitened_at(next.value);
      if (!trial.rows.runs) {
        there.emplace(simulated_at(next));
        trial.rows = there->whitened_at(next.value);
      }
      trial.sum = misfit(trial.rows, scale_);
      if (!(trial.sum <= at_.sum)) {
        if (steps_.is_far()) return false;
        continue;
      }
      const bool improved = at_.sum - trial.sum > kNoGain;
      at_ = std::move(trial);
      if (there) nearby_ = std::move(*there);
      return improved;
    }
    return false;
  }

  const Problem& problem_;
  std::vector<ParameterRecord> records_;
  double scale_;
  Steps steps_;
  Hypothesis h_;
  NearbyRows nearby_;
  Spot at_;
};

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
  const bool has_parameters = !start.value.empty();
  Descent descent(problem, std::move(start), scale);
  constexpr int kPasses = 60;
  for (int pass = 0; has_parameters && pass < kPasses; ++pass) {
    if (!descent.improve()) break;
  }
  return std::move(descent).result();
}

std::vector<Fit> fit_all(const Problem& problem, const std::vector<Hypothesis>& starts,
                         double scale) {
  std::vector<Fit> fits(starts.size());
  for_fits(problem, starts.size(),
           [&](std::size_t k) { fits[k] = fit(problem, starts[k], scale); });
  return fits;
}

}  // namespace gear3k::calibrate
