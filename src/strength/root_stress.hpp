#pragma once
// Bending stress at the root of a tooth.

#include <optional>

#include "strength/factor.hpp"
#include "strength/root_section.hpp"

namespace gear3k::strength {

/// A normal force on a flank, at the distance ρ from the base circle's tangent point along the line
/// of action.
///
///   tan α_y = ρ/rb,  α_F = α_y ∓ ψ_y,  ψ_y = s_y/(2 r_y),  y_c = rb/cos α_F   (− external, + ring)
///
/// Source: IACS UR M56 (external); the same lines drawn for a ring, docs/theory §42.
template <class T>
struct LoadPoint {
  T length_m{};       ///< ρ
  T angle_rad{};      ///< α_F: of the force with the normal to the tooth's axis
  T axis_height_m{};  ///< y_c: where the force's line crosses the tooth's axis, from the gear's
};
template <class T>
LoadPoint<T> load_point(const geometry::GearGeometry<T>& gear, const T& length_m);

/// ρ of the outer point of single contact: one base pitch less than the path's length below the
/// tip.
///
///   ρ_e = ρ_a ∓ p_b (min(ε, 2) − 1)            (− external, + ring)
///
/// Source: IACS UR M56 for 1 ≤ ε ≤ 2; above, the inner end of the last pitch is taken, which rates
/// the tooth alone and is conservative.  Below 1 the load is at the tip.  Kinks at ε = 1 and 2.
/// @returns ρ_e [m]
template <class T>
T outer_single_contact(const geometry::GearGeometry<T>& gear, const T& base_pitch_m,
                       const T& contact_ratio);

/// What the shape of a tooth makes of a force on it.
///
///   h_F = |y_F − y_c|,  Y_F = 6 (h_F/m) cos α_F/((s_F/m)² cos α)
///   L = s_F/h_F,  q_s = s_F/(2 ρ_F),  Y_S = (1.2 + 0.13 L) q_s^(1/(1.21 + 2.3/L))
///
/// Source: IACS UR M56.  f_ε = 1: the factor of ISO 6336-3:2019 jumps at ε = 2.
/// Valid: 1 ≤ q_s < 8, else notch_in_range is false and the value stands.
template <class T>
struct RootForm {
  RootSection<T> section;
  LoadPoint<T> load;
  T bending_arm_m{};             ///< h_F
  T form_factor{};               ///< Y_F
  T arm_ratio{};                 ///< L
  T notch_parameter{};           ///< q_s
  T stress_correction_factor{};  ///< Y_S
  bool notch_in_range = true;
};
inline constexpr double kLeastNotchParameter = 1.0, kGreatestNotchParameter = 8.0;

template <class T>
RootForm<T> root_form(const geometry::GearGeometry<T>& gear, const RootSection<T>& section,
                      const LoadPoint<T>& load);

/// Rim thickness factor Y_B.
///
///   external: 1.6 ln(2.242 h/s_R)  for s_R/h < 1.2, else 1;  a check fails at s_R/h ≤ 0.5
///   ring:     1.15 ln(8.324 m/s_R) for s_R/m < 3.5, else 1;  a check fails at s_R/m ≤ 1.75
///
/// and never below 1: the ring's formula, 0.9964 at 3.5, crosses 1 at s_R/m = 3.489.
/// h: tooth height |ra − rf|.  Source: IACS UR M56; not below 1: own choice.  Kinks where it
/// becomes 1, at 1.2 and 3.489 (a step of 7e-5 at 1.2).
/// @param rim_m  s_R: material under the root circle; empty: no rim is stated and Y_B = 1
/// @throws std::invalid_argument when s_R is not positive
template <class T>
Factor<T> rim_factor(const geometry::GearGeometry<T>& gear, const std::optional<T>& rim_m);

/// Rim below which Y_B has no value: half a tooth height, of a ring 1.75 modules.  @returns s_R [m]
template <class T>
T least_rim(const geometry::GearGeometry<T>& gear);

/// Factors that raise the nominal load of a root, K_A K_γ K_v K_Fβ K_Fα, or of a flank.
template <class T>
struct LoadFactorSet {
  T application = constant<T>(1.0);  ///< K_A
  T mesh_load = constant<T>(1.0);    ///< K_γ
  T dynamic = constant<T>(1.0);      ///< K_v
  T face = constant<T>(1.0);         ///< K_Fβ, K_Hβ
  T transverse = constant<T>(1.0);   ///< K_Fα, K_Hα

  [[nodiscard]] T product() const { return application * mesh_load * dynamic * face * transverse; }
};

/// A tooth's share of the transmitted force.
template <class T>
struct ToothLoad {
  T tangential_N{};  ///< F_t = F_n cos α, at the reference circle, of one planet
  T face_width_m{};  ///< b
};

/// Root stress.
///
///   σ_F0 = F_t/(b m) Y_F Y_S Y_B,  σ_F = σ_F0 K_A K_γ K_v K_Fβ K_Fα      (Y_β = Y_DT = 1)
///
/// Source: IACS UR M56.
template <class T>
struct RootStress {
  T nominal_Pa{};  ///< σ_F0
  T stress_Pa{};   ///< σ_F
};
/// @throws std::invalid_argument when b is not positive or F_t negative
template <class T>
RootStress<T> root_stress(const geometry::GearGeometry<T>& gear, const RootForm<T>& form,
                          const T& rim_factor, const ToothLoad<T>& load,
                          const LoadFactorSet<T>& factors);

}  // namespace gear3k::strength
