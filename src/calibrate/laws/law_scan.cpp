#include "calibrate/laws/law_scan.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <tuple>

#include "calibrate/fit/screen.hpp"
#include "calibrate/laws/law_forms.hpp"

namespace gear3k::calibrate {

namespace {

/// What tells forms apart, whatever the values of their parameters.
using FormKey = std::tuple<int, int, bool, int, std::size_t, int, std::size_t>;
FormKey key_of(const Law& law) {
  const LawFactor& first = law.factors.front();
  const LawFactor& second = law.factors.back();
  const bool two = law.factors.size() > 1;
  return {static_cast<int>(law.action),
          static_cast<int>(law.rows),
          law.offset,
          static_cast<int>(first.shape),
          first.condition,
          two ? static_cast<int>(second.shape) : -1,
          two ? second.condition : 0};
}

class FormScan {
 public:
  explicit FormScan(const LawData& data)
      : d_(data), values_(condition_values(data.data, data.scope)) {}

  std::vector<LawTrial> best_of_each() {
    scan_singles();
    scan_products();
    scan_waves();
    std::vector<LawTrial> trials;
    trials.reserve(tried_.size());
    for (const auto& [form, trial] : tried_) trials.push_back(trial);
    return trials;
  }

 private:
  [[nodiscard]] Eigen::VectorXd column_of(const TriedFactor& tried,
                                          const ConditionValues& v) const {
    Eigen::VectorXd column(d_.simulated.size());
    for (Eigen::Index i = 0; i < column.size(); ++i) {
      column[i] = factor_value(tried.factor, v.value[static_cast<std::size_t>(i)], tried.p.data());
    }
    return column;
  }

  /// Squares that columns (whitened here) take off what a basis leaves of the residual.
  Eigen::VectorXd gains(Eigen::MatrixXd columns, const Eigen::MatrixXd& basis) const {
    d_.noise.whiten(columns);
    const Eigen::VectorXd before = columns.colwise().squaredNorm();
    Eigen::VectorXd residual = d_.residual;
    if (basis.cols() > 0) {
      residual -= basis * (basis.transpose() * residual);
      columns -= basis * (basis.transpose() * columns);
    }
    const Eigen::VectorXd along = columns.transpose() * residual;
    Eigen::VectorXd result = columns.colwise().squaredNorm();
    constexpr double kNothingLeft = 1e-8;
    for (Eigen::Index k = 0; k < result.size(); ++k) {
      result[k] = result[k] > kNothingLeft * before[k] ? along[k] * along[k] / result[k] : 0.0;
    }
    return result;
  }

  /// Takes a trial in where it is the best of its form so far.
  void offer(Law law, const std::vector<double>& factors, double gain, int orders = 1,
             double highest_order = HUGE_VAL) {
    LawTrial& best = tried_[key_of(law)];
    if (!best.value.empty() && gain <= best.gain) return;
    best.value.assign(law.offset ? 2 : 1, 0.0);
    best.value.insert(best.value.end(), factors.begin(), factors.end());
    best.law = std::move(law);
    best.gain = gain;
    best.orders = orders;
    best.highest_order = highest_order;
  }

  static std::vector<double> parameters(const TriedFactor& t) {
    return {t.p.begin(), t.p.begin() + parameter_count(t.factor.shape)};
  }

  [[nodiscard]] bool fits(LawShape shape, const ConditionValues& v) const {
    const LawCondition& c = law_conditions()[v.condition];
    if (c.turn > 0.0) return record_of(shape).turns;
    return !record_of(shape).natural_zero || c.natural_zero;
  }

  void scan_singles() {
    for (const ConditionValues& v : values_) {
      std::vector<TriedFactor> grid;
      for (const LawShape shape : single_shapes()) {
        if (!fits(shape, v)) continue;
        const auto more = grid_of(shape, v);
        grid.insert(grid.end(), more.begin(), more.end());
      }
      if (grid.empty()) continue;
      Eigen::MatrixXd plain(d_.simulated.size(), static_cast<Eigen::Index>(grid.size()));
      for (std::size_t k = 0; k < grid.size(); ++k) {
        plain.col(static_cast<Eigen::Index>(k)) = column_of(grid[k], v);
      }
      for (const Channel& ch : channels_of(d_.data, d_.scope)) {
        const Eigen::VectorXd w = channel_weights(d_, ch.action, ch.rows);
        const Eigen::MatrixXd columns = w.asDiagonal() * plain;
        for (const bool offset : {false, true}) {
          Eigen::MatrixXd basis = d_.own_basis;
          if (offset) {
            Eigen::MatrixXd constant = w;
            d_.noise.whiten(constant);
            basis = orthonormal_basis(
                (Eigen::MatrixXd(d_.own.rows(), d_.own.cols() + 1) << d_.own, constant).finished());
          }
          const Eigen::VectorXd gain = gains(columns, basis);
          for (std::size_t k = 0; k < grid.size(); ++k) {
            const Law law{.action = ch.action,
                          .rows = ch.rows,
                          .factors = {grid[k].factor},
                          .offset = offset};
            if (fitted_count(law) > kMostLawParameters) continue;
            offer(law, parameters(grid[k]), gain[static_cast<Eigen::Index>(k)]);
          }
        }
      }
    }
  }

