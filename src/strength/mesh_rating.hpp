#pragma once
// One mesh under load: every factor, stress and safety.

#include <array>
#include <optional>

#include "geometry/mesh.hpp"
#include "strength/flank_strength.hpp"
#include "strength/flank_stress.hpp"
#include "strength/mesh_stiffness.hpp"
#include "strength/plastic_gear.hpp"
#include "strength/rating_task.hpp"
#include "strength/root_strength.hpp"
#include "strength/root_stress.hpp"

namespace gear3k::strength {

/// A gear in the mesh that is rated.
template <class T>
struct RatedGear {
  const geometry::GearGeometry<T>& gear;
  /// Read by roots that are rated, of plastics all, without `section`, and by StiffnessPart::kPath.
  const geometry::ToothForm<T>& form;
  const GearMaterial& material;
  StatedTeeth teeth{};                 ///< cycles: N, of a stated life too
  std::optional<double> wear_turns{};  ///< meetings of a tooth with this mate; empty: not stated
  RootLoading loading = RootLoading::kPulsating;
  std::optional<T> rim_m{};  ///< material under the root circle
  bool root = true;          ///< of metals: whether the root is rated
  /// As root_section_of(gear, form, task) has it, where that is known already.
  const RootSection<T>* section = nullptr;
};

/// The rated section of a gear: of its tool, or of the virtual rack that a task states for rings.
template <class T>
RootSection<T> root_section_of(const geometry::GearGeometry<T>& gear,
                               const geometry::ToothForm<T>& form, const RatingTask& task);

/// What a mesh transmits, of one planet.
template <class T>
struct MeshDuty {
  T normal_N{};                       ///< F
  T face_width_m{};                   ///< b
  T speed_m_s{};                      ///< v: reference circles, carrier frame; 0: not stated
  T loss_W{};                         ///< friction power; heats plastics
  std::optional<T> housing_loss_W{};  ///< of the whole gearbox; empty: loss_W
  T loss_factor{};                    ///< H_V = P_loss/(μ P); wears plastics
  Factor<double> mesh_load{};         ///< K_γ
};

/// Load factors of a mesh with where they come from.
template <class T>
struct RatedLoadFactors {
  Factor<T> application, mesh_load, dynamic, flank_face, root_face, flank_transverse,
      root_transverse;
};

/// One tooth of a mesh: metals by ISO 6336, plastics by VDI 2736.
template <class T>
struct ToothRating {
  bool plastic = false;
  std::optional<double> cycles{};  ///< N; empty: not stated
  RootForm<T> form;
  Factor<T> rim;
  std::optional<T> rim_over_least{};  ///< where a rim is stated: over the range of Y_B
  RootStress<T> root;
  RootStrength<T> root_strength;
  T root_safety{};                 ///< S_F
  bool root_limit_stated = false;  ///< else S_F is 0 and not judged
  T flank_stress_Pa{};             ///< σ_H of this gear
  FlankStrength<T> flank_strength;
  T flank_safety{};  ///< S_H
  bool flank_limit_stated = false;
  bool limit_in_range = true;  ///< hardness and temperature
  std::optional<T> overload_root_safety{}, overload_flank_safety{};
  // Plastics.
  std::optional<T> root_temperature_K{}, flank_temperature_K{};
  std::optional<T> wear_m{};
  std::optional<T> contact_ratio_factor{};  ///< Y_ε
  std::optional<double> brinell{};          ///< HB of a metal, where it is known
};

template <class T>
struct MeshRating {
  T normal_N{};
  T tangential_N{};  ///< F_t, reference circle
  T face_width_m{};
  T speed_m_s{};
  T line_load_N_m{};  ///< w = F_t K_A/b
  RatedLoadFactors<T> factors;
  FlankStress<T> flank;
  IsoStiffness<T> iso;  ///< c', c_γα, c_γβ
  bool iso_in_range = true;
  /// k̄ over the path, per face width; empty where it was not asked for.
  std::optional<T> mean_stiffness_Pa{};
  std::optional<T> deformation_m{};  ///< λ, with a plastic gear
  std::optional<T> dynamic_speed{};  ///< V of K_v, where it is computed
  std::optional<T> shift_sum{};  ///< x1 + x2, of a ring −x2, where a factor is computed from c'
  std::array<ToothRating<T>, 2> teeth;
};

/// Which stiffnesses are wanted: kFactors those of ISO 6336 where a load factor needs them, kIso
/// those of ISO 6336, kPath the mean over the path too, the costly part.
enum class StiffnessPart { kFactors, kIso, kPath };

/// Rates both teeth of a mesh.
///
/// Metals by ISO 6336 method B, plastics by VDI 2736 with K = K_A K_γ.  The stress of a flank is
/// judged with the gear's own limit; lubrication coefficients are those of the softer gear.
/// Source: docs/theory §41-§45.
/// @throws std::invalid_argument for a face width or torque that is not positive, materials without
///   elastic constants, and as the parts
template <class T>
MeshRating<T> rate_mesh(const RatedGear<T>& gear1, const RatedGear<T>& gear2,
                        const geometry::MeshGeometry<T>& mesh, const MeshDuty<T>& duty,
                        const RatingTask& task, StiffnessPart part);

/// Whether K_v is computed, by dynamic_factor(): MeshRating::dynamic_speed is then set.
bool computes_dynamic_factor(const RatingTask& task, const GearMaterial& material1,
                             const GearMaterial& material2);

/// Whether a load factor is computed from c', which is stated for x1 + x2 from −0.5 to 2.
bool computes_stiffness_factor(const RatingTask& task, const GearMaterial& material1,
                               const GearMaterial& material2);
/// Whether Z_W of a gear is computed, which is stated for 130 to 470 HB.
/// @param own,mate  places of the gears in the task
bool computes_work_hardening(const RatingTask& task, std::size_t own, std::size_t mate);

/// On both flanks where the joint works both ways, as it does unless stated, and of idlers.
RootLoading root_loading(const StatedTeeth& teeth, bool idler);

/// Least safeties that are asked for of a gear with a material.
/// @param gear  its place in the task
double least_root_safety(const RatingTask& task, std::size_t gear);
double least_flank_safety(const RatingTask& task, std::size_t gear);
/// Of plastics kPlasticPeakSafety; of metals that of the root, and under overload the flank has its
/// own too.
double least_overload_root_safety(const RatingTask& task, std::size_t gear);

}  // namespace gear3k::strength
