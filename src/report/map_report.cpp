#include "report/map_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/text/json.hpp"
#include "io/text/printable.hpp"
#include "report/display.hpp"
#include "report/fields.hpp"
#include "report/operation_report.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

const char* absence(design::MapStatus status) {
  using design::MapStatus;
  switch (status) {
    case MapStatus::kHelped:
      return "helped";
    case MapStatus::kLocks:
      return "locks";
    case MapStatus::kNoFriction:
      return "no value";
    case MapStatus::kNotConverged:
      return "unsolved";
    case MapStatus::kRuns:
      break;
  }
  return "-";
}

namespace {

using design::Direction, design::MapPair, design::MapPoint, design::MapStatus, design::MapTorque,
    design::Operation, design::OperatingMap;

std::string status_name(MapStatus status) {
  return std::string(design::kMapStatusNames[static_cast<std::size_t>(status)]);
}

constexpr std::array<const char*, 2> kDirectionNames{"forward", "backward"};

// --- table

/// Places along an axis that a table has room for, the first and the last among them.
std::vector<std::size_t> shown_places(std::size_t count) {
  constexpr std::size_t kMost = 12;
  const std::size_t step = (count + kMost - 1) / kMost;
  std::vector<std::size_t> places;
  places.reserve(kMost + 1);
  for (std::size_t k = 0; k < count; k += step) places.push_back(k);
  if (places.back() + 1 != count) places.push_back(count - 1);
  return places;
}

std::string efficiency_cell(const MapPoint& point) {
  if (point.status != MapStatus::kRuns) return absence(point.status);
  const std::optional<double>& eta = point.operation->efficiency;
  return eta ? fixed(percent(*eta), 2) : "none";
}

std::string efficiency_table(const OperatingMap& map, Direction direction) {
  const auto speeds = shown_places(map.sun_speed_rad_s.size());
  const auto torques = shown_places(map.output_torque_Nm.size());
  std::vector<std::string> header{"torque at R2 (N m)"};
  header.reserve(speeds.size() + 1);
  for (const std::size_t i : speeds) {
    header.push_back(fmt::format("{:.6g}", rpm(map.sun_speed_rad_s[i])));
  }
  TextTable table(header);
  for (const std::size_t j : torques) {
    std::vector<std::string> row{fmt::format("{:.6g}", map.output_torque_Nm[j])};
    row.reserve(speeds.size() + 1);
    for (const std::size_t i : speeds) {
      row.push_back(
          efficiency_cell(point_of(map.points[i * map.output_torque_Nm.size() + j], direction)));
    }
    table.add(row);
  }
  const bool forward = direction == Direction::kForward;
  const bool thinned =
      speeds.size() < map.sun_speed_rad_s.size() || torques.size() < map.output_torque_Nm.size();
  return fmt::format("\nEfficiency {} in percent, over sun speed in rpm{}\n{}",
                     forward ? "forward (sun drives)" : "backward (R2 drives)",
                     thinned ? "; every point: --format csv" : "", table.text(2));
}

std::string torque_text(const MapTorque& torque) {
  return torque.torque_Nm ? fmt::format("{:.5g} N m", clean(*torque.torque_Nm))
                          : "none: " + torque.reason;
}

std::string torque_cell(const MapTorque& torque) {
  if (torque.torque_Nm) return fmt::format("{:.5g}", clean(*torque.torque_Nm));
  return torque.status == MapStatus::kLocks ? "locks" : "no value";
}

std::string running_table(const OperatingMap& map) {
  TextTable table({"sun speed (rpm)", "R2 speed (rpm)", "no-load torque at the sun (N m)",
                   "back-driving torque at R2 (N m)"});
  for (const std::size_t i : shown_places(map.sun_speed_rad_s.size())) {
    table.add({fmt::format("{:.6g}", rpm(map.sun_speed_rad_s[i])),
               fmt::format("{:.5g}", rpm(map.sun_speed_rad_s[i] / std::abs(map.ratio))),
               torque_cell(map.running[i].sun), torque_cell(map.running[i].output)});
  }
  return "\nTorques without load, running (no-load: sun drives, R2 free; back-driving: R2 drives, "
         "sun free)\n" +
         table.text(2);
}

bool self_locking(const OperatingMap& map) {
  return std::ranges::any_of(map.points,
                             [](const MapPair& pair) { return !pair.backward.drives_sun; });
}

std::string self_locking_text(const OperatingMap& map) {
  if (!self_locking(map)) return "; with planet bearings R2 drives the sun at every point";
  const auto locked = std::ranges::count_if(
      map.points, [](const MapPair& pair) { return !pair.backward.drives_sun; });
  return fmt::format(
      "; self-locking: flanks and planet bearings let R2 drive the sun at {} of {} points",
      static_cast<long>(map.points.size()) - locked, map.points.size());
}

std::string margin_text(const OperatingMap& map) {
  const bool below_one = train::g2(map.teeth) < 1.0;
  std::string text = fmt::format(
      "\nBack-driving margin of the meshes {} (positive: without drags and bearings R2 drives the "
      "sun)\n",
      below_one ? "eta2 eta3 - G2" : "eta2 eta3 G2 - 1");
  const auto least = design::least_margin(map);
  if (!least)
    return text + "  none: no point of the grid has friction with which every mesh runs backward\n";
  return text + fmt::format("  least: {} at {:.6g} rpm, {:.6g} N m{}\n",
                            fixed(*least->backward.backdriving_margin, 5),
                            rpm(least->point.sun_speed_rad_s), least->point.output_torque_Nm,
                            self_locking_text(map));
}

std::string heat_table(const OperatingMap& map) {
  const MapPair& at = map.reference;
  TextTable table({"", "forward (W)", "backward (W)", "friction forward", "friction backward"});
  const auto cell = [](const MapPoint& point, auto value, const char* format) {
    return point.operation ? fmt::format(fmt::runtime(format), clean(value(*point.operation)))
                           : efficiency_cell(point);
  };
  const auto add = [&](std::string name, auto value) {
    table.add(
        {std::move(name), cell(at.forward, value, "{:.4g}"), cell(at.backward, value, "{:.4g}")});
  };
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto heat = [k](const Operation<double>& o) { return o.mesh[k].loss_W; };
    const auto friction = [k](const Operation<double>& o) { return o.mesh[k].friction; };
    table.add({fmt::format("mesh {}", train::kMeshNames[k]), cell(at.forward, heat, "{:.4g}"),
               cell(at.backward, heat, "{:.4g}"), cell(at.forward, friction, "{:.5f}"),
               cell(at.backward, friction, "{:.5f}")});
  }
  constexpr std::array<const char*, design::kShaftCount> kDragRows{
      "drag on the sun", "drag on the planets", "drag on the carrier", "drag on R2"};
  for (std::size_t k = 0; k < design::kShaftCount; ++k) {
    add(kDragRows[k], [k](const Operation<double>& o) { return o.drag_loss_W[k]; });
  }
  add("planet bearings", [](const Operation<double>& o) { return o.bearing_loss_W; });
  add("all losses", [](const Operation<double>& o) { return o.loss_W; });
  add("input power", [](const Operation<double>& o) { return o.input_power_W; });
  return fmt::format("\nHeat at {:.6g} rpm of the sun and {:.6g} N m at R2 ({})\n{}",
                     rpm(at.point.sun_speed_rad_s), clean(at.point.output_torque_Nm),
                     map.reference_given ? "the operating point"
                                         : "the grid's most power; no operating point is stated",
                     table.text(2));
}

