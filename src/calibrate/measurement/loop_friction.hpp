#pragma once
// What friction does to the readings of torque-angle loops.

#include <vector>

#include "calibrate/measurement/loop_reading.hpp"

namespace gear3k::calibrate {

/// By how much friction opens a loop at zero torque, and what it takes off each of its travels.
struct FrictionShare {
  double friction_Nm = 0.0;  ///< T_f; 0: none shows
  double zero_rad = 0.0;
  std::vector<double> travel_rad{};  ///< of each LoopReading::travel
};

/// Friction behind which a dead band b and a wind-up as in (29.4) lie, T_m the greatest torque
/// read:
///
///   θ(0)      = b + W(T_f)
///   travel(T) = b + W(T − T_f),   W(T) = C (T/T_m)^(1−h),   −0.2 ≤ h ≤ 0.5
///
/// so that W(T_f) opens the loop and W(T) − W(T − T_f) is taken off a travel.  b, C, h and T_f are
/// fitted to the means of all loops (h = 0 where there are only three travels), weighted by 1/v: v
/// is the variance of a loop's opening o = θ(0) − (line through its travels at T = 0).
///
/// Curved flanks without friction open a loop too (0.05 of their wind-up at the peak for h = −0.1).
/// Friction therefore counts only where the same flanks at T_f = 0 have a χ² greater by 9.  Where
/// the fit itself misses by more than noise (χ² at 0.1 %), the gain over its misfit must also be
/// beyond chance (F at 0.27 %): a lack of fit is the same in all loops and does not average out.
///
/// One gearbox has one friction: T_f is that of all loops unless their openings differ (χ² at
/// 0.1 %; curvature drops out, as it is in all of them).  Then a loop's own is
/// T_f + s (o − ō)/(do/dT_f), s = τ²/(τ² + v) with the variance τ² between loops, and 0 where that
/// is not beyond 3 of its deviations √(s v).  A loop that is read at fewer torques, or not at zero,
/// has that of all.
///
/// Source: own derivation, docs/theory §31 (friction); τ²: R. DerSimonian, N. Laird (1986),
/// Control. Clin. Trials 7, 177.  Bounds of h: below, what is plausible of the cause `compliance`;
/// above, where its fit ends. Valid: wind-up that a power follows; three travels at least; T_f
/// below 0.9 of the smallest torque.
std::vector<FrictionShare> friction_shares(const std::vector<LoopReading>& loops);

}  // namespace gear3k::calibrate
