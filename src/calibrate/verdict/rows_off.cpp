#include "calibrate/verdict/rows_off.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "calibrate/measurement/level_groups.hpp"
#include "calibrate/search/rows_together.hpp"
#include "numerics/distributions.hpp"

namespace gear3k::calibrate {

namespace {

/// The rate that rows off together get, over that of all other structure: without a cause even
/// three of them beyond the clip are rare.
constexpr double kOfRate = 2.0;

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
  // Sessions that scatter are noise.
  const LevelGroups groups =
      level_groups(problem.data, levels, !(problem.noise.session_variance > 0.0));
  const auto found = rows_together(raw, bound / kWinsor, groups.columns);
  if (!found || found->p_value > kOfRate * rate) return std::nullopt;
  const LevelGroup& group = groups.group[static_cast<std::size_t>(found->group)];
  EmpiricalTerm term{.along = group.along, .columns = groups.columns.col(found->group)};
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
  return numerics::binomial_upper_tail(static_cast<int>(rows), kMost, static_cast<int>(outliers));
}

}  // namespace gear3k::calibrate
