#include "calibrate/torque_angle_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace gear3k::calibrate {
namespace {

using std::numbers::pi;

/// Swing of the unfiltered torque, as a fraction of its range, that counts in the first search.
constexpr double kRawReversalFraction = 0.5;
/// A first branch counts as loaded from the other side when it starts above this fraction.
constexpr double kLoadedFraction = 0.5;
/// Loops are compared at their ends when these torques agree within this fraction.
constexpr double kSamePeakFraction = 0.2;
constexpr double kSignificant = 3.0;  ///< standard deviations
/// Noise alone may pass zero torque several times, so far apart in angle [standard deviations].
constexpr double kManyDeviations = 6.0;
/// Differences below this fraction of the range of the angle are rounding.
constexpr double kRoundingFraction = 1e-6;
constexpr double kStrongestCorrelation = 0.95;
/// Cut-off, in units of the loop's frequency, under which a flank's part is chosen by its torque:
/// so low that the noise in that choice leaves the slope unbiased.
constexpr double kChoiceHarmonic = 15.0;
/// The same for the curve about which scatter is taken: the wider the filter's own pass band, the
/// less of the noise is left to tell its correlation from.
constexpr double kScatterHarmonic = 60.0;

double square(double x) { return x * x; }

// --- filter -------------------------------------------------------------------------------------

struct Biquad {
  double b0, b1, b2, a1, a2;
};

Biquad butterworth(double cutoff_per_sample) {
  const double k = std::tan(pi * cutoff_per_sample);
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  return {.b0 = k * k * scale,
          .b1 = 2.0 * k * k * scale,
          .b2 = k * k * scale,
          .a1 = 2.0 * (k * k - 1.0) * scale,
          .a2 = (1.0 - std::numbers::sqrt2 * k + k * k) * scale};
}

/// One pass in place, from the steady state of the first value.
template <class Iterator>
void pass(const Biquad& f, Iterator first, Iterator last) {
  double z1 = (1.0 - f.b0) * *first;
  double z2 = (f.b2 - f.a2) * *first;
  for (; first != last; ++first) {
    const double x = *first;
    const double y = f.b0 * x + z1;
    z1 = f.b1 * x - f.a1 * y + z2;
    z2 = f.b2 * x - f.a2 * y;
    *first = y;
  }
}

/// The filter's response to a unit impulse, from its centre on.
std::vector<double> impulse_response(double cutoff_per_sample) {
  const std::size_t reach = filter_padding(cutoff_per_sample);
  std::vector<double> impulse(4 * reach + 1, 0.0);
  impulse[2 * reach] = 1.0;
  const std::vector<double> response = zero_phase_filter(impulse, cutoff_per_sample);
  const auto centre = response.begin() + static_cast<std::ptrdiff_t>(2 * reach);
  return {centre, centre + static_cast<std::ptrdiff_t>(reach + 1)};
}

/// Adds factor times the weights that filtered sample i gives to the samples of a record of length
/// n, the continuation of its ends folded back onto them.
void add_row(const std::vector<double>& response, std::size_t i, std::size_t n, double factor,
             std::vector<double>& weight) {
  const auto reach = static_cast<std::ptrdiff_t>(response.size()) - 1;
  const auto last = static_cast<std::ptrdiff_t>(n) - 1;
  const auto at = [&](std::ptrdiff_t j) -> double& { return weight[static_cast<std::size_t>(j)]; };
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    const double h = factor * response[static_cast<std::size_t>(std::abs(k))];
    const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(i) + k;
    if (j < 0) {
      at(0) += 2.0 * h;
      at(-j) -= h;
    } else if (j > last) {
      at(last) += 2.0 * h;
      at(2 * last - j) -= h;
    } else {
      at(j) += h;
    }
  }
}

// --- noise --------------------------------------------------------------------------------------

/// Noise whose correlation falls as φ^|lag|.
struct Noise {
  double variance = 0.0;
  double correlation = 0.0;  ///< φ, between neighbours
};

/// Sum of correlated noise under these weights.
double variance_of_sum(const Noise& noise, const std::vector<double>& weight) {
  // Σ_j Σ_l w_j w_l φ^|j-l| by the recursion s_j = φ (s_{j-1} + w_{j-1}).
  double sum = 0.0;
  double before = 0.0;
  for (const double w : weight) {
    sum += w * (w + 2.0 * before);
    before = noise.correlation * (before + w);
  }
  return noise.variance * std::max(0.0, sum);
}

double inflation(const Noise& noise) {
  return (1.0 + noise.correlation) / (1.0 - noise.correlation);
}

/// What the filter leaves out of noise, |1 - |H|²|², over frequency.
struct LeftOut {
  static constexpr std::size_t kSteps = 512;
  std::array<double, kSteps> cosine{}, power{};

