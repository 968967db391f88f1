#include "design/operation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "design/train_motion.hpp"

namespace gear3k::design {

namespace {

using train::kMeshCount;

/// A train in motion before it is told in terms of a drive direction.
template <class T>
struct Motion {
  train::PowerFlow<T> flow;
  std::array<MeshOperation<T>, kMeshCount> mesh;
  std::array<T, kShaftCount> drag_Nm;  ///< magnitudes, all planets together
  T bearing_Nm;                        ///< magnitude, all planets together
  T output_bearing_Nm;                 ///< magnitude
};

template <class T>
struct MotionResult {
  std::optional<Motion<T>> motion;
  NoOperation reason = NoOperation::kLocks;
};

/// What friction depends on besides the torques.
template <class T>
struct FrictionState {
  T temperature_K;
  bool forward;
};

/// Sets the friction of flanks and bearings that the given mesh torques make, and that of R2's
/// bearing under the given torque at the output's shaft.
/// @returns false where the friction law has no value
template <class T>
bool apply_friction(const LossyTrain<T>& t, const FrictionState<T>& state,
                    const std::array<MeshKinematics<T>, kMeshCount>& mesh,
                    const MeshTorques<T>& torque_Nm, const T& output_torque_Nm, Motion<T>& motion,
                    train::LoadedTrain<T>& loaded) {
  const double planets = t.geometry.planets;
  const auto friction = efficiency::friction_at(t.friction, state.temperature_K);
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    auto& m = motion.mesh[k];
    m.normal_force_N = magnitude(torque_Nm[k]) / (planets * mesh[k].central_base_radius_m);
    m.sliding_speed_m_s = mesh[k].sliding_speed_m_s;
    const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[k][0]));
    const auto mu = efficiency::friction_coefficient<T>(
        friction, {.normal_force_N = m.normal_force_N,
                   .sliding_speed_m_s = m.sliding_speed_m_s,
                   .sum_speed_m_s = mesh[k].sum_speed_m_s,
                   .reduced_radius_m = mesh[k].reduced_radius_m,
                   .face_width_m = t.face_width_m[stage],
                   .temperature_K = state.temperature_K,
                   .forward = state.forward,
                   .ring2_torque_Nm = magnitude(torque_Nm[train::kMeshP2R2]),
                   .own_torque_Nm = ring2_torque_by(t.geometry.teeth, k, torque_Nm[k])});
    if (!mu) return false;
    m.friction = *mu;
    for (const std::size_t driver : {0U, 1U}) {
      const auto flank = efficiency::flank_friction(
          t.friction, friction_of_mesh(t.friction.extension, *mu, k, driver));
      loaded.efficiency[k][driver] =
          efficiency::mesh_efficiency(mesh[k].contact[driver], flank, t.friction.model);
    }
  }
  motion.bearing_Nm = planets * t.shafts.planet_bearing_coefficient *
                      t.shafts.planet_bearing_radius_m * planet_force(t.geometry, mesh, torque_Nm);
  loaded.known.pin = pin_torque(t.geometry.teeth, motion.drag_Nm[kPlanetShaft], motion.bearing_Nm);
  motion.output_bearing_Nm = output_bearing_torque(t.shafts, magnitude(output_torque_Nm));
  loaded.known.ring2 = -motion.drag_Nm[kOutputShaft] - motion.output_bearing_Nm;
  return true;
}

constexpr int kMostPasses = 5000;
// A steep friction law may alternate between two states: half steps after so many whole ones.
constexpr int kFullSteps = 50;

