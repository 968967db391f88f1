#pragma once
// Whether the workshop can cut and assemble what the involute formulas describe.

#include "geometry/mesh.hpp"

namespace gear3k::geometry {

/// Profile shift above the one at which a rack tool begins to undercut an external gear.
///
///   x − (h_Ff* − z sin² α / 2),  h_Ff* = hfP* − ρfP* (1 − sin α)
///
/// h_Ff* is the depth of the basic rack's straight flank below its reference line (1.0 for the
/// rack 1.25 / 0.38 at 20° to 4 decimals).
/// Source: ISO 21771 (undercut by a rack), docs/theory.md §5.
/// Valid: external gears cut by a rack or hob.  @returns margin in modules, negative = undercut
template <class T>
T undercut_margin(const GearGeometry<T>& external);

/// Distance that a ring's tip circle keeps outside its base circle: (ra − rb)/m.
/// Inside it there is no involute to mesh with.  @returns modules
template <class T>
T ring_tip_above_base(const GearGeometry<T>& ring);

/// Room between the contact point at a gear's tip and the tangent point of the mate's base circle;
/// beyond that point the tip would cut into the mate's root (involute interference).
///
///   external, tip of gear i: (d sin α_w − ρ_ai)/m
///   internal, tip of ring:   (ρ_a2 − d sin α_w)/m,  equal in sign to z1/z2 − 1 + tan α_a2/tan α_w
///
/// Source: ISO 21771; KHK Gear Technical Data (involute interference of internal gears).
/// @param which  1 or 2: the gear whose tip is examined (2 for a ring)
/// @returns modules, negative = interference
template <class T>
T involute_interference_margin(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                               const MeshGeometry<T>& mesh, int which);

}  // namespace gear3k::geometry
