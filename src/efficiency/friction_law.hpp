#pragma once
// How the coefficient of friction of a mesh depends on load, speed and lubricant.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "efficiency/friction_extension.hpp"
#include "efficiency/mesh_loss.hpp"

namespace gear3k::efficiency {

enum class FrictionLaw {
  kConstant,   ///< μ
  kLoadPower,  ///< μ (F/F_0)^n
  kStribeck,   ///< falls with sliding speed from a static to the running value
  kSchlenk,    ///< ISO/TR 14179-2: load, speed, viscosity, roughness
  kTable       ///< measured, over sliding speed and tooth force
};
inline constexpr std::array<std::string_view, 5> kFrictionLawNames{"constant", "load_power",
                                                                   "stribeck", "schlenk", "table"};

/// Greatest value that a law may return (without slope there), so that a small load or speed cannot
/// leave the range of Coulomb friction.
inline constexpr double kGreatestFriction = 1.0;

/// Below these kSchlenk extrapolates, friction_coefficient(): normal force over face width, sum of
/// the flanks' speeds at the pitch point.
inline constexpr double kSchlenkLeastLineLoad_N_m = 100e3;
inline constexpr double kSchlenkLeastSumSpeed_m_s = 1.0;

/// Kinematic viscosity at two temperatures, and density.
template <class T>
struct Lubricant {
  std::array<T, 2> temperature_K{};
  std::array<T, 2> viscosity_m2_s{};
  T density_kgm3{};
};

/// Dynamic viscosity of a mineral or synthetic oil at a temperature.
///
///   η = ρ ν,  lg lg (ν + 0.8) = K − m lg T      (ν in mm²/s, T in kelvin; K, m from two points)
///
/// Source: DIN 51563 (Ubbelohde-Walther, constant 0.8), as used in a published gearbox loss
/// calculation, docs/theory §25.  The density is taken as constant.
/// Accuracy: between the two points and near them; by the constant 0.7 of ASTM D341 in place of 0.8
/// it differs by less than 1 % there (docs/theory §25).
/// @throws std::invalid_argument unless all temperatures are above 0 K, the two of the oil differ,
/// and its viscosities are above 0.2 mm²/s
/// @returns η [Pa s]
template <class T>
T dynamic_viscosity(const Lubricant<T>& oil, const T& temperature_K);

/// Measured friction: linear between the points, constant beyond the first and the last.
struct FrictionTable {
  std::vector<double> sliding_speed_m_s;  ///< rising, at least one
  std::vector<double> tooth_force_N;      ///< rising; empty: μ does not depend on it
  std::vector<double> coefficient;        ///< [force][speed], one row after the other
};

/// Friction of the meshes as a user describes it.
template <class T>
struct Friction {
  T coefficient = constant<T>(0.1);  ///< μ; of kStribeck the running value
  LossModel model = LossModel::kSliding;
  T approach_factor = constant<T>(1.0), recess_factor = constant<T>(1.0);  ///< kDirectional
  FrictionLaw law = FrictionLaw::kConstant;
  T load_exponent{};                       ///< n of kLoadPower
  T reference_force_N{};                   ///< F_0 of kLoadPower
  T static_coefficient{};                  ///< μ_s of kStribeck
  T stribeck_speed_m_s{};                  ///< v_s of kStribeck
  T stribeck_exponent = constant<T>(1.0);  ///< δ of kStribeck
  T viscous_s_m{};                         ///< k of kStribeck
  T roughness_m{};                         ///< mean Ra of both flanks, kSchlenk
  T lubricant_factor{};                    ///< X_L of kSchlenk
  Lubricant<T> lubricant{};                ///< kSchlenk
  FrictionTable table{};                   ///< kTable
  FrictionExtension<T> extension{};        ///< of a calibrated model, with any law
};

/// The flanks' friction for a coefficient that a law gave.
template <class T>
FlankFriction<T> flank_friction(const Friction<T>& friction, const T& coefficient) {
  return {.coefficient = coefficient,
          .approach_factor = friction.approach_factor * friction.extension.approach,
          .recess_factor = friction.recess_factor * friction.extension.recess};
}

/// The same for FrictionLaw::kConstant, as constants of a scalar, of a mesh as mesh_factor() has
/// it.
template <class T>
FlankFriction<T> constant_friction(const Friction<double>& friction, bool forward, bool with_ring,
                                   bool inner_drives) {
  const auto flank =
      flank_friction(friction, friction.coefficient * constant_factor(friction.extension, forward) *
                                   mesh_factor(friction.extension, with_ring, inner_drives));
  return {.coefficient = constant<T>(flank.coefficient),
          .approach_factor = constant<T>(flank.approach_factor),
          .recess_factor = constant<T>(flank.recess_factor)};
}

/// Of a mesh without and with a ring, each with the inner and the outer gear driving: what a mesh
/// of any train has is one of these.
inline std::array<FlankFriction<double>, 4> constant_frictions(const Friction<double>& friction,
                                                               bool forward) {
  std::array<FlankFriction<double>, 4> flanks;
  for (const std::size_t k : {0U, 1U, 2U, 3U}) {
    flanks[k] = constant_friction<double>(friction, forward, k >= 2, k % 2 == 0);
  }
  return flanks;
}

/// A running mesh as its friction sees it; forces and speeds are magnitudes.
template <class T>
struct MeshState {
  T normal_force_N;     ///< F_bt on the flanks of one planet's mesh, transverse, all pairs
  T sliding_speed_m_s;  ///< mean over a base pitch, docs/theory §25
  T sum_speed_m_s;      ///< of the flanks at the pitch point, v_ΣC
  T reduced_radius_m;   ///< of curvature at the pitch point, ρ_redC
  T face_width_m;
  T temperature_K;
  bool forward = true;  ///< the sun drives the train
  T ring2_torque_Nm{};  ///< that R2's teeth carry, of all planets
  T own_torque_Nm{};    ///< the same by this mesh's force, as if nothing were lost between them
};

/// Whether a law needs to know where the mesh runs, and whether it reads Friction::coefficient.
constexpr bool depends_on_state(FrictionLaw law) { return law != FrictionLaw::kConstant; }
template <class T>
bool depends_on_state(const Friction<T>& friction) {
  return depends_on_state(friction.law) || depends_on_state(friction.extension);
}
constexpr bool reads_coefficient(FrictionLaw law) {
  return law != FrictionLaw::kSchlenk && law != FrictionLaw::kTable;
}

/// Coefficient of friction of a mesh.
///
///   constant    μ
///   load_power  μ (F/F_0)^n
///   stribeck    μ + (μ_s − μ) exp(−(v/v_s)^δ) + k v
///   schlenk     0.048 (F_bt/b/(v_ΣC ρ_redC))^0.2 η^−0.05 Ra^0.25 X_L
///               (N/mm, m/s, mm, mPa s, µm)
///   table       bilinear
///
/// times the factors of the extension, never above kGreatestFriction.
/// Source: load_power, stribeck: empirical forms, their constants are the user's; schlenk:
/// ISO/TR 14179-2 (Schlenk), constants as in cfernandesFEUP/Gear-Calculation, GearC/contact.py,
/// commit 02d9129, and in a second published loss calculation, docs/theory §25.
/// Valid: schlenk is a fit to industrial gears at some 100 N/mm and above 1 m/s; small and slow
/// gears extrapolate it (design/friction_range.hpp says so), and its scatter is not stated by the
/// sources.
/// @returns μ; empty where the law has none: schlenk at rest, load_power with n < 0 without load
template <class T>
std::optional<T> friction_coefficient(const Friction<T>& friction, const MeshState<T>& state);

/// The same as the law and the extension have it, also above kGreatestFriction.
template <class T>
std::optional<T> uncut_friction_coefficient(const Friction<T>& friction, const MeshState<T>& state);

/// A friction and what it has in common in all states of one temperature.
template <class T>
struct FrictionAtTemperature {
  const Friction<T>* friction;
  BentBy bent;
  T viscosity_factor, roughness_factor;  ///< η^−0.05 [mPa s], Ra^0.25 [µm]; kSchlenk
};
/// @param friction  must outlive the result
template <class T>
FrictionAtTemperature<T> friction_at(const Friction<T>& friction, const T& temperature_K);
/// @param bent  bent_by() of its extension, where many temperatures are asked for
template <class T>
FrictionAtTemperature<T> friction_at(const Friction<T>& friction, const BentBy& bent,
                                     const T& temperature_K);

/// The same to the last bit, for states of that temperature.
template <class T>
std::optional<T> friction_coefficient(const FrictionAtTemperature<T>& friction,
                                      const MeshState<T>& state);

}  // namespace gear3k::efficiency
