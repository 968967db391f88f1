#pragma once

#include "strength/rating_task.hpp"

namespace gear3k::strength {

/// Through hardened steel of σ_Hlim = 700 and σ_Flim = 290 N/mm², as a user states it by numbers.
inline GearMaterial steel_700_290() {
  GearMaterial material;
  material.record.group = MaterialGroup::kThroughHardened;
  material.record.life_curve = LifeCurve::kSteel;
  material.record.flank_limit = {.law = LimitLaw::kLinear, .constant_Pa = 700e6};
  material.record.root_limit = {.law = LimitLaw::kLinear, .constant_Pa = 290e6};
  material.record.youngs_modulus_Pa = 206e9;
  material.record.poisson_ratio = 0.3;
  return material;
}

}  // namespace gear3k::strength
