#include "design/rated_gearbox.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gear3k::design {

namespace {

bool has_friction(const MeshResult& mesh) {
  return std::isfinite(mesh.friction_forward) && std::isfinite(mesh.friction_backward);
}

}  // namespace

DirectionalFriction<double> force_friction(const Friction& friction,
                                           std::span<const MeshResult> meshes) {
  DirectionalFriction<double> result;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto flank = [&](double coefficient) {
      return efficiency::flank_friction(friction, std::isfinite(coefficient) ? coefficient : 0.0);
    };
    result[0][k] = flank(meshes[k].friction_forward);
    result[1][k] = flank(meshes[k].friction_backward);
  }
  return result;
}

std::optional<RatedGearbox> rate_gearbox(const Design& design,
                                         const train::TrainGeometry<double>& geometry,
                                         std::span<const geometry::ToothForm<double>> forms,
                                         std::span<const MeshResult> meshes) {
  if (!design.rating) return std::nullopt;
  using strength::Drive, strength::StiffnessPart;
  const strength::RatingTask& task = *design.rating;
  const auto loaded =
      loaded_train<double>(geometry, forms, task.face_width_m,
                           force_friction(design.friction, meshes), design.friction.model);
  const auto rated = [&](Drive drive, StiffnessPart part) {
    return strength::rate_train(loaded, task, drive, task.torque_Nm, part);
  };
  RatedGearbox gearbox{
      .result = {.forward = rated(Drive::kForward, StiffnessPart::kPath),
                 .backward = rated(Drive::kBackward, StiffnessPart::kPath),
                 .capacity_forward = strength::train_capacity(loaded, task, Drive::kForward),
                 .capacity_backward = strength::train_capacity(loaded, task, Drive::kBackward)},
      .deciding = rated(Drive::kEither, StiffnessPart::kNone),
      .notes = {}};
  if (gearbox.result.backward.locked) {
    gearbox.notes.emplace_back(
        "driven backward it locks: strength takes the forces of a held load, without losses");
  }
  if (!std::ranges::all_of(meshes, has_friction)) {
    gearbox.notes.emplace_back(
        "the friction of a mesh is not known here: strength takes its forces without losses");
  }
  return gearbox;
}

std::optional<strength::MeshRating<double>> rate_pair(
    const PairDesign& design, const std::array<geometry::GearGeometry<double>, 2>& gears,
    const std::array<geometry::ToothForm<double>, 2>& forms,
    const geometry::MeshGeometry<double>& mesh, const MeshResult& result) {
  if (!design.rating) return std::nullopt;
  const strength::RatingTask& task = *design.rating;
  const double normal_N = task.torque_Nm / gears[0].base_radius_m;
  const double speed2 = task.speed_rad_s * gears[0].gear.teeth / gears[1].gear.teeth;
  const auto cycles_at = [&](double speed_rad_s) -> std::optional<double> {
    if (task.cycles) return task.cycles;
    if (!task.life_s || !(speed_rad_s > 0.0)) return std::nullopt;
    return speed_rad_s * *task.life_s / (2.0 * std::numbers::pi);
  };
  const auto rated_gear = [&](std::size_t i, double speed_rad_s) {
    return strength::RatedGear<double>{.gear = gears[i],
                                       .form = forms[i],
                                       .material = *task.material[i],
                                       .root_cycles = cycles_at(speed_rad_s),
                                       .flank_cycles = cycles_at(speed_rad_s),
                                       .loading = task.load_reversal
                                                      ? strength::RootLoading::kReversed
                                                      : strength::RootLoading::kPulsating,
                                       .rim_m = {}};
  };
  const double lost = 1.0 - result.efficiency_forward;
  const double mu = result.friction_forward;
  return strength::rate_mesh<double>(rated_gear(0, task.speed_rad_s), rated_gear(1, speed2), mesh,
                                     {.normal_N = normal_N,
                                      .face_width_m = task.face_width_m[0],
                                      .speed_m_s = task.speed_rad_s * gears[0].reference_radius_m,
                                      .loss_W = task.torque_Nm * task.speed_rad_s * lost,
                                      .loss_factor = mu > 0.0 ? lost / mu : 0.0,
                                      .mesh_load = strength::mesh_load_of(task, 1)},
                                     task, strength::StiffnessPart::kPath);
}

}  // namespace gear3k::design
