#pragma once

#include <array>

#include "tests/rig/rig_gearbox.hpp"

namespace gear3k::rig {

/// One mesh at its centre distance. Gear a is the external one nearer to the sun's side of the
/// train: S, P1, P2; gear b is P1, R1, R2.
struct RigMesh {
  int teeth_a = 0, teeth_b = 0;
  double base_radius_a_m = 0.0, base_radius_b_m = 0.0;
  double working_angle_rad = 0.0;
  double tip_path_a_m = 0.0;  ///< path of contact on the side of a's tip, from the pitch point
  double tip_path_b_m = 0.0;  ///< the same on the side of b's tip
  /// Sum of |distance to the pitch point| over the pairs in contact, each weighted by its share
  /// of the load, averaged over a base pitch: the part on the side of a's tip and of b's tip.
  double lever_a_m = 0.0, lever_b_m = 0.0;
  double curvature_1_m = 0.0;  ///< 1/r_ba + 1/r_bb, minus for an internal pair
};

/// What describes one pair; the ring is gear b and its teeth are counted positive.
struct RigPair {
  int teeth_a = 0, teeth_b = 0;
  bool internal = false;
  double shift_a = 0.0, shift_b = 0.0;
  double module_m = 0.0, pressure_angle_rad = 0.0, center_distance_m = 0.0, addendum = 1.0;
};

/// Builds the mesh; the average over a base pitch is a quadrature over the pairs in contact.
/// @throws std::invalid_argument when the base circles leave no line of action or no pair touches
RigMesh make_rig_mesh(const RigPair& pair);

/// The three pairs S-P1, P1-R1, P2-R2 of a gearbox.
std::array<RigPair, 3> pairs_of(const Gearbox& gearbox);

/// Fraction of the power that is lost, to first order in friction.
double mesh_loss(const RigMesh& mesh, bool a_drives, double approach_friction,
                 double recess_friction);

/// Backlash along the line of action: circular pitch minus both tooth thicknesses on the working
/// pitch circles, times the cosine of the working angle.
/// @param center_distance_m may differ from the pair's own (run-out, temperature)
/// @param thinning_m        of both teeth together, normal to the flank
double normal_backlash_m(const RigPair& pair, double center_distance_m, double thinning_m);

}  // namespace gear3k::rig
