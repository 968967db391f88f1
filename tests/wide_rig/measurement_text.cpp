#include "tests/wide_rig/measurement_text.hpp"

#include "tests/rig/number_text.hpp"

namespace gear3k::wide_rig {
namespace {

using rig::number_text;

// Conditions with the digits they were rounded to, so that what the bench computed with is what
// stands in the file.
std::string exact(double value) { return number_text(value, 12); }

}  // namespace

std::string measurement_text(const std::string& kind, const BenchColumns& columns,
                             const std::vector<BenchRow>& rows, const std::vector<double>& readings,
                             const std::vector<double>& sigma) {
  std::string text = "# kind: " + kind + "\n";
  if (kind == "transmission") {
    text += "direction,sun_speed_rpm,output_torque_nm,sun_torque_nm";
    if (columns.rotation) text += ",rotation";
  } else if (kind == "lost_motion") {
    text += "test_torque_nm,lost_motion_arcmin";
    if (columns.cycles) text += ",cycles";
  } else {
    text += "driving_teeth,driven_teeth,loss_factor";
  }
  // The contract requires the angle of a lost_motion row.
  const bool angle = columns.angle || kind == "lost_motion";
  if (angle && kind != "pair_loss") text += ",output_angle_deg";
  if (columns.temperature) text += ",temperature_c";
  if (columns.time) text += ",time_s";
  if (columns.run) text += ",run";
  if (columns.sigma) {
    text += kind == "transmission"  ? ",sigma_nm"
            : kind == "lost_motion" ? ",sigma_arcmin"
                                    : ",sigma";
  }
  text += '\n';
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const BenchRow& row = rows[i];
    if (kind == "transmission") {
      text += row.forward ? "forward," : "backward,";
      text += exact(row.sun_speed_rpm) + ',' + exact(row.output_torque_Nm) + ',' +
              number_text(readings[i], 9);
      if (columns.rotation) text += row.rotation > 0.0 ? ",1" : ",-1";
    } else if (kind == "lost_motion") {
      text += exact(row.test_torque_Nm) + ',' + number_text(readings[i], 9);
      if (columns.cycles) text += ',' + exact(row.cycles);
    } else {
      text += std::to_string(row.driving_teeth) + ',' + std::to_string(row.driven_teeth) + ',' +
              number_text(readings[i], 9);
    }
    if (angle && kind != "pair_loss") text += ',' + exact(row.output_angle_deg);
    if (columns.temperature) text += ',' + exact(row.temperature_c);
    if (columns.time) text += ',' + exact(row.time_s);
    if (columns.run) text += ",s" + std::to_string(row.session + 1);
    if (columns.sigma) text += ',' + number_text(sigma[i], 6);
    text += '\n';
  }
  return text;
}

}  // namespace gear3k::wide_rig
