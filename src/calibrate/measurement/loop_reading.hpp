#pragma once
// What one torque-angle loop says of lost motion: between its branches at zero torque, and between
// its loading flanks.

#include <array>
#include <vector>

#include "calibrate/loops/correlated_noise.hpp"
#include "calibrate/loops/torque_angle_loop.hpp"

namespace gear3k::calibrate {

/// Fractions of the smallest peak torque of all loops at which travel is read, as the mean over
/// kTravelBand to either side (less would leave the noise of single samples).  Between the bands
/// there is more than the filter smooths over, so that neighbours do not share samples.
inline constexpr std::array<double, 6> kTravelFractions{0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
inline constexpr double kTravelBand = 0.04;

/// Mean travel about a torque.
struct TravelReading {
  double torque_Nm = 0.0, angle_rad = 0.0;
  double variance_rad2 = 0.0;  ///< by the noise of both flanks; 0: not known
  /// Where the flanks pass the torque, in samples of the record, between two of them.
  double fall_sample = 0.0, rise_sample = 0.0;
};

struct LoopReading {
  bool tells_zero = true;  ///< else there is no reading at zero torque
  double zero_rad = 0.0;   ///< between the branches at zero torque
  double zero_variance_rad2 = 0.0;
  std::vector<TravelReading> travel{};
};

/// The travels of a loop that has some at Loop::travel 1 % of its peak apart.
///
/// The variance of a travel is that of its mean over the band,
///
///   σ² Σ_j Σ_l w_j w_l φ^|j-l|
///
/// of both flanks, with the weights w of their samples in the filtered angles; that of θ(0) is at
/// least what the same noise makes there.
///
/// Source: own derivation, docs/theory §31 (uncertainty).
/// @param noise     LoopAnalysis::flank_noise of the loop's record
/// @param response  impulse_response() of its filter
/// @param peak_Nm   of which kTravelFractions are
LoopReading read_loop(const Loop& loop, const CorrelatedNoise& noise,
                      const std::vector<double>& response, double peak_Nm);

}  // namespace gear3k::calibrate
