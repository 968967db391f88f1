#include "motion/signal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gear3k::motion {

namespace {

double turns_per_second(const Signal& signal) {
  return 2.0 * std::numbers::pi * signal.frequency_Hz;
}

/// Slope of a piece; zero before the first row and after the last.
double table_slope(const Signal& signal, std::size_t piece) {
  if (piece == 0 || piece >= signal.time_s.size()) return 0.0;
  return (signal.value[piece] - signal.value[piece - 1]) /
         (signal.time_s[piece] - signal.time_s[piece - 1]);
}

}  // namespace

std::size_t piece_from(const Signal& signal, double time_s) {
  return static_cast<std::size_t>(std::ranges::upper_bound(signal.time_s, time_s) -
                                  signal.time_s.begin());
}

double value_at(const Signal& signal, double time_s, std::size_t piece) {
  double value = signal.constant;
  if (signal.amplitude != 0.0) {
    value += signal.amplitude * std::sin(turns_per_second(signal) * time_s + signal.phase_rad);
  }
  if (signal.time_s.empty()) return value;
  const std::size_t row = piece == 0 ? 0 : piece - 1;
  return value + signal.value[row] + table_slope(signal, piece) * (time_s - signal.time_s[row]);
}

double slope_at(const Signal& signal, double time_s, std::size_t piece) {
  const double turning = turns_per_second(signal);
  return table_slope(signal, piece) +
         signal.amplitude * turning * std::cos(turning * time_s + signal.phase_rad);
}

}  // namespace gear3k::motion
