#pragma once
// Pitting strength of a flank of steel or iron.

#include <optional>

#include "strength/factor.hpp"
#include "strength/material.hpp"

namespace gear3k::strength {

/// Hardness [HB] for which Z_W is stated.
inline constexpr double kLeastBrinell = 130.0, kGreatestBrinell = 470.0;

/// What the strength of a flank depends on besides its material's limit.
template <class T>
struct FlankCondition {
  T cycles{};                    ///< N; 0: static
  bool pitting_allowed = false;  ///< some pits do not count as failure
  /// Flank limit of the softer gear: its lubrication coefficients hold for both.
  T softer_limit_Pa{};
  T reduced_radius_m{};                      ///< ρ_red at the pitch point
  T speed_m_s = constant<T>(0.0);            ///< v: reference circles, carrier frame
  std::optional<double> viscosity40_m2_s{};  ///< ν40; empty: not stated
  std::optional<double> own_roughness_m{}, mate_roughness_m{};  ///< R_z of the flanks
  /// Group of the mate: a hard one hardens a soft gear by work.
  MaterialGroup mate_group = MaterialGroup::kNormalised;
  std::optional<double> brinell_hardness{};  ///< of this gear; empty: Z_W = 1
};

/// Flank strength σ_HG = σ_Hlim Z_NT Z_L Z_v Z_R Z_W Z_X, factor by factor.
///
///   Z_NT  flank_life_factor()
///   Z_L = C_ZL + 4 (1 − C_ZL)/(1.2 + 134/ν40)²,     ν40 in mm²/s
///         C_ZL = 0.83 (σ < 850), 0.91 (σ > 1200), σ/4375 + 0.6357, σ = the softer σ_Hlim in N/mm²
///   Z_v = C + 2 (1 − C)/√(0.8 + 32/v),  C = C_ZL + 0.02,     v in m/s
///   Z_R = (3/(R_z (10/ρ_red)^⅓))^C_ZR,  R_z = (R_z1 + R_z2)/2 in µm, ρ_red in mm
///         C_ZR = 0.15, 0.08, 0.32 − 0.0002 σ in the same ranges
///   Z_W = (1.2 − (HB − 130)/1700) (3/R)^0.15 of a soft gear (St, V) with a surface hardened mate,
///         R = R_z,h (10/ρ_red)^0.33 (R_z,h/R_z,s)^0.66/(v ν40/1500)^0.33, held in [3, 16], HB in
///         [130, 470]; else 1
///   Z_X = 1
///
/// Without lubricant Z_L = Z_v = 1, without a roughness Z_R = 1, without HB Z_W = 1; at rest Z_v is
/// its limit C.  C_ZL has a step of 1.4e-5 at 850 and at 1200 N/mm².
/// Source: IACS UR M56; hakangunes258/mekanika (ISO 6336-2:2006).
template <class T>
struct FlankStrength {
  T limit_Pa{};                ///< σ_Hlim
  Factor<T> life{};            ///< Z_NT
  Factor<T> lubricant{};       ///< Z_L
  Factor<T> speed{};           ///< Z_v
  Factor<T> roughness{};       ///< Z_R
  Factor<T> work_hardening{};  ///< Z_W
  Factor<T> size{};            ///< Z_X
  T strength_Pa{};             ///< σ_HG
};

/// @param limit_Pa  σ_Hlim, of flank_limit() or a number of the user
/// @throws std::invalid_argument when a limit or ρ_red is not positive, N, v or a roughness
/// negative
template <class T>
FlankStrength<T> flank_strength(const Material& material, const T& limit_Pa,
                                const FlankCondition<T>& condition);

/// S_H = σ_HG/σ_H.
template <class T>
T flank_safety(const FlankStrength<T>& strength, const T& stress_Pa) {
  return strength.strength_Pa / stress_Pa;
}

}  // namespace gear3k::strength
