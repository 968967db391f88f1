#include "optimize/refinement_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "efficiency/train_efficiency.hpp"
#include "geometry/interference.hpp"
#include "optimize/check_row.hpp"
#include "optimize/objective_value.hpp"
#include "optimize/rated_set.hpp"

namespace gear3k::optimize {

namespace {

using design::CheckId;

constexpr double kDegree_rad = std::numbers::pi / 180.0;
/// Working angles outside this range are not searched.
constexpr double kLeastAngle_rad = 1.0 * kDegree_rad;
constexpr double kGreatestAngle_rad = 65.0 * kDegree_rad;
/// Keeps ring tips off their base circles, where the tip's curvature has no derivative [modules].
constexpr double kBaseCircleClearance = 1e-6;

bool has_one_free_module(const RefinementProblem& p) {
  return has_same_module(*p.spec) && !p.fixed_module_m[0];
}

bool stage2_angle_is_variable(const RefinementProblem& p) {
  return !has_one_free_module(p) && (!p.fixed_module_m[0] || !p.fixed_module_m[1]);
}

/// Checks that the search and the choice of variables have seen to.
bool is_settled(CheckId id) {
  switch (id) {
    case CheckId::kEqualSpacing:
    case CheckId::kIdenticalPlanets:
    case CheckId::kHuntingTooth:
    case CheckId::kAllowedTeeth:
    case CheckId::kSameModule:
      return true;
    default:
      return false;
  }
}

/// Whether anything that is asked for depends on the face widths.
bool widths_matter(const Specification& spec) {
  return spec.rating || asks_for(spec, Objective::kMass) || asks_for(spec, Objective::kInertia);
}

/// Checks of what no variable changes: SetBounds has ruled out what fails them.
bool is_constant(const Specification& spec, const design::CheckInstance& check) {
  if (check.record->id == CheckId::kWall) {
    return train::kind_of(check.subject.member) == geometry::GearKind::kRing;
  }
  if (check.record->id != CheckId::kGearboxLength) return false;
  const auto& width = spec.free.face_width_m;
  return train::states_every_gear(spec.axial) || !widths_matter(spec) || (!width[0] && !width[1]);
}

void append_checks(RefinementProblem& p, int backlash_branch) {
  const design::Limits& limits = p.spec->limits;
  for (const design::CheckInstance& check :
       list_checks(limits, design::train_layout({.planets = p.candidate.planets,
                           .stage1_module_m = p.length_scale_m,
                           .cutter = p.spec->cutter,
                           .axial = p.spec->axial,
                           .bodies = bodies_of(*p.spec, least_face_widths_m(*p.spec)),
                           .rating = p.spec->rating ? &*p.spec->rating : nullptr,
                           .thermal = p.spec->thermal ? &*p.spec->thermal : nullptr}))) {
    const CheckId id = check.record->id;
    if (is_settled(id)) continue;
    const bool paper = limits.model == backlash::LostMotionModel::kPaper;
    ConstraintRow row{.check = check, .objective = std::nullopt, .name = check.record->name};
    if (id == CheckId::kOutputBacklashMin) {
      if (!has_least_lost_motion(limits)) continue;
      if (paper) row.check->subject.which = backlash_branch;
      p.rows.push_back(row);
    } else if (id == CheckId::kOutputBacklashMax && paper) {
      for (const int branch : {1, 2}) {
        row.check->subject.which = branch;
        p.rows.push_back(row);
      }
    } else {
      p.rows.push_back(row);
    }
  }
}

void append_objectives(RefinementProblem& p) {
  const auto append = [&](const ObjectiveRow& row) {
    p.rows.push_back(
        {.check = std::nullopt, .objective = row, .name = objective_record(row.objective).name});
  };
  for (const ObjectiveLimit& limit : p.spec->objective_limits) {
    if (limit.by_check) continue;
    append({.objective = limit.objective,
            .limit = limit.value,
            .branch = 0,
            .scale = objective_scale(limit.objective, *p.spec)});
  }
  if (p.spec->felt) {
    for (const FeltLimit& limit : p.spec->felt->limits) {
      p.rows.push_back({.check = std::nullopt,
                        .objective = std::nullopt,
                        .felt = limit,
                        .name = felt_record(limit.quantity).name});
    }
  }
  if (p.branch.objective > 0) {
    append({.objective = p.objective,
            .limit = std::nullopt,
            .branch = p.branch.objective,
            .scale = p.objective_scale});
  }
}

void append_module_bounds(RefinementProblem& p, int stage) {
  const auto& range = p.spec->module[static_cast<std::size_t>(stage)].range_m;
  if (!range) return;
  for (const bool at_least : {true, false}) {
    p.rows.push_back({.check = std::nullopt,
                      .objective = std::nullopt,
                      .stage = stage,
                      .bound_m = at_least ? range->min : range->max,
                      .at_least = at_least,
                      .name = stage == 0 ? "stage1_module" : "stage2_module"});
  }
}

}  // namespace

std::array<double, train::kMeshCount> tooth_sums(const train::ToothSet& z) {
  return {static_cast<double>(z.S + z.P1), static_cast<double>(z.R1 - z.P1),
          static_cast<double>(z.R2 - z.P2)};
}

train::TrainParameters<double> unrefined_train(const Specification& spec,
                                               const Candidate& candidate, double profile_shift) {
  train::TrainParameters<double> t{
      .teeth = candidate.teeth,
      .planets = candidate.planets,
      .pressure_angle_rad = spec.pressure_angle_rad,
      .center_distance_m = 0.0,
      .module_m = {least_module(spec.module[0]), least_module(spec.module[1])},
      .profile_shift = {},
      .machining_allowance = spec.machining_allowance,
      .tip_shortening = spec.tip_shortening,
      .khk_tip = spec.khk_tip,
      .rack = {},
      .cutter = spec.cutter};
  t.profile_shift.fill(profile_shift);
  t.rack.fill(spec.rack);
  return t;
}

namespace {

/// Most that a torque is raised above the stated one.
constexpr double kGreatestTorqueFactor = 1e3;

bool torque_is_variable(const Specification& spec) {
  return spec.rating &&
         (asks_for(spec, Objective::kTorqueCapacity) || asks_for(spec, Objective::kTorqueDensity));
}

void set_box(RefinementProblem& p, const Candidate& candidate) {
  p.candidate = candidate;
  const auto sums = tooth_sums(candidate.teeth);
  p.angle_mesh = sums[0] >= sums[1] ? train::kMeshSP1 : train::kMeshP1R1;
  if (!stage2_angle_is_variable(p) &&
      p.fixed_module_m[1].value_or(1.0) * sums[2] >
          p.fixed_module_m[0].value_or(1.0) * sums[static_cast<std::size_t>(p.angle_mesh)]) {
    p.angle_mesh = train::kMeshP2R2;
  }
  p.variables = stage2_angle_is_variable(p) ? kAngleB + 1 : kAngleA + 1;
  for (std::size_t k = kAngleA; k < static_cast<std::size_t>(p.variables); ++k) {
    p.lower[k] = kLeastAngle_rad;
    p.upper[k] = kGreatestAngle_rad;
  }
  const auto append = [&](const NumberRange& range) {
    const auto k = static_cast<std::size_t>(p.variables++);
    p.lower[k] = range.min;
    p.upper[k] = range.max;
    return k;
  };
  const FreeVariables& free = p.spec->free;
  p.scale = p.first_tip = p.pressure_angle = p.torque = 0;
  p.face_width = {};
  if (!p.fixed_module_m[0] && !p.fixed_module_m[1]) {
    const NumberRange& range = *p.spec->module[0].range_m;
    p.scale = append({.min = range.min / p.length_scale_m, .max = range.max / p.length_scale_m});
  }
  if (free.tip_shortening) {
    p.first_tip = append(*free.tip_shortening);
    for (int i = 1; i < train::kGearCount; ++i) append(*free.tip_shortening);
  }
  if (free.pressure_angle_rad) p.pressure_angle = append(*free.pressure_angle_rad);
  for (std::size_t stage = 0; stage < 2 && widths_matter(*p.spec); ++stage) {
    const auto& width = free.face_width_m[stage];
    if (!width || !(width->min < width->max)) continue;
    p.face_width[stage] = append({.min = width->min / width->max, .max = 1.0});
  }
  if (torque_is_variable(*p.spec)) p.torque = append({.min = 1.0, .max = kGreatestTorqueFactor});
}

RefinementProblem with_rows(const Specification& spec, int planets,
                            std::array<std::optional<double>, 2> fixed_module_m,
                            const ProblemBranch& branch) {
  RefinementProblem p;
  p.candidate.planets = planets;
  p.spec = &spec;
  p.fixed_module_m = fixed_module_m;
  p.length_scale_m = length_scale_m(spec);
  p.branch = branch;
  p.objective = first_objective(spec);
  p.objective_scale = objective_scale(p.objective, spec);
  append_checks(p, branch.backlash);
  append_objectives(p);
  if (!fixed_module_m[0] && fixed_module_m[1]) append_module_bounds(p, 0);
  if (!fixed_module_m[1] && !has_one_free_module(p)) append_module_bounds(p, 1);
  return p;
}

}  // namespace

RefinementProblem make_refinement_problem(const Specification& spec, const Candidate& candidate,
                                          std::array<std::optional<double>, 2> fixed_module_m,
                                          const ProblemBranch& branch) {
  RefinementProblem p = with_rows(spec, candidate.planets, fixed_module_m, branch);
  set_box(p, candidate);
  const auto unshifted = train::make_train_gears(unrefined_train(spec, candidate));
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const NumberRange& limits = shift_limits(spec, static_cast<int>(i));
    p.lower[i] = limits.min;
    p.upper[i] = limits.max;
    if (train::kind_of(static_cast<int>(i)) == geometry::GearKind::kRing) {
      // The tip's distance from the base circle grows with the shift, one to one.
      const double least = kBaseCircleClearance - geometry::ring_tip_above_base(unshifted[i]);
      p.lower[i] = std::min(p.upper[i], std::max(p.lower[i], least));
    }
  }
  return p;
}

