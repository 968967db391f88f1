#include "efficiency/mesh_loss_slopes.hpp"

#include <numbers>

#include "efficiency/coulomb_path.hpp"

namespace gear3k::efficiency {

namespace {

/// Efficiency by the friction in approach, μ_a, and in recess, μ_r.
struct PathSlopes {
  double efficiency = 1.0, by_approach = 0.0, by_recess = 0.0;
};

PathSlopes path_slopes(const MeshContact<double>& c, double approach, double recess,
                       LossSlopes wanted) {
  if (wanted == LossSlopes::kNone) {
    return {.efficiency =
                drawn_path_efficiency<double>(c, {.approach = approach, .recess = recess})};
  }
  const JetSides eta = drawn_path_efficiency<JetSides>(
      c, {.approach = JetSides(approach, 0), .recess = JetSides(recess, 1)});
  return {.efficiency = eta.a, .by_approach = eta.v[0], .by_recess = eta.v[1]};
}

}  // namespace

MeshEfficiencySlopes mesh_efficiency_slopes(const MeshContact<double>& contact,
                                            const FlankFriction<double>& mu, LossModel model,
                                            LossSlopes wanted) {
  const bool along_path = model == LossModel::kCoulombPath || model == LossModel::kDirectional;
  const bool alike = mu.approach_factor == 1.0 && mu.recess_factor == 1.0;
  const auto path_of = [&](double approach, double recess) {
    return path_slopes(contact, approach, recess, wanted);
  };
  MeshEfficiencySlopes result;
  if (along_path || !alike || wanted == LossSlopes::kByAll) {
    const PathSlopes path =
        path_of(mu.coefficient * mu.approach_factor, mu.coefficient * mu.recess_factor);
    result = {
        .efficiency = path.efficiency,
        .by_coefficient = path.by_approach * mu.approach_factor + path.by_recess * mu.recess_factor,
        .by_approach_factor = path.by_approach * mu.coefficient,
        .by_recess_factor = path.by_recess * mu.coefficient};
    if (along_path) return result;
    // What the sides make different, beside the model of first order.
    const PathSlopes plain = alike ? path : path_of(mu.coefficient, mu.coefficient);
    result.efficiency = 1.0 + (path.efficiency - plain.efficiency);
    result.by_coefficient -= plain.by_approach + plain.by_recess;
  }
  const double factor =
      model == LossModel::kOhlendorf
          ? ohlendorf_factor(contact.approach_contact_ratio, contact.recess_contact_ratio)
          : sliding_factor(contact.approach_contact_ratio, contact.recess_contact_ratio);
  const double slope = -std::numbers::pi * (1.0 / contact.z1 + contact.sign / contact.z2) * factor;
  result.efficiency += slope * mu.coefficient;
  result.by_coefficient += slope;
  return result;
}

}  // namespace gear3k::efficiency
