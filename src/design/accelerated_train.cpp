#include "design/accelerated_train.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "design/train_motion.hpp"

namespace gear3k::design {

namespace {

using train::kMeshCount;
using Kinematics = std::array<MeshKinematics<double>, kMeshCount>;
using Efficiencies = std::array<train::DriverEfficiencies<double>, kMeshCount>;

constexpr int kMostMotionPasses = 5000;
constexpr int kFullMotionSteps = 50;

/// What the iteration of one motion changes.
struct MovingState {
  train::LoadedTrain<double> loaded;
  std::array<double, kShaftCount> drag_Nm{};
  double bearing_Nm = 0.0, output_bearing_Nm = 0.0;
};

/// Adds the inertia torques of the bodies.
train::BodyTorques<double> with_inertia(train::BodyTorques<double> known, const MovingTrain& t,
                                        double acceleration) {
  const train::TrainGeometry<double>& g = t.lossy.geometry;
  const auto torques = inertia::inertia_torques<double>({.teeth = g.teeth,
                                                         .planets = g.planets,
                                                         .center_distance_m = g.center_distance_m,
                                                         .bodies = t.bodies},
                                                        acceleration);
  known.sun += torques.sun;
  known.planet += torques.planet;
  known.carrier += torques.carrier;
  known.ring2 += torques.ring2;
  return known;
}

/// Friction of flanks and bearings at given mesh torques and torque at the output's shaft.
/// @returns false where it has no value
bool set_friction(const MovingTrain& t, const TrainMotion& motion, const Kinematics& mesh,
                  const MeshTorques<double>& torque_Nm, double output_torque_Nm,
                  const train::BodyTorques<double>& fixed, MovingState& state) {
  const LossyTrain<double>& lossy = t.lossy;
  const double planets = lossy.geometry.planets;
  const auto friction = efficiency::friction_at(lossy.friction, motion.temperature_K);
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[k][0]));
    const auto mu = efficiency::friction_coefficient<double>(
        friction,
        {.normal_force_N = magnitude(torque_Nm[k]) / (planets * mesh[k].central_base_radius_m),
         .sliding_speed_m_s = mesh[k].sliding_speed_m_s,
         .sum_speed_m_s = mesh[k].sum_speed_m_s,
         .reduced_radius_m = mesh[k].reduced_radius_m,
         .face_width_m = lossy.face_width_m[stage],
         .temperature_K = motion.temperature_K,
         .forward = torque_Nm[train::kMeshP2R2] > 0.0,
         .ring2_torque_Nm = magnitude(torque_Nm[train::kMeshP2R2]),
         .own_torque_Nm = ring2_torque_by(lossy.geometry.teeth, k, torque_Nm[k])});
    if (!mu) return false;
    for (const std::size_t driver : {0U, 1U}) {
      const auto flank = efficiency::flank_friction(
          lossy.friction, friction_of_mesh(lossy.friction.extension, *mu, k, driver));
      state.loaded.efficiency[k][driver] =
          t.lossless_mesh[k]
              ? 1.0
              : efficiency::mesh_efficiency(mesh[k].contact[driver], flank, lossy.friction.model);
    }
  }
  const ShaftLosses<double>& shafts = lossy.shafts;
  state.bearing_Nm = planets * shafts.planet_bearing_coefficient * shafts.planet_bearing_radius_m *
                     planet_force(lossy.geometry, mesh, torque_Nm);
  state.output_bearing_Nm = output_bearing_torque(shafts, std::abs(output_torque_Nm));
  state.loaded.known.pin = fixed.pin + pin_torque(lossy.geometry.teeth, 0.0, state.bearing_Nm);
  state.loaded.known.ring2 = fixed.ring2 - state.output_bearing_Nm;
  return true;
}

TrainInstant instant_of(const MovingTrain& t, const TrainMotion& motion, const MovingState& state,
                        const train::PowerFlow<double>& flow) {
  const double w = motion.output_speed_rad_s;
  const auto speed = shaft_speeds(t.lossy.geometry.teeth);
  TrainInstant instant{
      .sun_torque_Nm = flow.sun_torque_Nm,
      .output_torque_Nm = flow.output_torque_Nm,
      .ring2_mesh_Nm = flow.mesh_torque_Nm[train::kMeshP2R2],
      .mesh_loss_W = {},
      .drag_loss_W = {},
      .bearing_loss_W =
          (state.bearing_Nm * std::abs(speed[kPlanetShaft]) + state.output_bearing_Nm) * w,
      .gear1_drives = flow.gear1_drives};
  for (std::size_t k = 0; k < kMeshCount; ++k) instant.mesh_loss_W[k] = flow.mesh_loss_Nm[k] * w;
  for (std::size_t k = 0; k < kShaftCount; ++k) {
    instant.drag_loss_W[k] = state.drag_Nm[k] * std::abs(speed[k]) * w;
  }
  return instant;
}

