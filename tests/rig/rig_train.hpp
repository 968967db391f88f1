#pragma once

#include <array>

#include "tests/rig/rig_gearbox.hpp"
#include "tests/rig/rig_mesh.hpp"

namespace gear3k::rig {

/// The geometry that the bench needs at each row, computed once.
///
/// Speeds are per unit of the output's absolute speed.
struct Train {
  Gearbox gearbox{};
  std::array<RigPair, 3> pairs{};
  std::array<RigMesh, 3> meshes{};
  double ratio = 0.0;                    ///< w_S / w_R2, negative when the output turns backwards
  double carrier_speed = 0.0;            ///< absolute
  double planet_speed = 0.0;             ///< relative to the carrier
  double output_speed = 0.0;             ///< of R2 relative to the carrier
  double sun_speed = 0.0;                ///< relative to the carrier
  std::array<double, 3> sliding_m{};     ///< mean sliding speed per unit of output speed
  std::array<double, 3> force_per_Nm{};  ///< normal force without loss per Nm at the output
  double pin_radius_m = 0.0;
  /// Mean sliding speed of the two ring meshes, which lose most, at 400 rpm of the sun.
  double stribeck_speed_m_s = 0.0;
  std::array<double, 3> thinning_m{};
};

/// @throws std::invalid_argument when a mesh has no line of action
Train make_train(const Gearbox& gearbox);

/// What acts on the train at one operating point.
struct TrainLoad {
  double output_torque_Nm = 0.0;  ///< external torque on R2, signed as R2's own rotation
  double sun_sense = 1.0;         ///< sign of the sun's rotation
  double sun_speed_rad_s = 0.0;
  double pin_friction = 0.0;
  /// Friction of a mesh: mu factor (F/F20)^exponent (1 + rise/(1 + (v/vs)^2)), times 1 + skew in
  /// approach and 1 - skew in recess.
  double friction_factor = 1.0, load_exponent = 0.0, speed_rise = 0.0, approach_skew = 0.0;
};

/// Balance of the free bodies sun, planets, carrier and R2 with friction in the meshes.
///
/// Each mesh transmits a normal force; the driven gear receives it reduced by the mesh's loss.
/// Which side drives is found by the signs of the powers relative to the carrier.
/// Source: own derivation (free bodies).
/// @returns external torque on the sun [Nm], signed
double balanced_sun_torque(const Train& train, const TrainLoad& load);

}  // namespace gear3k::rig
