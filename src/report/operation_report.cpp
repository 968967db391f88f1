#include "report/operation_report.hpp"

#include <fmt/format.h>

#include <array>
#include <numbers>

#include "io/text/json.hpp"
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

io::Json direction_json(const OperationResult<double>& result) {
  if (!result.operation) return {{"runs", false}, {"reason", no_operation_text(result.reason)}};
  io::Json json{{"runs", true}};
  json.update(operation_json(*result.operation));
  return json;
}

}  // namespace

io::Json operation_json(const Operation<double>& o) {
  io::Json meshes = io::Json::array();
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const design::MeshOperation<double>& m = o.mesh[k];
    meshes.push_back({{"name", train::kMeshNames[k]},
                      {"friction", m.friction},
                      {"normal_force_n", m.normal_force_N},
                      {"sliding_speed_m_s", m.sliding_speed_m_s},
                      {"gear1_drives", m.gear1_drives},
                      {"efficiency", m.efficiency},
                      {"heat_w", m.loss_W}});
  }
  io::Json drag;
  for (std::size_t k = 0; k < design::kShaftCount; ++k) {
    drag[std::string(design::kShaftNames[k])] = o.drag_loss_W[k];
  }
  return {{"sun_torque_nm", o.sun_torque_Nm + 0.0},  // no negative zero
          {"output_torque_nm", o.output_torque_Nm + 0.0},
          {"efficiency", o.efficiency},
          {"input_power_w", o.input_power_W},
          {"loss_w", o.loss_W},
          {"meshes", meshes},
          {"drag_loss_w", drag},
          {"bearing_loss_w", o.bearing_loss_W}};
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

void add_operation(io::Json& json, const Evaluation& e) {
  json["operating_point"] = nullptr;
  if (!e.operation) return;
  const auto& point = e.operation->point;
  json["operating_point"] = {{"sun_speed_rpm", rpm(point.sun_speed_rad_s)},
                             {"output_torque_nm", point.output_torque_Nm},
                             {"temperature_c", celsius(point.temperature_K)},
                             {"forward", direction_json(e.operation->forward)},
                             {"backward", direction_json(e.operation->backward)}};
}

std::string operation_csv(const Evaluation& e) {
  if (!e.operation) return "";
  std::string text;
  for (const auto& [name, result] : directions(*e.operation)) {
    if (!result->operation) continue;
    const Operation<double>& o = *result->operation;
    const std::string item = fmt::format("operating point {}", name);
    const auto add = [&](const std::string& quantity, double value, const char* unit) {
      text += csv_line({item, quantity, exact(value), unit, "", ""});
    };
    add("sun_torque", o.sun_torque_Nm, "N m");
    add("output_torque", o.output_torque_Nm, "N m");
    if (o.efficiency) add("efficiency", *o.efficiency, "");
    add("input_power", o.input_power_W, "W");
    add("loss", o.loss_W, "W");
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const std::string mesh(train::kMeshNames[k]);
      add("friction " + mesh, o.mesh[k].friction, "");
      add("heat " + mesh, o.mesh[k].loss_W, "W");
    }
    for (std::size_t i = 0; i < design::kShaftCount; ++i) {
      add(fmt::format("drag_loss {}", design::kShaftNames[i]), o.drag_loss_W[i], "W");
    }
    add("bearing_loss", o.bearing_loss_W, "W");
  }
  return text;
}

}  // namespace gear3k::report
