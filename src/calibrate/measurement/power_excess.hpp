#pragma once
// By how much rows give more power than they take.

#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Of a row, in its response: above 0 more power comes out than goes in.
struct PowerExcess {
  double excess = 0.0;
  double allowed = 0.0;  ///< what noise may do: 3 standard deviations, 1 % of `ideal` at least
  double ideal = 1.0;    ///< response of a transmission without loss, T_out/|i|; pair_loss: 1

  [[nodiscard]] bool impossible() const { return excess > allowed; }
  [[nodiscard]] bool lossy() const { return -excess > allowed; }
};

/// +1 where what is lost raises the response (forward), −1 where it lowers it.
double losing_sign(const Condition& c);

/// Of each row.
///
///   forward  T_out/|i| − T_sun,  backward  T_sun − T_out/|i|,  pair_loss  −loss
///
/// Where the rows state no sigma it is estimated from the scatter of neighbours in load, which
/// repeats are too.
/// @param set    of transmission or pair_loss
/// @param ratio  i, finite and not 0; pair_loss: not used
std::vector<PowerExcess> power_excess(const MeasurementSet& set, double ratio);

}  // namespace gear3k::calibrate
