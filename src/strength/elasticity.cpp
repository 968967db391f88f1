#include "strength/elasticity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace gear3k::strength {

void check_elasticity(const Elasticity& material) {
  if (!(material.youngs_modulus_Pa > 0.0 && std::isfinite(material.youngs_modulus_Pa))) {
    throw std::invalid_argument(fmt::format("elasticity: Young's modulus = {} Pa, allowed: above 0",
                                            material.youngs_modulus_Pa));
  }
  if (!(material.poissons_ratio >= 0.0 && material.poissons_ratio < 0.5)) {
    throw std::invalid_argument(fmt::format(
        "elasticity: Poisson's ratio = {}, allowed: 0 <= ratio < 0.5", material.poissons_ratio));
  }
}

}  // namespace gear3k::strength
