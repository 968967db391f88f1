#pragma once

#include <vector>

#include "tests/rig/hidden_cause.hpp"
#include "tests/rig/rig.hpp"
#include "tests/rig/rig_train.hpp"

namespace gear3k::rig {

/// What stands on the bench.
struct Bench {
  Train train;
  Kind kind = Kind::transmission;
  double pair_module_mm = 1.0;
  double hysteresis_Nm = 0.0;
};

/// Response of every row without noise, in the order of measurement: sun torque [Nm], lost motion
/// [arcmin], angle of the loop [arcmin] or loss [-].
std::vector<double> responses(const Bench& bench, const std::vector<Condition>& rows,
                              const Effects& effects);

}  // namespace gear3k::rig
