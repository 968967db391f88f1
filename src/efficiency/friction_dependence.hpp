#pragma once
// Which quantities of a running mesh its coefficient of friction depends on.

#include "efficiency/friction_law.hpp"

namespace gear3k::efficiency {

/// What of MeshState a coefficient of friction depends on: by any of them depends_on_state().
struct StateDependence {
  bool load = false;         ///< normal_force_N, or ring2_torque_Nm
  bool speed = false;        ///< sliding_speed_m_s, or sum_speed_m_s
  bool temperature = false;  ///< temperature_K
};

/// That of a law with its extension, whatever the values of the law's own parameters.
/// Source: friction_coefficient(); every parameter of either is tried against it in
/// tests/efficiency/friction_dependence_test.cpp.
template <class T>
StateDependence state_dependence(const Friction<T>& friction) {
  const FrictionLaw law = friction.law;
  const FrictionExtension<T>& e = friction.extension;
  const bool film = law == FrictionLaw::kSchlenk;
  const bool table = law == FrictionLaw::kTable;
  return {.load = film || table || law == FrictionLaw::kLoadPower ||
                  !(is_neutral(e.load_exponent, 0.0) && is_straight(e.load_bend)),
          .speed = film || table || law == FrictionLaw::kStribeck ||
                   !(is_neutral(e.slow_excess, 0.0) && is_neutral(e.speed_exponent, 0.0) &&
                     is_straight(e.speed_bend)),
          .temperature = film || depends_on_temperature(e)};
}

}  // namespace gear3k::efficiency
