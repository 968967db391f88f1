#pragma once
// Load capacity of gears of plastic: tooth temperatures, stresses, wear, deformation (VDI 2736).

#include <optional>

#include "strength/factor.hpp"
#include "strength/root_stress.hpp"

namespace gear3k::strength {

/// Material of the gear that a plastic gear meshes with.
enum class PlasticMate { kSteel, kPlastic };

/// Heat transfer coefficients k_ϑ [K (m/s)^0.75 mm^1.75/W].
struct HeatTransfer {
  double flank = 0.0, root = 0.0;
};
/// Steel mate 6300 | 895, plastic mate 9000 | 2148 (flank | root).
/// Source: cfernandesFEUP/GEARpie@2d87d6b CLASSES/VDI2736.py.
HeatTransfer heat_transfer(PlasticMate mate);

/// What heats a mesh, and where the heat goes.
template <class T>
struct ToothHeat {
  T ambient_K{};  ///< ϑ0
  T loss_W{};     ///< P_loss: the mesh's own friction power, of one planet
  /// P_G: what leaves through the housing, of all meshes and planets; empty: P_loss.
  std::optional<T> housing_loss_W{};
  T face_width_m{};      ///< b
  int pinion_teeth = 0;  ///< z1
  T speed_m_s{};         ///< v: pitch circle
  T module_m{};          ///< m
  /// R_λ [K m²/W]: 0 open, 0.015 to 0.045 partly open, 0.06 closed (source as heat_transfer()).
  double housing_resistance = 0.0;
  double housing_surface_m2 = 1.0;  ///< A_G
  double duty = 1.0;                ///< ED: share of the time at work
};
/// Tooth temperature.
///
///   ϑ = ϑ0 + (P_loss k_ϑ/(b z1 (v m)^0.75) + P_G R_λ/A_G) ED^0.64     b, m in mm, v in m/s
///
/// Source: VDI 2736-2 eq. 9 by tkuhn39/semesterthesis, for one mesh (P_G = P_loss); k_ϑ of
/// heat_transfer(), 0 where the source states none.  At rest only the housing is warm.
/// @returns ϑ [K]
/// @throws std::invalid_argument when b, m or A_G is not positive, or P_loss, v, k_ϑ, R_λ or ED
/// negative
template <class T>
T tooth_temperature(const ToothHeat<T>& heat, double transfer_coefficient);

/// Root stress of a plastic tooth: the load at the tip.
///
///   σ_F = K_F F_t/(b m) Y_Fa Y_Sa Y_ε,  Y_ε = 0.25 + 0.75/ε,  K_F = K_A K_γ
///
/// Below ε = 1, where no pair shares the load, Y_ε is held at 1.
/// Source: VDI 2736-2 eq. 10 by tkuhn39/semesterthesis.
template <class T>
struct PlasticRootStress {
  RootForm<T> form;          ///< Y_Fa, Y_Sa
  T contact_ratio_factor{};  ///< Y_ε
  T stress_Pa{};             ///< σ_F
};
/// @throws std::invalid_argument when b is not positive or F_t negative
template <class T>
PlasticRootStress<T> plastic_root_stress(const geometry::GearGeometry<T>& gear,
                                         const RootSection<T>& section, const T& contact_ratio,
                                         const ToothLoad<T>& load, const T& load_factor);

/// S_F = 2 σ_Flim/σ_F (Y_ST = 2), to be at least 2; S_H = σ_Hlim/σ_H with Z_B = 1, to be at least
/// 1.4.  Source: VDI 2736-2 eqs. 13, 17 by tkuhn39/semesterthesis.
inline constexpr double kPlasticRootSafety = 2.0;
inline constexpr double kPlasticFlankSafety = 1.4;
inline constexpr double kPlasticStressCorrection = 2.0;  ///< Y_ST
template <class T>
T plastic_root_safety(const T& limit_Pa, const T& stress_Pa) {
  return kPlasticStressCorrection * limit_Pa / stress_Pa;
}
template <class T>
T plastic_flank_safety(const T& limit_Pa, const T& stress_Pa) {
  return limit_Pa / stress_Pa;
}

/// What wears a flank.
template <class T>
struct FlankWear {
  T torque_Nm{};                       ///< T of the gear
  T revolutions{};                     ///< N of the gear: load cycles of one of its teeth
  T loss_factor{};                     ///< H_V = P_loss/(μ P)
  double wear_coefficient_m2_N = 0.0;  ///< k_w; 1 mm³/(N m) = 1e-9 m²/N
  T face_width_m{};                    ///< b
  int teeth = 0;                       ///< z
  T flank_length_m{};                  ///< l_Fl, active_flank_length()
};
/// Mean linear wear W = 2π T N H_V k_w/(b z l_Fl), to be at most 0.1 m.
/// Source: VDI 2736-2 eq. 19 by tkuhn39/semesterthesis.
/// @returns W [m]
/// @throws std::invalid_argument when b, z or l_Fl is not positive
template <class T>
T linear_wear(const FlankWear<T>& wear);
inline constexpr double kGreatestWear_modules = 0.1;

/// Length of the active flank, from the tip to where the mate's tip ends the contact.
///
///   l_Fl = |r_a² − r_Nf²|/(2 rb) = |ρ_a² − ρ_Nf²|/(2 rb)
///
/// Source: VDI 2736-2 eq. 20 by tkuhn39/semesterthesis; length of an involute.
/// @returns [m]
/// @param active_root_length_m  ρ_Nf: geometry::active_root_length()
template <class T>
T active_flank_length(const geometry::GearGeometry<T>& gear, const T& active_root_length_m);

/// Tooth deformation λ = 7.5 F_t/b (1/E1 + 1/E2).
/// Source: VDI 2736-2 eq. 22 by tkuhn39/semesterthesis.
/// @returns [m]
/// @throws std::invalid_argument when b or a modulus is not positive
template <class T>
T tooth_deformation(const ToothLoad<T>& load, double youngs_modulus1_Pa, double youngs_modulus2_Pa);

/// Safety against the peak of the load: 2 σ_S/σ_F,max, to be at least 1.5, σ_S the yield strength.
/// Source: VDI 2736-2 eq. 24 by tkuhn39/semesterthesis.
inline constexpr double kPlasticPeakSafety = 1.5;
template <class T>
T plastic_peak_safety(double yield_strength_Pa, const T& peak_stress_Pa) {
  return kPlasticStressCorrection * yield_strength_Pa / peak_stress_Pa;
}

}  // namespace gear3k::strength
