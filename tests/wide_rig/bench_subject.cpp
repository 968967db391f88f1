#include "tests/wide_rig/bench_subject.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/rig/number_text.hpp"

namespace gear3k::wide_rig {
namespace {

constexpr double kRpm = std::numbers::pi / 30.0;
constexpr double kArcmin = std::numbers::pi / 10800.0;

// What all effects together do to the bodies and the sensor in one row.
struct Actions {
  std::array<double, 4> drag_Nm{};
  double pin = 0.0, output_bearing = 0.0, gain = 1.0, offset_Nm = 0.0;
  double lost_motion_arcmin = 0.0, expansion = 0.0, loss = 0.0;
  bool physical = true;
};

Actions actions_of(const BenchRow& row, const std::vector<AppliedEffect>& effects) {
  Actions result;
  for (const AppliedEffect& applied : effects) {
    const HiddenEffect& effect = *applied.effect;
    if (effect.channel == Channel::friction || effect.channel == Channel::skew) continue;
    const double value = effect.value(applied.amplitude, row, {});
    switch (effect.channel) {
      case Channel::drag:
        result.drag_Nm[static_cast<std::size_t>(effect.body)] += value;
        break;
      case Channel::pin:
        result.pin += value;
        break;
      case Channel::output_bearing:
        result.output_bearing += value;
        break;
      case Channel::gain:
        result.gain *= 1.0 + value;
        break;
      case Channel::offset:
        result.offset_Nm += value;
        break;
      case Channel::lost_motion:
        result.lost_motion_arcmin += value;
        break;
      case Channel::expansion:
        result.expansion += value;
        break;
      case Channel::loss:
        result.loss += value;
        break;
      case Channel::friction:
      case Channel::skew:
        break;
    }
  }
  if (result.pin < 0.0 || result.output_bearing < 0.0) result.physical = false;
  return result;
}

struct MeshFriction {
  double approach = 0.0, recess = 0.0;  // as factors of the nominal coefficient
  bool physical = true;
};

MeshFriction friction_at(const BenchRow& row, const MeshPoint& point,
                         const std::vector<AppliedEffect>& effects) {
  double factor = 1.0, skew = 0.0;
  for (const AppliedEffect& applied : effects) {
    const HiddenEffect& effect = *applied.effect;
    if (effect.channel == Channel::friction) {
      factor *= 1.0 + effect.value(applied.amplitude, row, point);
    } else if (effect.channel == Channel::skew) {
      skew += effect.value(applied.amplitude, row, point);
    }
  }
  const bool physical = factor >= 0.05 && factor <= 6.0 && std::fabs(skew) <= 0.8;
  factor = std::clamp(factor, 0.01, 8.0);
  return {factor * (1.0 + skew), factor * (1.0 - skew), physical};
}

struct Balanced {
  double sun_Nm = 0.0;  // external, signed
  std::array<double, 3> force_N{};
};

// Planets do not accelerate: -b1 F1 + a2 F2 + a3 F3 + planet = 0; nor does the whole: the external
// torques on S, R1, R2 and the carrier add to 0: a1 F1 + b2 F2 + output + carrier = 0.
struct External {
  double output_Nm = 0.0, planet_Nm = 0.0, carrier_Nm = 0.0;
};

Balanced balanced(const rig::Train& train, const External& external,
                  const std::array<bool, 3>& a_drives, const std::array<double, 3>& loss) {
  std::array<double, 3> a{}, b{};
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = train.meshes[k].base_radius_a_m * (a_drives[k] ? 1.0 : 1.0 - loss[k]);
    b[k] = train.meshes[k].base_radius_b_m * (a_drives[k] ? 1.0 - loss[k] : 1.0);
  }
  Balanced result;
  auto& f = result.force_N;
  f[2] = external.output_Nm / b[2];
  const double planet = -(a[2] * f[2] + external.planet_Nm);
  const double rest = -(external.output_Nm + external.carrier_Nm);
  // -b1 F1 + a2 F2 = planet;  a1 F1 + b2 F2 = rest.
  const double determinant = -b[0] * b[1] - a[0] * a[1];
  f[0] = (planet * b[1] - a[1] * rest) / determinant;
  f[1] = (-b[0] * rest - a[0] * planet) / determinant;
  result.sun_Nm = a[0] * f[0];
  return result;
}

BenchReading train_torque(const BenchSubject& subject, const BenchRow& row, const Actions& act,
                          const std::vector<AppliedEffect>& effects) {
  const rig::Train& train = subject.train;
  const double output_sense = train.ratio > 0.0 ? row.rotation : -row.rotation;
  const double torque_Nm = row.output_torque_Nm;
  const auto drag = [&](Body body) { return act.drag_Nm[static_cast<std::size_t>(body)]; };
  const auto sense = [&](double speed) { return speed * output_sense > 0.0 ? 1.0 : -1.0; };
  const double lost_Nm = act.output_bearing * torque_Nm + drag(Body::output);
  External external;
  external.output_Nm = output_sense * ((row.forward ? -torque_Nm : torque_Nm) - lost_Nm);
  external.carrier_Nm = -sense(train.carrier_speed) * drag(Body::carrier);
  const double planet_drag_Nm =
      -sense(train.planet_speed) * drag(Body::planet) * static_cast<double>(train.gearbox.planets);
  const double output_speed = row.sun_speed_rpm * kRpm / std::fabs(train.ratio);

  const auto drivers = [&](const std::array<double, 3>& f) {
    return std::array<bool, 3>{f[0] * train.sun_speed * output_sense > 0.0,
                               -f[1] * train.planet_speed * output_sense > 0.0,
                               -f[2] * train.planet_speed * output_sense > 0.0};
  };
  bool physical = act.physical;
  std::array<double, 3> none{};
  Balanced now = balanced(train, external, {true, true, true}, none);
  std::array<bool, 3> a_drives = drivers(now.force_N);
  for (int pass = 0; pass < 60; ++pass) {
    std::array<double, 3> loss{};
    physical = act.physical;
    for (std::size_t k = 0; k < 3; ++k) {
      const MeshPoint point{
          .mesh = k,
          .force_N = std::max(std::fabs(now.force_N[k]) / train.gearbox.planets, 1e-9),
          .sliding_m_s = train.sliding_m[k] * output_speed,
          .a_drives = a_drives[k]};
      const MeshFriction mu = friction_at(row, point, effects);
      physical = physical && mu.physical;
      loss[k] = rig::mesh_loss(train.meshes[k], a_drives[k], subject.friction * mu.approach,
                               subject.friction * mu.recess);
    }
    external.planet_Nm = planet_drag_Nm;
    if (act.pin != 0.0) {
      double tangential = 0.0, radial = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double angle = train.meshes[k].working_angle_rad;
        tangential += now.force_N[k] * std::cos(angle);
        radial += (k == 0 ? 1.0 : -1.0) * std::fabs(now.force_N[k]) * std::sin(angle);
      }
      external.planet_Nm -=
          sense(train.planet_speed) * act.pin * train.pin_radius_m * std::hypot(tangential, radial);
    }
    const Balanced next = balanced(train, external, a_drives, loss);
    const double change = std::fabs(next.sun_Nm - now.sun_Nm);
    now = next;
    // The mesh that drives may change with the drags: at first at every pass, then left alone.
    const std::array<bool, 3> found = drivers(now.force_N);
    if (found != a_drives && pass < 20) {
      a_drives = found;
    } else if (change <= 1e-13 * std::fabs(now.sun_Nm)) {
      break;
    }
  }
  const double along = now.sun_Nm * row.rotation;
  return {row.forward ? along + drag(Body::sun) : -along - drag(Body::sun), physical};
}

