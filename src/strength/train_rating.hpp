#pragma once
// A whole 3K train under load: three meshes, six teeth, planets, stiffness, capacity.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "strength/governing.hpp"
#include "strength/load_cycles.hpp"
#include "strength/mesh_forces.hpp"
#include "strength/mesh_rating.hpp"
#include "strength/planet_loads.hpp"
#include "strength/train_stiffness.hpp"
#include "train/train_geometry.hpp"

namespace gear3k::strength {

/// Where the drive comes from.
enum class Drive {
  kForward,
  kBackward,
  kEither  ///< of every quantity the direction that is worse
};
inline constexpr std::array<std::string_view, 3> kDriveNames{"forward", "backward", "either"};

/// Efficiencies of the meshes by driver, in a drive direction.
template <class T>
using MeshDriverEfficiencies = std::array<train::DriverEfficiencies<T>, train::kMeshCount>;

/// Places along a planet's axis; its mass acts between the toothings.
template <class T>
PlanetAxis<T> planet_axis(const PlanetSupports& supports);

/// K_γ of each mesh.
using MeshLoadFactors = std::array<Factor<double>, train::kMeshCount>;
/// K_γ at an output torque.
using MeshLoadFunction = std::function<MeshLoadFactors(double torque_Nm)>;

/// The train that is rated; refers to its parts.
template <class T>
struct RatedTrain {
  const train::TrainGeometry<T>& geometry;
  std::span<const geometry::ToothForm<T>> forms;
  std::array<T, 2> face_width_m{};
  std::array<MeshDriverEfficiencies<T>, 2> efficiency{};  ///< by Drive
  /// μ by Drive and mesh, for H_V; 0: not known, no wear.
  std::array<std::array<T, train::kMeshCount>, 2> friction{};
  T planet_mass_kg = constant<T>(0.0);  ///< of a planet, for its centrifugal force
  /// K_γ at the torque of the rating, which MeshLoadSource::kTolerances wants; empty:
  /// mesh_load_of().
  std::optional<MeshLoadFactors> mesh_load{};
  /// Meshes that are rated; of the others a rating has the forces alone.
  std::array<bool, train::kMeshCount> rated{true, true, true};
  /// Whether the roots of metal gears are rated, by mesh and member.
  std::array<std::array<bool, 2>, train::kMeshCount> roots{
      {{true, true}, {true, true}, {true, true}}};
  /// Rated sections by gear, where they are known: no torque changes them.
  std::array<std::optional<RootSection<T>>, train::kGearCount> sections{};
};

/// The train with the sections of all roots that are rated, each made once.
template <class T>
RatedTrain<T> with_sections(RatedTrain<T> train, const RatingTask& task);

template <class T>
struct TrainRating {
  Drive drive = Drive::kForward;
  bool locked = false;  ///< no flow in balance: forces without losses, of a held load
  T torque_Nm{};        ///< at R2
  std::array<MeshRating<T>, train::kMeshCount> mesh;
  MeshForces<T> forces;  ///< of kEither those of the forward drive
  /// With RatingTask::supports, of kEither those of the forward drive.  Forces of the nominal
  /// torque: bearings and pin are rated without K_A and K_γ.
  std::optional<PlanetLoads<T>> planet;
  std::array<T, 2> bearing_load_N{};  ///< of A and B, with `planet`
  std::optional<T> pin_stress_Pa;
  /// StiffnessPart::kPath, where every mesh has a path of contact.
  std::optional<TrainStiffness<T>> stiffness;
  std::optional<TrainSprings<T>> springs;  ///< of that stiffness
};

/// Load cycles of a tooth of every gear; empty where no life is stated.
using TrainCycles = std::array<std::optional<double>, train::kGearCount>;
TrainCycles train_cycles(const train::ToothSet& teeth, int planets, const RatingTask& task);

/// Whether a gear is loaded on both flanks in turn whichever way the train is: P1 with G2 < 1.
bool is_idler(int gear, const train::ToothSet& teeth);

/// K_γ as the task has it for N planets; 1 where it states none.
/// @throws std::invalid_argument for MeshLoadSource::kTolerances, which the task alone does not say
Factor<double> mesh_load_of(const RatingTask& task, int planets);
/// The same by mesh: mesh_load_of(), or what the task holds of tolerances.
MeshLoadFactors mesh_loads_of(const RatingTask& task, int planets);
/// K_γ = 1 of every mesh, for what depends on the nominal forces alone: springs.
MeshLoadFactors even_mesh_loads();

/// Whether every gear has material left under its root circle, where a bore or an outer surface is
/// stated: else rate_train() has nothing to rate.
template <class T>
bool has_rims(const RatedTrain<T>& train, const RatingTask& task);

/// Rates the train at an output torque.
/// @throws std::invalid_argument for a torque below 0, for MeshLoadSource::kTolerances without
///   `mesh_load`, and as rate_mesh()
template <class T>
TrainRating<T> rate_train(const RatedTrain<T>& train, const RatingTask& task, Drive drive,
                          const T& torque_Nm, StiffnessPart part);

/// Greatest torque at which every safety is reached, in a drive direction; empty where none is
/// judged.
/// @param mesh_load  K_γ at any torque, in place of train.mesh_load; may fall and rise with the
///   torque.  Then the capacity is that below which no torque as far as scanned falls short
///   (CapacityOptions::scanned_octaves); of the slopes K_γ counts as a number.
template <class T>
std::optional<Capacity<T>> train_capacity(const RatedTrain<T>& train, const RatingTask& task,
                                          Drive drive, const MeshLoadFunction& mesh_load = {});

/// A capacity with the drive direction that it belongs to.
struct DrivenCapacity {
  Capacity<double> capacity;
  Drive drive = Drive::kForward;
};
/// The smaller one; empty unless both are known.
std::optional<DrivenCapacity> least_capacity(const std::optional<Capacity<double>>& forward,
                                             const std::optional<Capacity<double>>& backward);

}  // namespace gear3k::strength