// --- CSV

/// A point of the map in one drive direction: a row of the CSV.
Fields row_fields(const OperatingMap& map, const MapPair& pair, Direction direction) {
  const MapPoint& point = point_of(pair, direction);
  const std::optional<Operation<double>>& o = point.operation;
  Fields f;
  f.add_row(kDirectionNames[static_cast<std::size_t>(direction)], {"direction"});
  f.add_row(rpm(pair.point.sun_speed_rad_s), {"sun_speed_rpm"});
  f.add_row(clean(pair.point.output_torque_Nm), {"output_torque_nm"});
  const auto add = [&](std::string column, auto value) {
    std::optional<double> number;
    if (o) number = value(*o);
    if (number) *number += 0.0;  // no negative zero
    f.add_row(number, {std::move(column)});
  };
  add("sun_torque_nm", [](const auto& at) { return at.sun_torque_Nm; });
  add("efficiency", [](const auto& at) { return at.efficiency; });
  add("input_power_w", [](const auto& at) { return at.input_power_W; });
  add("loss_w", [](const auto& at) { return at.loss_W; });
  constexpr std::array<const char*, train::kMeshCount> kMeshes{"s_p1", "p1_r1", "p2_r2"};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    add(fmt::format("heat_{}_w", kMeshes[k]), [k](const auto& at) { return at.mesh[k].loss_W; });
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    add(fmt::format("friction_{}", kMeshes[k]),
        [k](const auto& at) { return at.mesh[k].friction; });
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    add(fmt::format("mesh_efficiency_{}", kMeshes[k]),
        [k](const auto& at) { return at.mesh[k].efficiency; });
  }
  constexpr std::array<const char*, design::kShaftCount> kShafts{"sun", "planet", "carrier", "r2"};
  for (std::size_t k = 0; k < design::kShaftCount; ++k) {
    add(fmt::format("drag_loss_{}_w", kShafts[k]),
        [k](const auto& at) { return at.drag_loss_W[k]; });
  }
  add("bearing_loss_w", [](const auto& at) { return at.bearing_loss_W; });
  f.add_row(celsius(map.temperature_K), {"temperature_c"});
  std::optional<double> margin = point.backdriving_margin;
  if (margin) *margin += 0.0;
  f.add_row(margin, {"backdriving_margin"});
  f.add_row(status_name(point.status), {"status"});
  return f;
}

