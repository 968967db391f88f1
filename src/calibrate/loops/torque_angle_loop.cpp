#include "calibrate/loops/torque_angle_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "calibrate/loops/branch_zero.hpp"
#include "calibrate/loops/filtered_record.hpp"
#include "calibrate/loops/flank_stiffness.hpp"
#include "calibrate/loops/loop_closing.hpp"
#include "calibrate/loops/loop_creep.hpp"
#include "calibrate/loops/torque_branch.hpp"
#include "calibrate/loops/zero_before_jump.hpp"
#include "calibrate/loops/zero_phase_filter.hpp"
#include "numerics/median.hpp"

namespace gear3k::calibrate {
namespace {

/// Swing of the unfiltered torque, as a fraction of its range, that counts in the first search.
constexpr double kRawReversalFraction = 0.5;
constexpr double kSignificantMotion = 3.0;  ///< standard deviations
/// Noise alone may pass zero torque several times, so far apart in angle [standard deviations].
constexpr double kManyDeviations = 6.0;
/// Differences below this fraction of the range of the angle are rounding.
constexpr double kRoundingFraction = 1e-6;

/// A record taken apart into branches, of which neighbours make a loop.
struct BranchedRecord {
  FilteredRecord filtered;
  std::vector<Branch> branches;
  std::vector<BranchZero> zeros;  ///< by branch
  double rounding_rad = 0.0;      ///< smaller differences of the angle are rounding
};

BranchedRecord branch_record(FilteredRecord filtered, const std::vector<std::size_t>& turns,
                             double zero_reach_fraction) {
  BranchedRecord r;
  r.filtered = std::move(filtered);
  const TorqueAngleCurve& curve = r.filtered.once;
  r.branches = find_branches(curve, turns);
  r.zeros.reserve(r.branches.size());
  for (const Branch& branch : r.branches) {
    r.zeros.push_back(find_branch_zero(r.filtered, branch, zero_reach_fraction));
  }
  r.zeros = zeros_before_jumps(r.filtered, r.branches, std::move(r.zeros));
  const auto [low, high] = std::minmax_element(curve.angle_rad.begin(), curve.angle_rad.end());
  r.rounding_rad = kRoundingFraction * (*high - *low);
  return r;
}

// --- one loop -----------------------------------------------------------------------------------

double place_of(const Crossing& at) {
  return static_cast<double>(at.i) + at.s * static_cast<double>(at.j - at.i);
}

/// Between the loading flanks at fractions of the smaller of their peaks (eq. 31.2).
std::vector<TravelAtTorque> travel_between(const FilteredRecord& f, const Branch& rise,
                                           const Branch& fall, const std::vector<double>& levels) {
  const double peak = std::min(f.once.torque_Nm[rise.last], -f.once.torque_Nm[fall.last]);
  std::vector<TravelAtTorque> travel;
  travel.reserve(levels.size());
  for (const double level : levels) {
    // Below that a branch without history has not yet merged with the loop.
    if (level < kLoadedFraction && !(rise.loaded && fall.loaded)) continue;
    const auto up = torque_crossing(f.raw.time_s, f.once, rise, level * peak);
    const auto down = torque_crossing(f.raw.time_s, f.once, fall, -level * peak);
    if (!up || !down) continue;
    travel.push_back({.torque_Nm = level * peak,
                      .angle_rad = f.angle_sense * (up->angle_rad - down->angle_rad),
                      .fall_sample = place_of(*down),
                      .rise_sample = place_of(*up)});
  }
  return travel;
}

/// Samples, peaks, stiffness and travel of the loop of branches b and b + 1.
Loop measure_flanks(const BranchedRecord& r, const LoopOptions& options, std::size_t b) {
  const FilteredRecord& f = r.filtered;
  const Branch& one = r.branches[b];
  const Branch& two = r.branches[b + 1];
  const auto first = f.once.torque_Nm.begin() + static_cast<std::ptrdiff_t>(one.first);
  const auto end = f.once.torque_Nm.begin() + static_cast<std::ptrdiff_t>(two.last) + 1;
  const auto [low, high] = std::minmax_element(first, end);
  Loop loop{.falling_first = two.rising,
            .first_sample = one.first,
            .reversal_sample = one.last,
            .last_sample = two.last,
            .lowest_torque_Nm = *low,
            .highest_torque_Nm = *high};
  const auto rise = loading_branch(f, r.branches, b, true, loop.highest_torque_Nm);
  const auto fall = loading_branch(f, r.branches, b, false, loop.lowest_torque_Nm);
  if (rise) loop.stiffness_positive = flank_stiffness(f, r.branches[*rise]);
  if (fall) loop.stiffness_negative = flank_stiffness(f, r.branches[*fall]);
  if (loop.stiffness_positive && loop.stiffness_negative) {
    const double k1 = loop.stiffness_positive->stiffness_Nm_rad;
    const double k2 = loop.stiffness_negative->stiffness_Nm_rad;
    loop.asymmetry = 2.0 * (k1 - k2) / (k1 + k2);
  }
  if (rise && fall) {
    loop.travel = travel_between(f, r.branches[*rise], r.branches[*fall], options.travel_levels);
  }
  return loop;
}

/// What keeps a lost motion from being trusted; a later reason hides an earlier one.
LoopOutcome judge(const BranchedRecord& r, const LoopOptions& options, std::size_t b,
                  const Loop& loop) {
  const BranchZero& one = r.zeros[b];
  const BranchZero& two = r.zeros[b + 1];
  const double lost = std::abs(loop.lost_motion_rad);
  LoopOutcome outcome = LoopOutcome::kMeasured;
  if (!(one.at_double && two.at_double) ||
      std::abs(loop.change_at_double_cutoff_rad) >
          std::max({options.filter_fraction * lost, kSignificantMotion * loop.lost_motion_sd_rad,
                    r.rounding_rad})) {
    outcome = LoopOutcome::kDependsOnFilter;
  }
  if (one.at_edge || two.at_edge) outcome = LoopOutcome::kAtEdge;
  const double spread = std::max(one.at->spread_rad, two.at->spread_rad);
  const double noise = std::sqrt(std::max(one.noise_variance_rad2, two.noise_variance_rad2));
  if (spread >
      std::max({options.filter_fraction * lost, kManyDeviations * noise, r.rounding_rad})) {
    outcome = LoopOutcome::kZeroAmbiguous;
  }
  if (loop.closing_error_rad &&
      std::abs(*loop.closing_error_rad) >
          std::max({options.closing_fraction * lost,
                    kSignificantMotion * closing_deviation_rad(r.filtered.secant, one, two),
                    r.rounding_rad})) {
    outcome = LoopOutcome::kDoesNotClose;
  }
  return outcome;
}

Loop measure_loop(const BranchedRecord& r, const LoopOptions& options, std::size_t b) {
  Loop loop = measure_flanks(r, options, b);
  const BranchZero& one = r.zeros[b];
  const BranchZero& two = r.zeros[b + 1];
  loop.outcome = one.outcome != LoopOutcome::kMeasured ? one.outcome : two.outcome;
  if (loop.outcome != LoopOutcome::kMeasured) return loop;
  const BranchZero& fall = one.rising ? two : one;
  const BranchZero& rise = one.rising ? one : two;
  const int sense = r.filtered.angle_sense;
  loop.falling_zero_angle_rad = fall.at->angle_rad;
  loop.rising_zero_angle_rad = rise.at->angle_rad;
  loop.falling_zero_sample = place_of(*fall.at);
  loop.rising_zero_sample = place_of(*rise.at);
  loop.lost_motion_rad = sense * (fall.at->angle_rad - rise.at->angle_rad);
  loop.lost_motion_sd_rad = std::sqrt(fall.variance_rad2 + rise.variance_rad2);
  loop.extrapolated_torque_Nm = std::max(fall.at->extrapolated_Nm, rise.at->extrapolated_Nm);
  if (fall.at_double && rise.at_double) {
    loop.change_at_double_cutoff_rad =
        sense * (fall.at_double->angle_rad - rise.at_double->angle_rad) - loop.lost_motion_rad;
  }
  loop.closing_error_rad = closing_error_rad(r.filtered, loop);
  loop.outcome = judge(r, options, b, loop);
  return loop;
}

/// Of the angle on the loading flanks of all loops, beyond the dead band and short of the turn. One
/// flank is too few samples to tell how its noise correlates.
CorrelatedNoise flank_noise(const BranchedRecord& r) {
  constexpr double kFrom = 0.25;
  const FilteredRecord& f = r.filtered;
  std::vector<double> scatter;
  for (const Branch& branch : r.branches) {
    const double peak = f.once.torque_Nm[branch.last];
    if ((peak > 0.0) != branch.rising) continue;
    const auto from = torque_crossing(f.raw.time_s, f.once, branch, kFrom * peak);
    const auto to = torque_crossing(f.raw.time_s, f.once, branch, kStiffnessTo * peak);
    if (!from || !to || to->i < from->i + kFewestFlankSamples) continue;
    const double compliance = (to->angle_rad - from->angle_rad) / ((kStiffnessTo - kFrom) * peak);
    const std::vector<double> more = angle_scatter(f, from->i, to->i, compliance);
    scatter.insert(scatter.end(), more.begin(), more.end());
  }
  return scatter.empty() ? CorrelatedNoise{} : noise_of_left_out(scatter, f.left_out);
}

// --- one record ---------------------------------------------------------------------------------

LoopAnalysis measure_record(FilteredRecord filtered, const LoopOptions& options) {
  LoopAnalysis analysis;
  analysis.cutoff_per_sample = filtered.cutoff_per_sample;
  const std::vector<std::size_t> turns =
      turning_points(filtered.once.torque_Nm, options.reversal_fraction);
  if (turns.size() < 3) {
    analysis.outcome = RecordOutcome::kTooFewReversals;
    return analysis;
  }
  analysis.angle_sense = filtered.angle_sense;
  const BranchedRecord r = branch_record(std::move(filtered), turns, options.zero_reach_fraction);
  analysis.loops.reserve(r.branches.size() - 1);
  for (std::size_t b = 0; b + 1 < r.branches.size(); ++b) {
    analysis.loops.push_back(measure_loop(r, options, b));
  }
  analysis.flank_noise = flank_noise(r);
  analysis.creep = find_creep(r.filtered, r.zeros, analysis.loops);
  return analysis;
}

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
  return numerics::upper_median(std::move(step));
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
    case LoopOutcome::kAtEdge:
      return "zero torque is too near to the dead band's edge";
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

std::string_view loop_outcome_remedy(LoopOutcome outcome) {
  switch (outcome) {
    case LoopOutcome::kMeasured:
      return "";
    case LoopOutcome::kPartialBranch:
      return "go on for another full loop, or begin at the peak torque";
    case LoopOutcome::kZeroNotCrossed:
      return "lead the torque through zero to both sides, and check its offset";
    case LoopOutcome::kTooFewSamples:
      return "sample faster or turn slower: 200 samples per loop and more";
    case LoopOutcome::kDoesNotClose:
      return "look for creep, slip or a moved sensor, or let it settle before";
    case LoopOutcome::kZeroAmbiguous:
      return "lead the torque steadily through zero, without a rest there";
    case LoopOutcome::kDependsOnFilter:
    case LoopOutcome::kAtEdge:
      return "sample faster about zero torque";
  }
  throw std::invalid_argument("unknown LoopOutcome");
}

std::string_view record_outcome_remedy(RecordOutcome outcome) {
  switch (outcome) {
    case RecordOutcome::kLoops:
      return "";
    case RecordOutcome::kTooFewSamples:
      return "sample faster or turn slower: 200 samples per loop and more";
    case RecordOutcome::kTooFewReversals:
      return "lead the torque to and fro, for two reversals and more";
  }
  throw std::invalid_argument("unknown RecordOutcome");
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
  const std::vector<std::size_t> raw_turns = turning_points(record.torque_Nm, kRawReversalFraction);
  if (raw_turns.size() < 2) {
    refused.outcome = RecordOutcome::kTooFewReversals;
    return refused;
  }
  const double period = samples_per_loop(raw_turns);
  const double cutoff = std::min(0.25, kCutoffHarmonic / period);
  refused.cutoff_per_sample = cutoff;
  if (n <= filter_padding(cutoff)) {
    refused.outcome = RecordOutcome::kTooFewSamples;
    return refused;
  }

  LoopAnalysis analysis = measure_record(filter_record(record, cutoff, period), options);
  analysis.cutoff_Hz = step > 0.0 ? cutoff / step : 0.0;
  return analysis;
}

}  // namespace gear3k::calibrate
