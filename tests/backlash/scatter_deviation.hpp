#pragma once
// Standard deviations of what random gearboxes scatter, in closed form.

#include <cmath>
#include <numbers>

#include "backlash/random_gearbox.hpp"

namespace gear3k::backlash {

/// Of a number over the half width of its limits: 1/√3 where it is uniform; normal, with limits at
/// L standard deviations, √(1 − 2 L φ(L)/(2 Φ(L) − 1))/L.
inline double number_deviation(const ScatterOptions& scatter) {
  if (scatter.scatter == Scatter::kUniform) return 1.0 / std::numbers::sqrt3;
  const double level = scatter.sigma_level;
  const double density = std::exp(-0.5 * level * level) / std::sqrt(2.0 * std::numbers::pi);
  const double within = std::erf(level / std::numbers::sqrt2);
  return std::sqrt(1.0 - 2.0 * level * density / within) / level;
}

/// Of one component in a circle over its radius: 1/2, and √(1 − (L²/2)/(e^{L²/2} − 1))/L.
inline double component_deviation(const ScatterOptions& scatter) {
  if (scatter.scatter == Scatter::kUniform) return 0.5;
  const double level = scatter.sigma_level;
  const double h = 0.5 * level * level;
  return std::sqrt(1.0 - h / std::expm1(h)) / level;
}

}  // namespace gear3k::backlash
