#pragma once
// Quantities that a scenario prescribes over time.

#include <cstddef>
#include <vector>

namespace gear3k::motion {

/// constant + amplitude sin(2π f t + phase) + the rows of a table, joined by straight lines.
///
/// Before the first row the table has its first value, after the last one its last.  Two rows of
/// the same time are a jump.
struct Signal {
  double constant = 0.0;
  double amplitude = 0.0, frequency_Hz = 0.0, phase_rad = 0.0;
  std::vector<double> time_s{}, value{};  ///< times do not decrease
};

/// The piece of the table that holds from t on: k between the rows k − 1 and k.
std::size_t piece_from(const Signal& signal, double time_s);
/// Value and slope of the signal with a piece's straight line, also beyond its ends: both are
/// smooth within a piece, and one-sided at its ends.
double value_at(const Signal& signal, double time_s, std::size_t piece);
double slope_at(const Signal& signal, double time_s, std::size_t piece);

}  // namespace gear3k::motion
