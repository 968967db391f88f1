#include "strength/root_strength.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "strength/life_factor.hpp"
#include "units/units.hpp"

namespace gear3k::strength {

namespace {

/// Slip layer thickness ρ' over yield strength.
struct SlipLayer {
  double yield_Pa, thickness_mm;
};
constexpr std::array<SlipLayer, 6> kSlipLayers{{{300e6, 0.0833},
                                                {400e6, 0.0445},
                                                {500e6, 0.0281},
                                                {600e6, 0.0194},
                                                {800e6, 0.0064},
                                                {1000e6, 0.0014}}};
constexpr double kHardenedSlipLayer_mm = 0.0030;
constexpr double kNitridedSlipLayer_mm = 0.1005;

struct FoundSlipLayer {
  double thickness_mm = 0.0;
  std::string_view branch;
  bool in_range = true;
};

FoundSlipLayer slip_layer_by_yield(double yield_Pa) {
  if (yield_Pa <= kSlipLayers.front().yield_Pa) {
    return {kSlipLayers.front().thickness_mm, "by yield strength",
            yield_Pa == kSlipLayers.front().yield_Pa};
  }
  for (std::size_t i = 1; i < kSlipLayers.size(); ++i) {
    const SlipLayer& a = kSlipLayers[i - 1];
    const SlipLayer& b = kSlipLayers[i];
    if (yield_Pa > b.yield_Pa) continue;
    const double share = (yield_Pa - a.yield_Pa) / (b.yield_Pa - a.yield_Pa);
    return {a.thickness_mm + share * (b.thickness_mm - a.thickness_mm), "by yield strength", true};
  }
  return {kSlipLayers.back().thickness_mm, "by yield strength", false};
}

/// Empty where nothing is known of it.
std::optional<FoundSlipLayer> slip_layer(const Material& material) {
  switch (material.group) {
    case MaterialGroup::kCaseHardened:
    case MaterialGroup::kInduction:
      return FoundSlipLayer{kHardenedSlipLayer_mm, "surface hardened"};
    case MaterialGroup::kNitriding:
    case MaterialGroup::kNitrided:
    case MaterialGroup::kNitrocarburised:
      return FoundSlipLayer{kNitridedSlipLayer_mm, "nitrided"};
    case MaterialGroup::kNormalised:
    case MaterialGroup::kThroughHardened:
    case MaterialGroup::kNodularIron:
      if (material.yield_strength_Pa) return slip_layer_by_yield(*material.yield_strength_Pa);
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

template <class T>
Factor<T> notch_sensitivity_factor(const Material& material, const T& notch_parameter) {
  using std::sqrt;
  const std::optional<FoundSlipLayer> layer = slip_layer(material);
  if (!layer) return {.branch = "slip layer not known", .source = sources::kNotStated};
  const double rho = layer->thickness_mm;
  return {.value = (1.0 + sqrt(0.2 * rho * (1.0 + 2.0 * notch_parameter))) /
                   (1.0 + std::sqrt(1.2 * rho)),
          .branch = layer->branch,
          .source = sources::kM56,
          .in_range = layer->in_range};
}

/// smooth below R_z = 1 µm, else constant − slope (R_z + 1)^exponent
struct SurfaceLaw {
  double constant, slope, exponent, smooth;
};
constexpr SurfaceLaw kHardenedSurface{1.674, 0.529, 0.1, 1.12};
constexpr SurfaceLaw kNormalisedSurface{5.306, 4.203, 0.01, 1.07};
constexpr SurfaceLaw kNitridedSurface{4.299, 3.259, 0.0058, 1.025};

template <class T>
Factor<T> surface_factor(MaterialGroup group, const std::optional<double>& roughness_m) {
  if (!roughness_m) return {.branch = "roughness not stated", .source = sources::kNotStated};
  if (!(*roughness_m >= 0.0)) {
    throw std::invalid_argument(
        fmt::format("root strength: roughness = {} m, allowed: 0 or more", *roughness_m));
  }
  if (is_plastic(group) || group == MaterialGroup::kBrass) {
    return {.branch = "no formula for this group", .source = sources::kNotStated};
  }
  const SurfaceLaw& law = is_nitrided(group)                    ? kNitridedSurface
                          : group == MaterialGroup::kNormalised ? kNormalisedSurface
                                                                : kHardenedSurface;
  const double rz = *roughness_m / units::kMicrometre;
  if (rz < 1.0) {
    return {.value = constant<T>(law.smooth), .branch = "below 1 um", .source = sources::kM56};
  }
  return {.value = constant<T>(law.constant - law.slope * std::pow(rz + 1.0, law.exponent)),
          .branch = is_nitrided(group)                    ? "nitrided"
                    : group == MaterialGroup::kNormalised ? "normalised"
                                                          : "through or surface hardened",
          .source = sources::kM56};
}

template <class T>
Factor<T> size_factor(MaterialGroup group, const T& module_m) {
  Factor<T> factor{.branch = "module up to 5 mm", .source = sources::kDin3990};
  const T m = module_m / units::kMillimetre;
  if (value_of(m) <= 5.0) return factor;
  if (is_plastic(group) || group == MaterialGroup::kBrass) {
    factor.branch = "no formula for this group";
    factor.source = sources::kNotStated;
    return factor;
  }
  const bool hard = is_surface_hardened(group);
  const double greatest = hard ? 25.0 : 30.0;
  const bool held = value_of(m) >= greatest;
  const T used = held ? constant<T>(greatest) : m;
  factor.value = hard ? T(1.05 - 0.01 * used) : T(1.03 - 0.006 * used);
  factor.branch = held ? "held at its greatest module" : hard ? "surface hardened" : "soft";
  return factor;
}

}  // namespace

std::optional<double> slip_layer_thickness_mm(const Material& material) {
  const std::optional<FoundSlipLayer> layer = slip_layer(material);
  return layer ? std::optional(layer->thickness_mm) : std::nullopt;
}

template <class T>
Factor<T> reversal_factor(RootLoading loading, const std::optional<double>& stated,
                          const Factor<T>& computed) {
  if (loading == RootLoading::kPulsating) return {.branch = "one flank", .source = sources::kM56};
  if (!stated) return computed;
  return {.value = constant<T>(*stated), .branch = "stated", .source = sources::kInput};
}

template <class T>
RootStrength<T> root_strength(const Material& material, const T& limit_Pa,
                              const RootCondition<T>& condition) {
  if (!(value_of(limit_Pa) > 0.0)) {
    throw std::invalid_argument(fmt::format("root strength: limit of {} = {} Pa, allowed: above 0",
                                            material.name, value_of(limit_Pa)));
  }
  if (!(value_of(condition.module_m) > 0.0)) {
    throw std::invalid_argument(fmt::format("root strength: module = {} m, allowed: above 0",
                                            value_of(condition.module_m)));
  }
  RootStrength<T> strength{
      .limit_Pa = limit_Pa,
      .stress_correction = {.value = constant<T>(2.0),
                            .branch = "gears of reference",
                            .source = sources::kM56},
      .life = root_life_factor(material.group, material.life_curve, condition.cycles),
      .notch_sensitivity = notch_sensitivity_factor(material, condition.notch_parameter),
      .surface = surface_factor<T>(material.group, condition.root_roughness_m),
      .size = size_factor(material.group, condition.module_m),
      .reversal = reversal_factor<T>(
          condition.loading, condition.reversal,
          {.value = constant<T>(0.7), .branch = "reversed", .source = sources::kM56})};
  strength.strength_Pa = limit_Pa * strength.stress_correction.value * strength.life.value *
                         strength.notch_sensitivity.value * strength.surface.value *
                         strength.size.value * strength.reversal.value;
  return strength;
}

#define INSTANTIATE(T)                                                             \
  template Factor<T> reversal_factor<T>(RootLoading, const std::optional<double>&, \
                                        const Factor<T>&);                         \
  template RootStrength<T> root_strength<T>(const Material&, const T&, const RootCondition<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
