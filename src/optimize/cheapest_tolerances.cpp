#include "optimize/cheapest_tolerances.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace gear3k::optimize {

namespace {

using backlash::ClearanceModel, backlash::DeviationLimits, backlash::ToleranceKind;

constexpr int kSteps = 6;  // of √2 either way

using Steps = std::vector<int>;

double factor_of(int step) { return std::exp2(0.5 * step); }

class Search {
 public:
  Search(const ClearanceModel& model, const CheapestOptions& options)
      : model_(model), options_(options), steps_(model.sources.size(), 0) {}

  CheapestTolerances run() {
    CheapestTolerances result;
    result.stated_cost = cost(steps_);
    result.stated_yield = verified_yield();
    const auto keep = [&](double yield) {
      result.factor = factors(steps_);
      result.cost = cost(steps_);
      result.yield = yield;
      result.reached = yield >= options_.yield;
    };
    keep(result.stated_yield);
    const double most = highest_yield(options_.samples);
    constexpr int kRounds = 5;
    for (int k = 0; k < kRounds && !stopped() && asked_ <= most; ++k) {
      descend();
      const double verified = verified_yield();
      const bool better = verified >= options_.yield ? !result.reached || cost(steps_) < result.cost
                                                     : !result.reached && verified > result.yield;
      if (better) keep(verified);
      if (verified >= options_.yield || yield_ < asked_) break;
      asked_ += options_.yield - verified;
    }
    return result;
  }

 private:
  /// From the steps as they are to a local optimum at the yield asked for.
  void descend() {
    yield_ = yield(steps_);
    while (yield_ < asked_ && !stopped() && tighten()) {
    }
    if (yield_ < asked_) return;
    do {
      while (!stopped() && widen()) {
      }
    } while (!stopped() && exchange());
  }

  [[nodiscard]] static std::vector<double> factors(const Steps& steps) {
    std::vector<double> result;
    result.reserve(steps.size());
    for (const int step : steps) result.push_back(factor_of(step));
    return result;
  }
  /// Whether the geometry's own checks let a source be as wide as in these steps.
  [[nodiscard]] bool may_be_wide(const Steps& steps, std::size_t source) const {
    const ToleranceKind kind = model_.sources[source].kind;
    if (kind != ToleranceKind::kToothThickness && kind != ToleranceKind::kCenterDistance) {
      return true;
    }
    return !options_.may_widen || options_.may_widen(factors(steps));
  }

  [[nodiscard]] bool stopped() const { return options_.stop && options_.stop(); }

  [[nodiscard]] double cost_of(std::size_t source, int step) const {
    return options_.cost[static_cast<std::size_t>(model_.sources[source].kind)] / factor_of(step);
  }
  [[nodiscard]] double cost(const Steps& steps) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < steps.size(); ++i) sum += cost_of(i, steps[i]);
    return sum;
  }
  [[nodiscard]] double yield(const Steps& steps) const {
    return yield(steps, options_.samples, options_.seed);
  }
  [[nodiscard]] double verified_yield() const {
    return yield(steps_, options_.verifying_samples, options_.seed + 2);
  }
  [[nodiscard]] double yield(const Steps& steps, std::uint64_t samples, std::uint64_t seed) const {
    ClearanceModel scaled = model_;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      scaled.sources[i].half_width_m *= factor_of(steps[i]);
    }
    return backlash::monte_carlo(scaled, {.samples = samples,
                                          .seed = seed,
                                          .scatter = options_.scatter,
                                          .limit_rad = options_.limit_rad})
        .yield.value;
  }
  [[nodiscard]] bool may_step(std::size_t source, int by) const {
    return std::abs(steps_[source] + by) <= kSteps;
  }
  [[nodiscard]] double yield_after(std::size_t source, int by) const {
    Steps trial = steps_;
    trial[source] += by;
    return yield(trial);
  }

  /// One step down, the one that buys most yield per cost; of equal ones, as where no single step
  /// gains anything and all of them together may, the cheapest.
  bool tighten() {
    std::optional<std::size_t> best;
    double best_rate = -std::numeric_limits<double>::infinity();
    double best_price = 0.0, best_yield = 0.0;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (!may_step(i, -1)) continue;
      const double after = yield_after(i, -1);
      const double price = cost_of(i, steps_[i] - 1) - cost_of(i, steps_[i]);
      const double rate = (after - yield_) / std::max(price, kNothing);
      if (rate > best_rate || (rate == best_rate && price < best_price)) {
        best_rate = rate;
        best_price = price;
        best = i;
        best_yield = after;
      }
    }
    if (!best) return false;
    --steps_[*best];
    yield_ = best_yield;
    return true;
  }

  /// One step up that leaves the yield, the one that saves most per yield lost.
  bool widen() {
    std::optional<std::size_t> best;
    double best_rate = 0.0;
    double best_yield = 0.0;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (!may_step(i, 1)) continue;
      const double saving = cost_of(i, steps_[i]) - cost_of(i, steps_[i] + 1);
      if (!(saving > 0.0)) continue;
      const double after = yield_after(i, 1);
      if (after < asked_) continue;
      const double rate = saving / std::max(yield_ - after, kNothing);
      Steps trial = steps_;
      ++trial[i];
      if (rate > best_rate && may_be_wide(trial, i)) {
        best_rate = rate;
        best = i;
        best_yield = after;
      }
    }
    if (!best) return false;
    ++steps_[*best];
    yield_ = best_yield;
    return true;
  }

  /// One up for one down, where it saves and the yield stays; the one that saves most.
  bool exchange() {
    struct Trade {
      double saving;
      std::size_t up, down;
    };
    std::vector<Trade> trades;
    for (std::size_t up = 0; up < steps_.size(); ++up) {
      if (!may_step(up, 1)) continue;
      for (std::size_t down = 0; down < steps_.size(); ++down) {
        if (down == up || !may_step(down, -1)) continue;
        const double saving = cost_of(up, steps_[up]) - cost_of(up, steps_[up] + 1) -
                              cost_of(down, steps_[down] - 1) + cost_of(down, steps_[down]);
        if (saving > kNothing) trades.push_back({.saving = saving, .up = up, .down = down});
      }
    }
    std::ranges::stable_sort(trades, std::greater{}, &Trade::saving);
    for (const Trade& trade : trades) {
      if (stopped()) return false;
      Steps trial = steps_;
      ++trial[trade.up];
      --trial[trade.down];
      const double after = yield(trial);
      if (after < asked_ || !may_be_wide(trial, trade.up)) continue;
      steps_ = std::move(trial);
      yield_ = after;
      return true;
    }
    return false;
  }

  static constexpr double kNothing = 1e-12;
  const ClearanceModel& model_;
  const CheapestOptions& options_;
  Steps steps_;
  double yield_ = 0.0;             ///< of steps_
  double asked_ = options_.yield;  ///< of the search's own series
};

