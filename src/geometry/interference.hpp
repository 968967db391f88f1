#pragma once
// Whether the workshop can cut and assemble what the involute formulas describe.

#include "geometry/mesh.hpp"
#include "geometry/tooth_form.hpp"

namespace gear3k::geometry {

/// Profile shift above the one at which a rack tool begins to undercut an external gear.
///
///   x − (h_Ff* − z sin² α / 2),  h_Ff* = rack_depth() − ρ* (1 − sin α),  ρ* = rack_rounding()
///
/// h_Ff* is the depth of the basic rack's straight flank below its reference line (1.0 for the
/// rack 1.25 / 0.38 at 20° to 4 decimals).
/// Source: ISO 21771 (undercut by a rack), docs/theory §5, §14.
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

/// Where the active flank of one gear of a mesh ends towards its root, as distance along the line
/// of action from its base circle's tangent point; the mate's tip sets it.
///
///   external  ρ_Nf1 = d sin α_w − ρ_a2, likewise gear 2
///   internal  ρ_Nf1 = ρ_a2 − d sin α_w,  ρ_Nf2 = ρ_a1 + d sin α_w
///
/// Source: ISO 21771 (start of active profile d_Nf = 2 sqrt(rb² + ρ_Nf²)), docs/theory §16.
/// @param which  1 or 2  @returns [m]; negative = involute interference
template <class T>
T active_root_length(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                     const MeshGeometry<T>& mesh, int which);

/// Flank that lies between the start of active profile and the form circle, along the line of
/// action: (ρ_Nf − ρ_F)/m external, (ρ_F − ρ_Nf)/m ring.
/// @param form  of gear `which`  @returns modules, negative = the mate's tip runs into the fillet,
///   or (undercut) on flank that is not there
template <class T>
T form_circle_margin(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                     const MeshGeometry<T>& mesh, const ToothForm<T>& form, int which);

/// Radial room between a gear's tip circle and its mate's root circle.
///
///   external (d − ra_i − rf_j)/m;  pinion's tip (rf_2 − d − ra_1)/m;  ring's tip (ra_2 − d −
///   rf_1)/m
///
/// Source: ISO 21771 (tip clearance c), docs/theory §16.  @param which  1 or 2: the gear whose
/// tip it is
/// @returns modules, negative = overlap
template <class T>
T root_clearance(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                 const MeshGeometry<T>& mesh, int which);

/// Room between the tip corners of pinion and ring where their tip circles cross, outside the path
/// of contact (trochoid interference):
///
///   ra_2 [ (θ1 + inv α_a1 − inv α_w) z1/z2 + inv α_w − inv α_a2 − θ2 ]/m
///   cos θ1 = (ra_2² − ra_1² − d²)/(2 d ra_1),  cos θ2 = (d² + ra_2² − ra_1²)/(2 d ra_2)
///
/// Flanks in contact on one side, so thinning has no part in it.  A tip corner that is free at the
/// crossing is free of the mate's flank everywhere (docs/theory §17).
/// Source: KHK Gear Technical Data (trochoid interference); derived again in docs/theory §17.
/// Valid: internal meshes.  @returns modules of arc on the ring's tip circle, negative =
/// interference
template <class T>
T trochoid_margin(const GearGeometry<T>& pinion, const GearGeometry<T>& ring,
                  const MeshGeometry<T>& mesh);

/// Room between the tip corners of pinion and ring when the pinion moves in along the line of
/// centres (trimming):
///
///   ra_2 [ (θ1 + inv α_a1 − inv α_w) z1/z2 − (θ2 + inv α_a2 − inv α_w) ]/m
///   sin² θ1 = (1 − (cos α_a1/cos α_a2)²)/(1 − (z1/z2)²),  ra_1 sin θ1 = ra_2 sin θ2
///
/// Source: KHK Gear Technical Data (trimming interference); derived again in docs/theory §17.
/// Valid: internal meshes; of no interest where planets are assembled along their axis.
/// @returns modules of arc on the ring's tip circle, negative = interference
template <class T>
T trimming_margin(const GearGeometry<T>& pinion, const GearGeometry<T>& ring,
                  const MeshGeometry<T>& mesh);

/// What the cutter of a ring leaves of its flanks: the least of four margins, in modules.
///
///   ToothForm::cutter_room: cutter and ring have a generating distance;
///   (ρ_a2 − a0 sin α_w0)/m: the cutter's involute reaches to the ring's tip;
///   trochoid_margin() and trimming_margin() of the cutter in the ring at a0: its corners do not
///   cut the ring's tips while it rolls and while it is fed in.
///
/// Source: as for those, docs/theory §17.  Valid: rings with a cutter.
template <class T>
T ring_cutter_margin(const GearGeometry<T>& ring, const ToothForm<T>& form);

/// Least gap between a gear's tip corner and its mate's root fillet over the whole passage through
/// the tooth space, as arc about the mate's centre; flanks in contact on the corner's side.
///
/// The first 15 % of the fillet (in cot γ, from the flank) are left out: there the gap touches zero
/// where form_circle_margin() does.
/// Source: own derivation, docs/theory §18.  Derivatives are those
/// of the least gap, whose place moves with the design.
/// @param form  of the mate  @param which  1 or 2: the gear whose tip corner it is
/// @returns modules, negative = the corner cuts into the fillet
template <class T>
T tip_fouling_gap(const GearGeometry<T>& gear1, const GearGeometry<T>& gear2,
                  const MeshGeometry<T>& mesh, const ToothForm<T>& form, int which);

}  // namespace gear3k::geometry
