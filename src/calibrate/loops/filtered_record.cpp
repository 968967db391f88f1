#include "calibrate/loops/filtered_record.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/loops/zero_phase_filter.hpp"

namespace gear3k::calibrate {
namespace {

/// Cut-off, in units of the loop's frequency, under which a flank's part is chosen by its torque:
/// so low that the noise in that choice leaves the slope unbiased.
constexpr double kChoiceHarmonic = 15.0;
/// The same for the curve about which scatter is taken: the wider the filter's own pass band, the
/// less of the noise is left to tell its correlation from.
constexpr double kScatterHarmonic = 60.0;

TorqueAngleCurve filtered(const TorqueAngleRecord& record, double cutoff_per_sample) {
  return {.torque_Nm = zero_phase_filter(record.torque_Nm, cutoff_per_sample),
          .angle_rad = zero_phase_filter(record.angle_rad, cutoff_per_sample)};
}

/// Sign of the covariance of torque and angle.
int angle_sense(const TorqueAngleCurve& curve) {
  const std::size_t n = curve.torque_Nm.size();
  double mean_t = 0.0;
  double mean_a = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    mean_t += curve.torque_Nm[i] / static_cast<double>(n);
    mean_a += curve.angle_rad[i] / static_cast<double>(n);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    sum += (curve.torque_Nm[i] - mean_t) * (curve.angle_rad[i] - mean_a);
  }
  return sum < 0.0 ? -1 : 1;
}

}  // namespace

FilteredRecord filter_record(TorqueAngleRecord record, double cutoff_per_sample,
                             double samples_per_loop) {
  const double cutoff = cutoff_per_sample;
  FilteredRecord f;
  f.raw = std::move(record);
  f.cutoff_per_sample = cutoff;
  f.secant = static_cast<std::size_t>(std::ceil(0.5 / cutoff));
  f.response = impulse_response(cutoff);
  f.once = filtered(f.raw, cutoff);
  f.twice = filtered(f.raw, std::min(2.0 * cutoff, 0.5 * (cutoff + 0.5)));
  const double scatter_cutoff = std::min(cutoff, kScatterHarmonic / samples_per_loop);
  f.scatter_reach = static_cast<std::size_t>(std::ceil(1.0 / scatter_cutoff));
  f.smooth = filtered(f.raw, scatter_cutoff);
  f.left_out = left_out_spectrum(scatter_cutoff);
  const double low = kChoiceHarmonic / samples_per_loop;
  f.choice_Nm = low < cutoff && f.raw.torque_Nm.size() > filter_padding(low)
                    ? zero_phase_filter(f.raw.torque_Nm, low)
                    : f.once.torque_Nm;
  f.angle_sense = angle_sense(f.once);
  return f;
}

std::vector<double> angle_scatter(const FilteredRecord& f, std::size_t from, std::size_t to,
                                  double compliance) {
  std::vector<double> scatter;
  scatter.reserve(to - from);
  for (std::size_t i = from; i < to; ++i) {
    scatter.push_back(f.raw.angle_rad[i] - f.smooth.angle_rad[i] -
                      compliance * (f.raw.torque_Nm[i] - f.smooth.torque_Nm[i]));
  }
  return scatter;
}

}  // namespace gear3k::calibrate
