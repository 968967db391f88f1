#include "backlash/tolerance_shares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gear3k::backlash {

namespace {

constexpr std::size_t kShareBins = std::size_t{1} << 14U;
/// Streams of the generator: A is that of monte_carlo().
constexpr std::uint64_t kStreamA = 0, kStreamB = 1;

/// ShareSums of x, x² and x v, from which the mean of x over that of v gets its error.
struct RatioSums {
  double x = 0.0, xx = 0.0, xv = 0.0;
  void add(double value, double v) {
    x += value;
    xx += value * value;
    xv += value * v;
  }
  void add(const RatioSums& s) {
    x += s.x;
    xx += s.xx;
    xv += s.xv;
  }
};

/// Gearboxes that a change makes good, and makes bad.
struct Changed {
  std::uint64_t gained = 0, lost = 0;
  void add(bool before, bool after) {
    gained += !before && after ? 1U : 0U;
    lost += before && !after ? 1U : 0U;
  }
  void add(const Changed& c) {
    gained += c.gained;
    lost += c.lost;
  }
};

struct SourceSums {
  RatioSums first, total;
  Changed yield, jam;
};

struct ShareSums {
  double y = 0.0, v = 0.0, vv = 0.0;  ///< y of A and B from the reference, and their mean square
  std::uint64_t good = 0, jammed = 0;
  std::vector<SourceSums> sources;

  void add(const ShareSums& s) {
    y += s.y;
    v += s.v;
    vv += s.vv;
    good += s.good;
    jammed += s.jammed;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      sources[i].first.add(s.sources[i].first);
      sources[i].total.add(s.sources[i].total);
      sources[i].yield.add(s.sources[i].yield);
      sources[i].jam.add(s.sources[i].jam);
    }
  }
};

/// Where the components of one source stand: one after the other.
struct ComponentRange {
  std::size_t begin = 0, end = 0;
};

struct Series {
  GearboxBatch batch;
  RandomGearbox A, B;
  std::vector<ComponentRange> sources;
  double greatest_rad = 0.0, limit_rad = 0.0;
  double reference_rad = 0.0;
};

bool jams(const BatchRange& range, std::size_t b) { return !(range.margin_m.lane[b] >= 0.0); }
double lost_motion(const BatchRange& range, std::size_t b) {
  return jams(range, b) ? 0.0 : range.width_rad.lane[b];
}

class ShareWorker {
 public:
  explicit ShareWorker(const Series& series)
      : as_is(0.0, series.greatest_rad, kShareBins),
        halved(series.sources.size(), as_is),
        series_(&series),
        a_(series.batch.components().size()),
        b_(a_.size()),
        half_(a_.size()) {}

  ShareSums run(std::uint64_t first, std::uint64_t count) {
    ShareSums sums;
    sums.sources.resize(series_->sources.size());
    for (std::uint64_t at = 0; at < count; at += kBatch) {
      add_batch(first + at, static_cast<std::size_t>(std::min<std::uint64_t>(kBatch, count - at)),
                sums);
    }
    return sums;
  }

  FineHistogram as_is;
  std::vector<FineHistogram> halved;

 private:
  void add_batch(std::uint64_t first, std::size_t lanes, ShareSums& sums) {
    series_->A.draw(first, a_);
    series_->B.draw(first, b_);
    for (std::size_t c = 0; c < a_.size(); ++c) {
      for (std::size_t b = 0; b < kBatch; ++b) half_[c].lane[b] = 0.5 * a_[c].lane[b];
    }
    evaluate_with({}, b_, of_b_);
    evaluate_with({}, a_, of_a_);
    const double m = series_->reference_rad;
    for (std::size_t b = 0; b < lanes; ++b) {
      const double y_a = lost_motion(of_a_, b) - m;
      const double y_b = lost_motion(of_b_, b) - m;
      const double v = 0.5 * (y_a * y_a + y_b * y_b);
      sums.y += 0.5 * (y_a + y_b);
      sums.v += v;
      sums.vv += v * v;
      sums.good += good(of_a_, b) ? 1U : 0U;
      sums.jammed += jams(of_a_, b) ? 1U : 0U;
      if (!jams(of_a_, b)) as_is.add(of_a_.width_rad.lane[b]);
    }
    for (std::size_t i = 0; i < series_->sources.size(); ++i) {
      evaluate_with(series_->sources[i], b_, mixed_);
      for (std::size_t b = 0; b < lanes; ++b) {
        const double y_a = lost_motion(of_a_, b) - m;
        const double y_b = lost_motion(of_b_, b) - m;
        const double v = 0.5 * (y_a * y_a + y_b * y_b);
        const double change = lost_motion(mixed_, b) - m - y_a;
        sums.sources[i].first.add(y_b * change, v);
        sums.sources[i].total.add(0.5 * change * change, v);
      }
      evaluate_with(series_->sources[i], half_, mixed_);
      for (std::size_t b = 0; b < lanes; ++b) {
        sums.sources[i].yield.add(good(of_a_, b), good(mixed_, b));
        sums.sources[i].jam.add(jams(of_a_, b), jams(mixed_, b));
        if (!jams(mixed_, b)) halved[i].add(mixed_.width_rad.lane[b]);
      }
    }
  }

  [[nodiscard]] bool good(const BatchRange& range, std::size_t b) const {
    return !jams(range, b) && range.width_rad.lane[b] <= series_->limit_rad;
  }