template <class T>
MotionResult<T> move(const LossyTrain<T>& t, const OperatingPoint<T>& point, Direction direction,
                     const EndLoad<T>& load) {
  const auto none = [](NoOperation reason) {
    return MotionResult<T>{.motion = std::nullopt, .reason = reason};
  };
  for (const auto& mesh : t.geometry.meshes) {
    if (!(value_of(mesh.contact_ratio) > 0.0)) return none(NoOperation::kNoContact);
  }
  const T output_speed =
      point.sun_speed_rad_s / std::abs(train::speed_ratios(t.geometry.teeth).sun);
  const auto mesh = kinematics(t.geometry, output_speed);
  Motion<T> motion{};
  motion.drag_Nm = drag_torques(t.geometry, t.shafts, output_speed, point.temperature_K);
  motion.bearing_Nm = constant<T>(0.0);
  motion.output_bearing_Nm = constant<T>(0.0);
  const FrictionState<T> state{.temperature_K = point.temperature_K,
                               .forward = direction == Direction::kForward};
  train::LoadedTrain<T> loaded = frictionless_train(t.geometry.teeth, motion.drag_Nm, load);
  auto flow = train::solve_power_flow(loaded);
  if (!flow) return none(NoOperation::kLocks);

  bool repeats = false;
  int passes = kMostPasses;
  MeshTorques<T> taken{};  // the torques that friction is taken at
  T taken_output{};
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const T& latest = flow->mesh_torque_Nm[k];
      taken[k] = pass < kFullSteps ? latest : T(0.5 * (taken[k] + latest));
    }
    const T& output = flow->output_torque_Nm;
    taken_output = pass < kFullSteps ? output : T(0.5 * (taken_output + output));
    if (!apply_friction(t, state, mesh, taken, taken_output, motion, loaded)) {
      return none(NoOperation::kNoFriction);
    }
    flow = train::solve_power_flow(loaded);
    if (!flow) return none(NoOperation::kLocks);
    if (!repeats && relative_change(taken, taken_output, flow->mesh_torque_Nm,
                                    flow->output_torque_Nm) <= kRepeats) {
      repeats = true;
      // Derivatives follow the values at the same rate, one pass behind: as many passes again.
      passes = std::is_floating_point_v<T> ? pass + 1 : 2 * (pass + 1);
    }
  }
  if (!repeats) return none(NoOperation::kNotConverged);
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    auto& m = motion.mesh[k];
    m.gear1_drives = flow->gear1_drives[k];
    const std::size_t driver = m.gear1_drives ? 0 : 1;
    m.friction = friction_of_mesh(t.friction.extension, m.friction, k, driver);
    m.efficiency = loaded.efficiency[k][driver];
    m.loss_W = flow->mesh_loss_Nm[k] * output_speed;
  }
  motion.flow = *flow;
  return {.motion = motion, .reason = NoOperation::kLocks};
}

void require_magnitude(const char* name, double value) {
  if (value >= 0.0 && std::isfinite(value)) return;
  throw std::invalid_argument(
      fmt::format("operate: {} = {}, allowed: finite, 0 or more", name, value));
}

template <class T>
OperationResult<T> operation_of(const LossyTrain<T>& t, const OperatingPoint<T>& point,
                                Direction direction, const EndLoad<T>& load) {
  require_magnitude("sun_speed_rad_s", value_of(point.sun_speed_rad_s));
  require_magnitude("output_torque_Nm", value_of(point.output_torque_Nm));
  const MotionResult<T> moved = move(t, point, direction, load);
  if (!moved.motion) return {.operation = std::nullopt, .reason = moved.reason};
  const Motion<T>& motion = *moved.motion;
  const train::SpeedRatios w = train::speed_ratios(t.geometry.teeth);
  const double ratio = std::abs(w.sun);
  const T output_speed = point.sun_speed_rad_s / ratio;
  const double forward = direction == Direction::kForward ? 1.0 : -1.0;
  Operation<T> o{};
  o.sun_torque_Nm = forward * sign_of(w.sun) * motion.flow.sun_torque_Nm;
  o.output_torque_Nm = -forward * motion.flow.output_torque_Nm;
  const T sun_end = ratio * o.sun_torque_Nm;
  const T& numerator = forward > 0.0 ? o.output_torque_Nm : sun_end;
  const T& denominator = forward > 0.0 ? sun_end : o.output_torque_Nm;
  if (value_of(denominator) > 0.0) o.efficiency = T(numerator / denominator);
  o.mesh = motion.mesh;
  const auto speed = shaft_speeds(t.geometry.teeth);
  o.loss_W = constant<T>(0.0);
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    o.drag_loss_W[i] = motion.drag_Nm[i] * std::abs(speed[i]) * output_speed;
    o.loss_W = o.loss_W + o.drag_loss_W[i];
  }
  o.bearing_loss_W =
      (motion.bearing_Nm * std::abs(speed[kPlanetShaft]) + motion.output_bearing_Nm) * output_speed;
  o.loss_W = o.loss_W + o.bearing_loss_W;
  for (const auto& m : o.mesh) o.loss_W = o.loss_W + m.loss_W;
  // Positive at the ends that drive; with a helped sun, both.
  const T sun_power = forward * sun_end * output_speed;
  const T output_power = -forward * o.output_torque_Nm * output_speed;
  o.input_power_W = larger(sun_power, constant<T>(0.0)) + larger(output_power, constant<T>(0.0));
  return {.operation = o, .reason = NoOperation::kLocks};
}

}  // namespace

std::string_view no_operation_text(NoOperation reason) {
  switch (reason) {
    case NoOperation::kLocks:
      break;
    case NoOperation::kNoFriction:
      return "the friction law has no value here";
    case NoOperation::kNoContact:
      return "a mesh has no contact";
    case NoOperation::kNotConverged:
      return "no torques found: friction and tooth forces do not settle, close to locking";
  }
  return "it locks: no torques are in balance while it turns";
}

