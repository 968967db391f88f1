#pragma once

#include "geometry/gear.hpp"

namespace gear3k::inertia {

/// Mass and polar moment of inertia of a body about its own axis.
template <class T>
struct MassProperties {
  T mass_kg;
  T inertia_kgm2;
};

/// A homogeneous hollow cylinder.
template <class T>
struct HollowCylinder {
  T outer_radius_m, inner_radius_m, width_m, density_kgm3;
};

/// m = ρ π b (ro² − ri²),  J = m (ro² + ri²)/2.
/// @throws std::invalid_argument unless ro ≥ ri ≥ 0, b ≥ 0, ρ ≥ 0
template <class T>
MassProperties<T> hollow_cylinder(const HollowCylinder<T>& body);

/// Inertia of a body about an axis parallel to its own, at a distance from it.
///
///   J' = J + m d²
///
/// Source: parallel-axis theorem.  @returns [kg m²]
template <class T>
T inertia_about_parallel_axis(const MassProperties<T>& body, const T& distance_m);

/// Radius half-way between tip and root circle: where the teeth end as a body.  @returns [m]
template <class T>
T toothed_radius(const geometry::GearGeometry<T>& g);

/// A gear as a cylinder whose toothed side lies half-way between tip and root circle.
///
/// External gears reach from the bore to that circle, rings from that circle to the outer radius.
/// Source: the convention of gear calculation reports ((da + df)/2 and bore).
/// Does not account for: webs, shafts, chamfers.
/// @param other_radius_m  bore radius of an external gear, outer radius of a ring
template <class T>
MassProperties<T> gear_body(const geometry::GearGeometry<T>& g, const T& other_radius_m,
                            const T& width_m, const T& density_kgm3);

}  // namespace gear3k::inertia
