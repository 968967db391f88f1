#pragma once
// Where a gearbox runs, and what it loses outside the flanks.

#include <array>
#include <cmath>
#include <string_view>

#include "geometry/scalar.hpp"

namespace gear3k::design {

/// Load, speed and temperature; magnitudes, the same for both drive directions.
template <class T>
struct OperatingPoint {
  T sun_speed_rad_s{};   ///< ≥ 0; 0: about to move
  T output_torque_Nm{};  ///< ≥ 0; of the load (forward) or of the drive (backward) at R2
  T temperature_K = constant<T>(293.15);  ///< of the lubricant
};

/// Shafts with load-independent torques.
enum ShaftId { kSunShaft = 0, kPlanetShaft, kCarrierShaft, kOutputShaft };
inline constexpr int kShaftCount = 4;
inline constexpr std::array<std::string_view, kShaftCount> kShaftNames{"S", "planet", "carrier",
                                                                       "R2"};

/// Load-independent torque on a shaft at speed w: c + v |w| + q w², against its rotation.
template <class T>
struct ShaftDrag {
  T constant_Nm{};     ///< c: seals, preload
  T viscous_Nms{};     ///< v [Nm s/rad]
  T quadratic_Nms2{};  ///< q [Nm s²/rad²]: churning, windage
};

/// A share of a torque that grows with its magnitude: λ (|T|/T_0)^y, as the coefficient of a
/// rolling bearing does (f ~ (P/C)^y).  |T|/T_0 counts as at least 1e-3, for the power has no value
/// at 0. Source: Palmgren's equation of the load-dependent friction of rolling bearings.
template <class T>
struct GrowingShare {
  T share{};                  ///< λ at T_0
  T exponent{};               ///< y
  double reference_Nm = 1.0;  ///< T_0 > 0
};
/// @param torque_Nm  |T|
template <class T>
T share_at(const GrowingShare<T>& s, const T& torque_Nm) {
  using std::exp;
  using std::log;
  constexpr double kLeast = 1e-3;
  if (is_neutral(s.share, 0.0)) return constant<T>(0.0);
  const T reduced = larger(T(torque_Nm / s.reference_Nm), constant<T>(kLeast));
  return T(s.share * exp(T(s.exponent * log(reduced))));
}

/// Losses outside the flanks.
template <class T>
struct ShaftLosses {
  /// By ShaftId; sun, carrier and R2 by absolute speed, each planet by its speed on the carrier.
  std::array<ShaftDrag<T>, kShaftCount> drag{};
  /// Friction of a planet on its pin: coefficient times radius times the resultant of the mesh
  /// forces on the planet.
  T planet_bearing_coefficient{};
  T planet_bearing_radius_m{};
  /// Friction of R2's bearing: this share of the torque at the output's shaft, whose reaction the
  /// bearing takes.
  T output_bearing_share{};
  GrowingShare<T> output_bearing_growth{};  ///< beside it
  /// All drags times exp(β (θ − θ_0)).
  T drag_temperature_1_K{};                      ///< β
  double drag_reference_temperature_K = 293.15;  ///< θ_0
};

/// Friction of R2's bearing, M = λ |T_o|.  N planets press on R2 evenly all round, so that their
/// forces add up to a torque and load no bearing: what does is the force F = |T_o|/r_L that the
/// load (lever, belt, pinion) takes at its arm r_L, and the friction of a bearing of radius r_b is
/// μ_b r_b F, λ = μ_b r_b/r_L.
/// @param torque_Nm  magnitude of the torque at the output's shaft
template <class T>
T output_bearing_torque(const ShaftLosses<T>& shafts, const T& torque_Nm) {
  return T((shafts.output_bearing_share + share_at(shafts.output_bearing_growth, torque_Nm)) *
           torque_Nm);
}

}  // namespace gear3k::design
