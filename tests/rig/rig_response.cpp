#include "tests/rig/rig_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

#include "tests/rig/rig_lost_motion.hpp"

namespace gear3k::rig {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kArcmin = kDeg / 60.0;
constexpr double kRpm = std::numbers::pi / 30.0;

// How far a drift has come; wear follows cycles where they are counted, else time.
double progress(const Drift& drift, const Condition& row) {
  double fraction = 0.0;
  if (drift.cycles > 0.0) {
    fraction = row.cycles / drift.cycles;
  } else if (drift.duration_s > 0.0) {
    fraction = row.time_s / drift.duration_s;
  } else {
    throw std::invalid_argument("a drift needs the campaign's duration or cycles");
  }
  return drift.saturating ? 1.0 - std::exp(-fraction / 0.2) : fraction;
}

double wave_value(const Wave& wave, const Condition& row) {
  return wave.amplitude * std::cos(wave.order * row.output_angle_deg * kDeg + wave.phase_rad);
}

// What is added to any response, whatever its physics.
double added(const Effects& effects, const Condition& row) {
  double sum = 0.0;
  for (const Step& step : effects.steps) {
    if (row.session < step.from_session) continue;
    const double sign = step.sensor_sign && row.forward != (row.rotation > 0) ? -1.0 : 1.0;
    sum += sign * step.amplitude;
  }
  for (const Drift& drift : effects.drifts) sum += drift.amplitude * progress(drift, row);
  for (const Wave& wave : effects.added_waves) sum += wave_value(wave, row);
  for (std::size_t i = 0; i < effects.oscillations.size(); ++i) {
    const Drift& oscillation = effects.oscillations[i];
    sum += oscillation.amplitude * std::cos(10.0 * std::numbers::pi * progress(oscillation, row) +
                                            effects.oscillation_phase_rad[i]);
  }
  return sum;
}

// nu(T)/nu(35 C) of an oil of viscosity grade 100: Vogel's law through 100 mm2/s at 40 C and
// 11 mm2/s at 100 C with its pole at -110 C.
double viscosity_ratio(double temperature_c) {
  constexpr double kSlope = 1159.0;
  return std::exp(kSlope / (temperature_c + 110.0) - kSlope / (35.0 + 110.0));
}

double sensor_torque(const Train& train, const Effects& e, const Condition& row) {
  const double speed = row.sun_speed_rpm * kRpm;
  const double losing = row.forward ? 1.0 : -1.0;  // a loss adds to the sun's torque or takes away
  TrainLoad load{.output_torque_Nm = row.output_torque_Nm * (1.0 + losing * e.output_bearing) +
                                     losing * e.output_drag_Nm,
                 .sun_sense = row.rotation > 0 ? 1.0 : -1.0,
                 .sun_speed_rad_s = speed,
                 .pin_friction = e.pin_friction,
                 .friction_factor = e.friction_factor * (1.0 + losing * e.drive_skew),
                 .load_exponent = e.load_exponent,
                 .speed_rise = e.speed_rise,
                 .approach_skew = e.approach_skew};
  if (row.forward) load.output_torque_Nm = -load.output_torque_Nm;  // the load resists
  if (e.viscosity_exponent != 0.0) {
    load.friction_factor *= std::pow(viscosity_ratio(row.temperature_c), e.viscosity_exponent);
  }
  if (e.friction_drift) {
    load.friction_factor *= 1.0 + e.friction_drift->amplitude * progress(*e.friction_drift, row);
  }
  double torque = losing * load.sun_sense * balanced_sun_torque(train, load);
  double modulation = 1.0;
  for (const Wave& wave : e.relative_waves) modulation += wave_value(wave, row);
  torque *= modulation;

  double drag = e.sun_drag_Nm + e.viscous_Nms_rad * speed + e.quadratic_Nms2_rad2 * speed * speed;
  const double off_resonance = (row.sun_speed_rpm - 600.0) / 80.0;
  drag += e.resonance_Nm / (1.0 + off_resonance * off_resonance);
  if (row.sun_speed_rpm <= 300.0 && row.output_torque_Nm >= 40.0) drag += e.corner_Nm;
  drag += e.rotation_load * row.rotation * row.output_torque_Nm;
  torque += losing * drag;

  return torque * (1.0 + e.gain) + losing * row.rotation * e.offset_Nm + added(e, row);
}

double lost_motion(const Train& train, const Effects& e, const Condition& row) {
  const double d = train.gearbox.center_distance_mm * 1e-3 *
                   (1.0 + e.expansion_1_K * (row.temperature_c - 20.0));
  std::array<double, 3> distance{d, d, d};
  for (const EccentricBody& body : e.eccentric) {
    const double shift = wave_value(body.wave, row);
    for (std::size_t k = 0; k < 3; ++k) distance[k] += body.meshes[k] ? shift : 0.0;
  }
  return lost_motion_rad(train, distance) / kArcmin + e.clearance_arcmin +
         2.0 * row.output_torque_Nm * e.compliance_arcmin_Nm + added(e, row);
}

double loss_of_pair(const Bench& bench, const Effects& e, const Condition& row) {
  const Gearbox& gearbox = bench.train.gearbox;
  const double module_m = bench.pair_module_mm * 1e-3;
  const RigMesh mesh =
      make_rig_mesh({.teeth_a = row.driving_teeth,
                     .teeth_b = row.driven_teeth,
                     .module_m = module_m,
                     .pressure_angle_rad = gearbox.pressure_angle_deg * kDeg,
                     .center_distance_m = 0.5 * module_m * (row.driving_teeth + row.driven_teeth),
                     .addendum = gearbox.addendum});
  const double mu = gearbox.friction * e.friction_factor;
  const double loss =
      mesh_loss(mesh, true, mu * (1.0 + e.approach_skew), mu * (1.0 - e.approach_skew)) +
      e.pair_bearing;
  return 1.0 - (1.0 - loss) * (1.0 + e.gain) + added(e, row);
}

// Quasi-static loop: friction holds the torque back like a play of half width h, then the elastic
// angle and the dead band follow what is left.
std::vector<double> loop(const Bench& bench, const std::vector<Condition>& rows, const Effects& e) {
  const double d = bench.train.gearbox.center_distance_mm * 1e-3;
  const double dead_band = lost_motion_rad(bench.train, {d, d, d}) / kArcmin + e.clearance_arcmin;
  const double h = bench.hysteresis_Nm;
  const double width = h / 6.0;  // of the transition: the flanks change within a fraction of h
  std::vector<double> angles;
  angles.reserve(rows.size());
  double effective = 0.0;
  for (const Condition& row : rows) {
    effective = std::clamp(effective, row.output_torque_Nm - h, row.output_torque_Nm + h);
    angles.push_back(effective * e.compliance_arcmin_Nm +
                     0.5 * dead_band * std::tanh(effective / width) + added(e, row));
  }
  return angles;
}

}  // namespace

std::vector<double> responses(const Bench& bench, const std::vector<Condition>& rows,
                              const Effects& effects) {
  if (bench.kind == Kind::torque_angle) return loop(bench, rows, effects);
  std::vector<double> values;
  values.reserve(rows.size());
  for (const Condition& row : rows) {
    switch (bench.kind) {
      case Kind::lost_motion:
        values.push_back(lost_motion(bench.train, effects, row));
        break;
      case Kind::pair_loss:
        values.push_back(loss_of_pair(bench, effects, row));
        break;
      default:
        values.push_back(sensor_torque(bench.train, effects, row));
        break;
    }
  }
  return values;
}

}  // namespace gear3k::rig