// The share of power that is lost follows the coefficient of friction.
BenchReading black_box_torque(const BenchSubject& box, const BenchRow& row, const Actions& act,
                              const std::vector<AppliedEffect>& effects) {
  const double i = std::fabs(box.ratio);
  const double lost_Nm = act.output_bearing * row.output_torque_Nm + act.drag_Nm[3];
  const double output_Nm = row.output_torque_Nm + (row.forward ? lost_Nm : -lost_Nm);
  const MeshPoint point{.mesh = 0,
                        .force_N = row.output_torque_Nm,
                        .sliding_m_s = row.sun_speed_rpm * kRpm,
                        .a_drives = row.forward};
  const MeshFriction mu = friction_at(row, point, effects);
  const double level = 0.5 * (mu.approach + mu.recess);
  const double sun_Nm =
      row.forward
          ? output_Nm / i * (1.0 + level * (1.0 / box.efficiency_forward - 1.0)) + act.drag_Nm[0]
          : output_Nm / i * (1.0 - level * (1.0 - box.efficiency_backward)) - act.drag_Nm[0];
  return {sun_Nm, mu.physical && act.physical};
}

}  // namespace

double BenchSubject::force_at(double output_torque_Nm) const {
  return black_box ? output_torque_Nm
                   : output_torque_Nm * train.force_per_Nm[2] / train.gearbox.planets;
}

double BenchSubject::sliding_at(double sun_speed_rpm) const {
  return black_box ? sun_speed_rpm * kRpm
                   : train.sliding_m[2] * sun_speed_rpm * kRpm / std::fabs(train.ratio);
}

