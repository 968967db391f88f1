#include "calibrate/verdict/remainder.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include "calibrate/measurement/commanded_torque.hpp"
#include "calibrate/measurement/value_range.hpp"
#include "calibrate/search/order_scan.hpp"

namespace gear3k::calibrate {

namespace {

/// From here on fewer simulations and orders must do.
constexpr Eigen::Index kManyScreenedRows = 5000;

/// A covariate as a number: those with a natural zero over their greatest value, others from −1 to
/// 1 over their range.
struct Trend {
  std::string name;
  Eigen::VectorXd value;
};

std::vector<Trend> trends_of(const MeasurementSet& data) {
  std::vector<Trend> result;
  const auto n = static_cast<Eigen::Index>(data.rows.size());
  const auto add_values = [&](const char* name, bool natural_zero, Eigen::VectorXd value) {
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
  const auto add = [&](const char* name, bool natural_zero, auto get) {
    Eigen::VectorXd value(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      value[i] = get(data.rows[static_cast<std::size_t>(i)].condition);
    }
    add_values(name, natural_zero, std::move(value));
  };
  if (!is_commanded(data)) {
    add("load", true, [](const Condition& c) { return c.output_torque_Nm; });
  }
  add("speed", true, [](const Condition& c) { return c.sun_speed_rad_s; });
  add("test torque", true, [](const Condition& c) { return c.test_torque_Nm; });
  add("temperature", false, [](const Condition& c) { return c.temperature_K; });
  const std::vector<double> times = reading_times(data);
  add_values("time", false, Eigen::Map<const Eigen::VectorXd>(times.data(), n));
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

/// A column for each level of more than one row: that of a single row would only say how far off it
/// is.
Eigen::MatrixXd indicators_of_several(const Levels& levels) {
  Eigen::MatrixXd columns = indicators(levels);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    if (columns.col(k).sum() < 2.0) columns.col(k).setZero();
  }
  return columns;
}

/// What a term is to the table of covariates: nothing, the levels of one, or what they lose.
enum class Entry { kNone, kLevels, kLosses };

/// A term that a covariate, or several, could add.  Its columns are made when they are asked for:
/// hundreds of them for many rows are hundreds of megabytes.
struct Term {
  std::string along;
  Eigen::Index count = 0;                  // of its columns
  std::function<Eigen::MatrixXd()> plain;  // not whitened
  Entry entry = Entry::kNone;
  double weight = 1.0;

  [[nodiscard]] Eigen::MatrixXd columns(const NoiseModel& noise) const {
    Eigen::MatrixXd result = plain();
    noise.whiten(result);
    return result;
  }
};

/// Terms of the rows of a problem, each with its weight before the data.
class TermCollection {
 public:
  TermCollection(const Problem& problem, const std::vector<Levels>& levels)
      : problem_(problem),
        levels_(levels),
        losing_(losing_sign(problem.data)),
        both_ways_((losing_.array() != losing_[0]).any()) {
    add_constant();
    add_levels();
    add_cells();
    add_products();
  }
  [[nodiscard]] const std::vector<Term>& terms() const { return terms_; }
  /// The first term: what is there under all conditions alike, which is structure along none.
  [[nodiscard]] Eigen::MatrixXd constant() const { return terms_.front().columns(problem_.noise); }
  /// The same as a loss; whitened.
  [[nodiscard]] Eigen::MatrixXd constant_loss() const {
    Eigen::MatrixXd column = losing_;
    problem_.noise.whiten(column);
    return column;
  }

 private:
  [[nodiscard]] const Levels* find(std::string_view name) const {
    const auto found = std::ranges::find(levels_, name, &Levels::name);
    return found == levels_.end() ? nullptr : &*found;
  }
  /// A term of a third of the rows explains anything.
  [[nodiscard]] bool few(const Levels& l) const {
    return l.count <= static_cast<int>(problem_.data.rows.size() / 3);
  }
  /// Neighbours together until they are few: rows of few loops have as many torques as loops.
  [[nodiscard]] Levels in_few(Levels l) const {
    const int most = static_cast<int>(problem_.data.rows.size() / 3);
    if (l.count <= most || most < 2) return l;
    for (int& level : l.of) {
      if (level >= 0) level = level * most / l.count;
    }
    l.count = most;
    l.at.clear();
    return l;
  }
  /// Sessions that scatter are part of the noise.
  [[nodiscard]] bool is_noise(const Levels& l) const {
    return l.name == "run" && problem_.noise.session_variance > 0.0;
  }
  void add(Term term) { terms_.push_back(std::move(term)); }
  void add(const Levels& l, Entry entry, double weight) {
    if (l.count < 2 || !few(l)) return;
    add({.along = l.name,
         .count = l.count,
         .plain = [l] { return indicators_of_several(l); },
         .entry = entry,
         .weight = weight});
  }

  void add_constant() {
    const auto n = static_cast<Eigen::Index>(problem_.data.rows.size());
    add({.along = "", .count = 1, .plain = [n] { return Eigen::MatrixXd::Ones(n, 1); }});
  }

  /// Levels of a covariate, by themselves and by direction or rotation, and of several together.
  void add_levels() {
    for (const Levels& l : levels_) {
      if (is_noise(l)) continue;
      add(l.name == "run" ? l : in_few(l), Entry::kLevels, 1.0);
      for (const char* other : {"direction", "rotation"}) {
        const Levels* o = find(other);
        if (o != nullptr && o->name != l.name) add(crossed(l, *o), Entry::kNone, 0.5);
      }
    }
    for (const Levels& l : tooth_levels(problem_.data)) add(l, Entry::kNone, 0.5);
    // What is lost adds to the sun's torque forward and takes from it backward.
    for (const Levels& l : levels_) {
      if (!both_ways_ || l.name == "direction" || !few(l) || is_noise(l)) continue;
      add({.along = l.name,
           .count = l.count,
           .plain =
               [l, losing = losing_] {
                 Eigen::MatrixXd columns = indicators_of_several(l);
                 columns.array().colwise() *= losing.array();
                 return columns;
               },
           .entry = Entry::kLosses,
           .weight = 0.7});
    }
    const Levels* load = find("load");
    const Levels* speed = find("speed");
    const Levels* direction = find("direction");
    const Levels* rotation = find("rotation");
    if (load != nullptr && speed != nullptr) {
      add(crossed(*load, *speed), Entry::kNone, 0.3);
      if (direction != nullptr) add(crossed(crossed(*load, *speed), *direction), Entry::kNone, 0.3);
    }
    if (load != nullptr && direction != nullptr && rotation != nullptr) {
      add(crossed(crossed(*load, *direction), *rotation), Entry::kNone, 0.3);
    }
  }

  /// One cell of loads and speeds by itself.
  void add_cells() {
    const Levels* load = find("load");
    const Levels* speed = find("speed");
    if (load == nullptr || speed == nullptr) return;
    const Levels cells = crossed(*load, *speed);
    constexpr int kMostCells = 64;
    if (cells.count > kMostCells) return;
    const auto of = std::make_shared<const std::vector<int>>(cells.of);
    const auto sign = std::make_shared<const Eigen::VectorXd>(losing_);
    const double share = 0.5 / static_cast<double>(cells.count);
    for (int k = 0; k < cells.count; ++k) {
      for (const bool losing : {false, true}) {
        if (losing && !both_ways_) continue;
        add({.along = load->name,
             .count = 1,
             .plain =
                 [of, sign, k, losing] {
                   Eigen::MatrixXd column = Eigen::MatrixXd::Zero(sign->size(), 1);
                   for (Eigen::Index i = 0; i < column.rows(); ++i) {
                     if ((*of)[static_cast<std::size_t>(i)] != k) continue;
                     column(i, 0) = losing ? (*sign)[i] : 1.0;
                   }
                   return column;
                 },
             .weight = share});
      }
    }
  }

  /// Products of up to three covariates.
  void add_products() {
    const auto trends = std::make_shared<const std::vector<Trend>>(trends_of(problem_.data));
    std::vector<std::vector<std::size_t>> products;
    for (std::size_t i = 0; i < trends->size(); ++i) {
      products.push_back({i});
      for (std::size_t j = i; j < trends->size(); ++j) {
        products.push_back({i, j});
        for (std::size_t k = j; k < trends->size(); ++k) products.push_back({i, j, k});
      }
    }
    const double share = 1.0 / static_cast<double>(products.size());
    for (const std::vector<std::size_t>& factors : products) {
      add({.along = (*trends)[factors.front()].name,
           .count = 1,
           .plain =
               [trends, factors] {
                 Eigen::MatrixXd column = (*trends)[factors.front()].value;
                 for (std::size_t k = 1; k < factors.size(); ++k) {
                   column.array() *= (*trends)[factors[k]].value.array();
                 }
                 return column;
               },
           .weight = share});
    }
  }

  const Problem& problem_;
  const std::vector<Levels>& levels_;
  Eigen::VectorXd losing_;
  bool both_ways_;  ///< rows of either direction: else what is lost is what is added
  std::vector<Term> terms_;
};

double weight_of(std::span<const Term* const> terms) {
  double sum = 0.0;
  for (const Term* t : terms) sum += t->weight;
  return sum;
}

/// Terms side by side, as blocks.
struct TermBlocks {
  Eigen::MatrixXd columns;
  std::vector<Block> blocks;
};
/// @param sum  of the weights of all terms that are judged together
TermBlocks blocks_of_terms(std::span<const Term* const> terms, double sum, const NoiseModel& noise,
                           Eigen::Index rows) {
  Eigen::Index total = 0;
  for (const Term* t : terms) total += t->count;
  TermBlocks result{.columns = Eigen::MatrixXd(rows, total), .blocks = {}};
  result.blocks.reserve(terms.size());
  Eigen::Index first = 0;
  for (const Term* t : terms) {
    const Eigen::Index count = t->count;
    result.columns.middleCols(first, count) = t->columns(noise);
    result.blocks.push_back(
        {.first = first, .count = count, .side = 0, .log_weight = std::log(t->weight / sum)});
    first += count;
  }
  return result;
}

/// Whether rows differ along each covariate by itself, by all terms that are one kind of entry.
/// @param residual  without what all rows have in common: their mean, or their mean loss
std::vector<CovariateTest> test_covariates(const std::vector<Term>& terms, Entry entry,
                                           const FreeResidual& residual) {
  std::vector<const Term*> entries;
  for (const Term& t : terms) {
    if (t.entry == entry) entries.push_back(&t);
  }
  std::vector<CovariateTest> tests;
  if (entries.empty()) return tests;
  TermBlocks all =
      blocks_of_terms(entries, weight_of(entries), residual.noise, residual.left.size());
  const Screen screen(residual.own_basis, std::move(all.columns), all.blocks, 0.0);
  const std::vector<Gain> gains = screen.gains(residual.left);
  tests.reserve(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) {
    tests.push_back({.name = entries[k]->along,
                     .statistic = gains[k].statistic,
                     .degrees = static_cast<int>(screen.rank(k)),
                     .p_value = std::exp(all.blocks[k].log_weight - gains[k].evidence)});
  }
  return tests;
}

/// The clearer of two tests of a covariate, which had two chances.
void take_clearer(std::vector<CovariateTest>& tests, const std::vector<CovariateTest>& others) {
  for (const CovariateTest& other : others) {
    const auto known = std::ranges::find(tests, other.name, &CovariateTest::name);
    if (known == tests.end()) continue;
    if (other.p_value < known->p_value) *known = other;
    known->p_value = std::min(1.0, 2.0 * known->p_value);
  }
}

/// Judges all terms at once; the best and its p-value go into the result.
void screen_terms(const std::vector<Term>& terms, const FreeResidual& residual, double rate,
                  std::uint64_t seed, RemainderSearch& result) {
  const Eigen::Index n = residual.left.size();
  std::vector<const Term*> pointers;
  pointers.reserve(terms.size());
  for (const Term& t : terms) pointers.push_back(&t);
  const double weight = weight_of(pointers);
  // The columns of all terms of many rows are hundreds of megabytes: some terms after the others.
  constexpr Eigen::Index kMostNumbers = 8'000'000;
  std::vector<Gain> gains;
  std::vector<double> greatest;
  for (std::span<const Term* const> left = pointers; !left.empty();) {
    std::size_t count = 0;
    for (Eigen::Index columns = 0; count < left.size(); ++count) {
      columns += left[count]->count;
      if (count > 0 && columns * n > kMostNumbers) break;
    }
    TermBlocks some = blocks_of_terms(left.first(count), weight, residual.noise, n);
    const Screen screen(residual.own_basis, std::move(some.columns), some.blocks, 0.0);
    const std::vector<Gain> these = screen.gains(residual.left);
    gains.insert(gains.end(), these.begin(), these.end());
    std::vector<double> by_luck = screen.greatest_by_luck(
        residual.left, n > kManyScreenedRows ? 128 : 256, seed, Screen::Chance::kShuffled);
    for (std::size_t k = 0; k < greatest.size(); ++k) {
      by_luck[k] = std::max(by_luck[k], greatest[k]);
    }
    greatest = std::move(by_luck);
    left = left.subspan(count);
  }
  const Screen::Luck luck = Screen::luck_of(std::move(greatest), rate);
  const auto best = static_cast<std::size_t>(std::ranges::max_element(gains, {}, &Gain::evidence) -
                                             gains.begin());
  result.best = {.along = terms[best].along,
                 .columns = terms[best].columns(residual.noise),
                 .evidence = gains[best].evidence,
                 .p_value = luck.p_value(gains[best].evidence),
                 .statistic = gains[best].statistic};
  result.p_value = result.best.p_value;
}

/// A whitened residual without what columns explain of it.
FreeResidual free_residual(const NoiseModel& noise, const Eigen::MatrixXd& own,
                           const Eigen::VectorXd& residual) {
  FreeResidual result{.noise = noise, .own_basis = orthonormal_basis(own), .left = residual};
  const Eigen::MatrixXd& basis = result.own_basis;
  if (basis.cols() > 0) result.left -= basis * (basis.transpose() * result.left);
  return result;
}

/// Takes the best order of a scan as the result where its p-value is the lowest so far.
void consider_order(const char* along, const std::vector<double>& phase, const OrderScan& scan,
                    const FreeResidual& residual, RemainderSearch& result) {
  const double p = std::exp(-scan.evidence);
  // P(χ²_2 ≥ x) = e^(−x/2): x is that of the p-value by itself.
  const double statistic = 2.0 * (scan.evidence + std::log(static_cast<double>(scan.order.size())));
  result.tests.push_back(
      {.name = along, .statistic = statistic, .degrees = 2, .p_value = std::min(1.0, p)});
  if (p >= result.p_value) return;
  Eigen::MatrixXd columns = waves(phase, scan.order[scan.best]);
  residual.noise.whiten(columns);
  result.best = {.along = along,
                 .columns = std::move(columns),
                 .order = scan.order[scan.best],
                 .evidence = scan.evidence,
                 .p_value = p,
                 .statistic = statistic};
  result.p_value = p;
}

/// Orders of the output's angle, half the resolution apart, up to the sun's order and beyond; fewer
/// where rows and turns are so many that it would take seconds.
OrderScan scan_angle(const std::vector<double>& angle, double ratio, const FreeResidual& residual,
                     double& highest_order) {
  constexpr double kMostProducts = 4e7;  // of orders and rows
  const ValueRange range = range_of(angle);
  if (!range.varies()) return {};
  const double revolutions = (range.high - range.low) / (2.0 * std::numbers::pi);
  const double step = 0.5 / revolutions;
  const double highest = std::max(2.0, 1.25 * std::abs(ratio));
  const double most = std::floor(kMostProducts / static_cast<double>(residual.left.size()));
  const auto count = static_cast<int>(std::min(most, highest / step));
  if (most < highest / step) highest_order = step * (count + 1);
  return scan_orders(angle, 2.0 * step, step, count, residual);
}

/// Phase of a wave that fits once into the time of the rows.
std::vector<double> time_phase(const MeasurementSet& data) {
  std::vector<double> phase = reading_times(data);
  const ValueRange range = range_of(phase);
  if (!range.varies()) return {};
  for (double& t : phase) t = 2.0 * std::numbers::pi * (t - range.low) / (range.high - range.low);
  return phase;
}

}  // namespace

RemainderSearch search_remainder(const Problem& problem, const Columns& at,
                                 const std::vector<Levels>& levels, double rate,
                                 std::uint64_t seed) {
  RemainderSearch result;
  const Eigen::Index n = at.residual.size();
  const FreeResidual whole = free_residual(problem.noise, at.own, at.residual);
  constexpr Eigen::Index kFewestRows = 8;
  if (n - whole.own_basis.cols() < kFewestRows || !(whole.left.squaredNorm() > 0.0) ||
      problem.noise.within_rounding(whole.left)) {
    return result;
  }

  const TermCollection collection(problem, levels);
  screen_terms(collection.terms(), whole, rate, seed, result);
  // What all rows have in common is along no covariate.
  Eigen::MatrixXd own_and_mean(n, at.own.cols() + 1);
  own_and_mean << collection.constant(), at.own;
  const FreeResidual residual = free_residual(problem.noise, own_and_mean, at.residual);
  if (!(residual.left.squaredNorm() > 0.0)) return result;
  result.tests = test_covariates(collection.terms(), Entry::kLevels, residual);
  Eigen::MatrixXd own_and_losses(n, own_and_mean.cols() + 1);
  own_and_losses << collection.constant_loss(), own_and_mean;
  const FreeResidual beside_losses = free_residual(problem.noise, own_and_losses, at.residual);
  take_clearer(result.tests, test_covariates(collection.terms(), Entry::kLosses, beside_losses));
  int searches = 1;
  const std::vector<double> angle = column_of(problem.data, &Condition::output_angle_rad);
  if (OrderScan scan =
          scan_angle(angle, problem.simulation.ratio(), residual, result.highest_order);
      !scan.order.empty()) {
    ++searches;
    consider_order("angle", angle, scan, residual, result);
    result.periodogram = {.order = std::move(scan.order), .power = std::move(scan.share)};
  }
  if (const std::vector<double> phase = time_phase(problem.data); !phase.empty()) {
    constexpr Eigen::Index kMostOrders = 200;
    const int count = static_cast<int>(std::min(n, kMostOrders));
    ++searches;
    consider_order("time", phase, scan_orders(phase, 1.0, 0.5, count, residual), residual, result);
  }
  result.p_value = std::min(1.0, result.p_value * searches);
  result.best.p_value = result.p_value;
  return result;
}

}  // namespace gear3k::calibrate
