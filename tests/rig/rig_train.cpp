#include "tests/rig/rig_train.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace gear3k::rig {
namespace {

using Drivers = std::array<bool, 3>;
using Forces = std::array<double, 3>;

struct Balance {
  Forces force_N{};
  double sun_Nm = 0.0;
};

// Forces are signed such that the mesh torques on the gears, counterclockwise positive, are
// S -F1 r, P1 -F1 r; P1 +F2 r, R1 -F2 r; P2 +F3 r, R2 -F3 r, that on the driven gear times 1 -
// loss.
Balance balance(const Train& train, double output_Nm, double pin_Nm, const Drivers& a_drives,
                const std::array<double, 3>& loss) {
  std::array<double, 3> a{}, b{};  // lever of gear a and b
  for (std::size_t k = 0; k < 3; ++k) {
    const RigMesh& mesh = train.meshes[k];
    a[k] = mesh.base_radius_a_m * (a_drives[k] ? 1.0 : 1.0 - loss[k]);
    b[k] = mesh.base_radius_b_m * (a_drives[k] ? 1.0 - loss[k] : 1.0);
  }
  Balance result;
  Forces& f = result.force_N;
  // R2 does not accelerate.
  f[2] = output_Nm / b[2];
  // Planets do not accelerate:        -b1 F1 + a2 F2 = -(a3 F3 + pin).
  // No torque on the carrier, so the external ones on S, R1 and R2 add to 0:
  //                                    a1 F1 + b2 F2 = -output.
  const double planet = -(a[2] * f[2] + pin_Nm);
  const double determinant = -b[0] * b[1] - a[1] * a[0];
  f[0] = (planet * b[1] + a[1] * output_Nm) / determinant;
  f[1] = (b[0] * output_Nm - a[0] * planet) / determinant;
  result.sun_Nm = f[0] * a[0];
  return result;
}

// Power that gear a puts into each mesh relative to the carrier, positive when it drives.
Drivers drivers_of(const Train& train, const Forces& f, double output_sense) {
  const double planet = train.planet_speed * output_sense;
  const double sun = train.sun_speed * output_sense;
  return {f[0] * sun > 0.0, -f[1] * planet > 0.0, -f[2] * planet > 0.0};
}

double pin_force(const Train& train, const Forces& f) {
  double tangential = 0.0, radial = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double aw = train.meshes[k].working_angle_rad;
    tangential += f[k] * std::cos(aw);
    radial += (k == 0 ? 1.0 : -1.0) * std::fabs(f[k]) * std::sin(aw);
  }
  return std::hypot(tangential, radial);
}

}  // namespace

Train make_train(const Gearbox& gearbox) {
  Train train;
  train.gearbox = gearbox;
  train.pairs = pairs_of(gearbox);
  for (std::size_t k = 0; k < 3; ++k) train.meshes[k] = make_rig_mesh(train.pairs[k]);
  const auto& z = gearbox.teeth;
  // Relative to the carrier R1 turns at -w_C, the rest follows by rolling.
  const double planet = -static_cast<double>(z[2]) / z[1];  // per w_C
  const double output = planet * z[3] / z[4];
  const double sun = -planet * z[1] / z[0];
  train.carrier_speed = 1.0 / (1.0 + output);
  train.planet_speed = planet * train.carrier_speed;
  train.output_speed = output * train.carrier_speed;
  train.sun_speed = sun * train.carrier_speed;
  train.ratio = train.sun_speed + train.carrier_speed;
  const std::array<double, 3> relative{train.sun_speed - train.planet_speed,
                                       train.planet_speed + train.carrier_speed,
                                       train.planet_speed - train.output_speed};
  const Balance unit = balance(train, 1.0, 0.0, {true, true, true}, {0.0, 0.0, 0.0});
  for (std::size_t k = 0; k < 3; ++k) {
    const RigMesh& mesh = train.meshes[k];
    train.sliding_m[k] = std::fabs(relative[k]) * (mesh.lever_a_m + mesh.lever_b_m);
    train.force_per_Nm[k] = std::fabs(unit.force_N[k]);
  }
  train.stribeck_speed_m_s = 0.5 * (train.sliding_m[1] + train.sliding_m[2]) *
                             (400.0 * std::numbers::pi / 30.0) / std::fabs(train.ratio);
  train.pin_radius_m = 0.3 * train.meshes[1].base_radius_a_m;
  const auto& q = gearbox.machining_allowance;
  const double m1 = gearbox.module1_mm * 1e-3, m2 = gearbox.module2_mm * 1e-3;
  train.thinning_m = {m1 * (q[0] + q[1]), m1 * (q[1] + q[2]), m2 * (q[3] + q[4])};
  return train;
}

double balanced_sun_torque(const Train& train, const TrainLoad& load) {
  const double output_sense = train.ratio > 0.0 ? load.sun_sense : -load.sun_sense;
  const double external_Nm = load.output_torque_Nm * output_sense;
  const double planet_sense = train.planet_speed * output_sense > 0.0 ? 1.0 : -1.0;
  const double output_speed = load.sun_speed_rad_s / std::fabs(train.ratio);

  std::array<double, 3> friction{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double v = train.sliding_m[k] * output_speed / train.stribeck_speed_m_s;
    friction[k] =
        train.gearbox.friction * load.friction_factor * (1.0 + load.speed_rise / (1.0 + v * v));
  }
  Balance state = balance(train, external_Nm, 0.0, {true, true, true}, {0.0, 0.0, 0.0});
  const bool depends_on_force = load.load_exponent != 0.0 || load.pin_friction != 0.0;

  const auto solve = [&](const Drivers& a_drives) {
    Balance now = state;
    for (int pass = 0; pass < 40; ++pass) {
      std::array<double, 3> loss{};
      for (std::size_t k = 0; k < 3; ++k) {
        double mu = friction[k];
        if (load.load_exponent != 0.0) {
          const double force = std::max(std::fabs(now.force_N[k]), 1e-12);
          mu *= std::pow(force / (20.0 * train.force_per_Nm[k]), load.load_exponent);
        }
        loss[k] = mesh_loss(train.meshes[k], a_drives[k], mu * (1.0 + load.approach_skew),
                            mu * (1.0 - load.approach_skew));
      }
      const double pin_Nm = load.pin_friction == 0.0
                                ? 0.0
                                : -planet_sense * load.pin_friction * train.pin_radius_m *
                                      pin_force(train, now.force_N);
      const Balance next = balance(train, external_Nm, pin_Nm, a_drives, loss);
      const double change = std::fabs(next.sun_Nm - now.sun_Nm);
      now = next;
      if (!depends_on_force || change <= 1e-14 * std::fabs(next.sun_Nm)) break;
    }
    return now;
  };

  Drivers a_drives = drivers_of(train, state.force_N, output_sense);
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Balance found = solve(a_drives);
    const Drivers driving = drivers_of(train, found.force_N, output_sense);
    if (driving == a_drives) return found.sun_Nm;
    a_drives = driving;
  }
  for (unsigned pattern = 0; pattern < 8; ++pattern) {
    a_drives = {(pattern & 1U) != 0, (pattern & 2U) != 0, (pattern & 4U) != 0};
    const Balance found = solve(a_drives);
    if (drivers_of(train, found.force_N, output_sense) == a_drives) return found.sun_Nm;
  }
  return solve(drivers_of(train, state.force_N, output_sense)).sun_Nm;
}

}  // namespace gear3k::rig