  void scan_products() {
    const std::vector<Channel> channels = channels_of(d_.data, d_.scope);
    for (std::size_t a = 0; a < values_.size(); ++a) {
      for (std::size_t b = 0; b < values_.size(); ++b) {
        if (a == b) continue;
        for (const auto& [first, second] : product_shapes()) {
          // The same shape of both: each pair once.
          if (first == second && b < a) continue;
          if (fits(first, values_[a]) && fits(second, values_[b])) {
            scan_product(grid_of(first, values_[a]), values_[a], grid_of(second, values_[b]),
                         values_[b], channels);
          }
        }
      }
    }
  }

  void scan_product(const std::vector<TriedFactor>& one, const ConditionValues& of_one,
                    const std::vector<TriedFactor>& two, const ConditionValues& of_two,
                    const std::vector<Channel>& channels) {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t i = 0; i < one.size(); ++i) {
      for (std::size_t j = 0; j < two.size(); ++j) {
        // Windows as wide along the one as along the other.
        if (one[i].factor.shape == LawShape::kWindow && two[j].factor.shape == LawShape::kWindow &&
            one[i].factor.constant != two[j].factor.constant) {
          continue;
        }
        pairs.emplace_back(i, j);
      }
    }
    if (pairs.empty()) return;
    std::vector<Eigen::VectorXd> left;
    std::vector<Eigen::VectorXd> right;
    left.reserve(one.size());
    right.reserve(two.size());
    for (const TriedFactor& t : one) left.push_back(column_of(t, of_one));
    for (const TriedFactor& t : two) right.push_back(column_of(t, of_two));
    Eigen::MatrixXd plain(d_.simulated.size(), static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      plain.col(static_cast<Eigen::Index>(k)) =
          left[pairs[k].first].cwiseProduct(right[pairs[k].second]);
    }
    for (const Channel& ch : channels) {
      if (ch.rows != LawRows::kAll) continue;
      const Eigen::VectorXd gain =
          gains(channel_weights(d_, ch.action, ch.rows).asDiagonal() * plain, d_.own_basis);
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        std::vector<double> p = parameters(one[pairs[k].first]);
        const std::vector<double> more = parameters(two[pairs[k].second]);
        p.insert(p.end(), more.begin(), more.end());
        offer({.action = ch.action,
               .rows = ch.rows,
               .factors = {one[pairs[k].first].factor, two[pairs[k].second].factor}},
              p, gain[static_cast<Eigen::Index>(k)]);
      }
    }
  }

