#pragma once
// Lost motion as a test measures it: rigid bodies, and what a calibrated model adds.

#include <algorithm>
#include <optional>

#include "backlash/lost_motion_extension.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::design {

/// The test: ±T at the output with the sun locked, at a temperature.
template <class T>
struct LostMotionTest {
  T torque_Nm{};                          ///< ≥ 0
  T temperature_K = constant<T>(293.15);  ///< of carrier and gears
};

/// Whether an extension changes the lost motion at all.
template <class T>
bool changes_lost_motion(const backlash::LostMotionExtension<T>& e) {
  const bool soft = std::ranges::any_of(
      e.soft, [](const auto& stage) { return !is_neutral(stage.windup_rad, 0.0); });
  return soft || !(is_neutral(e.clearance_rad, 0.0) && is_neutral(e.compliance_rad_Nm, 0.0) &&
                   is_neutral(e.expansion_1_K, 0.0));
}

/// Angle of the output between +T and −T, sun locked.
///
///   φ = φ_kin(d (1 + α (θ − θ_0))) + φ_0 + 2 c T_0 s(T) + Σ w_i min(1, T/T_i)
///
/// s: wind-up over that at T_0 (backlash::LostMotionExtension).
///
/// The parts keep their size: α is the carrier's expansion relative to that of the gears.  A mesh
/// that interferes keeps its negative share, as in backlash::kinematic_lost_motion().
/// Source: definition of the test, docs/theory (29.4).
/// @returns φ [rad]; empty where a mesh has no working angle at the distance of the temperature
template <class T>
std::optional<T> measured_lost_motion(const train::TrainParameters<T>& parameters,
                                      const backlash::LostMotionExtension<T>& extension,
                                      const LostMotionTest<T>& test);

/// The same with the geometry of the parameters at hand, which is used where α is 0.
template <class T>
std::optional<T> measured_lost_motion(const train::TrainParameters<T>& parameters,
                                      const train::TrainGeometry<T>& geometry,
                                      const backlash::LostMotionExtension<T>& extension,
                                      const LostMotionTest<T>& test);

}  // namespace gear3k::design
