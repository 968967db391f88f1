#pragma once
// Gear materials: elastic data and stress limits.

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "geometry/scalar.hpp"

namespace gear3k::strength {

enum class MaterialGroup {
  kNormalised,       ///< St
  kThroughHardened,  ///< V
  kCaseHardened,     ///< Eh
  kInduction,        ///< IF: flame or induction hardened
  kNitriding,        ///< NT: nitrided nitriding steel
  kNitrided,         ///< NV: nitrided through hardening steel
  kNitrocarburised,  ///< NVc
  kNodularIron,      ///< GGG, taken as perlitic or bainitic
  kBrass,
  kPom,
  kPa66,
  kPa6,
  kPa,
  kPeek,
  kPlastic  ///< any other plastic; the CSV leaves its group empty
};
/// Names of the groups in files, in the order of the enum.
inline constexpr std::array<std::string_view, 15> kMaterialGroupNames{
    "St",    "V",   "Eh",   "IF",  "NT", "NV",   "NVc",    "GGG",
    "brass", "POM", "PA66", "PA6", "PA", "PEEK", "plastic"};

/// Which of the life curves a material follows; kNone: the source states none.
enum class LifeCurve { kNone, kSteel, kNitrided, kNitrocarburised, kPlastic };
inline constexpr std::array<std::string_view, 5> kLifeCurveNames{"", "steel", "nitrided",
                                                                 "nitrocarburised", "plastic"};

enum class HardnessScale { kNone, kBrinell, kVickers, kRockwellC };
inline constexpr std::array<std::string_view, 4> kHardnessScaleNames{"", "HBW", "HV", "HRC"};

inline bool is_plastic(MaterialGroup group) { return group >= MaterialGroup::kPom; }
/// Hard skin: the mate of a soft gear whose flank it work-hardens.
inline bool is_surface_hardened(MaterialGroup group) {
  return group >= MaterialGroup::kCaseHardened && group <= MaterialGroup::kNitrocarburised;
}
inline bool is_nitrided(MaterialGroup group) {
  return group >= MaterialGroup::kNitriding && group <= MaterialGroup::kNitrocarburised;
}

/// How a stress limit is stated.
enum class LimitLaw {
  kNotStated,
  kLinear,    ///< slope h + constant, h the hardness; slope 0: one number
  kPomFlank,  ///< 36 − 0.0012 T² + (1000 − 0.025 T²) N^−0.21
  kPomRoot,   ///< 26 − 0.0025 T² + 400 N^−0.2
  kPa66Root   ///< 30 − 0.22 T + (4600 − 900 T^0.3) N^(−1/3)
};
struct StressLimit {
  LimitLaw law = LimitLaw::kNotStated;
  double slope_Pa = 0.0;     ///< kLinear: per unit of hardness
  double constant_Pa = 0.0;  ///< kLinear
};

/// A row of data/gear_materials.csv.  Nominal root limits σ_Flim are to be multiplied by Y_ST = 2.
struct Material {
  std::string_view name{};
  MaterialGroup group = MaterialGroup::kNormalised;
  HardnessScale hardness_scale = HardnessScale::kNone;
  /// Range that the row holds for; empty: the source states no hardness.
  std::optional<double> hardness_min{}, hardness_max{};
  StressLimit flank_limit{};  ///< σ_Hlim
  StressLimit root_limit{};   ///< σ_Flim
  /// Empty: the source does not state it.
  std::optional<double> youngs_modulus_Pa{}, poisson_ratio{}, density_kgm3{}, yield_strength_Pa{};
  LifeCurve life_curve = LifeCurve::kNone;
  std::string_view note{}, source{};
};

/// Every row of data/gear_materials.csv, in its order.
std::span<const Material> material_table();

/// The material of a name.  @returns nullptr where the table has none
const Material* find_material(std::string_view name);

/// Whether a material's limits are curves over load cycles and temperature.
bool has_life_curves(const Material& material);

/// What a limit depends on besides its material.
template <class T>
struct ToothCondition {
  std::optional<double> hardness{};  ///< in the material's scale; empty: the row's only value
  T temperature_K = constant<T>(293.15);
  T cycles = constant<T>(1.0);  ///< N, plastics
};

/// A stress limit and whether its law holds there.
template <class T>
struct LimitValue {
  T stress_Pa = constant<T>(0.0);
  bool stated = false;  ///< false: no limit is known, and stress_Pa is 0
  bool hardness_in_range = true;
  bool temperature_in_range = true;
};

/// Highest tooth temperature of the curves of plastics.  Source: cfernandesFEUP/GEARpie@45f9b44
/// CLASSES/MATERIAL_LIBRARY.py.
inline constexpr double kHighestPlasticTemperature_K = 120.0 + 273.15;

/// Flank limit σ_Hlim and nominal root limit σ_Flim [Pa] of a material.
///
/// Steels: linear in hardness; ISO 6336-5:2016 table 1.  Plastics: LimitLaw, T tooth temperature in
/// °C, N load cycles, N/mm².  The value of a law stands outside its range, which is reported; below
/// 0 °C plastics keep the value of 0 °C.  A curve that has fallen below 0 stands as it is: no load
/// is safe.
/// Sources: Material::source, row by row.
/// @throws std::invalid_argument when a law needs a hardness and none is given or implied, or for
/// plastics when N < 1, or anything is NaN
template <class T>
LimitValue<T> flank_limit(const Material& material, const ToothCondition<T>& condition);
template <class T>
LimitValue<T> root_limit(const Material& material, const ToothCondition<T>& condition);

}  // namespace gear3k::strength
