#include "calibrate/remainder.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

namespace gear3k::calibrate {

namespace {

constexpr std::size_t kMostLevels = 8;

/// Levels of a variable; none where it does not vary.
Levels levels_of(std::string name, const std::vector<double>& values, double per_unit,
                 double offset) {
  Levels levels{.name = std::move(name), .of = std::vector<int>(values.size(), -1)};
  std::vector<double> sorted;
  for (const double v : values) {
    if (std::isfinite(v)) sorted.push_back(v);
  }
  if (sorted.empty()) return levels;
  std::ranges::sort(sorted);
  const double span = sorted.back() - sorted.front();
  if (!(span > 0.0)) return levels;
  // Values that differ by less than 2 % of the range are one level.
  constexpr double kSame = 0.02;
  std::vector<double> edges;  // lower edges of all levels but the first
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    if (sorted[k] - sorted[k - 1] > kSame * span)
      edges.push_back(0.5 * (sorted[k] + sorted[k - 1]));
  }
  const bool clustered = !edges.empty() && edges.size() < kMostLevels;
  if (!clustered) {
    edges.clear();
    const std::size_t bins = std::min<std::size_t>(kMostLevels, sorted.size() / 8);
    for (std::size_t k = 1; k < bins; ++k) edges.push_back(sorted[k * sorted.size() / bins]);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
  levels.count = static_cast<int>(edges.size()) + 1;
  levels.at.assign(static_cast<std::size_t>(levels.count), 0.0);
  std::vector<double> rows(levels.at.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const auto level =
        static_cast<std::size_t>(std::ranges::upper_bound(edges, values[i]) - edges.begin());
    levels.of[i] = static_cast<int>(level);
    levels.at[level] += (values[i] - offset) / per_unit;
    rows[level] += 1.0;
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] > 0.0) levels.at[k] /= rows[k];
  }
  return levels;
}

Eigen::MatrixXd indicators(const Levels& levels) {
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(levels.of.size()), levels.count);
  for (std::size_t i = 0; i < levels.of.size(); ++i) {
    if (levels.of[i] >= 0) columns(static_cast<Eigen::Index>(i), levels.of[i]) = 1.0;
  }
  return columns;
}

/// Levels of two covariates together.
Levels crossed(const Levels& a, const Levels& b) {
  Levels result{.name = a.name, .of = std::vector<int>(a.of.size(), -1)};
  std::map<std::pair<int, int>, int> cells;
  for (std::size_t i = 0; i < a.of.size(); ++i) {
    if (a.of[i] < 0 || b.of[i] < 0) continue;
    const auto [at, inserted] =
        cells.emplace(std::pair(a.of[i], b.of[i]), static_cast<int>(cells.size()));
    result.of[i] = at->second;
  }
  result.count = static_cast<int>(cells.size());
  return result;
}

/// Share of the residual's squares that a wave of an order takes off, and its columns.
struct Wave {
  double share = 0.0;
  Eigen::MatrixXd columns;
};
Wave wave_of(Eigen::MatrixXd columns, const Problem& problem, const Eigen::MatrixXd& own_basis,
             const Eigen::VectorXd& left) {
  problem.noise.whiten(columns);
  if (own_basis.cols() > 0) columns -= own_basis * (own_basis.transpose() * columns);
  const Eigen::Matrix2d gram = columns.transpose() * columns;
  const Eigen::Vector2d moment = columns.transpose() * left;
  const double determinant = gram.determinant();
  Wave wave;
  if (determinant > 1e-9 * gram(0, 0) * gram(1, 1)) {
    wave.share = moment.dot(gram.inverse() * moment) / left.squaredNorm();
  }
  wave.columns = std::move(columns);
  return wave;
}

/// Cosine and sine of an order of a phase; 0 where the phase is not known.
Eigen::MatrixXd waves(const std::vector<double>& phase, double order) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(phase.size()), 2);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double angle = order * phase[static_cast<std::size_t>(i)];
    columns(i, 0) = std::isfinite(angle) ? std::cos(angle) : 0.0;
    columns(i, 1) = std::isfinite(angle) ? std::sin(angle) : 0.0;
  }
  return columns;
}

struct Scan {
  std::vector<double> order, share;
  std::size_t best = 0;
  double evidence = 0.0;  ///< of the best, paid for by the number of orders
};

