#include "design/sun_torque.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "design/scalar_as.hpp"
#include "design/train_motion.hpp"
#include "efficiency/friction_dependence.hpp"
#include "efficiency/mesh_loss_slopes.hpp"

namespace gear3k::design {

/// What SunTorque::Parts is made of.
namespace sun_torque_parts {

using train::kMeshCount, train::kMeshP1R1, train::kMeshP2R2, train::kMeshSP1;

/// What of a train depends on neither losses nor state.
struct TrainConstants {
  train::TrainGeometry<double> const& geometry;
  std::array<MeshConstants<double>, kMeshCount> constants;
  std::array<MeshKinematics<double>, kMeshCount> at_rest;
  std::array<double, kMeshCount> lever, rolling_speed, face_width_m;
  /// R2's torque over the mesh's where nothing is lost, ring2_torque_by().
  std::array<double, kMeshCount> ring2_over_own;
  std::array<double, kShaftCount> shaft_speed;  ///< over R2's
  bool meshes_run;                              ///< all have a contact ratio
};

/// The losses in a scalar, and what all states have in common.
template <class T>
struct Losses {
  Losses(const TrainConstants& train, efficiency::Friction<T> f, ShaftLosses<T> s)
      : friction(std::move(f)), shafts(std::move(s)), bent(bent_by(friction.extension)) {
    flank = efficiency::flank_friction(friction, constant<T>(0.0));
    sides_alike = is_neutral(flank.approach_factor, 1.0) && is_neutral(flank.recess_factor, 1.0);
    const T arm = shafts.planet_bearing_coefficient * shafts.planet_bearing_radius_m;
    bearing_arm_m = static_cast<double>(train.geometry.planets) * arm;
    has_bearing = !is_neutral(bearing_arm_m, 0.0);
    meshes_differ = depends_on_mesh(friction.extension);
    const bool along_path = friction.model == efficiency::LossModel::kCoulombPath ||
                            friction.model == efficiency::LossModel::kDirectional;
    linear = sides_alike && !along_path;
    for (std::size_t k = 0; linear && k < kMeshCount; ++k) {
      for (const std::size_t driver : {0U, 1U}) {
        efficiency_by_friction[k][driver] =
            mesh_efficiency_slopes(train.at_rest[k].contact[driver], {}, friction.model,
                                   efficiency::LossSlopes::kByCoefficient)
                .by_coefficient;
      }
    }
  }

  efficiency::Friction<T> friction;
  ShaftLosses<T> shafts;
  efficiency::BentBy bent;
  efficiency::FlankFriction<T> flank;  ///< its factors
  T bearing_arm_m;                     ///< of all planets' pins
  bool sides_alike, has_bearing, meshes_differ;
  bool linear;  ///< efficiencies are, in the coefficient of friction; by mesh and driver:
  std::array<std::array<double, 2>, kMeshCount> efficiency_by_friction{};
};

}  // namespace sun_torque_parts

namespace {

using namespace sun_torque_parts;

using Pattern = std::array<bool, kMeshCount>;  ///< by mesh: gear 1 drives

TrainConstants train_constants(const FixedTrain& train) {
  const train::TrainGeometry<double>& g = train.geometry;
  TrainConstants result{.geometry = g,
                        .constants = mesh_constants(g),
                        .at_rest = {},
                        .lever = train::planet_levers(g.teeth),
                        .rolling_speed = train::central_rolling_speeds(g.teeth),
                        .face_width_m = {},
                        .ring2_over_own = {},
                        .shaft_speed = shaft_speeds(g.teeth),
                        .meshes_run = std::ranges::all_of(
                            g.meshes, [](const auto& mesh) { return mesh.contact_ratio > 0.0; })};
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[k][0]));
    result.face_width_m[k] = train.face_width_m[stage];
    result.ring2_over_own[k] = ring2_torque_by(g.teeth, k, 1.0);
    result.at_rest[k] = result.constants[k].at_rest;
  }
  return result;
}

