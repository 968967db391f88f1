#include "calibrate/verdict/wild_rows.hpp"

#include <algorithm>
#include <cmath>

#include "calibrate/fit/fit.hpp"
#include "calibrate/measurement/level_groups.hpp"
#include "calibrate/measurement/noise.hpp"
#include "calibrate/search/rows_together.hpp"

namespace gear3k::calibrate {

namespace {

constexpr double kWildDeviations = 20.0;
constexpr double kWildShare = 0.5;  // of the greater of two values: a factor of two
constexpr double kMostWild = 0.05;  // of the rows
constexpr double kSomeWild = 3.0;
constexpr std::size_t kFewestTold = 8;
constexpr double kTogetherChance = 0.01;

}  // namespace

std::vector<char> wild_rows(const MeasurementSet& data, const Eigen::VectorXd& simulated,
                            const std::vector<Levels>& levels) {
  std::vector<char> wild(data.rows.size(), 0);
  if (data.kind == Kind::kTorqueAngle || data.rows.size() < kFewestTold) return wild;
  const Eigen::VectorXd y = measured(data);
  const Eigen::VectorXd residual = (y - simulated).cwiseProduct(make_noise_model(data).weight);
  const double scale = robust_deviation(residual);
  if (!(scale > 0.0)) return wild;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const double greater = std::max(std::abs(y[i]), std::abs(simulated[i]));
    const bool is_wild = std::abs(residual[i]) > kWildDeviations * scale &&
                         std::abs(y[i] - simulated[i]) > kWildShare * greater;
    wild[static_cast<std::size_t>(i)] = is_wild ? 1 : 0;
  }
  if (std::ranges::count(wild, 1) == 0) return wild;
  const LevelGroups groups = level_groups(data, levels);
  Eigen::VectorXd far = residual;
  while (const auto together = rows_together(far, scale, groups.columns)) {
    if (together->p_value > kTogetherChance) break;
    for (Eigen::Index i = 0; i < far.size(); ++i) {
      if (groups.columns(i, together->group) == 0.0) continue;
      far[i] = 0.0;
      wild[static_cast<std::size_t>(i)] = 0;
    }
  }
  const auto count = static_cast<double>(std::ranges::count(wild, 1));
  if (count > std::max(kSomeWild, kMostWild * static_cast<double>(wild.size()))) {
    std::ranges::fill(wild, 0);
  }
  return wild;
}

}  // namespace gear3k::calibrate
