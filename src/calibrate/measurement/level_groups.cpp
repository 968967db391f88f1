#include "calibrate/measurement/level_groups.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

namespace gear3k::calibrate {

namespace {

/// A factor ±1 of each row.
template <class Value>
Eigen::VectorXd sign_of(const MeasurementSet& data, Value value) {
  Eigen::VectorXd sign(static_cast<Eigen::Index>(data.rows.size()));
  for (Eigen::Index i = 0; i < sign.size(); ++i) {
    sign[i] = value(data.rows[static_cast<std::size_t>(i)].condition) ? 1.0 : -1.0;
  }
  return sign;
}

bool varies(const Eigen::VectorXd& sign) {
  return sign.size() > 0 && (sign.array() != sign[0]).any();
}

bool is_forward(const Condition& c) { return c.direction == design::Direction::kForward; }

/// Of many sessions levels are bins.
Levels each_session(const MeasurementSet& data) {
  Levels l{.name = "run", .of = {}, .count = static_cast<int>(data.runs.size())};
  l.of.reserve(data.rows.size());
  for (const Observation& row : data.rows) l.of.push_back(row.condition.run);
  return l;
}

/// Twelfths of a turn of the output, the first about an angle of half a twelfth or of none; none
/// where an angle is not stated.
std::optional<Levels> twelfths_of_turn(const MeasurementSet& data, bool about_none) {
  constexpr int kSectors = 12;
  constexpr double kDegrees = 360.0 / kSectors;
  Levels l{.name = "angle", .of = {}, .count = kSectors, .binned = true};
  for (int k = 0; k < kSectors; ++k) l.at.push_back(kDegrees * (k + (about_none ? 0.0 : 0.5)));
  for (const Observation& row : data.rows) {
    const double turns = row.condition.output_angle_rad / (2.0 * std::numbers::pi);
    if (!std::isfinite(turns)) return std::nullopt;
    const double sector = kSectors * (turns - std::floor(turns)) + (about_none ? 0.5 : 0.0);
    l.of.push_back(static_cast<int>(sector) % kSectors);
  }
  return l;
}

}  // namespace

LevelGroups level_groups(const MeasurementSet& data, const std::vector<Levels>& levels,
                         bool sessions) {
  const Eigen::VectorXd losing = sign_of(data, is_forward);
  const Eigen::VectorXd turning = sign_of(data, [](const Condition& c) { return c.rotation >= 0; });
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(losing.size());
  std::vector<Eigen::VectorXd> senses{ones};
  if (varies(losing)) senses.push_back(losing);
  if (varies(turning)) senses.push_back(turning);
  if (varies(losing) && varies(turning)) senses.push_back(losing.cwiseProduct(turning));
  LevelGroups result;
  std::vector<Eigen::VectorXd> columns;
  const auto add = [&](const LevelGroup& group, const Eigen::VectorXd& inside) {
    if (!(inside.array() != 0.0).any()) return;
    for (const Eigen::VectorXd& sense : senses) {
      // In one direction the losses have the sign of the reading.
      if (group.direction != 0 && &sense != &senses.front()) continue;
      result.group.push_back(group);
      columns.emplace_back(inside.cwiseProduct(sense));
    }
  };
  std::vector<Levels> all = levels;
  for (const bool about_none : {false, true}) {
    if (auto sectors = twelfths_of_turn(data, about_none)) all.push_back(std::move(*sectors));
  }
  for (const Levels& given : all) {
    const bool of_sessions = given.name == "run";
    if (of_sessions && !sessions) continue;
    const Levels l = of_sessions && given.binned ? each_session(data) : given;
    constexpr double kMostEntries = 2e7;
    const auto senses_and_directions = static_cast<double>(senses.size() + 2);
    if (senses_and_directions * l.count * static_cast<double>(losing.size()) > kMostEntries) {
      continue;
    }
    const Eigen::MatrixXd inside = indicators(l);
    for (int k = 0; k < l.count; ++k) {
      const auto level = static_cast<std::size_t>(k);
      LevelGroup group{.along = l.name,
                       .level = k,
                       .at = level < l.at.size() ? l.at[level] : kUnknown,
                       .binned = l.binned};
      add(group, inside.col(k));
      if (!varies(losing) || l.name == "direction") continue;
      for (const int direction : {1, -1}) {
        const Eigen::VectorXd one =
            (losing.array() == static_cast<double>(direction)).cast<double>();
        group.direction = direction;
        add(group, inside.col(k).cwiseProduct(one));
      }
    }
  }
  result.columns.resize(losing.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    result.columns.col(static_cast<Eigen::Index>(k)) = columns[k];
    columns[k].resize(0);
  }
  return result;
}

std::string level_text(const MeasurementSet& data, const LevelGroup& group) {
  const auto k = static_cast<std::size_t>(group.level);
  const std::string_view way = group.direction > 0   ? ", forward"
                               : group.direction < 0 ? ", backward"
                                                     : "";
  if (group.along == "run" && k < data.runs.size()) {
    return fmt::format("session {}{}", data.runs[k], way);
  }
  if (group.along == "direction") {
    return fmt::format("direction {}", group.at > 0.0 ? "forward" : "backward");
  }
  if (!std::isfinite(group.at)) return fmt::format("one {}{}", group.along, way);
  return fmt::format("{} {}{:.4g}{}", group.along, group.binned ? "about " : "", group.at, way);
}

}  // namespace gear3k::calibrate
