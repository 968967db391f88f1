#include "design/sun_torque.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "design/scalar_as.hpp"
#include "design/train_motion.hpp"
#include "efficiency/mesh_loss_slopes.hpp"

namespace gear3k::design {

namespace {

using train::kMeshCount;

template <class T>
T efficiency_of(const efficiency::MeshContact<double>& contact,
                const efficiency::FlankFriction<T>& mu, efficiency::LossModel model) {
  constexpr bool kValue = std::is_floating_point_v<T>;
  const bool alike = is_neutral(mu.approach_factor, 1.0) && is_neutral(mu.recess_factor, 1.0);
  const efficiency::LossSlopes wanted = kValue  ? efficiency::LossSlopes::kNone
                                        : alike ? efficiency::LossSlopes::kByCoefficient
                                                : efficiency::LossSlopes::kByAll;
  const efficiency::MeshEfficiencySlopes eta =
      mesh_efficiency_slopes(contact,
                             {.coefficient = value_of(mu.coefficient),
                              .approach_factor = value_of(mu.approach_factor),
                              .recess_factor = value_of(mu.recess_factor)},
                             model, wanted);
  if constexpr (kValue) {
    return eta.efficiency;
  } else {
    return T(eta.efficiency, eta.by_coefficient * mu.coefficient.v +
                                 eta.by_approach_factor * mu.approach_factor.v +
                                 eta.by_recess_factor * mu.recess_factor.v);
  }
}

/// Members that may drive, of each mesh.
using Drivers = std::array<std::array<bool, 2>, kMeshCount>;
constexpr Drivers kAnyDriver{{{true, true}, {true, true}, {true, true}}};
Drivers only(const std::array<bool, kMeshCount>& gear1_drives) {
  Drivers drivers{};
  for (std::size_t k = 0; k < kMeshCount; ++k) drivers[k][gear1_drives[k] ? 0 : 1] = true;
  return drivers;
}

/// Where a train runs, without what it loses.
struct Running {
  const FixedTrain& train;
  std::array<MeshKinematics<double>, kMeshCount> mesh{};
  double output_speed_rad_s = 0.0;
  double temperature_K = 0.0;
  bool forward = true;
  double output_torque_Nm = 0.0;  ///< on R2, along the rotation at w_R2 = 1
};

/// F: the train in balance with the friction that given mesh torques make.
template <class T>
std::optional<train::PowerFlow<T>> balance_at(const Running& r,
                                              const efficiency::FrictionAtTemperature<T>& friction,
                                              const ShaftLosses<T>& shafts,
                                              const MeshTorques<T>& torque_Nm,
                                              const Drivers& drivers) {
  const train::TrainGeometry<double>& g = r.train.geometry;
  const auto drag =
      drag_torques<T>(g, shafts, constant<T>(r.output_speed_rad_s), constant<T>(r.temperature_K));
  train::LoadedTrain<T> loaded = frictionless_train<T>(
      g.teeth, drag, {.end = train::End::kOutput, .torque_Nm = constant<T>(r.output_torque_Nm)});
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const MeshKinematics<double>& mesh = r.mesh[k];
    const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[k][0]));
    const auto mu = efficiency::friction_coefficient<T>(
        friction,
        {.normal_force_N = magnitude(torque_Nm[k]) / (g.planets * mesh.central_base_radius_m),
         .sliding_speed_m_s = constant<T>(mesh.sliding_speed_m_s),
         .sum_speed_m_s = constant<T>(mesh.sum_speed_m_s),
         .reduced_radius_m = constant<T>(mesh.reduced_radius_m),
         .face_width_m = constant<T>(r.train.face_width_m[stage]),
         .temperature_K = constant<T>(r.temperature_K),
         .forward = r.forward,
         .ring2_torque_Nm = magnitude(torque_Nm[train::kMeshP2R2]),
         .own_torque_Nm = ring2_torque_by(g.teeth, k, torque_Nm[k])});
    if (!mu) return std::nullopt;
    const efficiency::Friction<T>& law = *friction.friction;
    for (const std::size_t driver : {0U, 1U}) {
      const auto flank =
          efficiency::flank_friction(law, friction_of_mesh(law.extension, *mu, k, driver));
      loaded.efficiency[k][driver] = drivers[k][driver]
                                         ? efficiency_of<T>(mesh.contact[driver], flank, law.model)
                                         : constant<T>(0.0);
    }
  }
  const T arm = shafts.planet_bearing_coefficient * shafts.planet_bearing_radius_m;
  const T bearing = static_cast<double>(g.planets) * arm * planet_force<T>(g, r.mesh, torque_Nm);
  loaded.known.pin = pin_torque<T>(g.teeth, drag[kPlanetShaft], bearing);
  loaded.known.ring2 = -drag[kOutputShaft] -
                       output_bearing_torque(shafts, constant<T>(std::abs(r.output_torque_Nm)));
  return train::solve_power_flow(loaded);
}