/// Orders from `first` in `count` steps of `step`.
Scan scan_orders(const std::vector<double>& phase, double first, double step, int count,
                 const Problem& problem, const Eigen::MatrixXd& own_basis,
                 const Eigen::VectorXd& left) {
  Scan scan;
  scan.order.resize(static_cast<std::size_t>(count));
  scan.share.resize(scan.order.size());
  // Neighbouring orders follow from one another by a rotation; begun afresh every so often.
  constexpr int kFresh = 128;
  const Eigen::MatrixXd turn = waves(phase, step);
#pragma omp parallel for schedule(static) if (left.size() > 2000)
  for (int start = 0; start < count; start += kFresh) {
    Eigen::MatrixXd now = waves(phase, first + step * start);
    for (int k = start; k < std::min(count, start + kFresh); ++k) {
      const auto at = static_cast<std::size_t>(k);
      scan.order[at] = first + step * k;
      scan.share[at] = wave_of(now, problem, own_basis, left).share;
      const Eigen::ArrayXd cosine =
          now.col(0).array() * turn.col(0).array() - now.col(1).array() * turn.col(1).array();
      now.col(1) =
          now.col(1).array() * turn.col(0).array() + now.col(0).array() * turn.col(1).array();
      now.col(0) = cosine;
    }
  }
  if (count == 0) return scan;
  scan.best = static_cast<std::size_t>(std::ranges::max_element(scan.share) - scan.share.begin());
  const auto degrees = static_cast<double>(left.size() - own_basis.cols() - 2);
  const double kept = std::max(1.0 - scan.share[scan.best], 1e-12);
  // Two parameters: P = (1 − share)^(ν/2).
  scan.evidence = -0.5 * degrees * std::log(kept) - std::log(static_cast<double>(count));
  return scan;
}

/// A covariate as a number: those with a natural zero over their greatest value, others from −1 to
/// 1 over their range.
struct Trend {
  std::string name;
  Eigen::VectorXd value;
};

std::vector<Trend> trends_of(const MeasurementSet& data) {
  std::vector<Trend> result;
  const auto n = static_cast<Eigen::Index>(data.rows.size());
  const auto add = [&](const char* name, bool natural_zero, auto get) {
    Eigen::VectorXd value(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      value[i] = get(data.rows[static_cast<std::size_t>(i)].condition);
    }
    if (!value.allFinite()) return;
    const double low = value.minCoeff();
    const double high = value.maxCoeff();
    if (!(high > low)) return;
    if (natural_zero) {
      value /= high;
    } else {
      value = (2.0 * value.array() - low - high) / (high - low);
    }
    result.push_back({.name = name, .value = std::move(value)});
  };
  add("load", true, [](const Condition& c) { return c.output_torque_Nm; });
  add("speed", true, [](const Condition& c) { return c.sun_speed_rad_s; });
  add("test torque", true, [](const Condition& c) { return c.test_torque_Nm; });
  add("temperature", false, [](const Condition& c) { return c.temperature_K; });
  add("time", false, [](const Condition& c) { return c.time_s; });
  add("direction", false,
      [](const Condition& c) { return c.direction == design::Direction::kForward ? 1.0 : -1.0; });
  add("rotation", false, [](const Condition& c) { return static_cast<double>(c.rotation); });
  return result;
}

/// +1 forward, −1 backward.
Eigen::VectorXd losing_sign(const MeasurementSet& data) {
  Eigen::VectorXd sign(static_cast<Eigen::Index>(data.rows.size()));
  for (Eigen::Index i = 0; i < sign.size(); ++i) {
    const Condition& c = data.rows[static_cast<std::size_t>(i)].condition;
    sign[i] = c.direction == design::Direction::kForward ? 1.0 : -1.0;
  }
  return sign;
}

std::vector<double> column_of(const MeasurementSet& data, double Condition::*member) {
  std::vector<double> result;
  result.reserve(data.rows.size());
  for (const Observation& row : data.rows) result.push_back(row.condition.*member);
  return result;
}

}  // namespace

std::vector<Levels> covariate_levels(const MeasurementSet& data) {
  constexpr double kRpm = std::numbers::pi / 30.0;
  std::vector<Levels> result;
  const auto add = [&](std::string name, const std::vector<double>& values, double per_unit,
                       double offset) {
    Levels levels = levels_of(std::move(name), values, per_unit, offset);
    if (levels.count > 1) result.push_back(std::move(levels));
  };
  const auto integers = [&](auto get) {
    std::vector<double> values;
    values.reserve(data.rows.size());
    for (const Observation& row : data.rows) values.push_back(get(row.condition));
    return values;
  };
  add("load", column_of(data, &Condition::output_torque_Nm), 1.0, 0.0);
  add("speed", column_of(data, &Condition::sun_speed_rad_s), kRpm, 0.0);
  add("test torque", column_of(data, &Condition::test_torque_Nm), 1.0, 0.0);
  add("temperature", column_of(data, &Condition::temperature_K), 1.0, 273.15);
  add("time", column_of(data, &Condition::time_s), 1.0, 0.0);
  add("cycles", column_of(data, &Condition::cycles), 1.0, 0.0);
  add("direction", integers([](const Condition& c) {
        return c.direction == design::Direction::kForward ? 1.0 : -1.0;
      }),
      1.0, 0.0);
  add("rotation", integers([](const Condition& c) { return static_cast<double>(c.rotation); }), 1.0,
      0.0);
  add("driving teeth",
      integers([](const Condition& c) { return static_cast<double>(c.driving_teeth); }), 1.0, 0.0);
  add("driven teeth",
      integers([](const Condition& c) { return static_cast<double>(c.driven_teeth); }), 1.0, 0.0);
  if (data.runs.size() > 1) {
    add("run", integers([](const Condition& c) { return static_cast<double>(c.run); }), 1.0, 0.0);
  }
  for (const Covariate& c : data.covariates) add(c.name, c.value, 1.0, 0.0);
  return result;
}

