#include "actuator/winding.hpp"

namespace gear3k::actuator {

namespace {

std::optional<double> capacity(const std::optional<double>& time_s,
                               const std::optional<double>& resistance_K_W) {
  if (!time_s || !resistance_K_W) return std::nullopt;
  return *time_s / *resistance_K_W;
}

}  // namespace

std::optional<WindingState> winding_state(const Motor& motor, const HeatSources& heat) {
  const MotorHeat& h = motor.heat;
  const bool one_node = h.winding_ambient_K_W.has_value();
  if (!one_node && !(h.winding_housing_K_W && h.housing_ambient_K_W)) return std::nullopt;
  // What copper loss and what friction has to pass.
  const double friction_K_W = one_node ? *h.winding_ambient_K_W : *h.housing_ambient_K_W;
  const double copper_K_W = one_node ? friction_K_W : *h.winding_housing_K_W + friction_K_W;
  WindingState state;
  state.winding_J_K =
      capacity(h.winding_time_constant_s, one_node ? h.winding_ambient_K_W : h.winding_housing_K_W);
  state.housing_J_K = capacity(h.housing_time_constant_s, h.housing_ambient_K_W);
  const double q = motor.resistance_ohm * heat.mean_square_current_A2;
  const double denominator = 1.0 - kCopperSlope_1_K * copper_K_W * q;
  if (!(denominator > 0.0)) {
    state.runaway = true;
    return state;
  }
  const double ambient_K = heat.ambient_K.value_or(h.ambient_K);
  const double at_ambient = q * (1.0 + kCopperSlope_1_K * (ambient_K - kResistanceTemperature_K));
  const double rise = (copper_K_W * at_ambient + friction_K_W * heat.friction_W) / denominator;
  state.winding_K = ambient_K + rise;
  if (one_node) return state;
  const double copper_W = at_ambient + kCopperSlope_1_K * q * rise;
  state.housing_K = ambient_K + friction_K_W * (copper_W + heat.friction_W);
  return state;
}

}  // namespace gear3k::actuator
