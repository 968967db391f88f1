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

namespace {

/// Of one planet; empty where a step has none.
std::optional<double> planet_mass_kg(const std::vector<PartMass>& parts) {
  const auto mass_of = [&](std::string_view name) -> std::optional<double> {
    const auto part = std::ranges::find(parts, name, &PartMass::name);
    return part == parts.end() ? std::nullopt : part->mass_kg;
  };
  if (const auto whole = mass_of("planet")) return whole;
  const auto first = mass_of("P1"), second = mass_of("P2");
  if (!first || !second) return std::nullopt;
  return *first + *second;
}

template <class Materials>
bool any_plastic(const Materials& materials) {
  return std::ranges::any_of(materials, [](const auto& material) {
    return material && strength::is_plastic(material->record.group);
  });
}

/// What a rating takes as absent though it may not be.
void note_unknown(const strength::RatingTask& task, std::vector<std::string>& notes) {
  if (!any_plastic(task.material)) return;
  if (!(task.speed_rad_s > 0.0) && !task.tooth_temperature_K) {
    notes.emplace_back(
        "no speed is stated: the teeth of plastic are as warm as their surroundings");
  }
  const strength::StatedFactors& k = task.factors;
  if (k.dynamic || k.flank_face || k.root_face || k.flank_transverse || k.root_transverse ||
      task.misalignment_m > 0.0 || task.accuracy_grade) {
    notes.emplace_back(
        "gears of plastic are rated with K_A and K_gamma alone: k_v, k_h_beta, k_h_alpha, "
        "k_f_beta, k_f_alpha, f_beta_um and accuracy_grade do not act in their meshes");
  }
}

}  // namespace

std::optional<RatedGearbox> rate_gearbox(const Design& design,
                                         const train::TrainGeometry<double>& geometry,
                                         std::span<const geometry::ToothForm<double>> forms,
                                         std::span<const MeshResult> meshes,
                                         const std::vector<PartMass>& parts) {
  if (!design.rating) return std::nullopt;
  using strength::Drive, strength::StiffnessPart;
  const strength::RatingTask& task = *design.rating;
  auto loaded =
      loaded_train<double>(geometry, forms, task.face_width_m,
                           force_friction(design.friction, meshes), design.friction.model);
  const auto planet_kg = planet_mass_kg(parts);
  loaded.planet_mass_kg = planet_kg.value_or(0.0);
  const auto rated = [&](Drive drive, StiffnessPart part) {
    return strength::rate_train(loaded, task, drive, task.torque_Nm, part);
  };
  RatedGearbox gearbox{
      .result = {.forward = rated(Drive::kForward, StiffnessPart::kPath),
                 .backward = rated(Drive::kBackward, StiffnessPart::kPath),
                 .capacity_forward = strength::train_capacity(loaded, task, Drive::kForward),
                 .capacity_backward = strength::train_capacity(loaded, task, Drive::kBackward)},
      .deciding = rated(Drive::kEither, StiffnessPart::kIso),
      .notes = {}};
  if (gearbox.result.backward.locked) {
    gearbox.notes.emplace_back(
        "driven backward it locks: strength takes the forces of a held load, without losses");
  }
  if (!std::ranges::all_of(meshes, has_friction)) {
    gearbox.notes.emplace_back(
        "the friction of a mesh is not known here: strength takes its forces without losses, which "
        "neither heat nor wear");
  }
  if (task.supports && task.speed_rad_s > 0.0 && !planet_kg) {
    gearbox.notes.emplace_back(
        "the mass of a planet is not known: its bearings are loaded without centrifugal force");
  }
  note_unknown(task, gearbox.notes);
  return gearbox;
}

std::optional<RatedPair> rate_pair(const PairDesign& design,
                                   const std::array<geometry::GearGeometry<double>, 2>& gears,
                                   const std::array<geometry::ToothForm<double>, 2>& forms,
                                   const geometry::MeshGeometry<double>& mesh,
                                   const MeshResult& result) {
  if (!design.rating) return std::nullopt;
  const strength::RatingTask& task = *design.rating;
  const double speed2 = task.speed_rad_s * gears[0].gear.teeth / gears[1].gear.teeth;
  const auto rated_gear = [&](std::size_t i, double speed_rad_s) {
    strength::StatedTeeth teeth = strength::stated_teeth(task, i);
    if (!teeth.cycles && task.life_s && speed_rad_s > 0.0) {
      teeth.cycles = speed_rad_s * *task.life_s / (2.0 * std::numbers::pi);
    }
    return strength::RatedGear<double>{.gear = gears[i],
                                       .form = forms[i],
                                       .material = *task.material[i],
                                       .teeth = teeth,
                                       .wear_turns = teeth.cycles,
                                       .loading = teeth.load_reversal.value_or(true)
                                                      ? strength::RootLoading::kReversed
                                                      : strength::RootLoading::kPulsating,
                                       .rim_m = {}};
  };
  const double lost = 1.0 - result.efficiency_forward;
  const double mu = result.friction_forward;
  const auto rated_at = [&](double torque_Nm, strength::StiffnessPart part) {
    return strength::rate_mesh<double>(rated_gear(0, task.speed_rad_s), rated_gear(1, speed2), mesh,
                                       {.normal_N = torque_Nm / gears[0].base_radius_m,
                                        .face_width_m = task.face_width_m[0],
                                        .speed_m_s = task.speed_rad_s * gears[0].reference_radius_m,
                                        .loss_W = torque_Nm * task.speed_rad_s * lost,
                                        .loss_factor = mu > 0.0 ? lost / mu : 0.0,
                                        .mesh_load = strength::mesh_load_of(task, 1)},
                                       task, part);
  };
  RatedPair pair{.rating = rated_at(task.torque_Nm, strength::StiffnessPart::kPath),
                 .capacity = strength::governed_capacity(
                     [&](double torque_Nm) {
                       strength::JudgedSafeties<double> list;
                       strength::add_judged_safeties(
                           rated_at(torque_Nm, strength::StiffnessPart::kIso), task, 0, {0, 1},
                           list);
                       return list;
                     },
                     task.torque_Nm),
                 .notes = {}};
  note_unknown(task, pair.notes);
  return pair;
}

}  // namespace gear3k::design
