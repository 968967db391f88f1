#pragma once
// A low-pass filter that delays nothing.

#include <cstddef>
#include <vector>

namespace gear3k::calibrate {

/// Low-pass without phase: Butterworth of second order forward, then backward.
///
///   |H|² = 1/(1 + (tan(π f)/tan(π f_c))⁴)     (f in cycles per sample)
///
/// is the amplitude response of both passes together.  The ends are continued by the signal
/// turned by 180° about its end point, and each pass starts in the steady state of its first value.
/// Source: bilinear transform of the analogue filter; docs/theory §31, eq. 31.1.
/// @returns as many samples as the signal has, in its unit
/// @throws std::invalid_argument unless 0 < f_c < 0.5 and there are more samples than
/// filter_padding()
std::vector<double> zero_phase_filter(const std::vector<double>& signal, double cutoff_per_sample);

/// Samples by which zero_phase_filter() continues each end: the response has decayed to 1e-5.
/// @throws std::invalid_argument unless 0 < f_c < 0.5
std::size_t filter_padding(double cutoff_per_sample);

/// The filter's response to a unit impulse, from its centre on: h_k = h_-k, k = 0 to
/// filter_padding().
/// @throws std::invalid_argument unless 0 < f_c < 0.5
std::vector<double> impulse_response(double cutoff_per_sample);

/// Adds factor times the weights that filtered sample i gives to the samples of a record,
///
///   y_i = Σ_k h_|k| x_(i+k),     x_-j = 2 x_0 - x_j,  x_(n-1+j) = 2 x_(n-1) - x_(n-1-j),
///
/// the continuation of the ends folded back onto them.
/// Source: docs/theory §31 (the weights w of its uncertainty).
/// Valid: i < n = weight.size(), and n above the reach of the response, response.size() - 1.
/// Accuracy: that of the padding, 1e-5 of the record's range.
void add_filter_weights(const std::vector<double>& response, std::size_t i, double factor,
                        std::vector<double>& weight);

}  // namespace gear3k::calibrate
