#pragma once
// Rows of a transmission over every combination of what is set.

#include <numbers>
#include <utility>
#include <vector>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// What is set on the bench; without sessions, times and angles.
struct SetPoints {
  std::vector<double> sun_speeds_rpm{200.0, 600.0, 1000.0};
  std::vector<double> output_torques_Nm{5.0, 20.0, 50.0};
  std::vector<design::Direction> directions{design::Direction::kForward,
                                            design::Direction::kBackward};
  std::vector<int> rotations{1, -1};
  int repeats = 1;
};

inline MeasurementSet measured_grid(const SetPoints& set) {
  constexpr double kRpm = std::numbers::pi / 30.0;
  MeasurementSet data;
  data.kind = Kind::kTransmission;
  Observation row;
  for (int repeat = 0; repeat < set.repeats; ++repeat) {
    for (const double speed : set.sun_speeds_rpm) {
      row.condition.sun_speed_rad_s = speed * kRpm;
      for (const double torque : set.output_torques_Nm) {
        row.condition.output_torque_Nm = torque;
        for (const design::Direction direction : set.directions) {
          row.condition.direction = direction;
          for (const int rotation : set.rotations) {
            row.condition.rotation = rotation;
            data.rows.push_back(row);
          }
        }
      }
    }
  }
  return data;
}

}  // namespace gear3k::calibrate
