#include "optimize/stage_flanks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "efficiency/friction_law.hpp"
#include "optimize/stage_tasks.hpp"
#include "strength/mesh_rating.hpp"
#include "train/tooth_set.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

/// Greatest face width of a stage [m].
double greatest_width_m(const Specification& spec, std::size_t stage) {
  const auto& range = spec.free.face_width_m[stage];
  const double stated = spec.rating->face_width_m[stage];
  return range ? std::max(range->max, stated) : spec.bodies.face_width_m[stage].value_or(stated);
}

/// Greatest module of a stage whose ring has a greatest root diameter [m].
double greatest_module_m(const Specification& spec, std::size_t stage, const StageGear& ring) {
  const double most =
      module_range(spec.module[stage]).hi + design::kFeasibilitySlack * length_scale_m(spec);
  const auto diameter = most_ring_root_diameter_m(spec);
  const double root = 0.5 * ring.teeth + ring.root_height + ring.profile_shift.lo;
  if (!diameter || !(root > 0.0)) return most;
  return std::min(most, 0.5 * *diameter * (1.0 + design::kFeasibilitySlack) / root);
}

/// ρ_red of a mesh at the pitch point at a centre distance, in modules.
double curvature_at(double distance, double base1, double base2) {
  const double sum = base1 + base2;   // of a ring mesh base1 < 0
  if (!(distance > sum)) return 1.0;  // the stage has no design
  const double tan_w = std::sqrt((distance - sum) * (distance + sum)) / sum;
  return std::abs(base1) * base2 / sum * tan_w;
}

/// Of two needs the lesser.
void take_less(strength::FlankNeed& least, const strength::FlankNeed& need) {
  for (std::size_t i = 0; i < 2; ++i) {
    least.load_m2[i] = std::min(least.load_m2[i], need.load_m2[i]);
  }
  least.single_contact = need.single_contact;
}

void take_less(strength::RootNeed& least, const strength::RootNeed& need) {
  const double load_m2 = std::min(least.load_m2, need.load_m2);
  least = need;
  least.load_m2 = load_m2;
}

/// Sections of the gears of one place by their teeth, over the shifts of all their stages.
class RootTables {
 public:
  RootTables(const Specification& spec, int gear) : spec_(spec), gear_(gear) {}
  void widen(const StageGear& gear) {
    Interval& shift = shift_.try_emplace(gear.teeth, gear.profile_shift).first->second;
    shift = {std::min(shift.lo, gear.profile_shift.lo), std::max(shift.hi, gear.profile_shift.hi)};
  }
  std::shared_ptr<const strength::RootTable> of(const StageGear& gear) {
    auto& table = table_[gear.teeth];
    const Interval& shift = shift_.at(gear.teeth);
    if (!table && !shift.empty()) {
      const auto cut = geometry::make_gear_geometry<double>(
          {.teeth = gear.teeth,
           .kind = geometry::GearKind::kExternal,
           .module_m = length_scale_m(spec_),
           .profile_shift = shift.lo,
           .machining_allowance = spec_.machining_allowance[static_cast<std::size_t>(gear_)],
           .tip_shortening = 0.0,
           .rack = spec_.rack},
          geometry::make_pressure_angle(spec_.pressure_angle_rad));
      table = std::make_shared<const strength::RootTable>(strength::make_root_table(cut, shift.hi));
    }
    return table;
  }

 private:
  const Specification& spec_;
  int gear_;
  std::map<int, Interval> shift_;
  std::map<int, std::shared_ptr<const strength::RootTable>> table_;
};

}  // namespace

bool bounds_roots(const Specification& spec) {
  return spec.rating && spec.limits[CheckId::kRootSafety] &&
         std::isfinite(least_root_safety_asked(spec));
}

double least_root_safety_asked(const Specification& spec) {
  double least = kInfinity;
  for (const int id : {train::kS, train::kP1, train::kP2}) {
    const auto gear = static_cast<std::size_t>(id);
    const auto& material = spec.rating->material[gear];
    if (!material || material->record.root_limit.law == strength::LimitLaw::kNotStated) continue;
    least = std::min(least, strength::least_root_safety(*spec.rating, gear));
  }
  return least;
}

bool bounds_flanks(const Specification& spec) {
  return spec.rating && spec.limits[CheckId::kFlankSafety] &&
         std::isfinite(least_flank_safety_asked(spec));
}

bool friction_is_dissipative(const Specification& spec) {
  using efficiency::LossModel;
  if (spec.friction.model == LossModel::kCoulombPath ||
      spec.friction.model == LossModel::kDirectional) {
    return true;
  }
  return std::ranges::all_of(std::array{true, false}, [&](bool forward) {
    const auto flanks = efficiency::constant_frictions(spec.friction, forward);
    return least_friction(spec, forward) > 0.0 || std::ranges::all_of(flanks, [](const auto& f) {
             return f.coefficient <= 0.0 || (f.approach_factor == 1.0 && f.recess_factor == 1.0);
           });
  });
}

