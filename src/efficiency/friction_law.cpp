#include "efficiency/friction_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace gear3k::efficiency {

namespace {

using std::exp, std::log, std::pow;

/// Place of x between the points: those at `low` and `high` weighted by 1 − share and share.
template <class T>
struct Place {
  std::size_t low, high;
  T share;
};
template <class T>
Place<T> place_of(const std::vector<double>& points, const T& x) {
  const auto after = std::ranges::upper_bound(points, value_of(x));
  if (after == points.begin()) return {0, 0, constant<T>(0.0)};
  const auto high = static_cast<std::size_t>(after - points.begin());
  if (after == points.end()) return {high - 1, high - 1, constant<T>(0.0)};
  return {high - 1, high, (x - points[high - 1]) / (points[high] - points[high - 1])};
}

template <class T>
T table_friction(const FrictionTable& table, const MeshState<T>& state) {
  const Place<T> speed = place_of(table.sliding_speed_m_s, state.sliding_speed_m_s);
  const std::size_t columns = table.sliding_speed_m_s.size();
  const auto along_speed = [&](std::size_t row) {
    const double low = table.coefficient[row * columns + speed.low];
    const double high = table.coefficient[row * columns + speed.high];
    return T(low + speed.share * (high - low));
  };
  if (table.tooth_force_N.empty()) return along_speed(0);
  const Place<T> force = place_of(table.tooth_force_N, state.normal_force_N);
  const T low = along_speed(force.low);
  return low + force.share * (along_speed(force.high) - low);
}

template <class T>
std::optional<T> load_power_friction(const Friction<T>& f, const MeshState<T>& state) {
  if (value_of(state.normal_force_N) <= 0.0) {
    if (value_of(f.load_exponent) < 0.0) return std::nullopt;
    return value_of(f.load_exponent) == 0.0 ? f.coefficient : constant<T>(0.0);
  }
  return T(f.coefficient * exp(f.load_exponent * log(state.normal_force_N / f.reference_force_N)));
}

template <class T>
T stribeck_friction(const Friction<T>& f, const MeshState<T>& state) {
  const T& v = state.sliding_speed_m_s;
  if (value_of(v) <= 0.0) return f.static_coefficient;
  const T decay = exp(-exp(f.stribeck_exponent * log(v / f.stribeck_speed_m_s)));
  return f.coefficient + (f.static_coefficient - f.coefficient) * decay + f.viscous_s_m * v;
}

template <class T>
std::optional<T> schlenk_friction(const FrictionAtTemperature<T>& at, const MeshState<T>& state) {
  if (!(value_of(state.sum_speed_m_s) > 0.0)) return std::nullopt;
  if (!(value_of(state.normal_force_N) > 0.0)) return constant<T>(0.0);
  constexpr double kMilli = 1e3;
  const T force_N_mm = state.normal_force_N / (state.face_width_m * kMilli);
  const T radius_mm = state.reduced_radius_m * kMilli;
  return T(0.048 * pow(T(force_N_mm / (state.sum_speed_m_s * radius_mm)), 0.2) *
           at.viscosity_factor * at.roughness_factor * at.friction->lubricant_factor);
}

template <class T>
std::optional<T> friction_by_law(const FrictionAtTemperature<T>& at, const MeshState<T>& state) {
  const Friction<T>& f = *at.friction;
  switch (f.law) {
    case FrictionLaw::kConstant:
      break;
    case FrictionLaw::kLoadPower:
      return load_power_friction(f, state);
    case FrictionLaw::kStribeck:
      return stribeck_friction(f, state);
    case FrictionLaw::kSchlenk:
      return schlenk_friction(at, state);
    case FrictionLaw::kTable:
      return table_friction(f.table, state);
  }
  return f.coefficient;
}

}  // namespace

template <class T>
T dynamic_viscosity(const Lubricant<T>& oil, const T& temperature_K) {
  const auto require = [](bool holds, const char* name, double value) {
    if (holds) return;
    throw std::invalid_argument(fmt::format(
        "dynamic_viscosity: {} = {}, allowed: above 0, two different temperatures", name, value));
  };
  for (const std::size_t i : {0U, 1U}) {
    require(value_of(oil.temperature_K[i]) > 0.0, "temperature", value_of(oil.temperature_K[i]));
    // Below 0.2 mm²/s lg (ν + 0.8) is negative: the form has no value.
    require(value_of(oil.viscosity_m2_s[i]) > 0.2e-6, "viscosity", value_of(oil.viscosity_m2_s[i]));
  }
  require(value_of(temperature_K) > 0.0, "temperature", value_of(temperature_K));
  require(value_of(oil.temperature_K[0]) != value_of(oil.temperature_K[1]), "temperature",
          value_of(oil.temperature_K[1]));
  constexpr double kMillimetre2 = 1e6;
  constexpr double kWalther = 0.8;
  // The base of the logarithms drops out of the inner one's differences; lg is kept for the form.
  const double ln10 = std::log(10.0);
  const auto lg_lg = [&](const T& viscosity_m2_s) {
    return T(log(T(log(T(viscosity_m2_s * kMillimetre2 + kWalther)) / ln10)) / ln10);
  };
  const T w0 = lg_lg(oil.viscosity_m2_s[0]);
  const T w1 = lg_lg(oil.viscosity_m2_s[1]);
  const T share = log(T(temperature_K / oil.temperature_K[0])) /
                  log(T(oil.temperature_K[1] / oil.temperature_K[0]));
  const T w = w0 + share * (w1 - w0);
  const T viscosity_mm2_s = exp(T(ln10 * exp(T(ln10 * w)))) - kWalther;
  return oil.density_kgm3 * viscosity_mm2_s / kMillimetre2;
}