template <class T>
MeshTorques<T> torques_as(const MeshTorques<double>& from) {
  MeshTorques<T> result;
  std::ranges::transform(from, result.begin(), [](double x) { return constant<T>(x); });
  return result;
}

/// Mesh torques that make the friction which makes them.
std::optional<train::PowerFlow<double>> settled(const Running& r,
                                                const efficiency::Friction<double>& friction_law,
                                                const ShaftLosses<double>& shafts) {
  const auto friction = efficiency::friction_at(friction_law, r.temperature_K);
  const train::ToothSet& teeth = r.train.geometry.teeth;
  auto flow = train::solve_power_flow(frictionless_train<double>(
      teeth, drag_torques<double>(r.train.geometry, shafts, r.output_speed_rad_s, r.temperature_K),
      {.end = train::End::kOutput, .torque_Nm = r.output_torque_Nm}));
  constexpr int kFewPasses = 50;
  for (int pass = 0; flow && pass < kFewPasses; ++pass) {
    auto next =
        balance_at<double>(r, friction, shafts, flow->mesh_torque_Nm, only(flow->gear1_drives));
    if (!next) return std::nullopt;
    if (relative_change(flow->mesh_torque_Nm, next->mesh_torque_Nm) <= kRepeats) {
      // The drivers were taken over from pass to pass: a search among all must find the same.
      const auto free = balance_at<double>(r, friction, shafts, next->mesh_torque_Nm, kAnyDriver);
      if (!free || free->gear1_drives != next->gear1_drives) return std::nullopt;
      return next;
    }
    flow = next;
  }
  return std::nullopt;
}

}  // namespace

SunTorque::SunTorque(const FixedTrain& train, VariedLosses losses)
    : train_(train),
      losses_(std::move(losses)),
      numbers_{.friction = friction_as<double>(losses_.friction),
               .shafts = shafts_as<double>(losses_.shafts)},
      by_torque_{.friction = friction_as<Jet3>(numbers_.friction),
                 .shafts = shafts_as<Jet3>(numbers_.shafts)},
      meshes_(mesh_constants(train.geometry)),
      sun_speed_(train::speed_ratios(train.geometry.teeth).sun),
      meshes_run_(std::ranges::all_of(train.geometry.meshes,
                                      [](const auto& mesh) { return mesh.contact_ratio > 0.0; })) {}

std::optional<Jet1> SunTorque::at(const OperatingPoint<double>& point, Direction direction) const {
  const auto is_magnitude = [](double x) { return x >= 0.0 && std::isfinite(x); };
  if (!is_magnitude(point.sun_speed_rad_s) || !is_magnitude(point.output_torque_Nm)) {
    return std::nullopt;
  }
  if (!meshes_run_) return std::nullopt;
  const double output_speed = point.sun_speed_rad_s / std::abs(sun_speed_);
  const bool forward = direction == Direction::kForward;
  const Running running{
      .train = train_,
      .mesh = kinematics(meshes_, output_speed),
      .output_speed_rad_s = output_speed,
      .temperature_K = point.temperature_K,
      .forward = forward,
      .output_torque_Nm = forward ? -point.output_torque_Nm : point.output_torque_Nm};
  const auto flow = settled(running, numbers_.friction, numbers_.shafts);
  if (!flow) return std::nullopt;
  const Drivers drivers = only(flow->gear1_drives);

  const auto by_losses = balance_at<Jet1>(
      running, efficiency::friction_at(losses_.friction, Jet1(point.temperature_K)), losses_.shafts,
      torques_as<Jet1>(flow->mesh_torque_Nm), drivers);
  MeshTorques<Jet3> torque;
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    torque[k] = Jet3(flow->mesh_torque_Nm[k], static_cast<int>(k));
  }
  const auto by_torques = balance_at<Jet3>(
      running, efficiency::friction_at(by_torque_.friction, Jet3(point.temperature_K)),
      by_torque_.shafts, torque, drivers);
  if (!by_losses || !by_torques) return std::nullopt;
  Eigen::Matrix3d from_torques;                           // ∂F/∂τ
  Eigen::Matrix<double, 3, Jet1::DIMENSION> from_losses;  // ∂F/∂p
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto mesh = static_cast<std::size_t>(k);
    from_torques.row(k) = by_torques->mesh_torque_Nm[mesh].v.transpose();
    from_losses.row(k) = by_losses->mesh_torque_Nm[mesh].v.transpose();
  }
  const Eigen::Matrix3d left = Eigen::Matrix3d::Identity() - from_torques;
  const Eigen::Matrix<double, 3, Jet1::DIMENSION> slopes = left.inverse() * from_losses;
  Jet1 sun(flow->sun_torque_Nm);
  sun.v = by_losses->sun_torque_Nm.v + slopes.transpose() * by_torques->sun_torque_Nm.v;
  if (!sun.v.allFinite()) return std::nullopt;
  return Jet1((forward ? 1.0 : -1.0) * sign_of(sun_speed_) * sun);
}

}  // namespace gear3k::design
