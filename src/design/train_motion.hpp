#pragma once
// What the balance of a train in steady motion is made of, for operate() and sun_torque(): internal
// to design/.  T: scalar of losses and torques, G: of the geometry.

#include <algorithm>
#include <array>
#include <cmath>

#include "design/operation.hpp"

namespace gear3k::design {

template <class T>
using MeshTorques = std::array<T, train::kMeshCount>;

inline double sign_of(double x) { return x < 0.0 ? -1.0 : 1.0; }

/// The coefficient of friction of a mesh by which of its gears drives.
/// @param driver  0: gear 1, the inner one; 1: gear 2
template <class T>
T friction_of_mesh(const efficiency::FrictionExtension<T>& extension, const T& coefficient,
                   std::size_t mesh, std::size_t driver) {
  if (!efficiency::depends_on_mesh(extension)) return coefficient;
  const bool with_ring = mesh != train::kMeshSP1;
  return T(coefficient * efficiency::mesh_factor(extension, with_ring, driver == 0));
}

/// What of a mesh does not depend on its load.
template <class T>
struct MeshKinematics {
  T sliding_speed_m_s{}, sum_speed_m_s{}, reduced_radius_m{};
  T central_base_radius_m{};  ///< of S, R1 or R2
  T central_working_radius_m{};
  std::array<efficiency::MeshContact<T>, 2> contact{};  ///< gear 1 drives, gear 2 drives
};

/// What of a mesh depends on neither speed nor load.
template <class T>
struct MeshConstants {
  T line_radius_m{};          ///< speed along the line of action over the output's
  T curvature_1_m{};          ///< 1/r_b1 ± 1/r_b2
  T sliding_per_turning_m{};  ///< mean sliding speed over the sum of the rolling speeds
  T tan_alpha_w{};
  MeshKinematics<T> at_rest{};  ///< its speeds are not set
};

template <class T>
std::array<MeshConstants<T>, train::kMeshCount> mesh_constants(const train::TrainGeometry<T>& g) {
  const std::array<double, train::kMeshCount> rolling = train::central_rolling_speeds(g.teeth);
  std::array<MeshConstants<T>, train::kMeshCount> result;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const auto& gear1 = g.gears[static_cast<std::size_t>(first)];
    const auto& gear2 = g.gears[static_cast<std::size_t>(second)];
    const auto& central = g.gears[train::kCentralGears[k]];
    const auto& mesh = g.meshes[k];
    const double sign = geometry::mesh_sign(gear2.gear.kind);
    auto& c = result[k];
    auto& m = c.at_rest;
    m.contact = {efficiency::contact_of(gear1, gear2, mesh, true),
                 efficiency::contact_of(gear1, gear2, mesh, false)};
    const T factor = efficiency::sliding_factor(m.contact[0].approach_contact_ratio,
                                                m.contact[0].recess_contact_ratio);
    c.line_radius_m = central.base_radius_m * std::abs(rolling[k]);
    c.curvature_1_m = 1.0 / gear1.base_radius_m + sign / gear2.base_radius_m;
    c.sliding_per_turning_m = 0.5 * factor * mesh.base_pitch_m;
    c.tan_alpha_w = mesh.tan_alpha_w;
    m.reduced_radius_m = mesh.tan_alpha_w / c.curvature_1_m;
    m.central_base_radius_m = central.base_radius_m;
    m.central_working_radius_m =
        central.base_radius_m * mesh.center_distance_m / geometry::base_radius_sum(gear1, gear2);
  }
  return result;
}

/// Sets the speeds of the meshes.
template <class T>
void set_speeds(const std::array<MeshConstants<T>, train::kMeshCount>& constants,
                const T& output_speed_rad_s,
                std::array<MeshKinematics<T>, train::kMeshCount>& meshes) {
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    // Speed along the line of action and the sum (difference) of the gears' rolling speeds.
    const T line_speed = constants[k].line_radius_m * output_speed_rad_s;
    const T turning = line_speed * constants[k].curvature_1_m;
    meshes[k].sliding_speed_m_s = constants[k].sliding_per_turning_m * turning;
    meshes[k].sum_speed_m_s = 2.0 * line_speed * constants[k].tan_alpha_w;
  }
}

template <class T>
std::array<MeshKinematics<T>, train::kMeshCount> kinematics(
    const std::array<MeshConstants<T>, train::kMeshCount>& constants, const T& output_speed_rad_s) {
  std::array<MeshKinematics<T>, train::kMeshCount> result;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) result[k] = constants[k].at_rest;
  set_speeds(constants, output_speed_rad_s, result);
  return result;
}
template <class T>
std::array<MeshKinematics<T>, train::kMeshCount> kinematics(const train::TrainGeometry<T>& g,
                                                            const T& output_speed_rad_s) {
  return kinematics(mesh_constants(g), output_speed_rad_s);
}

/// Resultant of the mesh forces on one planet.
template <class T, class G>
T planet_force(const train::TrainGeometry<G>& g,
               const std::array<MeshKinematics<G>, train::kMeshCount>& mesh,
               const MeshTorques<T>& torque_Nm) {
  using std::sqrt;
  T tangential = constant<T>(0.0);
  T radial = constant<T>(0.0);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const T force =
        torque_Nm[k] / (static_cast<double>(g.planets) * mesh[k].central_working_radius_m);
    tangential = tangential - force;
    // The sun presses the planet outwards, the rings press it inwards.
    const double outward = k == train::kMeshSP1 ? 1.0 : -1.0;
    radial = radial + outward * magnitude(force) * g.meshes[k].tan_alpha_w;
  }
  const T square = tangential * tangential + radial * radial;
  return value_of(square) > 0.0 ? T(sqrt(square)) : constant<T>(0.0);
}