  explicit LeftOut(double cutoff_per_sample) {
    const double t_c = std::tan(pi * cutoff_per_sample);
    for (std::size_t i = 0; i < kSteps; ++i) {
      const double omega = pi * (static_cast<double>(i) + 0.5) / kSteps;
      const double ratio = square(square(std::tan(omega / 2.0) / t_c));
      cosine[i] = std::cos(omega);
      power[i] = square(ratio / (1.0 + ratio)) / kSteps;
    }
  }

  /// Covariances at lag 0 and 1 that remain of noise of variance 1 and correlation φ.
  [[nodiscard]] std::array<double, 2> covariance(double phi) const {
    std::array<double, 2> sum{};
    for (std::size_t i = 0; i < kSteps; ++i) {
      const double density =
          (1.0 - phi * phi) / (1.0 - 2.0 * phi * cosine[i] + phi * phi) * power[i];
      sum[0] += density;
      sum[1] += density * cosine[i];
    }
    return sum;
  }
};

struct Covariance {
  double lag0 = 0.0, lag1 = 0.0;
};

Covariance covariance(const std::vector<double>& u) {
  Covariance c;
  for (std::size_t i = 0; i < u.size(); ++i) {
    c.lag0 += u[i] * u[i] / static_cast<double>(u.size());
    if (i > 0) c.lag1 += u[i] * u[i - 1] / static_cast<double>(u.size() - 1);
  }
  return c;
}

/// The noise whose part left out by the filter has these covariances.
Noise noise_of_left_out(const Covariance& c, const LeftOut& left_out) {
  if (!(c.lag0 > 0.0)) return {};
  const double wanted = c.lag1 / c.lag0;
  double low = -kStrongestCorrelation;
  double high = kStrongestCorrelation;
  for (int i = 0; i < 40; ++i) {
    const double phi = 0.5 * (low + high);
    const auto [c0, c1] = left_out.covariance(phi);
    (c1 / c0 < wanted ? low : high) = phi;
  }
  const double phi = 0.5 * (low + high);
  return {.variance = c.lag0 / left_out.covariance(phi)[0], .correlation = phi};
}

/// The noise of the residuals of a straight line.
Noise noise_of_residuals(const std::vector<double>& u, double parameters) {
  const Covariance c = covariance(u);
  if (!(c.lag0 > 0.0)) return {};
  const auto n = static_cast<double>(u.size());
  return {
      .variance = c.lag0 * n / (n - parameters),
      .correlation = std::clamp(c.lag1 / c.lag0, -kStrongestCorrelation, kStrongestCorrelation)};
}

// --- branches -----------------------------------------------------------------------------------

/// First sample, reversals and last sample of a signal that swings by more than the threshold.
std::vector<std::size_t> turning_points(const std::vector<double>& x, double threshold) {
  std::size_t lowest = 0;
  std::size_t highest = 0;
  int sense = 0;
  std::vector<std::size_t> turns;
  turns.reserve(16);
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (x[i] < x[lowest]) lowest = i;
    if (x[i] > x[highest]) highest = i;
    if (sense >= 0 && x[highest] - x[i] > threshold) {
      turns.push_back(highest);
      lowest = i;
      sense = -1;
    } else if (sense <= 0 && x[i] - x[lowest] > threshold) {
      turns.push_back(lowest);
      highest = i;
      sense = 1;
    }
  }
  if (sense > 0) turns.push_back(highest);
  if (sense < 0) turns.push_back(lowest);
  return turns;
}

double range(const std::vector<double>& x) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return *high - *low;
}

struct Branch {
  std::size_t first = 0, last = 0;
  bool rising = false;
  bool loaded = true;  ///< begins at a reversal, or well on the side it should come from
};

/// Torque and angle under one filter.
struct Filtered {
  std::vector<double> torque, angle;
};

/// Where a branch has a torque.
struct Crossing {
  double angle = 0.0, time = 0.0;
  double spread = 0.0;        ///< between the first and the last passage
  double extrapolated = 0.0;  ///< torque between the end of the branch and the level
  std::size_t i = 0, j = 1;   ///< angle = (1 - s) angle_i + s angle_j, at the first passage
  double s = 0.0;
};

Crossing interpolate(const TorqueAngleRecord& record, const Filtered& f, std::size_t i,
                     std::size_t j, double level) {
  const double s = (level - f.torque[i]) / (f.torque[j] - f.torque[i]);
  return {.angle = (1.0 - s) * f.angle[i] + s * f.angle[j],
          .time = (1.0 - s) * record.time_s[i] + s * record.time_s[j],
          .i = i,
          .j = j,
          .s = s};
}