BenchSubject random_gearbox(rig::DeterministicRandom& random, bool may_be_black_box) {
  BenchSubject subject;
  const double which = random.uniform();
  const std::size_t design = random.index(3);
  const double friction = std::round(random.between(0.05, 0.14) * 1000.0) / 1000.0;
  const double ratio = std::round(random.between(8.0, 160.0) * 10.0) / 10.0;
  const double forward = std::round(random.between(0.62, 0.94) * 1000.0) / 1000.0;
  const double backward = std::round((forward - random.between(0.0, 0.08)) * 1000.0) / 1000.0;
  const double backlash = std::round(random.between(1.0, 25.0) * 10.0) / 10.0;
  if (may_be_black_box && which < 0.25) {
    subject.black_box = true;
    subject.ratio = ratio;
    subject.efficiency_forward = forward;
    subject.efficiency_backward = backward;
    subject.backlash_arcmin = backlash;
    subject.toml = "[gearbox]\nratio = " + rig::number_text(ratio) +
                   "\nefficiency_forward = " + rig::number_text(forward) +
                   "\nefficiency_backward = " + rig::number_text(backward) +
                   "\nbacklash_arcmin = " + rig::number_text(backlash) + "\n";
    return subject;
  }
  rig::Gearbox gearbox = design == 0   ? rig::bilateral_drive_gear()
                         : design == 1 ? rig::low_backlash_gear()
                                       : rig::reversing_gear();
  gearbox.friction = friction;
  subject.train = rig::make_train(gearbox);
  subject.ratio = subject.train.ratio;
  subject.friction = friction;
  subject.toml = rig::design_toml(gearbox);
  return subject;
}

BenchSubject random_pair(rig::DeterministicRandom& random) {
  BenchSubject subject;
  subject.black_box = true;
  subject.friction = std::round(random.between(0.06, 0.3) * 100.0) / 100.0;
  const std::array<double, 4> modules{0.5, 0.8, 1.0, 2.0};
  subject.module_mm = modules[random.index(4)];
  subject.toml =
      "name = \"steel pairs\"\nkind = \"external\"\nmodule_mm = " +
      rig::number_text(subject.module_mm) +
      "\npressure_angle_deg = 20.0\n[gear1]\nteeth = 24\n[gear2]\nteeth = 60\n[friction]\n"
      "coefficient = " +
      rig::number_text(subject.friction) + "\nloss_model = \"sliding\"\n";
  return subject;
}

BenchReading sun_torque(const BenchSubject& subject, const BenchRow& row,
                        const std::vector<AppliedEffect>& effects) {
  const Actions act = actions_of(row, effects);
  BenchReading result = subject.black_box ? black_box_torque(subject, row, act, effects)
                                          : train_torque(subject, row, act, effects);
  const double sensor_Nm = (row.forward ? row.rotation : -row.rotation) * act.offset_Nm;
  result.value = result.value * act.gain + sensor_Nm;
  // A bench whose readings make power is found out at once.
  const double lossless_Nm = row.output_torque_Nm / std::fabs(subject.ratio);
  if (row.forward ? result.value < lossless_Nm : result.value > lossless_Nm)
    result.physical = false;
  if (!(result.value > 0.02 * lossless_Nm) || result.value > 20.0 * lossless_Nm) {
    result.physical = false;
  }
  return result;
}

BenchReading lost_motion(const BenchSubject& subject, const BenchRow& row,
                         const std::vector<AppliedEffect>& effects) {
  const Actions act = actions_of(row, effects);
  double play_arcmin = subject.backlash_arcmin;
  bool physical = true;
  if (!subject.black_box) {
    play_arcmin = 0.0;
    const rig::Train& train = subject.train;
    for (std::size_t k = 0; k < 3; ++k) {
      const double normal_m = rig::normal_backlash_m(
          train.pairs[k], train.pairs[k].center_distance_m * (1.0 + act.expansion),
          train.thinning_m[k]);
      physical = physical && normal_m > 0.0;
      play_arcmin += train.force_per_Nm[k] * normal_m / kArcmin;
    }
  }
  const double value = play_arcmin + act.lost_motion_arcmin;
  return {value, physical && value > 0.02 * play_arcmin};
}

BenchReading pair_loss(const BenchSubject& subject, const BenchRow& row,
                       const std::vector<AppliedEffect>& effects) {
  const Actions act = actions_of(row, effects);
  rig::RigPair pair{.teeth_a = std::min(row.driving_teeth, row.driven_teeth),
                    .teeth_b = std::max(row.driving_teeth, row.driven_teeth),
                    .module_m = subject.module_mm * 1e-3,
                    .pressure_angle_rad = std::numbers::pi / 9.0};
  pair.center_distance_m = 0.5 * pair.module_m * (pair.teeth_a + pair.teeth_b);
  const rig::RigMesh mesh = rig::make_rig_mesh(pair);
  const bool a_drives = row.driving_teeth == pair.teeth_a;
  const MeshFriction mu = friction_at(row, {.mesh = 0, .a_drives = a_drives}, effects);
  const double loss =
      rig::mesh_loss(mesh, a_drives, subject.friction * mu.approach, subject.friction * mu.recess);
  const double value = (loss + act.loss) * act.gain;
  return {value, mu.physical && value > 0.0 && value < 0.9};
}

}  // namespace gear3k::wide_rig
