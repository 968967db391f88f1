#include "strength/flank_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "strength/flank_strength.hpp"
#include "strength/flank_stress.hpp"
#include "strength/mesh_rating.hpp"
#include "strength/train_rating.hpp"
#include "train/power_flow.hpp"

namespace gear3k::strength {

namespace {

/// A gear with its mate where both are best off.
struct FavouredGear {
  const GearMaterial& own;
  const GearMaterial& mate;
  const StatedTeeth& own_teeth;
  const StatedTeeth& mate_teeth;
  std::optional<double> cycles;
  double speed_m_s = 0.0;         ///< greatest v
  double reduced_radius_m = 0.0;  ///< greatest ρ_red
};

/// σ_HG where v and ρ_red are greatest: it falls with neither.
double greatest_strength_pa(const RatingTask& task, const FavouredGear& g) {
  const Material& material = g.own.record;
  if (is_plastic(material.group)) {
    // Limits fall with the temperature, and friction only heats.
    return flank_limit<double>(material,
                               {.hardness = g.own.hardness,
                                .temperature_K = task.tooth_temperature_K.value_or(task.ambient_K),
                                .cycles = g.cycles.value_or(1.0)})
        .stress_Pa;
  }
  const double limit_Pa = flank_limit<double>(material, {.hardness = g.own.hardness}).stress_Pa;
  double softer_Pa = limit_Pa;
  if (!is_plastic(g.mate.record.group)) {
    const auto of_mate = flank_limit<double>(
        g.mate.record, {.hardness = g.mate.hardness, .temperature_K = task.ambient_K});
    if (of_mate.stated) softer_Pa = std::min(softer_Pa, of_mate.stress_Pa);
  }
  const FlankStrength<double> strength =
      flank_strength<double>(material, limit_Pa,
                             {.cycles = g.cycles.value_or(0.0),
                              .pitting_allowed = task.pitting_allowed,
                              .softer_limit_Pa = softer_Pa,
                              .reduced_radius_m = g.reduced_radius_m,
                              .speed_m_s = g.speed_m_s,
                              .viscosity40_m2_s = task.viscosity40_m2_s,
                              .own_roughness_m = g.own_teeth.flank_roughness_m,
                              .mate_roughness_m = g.mate_teeth.flank_roughness_m,
                              .mate_group = g.mate.record.group,
                              .brinell_hardness = brinell_hardness(g.own)});
  return g.cycles ? strength.strength_Pa : strength.strength_Pa / strength.life.value;
}

/// v of a mesh at its greatest module.
double greatest_speed_m_s(const RatingTask& task, const FlankExtremes& extremes, std::size_t mesh) {
  const double output_rad_s = task.speed_rad_s / std::abs(train::speed_ratios(extremes.teeth).sun);
  const auto z = train::teeth_of(extremes.teeth);
  const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[mesh][0]));
  return std::abs(train::central_rolling_speeds(extremes.teeth)[mesh]) * output_rad_s * 0.5 *
         z[train::kCentralGears[mesh]] * extremes.greatest_module_m[stage];
}

}  // namespace

double least_line_force(const RatingTask& task, const FlankExtremes& extremes, std::size_t mesh) {
  const auto z = train::teeth_of(extremes.teeth);
  const double i = train::ratio(extremes.teeth);
  const std::array<double, train::kMeshCount> share{1.0 / std::abs(i), std::abs(1.0 - 1.0 / i),
                                                    1.0};
  const auto stage = static_cast<std::size_t>(train::stage_of(train::kMeshGears[mesh][0]));
  const double half_cos = 0.5 * std::cos(extremes.pressure_angle_rad);
  return task.torque_Nm * share[mesh] /
         (extremes.planets * extremes.greatest_face_width_m[stage] * half_cos *
          z[train::kCentralGears[mesh]]);
}

double least_load_factor(const RatingTask& task, const FlankExtremes& extremes, std::size_t mesh,
                         double face, double transverse) {
  const StatedFactors& stated = task.factors;
  // K_γ of tolerances is 1 and more.
  const bool unknown =
      stated.mesh_load_source == MeshLoadSource::kTolerances && !stated.held_mesh_load;
  const double mesh_load = unknown ? 1.0 : mesh_loads_of(task, extremes.planets)[mesh].value;
  const double shared = stated.application.value_or(1.0) * mesh_load;
  const bool plastic = std::ranges::any_of(train::kMeshGears[mesh], [&](int gear) {
    return is_plastic(task.material[static_cast<std::size_t>(gear)]->record.group);
  });
  if (plastic) return shared;
  return shared * stated.dynamic.value_or(1.0) * face * transverse;
}

std::array<FlankNeed, train::kMeshCount> flank_needs(const RatingTask& task,
                                                     const FlankExtremes& extremes) {
  const auto z = train::teeth_of(extremes.teeth);
  const TrainCycles cycles = train_cycles(extremes.teeth, extremes.planets, task);
  const double half_cos = 0.5 * std::cos(extremes.pressure_angle_rad);

  std::array<FlankNeed, train::kMeshCount> needs;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    if (k != train::kMeshP2R2 && !extremes.dissipative) continue;
    const auto [first, second] = train::kMeshGears[k];
    const std::array gears{static_cast<std::size_t>(first), static_cast<std::size_t>(second)};
    const auto stage = static_cast<std::size_t>(train::stage_of(first));
    const bool ring = train::kind_of(second) == geometry::GearKind::kRing;
    const double curvature = (1.0 / z[gears[0]] + (ring ? -1.0 : 1.0) / z[gears[1]]) / half_cos;
    const double module_m = extremes.greatest_module_m[stage];
    const double speed_m_s = greatest_speed_m_s(task, extremes, k);
    const double line_load = least_line_force(task, extremes, k);
    const double factor =
        least_load_factor(task, extremes, k, task.factors.flank_face.value_or(1.0),
                          task.factors.flank_transverse.value_or(1.0));
    const double elasticity = elasticity_factor(elasticity_of(*task.material[gears[0]]),
                                                elasticity_of(*task.material[gears[1]]));
    const std::array stated{stated_teeth(task, gears[0]), stated_teeth(task, gears[1])};
    for (std::size_t own = 0; own < 2; ++own) {
      const GearMaterial& material = *task.material[gears[own]];
      const bool plastic = is_plastic(material.record.group);
      if (material.record.flank_limit.law == LimitLaw::kNotStated) continue;
      if (plastic && !task.tooth_temperature_K && !extremes.dissipative) continue;
      needs[k].single_contact[own] = !plastic && !(ring && own == 1);
      const double strength_Pa = greatest_strength_pa(
          task, {.own = material,
                 .mate = *task.material[gears[1 - own]],
                 .own_teeth = stated[own],
                 .mate_teeth = stated[1 - own],
                 .cycles = cycles[gears[own]],
                 .speed_m_s = speed_m_s,
                 .reduced_radius_m = extremes.greatest_curvature[k] * module_m});
      if (!(strength_Pa > 0.0)) {
        needs[k].load_m2[own] = std::numeric_limits<double>::infinity();
        continue;
      }
      const double safety =
          std::max(0.0, least_flank_safety(task, gears[own]) - extremes.safety_slack);
      const double ratio = elasticity * safety / strength_Pa;
      needs[k].load_m2[own] = line_load * curvature * factor * ratio * ratio;
    }
  }
  return needs;
}

}  // namespace gear3k::strength
