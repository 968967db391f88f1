#include "design/output_terms.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "strength/mesh_forces.hpp"

namespace gear3k::design {

OutputTerms output_terms(const Design& design, const Evaluation& evaluation) {
  const auto train = train::make_train_geometry(resolved_parameters(design));
  if (!train)
    throw std::invalid_argument(
        "output_terms: a mesh has no working pressure angle, "
        "allowed: a design that evaluate() takes");
  OutputTerms terms;
  terms.tooth_force_per_torque_1_m = strength::normal_forces_per_torque(*train);
  for (double& force : terms.tooth_force_per_torque_1_m) force /= evaluation.planets;
  const double ratio = std::abs(evaluation.ratio);
  if (const auto& forward = evaluation.efficiency.forward; forward && *forward > 0.0) {
    terms.driving_torque_share = 1.0 / (ratio * *forward);
    terms.friction_torque_share = (1.0 / *forward - 1.0) / ratio;
  }
  if (const auto& backward = evaluation.efficiency.backward) {
    terms.back_driven_torque_share = *backward / ratio;
  }
  terms.outer_diameter_m =
      2.0 *
      std::max(design.masses.ring1_outer_radius_m.value_or(train->gears[train::kR1].root_radius_m),
               design.masses.ring2_outer_radius_m.value_or(train->gears[train::kR2].root_radius_m));
  terms.outer_surface_stated = stated_outer_diameter_m(design).has_value();
  terms.ring_root_diameter_m = 2.0 * std::max(train->gears[train::kR1].root_radius_m,
                                              train->gears[train::kR2].root_radius_m);
  return terms;
}

std::optional<double> stated_outer_diameter_m(const Design& design) {
  const auto& outer1_m = design.masses.ring1_outer_radius_m;
  const auto& outer2_m = design.masses.ring2_outer_radius_m;
  if (!outer1_m || !outer2_m) return std::nullopt;
  return 2.0 * std::max(*outer1_m, *outer2_m);
}

}  // namespace gear3k::design