template <class T>
OperationResult<T> operate(const LossyTrain<T>& train, const OperatingPoint<T>& point,
                           Direction direction) {
  const T torque =
      direction == Direction::kForward ? T(-point.output_torque_Nm) : point.output_torque_Nm;
  return operation_of<T>(train, point, direction,
                         {.end = train::End::kOutput, .torque_Nm = torque});
}

namespace {

template <class T>
OperatingPoint<T> with_output_torque(OperatingPoint<T> point, const T& torque_Nm) {
  point.output_torque_Nm = torque_Nm;
  return point;
}

/// Torque at R2, found by bisection of the backward operation, at which the sun's torque passes
/// through zero; empty where it does not, or jumps over it.
template <class T>
std::optional<T> freeing_torque(const LossyTrain<T>& train, const OperatingPoint<T>& point) {
  const auto driven_by = [&](const T& torque_Nm) {
    return operate(train, with_output_torque(point, torque_Nm), Direction::kBackward).operation;
  };
  const auto sun_torque = [&](double torque_Nm) {
    const auto operation = driven_by(constant<T>(torque_Nm));
    return operation ? value_of(operation->sun_torque_Nm) : -1.0;  // not driven
  };
  constexpr double kLeast = 1e-9;
  constexpr double kGreatest = 1e9;
  constexpr double kGrowth = 1.25;
  double low = kLeast;
  double high = low;
  while (!(sun_torque(high) > 0.0)) {
    low = high;
    high *= kGrowth;
    if (high > kGreatest) return std::nullopt;
  }
  for (double middle = 0.5 * (low + high); middle > low && middle < high;
       middle = 0.5 * (low + high)) {
    (sun_torque(middle) > 0.0 ? high : low) = middle;
  }
  const auto root = driven_by(constant<T>(high));
  constexpr double kJump = 1e-12;
  if (!root || value_of(root->sun_torque_Nm) > kJump * high) return std::nullopt;
  T torque = constant<T>(high);
  if constexpr (!std::is_floating_point_v<T>) {
    // Implicit function theorem; its slope from the same point with all of the torque's own
    // derivatives at 1.
    T moved = torque;
    moved.v.setOnes();
    const auto slope = driven_by(moved);
    if (!slope) return std::nullopt;
    const auto& own = root->sun_torque_Nm.v;
    torque.v = -own.cwiseQuotient(slope->sun_torque_Nm.v - own);
  }
  return torque;
}

}  // namespace

template <class T>
OperationResult<T> drive_free_sun(const LossyTrain<T>& train, const OperatingPoint<T>& point) {
  OperationResult<T> direct = operation_of<T>(
      train, point, Direction::kBackward, {.end = train::End::kSun, .torque_Nm = constant<T>(0.0)});
  const bool may_run =
      direct.reason == NoOperation::kLocks || direct.reason == NoOperation::kNotConverged;
  if (direct.operation || !may_run) return direct;
  // Some pass may lock on the way to a balance that exists: search it from R2's side.
  const auto torque = freeing_torque(train, point);
  if (!torque) return direct;
  OperationResult<T> found =
      operate(train, with_output_torque(point, *torque), Direction::kBackward);
  if (found.operation) found.operation->sun_torque_Nm = constant<T>(0.0);
  return found;
}

template <class T>
std::optional<std::array<T, kMeshCount>> mesh_friction(const LossyTrain<T>& train,
                                                       const OperatingPoint<T>& point,
                                                       Direction direction) {
  std::array<T, kMeshCount> mu{};
  if (!efficiency::depends_on_state(train.friction)) {
    const auto& extension = train.friction.extension;
    const bool forward = direction == Direction::kForward;
    const T same = train.friction.coefficient * constant_factor(extension, forward);
    const bool g2_below_one = train::g2(train.geometry.teeth) < 1.0;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const bool gear1 = train::gear1_drives(static_cast<train::MeshId>(k), g2_below_one, forward);
      mu[k] = friction_of_mesh(extension, same, k, gear1 ? 0 : 1);
    }
    return mu;
  }
  const OperationResult<T> result = operate(train, point, direction);
  if (!result.operation) return std::nullopt;
  for (std::size_t k = 0; k < kMeshCount; ++k) mu[k] = result.operation->mesh[k].friction;
  return mu;
}

#define INSTANTIATE(T)                                                                           \
  template OperationResult<T> operate<T>(const LossyTrain<T>&, const OperatingPoint<T>&,         \
                                         Direction);                                             \
  template OperationResult<T> drive_free_sun<T>(const LossyTrain<T>&, const OperatingPoint<T>&); \
  template std::optional<std::array<T, kMeshCount>> mesh_friction<T>(                            \
      const LossyTrain<T>&, const OperatingPoint<T>&, Direction);
INSTANTIATE(double)
INSTANTIATE(Jet1)
#undef INSTANTIATE

}  // namespace gear3k::design
