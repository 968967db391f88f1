#pragma once
// Branches of a torque-angle record: from one reversal of the torque to the next.

#include <cstddef>
#include <optional>
#include <vector>

namespace gear3k::calibrate {

/// First sample, reversals and last sample of a signal: extrema after which it swings back by more
/// than this fraction of its range.  The first and the last are extrema too, not the record's ends.
/// Source: docs/theory §31 (branches).
/// @returns indices in rising order; empty where the signal never swings so far
std::vector<std::size_t> turning_points(const std::vector<double>& signal, double swing_fraction);

/// Torque and angle sample by sample, filtered alike.
struct TorqueAngleCurve {
  std::vector<double> torque_Nm, angle_rad;
};

/// The samples between neighbouring turning points.
struct Branch {
  std::size_t first = 0, last = 0;
  bool rising = false;  ///< in torque
  bool loaded = true;   ///< begins at a reversal, or well on the side it should come from
};

/// A first branch counts as loaded from the other side when it starts above this fraction of the
/// peak torque there.
inline constexpr double kLoadedFraction = 0.5;

/// The branches between turning points of the curve's torque, in order of time.
///
/// The first begins with the record: it is loaded if it starts at kLoadedFraction of the peak
/// torque or beyond, on the side it comes from.  On a record that stays on one side of zero torque
/// every branch counts as loaded.
/// Source: docs/theory §31 (branches).
/// @returns one branch less than turning points; empty without any
std::vector<Branch> find_branches(const TorqueAngleCurve& curve,
                                  const std::vector<std::size_t>& turns);

/// Where a branch has a torque: the mean of its first and last passage.
struct Crossing {
  double angle_rad = 0.0, time_s = 0.0;
  double spread_rad = 0.0;       ///< between the first and the last passage, ≥ 0
  double extrapolated_Nm = 0.0;  ///< torque between the end of the branch and the level, ≥ 0
  std::size_t i = 0, j = 1;      ///< angle = (1 - s) angle_i + s angle_j, at the first passage
  double s = 0.0;                ///< beyond 1 where extrapolated
};

/// By interpolation between neighbouring samples; empty where the branch does not pass the torque.
std::optional<Crossing> torque_crossing(const std::vector<double>& time_s,
                                        const TorqueAngleCurve& curve, const Branch& branch,
                                        double torque_Nm);

/// How far a branch that ends short of zero torque is continued.
struct Continuation {
  double reach_fraction;  ///< of its first torque
  std::size_t secant;     ///< samples at its end that give the direction
};

/// At zero torque; a branch that comes from the other side and ends just short of zero is continued
/// along the secant of its last samples.
/// Source: docs/theory §31 (branches).
std::optional<Crossing> zero_torque_crossing(const std::vector<double>& time_s,
                                             const TorqueAngleCurve& curve, const Branch& branch,
                                             const Continuation& continuation);

}  // namespace gear3k::calibrate
