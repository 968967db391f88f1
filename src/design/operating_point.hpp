#pragma once
// Where a gearbox runs, and what it loses outside the flanks.

#include <array>
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

/// Losses outside the flanks.
template <class T>
struct ShaftLosses {
  /// By ShaftId; sun, carrier and R2 by absolute speed, each planet by its speed on the carrier.
  std::array<ShaftDrag<T>, kShaftCount> drag{};
  /// Friction of a planet on its pin: coefficient times radius times the resultant of the mesh
  /// forces on the planet.
  T planet_bearing_coefficient{};
  T planet_bearing_radius_m{};
  /// Friction of R2's bearing: this share of the torque that R2's teeth carry.
  T output_bearing_share{};
  /// All drags times exp(β (θ − θ_0)).
  T drag_temperature_1_K{};                      ///< β
  double drag_reference_temperature_K = 293.15;  ///< θ_0
};

}  // namespace gear3k::design
