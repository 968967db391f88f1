#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tests/rig/rig_train.hpp"

namespace gear3k::rig {

enum class Kind { transmission, lost_motion, torque_angle, pair_loss };

/// An effect to be hidden in the data.
///
/// Ids and variants (the first variant is what an empty name means), amplitude and its unit:
///
///   id                    variants                               amplitude
///   friction_level                                               mu (1 + A)
///   friction_load                                                mu (F/F20)^A, F20 at 20 Nm
///   friction_speed                                               mu (1 + A/(1 + (v/vs)^2))
///   friction_temperature                                         mu (nu(T)/nu(35 C))^A, Vogel
///   friction_direction    approach_recess, drive                 mu (1 +- A)
///   drag_constant         sun, output                            A [Nm]
///   drag_viscous                                                 A w_S, A [Nm s/rad]
///   drag_quadratic                                               A w_S^2, A [Nm s^2/rad^2]
///   bearing_load          pins, output                           A = friction of pins; fraction
///   sensor_gain                                                  1 + A
///   sensor_offset                                                A [Nm], sign of the sensor
///   run_step              shift, sensor                          A [Nm, arcmin, -]
///   drift                 linear, saturating, friction           A at the end [Nm, arcmin; -]
///   runout                sun, planet, carrier, sun_absolute,    A relative torque; lost motion:
///                         planet_absolute                        eccentricity [m]
///   mesh_order            stage1, stage2                         A relative torque; [arcmin]
///   clearance                                                    A [arcmin]
///   compliance                                                   2 T A, A [arcmin/Nm]
///   thermal_expansion                                            d (1 + A (T - 20 C)), A [1/K]
/// and, outside what a library of causes can hold:
///   odd_order                                                    A [Nm, arcmin], 7.3 per turn
///   resonance                                                    A [Nm] at 600 rpm, 80 rpm wide
///   rotation_load                                                loss +-A of the load [Nm/Nm]
///   time_oscillation                                             A [Nm, arcmin], 5 per campaign
///   corner                                                       A [Nm] at <= 300 rpm, >= 40 Nm
struct HiddenCause {
  std::string id;
  std::string variant{};
  std::optional<double> amplitude{};
  /// Instead of the amplitude: root mean square of what the cause alone changes over the plan's
  /// rows, in standard deviations of the noise; negative = an amplitude below zero.
  std::optional<double> rms_in_noise{};
  std::optional<double> phase_rad{};   ///< of periodic causes; drawn from the seed when absent
  std::optional<int> from_session{};   ///< of run_step; the middle session when absent
  std::optional<double> duration_s{};  ///< of a drift or oscillation; the campaign's when absent
  std::optional<double> cycles{};      ///< of a drift of lost motion; the campaign's when absent
};

struct TruthParameter {
  std::string name, unit;
  double value = 0.0;
};

/// What was hidden.
struct Truth {
  std::string id, variant{};
  std::string body{};         ///< of run-out: sun, planet, carrier; of mesh order: stage1, stage2
  double order = 0.0;         ///< per output revolution, as the rig applied it
  double rms_in_noise = 0.0;  ///< what the cause alone changes, in units of the noise
  bool physical = true;       ///< false: the amplitude asks for negative friction in a mesh
  bool in_library = true;     ///< false: nothing that diagnose can name
  std::vector<TruthParameter> parameters{};
};

/// A periodic change, cos(order * output angle + phase).
struct Wave {
  double order = 0.0, amplitude = 0.0, phase_rad = 0.0;
};

/// A change of the distance of the axes with the output angle.
struct EccentricBody {
  std::array<bool, 3> meshes{};
  Wave wave;  ///< amplitude [m]
};

struct Drift {
  double amplitude = 0.0, duration_s = 0.0, cycles = 0.0;
  bool saturating = false;
};

struct Step {
  double amplitude = 0.0;
  int from_session = 0;
  bool sensor_sign = false;
};

/// All causes together, as the bench applies them.
struct Effects {
  // Friction in the meshes.
  double friction_factor = 1.0, load_exponent = 0.0, speed_rise = 0.0, viscosity_exponent = 0.0;
  double approach_skew = 0.0, drive_skew = 0.0;
  std::optional<Drift> friction_drift{};
  // Losses outside of them.
  double sun_drag_Nm = 0.0, output_drag_Nm = 0.0, viscous_Nms_rad = 0.0, quadratic_Nms2_rad2 = 0.0;
  double pin_friction = 0.0, output_bearing = 0.0, pair_bearing = 0.0;
  // The sensor.
  double gain = 0.0, offset_Nm = 0.0;
  std::vector<Step> steps;
  std::vector<Drift> drifts;
  std::vector<Wave> relative_waves, added_waves;
  // Lost motion.
  std::vector<EccentricBody> eccentric;
  double clearance_arcmin = 0.0, compliance_arcmin_Nm = 0.0, expansion_1_K = 0.0;
  // Outside the library.
  double resonance_Nm = 0.0, rotation_load = 0.0, corner_Nm = 0.0;
  std::vector<Drift> oscillations;  ///< five periods over the duration
  std::vector<double> oscillation_phase_rad;
};

/// Adds a cause to the others.
/// @param amplitude of the cause, given or found
/// @throws std::invalid_argument for an unknown id or variant, or one that this kind cannot show
void add_cause(Effects& effects, const HiddenCause& cause, double amplitude, Kind kind,
               const Train& train);

/// An amplitude of ordinary size, from which the search for an rms starts.
double usual_amplitude(const HiddenCause& cause, Kind kind, double noise_sd);

Truth truth_of(const HiddenCause& cause, double amplitude, Kind kind, const Train& train);

}  // namespace gear3k::rig