RemainderSearch search_remainder(const Problem& problem, const Columns& at,
                                 const std::vector<Levels>& levels, double rate,
                                 std::uint64_t seed) {
  RemainderSearch result;
  const Eigen::Index n = at.residual.size();
  const Eigen::MatrixXd own_basis = orthonormal_basis(at.own);
  Eigen::VectorXd left = at.residual;
  if (own_basis.cols() > 0) left -= own_basis * (own_basis.transpose() * left);
  if (n - own_basis.cols() < 8 || !(left.squaredNorm() > 0.0)) return result;

  struct Term {
    std::string along;
    Eigen::MatrixXd columns;
    bool main;
    double weight;
  };
  std::vector<Term> terms;
  const auto add = [&](const Levels& l, bool main, double weight) {
    // A term of a third of the rows explains anything.
    if (l.count < 2 || l.count > n / 3) return;
    Eigen::MatrixXd columns = indicators(l);
    problem.noise.whiten(columns);
    terms.push_back(
        {.along = l.name, .columns = std::move(columns), .main = main, .weight = weight});
  };
  const auto find = [&](std::string_view name) {
    return std::ranges::find(levels, name, &Levels::name);
  };
  for (const Levels& l : levels) {
    // Sessions that scatter are part of the noise.
    if (l.name == "run" && problem.noise.session_variance > 0.0) continue;
    add(l, true, 1.0);
    for (const char* other : {"direction", "rotation"}) {
      const auto o = find(other);
      if (o != levels.end() && o->name != l.name) add(crossed(l, *o), false, 0.5);
    }
  }
  // What is lost adds to the sun's torque forward and takes from it backward.
  const Eigen::VectorXd losing = losing_sign(problem.data);
  for (const Levels& l : levels) {
    if (l.name == "direction" || l.count > n / 3) continue;
    if (l.name == "run" && problem.noise.session_variance > 0.0) continue;
    Eigen::MatrixXd columns = indicators(l);
    columns.array().colwise() *= losing.array();
    problem.noise.whiten(columns);
    terms.push_back({.along = l.name, .columns = std::move(columns), .main = false, .weight = 0.7});
  }
  const auto load = find("load");
  const auto speed = find("speed");
  const auto direction = find("direction");
  const auto rotation = find("rotation");
  if (load != levels.end() && speed != levels.end()) {
    add(crossed(*load, *speed), false, 0.3);
    if (direction != levels.end()) add(crossed(crossed(*load, *speed), *direction), false, 0.3);
  }
  if (load != levels.end() && direction != levels.end() && rotation != levels.end()) {
    add(crossed(crossed(*load, *direction), *rotation), false, 0.3);
  }
  const auto add_column = [&](const std::string& along, const Eigen::VectorXd& column,
                              double weight) {
    Eigen::MatrixXd columns = column;
    problem.noise.whiten(columns);
    terms.push_back(
        {.along = along, .columns = std::move(columns), .main = false, .weight = weight});
  };
  // One cell of loads and speeds by itself.
  if (load != levels.end() && speed != levels.end()) {
    const Levels cells = crossed(*load, *speed);
    constexpr int kMostCells = 64;
    if (cells.count <= kMostCells) {
      const Eigen::MatrixXd each = indicators(cells);
      const double share = 0.5 / static_cast<double>(each.cols());
      for (Eigen::Index k = 0; k < each.cols(); ++k) {
        add_column(load->name, each.col(k), share);
        add_column(load->name, each.col(k).cwiseProduct(losing), share);
      }
    }
  }
  // Products of up to three covariates.
  const std::vector<Trend> trends = trends_of(problem.data);
  std::vector<std::pair<std::string, Eigen::VectorXd>> products;
  for (std::size_t i = 0; i < trends.size(); ++i) {
    products.emplace_back(trends[i].name, trends[i].value);
    for (std::size_t j = i; j < trends.size(); ++j) {
      const Eigen::VectorXd two = trends[i].value.cwiseProduct(trends[j].value);
      products.emplace_back(trends[i].name, two);
      for (std::size_t k = j; k < trends.size(); ++k) {
        products.emplace_back(trends[i].name, two.cwiseProduct(trends[k].value));
      }
    }
  }
  for (const auto& [along, column] : products) {
    add_column(along, column, 1.0 / static_cast<double>(products.size()));
  }
  Eigen::Index total = 0;
  for (const Term& t : terms) total += t.columns.cols();
  Eigen::MatrixXd all(n, total);
  std::vector<Block> blocks;
  Eigen::Index first = 0;
  double sum = 0.0;
  for (const Term& t : terms) sum += t.weight;
  for (const Term& t : terms) {
    all.middleCols(first, t.columns.cols()) = t.columns;
    blocks.push_back({.first = first,
                      .count = t.columns.cols(),
                      .side = 0,
                      .log_weight = std::log(t.weight / sum)});
    first += t.columns.cols();
  }
  if (!terms.empty()) {
    const Screen screen(at.own, all, blocks, 0.0);
    const std::vector<Gain> gains = screen.gains(left);
    const auto luck =
        screen.luck(left, rate, n > 5000 ? 128 : 256, seed, Screen::Chance::kShuffled);
    std::size_t best = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const double own_evidence = gains[k].evidence - blocks[k].log_weight;
      if (terms[k].main) {
        result.tests.push_back({.name = terms[k].along,
                                .statistic = gains[k].statistic,
                                .degrees = static_cast<int>(terms[k].columns.cols()) - 1,
                                .p_value = std::exp(-own_evidence)});
      }
      if (gains[k].evidence > gains[best].evidence) best = k;
    }
    result.best = {.along = terms[best].along,
                   .columns = terms[best].columns,
                   .evidence = gains[best].evidence,
                   .p_value = luck.p_value(gains[best].evidence),
                   .statistic = gains[best].statistic};
    result.p_value = result.best.p_value;
  }
  int searches = 1;
  const auto consider = [&](const char* along, const std::vector<double>& phase, const Scan& scan,
                            double order_unit) {
    if (scan.order.empty()) return;
    const double p = std::exp(-scan.evidence);
    result.tests.push_back({.name = along,
                            .statistic = -2.0 * std::log(1.0 - scan.share[scan.best]) * 0.5 *
                                         static_cast<double>(n - own_basis.cols()),
                            .degrees = 2,
                            .p_value = std::min(1.0, p)});
    ++searches;
    if (p >= result.p_value) return;
    const Wave wave = wave_of(waves(phase, scan.order[scan.best]), problem, own_basis, left);
    result.best = {.along = along,
                   .columns = wave.columns,
                   .order = scan.order[scan.best] * order_unit,
                   .evidence = scan.evidence,
                   .p_value = p,
                   .statistic = result.tests.back().statistic};
    result.p_value = p;
  };
  const std::vector<double> angle = column_of(problem.data, &Condition::output_angle_rad);
  const auto range_of = [](const std::vector<double>& values) {
    std::array<double, 2> range{kUnknown, kUnknown};
    for (const double v : values) {
      if (!std::isfinite(v)) continue;
      if (!(range[0] <= v)) range[0] = v;
      if (!(range[1] >= v)) range[1] = v;
    }
    return range;
  };
  constexpr int kMostOrders = 6000;
  if (const auto range = range_of(angle); range[1] > range[0]) {
    const double revolutions = (range[1] - range[0]) / (2.0 * std::numbers::pi);
    // Half the resolution; up to the sun's order and beyond while there are orders left.
    const double step = 0.5 / revolutions;
    const double highest = std::max(2.0, 1.25 * std::abs(problem.simulation.ratio()));
    const int count = std::min(n > 5000 ? 1000 : kMostOrders, static_cast<int>(highest / step));
    const Scan scan = scan_orders(angle, 2.0 * step, step, count, problem, own_basis, left);
    result.periodogram = {.order = scan.order, .power = scan.share};
    consider("angle", angle, scan, 1.0);
  }
  const std::vector<double> time = column_of(problem.data, &Condition::time_s);
  if (const auto range = range_of(time); range[1] > range[0]) {
    std::vector<double> phase(time.size());
    std::ranges::transform(time, phase.begin(), [&](double t) {
      return 2.0 * std::numbers::pi * (t - range[0]) / (range[1] - range[0]);
    });
    const int count = static_cast<int>(std::min<Eigen::Index>(n, 200));
    consider("time", phase, scan_orders(phase, 1.0, 0.5, count, problem, own_basis, left), 1.0);
  }
  result.p_value = std::min(1.0, result.p_value * searches);
  result.best.p_value = result.p_value;
  return result;
}

}  // namespace gear3k::calibrate
