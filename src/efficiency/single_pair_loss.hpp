#pragma once
// Friction loss of one tooth pair that carries the whole load over its whole path of contact: the
// single-tooth model of the directional-impedance thesis.

namespace gear3k::efficiency {

/// An external spur pair, gear 1 driving, as the single-tooth model sees it.
struct SinglePair {
  double pitch_radius1_m = 0.0;  ///< R1, working pitch circle of the driver
  double pitch_radius2_m = 0.0;  ///< R2, of the driven gear
  double tip_radius1_m = 0.0;
  double tip_radius2_m = 0.0;
  double pressure_angle_rad = 0.0;  ///< α, working
  double friction = 0.0;            ///< μ ≥ 0, Coulomb
};

/// The same pair with gear 2 driving.
SinglePair reversed(const SinglePair& pair);

/// Lengths of the path of contact on either side of the pitch point.
///
///   approach = √(ra2² − R2² cos² α) − R2 sin α      (ended by the driven gear's tip)
///   recess   = √(ra1² − R1² cos² α) − R1 sin α      (ended by the driver's tip)
///
/// Their sum is the length of contact.  Source: directional-impedance thesis, limits of eqs. 2.1
/// and 2.2, and eq. 2.3; own derivation from tip circle and line of action.
struct ContactPath {
  double approach_m = 0.0, recess_m = 0.0;
};
/// @throws std::invalid_argument when a radius or the angle is not that of a pair whose tips reach
///         its pitch point
ContactPath contact_path(const SinglePair& pair);

/// Whether the path ends before both base circles' tangent points: approach ≤ R1 sin α and recess ≤
/// R2 sin α.  Beyond them a flank has no involute and the formulas below describe no contact.
/// @throws std::invalid_argument as contact_path()
bool path_on_involutes(const SinglePair& pair);

/// Torque loss λ = 1 − T2 R1/(T1 R2) with the contact before (after) the pitch point.
///
///   approach  λ = μ a (R1 + R2)/(R2 (μ a + R1 cos α − μ R1 sin α))
///   recess    λ = μ a (R1 + R2)/(R2 (μ a + R1 cos α + μ R1 sin α))
///
/// From the moments of the normal force F and the friction μ F, whose arms about the centres are
/// r_b = R cos α and ρ = R sin α ± a: T = F (r_b ∓ μ ρ), exact for any μ.
/// Source: directional-impedance thesis, eqs. 2.1 (approach) and 2.2 (recess); own derivation.
/// Valid: a ≥ 0, μ tan α < 1 (beyond, the driver cannot move the pair through the pitch point).
/// λ above 1 (the driven gear locks) is returned as it is.
/// @param distance_m  a, from the pitch point along the line of action
/// @throws std::invalid_argument outside the range of validity
double approach_torque_loss(const SinglePair& pair, double distance_m);
double recess_torque_loss(const SinglePair& pair, double distance_m);

/// Mean of λ, evenly over the whole path of contact.
///
/// With approach and recess contact ratios e_a, e_r it is to first order in μ
/// μ π (1/z1 + 1/z2)(e_a² + e_r²)/(e_a + e_r); mesh_efficiency() has a smaller factor where two
/// pairs share the load.
/// Gauss-Legendre quadrature with 15 points on either side of the pitch point.  Accuracy: 256 ε of
/// the value for μ ≤ 1 and 10 to 150 teeth, from the lengths' cancellation (property-tested against
/// the closed form); the quadrature's own error is below that.
/// Does not account for: load sharing between pairs (one pair carries all load, tip to tip), tips
/// beyond the tangent points (see path_on_involutes()), undercut, bearings, dependence of μ on
/// load, speed or sense of sliding.
/// Source: directional-impedance thesis, sec. 2.1 ("averaged over the line of action").
/// @throws std::invalid_argument as contact_path() and the pointwise losses
double mean_torque_loss(const SinglePair& pair);

/// Half the sum and half the difference of the mean losses in the two drive directions; loss =
/// symmetric + skew, and skew changes its sign with the direction.
///
/// Skew is of second order in μ, from two terms of opposite sign that nearly cancel:
///   μ² (R1 + R2)/(2 R1 R2 cos α (A + B)) [tan α (A² − B²) − (1/R1 − 1/R2)(A³ + B³)/(3 cos α)]
/// with A approach and B recess; its sign is therefore not that of R1 − R2 everywhere.
/// Source: directional-impedance thesis, eq. 2.4; expansion: own derivation.
/// @throws std::invalid_argument as mean_torque_loss()
double symmetric_loss(const SinglePair& pair);
double skew_loss(const SinglePair& pair);

}  // namespace gear3k::efficiency
