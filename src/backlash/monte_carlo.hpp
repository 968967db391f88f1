#pragma once
// What a series of built gearboxes will do.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "backlash/fine_histogram.hpp"
#include "backlash/gearbox_chunks.hpp"
#include "backlash/random_gearbox.hpp"
#include "backlash/worst_case.hpp"

namespace gear3k::backlash {

struct MonteCarloOptions {
  std::uint64_t samples = 1'000'000;  ///< gearboxes
  std::uint64_t seed = 1;
  ScatterOptions scatter{};
  std::optional<double> limit_rad{};  ///< of the lost motion; empty: none
  SeriesProgress progress{};
};

/// Share of a series, with Clopper and Pearson's 95 % interval of the probability behind it.
struct Proportion {
  std::uint64_t count = 0;
  double value = 0.0, lower = 0.0, upper = 1.0;
};
/// @throws std::invalid_argument unless 0 < samples and count ≤ samples
Proportion proportion(std::uint64_t count, std::uint64_t samples);

/// Value that a share `probability` of the gearboxes does not exceed.
struct Quantile {
  double probability = 0.0, value = 0.0;
};
inline constexpr std::array kLostMotionProbabilities{0.001, 0.01, 0.05, 0.25, 0.5,
                                                     0.75,  0.95, 0.99, 0.999};
inline constexpr std::array kMarginProbabilities{1e-4, 1e-3, 0.01, 0.05, 0.5};
/// Bins between 0 and the worst case from which quantiles are taken: their resolution.
inline constexpr std::size_t kFineBins = std::size_t{1} << 16U;

/// Of those that assemble.
struct LostMotionDistribution {
  double mean_rad = 0.0;
  double deviation_rad = 0.0;  ///< standard deviation
  double least_rad = 0.0, greatest_rad = 0.0;
  std::vector<Quantile> quantiles{};      ///< [rad], at kLostMotionProbabilities
  std::vector<HistogramBin> histogram{};  ///< [rad], about 100 bins
};

struct MonteCarloResult {
  std::uint64_t samples = 0;  ///< fewer than asked for where the progress ended the series
  Proportion assembled, jammed;
  Proportion beyond_limit;  ///< of all: they assemble, with more lost motion than the limit
  Proportion yield;         ///< of all: they assemble, within the limit
  LostMotionDistribution lost_motion;
  /// Limit that 99 % of all gearboxes meet; empty where more than 1 % jam.
  std::optional<double> limit_of_99_percent_rad;
  std::vector<Quantile> margin;  ///< of OutputRange::margin_m, at kMarginProbabilities, of all
  WorstCase worst;
};

/// Builds `samples` random gearboxes (RandomGearbox, GearboxBatch).
///
/// The same bits at any number of OpenMP threads: a gearbox depends on seed and index only, sums
/// are taken by chunks of kChunkGearboxes and added in their order, histograms are integers.
/// Resolution of quantiles: the range of the worst case over kFineBins.
/// @throws std::invalid_argument for 0 samples or a limit that is not a number
MonteCarloResult monte_carlo(const ClearanceModel& model, const MonteCarloOptions& options);

}  // namespace gear3k::backlash
