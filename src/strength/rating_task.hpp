#pragma once
// What a gearbox is to carry, for how long, and what its gears are made of.

#include <array>
#include <optional>
#include <string_view>

#include "strength/elasticity.hpp"
#include "strength/load_factors.hpp"
#include "strength/material.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::strength {

/// Material of one gear: a row of the table, or one with the user's numbers in its place.
struct GearMaterial {
  Material record{};                 ///< name "": of numbers only
  std::optional<double> hardness{};  ///< in the record's scale; empty: the row's only value
};
/// @throws std::invalid_argument where E or ν is not known
Elasticity elasticity_of(const GearMaterial& material);
/// Hardness in HB; empty where the material states none in it.
std::optional<double> brinell_hardness(const GearMaterial& material);

/// Where K_γ comes from.
enum class MeshLoadSource {
  kNumber,
  kM56,         ///< MeshLoadTable::kM56
  kDrivetrain,  ///< MeshLoadTable::kDrivetrain
  kTolerances   ///< RatedTrain::mesh_load
};
inline constexpr std::array<std::string_view, 4> kMeshLoadSourceNames{"number", "m56", "drivetrain",
                                                                      "tolerances"};

/// Load factors as stated; what is empty is computed, or 1 where nothing to compute it from is
/// stated.
struct StatedFactors {
  std::optional<double> application{};  ///< K_A
  MeshLoadSource mesh_load_source = MeshLoadSource::kNumber;
  std::optional<double> mesh_load{};  ///< K_γ, kNumber
  double mesh_load_quantile = 0.99;   ///< share of gearboxes that K_γ covers, kTolerances
  /// kTolerances: K_γ by mesh, held by a search of designs whose own it does not know.
  std::optional<std::array<double, train::kMeshCount>> held_mesh_load{};
  std::optional<double> dynamic{};                              ///< K_v
  std::optional<double> flank_face{};                           ///< K_Hβ
  std::optional<double> root_face{};                            ///< K_Fβ
  std::optional<double> flank_transverse{}, root_transverse{};  ///< K_Hα, K_Fα
};

/// What is stated of the teeth of all gears, or of one gear in its place.
struct StatedTeeth {
  std::optional<double> root_roughness_m{}, flank_roughness_m{};  ///< R_z
  std::optional<double> cycles{};       ///< N of a tooth, in place of a life
  std::optional<bool> load_reversal{};  ///< whether both flanks are loaded; empty: they are
  std::optional<double> reversal{};     ///< Y_M of teeth that are loaded on both flanks
  /// Least safeties; empty: 1, of plastics kPlasticRootSafety, kPlasticFlankSafety.
  std::optional<double> root_safety_min{}, flank_safety_min{};
};

/// Bearings of a planet on its pin.
struct PlanetSupports {
  std::array<double, 2> position_m{};     ///< of A and B along the axis, as axial.* states places
  std::array<double, 2> plane_m{};        ///< middle of the toothings P1 and P2
  std::optional<double> stiffness_N_m{};  ///< of one bearing, radial; empty: rigid
  std::optional<double> pin_stiffness_N_m{};  ///< of the pin under a bearing; empty: rigid
};

/// A load that a gearbox, or a pair, is to carry.
struct RatingTask {
  std::array<std::optional<GearMaterial>, train::kGearCount> material{};  ///< of a pair: 1 and 2
  double torque_Nm = 0.0;                ///< at R2; of a pair: on gear 1
  std::array<double, 2> face_width_m{};  ///< by stage; of a pair: the first
  /// Speed of the sun, of a pair of gear 1; 0: not stated.
  double speed_rad_s = 0.0;
  /// Time at speed_rad_s; neither it nor cycles: the endurance limit of metals.
  std::optional<double> life_s{};
  StatedTeeth teeth{};                                      ///< of all gears
  std::array<StatedTeeth, train::kGearCount> gear_teeth{};  ///< of one gear, in their place
  StatedFactors factors{};
  double misalignment_m = 0.0;          ///< F_βy
  std::optional<int> accuracy_grade{};  ///< ISO 1328
  /// ρ* of the virtual rack in place of a ring's tool, in modules; empty: the tool.
  std::optional<double> virtual_root_radius{};
  std::optional<double> overload{};  ///< peak over stated torque; empty: not rated
  std::optional<double> viscosity40_m2_s{};
  bool pitting_allowed = false;
  /// Rim under the teeth, by gear: from the root circle to bore or outer surface; empty: solid.
  std::array<std::optional<double>, train::kGearCount> rim_radius_m{};
  /// Of both rings outside their root circles, where their outer surface follows the teeth.
  std::optional<double> ring_rim_m{};
  // Plastics.
  double ambient_K = 293.15;
  std::optional<double> tooth_temperature_K{};  ///< stated instead of computed
  double duty = 1.0;
  double housing_resistance = 0.0;  ///< R_λ [K m²/W]
  double housing_surface_m2 = 1.0;
  std::optional<double> wear_coefficient_m2_N{};
  // Planets.
  std::optional<PlanetSupports> supports{};
  std::optional<double> pin_diameter_m{};
  // Torsional stiffness; empty: rigid.
  std::optional<double> planet_torsion_Nm_rad{};  ///< between P1 and P2, of one planet
  std::optional<double> sun_shaft_Nm_rad{};       ///< between the sun's teeth and the input
  std::optional<double> ring2_Nm_rad{};           ///< between R2's teeth and the output
};

/// What holds for the teeth of a gear: value by value its own, else that of all gears.
StatedTeeth stated_teeth(const RatingTask& task, std::size_t gear);
/// Whether cycles of a gear's teeth are stated, or a time.
bool has_life(const RatingTask& task, std::size_t gear);

}  // namespace gear3k::strength
