#include "design/rated_gearbox.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gear3k::design {

namespace {

bool has_shaft_losses(const ShaftLosses<double>& losses) {
  return losses.planet_bearing_coefficient > 0.0 || losses.output_bearing_share > 0.0 ||
         losses.output_bearing_growth.share > 0.0 ||
         std::ranges::any_of(losses.drag, [](const ShaftDrag<double>& drag) {
           return drag.constant_Nm > 0.0 || drag.viscous_Nms > 0.0 || drag.quadratic_Nms2 > 0.0;
         });
}

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

/// What is stated of the heat and the wear of plastic where there is none.
void note_without_plastic(const strength::RatingTask& task, std::vector<std::string>& notes) {
  const strength::RatingTask usual;
  constexpr double kSame_K = 1e-9;  // of the way from degrees Celsius
  std::vector<std::string_view> idle;
  if (std::abs(task.ambient_K - usual.ambient_K) > kSame_K) idle.emplace_back("ambient_c");
  if (task.tooth_temperature_K) idle.emplace_back("tooth_temperature_c");
  if (task.duty != usual.duty) idle.emplace_back("duty");
  if (task.housing_surface_m2 != usual.housing_surface_m2) {
    idle.emplace_back("housing_surface_mm2");
  }
  if (task.wear_coefficient_m2_N) idle.emplace_back("wear_coefficient_mm3_nm");
  if (idle.empty()) return;
  notes.push_back(
      fmt::format("{} of [strength]: no effect, as there is no gear of plastic, in whose meshes "
                  "alone this acts",
                  fmt::join(idle, ", ")));
}

/// What a rating takes as absent though it may not be.
void note_unknown(const strength::RatingTask& task, std::vector<std::string>& notes) {
  if (!any_plastic(task.material)) {
    note_without_plastic(task, notes);
    return;
  }
  if (!(task.speed_rad_s > 0.0) && !task.tooth_temperature_K) {
    notes.emplace_back(
        "no speed is stated: the teeth of plastic are as warm as their surroundings");
  }
  const auto below = [](const std::optional<double>& stated, double source) {
    return stated && *stated < source;
  };
  bool asks_for_less = false;
  for (std::size_t gear = 0; gear < task.material.size(); ++gear) {
    const auto& material = task.material[gear];
    if (!material || !strength::is_plastic(material->record.group)) continue;
    const strength::StatedTeeth teeth = strength::stated_teeth(task, gear);
    asks_for_less = asks_for_less || below(teeth.root_safety_min, strength::kPlasticRootSafety) ||
                    below(teeth.flank_safety_min, strength::kPlasticFlankSafety);
  }
  if (asks_for_less) {
    notes.push_back(
        fmt::format("the stated least safeties hold for gears of plastic too, for which VDI 2736 "
                    "asks {:g} of the root and {:g} of the flank",
                    strength::kPlasticRootSafety, strength::kPlasticFlankSafety));
  }
  if (std::ranges::any_of(task.material, [](const auto& material) {
        return material && strength::has_life_curves(material->record);
      })) {
    notes.emplace_back(
        "limits of plastics are fitted curves: for which numbers of cycles they hold their source "
        "does not say");
  }
  const strength::StatedFactors& k = task.factors;
  if (k.dynamic || k.flank_face || k.root_face || k.flank_transverse || k.root_transverse ||
      task.misalignment_m > 0.0 || task.accuracy_grade) {
    notes.emplace_back(
        "gears of plastic are rated with K_A and K_gamma alone: k_v, k_h_beta, k_h_alpha, "
        "k_f_beta, k_f_alpha, f_beta_um and accuracy_grade do not act in their meshes");
  }
}

/// Gears without material under their root circle, where their rim is stated.
std::array<bool, train::kGearCount> gears_without_rim(const strength::RatedTrain<double>& train,
                                                      const strength::RatingTask& task) {
  std::array<bool, train::kGearCount> without{};
  if (strength::has_rims(train, task)) return without;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    strength::RatingTask one;
    one.rim_radius_m[gear] = task.rim_radius_m[gear];
    without[gear] = !strength::has_rims(train, one);
  }
  return without;
}

/// A root that is rated beside the section that its formulas are for.
void note_section(const strength::RootSection<double>& section, std::string_view gear,
                  std::vector<std::string>& notes) {
  if (!(section.chord_m > 0.0)) {
    notes.push_back(fmt::format(
        "the root of {} is not judged: undercut or fillets leave its teeth no section there",
        gear));
    return;
  }
  if (section.on_fillet) return;
  notes.push_back(fmt::format(
      "the fillet of {} has no tangent at {:.0f} deg to the tooth's axis, where Y_F and Y_S are "
      "taken: its root is rated where the fillet meets the flank",
      gear, units::from_si(section.tangent_angle_rad, units::Unit::kDegree)));
}

