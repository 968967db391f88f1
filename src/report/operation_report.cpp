#include "report/operation_report.hpp"

#include <fmt/format.h>

#include <array>
#include <numbers>

#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using design::Evaluation, design::Operation, design::OperationResult;

struct DirectedResult {
  const char* name;
  const OperationResult<double>* result;
};
std::array<DirectedResult, 2> directions(const design::OperatingResult& o) {
  return {{{"forward", &o.forward}, {"backward", &o.backward}}};
}

std::string sun_torque_text(const Operation<double>& o) {
  return fmt::format("{:.5g} N m{}", o.sun_torque_Nm + 0.0,
                     o.sun_torque_Nm < 0.0 ? " (helps)" : "");
}

std::string efficiency_text(const Operation<double>& o) {
  return o.efficiency ? fmt::format("{:.2f} %", 100.0 * *o.efficiency) : "undefined";
}

Fields direction_fields(const DirectedResult& directed) {
  const OperationResult<double>& result = *directed.result;
  Fields f;
  f.add("runs", result.operation.has_value());
  if (result.operation) {
    f.join(operation_fields(fmt::format("operating point {}", directed.name), *result.operation));
  } else {
    f.add("reason", no_operation_text(result.reason));
  }
  return f;
}

}  // namespace

Fields operation_fields(const std::string& item, const Operation<double>& o) {
  Fields f(item);
  f.add("sun_torque_nm", o.sun_torque_Nm, {"sun_torque", "N m"});
  f.add("output_torque_nm", o.output_torque_Nm, {"output_torque", "N m"});
  f.add("efficiency", o.efficiency, {"efficiency"});
  f.add("input_power_w", o.input_power_W, {"input_power", "W"});
  f.add("loss_w", o.loss_W, {"loss", "W"});
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const design::MeshOperation<double>& m = o.mesh[k];
    const std::string name(train::kMeshNames[k]);
    Fields mesh(item);
    mesh.add("name", name);
    mesh.add("friction", m.friction, {"friction " + name});
    mesh.add("normal_force_n", m.normal_force_N, {"normal_force " + name, "N"});
    mesh.add("sliding_speed_m_s", m.sliding_speed_m_s, {"sliding_speed " + name, "m/s"});
    mesh.add("gear1_drives", m.gear1_drives);
    mesh.add("efficiency", m.efficiency, {"efficiency " + name});
    mesh.add("heat_w", m.loss_W, {"heat " + name, "W"});
    f.append("meshes", std::move(mesh));
  }
  Fields drag(item);
  for (std::size_t k = 0; k < design::kShaftCount; ++k) {
    const std::string shaft(design::kShaftNames[k]);
    drag.add(shaft, o.drag_loss_W[k], {"drag_loss " + shaft, "W"});
  }
  f.add("drag_loss_w", std::move(drag));
  f.add("bearing_loss_w", o.bearing_loss_W, {"bearing_loss", "W"});
  return f;
}

Fields operating_point_fields(const design::OperatingResult& o) {
  Fields f("operating point");
  f.add("sun_speed_rpm", rpm(o.point.sun_speed_rad_s), {"sun_speed", "rpm"});
  f.add("output_torque_nm", o.point.output_torque_Nm, {"output_torque", "N m"});
  f.add("temperature_c", celsius(o.point.temperature_K), {"temperature", "C"});
  for (const DirectedResult& directed : directions(o)) {
    f.add(directed.name, direction_fields(directed));
  }
  return f;
}

std::string operation_table(const Evaluation& e) {
  if (!e.operation) return "";
  const auto& point = e.operation->point;
  std::vector<std::string> header{"driven", "sun torque", "efficiency", "loss"};
  for (const std::string_view name : train::kMeshNames) header.emplace_back(name);
  for (const std::string_view name : design::kShaftNames)
    header.push_back(fmt::format("drag {}", name));
  header.emplace_back("bearings");
  TextTable losses(header);
  TextTable meshes({"mesh", "driven", "friction", "normal force", "sliding speed", "eta"});
  meshes.align_left(1);
  for (const auto& [name, result] : directions(*e.operation)) {
    if (!result->operation) {
      losses.add({name, std::string(no_operation_text(result->reason))});
      continue;
    }
    const Operation<double>& o = *result->operation;
    const auto watts = [](double w) { return fmt::format("{:.4g} W", w + 0.0); };
    std::vector<std::string> row{name, sun_torque_text(o), efficiency_text(o), watts(o.loss_W)};
    for (const auto& m : o.mesh) row.push_back(watts(m.loss_W));
    for (const double w : o.drag_loss_W) row.push_back(watts(w));
    row.push_back(watts(o.bearing_loss_W));
    losses.add(row);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const auto& m = o.mesh[k];
      meshes.add({std::string(train::kMeshNames[k]), name, fmt::format("{:.4f}", m.friction),
                  fmt::format("{:.1f} N", m.normal_force_N + 0.0),
                  fmt::format("{:.4f} m/s", m.sliding_speed_m_s),
                  fmt::format("{:.5f}", m.efficiency)});
    }
  }
  return fmt::format(
             "\nAt the operating point: {:.5g} rpm at the sun, {:.5g} N m at R2, {:.4g} C (losses "
             "of all planets; efficiency with drag and bearings)\n",
             rpm(point.sun_speed_rad_s), point.output_torque_Nm, celsius(point.temperature_K)) +
         losses.text(2) + "\n" + meshes.text(2);
}

std::string operation_summary(const Evaluation& e) {
  std::string text;
  for (const auto& [name, result] : directions(e.operation.value())) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name,
                        result->operation ? efficiency_text(*result->operation) : "does not run");
  }
  return text + " at the operating point";
}

}  // namespace gear3k::report
