#pragma once
// The output's angle over the output's torque with the input locked: lost motion, wind-up and the
// hysteresis of friction.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "backlash/lost_motion_extension.hpp"
#include "design/elastic_windup.hpp"
#include "design/evaluation.hpp"

namespace gear3k::design {

/// Parts of the loop in the order of a test: 0 → +T → 0 → −T → 0.
inline constexpr std::array<std::string_view, 4> kLoopBranchNames{
    "loading", "unloading", "reverse_loading", "reverse_unloading"};

struct TorqueAnglePoint {
  double torque_Nm = 0.0;
  double angle_rad = 0.0;  ///< 0 in the middle of the lost motion
};

/// Stiffness of the output without friction at a torque: T over the turn that it makes.
struct StiffnessAtTorque {
  double torque_Nm = 0.0, output_Nm_rad = 0.0;
};

struct TorqueAngleCurve {
  double peak_torque_Nm = 0.0;
  double lost_motion_rad = 0.0;  ///< b, at T = 0
  double windup_rad = 0.0;       ///< on one side, at the peak of the loading branch
  double elastic_rad = 0.0;      ///< the same without friction: T/K_out
  /// By the names above; each begins where the last one ends but for the lost motion at T = 0.
  std::array<std::vector<TorqueAnglePoint>, 4> branch;
  std::vector<StiffnessAtTorque> stiffness;  ///< at 1/8, 1/4, 1/2 and all of the peak torque
  double loop_J = 0.0;                       ///< ∮ T dφ
  double friction_J = 0.0;                   ///< that the meshes' friction takes over the loop
  /// Wind-up that is left at T = 0 after unloading, as it is where friction holds more than the
  /// springs can move; the branch after it begins without.
  double held_rad = 0.0;
  /// On unloading friction takes all of the sun's load: its flank lifts off.
  bool sun_lifts_off = false;
};

/// What a curve is made of.
struct TorqueAngleTask {
  double peak_torque_Nm = 0.0;   ///< > 0
  double lost_motion_rad = 0.0;  ///< ≥ 0
  train::ToothSet teeth{};
  strength::MeshDriverEfficiencies<double> efficiency{};  ///< of each mesh by its driver
  /// Its windup() is in series with all springs, between R2 and output, or holds theirs too; the
  /// rest of it has no part in the loop.
  backlash::LostMotionExtension<double> extension{};
  int steps = 100;  ///< of each branch
};

/// The loop of a held train.
///
///   φ = ∂U/∂T,  ψ_k = ∂U/∂m_k;   ψ_k at rest: m_k between the two sliding couples;
///   ψ_k moving: m_k at the one that resists;   F_1 ≥ 0, the sun's flank lifts off at F_1 = 0
///
/// is solved step by step: U of strength::locked_train() with each mesh's spring at its own force.
/// Source: own derivation, docs/theory §57.  Limits (tested): μ → 0 one curve φ = b/2 + T/K_out(T);
/// a soft shaft of the sun alone: the train's own efficiencies, T η_b on loading and T/η_f on
/// unloading reach it; a soft shaft of R2 alone: no hysteresis; ∮ T dφ is what friction takes.
/// Does not account for: friction of bearings and seals, stiction beyond the stated friction, the
/// give of teeth along their flanks, the change within a base pitch, the far flank of a sun that
/// lifted off.
/// @returns empty where a mesh jams, or no forces, or none with their own springs, are in balance
/// @throws std::invalid_argument unless peak torque > 0, lost motion ≥ 0 and steps ≥ 1
std::optional<TorqueAngleCurve> torque_angle_loop(const ElasticTrain& train,
                                                  const TorqueAngleTask& task);

/// The curve of a design up to the torque that it states, or why there is none.
///
/// Lost motion is measured_lost_motion() at T = 0, with what a calibrated model adds; half of its
/// windup() at each torque is in series, less the wind-up of the springs where it was found without
/// them. Source: docs/theory (57.7).
/// @param evaluation  of the design
std::variant<TorqueAngleCurve, std::string> torque_angle_curve(const Design& design,
                                                               const Evaluation& evaluation);

}  // namespace gear3k::design
