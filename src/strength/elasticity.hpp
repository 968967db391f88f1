#pragma once

namespace gear3k::strength {

/// Elastic constants of a gear's material.
struct Elasticity {
  double youngs_modulus_Pa = 0.0;  ///< E > 0
  double poissons_ratio = 0.0;     ///< ν, 0 ≤ ν < 0.5

  /// E' = E/(1 − ν²) [Pa]
  [[nodiscard]] double plane_strain_modulus() const {
    return youngs_modulus_Pa / (1.0 - poissons_ratio * poissons_ratio);
  }
};
/// @throws std::invalid_argument outside the ranges above or NaN
void check_elasticity(const Elasticity& material);

}  // namespace gear3k::strength