void note_sections(const std::array<strength::MeshRating<double>, train::kMeshCount>& meshes,
                   std::vector<std::string>& notes) {
  std::array<const strength::RootSection<double>*, train::kGearCount> sections{};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    for (const std::size_t i : {0U, 1U}) {
      sections[static_cast<std::size_t>(train::kMeshGears[k][i])] =
          &meshes[k].teeth[i].form.section;
    }
  }
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    note_section(*sections[gear], train::kGearNames[gear], notes);
  }
}

/// Y_M where nothing reads it, as no tooth that it is stated for is loaded on both flanks.
void note_reversal(const strength::RatingTask& task, const train::ToothSet& teeth,
                   std::vector<std::string>& notes) {
  const auto both_flanks = [&](std::size_t gear) {
    return strength::stated_teeth(task, gear).load_reversal.value_or(true);
  };
  if (both_flanks(train::kP1) || !(train::g2(teeth) > 1.0)) return;
  constexpr std::string_view kWhy =
      "its load does not reverse, and with G2 > 1 S and R1 load the same flank";
  if (task.gear_teeth[train::kP1].reversal) {
    notes.push_back(fmt::format("the stated Y_M of P1 is not used: {}", kWhy));
  }
  bool any = false;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) any = any || both_flanks(gear);
  if (task.teeth.reversal && !any) {
    notes.push_back(fmt::format(
        "the stated Y_M of all gears is not used: no load reverses, and of P1 {}", kWhy));
  }
}

/// Where K_γ of the tolerances is not known, and where it is above what all on one planet makes.
void note_sharing(const PlanetSharing& sharing, int planets, std::vector<std::string>& notes) {
  if (!sharing.series) {
    notes.emplace_back(
        "K_gamma of the tolerances is not known, as no gearbox that was drawn assembles or a mesh "
        "has no path of contact: neither are the stresses, safeties and capacity");
    return;
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (sharing.series->quantile[k] <= planets * (1.0 + 1e-9)) continue;
    notes.push_back(
        fmt::format("K_gamma of {} is {:.4g}, above the {} of one planet that carries all: the "
                    "deviations brace planets against each other on back flanks",
                    train::kMeshNames[k], sharing.series->quantile[k], planets));
  }
}

/// What the rating of a built gearbox takes from the drawn one.
struct DrawnLoad {
  const Design& design;
  DirectionalFriction<double> friction;
  double planet_kg = 0.0;

  [[nodiscard]] strength::RatedTrain<double> of(
      const train::TrainGeometry<double>& built,
      std::span<const geometry::ToothForm<double>> built_forms) const {
    auto train = loaded_train<double>(built, built_forms, design.rating->face_width_m, friction,
                                      design.friction.model);
    train.planet_mass_kg = planet_kg;
    return train;
  }
};

/// The rating in a corner of the tolerances, with K_γ of the drawn gearbox.
GearingRating corner_rating(const DrawnLoad& drawn,
                            const std::optional<strength::MeshLoadFactors>& mesh_load) {
  return [drawn, mesh_load](const Gearing<double>& gearing,
                            const std::array<bool, train::kMeshCount>& meshes_rated) {
    const strength::RatingTask& task = *drawn.design.rating;
    auto train = drawn.of(*gearing.train, gearing.forms);
    train.rated = meshes_rated;
    train.mesh_load = mesh_load;
    const auto without_rim = gears_without_rim(train, task);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      for (const std::size_t i : {0U, 1U}) {
        const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
        train.roots[k][i] = !without_rim[gear];
      }
    }
    return LoadedGearing{
        .rating = strength::rate_train(train, task, strength::Drive::kEither, task.torque_Nm,
                                       strength::StiffnessPart::kFactors),
        .without_rim = without_rim};
  };
}

/// Forces and masses that the rating leaves out.
void note_left_out(const Design& design, std::span<const MeshResult> meshes, bool planet_weighed,
                   std::vector<std::string>& notes) {
  if (has_shaft_losses(design.shafts)) {
    notes.emplace_back(
        "drags and friction of bearings are stated: strength takes forces of the meshes' friction "
        "alone, those of the operating point have both");
  }
  if (!std::ranges::all_of(meshes, has_friction)) {
    notes.emplace_back(
        "the friction of a mesh is not known here: strength takes its forces without losses, which "
        "neither heat nor wear");
  }
  if (design.rating->supports && design.rating->speed_rad_s > 0.0 && !planet_weighed) {
    notes.emplace_back(
        "the mass of a planet is not known: its bearings are loaded without centrifugal force");
  }
}

}  // namespace

