#pragma once

#include <string>
#include <vector>

namespace gear3k::wide_rig {

/// The condition of one observation, in the units of DATA.csv.
struct BenchRow {
  bool forward = true;
  double rotation = 1.0;
  double sun_speed_rpm = 0.0;
  double output_torque_Nm = 0.0;  ///< true one
  double test_torque_Nm = 0.0;
  double temperature_c = 25.0;
  double housing_c = 25.0;  ///< lags behind the measured temperature
  double time_s = 0.0;
  double elapsed = 0.0;  ///< share of the campaign, 0 to 1
  double output_angle_deg = 0.0;
  double cycles = 0.0;
  int session = 0;
  int driving_teeth = 0, driven_teeth = 0;
};

/// Which optional columns a campaign has.
struct BenchColumns {
  bool rotation = true, angle = true, temperature = true, time = true, run = true, cycles = false;
  bool sigma = false;
};

}  // namespace gear3k::wide_rig