RefinementProblem make_problem_rows(const Specification& spec, int planets,
                                    std::array<std::optional<double>, 2> fixed_module_m,
                                    const ProblemBranch& branch) {
  RefinementProblem p = with_rows(spec, planets, fixed_module_m, branch);
  std::erase_if(p.rows, [&](const ConstraintRow& row) {
    return row.check && (in_shift_range(spec, *row.check) || is_constant(spec, *row.check));
  });
  return p;
}

void set_teeth(RefinementProblem& problem, const Candidate& candidate, const ShiftRanges& shifts) {
  set_box(problem, candidate);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    problem.lower[i] = shifts[i].range.lo;
    problem.upper[i] = shifts[i].range.hi;
  }
}

RefinementProblem with_all_rows(const RefinementProblem& p) {
  return make_refinement_problem(*p.spec, p.candidate, p.fixed_module_m, p.branch);
}

namespace {

/// Modules and centre distance at a point.
template <class T>
void set_lengths(const RefinementProblem& p, std::span<const T> v, const T& half_cos_alpha,
                 train::TrainParameters<T>& t) {
  using std::cos;
  const auto sums = tooth_sums(p.candidate.teeth);
  const double sum_a = sums[static_cast<std::size_t>(p.angle_mesh)];
  const T cos_a = cos(v[kAngleA]);
  T& m1 = t.module_m[0];
  T& m2 = t.module_m[1];
  T& d = t.center_distance_m;
  if (!stage2_angle_is_variable(p)) {
    m1 = p.scale > 0 ? T(p.length_scale_m * v[p.scale]) : constant<T>(*p.fixed_module_m[0]);
    m2 = p.scale > 0 ? m1 : constant<T>(*p.fixed_module_m[1]);
    d = half_cos_alpha * sum_a * (p.angle_mesh == train::kMeshP2R2 ? m2 : m1) / cos_a;
    return;
  }
  const T cos_b = cos(v[kAngleB]);
  if (!p.fixed_module_m[0] && p.fixed_module_m[1]) {
    m2 = constant<T>(*p.fixed_module_m[1]);
    d = half_cos_alpha * sums[2] * m2 / cos_b;
    m1 = d * cos_a / (half_cos_alpha * sum_a);
    return;
  }
  m1 = p.fixed_module_m[0] ? constant<T>(*p.fixed_module_m[0]) : T(p.length_scale_m * v[p.scale]);
  d = half_cos_alpha * sum_a * m1 / cos_a;
  m2 = d * cos_b / (half_cos_alpha * sums[2]);
}

}  // namespace