void scale(DeviationLimits& limits, double factor) {
  const double middle = limits.middle();
  const double half = factor * limits.half_width();
  limits = {.lower = middle - half, .upper = middle + half};
}

}  // namespace

CheapestTolerances cheapest_tolerances(const ClearanceModel& model,
                                       const CheapestOptions& options) {
  if (!(options.yield <= highest_yield(options.samples))) {
    throw std::invalid_argument(fmt::format(
        "cheapest_tolerances: yield = {:g} of a series of {} gearboxes, allowed: at most {:g}",
        options.yield, options.samples, highest_yield(options.samples)));
  }
  return Search(model, options).run();
}

backlash::Tolerances scaled(const backlash::Tolerances& tolerances, const ClearanceModel& model,
                            const std::vector<double>& factor, double cos_pressure_angle) {
  backlash::Tolerances result = tolerances;
  // What F_p says beyond the run-out's share in it, docs/theory §33.
  std::array<double, train::kGearCount> rest{};
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const backlash::GearTolerances& g = tolerances.gears[i];
    rest[i] = std::max(0.0, g.cumulative_pitch_m - g.runout_m / cos_pressure_angle);
  }
  for (std::size_t s = 0; s < factor.size(); ++s) {
    const backlash::ToleranceSource& source = model.sources[s];
    const auto gear = static_cast<std::size_t>(std::max(source.gear, 0));
    backlash::GearTolerances& g = result.gears[gear];
    switch (source.kind) {
      case ToleranceKind::kCenterDistance:
        scale(result.center_distance_m, factor[s]);
        break;
      case ToleranceKind::kToothThickness:
        scale(g.tooth_thickness_m, factor[s]);
        break;
      case ToleranceKind::kPinPosition:
        result.pin_position_m *= factor[s];
        break;
      case ToleranceKind::kPlanetPhase:
        scale(result.planet_phase_rad, factor[s]);
        break;
      case ToleranceKind::kRunout:
        g.runout_m *= factor[s];
        // All of F_p is run-out's: it goes with it, and leaves no rest.
        if (!(rest[gear] > 0.0)) g.cumulative_pitch_m *= factor[s];
        break;
      case ToleranceKind::kCumulativePitch:
        rest[gear] *= factor[s];
        break;
      case ToleranceKind::kSinglePitch:
        g.single_pitch_m *= factor[s];
        break;
    }
  }
  for (std::size_t i = 0; i < rest.size(); ++i) {
    backlash::GearTolerances& g = result.gears[i];
    if (rest[i] > 0.0) {
      g.cumulative_pitch_m = g.runout_m / cos_pressure_angle + rest[i];
    }
  }
  return result;
}

}  // namespace gear3k::optimize
