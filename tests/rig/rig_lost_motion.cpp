#include "tests/rig/rig_lost_motion.hpp"

#include <cmath>
#include <cstddef>

namespace gear3k::rig {

double lost_motion_rad(const Train& train, const std::array<double, 3>& center_distance_m) {
  const auto& mesh = train.meshes;
  double total = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double gap = normal_backlash_m(train.pairs[k], center_distance_m[k], train.thinning_m[k]);
    std::array<double, 3> opened{};  // clearance taken up along each line of action
    opened[k] = 1.0;
    // Angles c of the carrier, p of the planet relative to it, sun and R1 at rest:
    //   S-P1   -rS c + rP1 p = o1
    //   P1-R1   rP1 p + rR1 c = o2
    //   P2-R2   rP2 p - rR2 (w - c) = o3
    const double rs = mesh[0].base_radius_a_m, rp1 = mesh[1].base_radius_a_m;
    const double rr1 = mesh[1].base_radius_b_m;
    const double carrier = (opened[1] - opened[0]) / (rr1 + rs);
    const double planet = (opened[0] + rs * carrier) / rp1;
    const double output =
        carrier + (mesh[2].base_radius_a_m * planet - opened[2]) / mesh[2].base_radius_b_m;
    total += std::fabs(output) * gap;
  }
  return total;
}

}  // namespace gear3k::rig
