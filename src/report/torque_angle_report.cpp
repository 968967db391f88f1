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
  Fields f;
  f.add("peak_torque_nm", curve.peak_torque_Nm);
  f.add("lost_motion_arcmin", arcmin(curve.lost_motion_rad));
  f.add("windup_arcmin", arcmin(curve.windup_rad));
  f.add("elastic_windup_arcmin", arcmin(curve.elastic_rad));
  f.add(
      "stiffness", list_json(curve.stiffness, [](const design::StiffnessAtTorque& point) {
        return io::Json{{"torque_nm", point.torque_Nm}, {"output_nm_per_rad", point.output_Nm_rad}};
      }));
  f.add("loop_mj", millijoules(curve.loop_J));
  f.add("friction_mj", millijoules(curve.friction_J));
  f.add("held_arcmin", arcmin(curve.held_rad));
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