std::optional<Crossing> crossing(const TorqueAngleRecord& record, const Filtered& f,
                                 const Branch& branch, double level) {
  std::optional<Crossing> first;
  std::optional<Crossing> last;
  for (std::size_t i = branch.first; i < branch.last; ++i) {
    if ((f.torque[i] >= level) == (f.torque[i + 1] >= level)) continue;
    last = interpolate(record, f, i, i + 1, level);
    if (!first) first = last;
  }
  if (!first) return std::nullopt;
  first->spread = std::abs(last->angle - first->angle);
  first->angle = 0.5 * (first->angle + last->angle);
  first->time = 0.5 * (first->time + last->time);
  return first;
}

/// At zero torque; a branch that ends just short of it is continued along its last `secant`
/// samples.
std::optional<Crossing> zero_crossing(const TorqueAngleRecord& record, const Filtered& f,
                                      const Branch& branch, double reach_fraction,
                                      std::size_t secant) {
  if (auto found = crossing(record, f, branch, 0.0)) return found;
  const double start = f.torque[branch.first];
  const double end = f.torque[branch.last];
  const bool towards = branch.rising ? start < 0.0 : start > 0.0;
  if (!towards || std::abs(end) > reach_fraction * std::abs(start)) return std::nullopt;
  const std::size_t from = branch.last - std::min(secant, branch.last - branch.first);
  if (f.torque[from] == end) return std::nullopt;
  Crossing found = interpolate(record, f, from, branch.last, 0.0);
  found.extrapolated = std::abs(end);
  return found;
}

// --- one record ---------------------------------------------------------------------------------

/// What is known of a branch at zero torque.
struct BranchZero {
  std::optional<Crossing> at, at_double;  ///< at the cut-off and at twice the cut-off
  LoopOutcome outcome = LoopOutcome::kMeasured;
  Noise noise;                  ///< of the angle, that of the torque turned into angle
  double noise_variance = 0.0;  ///< of the angle at zero torque
  double variance = 0.0;        ///< with the spread of several passages, as evenly distributed
};

struct LineFit {
  double torque = 0.0, angle = 0.0;
};

class Analysis {
 public:
  Analysis(const TorqueAngleRecord& record, const LoopOptions& options, double cutoff,
           double samples_per_loop)
      : record_(record),
        options_(options),
        cutoff_(cutoff),
        n_(record.time_s.size()),
        secant_(static_cast<std::size_t>(std::ceil(0.5 / cutoff))),
        scatter_reach_(static_cast<std::size_t>(
            std::ceil(1.0 / std::min(cutoff, kScatterHarmonic / samples_per_loop)))),
        response_(impulse_response(cutoff)),
        left_out_(std::min(cutoff, kScatterHarmonic / samples_per_loop)),
        once_(filtered(cutoff)),
        double_(filtered(std::min(2.0 * cutoff, 0.5 * (cutoff + 0.5)))),
        smooth_(filtered(std::min(cutoff, kScatterHarmonic / samples_per_loop))),
        choice_(once_.torque) {
    const double low = kChoiceHarmonic / samples_per_loop;
    if (low < cutoff && n_ > filter_padding(low)) {
      choice_ = zero_phase_filter(record.torque_Nm, low);
    }
  }

  LoopAnalysis run() {
    LoopAnalysis result;
    result.cutoff_per_sample = cutoff_;
    const std::vector<std::size_t> turns =
        turning_points(once_.torque, options_.reversal_fraction * range(once_.torque));
    if (turns.size() < 3) {
      result.outcome = RecordOutcome::kTooFewReversals;
      return result;
    }
    result.reversals.assign(turns.begin() + 1, turns.end() - 1);
    find_branches(turns);
    sense_ = angle_sense();
    result.angle_sense = sense_;
    result.loops.reserve(branches_.size() - 1);
    for (std::size_t b = 0; b + 1 < branches_.size(); ++b) result.loops.push_back(loop(b));
    result.creep = creep(result.loops);
    return result;
  }

  /// Variance of the lost motion of loop b, the record's creep having been removed from the angle.
  [[nodiscard]] double variance_without_creep(std::size_t b, double creep_variance) const {
    const Slope slope = common_slope();
    const double elapsed = zeros_[b + 1].at->time - zeros_[b].at->time;
    double variance = 0.0;
    if (!slope.repeats) {
      return zeros_[b].variance + zeros_[b + 1].variance + square(elapsed) * creep_variance;
    }
    for (std::size_t k = 0; k < zeros_.size(); ++k) {
      const double own = k == b + 1 ? 1.0 : (k == b ? -1.0 : 0.0);
      variance += square(own - elapsed * slope.weight[k]) * zeros_[k].variance;
    }
    return variance;
  }