/// Where a train runs.
struct Running {
  const TrainConstants& train;
  std::array<double, kMeshCount> sliding_speed_m_s{}, sum_speed_m_s{};
  double output_speed_rad_s = 0.0;
  double temperature_K = 0.0;
  bool forward = true;
  double output_torque_Nm = 0.0;  ///< on R2, along the rotation at w_R2 = 1
};

Running running_at(const TrainConstants& train, const OperatingPoint<double>& point,
                   Direction direction) {
  const bool forward = direction == Direction::kForward;
  Running r{.train = train,
            .output_speed_rad_s = point.sun_speed_rad_s / std::abs(train.shaft_speed[kSunShaft]),
            .temperature_K = point.temperature_K,
            .forward = forward,
            .output_torque_Nm = forward ? -point.output_torque_Nm : point.output_torque_Nm};
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const MeshConstants<double>& c = train.constants[k];
    const double line_speed = c.line_radius_m * r.output_speed_rad_s;
    r.sliding_speed_m_s[k] = c.sliding_per_turning_m * (line_speed * c.curvature_1_m);
    r.sum_speed_m_s[k] = 2.0 * line_speed * c.tan_alpha_w;
  }
  return r;
}

/// Torques that no friction of a mesh or a pin changes, as train::BodyTorques has them.
template <class T>
struct Known {
  T sun, pin, ring2_mesh;
  T rest;  ///< of the meshes of S and R1 together
};

template <class T>
Known<T> known_of(const Running& r, const ShaftLosses<T>& shafts) {
  const TrainConstants& g = r.train;
  const auto drag = drag_torques<T>(g.geometry, shafts, r.output_speed_rad_s, r.temperature_K);
  const auto against = [&](ShaftId shaft) {
    return T(-sign_of(g.shaft_speed[shaft]) * drag[shaft]);
  };
  const T ring2 = -drag[kOutputShaft] -
                  output_bearing_torque(shafts, constant<T>(std::abs(r.output_torque_Nm)));
  const T ring2_mesh = -(r.output_torque_Nm + ring2);
  return {.sun = against(kSunShaft),
          .pin = against(kPlanetShaft),
          .ring2_mesh = ring2_mesh,
          .rest = against(kCarrierShaft) - ring2_mesh};
}

template <class To, class From>
Known<To> known_as(const Known<From>& k) {
  return {.sun = scalar_as<To>(k.sun),
          .pin = scalar_as<To>(k.pin),
          .ring2_mesh = scalar_as<To>(k.ring2_mesh),
          .rest = scalar_as<To>(k.rest)};
}

/// Efficiency of a mesh with friction that differs from side to side, or in a path model.
template <class T>
T path_efficiency_of(const efficiency::MeshContact<double>& contact, const Losses<T>& losses,
                     const T& coefficient) {
  constexpr bool kValue = std::is_floating_point_v<T>;
  const efficiency::LossModel model = losses.friction.model;
  const bool sides_alike = losses.sides_alike;
  const efficiency::LossSlopes wanted = kValue        ? efficiency::LossSlopes::kNone
                                        : sides_alike ? efficiency::LossSlopes::kByCoefficient
                                                      : efficiency::LossSlopes::kByAll;
  efficiency::FlankFriction<T> mu = losses.flank;
  mu.coefficient = coefficient;
  const efficiency::MeshEfficiencySlopes eta =
      mesh_efficiency_slopes(contact,
                             {.coefficient = value_of(mu.coefficient),
                              .approach_factor = value_of(mu.approach_factor),
                              .recess_factor = value_of(mu.recess_factor)},
                             model, wanted);
  if constexpr (kValue) {
    return eta.efficiency;
  } else {
    T result(eta.efficiency, eta.by_coefficient * mu.coefficient.v);
    if (!sides_alike) {
      result.v +=
          eta.by_approach_factor * mu.approach_factor.v + eta.by_recess_factor * mu.recess_factor.v;
    }
    return result;
  }
}

