#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/rig/hidden_cause.hpp"
#include "tests/rig/rig_gearbox.hpp"

/// A simulated test bench. It shares no code with the product: it hides effects in data with
/// noise, and `gear3k diagnose` has to find them.
namespace gear3k::rig {

/// One operating point of the bench. A kind uses the fields that it knows.
struct Condition {
  bool forward = true;
  double sun_speed_rpm = 600.0;
  double output_torque_Nm = 20.0;  ///< test torque in lost motion
  int rotation = 1;
  double output_angle_deg = 0.0;
  double temperature_c = 35.0;
  double time_s = 0.0;
  double cycles = 0.0;
  int session = 0;
  int driving_teeth = 0, driven_teeth = 0;  ///< pair_loss
  int repeats = 1;                          ///< of measure_conditions
};

enum class Noise {
  gaussian,
  student,          ///< Student's t with 3 degrees of freedom, the same standard deviation
  proportional,     ///< standard deviation in proportion to the clean value, the same on average
  session_offsets,  ///< Gaussian, and each session is off by half a standard deviation
};

/// How a campaign is planned and written.
struct Plan {
  Kind kind = Kind::transmission;
  std::vector<double> sun_speeds_rpm{200.0, 400.0, 600.0, 800.0, 1000.0};
  std::vector<double> torques_Nm{5.0, 20.0, 35.0, 50.0};  ///< at the output; test torques
  bool forward = true, backward = true, both_rotations = true;
  int repeats = 3;
  bool unequal_repeats = false;  ///< 1 to 5 of them, the same total
  int sessions = 4;
  bool load_by_session = false;  ///< loads rise over the campaign instead of random order
  double session_gap_s = 3600.0;
  double cold_c = 25.0, warm_c = 45.0;
  std::vector<int> pair_teeth{20, 30, 40, 60, 80};  ///< all ordered pairs
  double pair_module_mm = 1.0;
  int rows = 120;              ///< of lost motion
  int loops = 4;               ///< of torque_angle
  int samples_per_loop = 400;  ///< of torque_angle
  double sample_step_s = 0.05;
  double hysteresis_Nm = 0.3;  ///< friction of the loop
  // Columns that may be left out.
  bool angle = true, temperature = true, time = true, run = true, rotation = true;
  bool cycles = true, sigma = false;
  Noise noise = Noise::gaussian;
  double relative_noise = 0.01;  ///< standard deviation / mean of the response without causes
};

/// Speeds 200 to 1000 rpm, loads 5 to 50 Nm, both directions and rotations: 120 rows.
Plan transmission_plan();
/// Test torques 1 to 5 Nm, 15 to 45 C, any angle: 120 rows.
Plan lost_motion_plan();
/// Four loops of +-5 Nm with the sun locked.
Plan torque_angle_plan();
/// External pairs without shift, each three times.
Plan pair_loss_plan();

struct Dataset {
  std::string csv;
  std::vector<Truth> truth;
  std::vector<HiddenCause> causes;  ///< with amplitudes, phases, step and duration as applied
  double noise_sd = 0.0;            ///< in the unit of the response
  std::vector<Condition> conditions;
  std::vector<double> clean;     ///< response of each row without noise
  std::vector<double> measured;  ///< response of each row as in the file
};

/// Measures a campaign on a gearbox with hidden causes.
///
/// Everything random comes from the seed: the same seed gives the same order, angles, temperatures
/// and noise whatever the causes are.
/// @throws std::invalid_argument for a cause that the kind or plan cannot show
Dataset measure(const Gearbox& gearbox, const Plan& plan, const std::vector<HiddenCause>& causes,
                std::uint64_t seed);

/// Measures stated conditions on the same gearbox, e.g. those proposed as the next experiment.
/// @param causes    as in Dataset::causes of the first campaign, with fixed amplitudes
/// @param run_label of all rows
Dataset measure_conditions(const Gearbox& gearbox, const Plan& plan,
                           const std::vector<Condition>& conditions,
                           const std::vector<HiddenCause>& causes, double noise_sd,
                           std::uint64_t seed, const std::string& run_label);

/// Magnitude of the sun's torque [Nm] as the sensor shows it, without noise.
double sun_torque(const Gearbox& gearbox, const Condition& condition,
                  const std::vector<HiddenCause>& causes = {});

/// Lost motion at the output with the sun locked, without noise.
double lost_motion_arcmin(const Gearbox& gearbox, const Condition& condition,
                          const std::vector<HiddenCause>& causes = {});

/// 1 - efficiency of an external pair without shift, without noise.
double pair_loss(const Gearbox& gearbox, double module_mm, const Condition& condition,
                 const std::vector<HiddenCause>& causes = {});

}  // namespace gear3k::rig
