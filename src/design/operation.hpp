#pragma once
// A gearbox at an operating point: torques, losses and efficiency in either drive direction.

#include <array>
#include <optional>
#include <string_view>

#include "design/operating_point.hpp"
#include "efficiency/friction_law.hpp"
#include "efficiency/train_efficiency.hpp"
#include "train/power_flow.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::design {

enum class Direction { kForward, kBackward };

/// What decides the losses of a train; refers to its parts, which must outlive it.
template <class T>
struct LossyTrain {
  const train::TrainGeometry<T>& geometry;
  const efficiency::Friction<T>& friction;
  const ShaftLosses<T>& shafts;
  std::array<T, 2> face_width_m{};  ///< by stage; used by FrictionLaw::kSchlenk
};

template <class T>
struct MeshOperation {
  T friction;           ///< μ of this mesh
  T normal_force_N;     ///< on the flanks of one planet's mesh
  T sliding_speed_m_s;  ///< mean
  T efficiency;         ///< in the direction in which its power flows
  T loss_W;             ///< heat of this mesh on all planets
  bool gear1_drives;
};

/// A gearbox in steady motion.
template <class T>
struct Operation {
  /// Forward: of the drive on the sun.  Backward: taken from the sun; negative where the sun must
  /// be helped, as drag and friction exceed what R2 transmits.
  T sun_torque_Nm;
  T output_torque_Nm;  ///< at R2: of the load (forward), of the drive (backward)
  /// Forward T_out/(|i| T_sun), backward |i| T_sun/T_out, negative with T_sun; empty where the
  /// denominator is not positive.
  std::optional<T> efficiency;
  std::array<MeshOperation<T>, train::kMeshCount> mesh;
  std::array<T, kShaftCount> drag_loss_W;  ///< by ShaftId; all planets together
  T bearing_loss_W;                        ///< planets on their pins, R2 in its bearing
  T input_power_W;                         ///< of whatever drives
  T loss_W;                                ///< sum of all losses
};

/// Why there is no operation.
enum class NoOperation {
  kLocks,        ///< no torques are in balance while the train turns
  kNoFriction,   ///< the friction law has no value here (friction_coefficient())
  kNoContact,    ///< a mesh has a contact ratio ≤ 0
  kNotConverged  ///< the iteration found no torques that repeat
};

/// In words.
std::string_view no_operation_text(NoOperation reason);

template <class T>
struct OperationResult {
  std::optional<Operation<T>> operation;
  NoOperation reason = NoOperation::kLocks;  ///< where there is none
};

/// Torques of a gearbox that turns at a speed against (forward) or by (backward) a torque at R2.
///
/// Friction depends on tooth forces and these on friction: iterated from the forces without
/// losses until they repeat to rounding.  Power in = power out + losses to rounding at any time.
/// @throws std::invalid_argument unless speed and torque are finite and at least 0
/// At rest (speed 0) the torques are those at the onset of motion.
/// Does not account for: inertia, gravity, tilting of the planets, rolling friction.
/// Source: docs/theory §24-§26.
template <class T>
OperationResult<T> operate(const LossyTrain<T>& train, const OperatingPoint<T>& point,
                           Direction direction);

/// Torque at R2 that turns the gearbox backward with a free sun (T_sun = 0); the point's
/// output_torque_Nm is not used.  At rest: the breakaway torque.
template <class T>
OperationResult<T> drive_free_sun(const LossyTrain<T>& train, const OperatingPoint<T>& point);

/// Coefficient of friction of each mesh at an operating point; empty as operate().
template <class T>
std::optional<std::array<T, train::kMeshCount>> mesh_friction(const LossyTrain<T>& train,
                                                              const OperatingPoint<T>& point,
                                                              Direction direction);

}  // namespace gear3k::design