template <class T>
train::TrainParameters<T> parameters_at(const RefinementProblem& p, std::span<const T> v) {
  using std::cos;
  const Specification& spec = *p.spec;
  const T alpha = p.pressure_angle > 0 ? v[p.pressure_angle] : constant<T>(spec.pressure_angle_rad);
  const T half_cos_alpha = 0.5 * cos(alpha);

  train::TrainParameters<T> t;
  t.teeth = p.candidate.teeth;
  t.planets = p.candidate.planets;
  t.pressure_angle_rad = alpha;
  t.khk_tip = spec.khk_tip;
  t.cutter = cutters_of(spec, p.cutter_teeth);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    t.profile_shift[i] = v[i];
    t.tip_shortening[i] =
        p.first_tip > 0 ? v[p.first_tip + i] : constant<T>(spec.tip_shortening[i]);
    t.rack[i] = {.addendum = constant<T>(spec.rack.addendum),
                 .dedendum = constant<T>(spec.rack.dedendum),
                 .root_radius = constant<T>(spec.rack.root_radius)};
  }
  set_lengths(p, v, half_cos_alpha, t);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const T& module = t.module_m[static_cast<std::size_t>(train::stage_of(static_cast<int>(i)))];
    t.machining_allowance[i] = machining_allowance(spec, i, alpha, module);
  }
  return t;
}

