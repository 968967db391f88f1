#include "calibrate/verdict/rows_off.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "calibrate/search/rows_together.hpp"

namespace gear3k::calibrate {

namespace {

/// The rate that rows off together get, over that of all other structure: without a cause even
/// three of them beyond the clip are rare.
constexpr double kOfRate = 2.0;

/// A level, or a level in one direction.
struct LevelGroup {
  const Levels* levels = nullptr;
  int level = 0;
  int direction = 0;  ///< ±1, 0: both
};

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

/// Levels with the senses in which the rows of one may be off: of the reading, of what is lost, and
/// of a sensor, which turn with the direction, the rotation or both.
struct LevelGroups {
  std::vector<LevelGroup> group;  ///< of each column
  Eigen::MatrixXd columns;
};
/// @param levels  those of sessions one by one; where sessions scatter they are noise
LevelGroups groups_of(const Problem& problem, const std::vector<Levels>& levels) {
  const MeasurementSet& data = problem.data;
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
  for (const Levels& l : levels) {
    if (l.name == "run" && (l.binned || problem.noise.session_variance > 0.0)) continue;
    const Eigen::MatrixXd inside = indicators(l);
    for (int k = 0; k < l.count; ++k) {
      add({.levels = &l, .level = k}, inside.col(k));
      if (!varies(losing) || l.name == "direction") continue;
      for (const int direction : {1, -1}) {
        const Eigen::VectorXd one =
            (losing.array() == static_cast<double>(direction)).cast<double>();
        add({.levels = &l, .level = k, .direction = direction}, inside.col(k).cwiseProduct(one));
      }
    }
  }
  result.columns.resize(losing.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    result.columns.col(static_cast<Eigen::Index>(k)) = columns[k];
  }
  return result;
}

/// Of many sessions levels are bins.
Levels each_session(const MeasurementSet& data) {
  Levels l{.name = "run", .of = {}, .count = static_cast<int>(data.runs.size())};
  l.of.reserve(data.rows.size());
  for (const Observation& row : data.rows) l.of.push_back(row.condition.run);
  return l;
}

std::string level_text(const MeasurementSet& data, const LevelGroup& group) {
  const Levels& l = *group.levels;
  const auto k = static_cast<std::size_t>(group.level);
  const std::string_view way = group.direction > 0   ? ", forward"
                               : group.direction < 0 ? ", backward"
                                                     : "";
  if (l.name == "run" && k < data.runs.size()) {
    return fmt::format("session {}{}", data.runs[k], way);
  }
  if (l.name == "direction") {
    return fmt::format("direction {}", k < l.at.size() && l.at[k] > 0.0 ? "forward" : "backward");
  }
  if (k >= l.at.size()) return fmt::format("one {}{}", l.name, way);
  return fmt::format("{} {}{:.4g}{}", l.name, l.binned ? "about " : "", l.at[k], way);
}

}  // namespace

std::optional<std::string> take_level_off(const Problem& problem, const Columns& columns,
                                          const std::vector<Levels>& levels, double rate,
                                          RemainderSearch& search) {
  const Eigen::VectorXd& raw = columns.raw;
  if (search.p_value <= rate || raw.size() == 0 || problem.noise.within_rounding(raw)) {
    return std::nullopt;
  }
  const double bound = columns.residual.cwiseAbs().maxCoeff();
  if (!((raw - columns.residual).array() != 0.0).any()) return std::nullopt;
  std::vector<Levels> each = levels;
  for (Levels& l : each) {
    if (l.name == "run" && l.binned) l = each_session(problem.data);
  }
  const LevelGroups groups = groups_of(problem, each);
  const auto found = rows_together(raw, bound / kWinsor, groups.columns);
  if (!found || found->p_value > kOfRate * rate) return std::nullopt;
  const LevelGroup& group = groups.group[static_cast<std::size_t>(found->group)];
  EmpiricalTerm term{.along = group.levels->name, .columns = groups.columns.col(found->group)};
  problem.noise.whiten(term.columns);
  const Screen screen(columns.own, term.columns, {{.first = 0, .count = 1}}, 0.0);
  const Gain gain = screen.gains(columns.residual).front();
  term.evidence = gain.evidence;
  term.statistic = gain.statistic;
  term.p_value = search.p_value = found->p_value / kOfRate;
  search.best = std::move(term);
  return fmt::format(
      "{} of the {} rows of {} are far off in the same sense, which outliers are not: look at what "
      "was different there",
      found->off, found->rows, level_text(problem.data, group));
}

double chance_of_outliers(std::size_t outliers, std::size_t rows) {
  constexpr double kMost = 0.15;
  const auto n = static_cast<double>(rows);
  double sum = 0.0;
  for (auto k = static_cast<double>(outliers); k <= n; ++k) {
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                    k * std::log(kMost) + (n - k) * std::log1p(-kMost));
  }
  return std::min(1.0, sum);
}

}  // namespace gear3k::calibrate
