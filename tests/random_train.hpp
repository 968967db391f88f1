#pragma once

#include <numbers>
#include <optional>

#include "tests/random_numbers.hpp"
#include "train/train_geometry.hpp"

namespace gear3k {

/// Random 3K trains for identities.
class RandomTrain : public RandomNumbers {
 public:
  using RandomNumbers::RandomNumbers;

  /// Tooth numbers with G2 below or above 1, nearly coaxial.
  train::ToothSet teeth(bool g2_below_one) {
    for (;;) {
      train::ToothSet z{
          .S = count(10, 24), .P1 = count(18, 50), .R1 = 0, .P2 = count(18, 50), .R2 = 0};
      z.R1 = z.S + 2 * z.P1 + count(-2, 3);
      z.R2 = z.P2 + z.R1 - z.P1 + count(-2, 2);
      const int gap = z.P1 * z.R2 - z.P2 * z.R1;
      if (gap != 0 && (gap > 0) == g2_below_one) return z;
    }
  }

  /// A train whose meshes all have a working angle.
  train::TrainGeometry<double> train(bool g2_below_one) {
    for (;;) {
      train::TrainParameters<double> p{};
      p.teeth = teeth(g2_below_one);
      const train::ToothSet& z = p.teeth;
      p.pressure_angle_rad = between(18.0, 25.0) * std::numbers::pi / 180.0;
      p.module_m[0] = between(0.4e-3, 1e-3);
      p.module_m[1] = p.module_m[0] * (z.R1 - z.P1) / (z.R2 - z.P2) * between(0.98, 1.02);
      for (double& x : p.profile_shift) x = between(0.0, 1.0);
      p.center_distance_m = 0.5 * p.module_m[0] * (z.R1 - z.P1) * between(1.0, 1.06);
      if (auto result = make_train_geometry(p)) return *result;
    }
  }
};

}  // namespace gear3k