template <class T>
efficiency::FrictionAtTemperature<T> friction_in(const Running& r, const Losses<T>& losses) {
  return efficiency::friction_at(losses.friction, losses.bent, constant<T>(r.temperature_K));
}

/// Moment on the planets per torque on the central gear of a mesh under friction; empty where
/// friction has no value or the mesh cannot run.
template <class T>
std::optional<T> moment_of(const Running& r, const Losses<T>& losses,
                           const efficiency::FrictionAtTemperature<T>& friction, std::size_t k,
                           bool gear1_drives, const T& torque_Nm, const T& ring2_torque_Nm) {
  const TrainConstants& g = r.train;
  const MeshKinematics<double>& mesh = g.at_rest[k];
  const T torque = magnitude(torque_Nm);
  std::optional<T> mu = efficiency::friction_coefficient<T>(
      friction, {.normal_force_N = torque / (g.geometry.planets * mesh.central_base_radius_m),
                 .sliding_speed_m_s = constant<T>(r.sliding_speed_m_s[k]),
                 .sum_speed_m_s = constant<T>(r.sum_speed_m_s[k]),
                 .reduced_radius_m = constant<T>(mesh.reduced_radius_m),
                 .face_width_m = constant<T>(g.face_width_m[k]),
                 .temperature_K = constant<T>(r.temperature_K),
                 .forward = r.forward,
                 .ring2_torque_Nm = magnitude(ring2_torque_Nm),
                 .own_torque_Nm = g.ring2_over_own[k] * torque});
  if (!mu) return std::nullopt;
  const std::size_t driver = gear1_drives ? 0 : 1;
  if (losses.meshes_differ) mu = friction_of_mesh(losses.friction.extension, *mu, k, driver);
  const T eta = losses.linear ? T(1.0 + losses.efficiency_by_friction[k][driver] * *mu)
                              : path_efficiency_of<T>(mesh.contact[driver], losses, *mu);
  if (!(value_of(eta) > 0.0)) return std::nullopt;
  const bool central_drives = gear1_drives == train::central_is_gear1(k);
  return central_drives ? T(g.lever[k] * eta) : T(g.lever[k] / eta);
}

/// Torques of the meshes of S and R1.
template <class T>
struct Shared {
  T sun, ring1;
};

/// train::solve_power_flow() where the members that drive and the torque on R2 are given.
/// @param moment  on the planets per torque of each mesh
template <class T>
Shared<T> balance(const Known<T>& known, const std::array<T, kMeshCount>& moment, const T& pin) {
  const T rest_moment = -pin - moment[kMeshP2R2] * known.ring2_mesh;
  const T difference = moment[kMeshSP1] - moment[kMeshP1R1];
  return {.sun = T((rest_moment - moment[kMeshP1R1] * known.rest) / difference),
          .ring1 = T((moment[kMeshSP1] * known.rest - rest_moment) / difference)};
}

/// Torque of all planets' pins under the given mesh torques.
template <class T>
T pin_of(const Running& r, const Losses<T>& losses, const Known<T>& known,
         const MeshTorques<T>& torque_Nm) {
  if (!losses.has_bearing) return known.pin;
  const TrainConstants& g = r.train;
  const T friction = losses.bearing_arm_m * planet_force<T>(g.geometry, g.at_rest, torque_Nm);
  return T(known.pin - sign_of(g.shaft_speed[kPlanetShaft]) * friction);
}

