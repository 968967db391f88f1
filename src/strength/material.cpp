#include "strength/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "units/units.hpp"

namespace gear3k::strength {

namespace {

constexpr double kPascalPerMpa = 1e6;

template <class T>
T power(const T& base, double exponent) {
  using std::exp, std::log;
  return exp(exponent * log(base));
}

/// T in °C, no less than 0.
template <class T>
T celsius(const T& temperature_K) {
  return larger(T(temperature_K + units::kAbsoluteZero_c), constant<T>(0.0));
}

template <class T>
T pom_flank_mpa(const T& t, const T& n) {
  return 36.0 - 0.0012 * t * t + (1000.0 - 0.025 * t * t) * power(n, -0.21);
}
template <class T>
T pom_root_mpa(const T& t, const T& n) {
  return 26.0 - 0.0025 * t * t + 400.0 * power(n, -0.2);
}
template <class T>
T pa66_root_mpa(const T& t, const T& n) {
  const T root = value_of(t) > 0.0 ? power(t, 0.3) : constant<T>(0.0);
  return 30.0 - 0.22 * t + (4600.0 - 900.0 * root) * power(n, -1.0 / 3.0);
}

template <class T>
LimitValue<T> linear_limit(const Material& material, const StressLimit& limit,
                           const ToothCondition<T>& condition) {
  LimitValue<T> value{.stated = true};
  const bool one_value = material.hardness_min && material.hardness_min == material.hardness_max;
  const std::optional<double> hardness =
      condition.hardness || !one_value ? condition.hardness : material.hardness_min;
  if (hardness && !std::isfinite(*hardness)) {
    throw std::invalid_argument(
        fmt::format("material {}: hardness = {}, allowed: a number", material.name, *hardness));
  }
  if (limit.slope_Pa != 0.0 && !hardness) {
    throw std::invalid_argument(
        fmt::format("material {}: its limits depend on hardness, and none is given ({} to {} {})",
                    material.name, *material.hardness_min, *material.hardness_max,
                    kHardnessScaleNames[static_cast<std::size_t>(material.hardness_scale)]));
  }
  if (hardness && material.hardness_min) {
    value.hardness_in_range =
        *hardness >= *material.hardness_min && *hardness <= *material.hardness_max;
  }
  value.stress_Pa = constant<T>(limit.constant_Pa + limit.slope_Pa * hardness.value_or(0.0));
  return value;
}

template <class T>
LimitValue<T> limit_value(const Material& material, const StressLimit& limit,
                          const ToothCondition<T>& condition) {
  if (limit.law == LimitLaw::kNotStated) return {};
  if (limit.law == LimitLaw::kLinear) return linear_limit(material, limit, condition);
  const double temperature_K = value_of(condition.temperature_K);
  if (!std::isfinite(temperature_K)) {
    throw std::invalid_argument(fmt::format("material {}: temperature = {} K, allowed: a number",
                                            material.name, temperature_K));
  }
  if (!(value_of(condition.cycles) >= 1.0)) {
    throw std::invalid_argument(fmt::format("material {}: load cycles = {}, allowed: 1 or more",
                                            material.name, value_of(condition.cycles)));
  }
  LimitValue<T> value{.stated = true};
  value.temperature_in_range =
      temperature_K >= -units::kAbsoluteZero_c && temperature_K <= kHighestPlasticTemperature_K;
  const T t = celsius(condition.temperature_K);
  switch (limit.law) {
    case LimitLaw::kPomFlank:
      value.stress_Pa = kPascalPerMpa * pom_flank_mpa(t, condition.cycles);
      break;
    case LimitLaw::kPomRoot:
      value.stress_Pa = kPascalPerMpa * pom_root_mpa(t, condition.cycles);
      break;
    case LimitLaw::kPa66Root:
      value.stress_Pa = kPascalPerMpa * pa66_root_mpa(t, condition.cycles);
      break;
    case LimitLaw::kNotStated:
    case LimitLaw::kLinear:
      break;
  }
  return value;
}

}  // namespace

const Material* find_material(std::string_view name) {
  const std::span<const Material> table = material_table();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Material& material) { return material.name == name; });
  return found == table.end() ? nullptr : &*found;
}

bool has_life_curves(const Material& material) {
  const auto is_curve = [](const StressLimit& limit) {
    return limit.law != LimitLaw::kNotStated && limit.law != LimitLaw::kLinear;
  };
  return is_curve(material.flank_limit) || is_curve(material.root_limit);
}

template <class T>
LimitValue<T> flank_limit(const Material& material, const ToothCondition<T>& condition) {
  return limit_value(material, material.flank_limit, condition);
}

template <class T>
LimitValue<T> root_limit(const Material& material, const ToothCondition<T>& condition) {
  return limit_value(material, material.root_limit, condition);
}

#define INSTANTIATE(T)                                                              \
  template LimitValue<T> flank_limit<T>(const Material&, const ToothCondition<T>&); \
  template LimitValue<T> root_limit<T>(const Material&, const ToothCondition<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
