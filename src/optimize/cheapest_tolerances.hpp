#pragma once
// The cheapest tolerances that still reach a yield.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "backlash/monte_carlo.hpp"

namespace gear3k::optimize {

/// As high as a series of random gearboxes can tell a yield from 1: one of them fails.
inline constexpr double highest_yield(std::uint64_t samples) {
  return 1.0 - 1.0 / static_cast<double>(samples);
}

struct CheapestOptions {
  double yield = 0.99;     ///< at most highest_yield(samples)
  double limit_rad = 0.0;  ///< of the lost motion
  /// By backlash::ToleranceKind: cost of one tolerance as stated.
  std::array<double, backlash::kToleranceKindNames.size()> cost{};
  backlash::ScatterOptions scatter{};
  std::uint64_t samples = 20'000, seed = 1;
  /// Of a second series, from seed + 2, that has to reach the yield too: the search fits its own.
  std::uint64_t verifying_samples = 200'000;
  /// Whether tooth thicknesses and centre distance may be as wide as these factors make them;
  /// empty: yes.
  std::function<bool(const std::vector<double>& factor)> may_widen{};
  std::function<bool()> stop{};  ///< asked now and then; empty: never
};

struct CheapestTolerances {
  /// By ClearanceModel::sources: what each half width is multiplied by, a power of √2 from 1/8 to
  /// 8.
  std::vector<double> factor;
  double stated_cost = 0.0, cost = 0.0;
  double stated_yield = 0.0, yield = 0.0;  ///< of the verifying series
  bool reached = false;  ///< whether the yield is; else `factor` is what came nearest
};

/// Scales the stated tolerances about their middles, in steps of √2 (a grade of ISO 1328), for the
/// least cost
///
///   Σ cost_kind/factor     over all sources
///
/// at which yield (assembles, lost motion within the limit) is at least as asked for.  From the
/// stated ones: while the yield is short, the step down that buys most yield per cost; then, as
/// long as the yield stays, the step up that saves most per yield lost; then steps up of one
/// against steps down of another while they save.  No single step, and no such pair, improves the
/// result; it is not proven to be the cheapest of all.
///
/// The same numbers of the random gearboxes in every trial, so that trials differ by their
/// tolerances only.  Where the verifying series then falls short, the search goes on with a yield
/// as much higher, a few times at most.
///
/// Source: own derivation, docs/theory §35; reciprocal cost: the usual model of tolerance
/// synthesis.
/// @throws std::invalid_argument for a yield above highest_yield(options.samples)
CheapestTolerances cheapest_tolerances(const backlash::ClearanceModel& model,
                                       const CheapestOptions& options);

/// Tolerances with each source of their model scaled; F_p keeps the share that run-out has in it.
backlash::Tolerances scaled(const backlash::Tolerances& tolerances,
                            const backlash::ClearanceModel& model,
                            const std::vector<double>& factor, double cos_pressure_angle);

}  // namespace gear3k::optimize
