#include "strength/flank_strength.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "strength/life_factor.hpp"
#include "units/units.hpp"

namespace gear3k::strength {

namespace {

constexpr double kSoftLimit_mpa = 850.0, kHardLimit_mpa = 1200.0;
constexpr double kPaPerMpa = 1e6;
constexpr double kSquareMillimetre = units::kMillimetre * units::kMillimetre;

/// C_ZL and C_ZR.
template <class T>
struct FilmCoefficients {
  T lubricant{}, roughness{};
  std::string_view branch;
};
template <class T>
FilmCoefficients<T> film_coefficients(const T& softer_limit_Pa) {
  const T sigma = softer_limit_Pa / kPaPerMpa;
  if (value_of(sigma) < kSoftLimit_mpa) {
    return {constant<T>(0.83), constant<T>(0.15), "limit below 850 N/mm2"};
  }
  if (value_of(sigma) > kHardLimit_mpa) {
    return {constant<T>(0.91), constant<T>(0.08), "limit above 1200 N/mm2"};
  }
  return {sigma / 4375.0 + 0.6357, 0.32 - 0.0002 * sigma, "limit 850 to 1200 N/mm2"};
}

template <class T>
T raised(const T& base, double exponent) {
  using std::exp, std::log;
  return exp(exponent * log(base));
}

template <class T>
Factor<T> lubricant_factor(const FilmCoefficients<T>& film, double viscosity_m2_s) {
  const double rest = 1.2 + 134.0 / (viscosity_m2_s / kSquareMillimetre);
  return {.value = film.lubricant + 4.0 * (1.0 - film.lubricant) / (rest * rest),
          .branch = film.branch,
          .source = sources::kMekanika};
}

template <class T>
Factor<T> speed_factor(const FilmCoefficients<T>& film, const T& speed_m_s) {
  using std::sqrt;
  const T c = film.lubricant + 0.02;
  if (!(value_of(speed_m_s) > 0.0)) {
    return {.value = c, .branch = "at rest", .source = sources::kMekanika};
  }
  return {.value = c + 2.0 * (1.0 - c) / sqrt(0.8 + 32.0 / speed_m_s),
          .branch = film.branch,
          .source = sources::kMekanika};
}

template <class T>
Factor<T> roughness_factor(const FilmCoefficients<T>& film, const FlankCondition<T>& condition) {
  using std::exp, std::log;
  const double rz =
      0.5 * (*condition.own_roughness_m + *condition.mate_roughness_m) / units::kMicrometre;
  const T radius = condition.reduced_radius_m / units::kMillimetre;
  const T base = 3.0 / (rz * raised(T(10.0 / radius), 1.0 / 3.0));
  return {.value = exp(film.roughness * log(base)),
          .branch = film.branch,
          .source = sources::kMekanika};
}

template <class T>
Factor<T> work_hardening_factor(MaterialGroup group, const FlankCondition<T>& condition) {
  const bool soft = group == MaterialGroup::kNormalised || group == MaterialGroup::kThroughHardened;
  if (!soft || !is_surface_hardened(condition.mate_group)) {
    return {.branch = "not a soft gear with a hard mate", .source = sources::kM56};
  }
  if (!condition.brinell_hardness || !condition.own_roughness_m || !condition.mate_roughness_m ||
      !condition.viscosity40_m2_s) {
    return {.branch = "hardness, roughness or lubricant not stated", .source = sources::kNotStated};
  }
  const double hb = *condition.brinell_hardness;
  Factor<T> factor{.source = sources::kM56};
  factor.in_range = hb >= kLeastBrinell && hb <= kGreatestBrinell;
  const double hardness =
      1.2 - (std::clamp(hb, kLeastBrinell, kGreatestBrinell) - kLeastBrinell) / 1700.0;
  const double hard = *condition.mate_roughness_m / units::kMicrometre;
  const double soft_rz = *condition.own_roughness_m / units::kMicrometre;
  const double viscosity = *condition.viscosity40_m2_s / kSquareMillimetre;
  T equivalent = constant<T>(16.0);
  factor.branch = "roughness held at 16";
  if (value_of(condition.speed_m_s) > 0.0) {
    const T radius = condition.reduced_radius_m / units::kMillimetre;
    const T found = hard * std::pow(hard / soft_rz, 0.66) * raised(T(10.0 / radius), 0.33) /
                    raised(T(condition.speed_m_s * (viscosity / 1500.0)), 0.33);
    if (value_of(found) < 3.0) {
      equivalent = constant<T>(3.0);
      factor.branch = "roughness held at 3";
    } else if (value_of(found) <= 16.0) {
      equivalent = found;
      factor.branch = "roughness between 3 and 16";
    }
  }
  factor.value = hardness * raised(T(3.0 / equivalent), 0.15);
  return factor;
}

void check_positive(std::string_view name, double value) {
  if (!(value > 0.0)) {
    throw std::invalid_argument(
        fmt::format("flank strength: {} = {}, allowed: above 0", name, value));
  }
}

}  // namespace

template <class T>
FlankStrength<T> flank_strength(const Material& material, const T& limit_Pa,
                                const FlankCondition<T>& condition) {
  check_positive("limit [Pa]", value_of(limit_Pa));
  check_positive("softer limit [Pa]", value_of(condition.softer_limit_Pa));
  check_positive("reduced radius [m]", value_of(condition.reduced_radius_m));
  if (condition.own_roughness_m) check_positive("roughness [m]", *condition.own_roughness_m);
  if (condition.mate_roughness_m) check_positive("roughness [m]", *condition.mate_roughness_m);
  if (condition.viscosity40_m2_s) check_positive("viscosity [m2/s]", *condition.viscosity40_m2_s);
  if (!(value_of(condition.speed_m_s) >= 0.0)) {
    throw std::invalid_argument(fmt::format("flank strength: speed = {} m/s, allowed: 0 or more",
                                            value_of(condition.speed_m_s)));
  }
  const FilmCoefficients<T> film = film_coefficients(condition.softer_limit_Pa);
  FlankStrength<T> strength{
      .limit_Pa = limit_Pa,
      .life = flank_life_factor(material.life_curve, condition.pitting_allowed, condition.cycles),
      .lubricant = {.branch = "lubricant not stated", .source = sources::kNotStated},
      .speed = {.branch = "lubricant not stated", .source = sources::kNotStated},
      .roughness = {.branch = "roughness not stated", .source = sources::kNotStated},
      .work_hardening = work_hardening_factor(material.group, condition),
      .size = {.branch = "1", .source = sources::kM56}};
  if (condition.viscosity40_m2_s) {
    strength.lubricant = lubricant_factor(film, *condition.viscosity40_m2_s);
    strength.speed = speed_factor(film, condition.speed_m_s);
  }
  if (condition.own_roughness_m && condition.mate_roughness_m) {
    strength.roughness = roughness_factor(film, condition);
  }
  strength.strength_Pa = limit_Pa * strength.life.value * strength.lubricant.value *
                         strength.speed.value * strength.roughness.value *
                         strength.work_hardening.value * strength.size.value;
  return strength;
}

#define INSTANTIATE(T) \
  template FlankStrength<T> flank_strength<T>(const Material&, const T&, const FlankCondition<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