 private:
  [[nodiscard]] Filtered filtered(double cutoff) const {
    return {.torque = zero_phase_filter(record_.torque_Nm, cutoff),
            .angle = zero_phase_filter(record_.angle_rad, cutoff)};
  }

  [[nodiscard]] int angle_sense() const {
    double mean_t = 0.0;
    double mean_a = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      mean_t += once_.torque[i] / static_cast<double>(n_);
      mean_a += once_.angle[i] / static_cast<double>(n_);
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      sum += (once_.torque[i] - mean_t) * (once_.angle[i] - mean_a);
    }
    return sum < 0.0 ? -1 : 1;
  }

  void find_branches(const std::vector<std::size_t>& turns) {
    branches_.reserve(turns.size() - 1);
    zeros_.reserve(turns.size() - 1);
    for (std::size_t b = 0; b + 1 < turns.size(); ++b) {
      Branch branch{.first = turns[b], .last = turns[b + 1]};
      const double start = once_.torque[branch.first];
      branch.rising = once_.torque[branch.last] > start;
      if (b == 0) {
        const auto [low, high] = std::minmax_element(once_.torque.begin(), once_.torque.end());
        branch.loaded = branch.rising
                            ? start <= kLoadedFraction * std::min(*low, 0.0) && start < 0.0
                            : start >= kLoadedFraction * std::max(*high, 0.0) && start > 0.0;
        // A record that stays on one side of zero says so by kZeroNotCrossed.
        if (*low > 0.0 || *high < 0.0) branch.loaded = true;
      }
      branches_.push_back(branch);
      zeros_.push_back(branch_zero(branch));
    }
  }

  [[nodiscard]] BranchZero branch_zero(const Branch& branch) const {
    BranchZero zero;
    if (!branch.loaded) {
      zero.outcome = LoopOutcome::kPartialBranch;
      return zero;
    }
    const double reach = options_.zero_reach_fraction;
    zero.at = zero_crossing(record_, once_, branch, reach, secant_);
    if (!zero.at) {
      zero.outcome = LoopOutcome::kZeroNotCrossed;
      return zero;
    }
    zero.at_double = zero_crossing(record_, double_, branch, reach, secant_);
    const std::size_t from = branch.first + secant_;
    // Short of zero by the reach of the smoother curve: the dead band's jump may follow.
    const std::size_t to = zero.at->j - std::min(zero.at->j, scatter_reach_);
    if (to < from + kFewestFlankSamples) {
      zero.outcome = LoopOutcome::kTooFewSamples;
      zero.at.reset();
      return zero;
    }
    // Angle per torque where the branch passes zero: turns the scatter of torque into angle.
    const std::size_t before = zero.at->i - std::min(secant_, zero.at->i - branch.first);
    const std::size_t after = std::min(zero.at->j + secant_, branch.last);
    const double torque_span = once_.torque[after] - once_.torque[before];
    const double compliance =
        torque_span != 0.0 ? (once_.angle[after] - once_.angle[before]) / torque_span : 0.0;
    std::vector<double> scatter;
    scatter.reserve(to - from);
    for (std::size_t i = from; i < to; ++i) {
      scatter.push_back(record_.angle_rad[i] - smooth_.angle[i] -
                        compliance * (record_.torque_Nm[i] - smooth_.torque[i]));
    }
    zero.noise = noise_of_left_out(covariance(scatter), left_out_);
    std::vector<double> weight(n_, 0.0);
    add_row(response_, zero.at->i, n_, 1.0 - zero.at->s, weight);
    add_row(response_, zero.at->j, n_, zero.at->s, weight);
    zero.noise_variance = variance_of_sum(zero.noise, weight);
    zero.variance = zero.noise_variance + square(zero.at->spread) / 12.0;
    return zero;
  }

  /// Torque and angle at a turning point: the straight line through the samples that lead to it (at
  /// the record's start: that follow it), without the filter, which would round the turn.
  [[nodiscard]] LineFit at_turn(std::size_t turn) const {
    const bool lead = turn >= secant_;
    const std::size_t from = lead ? turn - secant_ : turn;
    const auto count = static_cast<double>(secant_ + 1);
    const double mean_x = 0.5 * static_cast<double>(secant_);
    LineFit mean;
    LineFit slope;
    double sum_xx = 0.0;
    for (std::size_t k = 0; k <= secant_; ++k) {
      const double x = static_cast<double>(k) - mean_x;
      sum_xx += x * x;
      mean.torque += record_.torque_Nm[from + k] / count;
      mean.angle += record_.angle_rad[from + k] / count;
      slope.torque += x * record_.torque_Nm[from + k];
      slope.angle += x * record_.angle_rad[from + k];
    }
    const double x = (lead ? 1.0 : -1.0) * mean_x / sum_xx;
    return {.torque = mean.torque + x * slope.torque, .angle = mean.angle + x * slope.angle};
  }

  /// The branch that loads one side of loop b up to at least half of the loop's peak there: its
  /// own, else the one before it.
  [[nodiscard]] const Branch* loading_branch(std::size_t b, bool positive, double peak) const {
    const std::size_t own = branches_[b].rising == positive ? b : b + 1;
    const auto reaches = [&](std::size_t k) {
      const double end = once_.torque[branches_[k].last];
      return positive ? end > 0.0 && end >= kLoadedFraction * peak
                      : end < 0.0 && end <= kLoadedFraction * peak;
    };
    if (reaches(own)) return &branches_[own];
    if (own >= 2 && reaches(own - 2)) return &branches_[own - 2];
    return nullptr;
  }

  /// Slope of torque over angle on the upper part of a loading flank, both regressed on the index.
  [[nodiscard]] std::optional<FlankStiffness> stiffness(const Branch& branch) const {
    const double peak = once_.torque[branch.last];
    std::size_t first = branch.last;
    while (first > branch.first && choice_[first - 1] / peak >= kStiffnessFrom) --first;
    std::size_t last = first;
    while (last < branch.last && choice_[last + 1] / peak <= kStiffnessTo) ++last;
    const std::size_t count = last - first + 1;
    if (count < kFewestFlankSamples) return std::nullopt;
    const double mean_x = 0.5 * static_cast<double>(first + last);
    double mean_t = 0.0;
    double mean_a = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      mean_t += record_.torque_Nm[i] / static_cast<double>(count);
      mean_a += record_.angle_rad[i] / static_cast<double>(count);
    }
    double torque = 0.0;
    double angle = 0.0;
    double sum_xx = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      const double x = static_cast<double>(i) - mean_x;
      sum_xx += x * x;
      torque += x * (record_.torque_Nm[i] - mean_t);
      angle += x * (record_.angle_rad[i] - mean_a);
    }
    const double k = angle != 0.0 ? torque / angle : 0.0;
    if (!(k * sense_ > 0.0)) return std::nullopt;
    std::vector<double> residual;
    residual.reserve(count);
    for (std::size_t i = first; i <= last; ++i) {
      residual.push_back(record_.torque_Nm[i] - mean_t - k * (record_.angle_rad[i] - mean_a));
    }
    const Noise noise = noise_of_residuals(residual, 2.0);
    const double deviation =
        std::sqrt(noise.variance * inflation(noise) * sum_xx) / std::abs(angle);
    if (!std::isfinite(deviation) || kSignificant * deviation > std::abs(k)) return std::nullopt;
    return FlankStiffness{.stiffness_Nm_rad = std::abs(k),
                          .standard_deviation_Nm_rad = deviation,
                          .first_sample = first,
                          .last_sample = last};
  }

  [[nodiscard]] Loop loop(std::size_t b) const {
    const Branch& one = branches_[b];
    const Branch& two = branches_[b + 1];
    Loop loop{.falling_first = two.rising,
              .first_sample = one.first,
              .reversal_sample = one.last,
              .last_sample = two.last};
    const auto [low, high] =
        std::minmax_element(once_.torque.begin() + static_cast<std::ptrdiff_t>(one.first),
                            once_.torque.begin() + static_cast<std::ptrdiff_t>(two.last) + 1);
    loop.lowest_torque_Nm = *low;
    loop.highest_torque_Nm = *high;
    measure_flanks(b, loop);
    measure_zero(b, loop);
    return loop;
  }

  void measure_flanks(std::size_t b, Loop& loop) const {
    const Branch* rise = loading_branch(b, true, loop.highest_torque_Nm);
    const Branch* fall = loading_branch(b, false, loop.lowest_torque_Nm);
    if (rise != nullptr) loop.stiffness_positive = stiffness(*rise);
    if (fall != nullptr) loop.stiffness_negative = stiffness(*fall);
    if (loop.stiffness_positive && loop.stiffness_negative) {
      const double k1 = loop.stiffness_positive->stiffness_Nm_rad;
      const double k2 = loop.stiffness_negative->stiffness_Nm_rad;
      loop.asymmetry = 2.0 * (k1 - k2) / (k1 + k2);
    }
    if (rise == nullptr || fall == nullptr) return;
    const double peak = std::min(once_.torque[rise->last], -once_.torque[fall->last]);
    loop.travel.reserve(options_.travel_levels.size());
    for (const double level : options_.travel_levels) {
      // Below that a branch without history has not yet merged with the loop.
      if (level < kLoadedFraction && !(rise->loaded && fall->loaded)) continue;
      const auto up = crossing(record_, once_, *rise, level * peak);
      const auto down = crossing(record_, once_, *fall, -level * peak);
      if (!up || !down) continue;
      loop.travel.push_back(
          {.torque_Nm = level * peak, .angle_rad = sense_ * (up->angle - down->angle)});
    }
  }

  void measure_zero(std::size_t b, Loop& loop) const {
    const BranchZero& one = zeros_[b];
    const BranchZero& two = zeros_[b + 1];
    loop.outcome = one.outcome != LoopOutcome::kMeasured ? one.outcome : two.outcome;
    if (loop.outcome != LoopOutcome::kMeasured) return;
    const BranchZero& fall = branches_[b].rising ? two : one;
    const BranchZero& rise = branches_[b].rising ? one : two;
    loop.falling_zero_angle_rad = fall.at->angle;
    loop.rising_zero_angle_rad = rise.at->angle;
    loop.lost_motion_rad = sense_ * (fall.at->angle - rise.at->angle);
    loop.lost_motion_sd_rad = std::sqrt(fall.variance + rise.variance);
    loop.extrapolated_torque_Nm = std::max(fall.at->extrapolated, rise.at->extrapolated);

    const double rounding = kRoundingFraction * range(once_.angle);
    const double lost = std::abs(loop.lost_motion_rad);
    if (fall.at_double && rise.at_double) {
      loop.change_at_double_cutoff_rad =
          sense_ * (fall.at_double->angle - rise.at_double->angle) - loop.lost_motion_rad;
      if (std::abs(loop.change_at_double_cutoff_rad) >
          std::max({options_.filter_fraction * lost, kSignificant * loop.lost_motion_sd_rad,
                    rounding})) {
        loop.outcome = LoopOutcome::kDependsOnFilter;
      }
    } else {
      loop.outcome = LoopOutcome::kDependsOnFilter;
    }

    const double spread = std::max(fall.at->spread, rise.at->spread);
    const double noise = std::sqrt(std::max(fall.noise_variance, rise.noise_variance));
    if (spread > std::max({options_.filter_fraction * lost, kManyDeviations * noise, rounding})) {
      loop.outcome = LoopOutcome::kZeroAmbiguous;
    }

    const LineFit start = at_turn(loop.first_sample);
    const LineFit end = at_turn(loop.last_sample);
    const auto& k = start.torque > 0.0 ? loop.stiffness_positive : loop.stiffness_negative;
    if (!k || std::abs(end.torque - start.torque) > kSamePeakFraction * std::abs(start.torque)) {
      return;
    }
    loop.closing_error_rad =
        end.angle - start.angle - sense_ * (end.torque - start.torque) / k->stiffness_Nm_rad;
    if (std::abs(*loop.closing_error_rad) >
        std::max(
            {options_.closing_fraction * lost, kSignificant * closing_deviation(b), rounding})) {
      loop.outcome = LoopOutcome::kDoesNotClose;
    }
  }

  /// The end of a straight line through m values has the variance 4 σ²/m.
  [[nodiscard]] double closing_deviation(std::size_t b) const {
    double variance = 0.0;
    for (const std::size_t k : {b, b + 1}) {
      variance += 4.0 / static_cast<double>(secant_ + 1) * zeros_[k].noise.variance *
                  std::max(1.0, inflation(zeros_[k].noise));
    }
    return std::sqrt(variance);
  }

  /// Slope in time that branches of the same sense have in common at zero torque.
  struct Slope {
    bool repeats = false;
    std::vector<double> weight;  ///< of each branch's angle in the slope
  };

  [[nodiscard]] Slope common_slope() const {
    Slope slope{.weight = std::vector<double>(zeros_.size(), 0.0)};
    double sum_tt = 0.0;
    for (const bool rising : {false, true}) {
      double mean = 0.0;
      double count = 0.0;
      for (std::size_t k = 0; k < zeros_.size(); ++k) {
        if (branches_[k].rising != rising || !zeros_[k].at) continue;
        mean += zeros_[k].at->time;
        count += 1.0;
      }
      if (count == 0.0) continue;
      mean /= count;
      for (std::size_t k = 0; k < zeros_.size(); ++k) {
        if (branches_[k].rising != rising || !zeros_[k].at) continue;
        slope.weight[k] = zeros_[k].at->time - mean;
        sum_tt += square(slope.weight[k]);
      }
    }
    slope.repeats = sum_tt > 0.0;
    if (slope.repeats) {
      for (double& w : slope.weight) w /= sum_tt;
    }
    return slope;
  }

  [[nodiscard]] std::optional<Creep> creep(const std::vector<Loop>& loops) const {
    Creep creep;
    double duration = 0.0;
    for (const Loop& l : loops) {
      duration += (record_.time_s[l.last_sample] - record_.time_s[l.first_sample]) /
                  static_cast<double>(loops.size());
    }
    const Slope slope = common_slope();
    if (slope.repeats) {
      double variance = 0.0;
      for (std::size_t k = 0; k < zeros_.size(); ++k) {
        if (slope.weight[k] == 0.0) continue;
        creep.rad_s += slope.weight[k] * zeros_[k].at->angle;
        variance += square(slope.weight[k]) * zeros_[k].variance;
      }
      creep.standard_deviation_rad_s = std::sqrt(variance);
    } else {
      std::size_t b = 0;
      while (b < loops.size() && !loops[b].closing_error_rad) ++b;
      if (b == loops.size()) return std::nullopt;
      const double own =
          record_.time_s[loops[b].last_sample] - record_.time_s[loops[b].first_sample];
      if (!(own > 0.0)) return std::nullopt;
      creep.rad_s = *loops[b].closing_error_rad / own;
      creep.standard_deviation_rad_s = closing_deviation(b) / own;
    }
    creep.rad_per_loop = creep.rad_s * duration;
    return creep;
  }

  const TorqueAngleRecord& record_;
  const LoopOptions& options_;
  double cutoff_;
  std::size_t n_;
  std::size_t secant_;  ///< samples over which the filter averages
  std::size_t scatter_reach_;
  std::vector<double> response_;
  LeftOut left_out_;
  Filtered once_, double_;
  Filtered smooth_;             ///< about which scatter is taken
  std::vector<double> choice_;  ///< torque that chooses the part of a flank
  std::vector<Branch> branches_;
  std::vector<BranchZero> zeros_;  ///< by branch
  int sense_ = 1;
};