/// F: the train in balance with the friction that given mesh torques make.
/// @param ring2_moment  of R2's mesh, where it is known
template <class T>
std::optional<Shared<T>> balance_at(const Running& r, const Losses<T>& losses,
                                    const Known<T>& known, const MeshTorques<T>& torque_Nm,
                                    const Pattern& drives, const T* ring2_moment) {
  const auto friction = friction_in(r, losses);
  std::array<T, kMeshCount> moment{};
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    if (k == kMeshP2R2 && ring2_moment != nullptr) {
      moment[k] = *ring2_moment;
      continue;
    }
    const auto found =
        moment_of(r, losses, friction, k, drives[k], torque_Nm[k], torque_Nm[kMeshP2R2]);
    if (!found) return std::nullopt;
    moment[k] = *found;
  }
  return balance(known, moment, pin_of(r, losses, known, torque_Nm));
}

/// Which members drive under the given torques, as train::solve_power_flow() has it.
Pattern pattern_of(const TrainConstants& g, const MeshTorques<double>& torque_Nm,
                   const Pattern& at_rest) {
  Pattern pattern = at_rest;
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const double into_central = torque_Nm[k] * g.rolling_speed[k];
    if (into_central != 0.0) pattern[k] = (into_central < 0.0) == train::central_is_gear1(k);
  }
  return pattern;
}

MeshTorques<double> without_mesh_losses(const TrainConstants& g, const Known<double>& known,
                                        double pin) {
  const Shared<double> shared = balance(known, g.lever, pin);
  return {shared.sun, shared.ring1, known.ring2_mesh};
}

/// Mesh torques that make the friction which makes them, and ∂F/∂τ there.
struct Settled {
  MeshTorques<double> torque_Nm{};
  double slope = 0.0;
};

}  // namespace

struct SunTorque::Parts {
  template <class T>
  static bool loaded(const Losses<T>& l) {
    return l.has_bearing || efficiency::state_dependence(l.friction).load;
  }
  Parts(const FixedTrain& fixed, const VariedLosses& varied)
      : train(train_constants(fixed)),
        losses(train, varied.friction, varied.shafts),
        numbers(train, friction_as<double>(varied.friction), shafts_as<double>(varied.shafts)),
        by_torque(train, friction_as<JetTorque>(numbers.friction),
                  shafts_as<JetTorque>(numbers.shafts)),
        reads_torques(loaded(losses)),
        iterates(loaded(numbers)) {}

  [[nodiscard]] std::optional<Settled> settled(const Running& r, const Known<double>& known,
                                               const Pattern& drives,
                                               const MeshTorques<double>& start) const;
  [[nodiscard]] std::optional<Jet1> sun_torque(const Running& r,
                                               const Jet1& more_output_torque_Nm) const;

  TrainConstants train;
  Losses<Jet1> losses;
  Losses<double> numbers;
  Losses<JetTorque> by_torque;
  bool reads_torques;  ///< friction or its derivatives depend on the torques
  bool iterates;       ///< friction does
};

std::optional<Settled> SunTorque::Parts::settled(const Running& r, const Known<double>& known,
                                                 const Pattern& drives,
                                                 const MeshTorques<double>& start) const {
  Settled s{.torque_Nm = start};
  if (!reads_torques) return s;
  const double ring2 = known.ring2_mesh;
  const auto ring2_moment =
      moment_of(r, numbers, friction_in(r, numbers), kMeshP2R2, drives[kMeshP2R2], ring2, ring2);
  if (!ring2_moment) return std::nullopt;
  const auto first = balance_at(r, numbers, known, start, drives, &*ring2_moment);
  if (!first) return std::nullopt;
  s.torque_Nm = {first->sun, first->ring1, ring2};
  if (!iterates) return s;
  const auto constants = known_as<JetTorque>(known);
  const auto moment = constant<JetTorque>(*ring2_moment);
  // Errors of a step, and of the slope drawn on to it, are about the square of its change.
  constexpr double kSettled = 1e-8;
  double slope_before = 0.0;
  double change_before = 0.0;
  constexpr int kFewPasses = 20;
  for (int pass = 0; pass < kFewPasses; ++pass) {
    MeshTorques<JetTorque> torque{JetTorque(s.torque_Nm[kMeshSP1], 0),
                                  JetTorque(s.torque_Nm[kMeshP1R1], 0), constant<JetTorque>(ring2)};
    torque[kMeshP1R1].v[0] = -1.0;
    const auto next = balance_at(r, by_torque, constants, torque, drives, &moment);
    if (!next) return std::nullopt;
    s.slope = next->sun.v[0];
    if (!(std::abs(s.slope) < 1.0)) return std::nullopt;
    const double change = (next->sun.a - s.torque_Nm[kMeshSP1]) / (1.0 - s.slope);
    s.torque_Nm = {next->sun.a + s.slope * change, next->ring1.a - s.slope * change, ring2};
    const double scale = std::max(
        {std::abs(s.torque_Nm[kMeshSP1]), std::abs(s.torque_Nm[kMeshP1R1]), std::abs(ring2)});
    if (std::abs(change) <= kSettled * scale) {
      if (change_before != 0.0) s.slope += (s.slope - slope_before) / change_before * change;
      return s;
    }
    slope_before = s.slope;
    change_before = change;
  }
  return std::nullopt;
}

