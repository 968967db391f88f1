#include "report/torque_angle_report.hpp"

#include <fmt/format.h>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

constexpr double kMillijoule_J = 1e-3;

/// Work in N m rad.
double millijoules(double work_J) { return work_J / kMillijoule_J; }

}  // namespace

Fields torque_angle_fields(const design::TorqueAngleCurve& curve) {
  Fields f("torque_angle");
  f.add("peak_torque_nm", curve.peak_torque_Nm, {"peak_torque", "N m"});
  f.add("lost_motion_arcmin", arcmin(curve.lost_motion_rad), {"lost_motion", "arcmin"});
  f.add("windup_arcmin", arcmin(curve.windup_rad), {"windup", "arcmin"});
  f.add("elastic_windup_arcmin", arcmin(curve.elastic_rad), {"elastic_windup", "arcmin"});
  f.add("stiffness", io::Json::array());
  for (std::size_t k = 0; k < curve.stiffness.size(); ++k) {
    const design::StiffnessAtTorque& point = curve.stiffness[k];
    Fields at(fmt::format("torque_angle {}", k));
    at.add("torque_nm", point.torque_Nm, {"torque", "N m"});
    at.add("output_nm_per_rad", point.output_Nm_rad, {"output_stiffness", "N m/rad"});
    f.append("stiffness", std::move(at));
  }
  f.add("loop_mj", millijoules(curve.loop_J), {"loop", "mJ"});
  f.add("friction_mj", millijoules(curve.friction_J), {"friction", "mJ"});
  f.add("held_arcmin", arcmin(curve.held_rad), {"held", "arcmin"});
  f.add("sun_lifts_off", curve.sun_lifts_off);
  return f;
}

std::string torque_angle_summary(const design::TorqueAngleCurve& curve) {
  std::string text = fmt::format(
      "{} arcmin at {:.6g} N m, {} without friction; with the lost motion {} arcmin between +T and "
      "-T",
      fixed(arcmin(curve.windup_rad), 2), clean(curve.peak_torque_Nm),
      fixed(arcmin(curve.elastic_rad), 2),
      fixed(arcmin(curve.lost_motion_rad + 2.0 * curve.windup_rad), 2));
  if (curve.held_rad > 1e-3 * curve.elastic_rad) {
    text += fmt::format("; friction keeps {} arcmin at T = 0", fixed(arcmin(curve.held_rad), 2));
  }
  return text;
}

std::string torque_angle_csv(const design::TorqueAngleCurve& curve) {
  std::string text = csv_line({"branch", "torque_nm", "angle_arcmin"});
  for (std::size_t k = 0; k < curve.branch.size(); ++k) {
    for (const design::TorqueAnglePoint& point : curve.branch[k]) {
      text += csv_line({std::string(design::kLoopBranchNames[k]), exact(clean(point.torque_Nm)),
                        exact(clean(arcmin(point.angle_rad)))});
    }
  }
  return text;
}

}  // namespace gear3k::report