// --- input --------------------------------------------------------------------------------------

void check_column(const std::vector<double>& x, std::string_view name, std::size_t size) {
  if (x.size() != size) {
    throw std::invalid_argument(
        fmt::format("{} has {} values where time_s has {}", name, x.size(), size));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) {
      throw std::invalid_argument(fmt::format("{}[{}] = {} is not finite", name, i, x[i]));
    }
  }
}

void check_fraction(double x, std::string_view name) {
  if (!(x > 0.0 && x < 1.0)) {
    throw std::invalid_argument(fmt::format("{} = {} is not between 0 and 1", name, x));
  }
}

void check(const TorqueAngleRecord& record, const LoopOptions& options) {
  check_column(record.time_s, "time_s", record.time_s.size());
  check_column(record.angle_rad, "angle_rad", record.time_s.size());
  check_column(record.torque_Nm, "torque_Nm", record.time_s.size());
  for (std::size_t i = 1; i < record.time_s.size(); ++i) {
    if (record.time_s[i] < record.time_s[i - 1]) {
      throw std::invalid_argument(fmt::format("time_s[{}] = {} is before time_s[{}] = {}", i,
                                              record.time_s[i], i - 1, record.time_s[i - 1]));
    }
  }
  if (options.cutoff_Hz && !(*options.cutoff_Hz > 0.0 && std::isfinite(*options.cutoff_Hz))) {
    throw std::invalid_argument(fmt::format("cutoff_Hz = {} is not above 0", *options.cutoff_Hz));
  }
  check_fraction(options.reversal_fraction, "reversal_fraction");
  check_fraction(options.zero_reach_fraction, "zero_reach_fraction");
  check_fraction(options.closing_fraction, "closing_fraction");
  check_fraction(options.filter_fraction, "filter_fraction");
  for (const double level : options.travel_levels) check_fraction(level, "travel_levels");
}

