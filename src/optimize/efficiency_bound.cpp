#include "optimize/efficiency_bound.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace gear3k::optimize {

namespace {

/// Losses of S-P1, P1-R1, P2-R2.
using Losses = std::array<double, train::kMeshCount>;

double efficiency_at(const train::ToothSet& z, const Losses& loss, bool forward) {
  const efficiency::MeshEfficiencies<double> eta{1.0 - loss[0], 1.0 - loss[1], 1.0 - loss[2]};
  if (std::ranges::any_of(eta, [](double e) { return !(e > 0.0); })) return 0.0;
  if (forward) return std::max(0.0, efficiency::forward_efficiency(z, eta));
  if (efficiency::backdriving_margin(z, eta) <= 0.0) return 0.0;
  return std::max(0.0, efficiency::backward_efficiency(z, eta));
}

}  // namespace

std::array<double, 2> loss_weights(double g1, double g2,
                                   const efficiency::MeshEfficiencies<double>& eta, bool forward) {
  const auto& [e1, e2, e3] = eta;
  if (forward && g2 < 1.0) {
    const double top = 1.0 + g1 * e1 * e2;
    return {g1 * e2 / top, g1 * e1 / top + g2 * e3 / (1.0 - g2 * e2 * e3)};
  }
  if (forward) {
    const double top = e2 + g1 * e1;
    return {g1 / top, 1.0 / top + e3 / (g2 - e2 * e3)};
  }
  if (g2 < 1.0) {
    const double bottom = g1 + e1 * e2;
    return {1.0 / e1 - e2 / bottom, 1.0 / (e2 - g2 / e3) - e1 / bottom};
  }
  const double bottom = e1 + g1 * e2;
  return {1.0 / e1 - 1.0 / bottom, g2 * e3 / (g2 * e2 * e3 - 1.0) - g1 / bottom};
}

double most_backward(const train::ToothSet& z, const LossRegion& r, double stage2) {
  const double corner_ring = r.weighted - r.sun_weight * r.sun;
  if (corner_ring <= r.ring) return efficiency_at(z, {r.sun, r.ring, stage2}, false);
  const auto at = [&](double sun) { return Losses{sun, r.weighted - r.sun_weight * sun, stage2}; };
  struct Tangent {
    double sun, value, slope;  // 1/η and its derivative along the edge
  };
  const auto tangent = [&](double sun) -> std::optional<Tangent> {
    const double eta = efficiency_at(z, at(sun), false);
    if (!(eta > 0.0)) return std::nullopt;
    const Losses loss = at(sun);
    const auto w = loss_weights(train::g1(z), train::g2(z),
                                {1.0 - loss[0], 1.0 - loss[1], 1.0 - loss[2]}, false);
    return Tangent{sun, 1.0 / eta, (w[0] - r.sun_weight * w[1]) / eta};
  };
  const double last = (r.weighted - r.ring) / r.sun_weight;
  auto a = tangent(r.sun);
  auto b = tangent(last);
  // Off the region where the train runs backwards, the corner of both.
  if (!a || !b) return efficiency_at(z, {r.sun, r.ring, stage2}, false);
  if (a->slope >= 0.0) return 1.0 / a->value;
  if (b->slope <= 0.0) return 1.0 / b->value;
  for (int k = 0; k < 6; ++k) {
    const auto middle = tangent(0.5 * (a->sun + b->sun));
    if (!middle) break;
    (middle->slope < 0.0 ? a : b) = middle;
  }
  const double crossing =
      (b->value - a->value - b->slope * b->sun + a->slope * a->sun) / (a->slope - b->slope);
  return 1.0 / (a->value + a->slope * (crossing - a->sun));
}

double most_forward(const train::ToothSet& z, const LossRegion& r, double stage2) {
  const auto log_of = [](double loss) { return -std::log1p(-std::min(loss, 1.0 - 1e-12)); };
  const auto loss_of = [](double lambda) { return -std::expm1(-lambda); };
  const double sun = log_of(r.sun), ring = log_of(r.ring);
  if (r.weighted <= r.sun_weight * sun + ring) {
    return efficiency_at(z, {r.sun, r.ring, stage2}, true);
  }
  const double other_ring = loss_of(r.weighted - r.sun_weight * sun);
  const double other_sun = loss_of((r.weighted - ring) / r.sun_weight);
  return std::max(efficiency_at(z, {r.sun, other_ring, stage2}, true),
                  efficiency_at(z, {other_sun, r.ring, stage2}, true));
}

}  // namespace gear3k::optimize
