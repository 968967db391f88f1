#include "strength/root_stress.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace gear3k::strength {

using geometry::GearGeometry;
using geometry::GearKind;

namespace {

/// +1 external, −1 ring.
double kind_sign(GearKind kind) { return kind == GearKind::kExternal ? 1.0 : -1.0; }

template <class T>
void check_tooth_load(const ToothLoad<T>& load) {
  if (!(value_of(load.face_width_m) > 0.0)) {
    throw std::invalid_argument(fmt::format("root stress: face width = {} m, allowed: above 0",
                                            value_of(load.face_width_m)));
  }
  if (!(value_of(load.tangential_N) >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "root stress: tangential force = {} N, allowed: 0 or more", value_of(load.tangential_N)));
  }
}

}  // namespace

template <class T>
LoadPoint<T> load_point(const GearGeometry<T>& gear, const T& length_m) {
  using std::atan2, std::cos, std::sqrt;
  const T& rb = gear.base_radius_m;
  const T radius = sqrt(rb * rb + length_m * length_m);
  const T half_tooth = geometry::tooth_thickness(gear, radius) / (2.0 * radius);
  const T angle = atan2(length_m, rb) - kind_sign(gear.gear.kind) * half_tooth;
  return {.length_m = length_m, .angle_rad = angle, .axis_height_m = rb / cos(angle)};
}

template <class T>
T outer_single_contact(const GearGeometry<T>& gear, const T& base_pitch_m, const T& contact_ratio) {
  T tip = geometry::tip_curvature_radius(gear);
  const double epsilon = value_of(contact_ratio);
  if (epsilon <= 1.0) return tip;
  const T beyond = epsilon < 2.0 ? T(contact_ratio - 1.0) : constant<T>(1.0);
  return tip - kind_sign(gear.gear.kind) * (base_pitch_m * beyond);
}

template <class T>
RootForm<T> root_form(const GearGeometry<T>& gear, const RootSection<T>& section,
                      const LoadPoint<T>& load) {
  using std::cos, std::exp, std::log;
  const T& m = gear.gear.module_m;
  const T& s_f = section.chord_m;
  RootForm<T> form{.section = section, .load = load};
  const T above = load.axis_height_m - section.height_m;
  form.bending_arm_m = magnitude(above);
  form.form_factor =
      6.0 * (form.bending_arm_m * m) * cos(load.angle_rad) / (s_f * s_f * gear.angle.cos);
  form.arm_ratio = s_f / form.bending_arm_m;
  form.notch_parameter = s_f / (2.0 * section.fillet_radius_m);
  const T exponent = 1.0 / (1.21 + 2.3 / form.arm_ratio);
  form.stress_correction_factor =
      (1.2 + 0.13 * form.arm_ratio) * exp(exponent * log(form.notch_parameter));
  const double q_s = value_of(form.notch_parameter);
  form.notch_in_range = q_s >= kLeastNotchParameter && q_s < kGreatestNotchParameter;
  return form;
}

template <class T>
Factor<T> rim_factor(const GearGeometry<T>& gear, const std::optional<T>& rim_m) {
  using std::log;
  if (!rim_m) return {.branch = "no rim stated", .source = sources::kNotStated};
  if (!(value_of(*rim_m) > 0.0)) {
    throw std::invalid_argument(
        fmt::format("rim factor: rim = {} m, allowed: above 0", value_of(*rim_m)));
  }
  const bool ring = gear.gear.kind == GearKind::kRing;
  const T height = kind_sign(gear.gear.kind) * (gear.tip_radius_m - gear.root_radius_m);
  const T ratio = ring ? T(*rim_m / gear.gear.module_m) : T(*rim_m / height);
  Factor<T> factor{.source = sources::kM56};
  if (value_of(ratio) >= (ring ? 3.5 : 1.2)) {
    factor.branch = "thick rim";
    return factor;
  }
  factor.value = ring ? T(1.15 * log(8.324 / ratio)) : T(1.6 * log(2.242 / ratio));
  // The ring's formula is 0.9964 at its end of 3.5, but a thinner rim is not stronger than a thick
  // one: the factor is 1 from where the formula crosses it, s_R/m = 8.324 e^(-1/1.15) = 3.489.
  if (value_of(factor.value) < 1.0) {
    return {.value = constant<T>(1.0), .branch = "thick rim", .source = sources::kM56};
  }
  factor.in_range = value_of(ratio) > (ring ? 1.75 : 0.5);
  factor.branch = factor.in_range ? "thin rim" : "rim too thin";
  return factor;
}

template <class T>
T least_rim(const GearGeometry<T>& gear) {
  if (gear.gear.kind == GearKind::kRing) return 1.75 * gear.gear.module_m;
  return 0.5 * (gear.tip_radius_m - gear.root_radius_m);
}

template <class T>
RootStress<T> root_stress(const GearGeometry<T>& gear, const RootForm<T>& form, const T& rim_factor,
                          const ToothLoad<T>& load, const LoadFactorSet<T>& factors) {
  check_tooth_load(load);
  const T nominal = load.tangential_N / (load.face_width_m * gear.gear.module_m) *
                    form.form_factor * form.stress_correction_factor * rim_factor;
  return {.nominal_Pa = nominal, .stress_Pa = nominal * factors.product()};
}

#define INSTANTIATE(T)                                                                        \
  template LoadPoint<T> load_point<T>(const GearGeometry<T>&, const T&);                      \
  template T outer_single_contact<T>(const GearGeometry<T>&, const T&, const T&);             \
  template RootForm<T> root_form<T>(const GearGeometry<T>&, const RootSection<T>&,            \
                                    const LoadPoint<T>&);                                     \
  template T least_rim<T>(const GearGeometry<T>&);                                            \
  template Factor<T> rim_factor<T>(const GearGeometry<T>&, const std::optional<T>&);          \
  template RootStress<T> root_stress<T>(const GearGeometry<T>&, const RootForm<T>&, const T&, \
                                        const ToothLoad<T>&, const LoadFactorSet<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
