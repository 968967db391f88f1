#pragma once
// Measurements of a gearbox whose friction jumps between two of four loads.

#include <cstdint>
#include <numbers>

#include "tests/calibrate/measured_grid.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate {

/// The rig's gearbox with another coefficient of friction below 20 N m than above, at one speed.
/// @param noise  standard deviation [N m]
inline MeasurementSet friction_jump(double noise, std::uint64_t seed) {
  MeasurementSet data = measured_grid({.sun_speeds_rpm = {600.0},
                                       .output_torques_Nm = {7.9, 15.4, 26.2, 42.6},
                                       .rotations = {1},
                                       .repeats = 5});
  rig::DeterministicRandom random(seed);
  for (Observation& row : data.rows) {
    rig::Gearbox gearbox = rig::bilateral_drive_gear();
    gearbox.friction *= row.condition.output_torque_Nm < 20.0 ? 1.5 : 0.4;
    row.response =
        rig::sun_torque(gearbox,
                        {.forward = row.condition.direction == design::Direction::kForward,
                         .sun_speed_rpm = row.condition.sun_speed_rad_s * 30.0 / std::numbers::pi,
                         .output_torque_Nm = row.condition.output_torque_Nm}) +
        noise * random.normal();
  }
  return data;
}

}  // namespace gear3k::calibrate