template <class T>
LoadAt<T> load_at(const RefinementProblem& p, std::span<const T> v) {
  const Specification& spec = *p.spec;
  LoadAt<T> load;
  for (std::size_t stage = 0; stage < 2; ++stage) {
    const std::size_t place = p.face_width[stage];
    load.face_width_m[stage] = place > 0
                                   ? T(v[place] * spec.free.face_width_m[stage]->max)
                                   : constant<T>(spec.bodies.face_width_m[stage].value_or(
                                         spec.rating ? spec.rating->face_width_m[stage] : 0.0));
  }
  const double stated = spec.rating ? spec.rating->torque_Nm : 0.0;
  load.torque_Nm = p.torque > 0 ? T(v[p.torque] * stated) : constant<T>(stated);
  return load;
}

Point point_of(const RefinementProblem& p, const train::TrainParameters<double>& train,
               const LoadAt<double>& load) {
  Point v{};
  std::ranges::copy(train.profile_shift, v.begin());
  const auto sums = tooth_sums(p.candidate.teeth);
  // The angle at which teeth of a module close a sum at the centre distance.
  const auto angle = [&](std::size_t mesh, double module_m) {
    return std::acos(0.5 * std::cos(train.pressure_angle_rad) * sums[mesh] * module_m /
                     train.center_distance_m);
  };
  v[kAngleA] = angle(static_cast<std::size_t>(p.angle_mesh),
                     train.module_m[p.angle_mesh == train::kMeshP2R2 ? 1 : 0]);
  if (stage2_angle_is_variable(p)) v[kAngleB] = angle(train::kMeshP2R2, train.module_m[1]);
  if (p.scale > 0) v[p.scale] = train.module_m[0] / p.length_scale_m;
  for (std::size_t i = 0; p.first_tip > 0 && i < train::kGearCount; ++i) {
    v[p.first_tip + i] = train.tip_shortening[i];
  }
  if (p.pressure_angle > 0) v[p.pressure_angle] = train.pressure_angle_rad;
  for (std::size_t stage = 0; stage < 2; ++stage) {
    if (p.face_width[stage] == 0) continue;
    v[p.face_width[stage]] = load.face_width_m[stage] / p.spec->free.face_width_m[stage]->max;
  }
  if (p.torque > 0) v[p.torque] = load.torque_Nm / p.spec->rating->torque_Nm;
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.variables); ++k) {
    v[k] = std::clamp(v[k], p.lower[k], p.upper[k]);
  }
  return v;
}