double least_flank_safety_asked(const Specification& spec) {
  double least = kInfinity;
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    const auto& material = spec.rating->material[gear];
    if (!material || material->record.flank_limit.law == strength::LimitLaw::kNotStated) continue;
    least = std::min(least, strength::least_flank_safety(*spec.rating, gear));
  }
  return least + spec.limits[design::CheckId::kFlankSafety].value_or(0.0);
}

std::vector<StageFlanks> stage_flanks(const Specification& spec, std::size_t stage,
                                      std::span<const StageTask> tasks,
                                      std::span<const Candidate> candidates,
                                      std::span<const std::uint32_t> stage_of) {
  std::vector<StageFlanks> flanks(tasks.size());
  std::vector<std::array<double, 2>> curvature(tasks.size());  // of S-P1, of the ring's mesh
  const double half_cos = 0.5 * std::cos(spec.pressure_angle_rad);
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const StageTask& task = tasks[k];
    StageFlanks& at = flanks[k];
    if (task.sun) {
      at.sun.load_m2.fill(kInfinity);
      at.sun_root.load_m2 = at.planet_root.load_m2 = kInfinity;
    }
    at.ring.load_m2.fill(kInfinity);
    at.ring_planet_root.load_m2 = kInfinity;
    at.greatest_module_m = greatest_module_m(spec, stage, task.ring);
    const double most = center_distances(task).hi;
    const double planet = half_cos * task.planet.teeth;
    curvature[k] = {task.sun ? curvature_at(most, half_cos * task.sun->teeth, planet) : 0.0,
                    curvature_at(most, -planet, half_cos * task.ring.teeth)};
  }
  const bool dissipative = friction_is_dissipative(spec);
  const bool of_flanks = bounds_flanks(spec);
  const bool of_roots = bounds_roots(spec);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const std::size_t k = stage_of[c];
    strength::FlankExtremes extremes{
        .teeth = candidates[c].teeth,
        .planets = candidates[c].planets,
        .greatest_face_width_m = {greatest_width_m(spec, 0), greatest_width_m(spec, 1)},
        .greatest_module_m = {flanks[k].greatest_module_m, flanks[k].greatest_module_m},
        .greatest_curvature = {},
        .pressure_angle_rad = spec.pressure_angle_rad,
        .dissipative = dissipative,
        .safety_slack = design::kFeasibilitySlack};
    StageFlanks& at = flanks[k];
    std::array<strength::FlankNeed, train::kMeshCount> needs;
    std::array<std::array<strength::RootNeed, 2>, train::kMeshCount> roots;
    extremes.greatest_curvature = stage == 0 ? std::array{curvature[k][0], curvature[k][1], 1.0}
                                             : std::array{1.0, 1.0, curvature[k][1]};
    if (of_flanks) needs = strength::flank_needs(*spec.rating, extremes);
    if (of_roots) roots = strength::root_needs(*spec.rating, extremes);
    if (stage == 0) {
      take_less(at.sun, needs[train::kMeshSP1]);
      take_less(at.ring, needs[train::kMeshP1R1]);
      take_less(at.sun_root, roots[train::kMeshSP1][0]);
      take_less(at.planet_root, roots[train::kMeshSP1][1]);
      take_less(at.ring_planet_root, roots[train::kMeshP1R1][0]);
    } else {
      take_less(at.ring, needs[train::kMeshP2R2]);
      take_less(at.ring_planet_root, roots[train::kMeshP2R2][0]);
    }
  }
  if (!of_roots) return flanks;
  RootTables suns(spec, train::kS);
  RootTables planets(spec, stage == 0 ? train::kP1 : train::kP2);
  for (const StageTask& task : tasks) {
    if (task.sun) suns.widen(*task.sun);
    planets.widen(task.planet);
  }
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (tasks[k].sun) flanks[k].sun_table = suns.of(*tasks[k].sun);
    flanks[k].planet_table = planets.of(tasks[k].planet);
  }
  return flanks;
}

StageTask with_flanks(const Specification& spec, const StageTask& task, const StageFlanks& flanks) {
  StageTask loaded = task;
  loaded.sun_flank = flanks.sun;
  loaded.ring_flank = flanks.ring;
  if (bounds_flanks(spec)) loaded.flank_safety = least_flank_safety_asked(spec);
  if (bounds_roots(spec)) loaded.root_safety = least_root_safety_asked(spec);
  loaded.roots = {.sun = flanks.sun_root,
                  .planet_of_sun = flanks.planet_root,
                  .planet_of_ring = flanks.ring_planet_root,
                  .sun_table = flanks.sun_table.get(),
                  .planet_table = flanks.planet_table.get()};
  loaded.most_module_m = flanks.greatest_module_m;
  if (const auto diameter = most_ring_root_diameter_m(spec)) {
    loaded.most_root_diameter_m = *diameter * (1.0 + design::kFeasibilitySlack);
  }
  return loaded;
}

}  // namespace gear3k::optimize