std::optional<RatedGearbox> rate_gearbox(const Design& design,
                                         const train::TrainGeometry<double>& geometry,
                                         std::span<const geometry::ToothForm<double>> forms,
                                         std::span<const MeshResult> meshes,
                                         const std::vector<PartMass>& parts) {
  if (!design.rating) return std::nullopt;
  using strength::Drive;
  const strength::RatingTask& task = *design.rating;
  const auto planet_kg = planet_mass_kg(parts);
  const DrawnLoad drawn{.design = design,
                        .friction = force_friction(design.friction, meshes),
                        .planet_kg = planet_kg.value_or(0.0)};
  auto loaded = drawn.of(geometry, forms);
  const auto unshared = loaded;
  const auto shared = shared_mesh_load(design, unshared);
  const strength::MeshLoadFunction mesh_load =
      shared ? shared->mesh_load : strength::MeshLoadFunction{};
  if (shared) loaded.mesh_load = mesh_load(task.torque_Nm);
  const auto rated = [&](Drive drive) {
    return strength::rate_train(loaded, task, drive, task.torque_Nm,
                                strength::StiffnessPart::kPath);
  };
  RatedGearbox gearbox{
      .result = {.planet_sharing = shared ? std::optional(shared->sharing) : std::nullopt,
                 .forward = rated(Drive::kForward),
                 .backward = rated(Drive::kBackward),
                 .capacity_forward =
                     strength::train_capacity(loaded, task, Drive::kForward, mesh_load),
                 .capacity_backward =
                     strength::train_capacity(loaded, task, Drive::kBackward, mesh_load)},
      .rating = corner_rating(drawn, loaded.mesh_load),
      .notes = {}};
  if (gearbox.result.backward.locked) {
    gearbox.notes.emplace_back(
        "driven backward it locks: strength takes the forces of a held load, without losses");
  }
  note_left_out(design, meshes, planet_kg.has_value(), gearbox.notes);
  if (shared) note_sharing(shared->sharing, geometry.planets, gearbox.notes);
  note_unknown(task, gearbox.notes);
  note_sections(gearbox.result.forward.mesh, gearbox.notes);
  note_reversal(task, geometry.teeth, gearbox.notes);
  return gearbox;
}

namespace {

/// A pair as built, at a torque on its gear 1.
strength::MeshRating<double> rated_pair_at(const PairDesign& design,
                                           std::span<const geometry::GearGeometry<double>> gears,
                                           std::span<const geometry::ToothForm<double>> forms,
                                           const geometry::MeshGeometry<double>& mesh,
                                           double torque_Nm, strength::StiffnessPart part) {
  const strength::RatingTask& task = *design.rating;
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
                                       .loading = strength::root_loading(teeth, false),
                                       .rim_m = {}};
  };
  const double speed2 = task.speed_rad_s * gears[0].gear.teeth / gears[1].gear.teeth;
  const double mu = design.friction.coefficient;
  const double lost =
      1.0 - efficiency::mesh_efficiency(efficiency::contact_of(gears[0], gears[1], mesh, true),
                                        efficiency::flank_friction(design.friction, mu),
                                        design.friction.model);
  return strength::rate_mesh<double>(rated_gear(0, task.speed_rad_s), rated_gear(1, speed2), mesh,
                                     {.normal_N = torque_Nm / gears[0].base_radius_m,
                                      .face_width_m = task.face_width_m[0],
                                      .speed_m_s = task.speed_rad_s * gears[0].reference_radius_m,
                                      .loss_W = torque_Nm * task.speed_rad_s * lost,
                                      .loss_factor = mu > 0.0 ? lost / mu : 0.0,
                                      .mesh_load = strength::mesh_load_of(task, 1)},
                                     task, part);
}

}  // namespace

std::optional<RatedPair> rate_pair(const PairDesign& design,
                                   const std::array<geometry::GearGeometry<double>, 2>& gears,
                                   const std::array<geometry::ToothForm<double>, 2>& forms,
                                   const geometry::MeshGeometry<double>& mesh) {
  if (!design.rating) return std::nullopt;
  using strength::StiffnessPart;
  const strength::RatingTask& task = *design.rating;
  RatedPair pair{
      .rating = rated_pair_at(design, gears, forms, mesh, task.torque_Nm, StiffnessPart::kPath),
      .rate =
          [&design](const Gearing<double>& gearing,
                    const std::array<bool, train::kMeshCount>& /*rated*/) {
            LoadedGearing loaded;
            loaded.rating.mesh[0] =
                rated_pair_at(design, gearing.gears, gearing.forms, gearing.meshes[0],
                              design.rating->torque_Nm, StiffnessPart::kFactors);
            return loaded;
          },
      .capacity = strength::governed_capacity(
          [&](double torque_Nm) {
            strength::JudgedSafeties<double> list;
            strength::add_judged_safeties(
                rated_pair_at(design, gears, forms, mesh, torque_Nm, StiffnessPart::kIso), task, 0,
                {0, 1}, list);
            return list;
          },
          {.start_Nm = task.torque_Nm}),
      .notes = {}};
  note_unknown(task, pair.notes);
  for (const std::size_t i : {0U, 1U}) {
    note_section(pair.rating.teeth[i].form.section, i == 0 ? "1" : "2", pair.notes);
  }
  return pair;
}

}  // namespace gear3k::design