namespace {

bool all_finite(double x) { return std::isfinite(x); }
bool all_finite(const Jet1& x) {
  return std::isfinite(x.a) &&
         std::all_of(x.v.begin(), x.v.end(), [](double slope) { return std::isfinite(slope); });
}

}  // namespace

namespace {

/// Gears whose tooth forms a check reads.
void mark_forms(const design::CheckInstance& check, std::array<bool, train::kGearCount>& needed) {
  if (!check.record->tooth_form) return;
  if (check.record->scope == design::CheckScope::kCutRing) {
    needed[static_cast<std::size_t>(check.subject.member)] = true;
    return;
  }
  for (const int gear : train::kMeshGears[static_cast<std::size_t>(check.subject.member)]) {
    needed[static_cast<std::size_t>(gear)] = true;
  }
}

/// What of a train has to be rated for the rows and the objective that are asked for.
struct RatedParts {
  bool any = false;
  bool stiffness = false;  ///< of all meshes over their paths
  std::array<bool, train::kMeshCount> mesh{};
  std::array<std::array<bool, 2>, train::kMeshCount> roots{};
};

void mark_rated(const design::CheckInstance& check, RatedParts& parts) {
  if (!check.record->rating) return;
  parts.any = true;
  using design::CheckScope;
  const CheckScope scope = check.record->scope;
  if (scope != CheckScope::kRatedTooth && scope != CheckScope::kRatedMesh)
    return;  // forces suffice
  const auto mesh = static_cast<std::size_t>(check.subject.member);
  parts.mesh[mesh] = true;
  const CheckId id = check.record->id;
  // A flank of P1 may be worn by both its mates.
  if (id == CheckId::kToothWear) parts.mesh[train::kMeshSP1] = parts.mesh[train::kMeshP1R1] = true;
  if (id != CheckId::kRootSafety && id != CheckId::kOverloadRootSafety &&
      id != CheckId::kNotchRange) {
    return;
  }
  parts.roots[mesh][static_cast<std::size_t>(check.subject.which - 1)] = true;
}

/// Plastic gears are rated with their roots.
void complete(const strength::RatingTask& task, RatedParts& parts,
              std::array<bool, train::kGearCount>& needed) {
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    for (std::size_t i = 0; i < 2 && (parts.mesh[k] || parts.stiffness); ++i) {
      const auto gear = static_cast<std::size_t>(train::kMeshGears[k][i]);
      const bool plastic = strength::is_plastic(task.material[gear]->record.group);
      if (parts.roots[k][i] || parts.stiffness || plastic) needed[gear] = true;
    }
  }
}

/// By how much an objective reaches its limit, or one branch exceeds the other; scaled.
template <class T>
T objective_margin(const ObjectiveRow& row, const ObjectiveInput<T>& at) {
  const T value = objective_value(row.objective, at, row.branch);
  if (row.limit) return (value - *row.limit) * (sense_of(row.objective) / row.scale);
  return (value - objective_value(row.objective, at, 3 - row.branch)) / row.scale;
}

