#pragma once
// How measured lost motion differs from that of rigid bodies at 20 °C: what a calibrated model
// carries.

#include <array>
#include <cmath>

#include "geometry/scalar.hpp"

namespace gear3k::backlash {

/// What is soft up to a torque only.
template <class T>
struct SoftStage {
  T windup_rad{};                  ///< w, whole from T_i on
  T torque_Nm = constant<T>(1.0);  ///< T_i > 0
};
/// Stages that an extension can have.
inline constexpr std::size_t kMostSoftStages = 5;

/// Lost motion at the output between +T and −T, sun locked:
///
///   φ = φ_kin(d (1 + α (θ − θ_0))) + φ_0 + 2 c T_0 s(T) + Σ w_i min(1, T/T_i)
///   s = (T/T_0)^(1 − h),  or ln(1 + T/T_p)/ln(1 + T_0/T_p) where there is a T_p
///
/// φ_kin: kinematic_lost_motion() at the centre distance of the temperature θ.  T_p: stiffness in
/// proportion to what presses rough surfaces together, the preload and the torque, K ~ T_p + T.
/// Source: definition of the test, docs/theory §29; w_i and T_i: stiffness in straight pieces, K_1
/// up to a torque and more beyond, as makers of strain wave gears state it (Harmonic Drive SE,
/// LynxDrive engineering data 1018856, 08/2018, glossary: torsional stiffness K_1, K_2, K_3); T_p:
/// p ~ e^(−u/u_0) between rough surfaces (Persson 2007, arXiv:0706.2762), hence dp/du ~ p.
template <class T>
struct LostMotionExtension {
  T clearance_rad{};                 ///< φ_0
  T compliance_rad_Nm{};             ///< c, at the output and T_0
  T hardening{};                     ///< h: 0 linear, towards 1 all near zero torque
  double hardening_torque_Nm = 1.0;  ///< T_0 > 0
  T preload_torque_Nm{};             ///< T_p, with h = 0; 0: none
  std::array<SoftStage<T>, kMostSoftStages> soft{};  ///< w_i and T_i; w_i = 0: none
  T expansion_1_K{};                                 ///< α of the carrier relative to the gears
  double reference_temperature_K = 293.15;           ///< θ_0
  /// c counts beyond the wind-up of the teeth and shafts that a design with [strength] states; else
  /// it is all of the wind-up.
  bool beyond_springs = false;
};

/// 2 c T_0 s(T) + Σ w_i min(1, T/T_i): what the gearbox winds up between −T and +T; 0 at T = 0.
template <class T>
T windup(const LostMotionExtension<T>& e, const T& torque_Nm) {
  using std::exp;
  using std::log;
  T result = 2.0 * torque_Nm * e.compliance_rad_Nm;
  if (!is_neutral(e.hardening, 0.0) && torque_Nm > constant<T>(0.0)) {
    result = result * exp(T(-e.hardening * log(T(torque_Nm / e.hardening_torque_Nm))));
  }
  if (!is_neutral(e.preload_torque_Nm, 0.0)) {
    const T& preload = e.preload_torque_Nm;
    result = T(2.0 * e.hardening_torque_Nm * e.compliance_rad_Nm *
               log(T(1.0 + torque_Nm / preload)) / log(T(1.0 + e.hardening_torque_Nm / preload)));
  }
  for (const SoftStage<T>& stage : e.soft) {
    if (is_neutral(stage.windup_rad, 0.0)) continue;
    result =
        T(result + stage.windup_rad * smaller(T(torque_Nm / stage.torque_Nm), constant<T>(1.0)));
  }
  return result;
}

}  // namespace gear3k::backlash
