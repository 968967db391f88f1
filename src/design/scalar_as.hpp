#pragma once
// Friction, losses and extensions between the scalar of a fit and plain numbers.

#include <type_traits>

#include "design/extension.hpp"
#include "design/operating_point.hpp"

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
efficiency::FrictionBend<To> bend_as(const efficiency::FrictionBend<From>& b) {
  efficiency::FrictionBend<To> result{.quadratic = scalar_as<To>(b.quadratic),
                                      .cubic = scalar_as<To>(b.cubic),
                                      .s = {},
                                      .places = b.places,
                                      .x = b.x,
                                      .half_range = b.half_range};
  for (std::size_t k = 0; k < b.s.size(); ++k) result.s[k] = scalar_as<To>(b.s[k]);
  return result;
}

template <class To, class From>
efficiency::FrictionExtension<To> extension_as(const efficiency::FrictionExtension<From>& e) {
  const auto as = [](const From& x) { return scalar_as<To>(x); };
  return {.level = as(e.level),
          .load_exponent = as(e.load_exponent),
          .reference_force_N = e.reference_force_N,
          .load_is_torque = e.load_is_torque,
          .share_is_of_force = e.share_is_of_force,
          .slow_excess = as(e.slow_excess),
          .slow_speed_m_s = as(e.slow_speed_m_s),
          .speed_exponent = as(e.speed_exponent),
          .reference_speed_m_s = e.reference_speed_m_s,
          .temperature_1_K = as(e.temperature_1_K),
          .reference_temperature_K = e.reference_temperature_K,
          .load_bend = bend_as<To>(e.load_bend),
          .speed_bend = bend_as<To>(e.speed_bend),
          .temperature_bend = bend_as<To>(e.temperature_bend),
          .forward = as(e.forward),
          .backward = as(e.backward),
          .approach = as(e.approach),
          .recess = as(e.recess),
          .inner_drives = as(e.inner_drives),
          .outer_drives = as(e.outer_drives),
          .ring_meshes = as(e.ring_meshes)};
}

template <class To, class From>
backlash::LostMotionExtension<To> extension_as(const backlash::LostMotionExtension<From>& e) {
  backlash::LostMotionExtension<To> result{.clearance_rad = scalar_as<To>(e.clearance_rad),
                                           .compliance_rad_Nm = scalar_as<To>(e.compliance_rad_Nm),
                                           .hardening = scalar_as<To>(e.hardening),
                                           .hardening_torque_Nm = e.hardening_torque_Nm,
                                           .preload_torque_Nm = scalar_as<To>(e.preload_torque_Nm),
                                           .soft = {},
                                           .expansion_1_K = scalar_as<To>(e.expansion_1_K),
                                           .reference_temperature_K = e.reference_temperature_K,
                                           .beyond_springs = e.beyond_springs};
  for (std::size_t k = 0; k < e.soft.size(); ++k) {
    result.soft[k] = {.windup_rad = scalar_as<To>(e.soft[k].windup_rad),
                      .torque_Nm = scalar_as<To>(e.soft[k].torque_Nm)};
  }
  return result;
}

template <class To, class From>
GrowingShare<To> growing_share_as(const GrowingShare<From>& s) {
  return {.share = scalar_as<To>(s.share),
          .exponent = scalar_as<To>(s.exponent),
          .reference_Nm = s.reference_Nm};
}

template <class To, class From>
Extension<To> extension_as(const Extension<From>& e) {
  Extension<To> result{.friction = extension_as<To>(e.friction),
                       .drag = {},
                       .drag_temperature_1_K = scalar_as<To>(e.drag_temperature_1_K),
                       .drag_reference_temperature_K = e.drag_reference_temperature_K,
                       .planet_bearing_arm_m = scalar_as<To>(e.planet_bearing_arm_m),
                       .output_bearing_share = scalar_as<To>(e.output_bearing_share),
                       .output_bearing_growth = growing_share_as<To>(e.output_bearing_growth),
                       .lost_motion = extension_as<To>(e.lost_motion)};
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    result.drag[i] = {.constant_Nm = scalar_as<To>(e.drag[i].constant_Nm),
                      .viscous_Nms = scalar_as<To>(e.drag[i].viscous_Nms),
                      .quadratic_Nms2 = scalar_as<To>(e.drag[i].quadratic_Nms2)};
  }
  return result;
}

template <class To, class From>
efficiency::Friction<To> friction_as(const efficiency::Friction<From>& f) {
  const auto as = [](const From& x) { return scalar_as<To>(x); };
  return {.coefficient = as(f.coefficient),
          .model = f.model,
          .approach_factor = as(f.approach_factor),
          .recess_factor = as(f.recess_factor),
          .law = f.law,
          .load_exponent = as(f.load_exponent),
          .reference_force_N = as(f.reference_force_N),
          .static_coefficient = as(f.static_coefficient),
          .stribeck_speed_m_s = as(f.stribeck_speed_m_s),
          .stribeck_exponent = as(f.stribeck_exponent),
          .viscous_s_m = as(f.viscous_s_m),
          .roughness_m = as(f.roughness_m),
          .lubricant_factor = as(f.lubricant_factor),
          .lubricant = {.temperature_K = {as(f.lubricant.temperature_K[0]),
                                          as(f.lubricant.temperature_K[1])},
                        .viscosity_m2_s = {as(f.lubricant.viscosity_m2_s[0]),
                                           as(f.lubricant.viscosity_m2_s[1])},
                        .density_kgm3 = as(f.lubricant.density_kgm3)},
          .table = f.table,
          .extension = extension_as<To>(f.extension)};
}

template <class To, class From>
ShaftLosses<To> shafts_as(const ShaftLosses<From>& s) {
  const auto as = [](const From& x) { return scalar_as<To>(x); };
  ShaftLosses<To> result{.drag = {},
                         .planet_bearing_coefficient = as(s.planet_bearing_coefficient),
                         .planet_bearing_radius_m = as(s.planet_bearing_radius_m),
                         .output_bearing_share = as(s.output_bearing_share),
                         .output_bearing_growth = growing_share_as<To>(s.output_bearing_growth),
                         .drag_temperature_1_K = as(s.drag_temperature_1_K),
                         .drag_reference_temperature_K = s.drag_reference_temperature_K};
  for (std::size_t i = 0; i < s.drag.size(); ++i) {
    result.drag[i] = {.constant_Nm = as(s.drag[i].constant_Nm),
                      .viscous_Nms = as(s.drag[i].viscous_Nms),
                      .quadratic_Nms2 = as(s.drag[i].quadratic_Nms2)};
  }
  return result;
}

}  // namespace gear3k::design
