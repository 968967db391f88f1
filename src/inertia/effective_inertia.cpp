#include "inertia/effective_inertia.hpp"

namespace gear3k::inertia {

namespace {

/// J_C + N m_P d².
template <class T>
T orbiting_inertia(const InertialTrain<T>& t) {
  const double n = t.planets;
  return t.bodies.carrier_kgm2 +
         n * t.bodies.planet_mass_kg * t.center_distance_m * t.center_distance_m;
}

}  // namespace

template <class T>
train::BodyTorques<T> inertia_torques(const InertialTrain<T>& t, double acceleration_rad_s2) {
  const train::SpeedRatios w = train::speed_ratios(t.teeth);
  const double a = acceleration_rad_s2;
  return {.sun = -(a * w.sun) * t.bodies.sun_kgm2,
          .planet = -(a * t.planets * w.planet) * (t.bodies.planet1_kgm2 + t.bodies.planet2_kgm2),
          .pin = constant<T>(0.0),
          .carrier = -(a * w.carrier) * orbiting_inertia(t),
          .ring2 = -a * t.bodies.ring2_kgm2};
}

template <class T>
T lossless_inertia(const InertialTrain<T>& t) {
  const train::SpeedRatios w = train::speed_ratios(t.teeth);
  const double n = t.planets;
  return w.sun * w.sun * t.bodies.sun_kgm2 +
         n * w.planet * w.planet * (t.bodies.planet1_kgm2 + t.bodies.planet2_kgm2) +
         w.carrier * w.carrier * orbiting_inertia(t) + t.bodies.ring2_kgm2;
}

template <class T>
std::optional<T> effective_inertia(const InertialTrain<T>& t, const DirectionalEfficiencies<T>& eta,
                                   bool forward) {
  const train::SpeedRatios w = train::speed_ratios(t.teeth);
  train::LoadedTrain<T> loaded{.teeth = t.teeth,
                               .efficiency = {},
                               .known = inertia_torques(t, 1.0),
                               .given_end = forward ? train::End::kOutput : train::End::kSun,
                               .given_torque_Nm = constant<T>(0.0)};
  const bool g2_below_one = train::g2(t.teeth) < 1.0;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const bool gear1_drives =
        train::gear1_drives(static_cast<train::MeshId>(k), g2_below_one, true);
    loaded.efficiency[k] = gear1_drives
                               ? train::DriverEfficiencies<T>{eta.forward[k], eta.backward[k]}
                               : train::DriverEfficiencies<T>{eta.backward[k], eta.forward[k]};
  }
  const auto flow = train::solve_power_flow(loaded);
  if (!flow) return std::nullopt;
  return forward ? T(flow->sun_torque_Nm / w.sun) : flow->output_torque_Nm;
}

template <class T>
T paper_inertia(const InertialTrain<T>& t, const efficiency::MeshEfficiencies<T>& eta) {
  const train::SpeedRatios w = train::speed_ratios(t.teeth);
  const double n = t.planets;
  const double rolling2 = n * w.planet_rolling * w.planet_rolling;
  return w.sun * w.sun * t.bodies.sun_kgm2 / (eta[0] * eta[1]) +
         rolling2 * t.bodies.planet1_kgm2 / eta[1] + rolling2 * t.bodies.planet2_kgm2 / eta[2] +
         t.bodies.ring2_kgm2 +
         w.carrier * w.carrier *
             (orbiting_inertia(t) + n * (t.bodies.planet1_kgm2 + t.bodies.planet2_kgm2));
}

#define INSTANTIATE(T)                                                                     \
  template train::BodyTorques<T> inertia_torques<T>(const InertialTrain<T>&, double);      \
  template T lossless_inertia<T>(const InertialTrain<T>&);                                 \
  template std::optional<T> effective_inertia<T>(const InertialTrain<T>&,                  \
                                                 const DirectionalEfficiencies<T>&, bool); \
  template T paper_inertia<T>(const InertialTrain<T>&, const efficiency::MeshEfficiencies<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::inertia
