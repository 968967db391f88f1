#include "strength/flank_stress.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace gear3k::strength {

using geometry::GearGeometry;
using geometry::GearKind;
using geometry::MeshGeometry;

namespace {

constexpr double kLeastSingleContactShare = 1e-3;
constexpr double kHeldContactRatio = 3.0;

template <class T>
Factor<T> contact_ratio_factor(const T& contact_ratio) {
  using std::sqrt;
  const double epsilon = value_of(contact_ratio);
  const bool held = epsilon > kHeldContactRatio;
  const T used = held ? constant<T>(kHeldContactRatio) : contact_ratio;
  return {.value = sqrt((4.0 - used) / 3.0),
          .branch = held            ? "held at contact ratio 3"
                    : epsilon > 2.0 ? "above contact ratio 2, conservative"
                    : epsilon < 1.0 ? "below contact ratio 1"
                                    : "contact ratio 1 to 2",
          .source = sources::kM56,
          .in_range = epsilon >= 1.0 && epsilon <= 2.0};
}

/// At the kink the slopes are those at point B: the pitch point's are those of the mate's flank.  A
/// solver that stops at the kink, where both limits hold, needs both.
constexpr double kTie = 1e-9;

/// Factor of one gear: its inner point of single contact is a base pitch below its tip.
/// @param sign  +1 external, −1 where the other one is a ring
template <class T>
Factor<T> single_contact_factor(const GearGeometry<T>& gear, const MeshGeometry<T>& mesh,
                                double sign, const T& pitch_product) {
  using std::sqrt;
  Factor<T> factor{.branch = "pitch point", .source = sources::kM56};
  const T& span = mesh.tangent_length_m;
  T own = geometry::tip_curvature_radius(gear) - mesh.base_pitch_m;
  T other = span - sign * own;
  const T least = kLeastSingleContactShare * span;
  if (value_of(own) < value_of(least) || value_of(other) < value_of(least)) {
    own = larger(own, least);
    other = larger(other, least);
    factor.in_range = false;
  }
  const T square = pitch_product / (own * other);
  if (value_of(square) > 1.0 - kTie) {
    factor.value = sqrt(square);
    factor.branch = "inner point of single contact";
    if (value_of(square) < 1.0) factor.value = factor.value + (1.0 - value_of(factor.value));
  }
  return factor;
}

}  // namespace

double elasticity_factor(const Elasticity& gear1, const Elasticity& gear2) {
  check_elasticity(gear1);
  check_elasticity(gear2);
  return std::sqrt(1.0 / (std::numbers::pi * (1.0 / gear1.plane_strain_modulus() +
                                              1.0 / gear2.plane_strain_modulus())));
}

template <class T>
FlankCurvature<T> pitch_point_curvature(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                                        const MeshGeometry<T>& mesh) {
  const T one = gear1.base_radius_m * mesh.tan_alpha_w;
  const T two = gear2.base_radius_m * mesh.tan_alpha_w;
  return {.length1_m = one, .length2_m = two, .reduced_m = one * two / mesh.tangent_length_m};
}

template <class T>
FlankStress<T> flank_stress(const ContactPair<T>& pair, const ToothLoad<T>& load,
                            const LoadFactorSet<T>& factors) {
  using std::cos, std::sin, std::sqrt;
  if (!(value_of(load.face_width_m) > 0.0)) {
    throw std::invalid_argument(fmt::format("flank stress: face width = {} m, allowed: above 0",
                                            value_of(load.face_width_m)));
  }
  if (!(value_of(load.tangential_N) >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "flank stress: tangential force = {} N, allowed: 0 or more", value_of(load.tangential_N)));
  }
  const GearGeometry<T>& g1 = pair.gear1;
  const GearGeometry<T>& g2 = pair.gear2;
  const MeshGeometry<T>& mesh = pair.mesh;
  const double sign = geometry::mesh_sign(g2.gear.kind);
  const T cos_w = cos(mesh.alpha_w_rad);
  const T sin_w = sin(mesh.alpha_w_rad);

  FlankStress<T> stress;
  stress.zone_factor = sqrt(2.0 * cos_w / (g1.angle.cos * g1.angle.cos * sin_w));
  stress.elasticity_factor = elasticity_factor(pair.elasticity1, pair.elasticity2);
  stress.contact_ratio = contact_ratio_factor(mesh.contact_ratio);
  const FlankCurvature<T> pitch = pitch_point_curvature(g1, g2, mesh);
  const T product = pitch.length1_m * pitch.length2_m;
  stress.single_contact1 = single_contact_factor(g1, mesh, sign, product);
  if (g2.gear.kind == GearKind::kRing) {
    stress.single_contact2 = {.branch = "ring", .source = sources::kM56};
  } else {
    stress.single_contact2 = single_contact_factor(g2, mesh, sign, product);
  }
  const T curvature = 0.5 / g1.reference_radius_m + sign * 0.5 / g2.reference_radius_m;
  const T pressure = load.tangential_N / load.face_width_m * curvature;
  // √ has no slope at 0: an unloaded mesh has no stress and no derivatives.
  if (!(value_of(pressure) > 0.0)) {
    stress.nominal_Pa = stress.pitch_point_Pa = constant<T>(0.0);
    stress.stress1_Pa = stress.stress2_Pa = constant<T>(0.0);
    return stress;
  }
  stress.nominal_Pa =
      stress.elasticity_factor * stress.zone_factor * stress.contact_ratio.value * sqrt(pressure);
  stress.pitch_point_Pa = stress.nominal_Pa * sqrt(factors.product());
  stress.stress1_Pa = stress.single_contact1.value * stress.pitch_point_Pa;
  stress.stress2_Pa = stress.single_contact2.value * stress.pitch_point_Pa;
  return stress;
}

#define INSTANTIATE(T)                                                                \
  template FlankCurvature<T> pitch_point_curvature<T>(                                \
      const GearGeometry<T>&, const GearGeometry<T>&, const MeshGeometry<T>&);        \
  template FlankStress<T> flank_stress<T>(const ContactPair<T>&, const ToothLoad<T>&, \
                                          const LoadFactorSet<T>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
