#include "optimize/zero_shift.hpp"

#include <algorithm>
#include <tuple>

#include "efficiency/train_efficiency.hpp"
#include "optimize/parallel.hpp"
#include "optimize/refinement_problem.hpp"

namespace gear3k::optimize {

namespace {

ZeroShiftSet at_zero_shift(const Specification& spec, const Candidate& candidate) {
  const train::ToothSet& z = candidate.teeth;
  const double m1 = length_scale_m(spec);
  const double d = 0.5 * m1 * (z.R1 - z.P1);
  const double m2 = 2.0 * d / (z.R2 - z.P2);
  ZeroShiftSet set{.candidate = candidate, .ratio = train::ratio(z), .module_ratio = m2 / m1};
  train::TrainParameters<double> parameters =
      unrefined_train(spec, candidate, {.profile_shift = 0.0});
  parameters.center_distance_m = d;
  parameters.module_m = {m1, m2};
  const auto train = train::make_train_geometry(parameters);
  if (!train) return set;
  set.defined = true;
  const auto j = backlash::normal_backlashes(*train);
  // At this distance P1-R1 and P2-R2 close exactly; what is left of them is rounding.
  set.meshes = *std::min_element(j.begin(), j.end()) >= -1e-9 * m1;
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    set.contact_ratio[k] = train->meshes[k].contact_ratio;
    set.meshes = set.meshes && set.contact_ratio[k] >= 1.0;
  }
  set.sun_backlash = j[0] / m1;
  set.lost_motion_rad = backlash::output_lost_motion(*train, j, spec.limits.model);
  const auto eta = [&](bool forward) {
    return efficiency::mesh_efficiencies(
        *train, efficiency::constant_friction<double>(spec.friction, forward), spec.friction.model,
        forward);
  };
  set.eta_b = efficiency::backward_efficiency(z, eta(false));
  set.eta_f = efficiency::forward_efficiency(z, eta(true));
  return set;
}

}  // namespace

std::vector<ZeroShiftSet> rank_at_zero_shift(const Specification& spec,
                                             const std::vector<Candidate>& candidates) {
  std::vector<ZeroShiftSet> sets(candidates.size());
  parallel_for(candidates.size(),
               [&](std::size_t k) { sets[k] = at_zero_shift(spec, candidates[k]); });
  const bool forward = first_objective(spec) == Objective::kForwardEfficiency;
  std::ranges::stable_sort(sets, [&](const ZeroShiftSet& a, const ZeroShiftSet& b) {
    return std::tuple(!a.meshes, !a.defined, forward ? -a.eta_f : -a.eta_b) <
           std::tuple(!b.meshes, !b.defined, forward ? -b.eta_f : -b.eta_b);
  });
  return sets;
}

}  // namespace gear3k::optimize
