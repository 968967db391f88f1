#include "calibrate/dynamic/drive_parameters.hpp"

namespace gear3k::calibrate {

const std::array<DriveCause, kMotionCauses> kDriveCauses{
    {{.id = "friction_level",
      .body = "",
      .title = "the losses of the meshes are not the stated ones",
      .name = "change",
      .unit = ""},
     {.id = "friction_direction",
      .body = "",
      .title = "the losses differ with which side drives",
      .name = "asymmetry",
      .unit = ""},
     {.id = "drag_constant",
      .body = "motor",
      .title = "constant drag on the motor's side",
      .name = "torque",
      .unit = "Nm"},
     {.id = "drag_constant",
      .body = "output",
      .title = "constant drag on the output's side",
      .name = "torque",
      .unit = "Nm"},
     {.id = "drag_viscous",
      .body = "motor",
      .title = "drag with speed on the motor's side",
      .name = "damping",
      .unit = "Nm s/rad"},
     {.id = "drag_viscous",
      .body = "output",
      .title = "drag with speed on the output's side",
      .name = "damping",
      .unit = "Nm s/rad"},
     {.id = "inertia",
      .body = "motor",
      .title = "inertia of the motor's side",
      .name = "inertia",
      .unit = "kg m2"},
     {.id = "inertia",
      .body = "output",
      .title = "inertia of the output's side",
      .name = "inertia",
      .unit = "kg m2"},
     {.id = "torque_constant",
      .body = "motor",
      .title = "the motor's torque is not the logged one",
      .name = "change",
      .unit = ""},
     {.id = "clearance",
      .body = "",
      .title = "play between the motor's side and the output is not the stated one",
      .name = "play",
      .unit = "arcmin"},
     {.id = "compliance",
      .body = "",
      .title = "the gearbox winds up by another angle per torque than stated",
      .name = "compliance",
      .unit = "rad/Nm"}}};

DriveParameters changed_drive(const DriveParameters& stated, const DriveChanges& changes) {
  DriveParameters d = stated;
  const double level = 1.0 + changes[kLevelChange], direction = changes[kDirectionChange];
  const double forward = (1.0 / stated.efficiency_forward - 1.0) * level * (1.0 + direction);
  d.efficiency_forward = 1.0 / (1.0 + forward);
  d.efficiency_backward = 1.0 - (1.0 - stated.efficiency_backward) * level * (1.0 - direction);
  d.motor_coulomb_Nm += changes[kMotorCoulombChange];
  d.output_coulomb_Nm += changes[kOutputCoulombChange];
  d.motor_viscous_Nms += changes[kMotorViscousChange];
  d.output_viscous_Nms += changes[kOutputViscousChange];
  d.motor_inertia_kgm2 += changes[kMotorInertiaChange];
  d.output_inertia_kgm2 += changes[kOutputInertiaChange];
  d.torque_gain *= 1.0 + changes[kTorqueConstantChange];
  return d;
}

bool is_physical(const DriveParameters& d) {
  return d.efficiency_forward > 0.0 && d.efficiency_forward <= 1.0 &&
         d.efficiency_backward <= 1.0 && d.motor_inertia_kgm2 >= 0.0 &&
         d.output_inertia_kgm2 >= 0.0 && d.motor_coulomb_Nm >= 0.0 && d.output_coulomb_Nm >= 0.0 &&
         d.motor_viscous_Nms >= 0.0 && d.output_viscous_Nms >= 0.0 && d.torque_gain > 0.0;
}

std::array<double, 4> drive_coefficients(const DriveParameters& d, int flow, double load_kgm2) {
  const double h = flow > 0 ? 1.0 / d.efficiency_forward : d.efficiency_backward;
  return {(d.motor_inertia_kgm2 + h * (d.output_inertia_kgm2 + load_kgm2)) / d.torque_gain,
          (d.motor_viscous_Nms + h * d.output_viscous_Nms) / d.torque_gain,
          (d.motor_coulomb_Nm + h * d.output_coulomb_Nm) / d.torque_gain, h / d.torque_gain};
}

}  // namespace gear3k::calibrate