template <class T>
T curve_at(const FrictionBend<T>& bend, const T& x) {
  const int last = bend.places - 1;
  const bool even = bend.x[0] == 0.0 && bend.x[1] == 0.0;
  const auto value = [&](int place) -> const T& { return bend.s[static_cast<std::size_t>(place)]; };
  const auto at = [&](int place) {
    return even ? 2.0 * place / last - 1.0 : bend.x[static_cast<std::size_t>(place)];
  };
  const auto chord = [&](int place) {
    return T((value(place + 1) - value(place)) / (at(place + 1) - at(place)));
  };
  const auto slope = [&](int place) {
    if (place == 0) return chord(0);
    if (place == last) return chord(last - 1);
    const T left = chord(place - 1);
    const T right = chord(place);
    const double before = at(place) - at(place - 1);
    const double after = at(place + 1) - at(place);
    if (even) return T((after * left + before * right) / (before + after));
    if (!(value_of(left) * value_of(right) > 0.0)) return constant<T>(0.0);
    return T(3.0 * (before + after) * left * right /
             ((2.0 * before + after) * left + (before + 2.0 * after) * right));
  };
  constexpr double kFarthest = 1.5;
  const T u = smaller(larger(x, constant<T>(-kFarthest)), constant<T>(kFarthest));
  if (value_of(u) <= at(0)) return T(value(0) + (u - at(0)) * slope(0));
  if (value_of(u) >= at(last)) return T(value(last) + (u - at(last)) * slope(last));
  int left = 0;
  while (value_of(u) >= at(left + 1)) ++left;
  const double width = at(left + 1) - at(left);
  const T t = (u - at(left)) / width;
  const T rise = value(left + 1) - value(left);
  const T first = slope(left) * width;
  const T second = slope(left + 1) * width;
  return T(value(left) + t * (first + t * (3.0 * rise - 2.0 * first - second +
                                           t * (first + second - 2.0 * rise))));
}

template <class T>
FrictionAtTemperature<T> friction_at(const Friction<T>& friction, const T& temperature_K) {
  return friction_at(friction, bent_by(friction.extension), temperature_K);
}
template <class T>
FrictionAtTemperature<T> friction_at(const Friction<T>& friction, const BentBy& bent,
                                     const T& temperature_K) {
  FrictionAtTemperature<T> at{.friction = &friction,
                              .bent = bent,
                              .viscosity_factor = constant<T>(1.0),
                              .roughness_factor = constant<T>(1.0)};
  if (friction.law == FrictionLaw::kSchlenk) {
    constexpr double kMilli = 1e3;
    const T viscosity_mPas = dynamic_viscosity(friction.lubricant, temperature_K) * kMilli;
    const T roughness_um = friction.roughness_m * 1e6;
    at.viscosity_factor = pow(viscosity_mPas, -0.05);
    at.roughness_factor = pow(roughness_um, 0.25);
  }
  return at;
}

namespace {

template <class T>
std::optional<T> uncut_friction(const FrictionAtTemperature<T>& at, const MeshState<T>& state) {
  std::optional<T> mu = friction_by_law(at, state);
  if (!mu) return mu;
  const FrictionExtension<T>& e = at.friction->extension;
  const T& torque = e.share_is_of_force ? state.own_torque_Nm : state.ring2_torque_Nm;
  const T& load = e.load_is_torque ? torque : state.normal_force_N;
  const T factor = friction_factor(e, at.bent, load, state.sliding_speed_m_s, state.temperature_K,
                                   state.forward);
  mu = T(*mu * factor);
  return mu;
}

}  // namespace

template <class T>
std::optional<T> friction_coefficient(const FrictionAtTemperature<T>& at,
                                      const MeshState<T>& state) {
  std::optional<T> mu = uncut_friction(at, state);
  if (mu) mu = smaller(*mu, constant<T>(kGreatestFriction));
  return mu;
}

template <class T>
std::optional<T> friction_coefficient(const Friction<T>& friction, const MeshState<T>& state) {
  return friction_coefficient(friction_at(friction, state.temperature_K), state);
}

template <class T>
std::optional<T> uncut_friction_coefficient(const Friction<T>& friction,
                                            const MeshState<T>& state) {
  return uncut_friction(friction_at(friction, state.temperature_K), state);
}

#define INSTANTIATE(T)                                                                           \
  template T curve_at<T>(const FrictionBend<T>&, const T&);                                      \
  template T dynamic_viscosity<T>(const Lubricant<T>&, const T&);                                \
  template FrictionAtTemperature<T> friction_at<T>(const Friction<T>&, const T&);                \
  template FrictionAtTemperature<T> friction_at<T>(const Friction<T>&, const BentBy&, const T&); \
  template std::optional<T> friction_coefficient<T>(const FrictionAtTemperature<T>&,             \
                                                    const MeshState<T>&);                        \
  template std::optional<T> friction_coefficient<T>(const Friction<T>&, const MeshState<T>&);    \
  template std::optional<T> uncut_friction_coefficient<T>(const Friction<T>&, const MeshState<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
INSTANTIATE(JetTorque)
#undef INSTANTIATE

}  // namespace gear3k::efficiency
