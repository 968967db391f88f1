#include "calibrate/loops/branch_zero.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "calibrate/loops/zero_phase_filter.hpp"

namespace gear3k::calibrate {
namespace {

/// Angle per torque where the branch passes zero: turns the scatter of torque into angle.
double compliance_at(const Crossing& at, const FilteredRecord& f, const Branch& branch) {
  const std::size_t before = at.i - std::min(f.secant, at.i - branch.first);
  const std::size_t after = std::min(at.j + f.secant, branch.last);
  const double torque_span = f.once.torque_Nm[after] - f.once.torque_Nm[before];
  return torque_span != 0.0 ? (f.once.angle_rad[after] - f.once.angle_rad[before]) / torque_span
                            : 0.0;
}

}  // namespace

BranchZero find_branch_zero(const FilteredRecord& f, const Branch& branch,
                            double zero_reach_fraction) {
  BranchZero zero;
  zero.rising = branch.rising;
  if (!branch.loaded) {
    zero.outcome = LoopOutcome::kPartialBranch;
    return zero;
  }
  const Continuation continuation{.reach_fraction = zero_reach_fraction, .secant = f.secant};
  const auto at = zero_torque_crossing(f.raw.time_s, f.once, branch, continuation);
  if (!at) {
    zero.outcome = LoopOutcome::kZeroNotCrossed;
    return zero;
  }
  const std::size_t from = branch.first + f.secant;
  // Short of zero by the reach of the smoother curve: the dead band's jump may follow.
  const std::size_t to = at->j - std::min(at->j, f.scatter_reach);
  if (to < from + kFewestFlankSamples) {
    zero.outcome = LoopOutcome::kTooFewSamples;
    return zero;
  }
  zero.at = at;
  zero.at_double = zero_torque_crossing(f.raw.time_s, f.twice, branch, continuation);
  zero.noise =
      noise_of_left_out(angle_scatter(f, from, to, compliance_at(*at, f, branch)), f.left_out);
  std::vector<double> weight(f.raw.time_s.size(), 0.0);
  add_filter_weights(f.response, at->i, 1.0 - at->s, weight);
  add_filter_weights(f.response, at->j, at->s, weight);
  zero.noise_variance_rad2 = variance_of_sum(zero.noise, weight);
  zero.variance_rad2 = zero.noise_variance_rad2 + at->spread_rad * at->spread_rad / 12.0;
  return zero;
}

}  // namespace gear3k::calibrate