double median_step(const std::vector<double>& time) {
  if (time.size() < 2) return 0.0;
  std::vector<double> step;
  step.reserve(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) step.push_back(time[i] - time[i - 1]);
  const auto middle = step.begin() + static_cast<std::ptrdiff_t>(step.size() / 2);
  std::nth_element(step.begin(), middle, step.end());
  return *middle;
}

/// A loop lasts twice its longest branch.
double samples_per_loop(const std::vector<std::size_t>& turns) {
  std::size_t longest = 1;
  for (std::size_t b = 0; b + 1 < turns.size(); ++b) {
    longest = std::max(longest, turns[b + 1] - turns[b]);
  }
  return 2.0 * static_cast<double>(longest);
}

}  // namespace

std::string_view loop_outcome_text(LoopOutcome outcome) {
  switch (outcome) {
    case LoopOutcome::kMeasured:
      return "measured";
    case LoopOutcome::kPartialBranch:
      return "a branch begins with the record, not after load from the other side";
    case LoopOutcome::kZeroNotCrossed:
      return "a branch does not reach zero torque";
    case LoopOutcome::kTooFewSamples:
      return "too few samples between a reversal and zero torque";
    case LoopOutcome::kDoesNotClose:
      return "the loop does not close";
    case LoopOutcome::kZeroAmbiguous:
      return "the torque rests at zero, or passes it more than once, over an angle";
    case LoopOutcome::kDependsOnFilter:
      return "the lost motion depends on the filter's cut-off";
  }
  throw std::invalid_argument("unknown LoopOutcome");
}

