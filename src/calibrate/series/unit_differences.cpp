#include "calibrate/series/unit_differences.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/screen.hpp"
#include "calibrate/measurement/covariate_levels.hpp"

namespace gear3k::calibrate {

namespace {

constexpr int kDifferenceDraws = 192;

/// Of more rows, as many at random places; fewer where columns by gearbox would take gigabytes, but
/// some of each.
constexpr double kMostRowsCompared = 12000.0;
constexpr double kMostEntriesCompared = 8e6;
constexpr double kFewestRowsCompared = 24.0;

/// Share of the rows that is looked at.
double looked_at(double rows, double columns, double gearboxes) {
  const double fitting = std::max(kMostEntriesCompared / columns, kFewestRowsCompared * gearboxes);
  return std::min({1.0, kMostRowsCompared / rows, fitting / rows});
}

/// The rows of all gearboxes, one gearbox after the other.
MeasurementSet all_rows(const std::deque<SeriesUnit>& units) {
  MeasurementSet all;
  all.kind = units.front().data.kind;
  for (const Covariate& c : units.front().data.covariates) {
    all.covariates.push_back({.name = c.name, .value = {}});
  }
  for (const SeriesUnit& unit : units) {
    all.rows.insert(all.rows.end(), unit.data.rows.begin(), unit.data.rows.end());
    for (std::size_t k = 0; k < all.covariates.size(); ++k) {
      const std::vector<double>& more = unit.data.covariates[k].value;
      all.covariates[k].value.insert(all.covariates[k].value.end(), more.begin(), more.end());
    }
  }
  return all;
}

/// Covariates along which gearboxes may differ.
std::vector<Levels> levels_of(const MeasurementSet& all) {
  std::vector<Levels> levels = covariate_levels(all);
  std::erase_if(levels, [](const Levels& l) {
    return l.name == "run" || l.name == "time" || l.name == "session time";
  });
  Levels constant{.name = "", .of = std::vector<int>(all.rows.size(), 0), .count = 1};
  levels.insert(levels.begin(), std::move(constant));
  return levels;
}

}  // namespace

std::vector<UnitDifference> unit_differences(const std::deque<SeriesUnit>& units,
                                             const JointFit& fit, double rate, std::uint64_t seed) {
  const MeasurementSet all = all_rows(units);
  const std::vector<Levels> levels = levels_of(all);
  const auto count = static_cast<Eigen::Index>(units.size());
  const auto values = static_cast<Eigen::Index>(fit.units.front().fit.hypothesis.value.size());
  Eigen::Index width = 0;
  for (const Levels& l : levels) width += l.count;
  const double share = looked_at(static_cast<double>(all.rows.size()),
                                 static_cast<double>(values * count + width * (count + 1)),
                                 static_cast<double>(count));
  std::vector<std::vector<Eigen::Index>> kept;
  Eigen::Index rows = 0;
  for (const SeriesUnit& unit : units) {
    kept.push_back(places_at_random(static_cast<Eigen::Index>(unit.data.rows.size()), share,
                                    seed + 101 + kept.size()));
    rows += static_cast<Eigen::Index>(kept.back().size());
  }
  Eigen::VectorXd residual(rows);
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(rows, values * count + width);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, width * count);
  std::vector<Block> blocks;
  std::vector<std::pair<std::size_t, std::size_t>> of_block;  // gearbox, levels
  Eigen::Index row = 0;
  Eigen::Index row_of_all = 0;
  for (Eigen::Index u = 0; u < count; ++u) {
    const auto place = static_cast<std::size_t>(u);
    const Problem& problem = units[place].problem;
    const UnitFit& f = fit.units[place];
    const Columns at = columns_at(problem, f.fit.hypothesis, {}, f.scale);
    const std::vector<Eigen::Index>& places = kept[place];
    const Eigen::Index unit_rows = at.residual.size();
    const auto n = static_cast<Eigen::Index>(places.size());
    residual.segment(row, n) = at.residual(places) / f.scale;
    own.block(row, values * u, n, values) = at.own(places, Eigen::all) / f.scale;
    Eigen::Index first = 0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const Levels& l = levels[k];
      Eigen::MatrixXd marks = Eigen::MatrixXd::Zero(unit_rows, l.count);
      for (Eigen::Index i = 0; i < unit_rows; ++i) {
        const int level = l.of[static_cast<std::size_t>(row_of_all + i)];
        if (level >= 0) marks(i, level) = 1.0;
      }
      problem.noise.whiten(marks);
      const Eigen::MatrixXd scaled = marks(places, Eigen::all) / f.scale;
      own.block(row, values * count + first, n, l.count) = scaled;
      columns.block(row, width * u + first, n, l.count) = scaled;
      blocks.push_back({.first = width * u + first, .count = l.count});
      of_block.emplace_back(place, k);
      first += l.count;
    }
    row += n;
    row_of_all += unit_rows;
  }
  std::vector<UnitDifference> result(units.size());
  if (own.cols() >= rows) return result;
  const Screen screen(own, std::move(columns), std::move(blocks), 0.0);
  const std::vector<Gain> gains = screen.gains(residual);
  const Screen::Luck luck =
      screen.luck(residual, rate, kDifferenceDraws, seed, Screen::Chance::kSigns);
  for (std::size_t b = 0; b < gains.size(); ++b) {
    const double p = luck.p_value(gains[b].evidence);
    UnitDifference& d = result[of_block[b].first];
    if (!(p < d.p_value)) continue;
    d.p_value = p;
    if (p <= rate) d.along = levels[of_block[b].second].name;
  }
  return result;
}

}  // namespace gear3k::calibrate