std::optional<Jet1> SunTorque::Parts::sun_torque(const Running& r,
                                                 const Jet1& more_output_torque_Nm) const {
  Known<Jet1> known = known_of(r, losses.shafts);
  const Jet1 more = (r.forward ? -1.0 : 1.0) * more_output_torque_Nm;
  known.ring2_mesh = known.ring2_mesh - more;
  known.rest = known.rest + more;
  const auto numbers_known = known_as<double>(known);
  const auto start = without_mesh_losses(train, numbers_known, numbers_known.pin);
  const Pattern drives = pattern_of(train, start, Pattern{});
  const auto at = settled(r, numbers_known, drives, start);
  if (!at) return std::nullopt;
  // At the torque of S the others have derivatives of their own.
  MeshTorques<Jet1> torque{Jet1(at->torque_Nm[kMeshSP1]), known.rest, known.ring2_mesh};
  torque[kMeshP1R1].a = at->torque_Nm[kMeshP1R1];
  const auto balanced = balance_at<Jet1>(r, losses, known, torque, drives, nullptr);
  if (!balanced) return std::nullopt;
  const MeshTorques<double> found{balanced->sun.a, balanced->ring1.a, numbers_known.ring2_mesh};
  if (!std::ranges::all_of(found, [](double x) { return std::isfinite(x); })) return std::nullopt;
  if (pattern_of(train, found, drives) != drives) return std::nullopt;
  if (numbers.has_bearing) {
    const double pin = pin_of(r, numbers, numbers_known, found);
    const auto lossless = without_mesh_losses(train, numbers_known, pin);
    if (pattern_of(train, lossless, Pattern{}) != drives) return std::nullopt;
  }
  Jet1 sun = balanced->sun;
  sun.v /= 1.0 - at->slope;
  sun = -sun - known.sun;
  if (!std::isfinite(sun.a) || !sun.v.allFinite()) return std::nullopt;
  return Jet1((r.forward ? 1.0 : -1.0) * sign_of(train.shaft_speed[kSunShaft]) * sun);
}

SunTorque::SunTorque(const FixedTrain& train, const VariedLosses& losses)
    : parts_(std::make_shared<const Parts>(train, losses)) {}

std::optional<Jet1> SunTorque::at(const OperatingPoint<double>& point, Direction direction,
                                  const Jet1& more_output_torque_Nm) const {
  const auto is_magnitude = [](double x) { return x >= 0.0 && std::isfinite(x); };
  if (!is_magnitude(point.sun_speed_rad_s) || !is_magnitude(point.output_torque_Nm)) {
    return std::nullopt;
  }
  if (!parts_->train.meshes_run) return std::nullopt;
  return parts_->sun_torque(running_at(parts_->train, point, direction), more_output_torque_Nm);
}

}  // namespace gear3k::design