std::string_view record_outcome_text(RecordOutcome outcome) {
  switch (outcome) {
    case RecordOutcome::kLoops:
      return "loops found";
    case RecordOutcome::kTooFewSamples:
      return "fewer samples than the filter needs";
    case RecordOutcome::kTooFewReversals:
      return "the torque never turns";
  }
  throw std::invalid_argument("unknown RecordOutcome");
}

std::size_t filter_padding(double cutoff_per_sample) {
  if (!(cutoff_per_sample > 0.0 && cutoff_per_sample < 0.5)) {
    throw std::invalid_argument(
        fmt::format("cutoff_per_sample = {} is not between 0 and 0.5", cutoff_per_sample));
  }
  return static_cast<std::size_t>(std::ceil(3.0 / cutoff_per_sample));
}

std::vector<double> zero_phase_filter(const std::vector<double>& signal, double cutoff_per_sample) {
  const std::size_t pad = filter_padding(cutoff_per_sample);
  const std::size_t n = signal.size();
  if (n <= pad) {
    throw std::invalid_argument(
        fmt::format("{} samples are too few to continue each end by {}", n, pad));
  }
  std::vector<double> x;
  x.reserve(n + 2 * pad);
  for (std::size_t k = pad; k > 0; --k) x.push_back(2.0 * signal.front() - signal[k]);
  x.insert(x.end(), signal.begin(), signal.end());
  for (std::size_t k = 1; k <= pad; ++k) x.push_back(2.0 * signal.back() - signal[n - 1 - k]);
  const Biquad filter = butterworth(cutoff_per_sample);
  pass(filter, x.begin(), x.end());
  pass(filter, x.rbegin(), x.rend());
  const auto first = x.begin() + static_cast<std::ptrdiff_t>(pad);
  return {first, first + static_cast<std::ptrdiff_t>(n)};
}

