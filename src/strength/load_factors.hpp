#pragma once
// Factors by which a mesh's load exceeds the nominal one.

#include <optional>

#include "strength/factor.hpp"
#include "strength/material.hpp"

namespace gear3k::strength {

/// A mesh as its load factors see it.  Lengths and forces in SI; the formulas want the line load
///   w = F_t K_A/b  [N/mm].
template <class T>
struct LoadedMesh {
  T tangential_N{};                 ///< F_t, of one planet
  T face_width_m{};                 ///< b
  double application_factor = 1.0;  ///< K_A
  T contact_ratio{};                ///< ε
  int pinion_teeth = 0;             ///< z1, of the gear with fewer teeth
  double tooth_ratio = 1.0;         ///< u = z2/z1 ≥ 1, positive for rings
  T speed_m_s = constant<T>(0.0);   ///< v: reference circle, carrier frame
};
/// w [N/mm].  @throws std::invalid_argument when b is not positive or F_t negative
template <class T>
T line_load_n_mm(const LoadedMesh<T>& mesh);

/// Dynamic factor, method C for spur gears.
///
///   K_v = 1 + (K1/max(100, w) + 0.0193) V K3,  V = v z1/100 √(u²/(1 + u²))
///   K3 = 2 (V ≤ 0.2), 2.071 − 0.357 V;   K1 = 2.1 3.9 7.5 14.9 26.8 39.1 for grades 3 to 8
///
/// Source: IACS UR M56.  Valid: V < 3; beyond, where the formula would fall and turn negative, it
/// is held at V = 3 and in_range is false.  Kinks: w = 100 N/mm, V = 0.2 (K3 has a step of 4e-4
/// there). At rest K_v = 1.
/// @param grade  ISO 1328 accuracy grade; empty: not stated, K_v = 1
/// @throws std::invalid_argument when the grade is not from 3 to 8
template <class T>
Factor<T> dynamic_factor(const LoadedMesh<T>& mesh, std::optional<int> grade);

/// V, the greatest of which the formula of K_v is stated for.
inline constexpr double kGreatestDynamicSpeed = 3.0;
template <class T>
T dynamic_speed(const LoadedMesh<T>& mesh);

/// Face load factor of the flank from the misalignment that is left after running in.
///
///   q = F_βy c_γβ/(2 w):  K_Hβ = 1 + q (q < 1), 2 √q
///
/// Source: hakangunes258/mekanika (ISO 6336-1:2006, eqs. 39, 41).  The kink at q = 1 is smooth in
/// value and slope.
/// @param misalignment_m  F_βy ≥ 0 over the face width; 0: K_Hβ = 1
/// @param stiffness_Pa  c_γβ [N/m²]; 1 N/(mm µm) = 1e9 N/m²
/// @throws std::invalid_argument when F_βy is negative, or c_γβ or w not positive though F_βy is
template <class T>
Factor<T> face_load_factor(const LoadedMesh<T>& mesh, const T& misalignment_m,
                           const T& stiffness_Pa);

/// Face load factor of the root, K_Fβ = K_Hβ^(1/(1 + h/b + (h/b)²)), h/b at most ⅓.
/// Source: IACS UR M56, hakangunes258/mekanika.
/// @param height_to_width  h/b: tooth height over face width, of the gear where it is larger
template <class T>
Factor<T> root_face_load_factor(const T& flank_factor, const T& height_to_width);

/// Transverse load factors of flank and root.
template <class T>
struct TransverseLoadFactors {
  Factor<T> flank{};  ///< K_Hα
  Factor<T> root{};   ///< K_Fα
};
/// What they depend on besides the mesh.
template <class T>
struct TransverseDeviation {
  T base_pitch_deviation_m{};  ///< f_pb, of the gear where it is larger
  T running_in_m{};            ///< y, running_in_allowance()
  T stiffness_Pa{};            ///< c_γα [N/m²]
  T dynamic_factor{};          ///< K_v
  T face_load_factor{};        ///< K_Hβ
};
/// K_Hα = K_Fα between their limits:
///
///   ε ≤ 2: ε/2 (0.9 + 0.4 q_α);  above: 0.9 + 0.4 √(2 (ε − 1)/ε) q_α
///   q_α = c_γα (f_pb − y)/(w K_v K_Hβ);  K_Hα in [1, 1/Z_ε²],  K_Fα in [1, ε/(0.25 ε + 0.75)]
///
/// Source: hakangunes258/mekanika (ISO 6336-1:2006, eqs. 71-77), cfernandesFEUP/GEARpie.  Kinks at
/// the limits; continuous at ε = 2.
/// @throws std::invalid_argument when f_pb, y or c_γα is negative, or w K_v K_Hβ not positive
template <class T>
TransverseLoadFactors<T> transverse_load_factors(const LoadedMesh<T>& mesh,
                                                 const TransverseDeviation<T>& deviation);

/// Base pitch deviation f_pb = f_pt cos α of an accuracy grade.
/// Source: backlash::pitch_grade(); the report of stage_01.
/// @returns [m]; empty outside the range of the grade's formulas
/// @throws std::invalid_argument when the grade is not from 3 to 12
std::optional<double> base_pitch_deviation(double module_m, double reference_diameter_m,
                                           double alpha_rad, int grade);

/// Running-in allowance of a base pitch deviation, in µm and N/mm².
///
///   surface hardened: min(0.075 f, 3);   St, V: 160 f/σ_Hlim
///
/// at most f.  Source: hakangunes258/mekanika (ISO 6336-1:2006).
/// @param flank_limit_Pa  σ_Hlim; empty: not stated, nothing is allowed for
/// @returns y [m]; 0 for other groups
/// @throws std::invalid_argument when the group's formula needs σ_Hlim and it is not positive
template <class T>
T running_in_allowance(MaterialGroup group, std::optional<double> flank_limit_Pa,
                       const T& deviation_m);

/// Whose table of K_γ.
enum class MeshLoadTable {
  kM56,        ///< N = 3, 4, 5, 6 and more: 1.0, 1.2, 1.3, 1.4
  kDrivetrain  ///< 1.1, 1.25, 1.35, 1.44
};
/// Mesh load factor K_γ of N planets.
/// Source: IACS UR M56; gfsReboucas/Drivetrain.
/// @returns empty for fewer than 3 planets: the tables have no row
/// @throws std::invalid_argument when N < 1
std::optional<Factor<double>> mesh_load_factor(MeshLoadTable table, int planets);

}  // namespace gear3k::strength