/// @tparam V  scalar of the speed
template <class T, class V>
T drag_torque(const ShaftDrag<T>& drag, const V& speed_rad_s) {
  const V w = magnitude(speed_rad_s);
  return drag.constant_Nm + drag.viscous_Nms * w + drag.quadratic_Nms2 * w * w;
}

/// Load at one end, along the rotation at w_R2 = 1.
template <class T>
struct EndLoad {
  train::End end;
  T torque_Nm;
};

/// Speeds that the drags act at, over |w_R2|, by ShaftId.
inline std::array<double, kShaftCount> shaft_speeds(const train::ToothSet& z) {
  const train::SpeedRatios w = train::speed_ratios(z);
  return {w.sun, w.planet - w.carrier, w.carrier, 1.0};
}

/// Magnitudes, all planets together.
/// @tparam V  scalar of speed and temperature
template <class T, class G, class V>
std::array<T, kShaftCount> drag_torques(const train::TrainGeometry<G>& g,
                                        const ShaftLosses<T>& shafts, const V& output_speed_rad_s,
                                        const V& temperature_K) {
  using std::exp;
  const auto speed = shaft_speeds(g.teeth);
  std::array<T, kShaftCount> drag{};
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    drag[i] = drag_torque(shafts.drag[i], V(speed[i] * output_speed_rad_s));
  }
  if (!is_neutral(shafts.drag_temperature_1_K, 0.0)) {
    const T factor =
        exp(T(shafts.drag_temperature_1_K * (temperature_K - shafts.drag_reference_temperature_K)));
    for (T& torque : drag) torque = torque * factor;
  }
  drag[kPlanetShaft] = drag[kPlanetShaft] * static_cast<double>(g.planets);
  return drag;
}

/// Torque on all planets from their pins.
template <class T>
T pin_torque(const train::ToothSet& teeth, const T& drag_Nm, const T& bearing_Nm) {
  const double on_pin = shaft_speeds(teeth)[kPlanetShaft];
  return -sign_of(on_pin) * (drag_Nm + bearing_Nm);
}

/// The train under drag and load, without friction of flanks and bearings.
template <class T>
train::LoadedTrain<T> frictionless_train(const train::ToothSet& teeth,
                                         const std::array<T, kShaftCount>& drag_Nm,
                                         const EndLoad<T>& load) {
  const auto speed = shaft_speeds(teeth);
  const auto against = [&](ShaftId shaft) { return T(-sign_of(speed[shaft]) * drag_Nm[shaft]); };
  train::LoadedTrain<T> loaded{
      .teeth = teeth,
      .efficiency = {},
      .known = {.sun = against(kSunShaft),
                .planet = constant<T>(0.0),
                .pin = pin_torque(teeth, drag_Nm[kPlanetShaft], constant<T>(0.0)),
                .carrier = against(kCarrierShaft),
                .ring2 = against(kOutputShaft)},
      .given_end = load.end,
      .given_torque_Nm = load.torque_Nm};
  for (auto& pair : loaded.efficiency) pair.fill(constant<T>(1.0));
  return loaded;
}

/// Torque that R2's teeth carry where a mesh carries a given one and nothing is lost on the way:
/// that of S times |i|, of R1 times |i/(i − 1)|, i = w_S/w_R2, as the torques on S, R1 and R2 add
/// up to none and so do their powers.
/// @param torque_Nm  on the mesh's central gear, of all planets
/// @returns a magnitude [N m]
template <class T>
T ring2_torque_by(const train::ToothSet& teeth, std::size_t mesh, const T& torque_Nm) {
  if (mesh == train::kMeshP2R2) return magnitude(torque_Nm);
  const double ratio = train::speed_ratios(teeth).sun;
  const double share = mesh == train::kMeshSP1 ? ratio : ratio / (ratio - 1.0);
  return T(std::abs(share) * magnitude(torque_Nm));
}

/// Largest change of the torques over the largest torque; 0 without torque.
template <class T>
double relative_change(const MeshTorques<T>& from, const MeshTorques<T>& to) {
  double change = 0.0;
  double scale = 0.0;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    change = std::max(change, std::abs(value_of(to[k]) - value_of(from[k])));
    scale = std::max(scale, std::abs(value_of(to[k])));
  }
  return scale > 0.0 ? change / scale : 0.0;
}

/// The same, and of the torque at the output's shaft, which is no part of the meshes' where the sun
/// is the end that is given: they repeat before it does.
template <class T>
double relative_change(const MeshTorques<T>& from, const T& from_output_Nm,
                       const MeshTorques<T>& to, const T& to_output_Nm) {
  const double change = std::abs(value_of(to_output_Nm) - value_of(from_output_Nm));
  double scale = std::abs(value_of(to_output_Nm));
  for (const T& torque : to) scale = std::max(scale, std::abs(value_of(torque)));
  return std::max(relative_change(from, to), scale > 0.0 ? change / scale : 0.0);
}

// Torques that repeat to some roundings end the iteration.  Where bearing friction takes nearly all
// that moves a planet passes gain little, and beyond that none: the torques then grow without end.
inline constexpr double kRepeats = 4e-15;

}  // namespace gear3k::design
