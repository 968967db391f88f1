#pragma once
// A torque-angle record next to what the filter makes of it.

#include <cstddef>
#include <vector>

#include "calibrate/loops/correlated_noise.hpp"
#include "calibrate/loops/torque_angle_loop.hpp"
#include "calibrate/loops/torque_branch.hpp"

namespace gear3k::calibrate {

struct FilteredRecord {
  TorqueAngleRecord raw;
  double cutoff_per_sample = 0.0;
  std::size_t secant = 0;         ///< samples over which the filter averages, 1/(2 f_c)
  std::vector<double> response;   ///< impulse_response() of the filter
  TorqueAngleCurve once;          ///< at the cut-off
  TorqueAngleCurve twice;         ///< at twice the cut-off, below 1/2: tells what depends on it
  TorqueAngleCurve smooth;        ///< about which scatter is taken
  std::size_t scatter_reach = 0;  ///< samples over which a jump disturbs that curve, 1/f_c
  LeftOutSpectrum left_out;       ///< of noise, by that curve
  std::vector<double> choice_Nm;  ///< torque that chooses the part of a flank
  int angle_sense = 1;            ///< -1: the angle falls where the torque rises
};

/// Filters torque and angle alike, over the index of the samples.
///
/// Scatter is taken about a curve of at most 60 cycles per loop, and the part of a flank chosen by
/// a torque of at most 15 cycles per loop, where the record is long enough for that filter.
/// Source: docs/theory §31, eq. 31.1 and its uncertainty.
/// Valid: columns of equal length above filter_padding() of both cut-offs, the given one and that
/// for the scatter.
/// @throws std::invalid_argument as zero_phase_filter()
FilteredRecord filter_record(TorqueAngleRecord record, double cutoff_per_sample,
                             double samples_per_loop);

/// Scatter of the angle from one sample to before another, that of the torque turned into angle.
///
///   u_i = (θ - θ̂)_i - c (T - T̂)_i          about the smooth curve
///
/// Source: docs/theory §31 (uncertainty).  Valid: no jump within `scatter_reach` of those samples.
/// @param compliance  c, of the angle per torque there [rad/Nm]
/// @returns of each sample [rad]; noise_of_left_out() of them and the record's `left_out` is that
/// of the angle
std::vector<double> angle_scatter(const FilteredRecord& record, std::size_t from, std::size_t to,
                                  double compliance);

}  // namespace gear3k::calibrate
