#pragma once
// What a log of motion can find changed in a drive.

#include <array>
#include <cstddef>
#include <string_view>

namespace gear3k::calibrate {

/// The two sides of docs/theory §58, at the output.
struct DriveParameters {
  double motor_inertia_kgm2 = 0.0;   ///< J1
  double motor_viscous_Nms = 0.0;    ///< D1
  double motor_coulomb_Nm = 0.0;     ///< c1
  double output_inertia_kgm2 = 0.0;  ///< J2 without the load of the log
  double output_viscous_Nms = 0.0;   ///< D2
  double output_coulomb_Nm = 0.0;    ///< c2
  double efficiency_forward = 1.0;   ///< η_f
  double efficiency_backward = 1.0;  ///< η_b
  double torque_gain = 1.0;          ///< true motor torque over the logged one
};

/// A cause with its place: one number that may differ from what is stated.
struct DriveCause {
  std::string_view id, body, title, name, unit;
};

enum DriveChange : std::size_t {
  kLevelChange,
  kDirectionChange,
  kMotorCoulombChange,
  kOutputCoulombChange,
  kMotorViscousChange,
  kOutputViscousChange,
  kMotorInertiaChange,
  kOutputInertiaChange,
  kTorqueConstantChange,
  kDriveChanges,
  // Of the wind-up between both sides, which no torque shows.
  kClearanceChange = kDriveChanges,
  kComplianceChange,
  kMotionCauses
};
using DriveChanges = std::array<double, kDriveChanges>;

/// Ids as in the contract of `diagnose`; values at the output, relative for the first two and the
/// last.
extern const std::array<DriveCause, kMotionCauses> kDriveCauses;

/// The drive with changes on top of what is stated.
///
///   1/η_f − 1 = (1/η_f0 − 1)(1 + λ)(1 + δ),   1 − η_b = (1 − η_b0)(1 + λ)(1 − δ)
///
/// λ friction_level, δ friction_direction; the others are added, the torque constant's as a factor
/// 1 + g.  Source: docs/theory §69.
DriveParameters changed_drive(const DriveParameters& stated, const DriveChanges& changes);

/// Whether every part can exist: no loss, drag or inertia below 0, η_f in (0, 1], η_b at most 1.
bool is_physical(const DriveParameters& drive);

/// Coefficients of a flow: the motor's torque for acceleration, speed, sense and −T_L.
///
///   τ = (J1 + h J2) a + (D1 + h D2) w + (c1 + h c2) s − h T_L,  h = 1/η_f forward, η_b backward
///
/// each over the torque gain.
/// @param flow  1 forward, −1 backward
/// Source: docs/theory §69, eq. 69.1.
std::array<double, 4> drive_coefficients(const DriveParameters& drive, int flow, double load_kgm2);

}  // namespace gear3k::calibrate
