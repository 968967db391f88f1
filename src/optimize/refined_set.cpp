#include "optimize/refined_set.hpp"

#include <fmt/format.h>

#include <limits>

#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

train::TrainParameters<double> train_of(const Specification& spec, const RefinedSet& set) {
  train::TrainParameters<double> train =
      unrefined_train(spec, set.candidate, {.profile_shift = 0.0});
  train.profile_shift = set.train.profile_shift;
  train.module_m = set.train.module_m;
  train.center_distance_m = set.train.center_distance_m;
  return train;
}

design::Design design_of(const Specification& spec, const RefinedSet& set) {
  const auto& z = set.candidate.teeth;
  design::Design design;
  design.name = fmt::format("{}{}/{}/{}/{}/{}", spec.name.empty() ? "" : spec.name + " ", z.S, z.P1,
                            z.R1, z.P2, z.R2);
  design.train = train_of(spec, set);
  design.center_distance_given = true;
  design.friction = spec.friction;
  design.friction.extension = {};
  design.axial = spec.axial;
  design.limits = spec.limits;
  return design;
}

double objective_of(const RefinedSet& set, Objective objective) {
  return objective == Objective::kForwardEfficiency ? set.eta_f : set.eta_b;
}

bool judged_by_model(const Specification& spec) {
  return spec.model.has_value() && spec.operating_point.has_value();
}

double judged_objective(const Specification& spec, const RefinedSet& set) {
  if (!judged_by_model(spec)) return objective_of(set, spec.objective);
  const auto& eta =
      spec.objective == Objective::kForwardEfficiency ? set.eta_f_model : set.eta_b_model;
  return eta.value_or(-std::numeric_limits<double>::infinity());
}

}  // namespace gear3k::optimize
