#include "design/extension.hpp"

namespace gear3k::design {

namespace {

/// Where a design states no bearing radius, the arm is written as a coefficient on this one.
constexpr double kBearingRadius_m = 1e-3;

}  // namespace

Design extended(Design design, const Extension<double>& extension) {
  design.friction.extension = extension.friction;
  ShaftLosses<double>& shafts = design.shafts;
  for (std::size_t i = 0; i < kShaftCount; ++i) {
    shafts.drag[i].constant_Nm += extension.drag[i].constant_Nm;
    shafts.drag[i].viscous_Nms += extension.drag[i].viscous_Nms;
    shafts.drag[i].quadratic_Nms2 += extension.drag[i].quadratic_Nms2;
  }
  shafts.drag_temperature_1_K = extension.drag_temperature_1_K;
  shafts.drag_reference_temperature_K = extension.drag_reference_temperature_K;
  if (extension.planet_bearing_arm_m != 0.0) {
    double& radius = shafts.planet_bearing_radius_m;
    const double arm = shafts.planet_bearing_coefficient * radius + extension.planet_bearing_arm_m;
    if (!(radius > 0.0)) radius = kBearingRadius_m;
    shafts.planet_bearing_coefficient = arm / radius;
  }
  shafts.output_bearing_share += extension.output_bearing_share;
  shafts.output_bearing_growth = extension.output_bearing_growth;
  design.lost_motion = extension.lost_motion;
  return design;
}

}  // namespace gear3k::design
