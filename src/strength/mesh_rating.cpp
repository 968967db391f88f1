#include "strength/mesh_rating.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/interference.hpp"
#include "strength/life_factor.hpp"

namespace gear3k::strength {

namespace {

template <class T>
Factor<T> input_factor(double value) {
  return {.value = constant<T>(value), .branch = "stated", .source = sources::kInput};
}
template <class T>
Factor<T> unstated_factor(std::string_view branch) {
  return {.branch = branch, .source = sources::kNotStated};
}
template <class T>
Factor<T> plastic_factor() {
  return {.branch = "plastics: K = K_A K_gamma", .source = sources::kVdi2736};
}

bool any_plastic(const GearMaterial& material1, const GearMaterial& material2) {
  return is_plastic(material1.record.group) || is_plastic(material2.record.group);
}

/// What both teeth of a mesh have in common.
template <class T>
struct SharedMesh {
  const std::array<const RatedGear<T>*, 2>& gears;
  const geometry::MeshGeometry<T>& mesh;
  const MeshDuty<T>& duty;
  const RatingTask& task;
};

template <class T>
LoadedMesh<T> loaded_mesh(const SharedMesh<T>& m, const T& tangential_N) {
  const int z1 = m.gears[0]->gear.gear.teeth;
  const int z2 = m.gears[1]->gear.gear.teeth;
  const int pinion = std::min(z1, z2);
  return {.tangential_N = tangential_N,
          .face_width_m = m.duty.face_width_m,
          .application_factor = m.task.factors.application.value_or(1.0),
          .contact_ratio = m.mesh.contact_ratio,
          .pinion_teeth = pinion,
          .tooth_ratio = static_cast<double>(std::max(z1, z2)) / pinion,
          .speed_m_s = m.duty.speed_m_s};
}

/// f_pb, y and stiffness for K_α; empty without an accuracy grade or outside its formulas.
template <class T>
std::optional<TransverseDeviation<T>> transverse_deviation(const SharedMesh<T>& m,
                                                           const RatedLoadFactors<T>& factors,
                                                           const T& mesh_stiffness_Pa) {
  if (!m.task.accuracy_grade) return std::nullopt;
  using std::cos;
  double nominal_m = 0.0;
  for (const RatedGear<T>* g : m.gears) {
    const double module_m = value_of(g->gear.gear.module_m);
    const auto f_pb =
        base_pitch_deviation(module_m, 2.0 * value_of(g->gear.reference_radius_m),
                             value_of(g->gear.angle.alpha_rad), *m.task.accuracy_grade);
    if (!f_pb) return std::nullopt;
    nominal_m = std::max(nominal_m, *f_pb);
  }
  // f_pt comes in steps; f_pb = f_pt cos α.
  const T& alpha_rad = m.gears[0]->gear.angle.alpha_rad;
  const T deviation_m = nominal_m * (cos(alpha_rad) / std::cos(value_of(alpha_rad)));
  T running_in_m = constant<T>(0.0);
  for (const RatedGear<T>* g : m.gears) {
    const auto limit =
        flank_limit<double>(g->material.record, {.hardness = g->material.hardness, .cycles = 1.0});
    running_in_m =
        running_in_m +
        0.5 * running_in_allowance(g->material.record.group,
                                   limit.stated ? std::optional(limit.stress_Pa) : std::nullopt,
                                   deviation_m);
  }
  return TransverseDeviation<T>{.base_pitch_deviation_m = deviation_m,
                                .running_in_m = running_in_m,
                                .stiffness_Pa = mesh_stiffness_Pa,
                                .dynamic_factor = factors.dynamic.value,
                                .face_load_factor = factors.flank_face.value};
}

template <class T>
RatedLoadFactors<T> load_factors_of(const SharedMesh<T>& m, const LoadedMesh<T>& loaded,
                                    const IsoStiffness<T>& iso) {
  const StatedFactors& stated = m.task.factors;
  RatedLoadFactors<T> f;
  f.application =
      stated.application ? input_factor<T>(*stated.application) : unstated_factor<T>("not stated");
  f.mesh_load = {.value = constant<T>(m.duty.mesh_load.value),
                 .branch = m.duty.mesh_load.branch,
                 .source = m.duty.mesh_load.source,
                 .in_range = m.duty.mesh_load.in_range};
  const auto stated_or = [](const std::optional<double>& value, const Factor<T>& computed) {
    return value ? input_factor<T>(*value) : computed;
  };
  if (any_plastic(m.gears[0]->material, m.gears[1]->material)) {
    f.dynamic = f.flank_face = f.root_face = f.flank_transverse = f.root_transverse =
        plastic_factor<T>();
    return f;
  }
  if (stated.dynamic) {
    f.dynamic = input_factor<T>(*stated.dynamic);
  } else if (value_of(m.duty.speed_m_s) <= 0.0) {
    f.dynamic = unstated_factor<T>("no speed stated");
  } else {
    f.dynamic = dynamic_factor(loaded, m.task.accuracy_grade);
  }
  const bool misaligned = m.task.misalignment_m > 0.0;
  f.flank_face =
      stated_or(stated.flank_face,
                misaligned && !stated.flank_face
                    ? face_load_factor(loaded, constant<T>(m.task.misalignment_m), iso.mesh_beta)
                    : unstated_factor<T>("no misalignment stated"));
  T height = constant<T>(0.0);
  for (const RatedGear<T>* g : m.gears) {
    const T own = g->gear.gear.kind == geometry::GearKind::kRing
                      ? T(g->gear.root_radius_m - g->gear.tip_radius_m)
                      : T(g->gear.tip_radius_m - g->gear.root_radius_m);
    height = larger(height, own);
  }
  f.root_face =
      stated_or(stated.root_face,
                misaligned || stated.flank_face
                    ? root_face_load_factor(f.flank_face.value, T(height / m.duty.face_width_m))
                    : unstated_factor<T>("no misalignment stated"));
  TransverseLoadFactors<T> transverse;
  if (const auto deviation = transverse_deviation(m, f, iso.mesh_alpha)) {
    transverse = transverse_load_factors(loaded, *deviation);
  } else {
    const bool graded = m.task.accuracy_grade.has_value();
    transverse.flank = unstated_factor<T>(graded ? "size outside the formulas of the grade"
                                                 : "accuracy grade not stated");
    transverse.flank.in_range = !graded;
    transverse.root = transverse.flank;
  }
  f.flank_transverse = stated_or(stated.flank_transverse, transverse.flank);
  f.root_transverse = stated_or(stated.root_transverse, transverse.root);
  return f;
}

/// A strength without a stated life: that at kUnstatedCycles with their life factor divided out.
template <class T>
void take_endurance_limit(Factor<T>& life, T& strength_Pa) {
  strength_Pa = strength_Pa / life.value;
  life = unstated_factor<T>("no life stated: endurance limit");
}
template <class T>
T temperature_of(const SharedMesh<T>& m, double transfer) {
  if (m.task.tooth_temperature_K) return constant<T>(*m.task.tooth_temperature_K);
  const int pinion = std::min(m.gears[0]->gear.gear.teeth, m.gears[1]->gear.gear.teeth);
  return tooth_temperature<T>({.ambient_K = constant<T>(m.task.ambient_K),
                               .loss_W = m.duty.loss_W,
                               .housing_loss_W = m.duty.housing_loss_W,
                               .face_width_m = m.duty.face_width_m,
                               .pinion_teeth = pinion,
                               .speed_m_s = m.duty.speed_m_s,
                               .module_m = m.gears[0]->gear.gear.module_m,
                               .housing_resistance = m.task.housing_resistance,
                               .housing_surface_m2 = m.task.housing_surface_m2,
                               .duty = m.task.duty},
                              transfer);
}

template <class T>
RootSection<T> section_of(const RatedGear<T>& g, const RatingTask& task) {
  return g.section != nullptr ? *g.section : root_section_of(g.gear, g.form, task);
}

/// Stress and safety of the root of a metal gear.
template <class T>
void rate_metal_root(const SharedMesh<T>& m, const RatedGear<T>& g, const LimitValue<T>& limit,
                     const ToothLoad<T>& load, const RatedLoadFactors<T>& f,
                     ToothRating<T>& tooth) {
  const Material& material = g.material.record;
  tooth.form = root_form(
      g.gear, section_of(g, m.task),
      load_point(g.gear, outer_single_contact(g.gear, m.mesh.base_pitch_m, m.mesh.contact_ratio)));
  tooth.rim = rim_factor(g.gear, g.rim_m);
  tooth.root = root_stress(g.gear, tooth.form, tooth.rim.value, load,
                           {.application = f.application.value,
                            .mesh_load = f.mesh_load.value,
                            .dynamic = f.dynamic.value,
                            .face = f.root_face.value,
                            .transverse = f.root_transverse.value});
  if (!limit.stated) return;
  const RootCondition<T> condition{.cycles = constant<T>(g.teeth.cycles.value_or(kUnstatedCycles)),
                                   .notch_parameter = tooth.form.notch_parameter,
                                   .module_m = g.gear.gear.module_m,
                                   .root_roughness_m = g.teeth.root_roughness_m,
                                   .loading = g.loading,
                                   .reversal = g.teeth.reversal};
  tooth.root_strength = root_strength(material, limit.stress_Pa, condition);
  if (!g.teeth.cycles) {
    take_endurance_limit(tooth.root_strength.life, tooth.root_strength.strength_Pa);
  }
  tooth.root_safety = root_safety(tooth.root_strength, tooth.root.stress_Pa);
  if (m.task.overload) {
    tooth.overload_root_safety =
        root_safety(static_root_strength(material, limit.stress_Pa, condition),
                    T(tooth.root.stress_Pa * (*m.task.overload) / f.dynamic.value));
  }
}

/// Safety of the flank of a metal gear.
template <class T>
void rate_metal_flank(const SharedMesh<T>& m, std::size_t own, const LimitValue<T>& limit,
                      const RatedLoadFactors<T>& f, ToothRating<T>& tooth) {
  const RatedGear<T>& g = *m.gears[own];
  const RatedGear<T>& mate = *m.gears[1 - own];
  const Material& material = g.material.record;
  const LimitValue<T> of_mate =
      flank_limit<T>(mate.material.record, {.hardness = mate.material.hardness,
                                            .temperature_K = constant<T>(m.task.ambient_K),
                                            .cycles = constant<T>(1.0)});
  const bool metal_mate = of_mate.stated && !is_plastic(mate.material.record.group);
  FlankCondition<T> condition{
      .cycles = constant<T>(g.teeth.cycles.value_or(kUnstatedCycles)),
      .pitting_allowed = m.task.pitting_allowed,
      .softer_limit_Pa = metal_mate ? smaller(limit.stress_Pa, of_mate.stress_Pa) : limit.stress_Pa,
      .reduced_radius_m =
          pitch_point_curvature(m.gears[0]->gear, m.gears[1]->gear, m.mesh).reduced_m,
      .speed_m_s = m.duty.speed_m_s,
      .viscosity40_m2_s = m.task.viscosity40_m2_s,
      .own_roughness_m = g.teeth.flank_roughness_m,
      .mate_roughness_m = mate.teeth.flank_roughness_m,
      .mate_group = mate.material.record.group,
      .brinell_hardness = brinell_hardness(g.material)};
  tooth.brinell = condition.brinell_hardness;
  tooth.flank_strength = flank_strength(material, limit.stress_Pa, condition);
  if (!g.teeth.cycles) {
    take_endurance_limit(tooth.flank_strength.life, tooth.flank_strength.strength_Pa);
  }
  tooth.flank_safety = flank_safety(tooth.flank_strength, tooth.flank_stress_Pa);
  if (m.task.overload) {
    using std::sqrt;
    condition.cycles = constant<T>(0.0);
    tooth.overload_flank_safety =
        flank_safety(flank_strength(material, limit.stress_Pa, condition),
                     T(tooth.flank_stress_Pa * sqrt(T(*m.task.overload / f.dynamic.value))));
  }
}

/// Root and flank of a metal gear.
template <class T>
void rate_metal(const SharedMesh<T>& m, std::size_t own, const ToothLoad<T>& load,
                const MeshRating<T>& rating, ToothRating<T>& tooth) {
  const RatedGear<T>& g = *m.gears[own];
  if (g.rim_m) tooth.rim_over_least = *g.rim_m / least_rim(g.gear);
  const ToothCondition<T> at{.hardness = g.material.hardness};
  const LimitValue<T> root = root_limit(g.material.record, at);
  const LimitValue<T> flank = flank_limit(g.material.record, at);
  tooth.root_limit_stated = root.stated;
  tooth.flank_limit_stated = flank.stated;
  tooth.limit_in_range = root.hardness_in_range && flank.hardness_in_range;
  if (g.root) rate_metal_root(m, g, root, load, rating.factors, tooth);
  tooth.flank_stress_Pa = own == 0 ? rating.flank.stress1_Pa : rating.flank.stress2_Pa;
  if (flank.stated) rate_metal_flank(m, own, flank, rating.factors, tooth);
}

/// Root, flank, temperatures and wear of a plastic gear.
template <class T>
void rate_plastic(const SharedMesh<T>& m, std::size_t own, const ToothLoad<T>& load,
                  const MeshRating<T>& rating, ToothRating<T>& tooth) {
  const RatedGear<T>& g = *m.gears[own];
  const RatedGear<T>& mate = *m.gears[1 - own];
  const Material& material = g.material.record;
  const T load_factor = rating.factors.application.value * rating.factors.mesh_load.value;
  tooth.plastic = true;
  const PlasticRootStress<T> root =
      plastic_root_stress(g.gear, section_of(g, m.task), m.mesh.contact_ratio, load, load_factor);
  tooth.form = root.form;
  tooth.rim = {.branch = "not in the method", .source = sources::kVdi2736};
  tooth.contact_ratio_factor = root.contact_ratio_factor;
  tooth.root = {.nominal_Pa = root.stress_Pa / load_factor, .stress_Pa = root.stress_Pa};
  const HeatTransfer transfer = heat_transfer(
      is_plastic(mate.material.record.group) ? PlasticMate::kPlastic : PlasticMate::kSteel);
  tooth.root_temperature_K = temperature_of(m, transfer.root);
  tooth.flank_temperature_K = temperature_of(m, transfer.flank);
  const auto limit_at = [&](bool of_root, const T& temperature_K) {
    const ToothCondition<T> at{.hardness = g.material.hardness,
                               .temperature_K = temperature_K,
                               .cycles = constant<T>(std::max(g.teeth.cycles.value_or(1.0), 1.0))};
    return of_root ? root_limit(material, at) : flank_limit(material, at);
  };
  const LimitValue<T> root_at = limit_at(true, *tooth.root_temperature_K);
  const LimitValue<T> flank_at = limit_at(false, *tooth.flank_temperature_K);
  tooth.root_limit_stated = root_at.stated;
  tooth.flank_limit_stated = flank_at.stated;
  tooth.limit_in_range = root_at.temperature_in_range && flank_at.temperature_in_range;
  tooth.flank_stress_Pa = rating.flank.pitch_point_Pa;
  const Factor<T> in_limit{.branch = "in the limit's curve", .source = sources::kVdi2736};
  if (root_at.stated) {
    RootStrength<T>& s = tooth.root_strength;
    s.life = s.notch_sensitivity = s.surface = s.size = in_limit;
    s.reversal =
        reversal_factor<T>(g.loading, g.teeth.reversal,
                           unstated_factor<T>("reversed; no source states it for plastics"));
    s.limit_Pa = root_at.stress_Pa;
    s.stress_correction = {.value = constant<T>(kPlasticStressCorrection),
                           .branch = "plastics",
                           .source = sources::kVdi2736};
    const T limit_Pa = root_at.stress_Pa * s.reversal.value;
    s.strength_Pa = kPlasticStressCorrection * limit_Pa;
    tooth.root_safety = plastic_root_safety(limit_Pa, tooth.root.stress_Pa);
  }
  if (flank_at.stated) {
    FlankStrength<T>& s = tooth.flank_strength;
    s.life = s.lubricant = s.speed = s.roughness = s.work_hardening = s.size = in_limit;
    s.limit_Pa = s.strength_Pa = flank_at.stress_Pa;
    tooth.flank_safety = plastic_flank_safety(flank_at.stress_Pa, tooth.flank_stress_Pa);
  }
  if (m.task.overload && material.yield_strength_Pa) {
    tooth.overload_root_safety = plastic_peak_safety(*material.yield_strength_Pa,
                                                     T(tooth.root.stress_Pa * (*m.task.overload)));
  }
  if (m.task.wear_coefficient_m2_N && g.wear_turns) {
    const int which = static_cast<int>(own) + 1;
    tooth.wear_m =
        linear_wear<T>({.torque_Nm = m.duty.normal_N * g.gear.base_radius_m,
                        .revolutions = constant<T>(*g.wear_turns),
                        .loss_factor = m.duty.loss_factor,
                        .wear_coefficient_m2_N = *m.task.wear_coefficient_m2_N,
                        .face_width_m = m.duty.face_width_m,
                        .teeth = g.gear.gear.teeth,
                        .flank_length_m = active_flank_length(
                            g.gear, geometry::active_root_length(m.gears[0]->gear, m.gears[1]->gear,
                                                                 m.mesh, which))});
  }
}

double least_safety(const std::optional<double>& stated, const GearMaterial& material,
                    double plastic) {
  return stated.value_or(is_plastic(material.record.group) ? plastic : 1.0);
}

}  // namespace

Elasticity elasticity_of(const GearMaterial& material) {
  const Material& record = material.record;
  if (!record.youngs_modulus_Pa || !record.poisson_ratio) {
    throw std::invalid_argument("material: Young's modulus and Poisson's ratio are to be stated");
  }
  return {.youngs_modulus_Pa = *record.youngs_modulus_Pa, .poissons_ratio = *record.poisson_ratio};
}

std::optional<double> brinell_hardness(const GearMaterial& material) {
  if (material.record.hardness_scale != HardnessScale::kBrinell) return std::nullopt;
  if (material.hardness) return material.hardness;
  if (material.record.hardness_min == material.record.hardness_max) {
    return material.record.hardness_min;
  }
  return std::nullopt;
}

StatedTeeth stated_teeth(const RatingTask& task, std::size_t gear) {
  StatedTeeth teeth = task.gear_teeth[gear];
  const auto complete = [&](auto member) {
    if (!(teeth.*member)) teeth.*member = task.teeth.*member;
  };
  complete(&StatedTeeth::root_roughness_m);
  complete(&StatedTeeth::flank_roughness_m);
  complete(&StatedTeeth::cycles);
  complete(&StatedTeeth::load_reversal);
  complete(&StatedTeeth::reversal);
  complete(&StatedTeeth::root_safety_min);
  complete(&StatedTeeth::flank_safety_min);
  return teeth;
}

bool has_life(const RatingTask& task, std::size_t gear) {
  return task.life_s || stated_teeth(task, gear).cycles;
}

bool computes_dynamic_factor(const RatingTask& task, const GearMaterial& material1,
                             const GearMaterial& material2) {
  return task.accuracy_grade && task.speed_rad_s > 0.0 && !task.factors.dynamic &&
         !any_plastic(material1, material2);
}

bool computes_stiffness_factor(const RatingTask& task, const GearMaterial& material1,
                               const GearMaterial& material2) {
  const StatedFactors& stated = task.factors;
  const bool face = task.misalignment_m > 0.0 && !stated.flank_face;
  const bool transverse =
      task.accuracy_grade && !(stated.flank_transverse && stated.root_transverse);
  return (face || transverse) && !any_plastic(material1, material2);
}

bool computes_work_hardening(const RatingTask& task, std::size_t own, std::size_t mate) {
  const GearMaterial& material = *task.material[own];
  const MaterialGroup group = material.record.group;
  const bool soft = group == MaterialGroup::kNormalised || group == MaterialGroup::kThroughHardened;
  return soft && is_surface_hardened(task.material[mate]->record.group) &&
         brinell_hardness(material) && stated_teeth(task, own).flank_roughness_m &&
         stated_teeth(task, mate).flank_roughness_m && task.viscosity40_m2_s &&
         material.record.flank_limit.law != LimitLaw::kNotStated;
}

RootLoading root_loading(const StatedTeeth& teeth, bool idler) {
  return teeth.load_reversal.value_or(true) || idler ? RootLoading::kReversed
                                                     : RootLoading::kPulsating;
}

double least_root_safety(const RatingTask& task, std::size_t gear) {
  return least_safety(stated_teeth(task, gear).root_safety_min, *task.material[gear],
                      kPlasticRootSafety);
}
double least_flank_safety(const RatingTask& task, std::size_t gear) {
  return least_safety(stated_teeth(task, gear).flank_safety_min, *task.material[gear],
                      kPlasticFlankSafety);
}

double least_overload_root_safety(const RatingTask& task, std::size_t gear) {
  return is_plastic(task.material[gear]->record.group) ? kPlasticPeakSafety
                                                       : least_root_safety(task, gear);
}

template <class T>
RootSection<T> root_section_of(const geometry::GearGeometry<T>& gear,
                               const geometry::ToothForm<T>& form, const RatingTask& task) {
  if (gear.gear.kind == geometry::GearKind::kRing && task.virtual_root_radius) {
    return virtual_rack_section(gear, *task.virtual_root_radius);
  }
  return root_section(gear, form);
}

template <class T>
MeshRating<T> rate_mesh(const RatedGear<T>& gear1, const RatedGear<T>& gear2,
                        const geometry::MeshGeometry<T>& mesh, const MeshDuty<T>& duty,
                        const RatingTask& task, StiffnessPart part) {
  const std::array<const RatedGear<T>*, 2> gears{&gear1, &gear2};
  const SharedMesh<T> shared{.gears = gears, .mesh = mesh, .duty = duty, .task = task};
  const Elasticity elastic1 = elasticity_of(gear1.material);
  const Elasticity elastic2 = elasticity_of(gear2.material);
  MeshRating<T> rating;
  rating.normal_N = duty.normal_N;
  rating.tangential_N = duty.normal_N * gear1.gear.angle.cos;
  rating.face_width_m = duty.face_width_m;
  rating.speed_m_s = duty.speed_m_s;
  rating.line_load_N_m =
      rating.tangential_N * task.factors.application.value_or(1.0) / duty.face_width_m;
  const bool needs_stiffness = computes_stiffness_factor(task, gear1.material, gear2.material);
  if (part != StiffnessPart::kFactors || needs_stiffness) {
    const IsoPair<T> pair = iso_pair(gear1.gear, gear2.gear);
    rating.iso =
        iso_stiffness(pair, mesh.contact_ratio, {.material1 = elastic1, .material2 = elastic2},
                      rating.line_load_N_m);
    rating.iso_in_range = iso_flexibility_in_range(pair) && is_of_iso_rack(gear1.gear.angle);
    if (needs_stiffness) rating.shift_sum = pair.profile_shift1 + pair.profile_shift2;
  }
  const LoadedMesh<T> loaded = loaded_mesh(shared, rating.tangential_N);
  rating.factors = load_factors_of(shared, loaded, rating.iso);
  if (computes_dynamic_factor(task, gear1.material, gear2.material)) {
    rating.dynamic_speed = dynamic_speed(loaded);
  }
  const ToothLoad<T> load{.tangential_N = rating.tangential_N, .face_width_m = duty.face_width_m};
  const RatedLoadFactors<T>& f = rating.factors;
  rating.flank = flank_stress<T>({.gear1 = gear1.gear,
                                  .gear2 = gear2.gear,
                                  .mesh = mesh,
                                  .elasticity1 = elastic1,
                                  .elasticity2 = elastic2},
                                 load,
                                 {.application = f.application.value,
                                  .mesh_load = f.mesh_load.value,
                                  .dynamic = f.dynamic.value,
                                  .face = f.flank_face.value,
                                  .transverse = f.flank_transverse.value});
  for (std::size_t i = 0; i < 2; ++i) {
    rating.teeth[i].cycles = gears[i]->teeth.cycles;
    if (is_plastic(gears[i]->material.record.group)) {
      rate_plastic(shared, i, load, rating, rating.teeth[i]);
    } else {
      rate_metal(shared, i, load, rating, rating.teeth[i]);
    }
  }
  if (any_plastic(gear1.material, gear2.material)) {
    rating.deformation_m =
        tooth_deformation(load, elastic1.youngs_modulus_Pa, elastic2.youngs_modulus_Pa);
  }
  if (part == StiffnessPart::kPath) {
    rating.mean_stiffness_Pa = mean_mesh_stiffness(
        make_elastic_mesh(gear1.gear, gear1.form, gear2.gear, gear2.form, mesh, elastic1, elastic2,
                          T(duty.normal_N / duty.face_width_m)));
  }
  return rating;
}

#define INSTANTIATE(T)                                                                          \
  template RootSection<T> root_section_of<T>(const geometry::GearGeometry<T>&,                  \
                                             const geometry::ToothForm<T>&, const RatingTask&); \
  template MeshRating<T> rate_mesh<T>(const RatedGear<T>&, const RatedGear<T>&,                 \
                                      const geometry::MeshGeometry<T>&, const MeshDuty<T>&,     \
                                      const RatingTask&, StiffnessPart);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
