#include "strength/mesh_forces.hpp"

#include <cmath>

namespace gear3k::strength {

template <class T>
std::array<T, train::kMeshCount> normal_forces_per_torque(const train::TrainGeometry<T>& train) {
  const double G1 = train::g1(train.teeth);
  const double G2 = train::g2(train.teeth);
  const double i = std::abs(train::ratio(train.teeth));
  return {1.0 / (i * train::central_base_radius(train, train::kMeshSP1)),
          ((G1 + G2) / (1.0 + G1)) / train::central_base_radius(train, train::kMeshP1R1),
          1.0 / train::central_base_radius(train, train::kMeshP2R2)};
}

template <class T>
MeshForces<T> lossless_mesh_forces(const train::TrainGeometry<T>& train,
                                   const T& output_torque_Nm) {
  using std::cos;
  const std::array<T, train::kMeshCount> a = normal_forces_per_torque(train);
  const double s1 = train::g2(train.teeth) < 1.0 ? 1.0 : -1.0;
  const std::array<double, train::kMeshCount> s{s1, 1.0, -1.0};
  MeshForces<T> forces;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const T force = output_torque_Nm * a[k] / static_cast<double>(train.planets);
    forces.normal_N[k] = magnitude(force);
    forces.tangential_N[k] = s[k] * force * cos(train.meshes[k].alpha_w_rad);
    forces.loss_Nm[k] = constant<T>(0.0);
  }
  return forces;
}

template <class T>
MeshForces<T> mesh_forces(const train::TrainGeometry<T>& train, const train::PowerFlow<T>& flow) {
  // Symbols as in docs/theory §24.
  const std::array<double, train::kMeshCount> w = train::central_rolling_speeds(train.teeth);
  const train::SpeedRatios speeds = train::speed_ratios(train.teeth);
  const double w_P = speeds.planet - speeds.carrier;
  const double n = train.planets;
  MeshForces<T> forces;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const T& T_k = flow.mesh_torque_Nm[k];
    const T M_k = -(flow.mesh_loss_Nm[k] + T_k * w[k]) / w_P;
    forces.normal_N[k] = magnitude(T_k) / (n * train::central_base_radius(train, k));
    forces.tangential_N[k] = -(T_k + M_k) / (n * train.center_distance_m);
    forces.loss_Nm[k] = magnitude(flow.mesh_loss_Nm[k]) / n;
  }
  return forces;
}

template <class T>
std::optional<MeshForces<T>> driven_mesh_forces(
    const train::TrainGeometry<T>& train,
    const std::array<train::DriverEfficiencies<T>, train::kMeshCount>& efficiency,
    const T& output_torque_Nm, bool forward) {
  const T zero = constant<T>(0.0);
  const auto flow = train::solve_power_flow(train::LoadedTrain<T>{
      .teeth = train.teeth,
      .efficiency = efficiency,
      .known = {.sun = zero, .planet = zero, .pin = zero, .carrier = zero, .ring2 = zero},
      .given_end = train::End::kOutput,
      .given_torque_Nm = forward ? T(-output_torque_Nm) : output_torque_Nm});
  if (!flow) return std::nullopt;
  return mesh_forces(train, *flow);
}

#define INSTANTIATE(T)                                                                      \
  template std::array<T, train::kMeshCount> normal_forces_per_torque<T>(                    \
      const train::TrainGeometry<T>&);                                                      \
  template MeshForces<T> lossless_mesh_forces<T>(const train::TrainGeometry<T>&, const T&); \
  template MeshForces<T> mesh_forces<T>(const train::TrainGeometry<T>&,                     \
                                        const train::PowerFlow<T>&);                        \
  template std::optional<MeshForces<T>> driven_mesh_forces<T>(                              \
      const train::TrainGeometry<T>&,                                                       \
      const std::array<train::DriverEfficiencies<T>, train::kMeshCount>&, const T&, bool);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