/// Efficiencies where friction depends on neither speed nor load, by whether the train drives
/// forward; empty where it does, or has no value.
std::optional<std::array<Efficiencies, 2>> fixed_efficiencies(const MovingTrain& t,
                                                              const Kinematics& mesh) {
  const ShaftLosses<double>& shafts = t.lossy.shafts;
  if (t.lossy.friction.law != efficiency::FrictionLaw::kConstant ||
      efficiency::depends_on_state(t.lossy.friction.extension) ||
      shafts.planet_bearing_coefficient != 0.0 || shafts.output_bearing_share != 0.0 ||
      shafts.output_bearing_growth.share != 0.0) {
    return std::nullopt;
  }
  std::array<Efficiencies, 2> result{};
  for (const bool forward : {false, true}) {
    MovingState state{};
    MeshTorques<double> torque_Nm{};
    torque_Nm[train::kMeshP2R2] = forward ? 1.0 : 0.0;
    if (!set_friction(t, {}, mesh, torque_Nm, 0.0, {}, state)) return std::nullopt;
    result[forward ? 1 : 0] = state.loaded.efficiency;
  }
  return result;
}

}  // namespace

struct PreparedTrain::Parts {
  MovingTrain train;
  std::array<MeshConstants<double>, kMeshCount> constants{};
  Kinematics at_rest{};
  bool contact = true;
  std::optional<std::array<Efficiencies, 2>> fixed{};
};

PreparedTrain::PreparedTrain(const MovingTrain& train) {
  const auto& meshes = train.lossy.geometry.meshes;
  auto parts = std::make_shared<Parts>(Parts{.train = train});
  parts->contact =
      std::ranges::all_of(meshes, [](const auto& mesh) { return mesh.contact_ratio > 0.0; });
  if (parts->contact) {
    parts->constants = mesh_constants(train.lossy.geometry);
    for (std::size_t k = 0; k < kMeshCount; ++k) parts->at_rest[k] = parts->constants[k].at_rest;
    parts->fixed = fixed_efficiencies(train, parts->at_rest);
  }
  parts_ = std::move(parts);
}

bool PreparedTrain::is_linear() const {
  const auto& drags = parts_->train.lossy.shafts.drag;
  return parts_->fixed &&
         std::ranges::all_of(drags, [](const auto& drag) { return drag.quadratic_Nms2 == 0.0; });
}

TrainInstantResult balance_motion(const MovingTrain& t, const TrainMotion& motion) {
  return PreparedTrain(t).balance(motion);
}

TrainInstantResult PreparedTrain::balance(const TrainMotion& motion) const {
  const double speed = motion.output_speed_rad_s;
  if (!(speed >= 0.0) || !std::isfinite(speed)) {
    throw std::invalid_argument(
        fmt::format("balance_motion: output_speed_rad_s = {}, allowed: finite, 0 or more", speed));
  }
  const auto none = [](NoOperation reason) {
    return TrainInstantResult{.instant = std::nullopt, .reason = reason};
  };
  if (!parts_->contact) return none(NoOperation::kNoContact);
  const MovingTrain& t = parts_->train;
  const train::TrainGeometry<double>& g = t.lossy.geometry;
  MovingState state{.loaded = {.teeth = g.teeth, .efficiency = {}, .known = {}}};
  state.drag_Nm = drag_torques(g, t.lossy.shafts, speed, motion.temperature_K);
  state.loaded = frictionless_train(g.teeth, state.drag_Nm,
                                    {.end = motion.given_end, .torque_Nm = motion.given_torque_Nm});
  const train::BodyTorques<double> fixed =
      with_inertia(state.loaded.known, t, motion.output_acceleration_rad_s2);
  state.loaded.known = fixed;
  const bool given_output = motion.given_end == train::End::kOutput;
  if (parts_->fixed && (given_output || (*parts_->fixed)[0] == (*parts_->fixed)[1])) {
    // The torque on R2 is given, and with it the end that drives; else that decides nothing.
    const bool forward = -(motion.given_torque_Nm + fixed.ring2) > 0.0;
    state.loaded.efficiency = (*parts_->fixed)[forward ? 1 : 0];
    const auto flow = train::solve_power_flow(state.loaded);
    if (!flow) return none(NoOperation::kLocks);
    return {.instant = instant_of(t, motion, state, *flow), .reason = NoOperation::kLocks};
  }
  Kinematics mesh = parts_->at_rest;
  set_speeds(parts_->constants, std::max(speed, motion.least_friction_speed_rad_s), mesh);
  auto flow = train::solve_power_flow(state.loaded);
  if (!flow) return none(NoOperation::kLocks);
  MeshTorques<double> taken{};
  double taken_output = 0.0;
  for (int pass = 0; pass < kMostMotionPasses; ++pass) {
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const double latest = flow->mesh_torque_Nm[k];
      taken[k] = pass < kFullMotionSteps ? latest : 0.5 * (taken[k] + latest);
    }
    const double output = flow->output_torque_Nm;
    taken_output = pass < kFullMotionSteps ? output : 0.5 * (taken_output + output);
    if (!set_friction(t, motion, mesh, taken, taken_output, fixed, state)) {
      return none(NoOperation::kNoFriction);
    }
    flow = train::solve_power_flow(state.loaded);
    if (!flow) return none(NoOperation::kLocks);
    if (relative_change(taken, taken_output, flow->mesh_torque_Nm, flow->output_torque_Nm) <=
        kRepeats) {
      return {.instant = instant_of(t, motion, state, *flow), .reason = NoOperation::kLocks};
    }
  }
  return none(NoOperation::kNotConverged);
}

}  // namespace gear3k::design