/// @param index_of  place in problem.rows of the k-th of `constraints`
template <class T, class IndexOf>
std::optional<T> evaluate_rows(const RefinementProblem& p, std::span<const T> v, IndexOf index_of,
                               std::span<T> constraints) {
  for (const T& x : v) {
    if (!std::isfinite(value_of(x))) return std::nullopt;
  }
  const Specification& spec = *p.spec;
  const auto parameters = parameters_at(p, v);
  const auto train = train::make_train_geometry(parameters);
  if (!train) return std::nullopt;
  const auto j_bn = backlash::normal_backlashes(*train);
  auto gearing = design::gearing_of(*train, j_bn, spec.limits.model);
  const LoadAt<T> load = load_at(p, v);
  std::array<bool, train::kGearCount> needed{};
  RatedParts parts;
  parts.stiffness = p.objective == Objective::kTorsionalStiffness;
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const ConstraintRow& row = p.rows[index_of(k)];
    if (row.objective && row.objective->objective == Objective::kTorsionalStiffness) {
      parts.stiffness = true;
    }
    if (!row.check) continue;
    mark_forms(*row.check, needed);
    mark_rated(*row.check, parts);
  }
  const bool rated = parts.any || parts.stiffness;
  if (rated) complete(*spec.rating, parts, needed);
  std::array<geometry::ToothForm<T>, train::kGearCount> forms;
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    if (needed[i]) forms[i] = geometry::make_tooth_form<T>(train->gears[i]);
  }
  gearing.forms = forms;
  gearing.axial = &spec.axial;
  const auto bodies = bodies_of<T>(spec, load.face_width_m);
  gearing.bodies = &bodies;
  gearing.thermal = spec.thermal ? &*spec.thermal : nullptr;
  std::optional<strength::TrainRating<T>> rating, stiffness;
  if (parts.any) {
    auto loaded = rated_train<T>(spec, *train, forms, load.face_width_m);
    if (!strength::has_rims(loaded, *spec.rating)) return std::nullopt;
    loaded.rated = parts.mesh;
    loaded.roots = parts.roots;
    rating = strength::rate_train(loaded, *spec.rating, strength::Drive::kEither, load.torque_Nm,
                                  strength::StiffnessPart::kFactors);
    gearing.rating = rating->mesh;
    gearing.train_rating = &*rating;
  }
  if (parts.stiffness) {
    auto loaded = rated_train<T>(spec, *train, forms, load.face_width_m);
    if (!strength::has_rims(loaded, *spec.rating)) return std::nullopt;
    loaded.roots = {};
    stiffness =
        strength::rate_train(loaded, *spec.rating, strength::Drive::kForward,
                             constant<T>(spec.rating->torque_Nm), strength::StiffnessPart::kPath);
    if (!stiffness->stiffness) return std::nullopt;
  }
  const ObjectiveInput<T> at{.spec = spec,
                             .train = *train,
                             .normal_backlash_m = j_bn,
                             .face_width_m = load.face_width_m,
                             .torque_Nm = load.torque_Nm,
                             .rating = stiffness ? &*stiffness : nullptr};
  const T objective = objective_value(p.objective, at, p.branch.objective) *
                      (-sense_of(p.objective) / p.objective_scale);
  bool finite = all_finite(objective);
  std::optional<FeltGearbox<T>> felt;
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const ConstraintRow& row = p.rows[index_of(k)];
    if (row.check) {
      constraints[k] = constraint_of(*row.check, gearing);
    } else if (row.objective) {
      constraints[k] = objective_margin(*row.objective, at);
    } else if (row.felt) {
      if (!felt) felt = felt_gearbox(at);
      constraints[k] = felt_margin(*spec.felt, *row.felt, *felt);
    } else {
      const T& module = parameters.module_m[static_cast<std::size_t>(row.stage)];
      constraints[k] =
          (row.at_least ? T(module - row.bound_m) : T(row.bound_m - module)) / p.length_scale_m;
    }
    finite = finite && all_finite(constraints[k]);
  }
  if (!finite) return std::nullopt;
  return objective;
}

}  // namespace

template <class T>
std::optional<T> evaluate(const RefinementProblem& p, std::span<const T> v,
                          std::span<T> constraints) {
  return evaluate_rows<T>(
      p, v, [](std::size_t k) { return k; }, constraints);
}

template <class T>
std::optional<T> evaluate(const RefinementProblem& p, std::span<const T> v,
                          std::span<const std::uint16_t> selection, std::span<T> constraints) {
  return evaluate_rows<T>(
      p, v, [&](std::size_t k) { return std::size_t{selection[k]}; }, constraints);
}

double worst_violation(std::span<const double> constraints) {
  double worst = 0.0;
  for (const double g : constraints) {
    if (std::isnan(g)) return std::numeric_limits<double>::infinity();
    worst = std::max(worst, -g);
  }
  return worst;
}

#define INSTANTIATE(T)                                                                \
  template train::TrainParameters<T> parameters_at<T>(const RefinementProblem&,       \
                                                      std::span<const T>);            \
  template LoadAt<T> load_at<T>(const RefinementProblem&, std::span<const T>);        \
  template std::optional<T> evaluate<T>(const RefinementProblem&, std::span<const T>, \
                                        std::span<T>);                                \
  template std::optional<T> evaluate<T>(const RefinementProblem&, std::span<const T>, \
                                        std::span<const std::uint16_t>, std::span<T>);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::optimize