LoopAnalysis analyse_loops(const TorqueAngleRecord& record, const LoopOptions& options) {
  check(record, options);
  LoopAnalysis refused;
  const std::size_t n = record.time_s.size();
  if (n < 2 * kFewestFlankSamples) {
    refused.outcome = RecordOutcome::kTooFewSamples;
    return refused;
  }
  const double step = median_step(record.time_s);
  const std::vector<std::size_t> raw_turns =
      turning_points(record.torque_Nm, kRawReversalFraction * range(record.torque_Nm));
  if (raw_turns.size() < 2) {
    refused.outcome = RecordOutcome::kTooFewReversals;
    return refused;
  }
  const double period = samples_per_loop(raw_turns);
  double cutoff = std::min(0.25, kCutoffHarmonic / period);
  if (options.cutoff_Hz) {
    if (!(*options.cutoff_Hz * step < 0.5 && step > 0.0)) {
      throw std::invalid_argument(
          fmt::format("cutoff_Hz = {} is not below half the sampling frequency of 1/({} s)",
                      *options.cutoff_Hz, step));
    }
    cutoff = *options.cutoff_Hz * step;
  }
  refused.cutoff_per_sample = cutoff;
  if (n <= filter_padding(cutoff)) {
    refused.outcome = RecordOutcome::kTooFewSamples;
    return refused;
  }

  const auto finish = [step](LoopAnalysis analysis) {
    analysis.cutoff_Hz = step > 0.0 ? analysis.cutoff_per_sample / step : 0.0;
    return analysis;
  };
  LoopAnalysis found = Analysis(record, options, cutoff, period).run();
  if (!options.remove_creep || !found.creep) return finish(std::move(found));
  TorqueAngleRecord steady = record;
  for (std::size_t i = 0; i < n; ++i) {
    steady.angle_rad[i] -= found.creep->rad_s * (record.time_s[i] - record.time_s.front());
  }
  Analysis again(steady, options, cutoff, period);
  LoopAnalysis result = again.run();
  result.creep = found.creep;
  for (std::size_t b = 0; b < result.loops.size(); ++b) {
    Loop& loop = result.loops[b];
    if (loop.lost_motion_sd_rad == 0.0) continue;
    loop.lost_motion_sd_rad =
        std::sqrt(again.variance_without_creep(b, square(found.creep->standard_deviation_rad_s)));
  }
  return finish(std::move(result));
}

}  // namespace gear3k::calibrate