  /// Power of the residual, times what the response's sign makes of it, at orders step, 2 step, ...
  [[nodiscard]] std::vector<double> spectrum(const std::vector<double>& turn,
                                             const Eigen::VectorXd& signal, double step,
                                             int count) const {
    const auto n = static_cast<std::size_t>(signal.size());
    std::vector<std::complex<double>> wave(n, 1.0);
    std::vector<std::complex<double>> by(n);
    for (std::size_t i = 0; i < n; ++i)
      by[i] = std::polar(1.0, 2.0 * std::numbers::pi * step * turn[i]);
    std::vector<double> power(static_cast<std::size_t>(count) + 1, 0.0);
    for (std::size_t k = 1; k < power.size(); ++k) {
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        wave[i] *= by[i];
        sum += signal[static_cast<Eigen::Index>(i)] * wave[i];
      }
      power[k] = std::norm(sum);
    }
    return power;
  }

  /// Waves and pulses: the orders at which the residual's power, summed over four harmonics, is
  /// greatest.
  void scan_waves() {
    constexpr double kProducts = 3e6;
    constexpr double kHighestOrder = 40.0;
    constexpr int kHarmonics = 4;
    constexpr std::size_t kOrders = 8;
    constexpr int kPhases = 16;
    const Eigen::VectorXd left = left_by_own(d_);
    for (const ConditionValues& v : values_) {
      const LawCondition& c = law_conditions()[v.condition];
      const bool time = c.name == "time";
      if (!(c.turn > 0.0) && !time) continue;
      const auto [low, high] = std::ranges::minmax(v.value);
      const double reference = time ? high - low : c.turn;
      const double origin = time ? low : 0.0;
      std::vector<double> turn;
      for (const double x : v.value) turn.push_back((x - origin) / reference);
      const double turns = (high - low) / reference;
      const double step = 0.4 / turns;
      const auto count = static_cast<int>(
          std::min(kHighestOrder / step, kProducts / static_cast<double>(d_.data.rows.size())));
      if (count < 2) continue;
      std::vector<LawAction> actions{LawAction::kAdded};
      const std::vector<Channel> channels = channels_of(d_.data, d_.scope);
      if (channels.front().action == LawAction::kLoss) actions.push_back(LawAction::kLoss);
      for (const LawAction action : actions) {
        const Eigen::VectorXd w = channel_weights(d_, action, LawRows::kAll) / d_.si;
        const std::vector<double> power = spectrum(turn, left.cwiseProduct(w), step, count);
        for (const LawShape shape : {LawShape::kWave, LawShape::kPulse}) {
          const int harmonics = shape == LawShape::kWave ? 1 : kHarmonics;
          std::vector<double> orders = best_orders(power, step, harmonics, kOrders);
          // Every second pulse alone has a power of its own.  What all of them take off decides
          // here whether the form is refined at all; LawFit::polish doubles again, from the refined
          // order and phase and to widths that this grid does not have.
          for (std::size_t k = 0; shape == LawShape::kPulse && k < kOrders && k < orders.size();
               ++k) {
            orders.push_back(2.0 * orders[k]);
          }
          for (const double order : orders) {
            std::vector<TriedFactor> grid;
            for (int phase = 0; phase < kPhases; ++phase) {
              for (const double near : {-0.25, 0.0, 0.25}) {
                TriedFactor t{.factor = {.shape = shape,
                                         .condition = v.condition,
                                         .origin = origin,
                                         .reference = reference},
                              .p = {order + near * step, static_cast<double>(phase) / kPhases}};
                if (shape == LawShape::kWave) {
                  grid.push_back(t);
                  continue;
                }
                for (const double width : {0.05, 0.08, 0.125, 0.2}) {
                  t.factor.constant = width;
                  grid.push_back(t);
                }
              }
            }
            Eigen::MatrixXd columns(d_.simulated.size(), static_cast<Eigen::Index>(grid.size()));
            for (std::size_t k = 0; k < grid.size(); ++k) {
              columns.col(static_cast<Eigen::Index>(k)) = column_of(grid[k], v);
            }
            const Eigen::VectorXd gain = gains(
                channel_weights(d_, action, LawRows::kAll).asDiagonal() * columns, d_.own_basis);
            for (std::size_t k = 0; k < grid.size(); ++k) {
              offer({.action = action, .factors = {grid[k].factor}}, parameters(grid[k]),
                    gain[static_cast<Eigen::Index>(k)], count, step * count);
            }
          }
        }
      }
    }
  }

  /// Orders of the greatest sums over harmonics, none next to another.
  static std::vector<double> best_orders(const std::vector<double>& power, double step,
                                         int harmonics, std::size_t most) {
    // A harmonic's order is known as much better as it is higher: finer steps, the nearest places.
    const int finer = harmonics;
    std::vector<std::pair<double, double>> sums;
    const auto count = static_cast<int>(power.size()) - 1;
    for (int k = 1; k * harmonics <= finer * count; ++k) {
      double sum = 0.0;
      for (int h = 1; h <= harmonics; ++h) {
        sum += power[static_cast<std::size_t>((k * h + finer / 2) / finer)];
      }
      sums.emplace_back(sum, step * k / finer);
    }
    std::ranges::sort(sums, std::greater<>());
    std::vector<double> orders;
    for (const auto& found : sums) {
      const double order = found.second;
      if (orders.size() >= most) break;
      if (std::ranges::none_of(orders, [&](double o) { return std::abs(o - order) < step; })) {
        orders.push_back(order);
      }
    }
    return orders;
  }

  const LawData& d_;
  std::vector<ConditionValues> values_;
  std::map<FormKey, LawTrial> tried_;
};

}  // namespace

std::vector<LawTrial> scan_forms(const LawData& data) { return FormScan(data).best_of_each(); }

}  // namespace gear3k::calibrate
