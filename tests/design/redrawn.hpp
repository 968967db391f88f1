#pragma once
// Another drawing in place of deviations: a gearbox, or a pair, as built.

#include <array>
#include <cmath>

#include "design/evaluation.hpp"

namespace gear3k::design {

/// What one built gearbox differs by, m.
struct Built {
  double center_distance_m = 0.0;
  std::array<GearDeviation, train::kGearCount> gears{};
};

/// Another drawing: the gearbox as built.  By the definitions of the keys: s = m (π/2 ± 2 x tan α)
/// of a gear and a ring, and tip and root circle at m (z/2 ± (ha* ± x − k)), m (z/2 ± (± x − hf*)).
inline Design redrawn(const Design& drawn, const Built& built) {
  Design d = drawn;
  d.tolerances.reset();
  d.train = resolved_parameters(drawn);
  d.center_distance_given = true;
  auto& t = d.train;
  const auto nominal = train::make_train_gears(t);
  t.khk_tip.fill(false);
  t.center_distance_m += built.center_distance_m;
  const double tan_alpha = std::tan(t.pressure_angle_rad);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const bool ring = train::kind_of(static_cast<int>(i)) == geometry::GearKind::kRing;
    const double m = t.module_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(i)))];
    const double half_z_m = nominal[i].reference_radius_m;
    const double tip_m = nominal[i].tip_radius_m + 0.5 * built.gears[i].tip_diameter_m;
    double& x = t.profile_shift[i];
    x += (ring ? -1.0 : 1.0) * built.gears[i].tooth_thickness_m / (2.0 * tan_alpha * m);
    t.tip_shortening[i] = ring ? (tip_m - half_z_m) / m + t.rack[i].addendum - x
                               : t.rack[i].addendum + x - (tip_m - half_z_m) / m;
    if (built.gears[i].root_diameter_m) {
      const double root_m = nominal[i].root_radius_m + 0.5 * *built.gears[i].root_diameter_m;
      t.rack[i].dedendum = ring ? (root_m - half_z_m) / m - x : x - (root_m - half_z_m) / m;
    }
  }
  return d;
}

/// @param pick  double(const backlash::DeviationLimits&)
template <class Pick>
Built built_by(const backlash::Tolerances& t, Pick pick) {
  Built b{.center_distance_m = pick(t.center_distance_m), .gears = {}};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    b.gears[i].tooth_thickness_m = pick(t.gears[i].tooth_thickness_m);
    b.gears[i].tip_diameter_m = pick(t.gears[i].tip_diameter_m);
    if (t.gears[i].root_diameter_m) b.gears[i].root_diameter_m = pick(*t.gears[i].root_diameter_m);
  }
  return b;
}

/// A pair as built, by the same definitions, where every gear is cut by a rack or has arcs for
/// fillets.
/// @param pick  as of built_by()
template <class Pick>
PairDesign redrawn_pair(const PairDesign& drawn, double center_distance_m, Pick pick) {
  PairDesign d = drawn;
  d.tolerances.reset();
  d.center_distance_m = center_distance_m + pick(drawn.tolerances->center_distance_m);
  d.khk_tip.fill(false);
  const double tan_alpha = std::tan(d.pressure_angle_rad);
  for (const std::size_t i : {0U, 1U}) {
    geometry::Gear<double>& gear = i == 0 ? d.gear1 : d.gear2;
    const backlash::GearTolerances& t = drawn.tolerances->gears[i];
    const double sign = gear.kind == geometry::GearKind::kRing ? -1.0 : 1.0;
    const double infeed = sign * pick(t.tooth_thickness_m) / (2.0 * tan_alpha * gear.module_m);
    gear.profile_shift += infeed;
    gear.tip_shortening += sign * (infeed - 0.5 * pick(t.tip_diameter_m) / gear.module_m);
  }
  return d;
}

}  // namespace gear3k::design