// --- JSON

io::Json point_json(const MapPair& pair, Direction direction) {
  const MapPoint& point = point_of(pair, direction);
  io::Json json{{"direction", kDirectionNames[static_cast<std::size_t>(direction)]},
                {"sun_speed_rpm", rpm(pair.point.sun_speed_rad_s)},
                {"output_torque_nm", clean(pair.point.output_torque_Nm)},
                {"status", status_name(point.status)}};
  if (direction == Direction::kBackward) {
    json["backdriving_margin"] = point.backdriving_margin;
  }
  if (point.operation) {
    json.update(operation_fields("", *point.operation).json());
    json["output_torque_nm"] = clean(pair.point.output_torque_Nm);
  } else {
    for (const char* key : {"sun_torque_nm", "efficiency", "input_power_w", "loss_w", "meshes",
                            "drag_loss_w", "bearing_loss_w"}) {
      json[key] = nullptr;
    }
  }
  return json;
}

io::Json torque_json(const MapTorque& torque) {
  return {{"torque_nm", torque.torque_Nm},
          {"status", status_name(torque.status)},
          {"reason", torque.reason}};
}

io::Json unloaded_json(const design::UnloadedTorques& torques) {
  return {{"sun", torque_json(torques.sun)}, {"output", torque_json(torques.output)}};
}

}  // namespace

std::string map_table(const OperatingMap& map, const ModelUse* model) {
  std::string text = fmt::format("{}: ratio {:.4f}, {} planets, friction law {}, {:.4g} C\n",
                                 io::printable(map.name), map.ratio, map.planets,
                                 efficiency::kFrictionLawNames[static_cast<std::size_t>(map.law)],
                                 celsius(map.temperature_K));
  text += efficiency_table(map, Direction::kForward);
  text += efficiency_table(map, Direction::kBackward);
  text += running_table(map);
  text += fmt::format("\nBreakaway torque\n  at the sun, R2 free: {}\n  at R2, sun free:     {}\n",
                      torque_text(map.breakaway.sun), torque_text(map.breakaway.output));
  text += margin_text(map) + heat_table(map);
  if (model != nullptr) text += model_paragraph(*model);
  if (!map.notes.empty()) text += '\n';
  for (const std::string& note : map.notes) text += fmt::format("Note: {}\n", io::printable(note));
  return text;
}

io::Json map_json(const OperatingMap& map, const ModelUse* model) {
  io::Json speeds = io::Json::array();
  io::Json torques = io::Json::array();
  io::Json running = io::Json::array();
  io::Json points = io::Json::array();
  for (std::size_t i = 0; i < map.sun_speed_rad_s.size(); ++i) {
    speeds.push_back(rpm(map.sun_speed_rad_s[i]));
    io::Json at = unloaded_json(map.running[i]);
    running.push_back({{"sun_speed_rpm", rpm(map.sun_speed_rad_s[i])},
                       {"sun", at["sun"]},
                       {"output", at["output"]}});
  }
  for (const double torque : map.output_torque_Nm) torques.push_back(clean(torque));
  for (const Direction direction : {Direction::kForward, Direction::kBackward}) {
    for (const MapPair& pair : map.points) points.push_back(point_json(pair, direction));
  }
  io::Json margin = nullptr;
  if (const auto least = design::least_margin(map)) {
    margin = {{"least", *least->backward.backdriving_margin},
              {"sun_speed_rpm", rpm(least->point.sun_speed_rad_s)},
              {"output_torque_nm", clean(least->point.output_torque_Nm)},
              {"self_locking", self_locking(map)}};
  }
  io::Json json{{"tool", tool_json()},
                {"name", map.name},
                {"ratio", map.ratio},
                {"planets", map.planets},
                {"friction_law", efficiency::kFrictionLawNames[static_cast<std::size_t>(map.law)]},
                {"temperature_c", celsius(map.temperature_K)},
                {"sun_speed_rpm", speeds},
                {"output_torque_nm", torques},
                {"points", points},
                {"running", running},
                {"breakaway", unloaded_json(map.breakaway)},
                {"backdriving_margin", margin},
                {"reference",
                 {{"from", map.reference_given ? "operating_point" : "grid"},
                  {"forward", point_json(map.reference, Direction::kForward)},
                  {"backward", point_json(map.reference, Direction::kBackward)}}},
                {"notes", map.notes}};
  if (model != nullptr) json["model"] = model_json(*model);
  return json;
}

std::string map_csv(const OperatingMap& map) {
  std::string text =
      "# kind: transmission\n" + row_fields(map, map.reference, Direction::kForward).csv_header();
  for (const Direction direction : {Direction::kForward, Direction::kBackward}) {
    for (const MapPair& pair : map.points) text += row_fields(map, pair, direction).csv_values();
  }
  return text;
}

}  // namespace gear3k::report
