#pragma once
// A duty cycle: load torque and motion of the output over time.

#include <optional>
#include <string>
#include <vector>

#include "actuator/polynomial.hpp"

namespace gear3k::actuator {

/// Rows of a cycle.  It is these rows joined by straight lines in torque and speed; angles are
/// joined by a cubic spline.
struct Cycle {
  std::string name;
  std::vector<double> time_s;   ///< strictly increasing, two or more
  std::vector<double> load_Nm;  ///< T_L: of the load on the output
  std::vector<double> motion;   ///< output speed [rad/s], or angle [rad]
  bool angles = false;          ///< what `motion` holds
};

/// One interval between rows, over x = (t − t_0)/duration in [0, 1].
struct CyclePiece {
  double duration_s = 0.0;
  Quadratic speed_rad_s{};
  Quadratic load_Nm{};  ///< a straight line

  [[nodiscard]] double acceleration(double x) const {
    return slope_at(speed_rad_s, x) / duration_s;
  }
  [[nodiscard]] bool rests() const {
    return speed_rad_s[0] == 0.0 && speed_rad_s[1] == 0.0 && speed_rad_s[2] == 0.0;
  }
};

/// Whether the last row repeats the first, to 1e-9 of the greatest magnitude of each column.
bool is_periodic(const Cycle& cycle);

/// The intervals of a cycle.
///
/// Angles: the interpolating cubic spline, periodic where the cycle is, else not-a-knot (three
/// rows: a parabola, two: a line); its derivative is the speed. Source: continuity of value, slope
/// and curvature; docs/theory §60.
/// @throws std::invalid_argument unless there are two rows of like length and times increase
std::vector<CyclePiece> pieces_of(const Cycle& cycle);

}  // namespace gear3k::actuator
