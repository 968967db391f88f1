#include "train/power_flow.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/scalar.hpp"

namespace gear3k::train {

namespace {

using Pattern = std::array<bool, kMeshCount>;  ///< by mesh: gear 1 drives

/// The train in balance when the given members drive, whether or not the powers agree.
template <class T>
PowerFlow<T> balance(const LoadedTrain<T>& t, const Pattern& gear1_drives) {
  const std::array<double, kMeshCount> lever = planet_levers(t.teeth);
  std::array<T, kMeshCount> moment{};
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const T& eta = t.efficiency[k][gear1_drives[k] ? 0 : 1];
    const bool central_drives = gear1_drives[k] == central_is_gear1(k);
    moment[k] = central_drives ? T(lever[k] * eta) : T(lever[k] / eta);
  }
  const bool from_output = t.given_end == End::kOutput;
  const std::size_t known = from_output ? kMeshP2R2 : kMeshSP1;
  const std::size_t other = from_output ? kMeshSP1 : kMeshP2R2;
  PowerFlow<T> flow{};
  flow.gear1_drives = gear1_drives;
  auto& torque = flow.mesh_torque_Nm;
  torque[known] = -(t.given_torque_Nm + (from_output ? t.known.ring2 : t.known.sun));
  const T rest_moment = -t.known.planet - t.known.pin - moment[known] * torque[known];
  const T rest_sum = t.known.carrier + t.known.planet - torque[known];
  // Each by its own quotient: a difference would let rounding decide the sign of a small torque.
  const T difference = moment[other] - moment[kMeshP1R1];
  torque[other] = (rest_moment - moment[kMeshP1R1] * rest_sum) / difference;
  torque[kMeshP1R1] = (moment[other] * rest_sum - rest_moment) / difference;
  flow.sun_torque_Nm = from_output ? T(-torque[kMeshSP1] - t.known.sun) : t.given_torque_Nm;
  flow.output_torque_Nm = from_output ? t.given_torque_Nm : T(-torque[kMeshP2R2] - t.known.ring2);
  return flow;
}

/// The train without losses in its meshes, as numbers.
template <class T>
LoadedTrain<double> lossless(const LoadedTrain<T>& t) {
  LoadedTrain<double> result{.teeth = t.teeth,
                             .efficiency = {},
                             .known = {.sun = value_of(t.known.sun),
                                       .planet = value_of(t.known.planet),
                                       .pin = value_of(t.known.pin),
                                       .carrier = value_of(t.known.carrier),
                                       .ring2 = value_of(t.known.ring2)},
                             .given_end = t.given_end,
                             .given_torque_Nm = value_of(t.given_torque_Nm)};
  for (auto& mesh : result.efficiency) mesh.fill(1.0);
  return result;
}

/// Whether every mesh can run with its driver.
template <class T>
bool runs(const LoadedTrain<T>& t, const Pattern& gear1_drives) {
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    if (!(value_of(t.efficiency[k][gear1_drives[k] ? 0 : 1]) > 0.0)) return false;
  }
  return true;
}

template <class T>
bool finite(const PowerFlow<T>& flow) {
  return std::ranges::all_of(flow.mesh_torque_Nm,
                             [](const T& torque) { return std::isfinite(value_of(torque)); });
}

}  // namespace

std::array<double, kMeshCount> central_rolling_speeds(const ToothSet& z) {
  const SpeedRatios w = speed_ratios(z);
  return {w.sun - w.carrier, -w.carrier, 1.0 - w.carrier};
}

template <class T>
std::optional<PowerFlow<T>> solve_power_flow(const LoadedTrain<T>& train) {
  const std::array<double, kMeshCount> speed = central_rolling_speeds(train.teeth);
  const auto pattern_of = [&](const auto& flow, const Pattern& at_rest) {
    Pattern pattern = at_rest;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const double into_central = value_of(flow.mesh_torque_Nm[k]) * speed[k];
      if (into_central != 0.0) pattern[k] = (into_central < 0.0) == central_is_gear1(k);
    }
    return pattern;
  };
  const Pattern nominal = pattern_of(balance(lossless(train), Pattern{}), Pattern{});

  constexpr unsigned kPatterns = 1U << kMeshCount;
  for (unsigned flips = 0; flips < kPatterns; ++flips) {
    Pattern pattern = nominal;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      if ((flips >> k & 1U) != 0) pattern[k] = !pattern[k];
    }
    if (!runs(train, pattern)) continue;
    PowerFlow<T> flow = balance(train, pattern);
    if (!finite(flow) || pattern_of(flow, pattern) != pattern) continue;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const T into_central = flow.mesh_torque_Nm[k] * speed[k];
      const T& eta = train.efficiency[k][pattern[k] ? 0 : 1];
      const bool central_drives = pattern[k] == central_is_gear1(k);
      flow.mesh_loss_Nm[k] =
          central_drives ? T(-into_central * (1.0 - eta)) : T(into_central * (1.0 - eta) / eta);
    }
    return flow;
  }
  return std::nullopt;
}

#define INSTANTIATE(T) \
  template std::optional<PowerFlow<T>> solve_power_flow<T>(const LoadedTrain<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::train
