#pragma once
// Extensions between the scalar of a fit and plain numbers.

#include <type_traits>

#include "design/extension.hpp"

namespace gear3k::design {

/// A scalar as another one: from or to `double`; derivatives are dropped, or none.
template <class To, class From>
To scalar_as(const From& x) {
  if constexpr (std::is_same_v<To, From>) {
    return x;
  } else {
    return constant<To>(value_of(x));
  }
}

template <class To, class From>
efficiency::FrictionExtension<To> extension_as(const efficiency::FrictionExtension<From>& e) {
  const auto as = [](const From& x) { return scalar_as<To>(x); };
  return {.level = as(e.level),
          .load_exponent = as(e.load_exponent),
          .reference_force_N = e.reference_force_N,
          .slow_excess = as(e.slow_excess),
          .slow_speed_m_s = as(e.slow_speed_m_s),
          .speed_exponent = as(e.speed_exponent),
          .reference_speed_m_s = e.reference_speed_m_s,
          .temperature_1_K = as(e.temperature_1_K),
          .reference_temperature_K = e.reference_temperature_K,
          .forward = as(e.forward),
          .backward = as(e.backward),
          .approach = as(e.approach),
          .recess = as(e.recess)};
}

template <class To, class From>
backlash::LostMotionExtension<To> extension_as(const backlash::LostMotionExtension<From>& e) {
  return {.clearance_rad = scalar_as<To>(e.clearance_rad),
          .compliance_rad_Nm = scalar_as<To>(e.compliance_rad_Nm),
          .expansion_1_K = scalar_as<To>(e.expansion_1_K),
          .reference_temperature_K = e.reference_temperature_K};
}

template <class To, class From>
Extension<To> extension_as(const Extension<From>& e) {
  Extension<To> result{.friction = extension_as<To>(e.friction),
                       .drag = {},
                       .drag_temperature_1_K = scalar_as<To>(e.drag_temperature_1_K),
                       .drag_reference_temperature_K = e.drag_reference_temperature_K,
                       .planet_bearing_arm_m = scalar_as<To>(e.planet_bearing_arm_m),
                       .output_bearing_share = scalar_as<To>(e.output_bearing_share),
                       .lost_motion = extension_as<To>(e.lost_motion)};
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    result.drag[i] = {.constant_Nm = scalar_as<To>(e.drag[i].constant_Nm),
                      .viscous_Nms = scalar_as<To>(e.drag[i].viscous_Nms),
                      .quadratic_Nms2 = scalar_as<To>(e.drag[i].quadratic_Nms2)};
  }
  return result;
}

}  // namespace gear3k::design
