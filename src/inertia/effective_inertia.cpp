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
  const train::ToothSet& z = t.teeth;
  const train::SpeedRatios w = train::speed_ratios(z);  // speeds at w_R2 = 1
  const bool g2_below_one = train::g2(z) < 1.0;
  // Speeds of S, R1, R2 relative to the carrier: mesh power enters a gear as torque times these.
  const std::array<double, 3> relative{w.sun - w.carrier, -w.carrier, 1.0 - w.carrier};
  // Moment on the planet per torque on the central gear, without loss.
  const std::array<double, 3> lever{static_cast<double>(z.P1) / z.S,
                                    -static_cast<double>(z.P1) / z.R1,
                                    -static_cast<double>(z.P2) / z.R2};
  const T planet_moment = t.planets * w.planet * (t.bodies.planet1_kgm2 + t.bodies.planet2_kgm2);
  const T carried_moment = w.carrier * orbiting_inertia(t) + planet_moment;

  std::optional<T> result;
  for (unsigned pattern = 0; pattern < 8 && !result; ++pattern) {
    std::array<bool, 3> planet_drives{};
    std::array<T, 3> moment{};  // on the planet per torque on the central gear
    for (std::size_t k = 0; k < 3; ++k) {
      planet_drives[k] = (pattern >> k & 1U) != 0;
      // Gear 1 of mesh S-P1 is the sun; of the internal meshes, the planet.
      const bool gear1_drives = (k == train::kMeshSP1) != planet_drives[k];
      const bool as_forward =
          train::gear1_drives(static_cast<train::MeshId>(k), g2_below_one, true) == gear1_drives;
      const T& eta_k = as_forward ? eta.forward[k] : eta.backward[k];
      moment[k] = planet_drives[k] ? T(lever[k] / eta_k) : T(lever[k] * eta_k);
    }
    // Torques of the meshes on S, R1, R2: two balances and the one that inertia alone gives.
    //   moment . torque = planet_moment,  T_S + T_R1 + T_R2 = -carried_moment
    std::array<T, 3> torque{};
    const std::size_t known = forward ? 2 : 0;
    const std::size_t other = forward ? 0 : 2;
    torque[known] = forward ? t.bodies.ring2_kgm2 : T(w.sun * t.bodies.sun_kgm2);
    const T rest_moment = planet_moment - moment[known] * torque[known];
    const T rest_sum = -carried_moment - torque[known];
    torque[other] = (rest_moment - moment[1] * rest_sum) / (moment[other] - moment[1]);
    torque[1] = rest_sum - torque[other];
    bool consistent = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const double power_into_gear = value_of(torque[k]) * relative[k];
      if (power_into_gear != 0.0 && (power_into_gear > 0.0) != planet_drives[k]) consistent = false;
    }
    const T driving = forward ? T((w.sun * t.bodies.sun_kgm2 - torque[0]) / w.sun)
                              : T(t.bodies.ring2_kgm2 - torque[2]);
    if (consistent) result = driving;
  }
  return result;
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
  template T lossless_inertia<T>(const InertialTrain<T>&);                                 \
  template std::optional<T> effective_inertia<T>(const InertialTrain<T>&,                  \
                                                 const DirectionalEfficiencies<T>&, bool); \
  template T paper_inertia<T>(const InertialTrain<T>&, const efficiency::MeshEfficiencies<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)

}  // namespace gear3k::inertia
