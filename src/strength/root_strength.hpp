#pragma once
// Bending strength of the root of a tooth of steel or iron.

#include <optional>

#include "strength/factor.hpp"
#include "strength/material.hpp"

namespace gear3k::strength {

/// How a tooth is loaded over its life.
enum class RootLoading {
  kPulsating,  ///< one flank
  kReversed    ///< both in turn: an idler, a joint that works in both directions
};

/// What the strength of a root depends on besides its material's limit.
template <class T>
struct RootCondition {
  T cycles{};                                ///< N; 0: static
  T notch_parameter{};                       ///< q_s
  T module_m{};                              ///< m
  std::optional<double> root_roughness_m{};  ///< R_z of the fillet; empty: not stated
  RootLoading loading = RootLoading::kPulsating;
  std::optional<double> reversal{};  ///< Y_M of kReversed as stated; empty: 0.7
};

/// Root strength σ_FG = σ_Flim Y_ST Y_NT Y_δ Y_R Y_X Y_M, factor by factor.
///
///   Y_ST = 2
///   Y_NT  root_life_factor()
///   Y_δ  = (1 + √(0.2 ρ' (1 + 2 q_s)))/(1 + √(1.2 ρ')), ρ' [mm] slip layer:
///          Eh, IF 0.0030; nitrided and nitrocarburised 0.1005; St, V by yield strength [N/mm²]
///          300 | 400 | 500 | 600 | 800 | 1000: 0.0833 | 0.0445 | 0.0281 | 0.0194 | 0.0064 |
///          0.0014, linear between, held beyond; 1 where neither group nor yield strength tells it
///   Y_R    R_z [µm] of the root, below 1 the value in brackets
///          V, Eh, IF 1.674 − 0.529 (R_z + 1)^0.1        [1.12]
///          St        5.306 − 4.203 (R_z + 1)^0.01       [1.07]
///          nitrided  4.299 − 3.259 (R_z + 1)^0.0058     [1.025]
///   Y_X    1 to m = 5 mm; V, St 1.03 − 0.006 m (held from 30 mm); surface hardened 1.05 − 0.01 m
///          (held from 25 mm)
///   Y_M    1; 0.7 reversed, or as stated
///
/// Source: IACS UR M56; ρ' of St: hakangunes258/mekanika; Y_X: hanslhansl/din3990.  Nodular iron is
/// taken as V (perlitic or bainitic).
/// Does not account for: Y_M of unequal amplitudes, which has no source.
template <class T>
struct RootStrength {
  T limit_Pa{};                   ///< σ_Flim
  Factor<T> stress_correction{};  ///< Y_ST
  Factor<T> life{};               ///< Y_NT
  Factor<T> notch_sensitivity{};  ///< Y_δ
  Factor<T> surface{};            ///< Y_R
  Factor<T> size{};               ///< Y_X
  Factor<T> reversal{};           ///< Y_M
  T strength_Pa{};                ///< σ_FG
};

/// @param limit_Pa  σ_Flim, of root_limit() or a number of the user
/// @throws std::invalid_argument when the limit or the module is not positive, R_z or N negative
template <class T>
RootStrength<T> root_strength(const Material& material, const T& limit_Pa,
                              const RootCondition<T>& condition);

/// S_F = σ_FG/σ_F.
template <class T>
T root_safety(const RootStrength<T>& strength, const T& stress_Pa) {
  return strength.strength_Pa / stress_Pa;
}

/// Greatest strength under few, large loads: σ_FG with the plateau of Y_NT; K_v = 1 belongs to it.
template <class T>
RootStrength<T> static_root_strength(const Material& material, const T& limit_Pa,
                                     RootCondition<T> condition) {
  condition.cycles = constant<T>(0.0);
  return root_strength(material, limit_Pa, condition);
}

/// ρ' of Y_δ [mm]; empty where nothing is known of it, and Y_δ = 1.
std::optional<double> slip_layer_thickness_mm(const Material& material);

/// Y_M of a loading.
/// @param stated    of kReversed
/// @param computed  of kReversed where it is not stated
template <class T>
Factor<T> reversal_factor(RootLoading loading, const std::optional<double>& stated,
                          const Factor<T>& computed);

}  // namespace gear3k::strength
