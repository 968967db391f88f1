#include "backlash/monte_carlo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "numerics/distributions.hpp"

namespace gear3k::backlash {

namespace {

constexpr std::size_t kDrawnBins = 100;

struct Sums {
  std::uint64_t assembled = 0, within = 0;
  double deviation = 0.0, square = 0.0;  ///< of the lost motion from the reference
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();

  void add(const Sums& s) {
    assembled += s.assembled;
    within += s.within;
    deviation += s.deviation;
    square += s.square;
    least = std::min(least, s.least);
    greatest = std::max(greatest, s.greatest);
  }
};

/// What one thread needs.
class Worker {
 public:
  Worker(const GearboxBatch& batch, const RandomGearbox& random, const WorstCase& worst,
         double limit_rad)
      : width(0.0, worst.greatest_rad, kFineBins),
        margin(worst.least_margin_m, worst.greatest_margin_m, kFineBins),
        batch_(&batch),
        random_(&random),
        limit_rad_(limit_rad),
        reference_rad_(worst.middle_rad),
        values_(batch.components().size()) {}

  Sums run(std::uint64_t first, std::uint64_t count) {
    pointers_.clear();
    for (const Lanes& v : values_) pointers_.push_back(&v);
    Sums sums;
    for (std::uint64_t at = 0; at < count; at += kBatch) {
      random_->draw(first + at, values_);
      batch_->ranges(pointers_, range_);
      const std::size_t lanes =
          static_cast<std::size_t>(std::min<std::uint64_t>(kBatch, count - at));
      for (std::size_t b = 0; b < lanes; ++b) {
        margin.add(range_.margin_m.lane[b]);
        if (!(range_.margin_m.lane[b] >= 0.0)) continue;
        const double lost = range_.width_rad.lane[b];
        width.add(lost);
        ++sums.assembled;
        if (lost <= limit_rad_) ++sums.within;
        const double d = lost - reference_rad_;
        sums.deviation += d;
        sums.square += d * d;
        sums.least = std::min(sums.least, lost);
        sums.greatest = std::max(sums.greatest, lost);
      }
    }
    return sums;
  }

  FineHistogram width, margin;

 private:
  const GearboxBatch* batch_;
  const RandomGearbox* random_;
  double limit_rad_, reference_rad_;
  std::vector<Lanes> values_;
  std::vector<const Lanes*> pointers_;
  BatchRange range_{};
};

template <class Probabilities>
std::vector<Quantile> quantiles(const FineHistogram& histogram, const Probabilities& probabilities,
                                double least, double greatest) {
  const auto count = static_cast<double>(histogram.count());
  std::vector<Quantile> result;
  result.reserve(probabilities.size());
  for (const double p : probabilities) {
    result.push_back(
        {.probability = p, .value = std::clamp(histogram.value_at(p * count), least, greatest)});
  }
  return result;
}

}  // namespace

Proportion proportion(std::uint64_t count, std::uint64_t samples) {
  if (!(samples > 0 && count <= samples)) {
    throw std::invalid_argument(
        fmt::format("proportion: {} of {}, allowed: at most all of at least 1", count, samples));
  }
  constexpr double kTail = 0.025;
  const auto n = static_cast<double>(samples);
  const auto k = static_cast<double>(count);
  const numerics::ProportionBounds bounds = numerics::binomial_bounds(n, k, kTail);
  return {.count = count, .value = k / n, .lower = bounds.lower, .upper = bounds.upper};
}

MonteCarloResult monte_carlo(const ClearanceModel& model, const MonteCarloOptions& options) {
  if (options.samples == 0) {
    throw std::invalid_argument("monte_carlo: samples = 0, allowed: at least 1");
  }
  const double limit_rad = options.limit_rad.value_or(std::numeric_limits<double>::infinity());
  if (std::isnan(limit_rad)) throw std::invalid_argument("monte_carlo: limit_rad is not a number");
  MonteCarloResult result;
  result.worst = worst_case(model);
  const GearboxBatch batch(model);
  const RandomGearbox random(model, options.scatter, options.seed);
  std::vector<Worker> workers(static_cast<std::size_t>(omp_get_max_threads()),
                              Worker(batch, random, result.worst, limit_rad));
  Sums sums;
  result.samples = run_in_chunks(options.samples, workers, options.progress,
                                 [&](const Sums& s) { sums.add(s); });
  for (std::size_t k = 1; k < workers.size(); ++k) {
    workers[0].width.merge(workers[k].width);
    workers[0].margin.merge(workers[k].margin);
  }

  const std::uint64_t n = result.samples;
  result.assembled = proportion(sums.assembled, n);
  result.jammed = proportion(n - sums.assembled, n);
  result.beyond_limit = proportion(sums.assembled - sums.within, n);
  result.yield = proportion(sums.within, n);
  const FineHistogram& margin = workers[0].margin;
  result.margin = quantiles(margin, kMarginProbabilities, result.worst.least_margin_m,
                            result.worst.greatest_margin_m);
  if (sums.assembled == 0) return result;

  const FineHistogram& width = workers[0].width;
  const auto assembled = static_cast<double>(sums.assembled);
  const double offset = sums.deviation / assembled;
  result.lost_motion = {
      .mean_rad = result.worst.middle_rad + offset,
      .deviation_rad = std::sqrt(std::max(0.0, sums.square - assembled * offset * offset) /
                                 std::max(1.0, assembled - 1.0)),
      .least_rad = sums.least,
      .greatest_rad = sums.greatest,
      .quantiles = quantiles(width, kLostMotionProbabilities, sums.least, sums.greatest),
      .histogram = width.coarse(kDrawnBins)};
  const double rank = 0.99 * static_cast<double>(n);
  if (rank <= assembled) {
    result.limit_of_99_percent_rad = std::clamp(width.value_at(rank), sums.least, sums.greatest);
  }
  return result;
}

}  // namespace gear3k::backlash
