#pragma once
// A gearbox that speeds up or slows down: torques, and losses by mesh, bearing and drag.

#include <array>
#include <memory>
#include <optional>

#include "design/operation.hpp"
#include "inertia/effective_inertia.hpp"

namespace gear3k::design {

/// A train with the inertia of its bodies; refers to its parts, which must outlive it.
struct MovingTrain {
  LossyTrain<double> lossy;
  inertia::BodyInertias<double>
      bodies{};  ///< planets' mass orbits at the geometry's centre distance
  std::array<bool, train::kMeshCount> lossless_mesh{};  ///< its efficiency is 1
};

/// R2 in motion; torques and acceleration are positive along its speed.
struct TrainMotion {
  double output_speed_rad_s = 0.0;  ///< ≥ 0; 0: about to move
  double output_acceleration_rad_s2 = 0.0;
  train::End given_end = train::End::kOutput;
  double given_torque_Nm = 0.0;  ///< from outside on R2, or on the sun as of w_R2 = 1
  double temperature_K = 293.15;
  /// Friction of the flanks is that of at least this speed: some laws have no value at rest.
  double least_friction_speed_rad_s = 0.0;
};

struct TrainInstant {
  double sun_torque_Nm, output_torque_Nm;  ///< from outside, positive along w_R2 = 1
  double ring2_mesh_Nm;                    ///< of the planets on R2
  std::array<double, train::kMeshCount> mesh_loss_W;
  std::array<double, kShaftCount> drag_loss_W;  ///< by ShaftId
  double bearing_loss_W;
  std::array<bool, train::kMeshCount> gear1_drives;
};

struct TrainInstantResult {
  std::optional<TrainInstant> instant;
  NoOperation reason = NoOperation::kLocks;  ///< where there is none
};

/// Balance of a train in accelerated motion: operate() with the inertia torques of all bodies, as
/// effective_inertia() has them, beside the drags.
///
/// Power in = power out + losses + change of kinetic energy, to rounding.
/// @throws std::invalid_argument unless the speed is finite and at least 0
/// Source: docs/theory §24-§27 (d'Alembert); equal to operate() without acceleration (tested).
TrainInstantResult balance_motion(const MovingTrain& train, const TrainMotion& motion);

/// The same for many instants of one train: what depends on neither speed nor load is found once.
///
/// A friction that depends on neither needs no iteration: one power flow. The results are those of
/// balance_motion() to the bit (tested).
class PreparedTrain {
 public:
  /// @param train  its parts must outlive this
  explicit PreparedTrain(const MovingTrain& train);

  [[nodiscard]] TrainInstantResult balance(const TrainMotion& motion) const;
  /// Whether torques are linear in speed, acceleration and load while each mesh keeps its driver.
  [[nodiscard]] bool is_linear() const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace gear3k::design
