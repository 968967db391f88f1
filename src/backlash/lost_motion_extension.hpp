#pragma once
// How measured lost motion differs from that of rigid bodies at 20 °C: what a calibrated model
// carries.

#include "geometry/scalar.hpp"

namespace gear3k::backlash {

/// Lost motion at the output between +T and −T, sun locked:
///
///   φ = φ_kin(d (1 + α (θ − θ_0))) + φ_0 + 2 T c
///
/// φ_kin: kinematic_lost_motion() at the centre distance of the temperature θ.
/// Source: definition of the test, docs/theory §29.
template <class T>
struct LostMotionExtension {
  T clearance_rad{};                        ///< φ_0
  T compliance_rad_Nm{};                    ///< c, at the output
  T expansion_1_K{};                        ///< α of the carrier relative to the gears
  double reference_temperature_K = 293.15;  ///< θ_0
};

}  // namespace gear3k::backlash