  /// Components of `from` in a range, or all of them if that is empty; the others are of A.
  void evaluate_with(ComponentRange range, const std::vector<Lanes>& from, BatchRange& result) {
    if (range.begin == range.end) range = {.begin = 0, .end = a_.size()};
    pointers_.clear();
    for (std::size_t c = 0; c < a_.size(); ++c) {
      pointers_.push_back(range.begin <= c && c < range.end ? &from[c] : &a_[c]);
    }
    series_->batch.ranges(pointers_, result);
  }

  const Series* series_;
  std::vector<Lanes> a_, b_, half_;
  std::vector<const Lanes*> pointers_;
  BatchRange of_a_{}, of_b_{}, mixed_{};
};

std::vector<ComponentRange> component_ranges(const GearboxBatch& batch, std::size_t sources) {
  std::vector<ComponentRange> ranges(sources);
  const auto& components = batch.components();
  for (std::size_t c = 0; c < components.size(); ++c) {
    ComponentRange& range = ranges[components[c].source];
    if (range.begin == range.end) range.begin = c;
    range.end = c + 1;
  }
  return ranges;
}

/// x̄/v̄ and its standard error.
Estimate ratio(const RatioSums& s, const ShareSums& sums, double variance, double n) {
  if (!(variance > 0.0)) return {};
  const double r = s.x / n / variance;
  const double square = std::max(0.0, s.xx - 2.0 * r * s.xv + r * r * sums.vv) / n;
  return {.value = r, .standard_error = std::sqrt(square / n) / variance};
}

Estimate change(const Changed& c, double n) {
  const auto gained = static_cast<double>(c.gained);
  const auto lost = static_cast<double>(c.lost);
  const double mean = (gained - lost) / n;
  return {.value = mean,
          .standard_error = std::sqrt(std::max(0.0, (gained + lost) / n - mean * mean) / n)};
}

double quantile_99(const FineHistogram& h) {
  return h.value_at(0.99 * static_cast<double>(h.count()));
}

/// Mean of y over the first chunk, about which squares are taken.
double reference(const Series& series) {
  std::vector<Lanes> values(series.batch.components().size());
  std::vector<const Lanes*> pointers;
  pointers.reserve(values.size());
  for (const Lanes& v : values) pointers.push_back(&v);
  BatchRange range{};
  double sum = 0.0;
  for (std::uint64_t at = 0; at < kChunkGearboxes; at += kBatch) {
    series.A.draw(at, values);
    series.batch.ranges(pointers, range);
    for (std::size_t b = 0; b < kBatch; ++b) sum += lost_motion(range, b);
  }
  return sum / static_cast<double>(kChunkGearboxes);
}

}  // namespace

ToleranceShares tolerance_shares(const ClearanceModel& model, const MonteCarloOptions& options) {
  if (options.samples == 0) {
    throw std::invalid_argument("tolerance_shares: samples = 0, allowed: at least 1");
  }
  Series series{.batch = GearboxBatch(model),
                .A = RandomGearbox(model, options.scatter, options.seed, kStreamA),
                .B = RandomGearbox(model, options.scatter, options.seed, kStreamB),
                .sources = {},
                .greatest_rad = worst_case(model).greatest_rad,
                .limit_rad = options.limit_rad.value_or(std::numeric_limits<double>::infinity())};
  if (std::isnan(series.limit_rad)) {
    throw std::invalid_argument("tolerance_shares: limit_rad is not a number");
  }
  series.sources = component_ranges(series.batch, model.sources.size());
  series.reference_rad = reference(series);
  std::vector<ShareWorker> workers(static_cast<std::size_t>(omp_get_max_threads()),
                                   ShareWorker(series));
  ShareSums sums;
  sums.sources.resize(model.sources.size());
  ToleranceShares result;
  result.samples = run_in_chunks(options.samples, workers, options.progress,
                                 [&](const ShareSums& s) { sums.add(s); });
  for (std::size_t k = 1; k < workers.size(); ++k) {
    workers[0].as_is.merge(workers[k].as_is);
    for (std::size_t i = 0; i < model.sources.size(); ++i) {
      workers[0].halved[i].merge(workers[k].halved[i]);
    }
  }

  const auto n = static_cast<double>(result.samples);
  const double offset = sums.y / n;
  result.mean_rad = series.reference_rad + offset;
  result.variance_rad2 = std::max(0.0, sums.v / n - offset * offset);
  result.yield = static_cast<double>(sums.good) / n;
  result.jam_probability = static_cast<double>(sums.jammed) / n;
  result.quantile_99_rad = quantile_99(workers[0].as_is);
  result.sources.reserve(model.sources.size());
  for (std::size_t i = 0; i < model.sources.size(); ++i) {
    const SourceSums& s = sums.sources[i];
    const Estimate yield_gain = change(s.yield, n);
    const Estimate jam_change = change(s.jam, n);
    result.sources.push_back(
        {.first_order = ratio(s.first, sums, result.variance_rad2, n),
         .total = ratio(s.total, sums, result.variance_rad2, n),
         .halved = {.yield = result.yield + yield_gain.value,
                    .jam_probability = result.jam_probability + jam_change.value,
                    .quantile_99_rad = quantile_99(workers[0].halved[i]),
                    .yield_gain = yield_gain,
                    .jam_change = jam_change}});
  }
  return result;
}

}  // namespace gear3k::backlash
