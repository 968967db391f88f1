#include "strength/plastic_gear.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "units/units.hpp"

namespace gear3k::strength {

using geometry::GearGeometry;

namespace {

void require_positive(std::string_view name, double value) {
  if (!(value > 0.0)) {
    throw std::invalid_argument(
        fmt::format("plastic gear: {} = {}, allowed: above 0", name, value));
  }
}
void require_not_negative(std::string_view name, double value) {
  if (!(value >= 0.0)) {
    throw std::invalid_argument(
        fmt::format("plastic gear: {} = {}, allowed: 0 or more", name, value));
  }
}

}  // namespace

HeatTransfer heat_transfer(PlasticMate mate) {
  return mate == PlasticMate::kSteel ? HeatTransfer{.flank = 6300.0, .root = 895.0}
                                     : HeatTransfer{.flank = 9000.0, .root = 2148.0};
}

template <class T>
T tooth_temperature(const ToothHeat<T>& heat, double transfer_coefficient) {
  using std::exp, std::log;
  require_positive("face width [m]", value_of(heat.face_width_m));
  require_positive("module [m]", value_of(heat.module_m));
  require_positive("teeth", heat.pinion_teeth);
  require_positive("housing surface [m2]", heat.housing_surface_m2);
  require_not_negative("loss [W]", value_of(heat.loss_W));
  require_not_negative("speed [m/s]", value_of(heat.speed_m_s));
  require_not_negative("heat transfer coefficient", transfer_coefficient);
  require_not_negative("housing resistance [K m2/W]", heat.housing_resistance);
  require_not_negative("duty", heat.duty);
  const T& through_housing_W = heat.housing_loss_W ? *heat.housing_loss_W : heat.loss_W;
  require_not_negative("loss through the housing [W]", value_of(through_housing_W));
  T rise_K = through_housing_W * (heat.housing_resistance / heat.housing_surface_m2);
  if (transfer_coefficient > 0.0 && value_of(heat.speed_m_s) > 0.0) {
    const T b = heat.face_width_m / units::kMillimetre;
    const T m = heat.module_m / units::kMillimetre;
    rise_K =
        rise_K + heat.loss_W * (transfer_coefficient / (b * static_cast<double>(heat.pinion_teeth) *
                                                        exp(0.75 * log(heat.speed_m_s * m))));
  }
  return heat.ambient_K + rise_K * std::pow(heat.duty, 0.64);
}

template <class T>
PlasticRootStress<T> plastic_root_stress(const GearGeometry<T>& gear, const RootSection<T>& section,
                                         const T& contact_ratio, const ToothLoad<T>& load,
                                         const T& load_factor) {
  const T one = constant<T>(1.0);
  PlasticRootStress<T> result{
      .form = root_form(gear, section, load_point(gear, geometry::tip_curvature_radius(gear))),
      .contact_ratio_factor = 0.25 + 0.75 / larger(contact_ratio, constant<T>(1.0))};
  const RootStress<T> at_tip = root_stress(gear, result.form, one, load, LoadFactorSet<T>{});
  result.stress_Pa = load_factor * at_tip.nominal_Pa * result.contact_ratio_factor;
  return result;
}

template <class T>
T linear_wear(const FlankWear<T>& wear) {
  require_positive("face width [m]", value_of(wear.face_width_m));
  require_positive("teeth", wear.teeth);
  require_positive("flank length [m]", value_of(wear.flank_length_m));
  return 2.0 * std::numbers::pi * wear.torque_Nm * wear.revolutions * wear.loss_factor *
         wear.wear_coefficient_m2_N /
         (wear.face_width_m * static_cast<double>(wear.teeth) * wear.flank_length_m);
}

template <class T>
T active_flank_length(const GearGeometry<T>& gear, const T& active_root_length_m) {
  const T tip = geometry::tip_curvature_radius(gear);
  const T length =
      (tip * tip - active_root_length_m * active_root_length_m) / (2.0 * gear.base_radius_m);
  return magnitude(length);
}

template <class T>
T tooth_deformation(const ToothLoad<T>& load, double youngs_modulus1_Pa,
                    double youngs_modulus2_Pa) {
  require_positive("face width [m]", value_of(load.face_width_m));
  require_positive("modulus of elasticity [Pa]", youngs_modulus1_Pa);
  require_positive("modulus of elasticity [Pa]", youngs_modulus2_Pa);
  return 7.5 * load.tangential_N / load.face_width_m *
         (1.0 / youngs_modulus1_Pa + 1.0 / youngs_modulus2_Pa);
}

#define INSTANTIATE(T)                                                                         \
  template T tooth_temperature<T>(const ToothHeat<T>&, double);                                \
  template PlasticRootStress<T> plastic_root_stress<T>(                                        \
      const GearGeometry<T>&, const RootSection<T>&, const T&, const ToothLoad<T>&, const T&); \
  template T linear_wear<T>(const FlankWear<T>&);                                              \
  template T active_flank_length<T>(const GearGeometry<T>&, const T&);                         \
  template T tooth_deformation<T>(const ToothLoad<T>&, double, double);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
