#pragma once
// A design as it is built many times over: yield, what it depends on, who carries first, one turn.

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "backlash/monte_carlo.hpp"
#include "backlash/tolerance_shares.hpp"
#include "backlash/turn_yield.hpp"
#include "design/design.hpp"
#include "design/thermal_series.hpp"

namespace gear3k::design {

/// Room that is left at the planets when the output's flanks first meet, over a series and both
/// senses of rotation.
struct FirstContactRooms {
  double greatest_share = 0.0;  ///< mean of the greatest part of the torque on one planet
  /// By rank: room [m] at the planet that would carry first (0), second, ...: median, and what 95 %
  /// have at most.
  std::vector<double> median_m, percent95_m;
  std::uint64_t samples = 0;  ///< gearboxes that assemble
};

struct BuiltSeries {
  backlash::ClearanceModel model;
  backlash::ScatterOptions scatter;
  std::uint64_t seed = 1;
  std::optional<double> limit_rad;  ///< of the lost motion, as the design's limits have it
  backlash::MonteCarloResult result;
  backlash::ToleranceShares shares;
  FirstContactRooms rooms;
  std::vector<ThermalSeries> thermal{};     ///< at the ends of the design's range, if any
  std::optional<backlash::TurnYield> turn;  ///< empty unless asked for
  bool paper_limit = false;  ///< the design's limit is for another model and does not count
};

/// Gearboxes for the shares of the tolerances, and for the rooms at first contact, at most.
inline constexpr std::uint64_t kShareSamples = 100'000, kRoomSamples = 20'000;

/// Builds design.sampling.samples gearboxes at random within the design's tolerances.
/// @param model  clearance_model_of() the design
/// @param share_samples  gearboxes for the shares
BuiltSeries build_series(const Design& design, const backlash::ClearanceModel& model,
                         std::uint64_t share_samples, const backlash::SeriesProgress& progress);

/// Empty where the design has no tolerances, or a mesh no working angle at their middle.
std::optional<backlash::ClearanceModel> clearance_model_of(const Design& design);

/// As many gearboxes as a table needs, 200,000 at most, 20,000 for the shares; empty where
/// build_series() has nothing to build.
std::optional<BuiltSeries> table_series(Design design);

}  // namespace gear3k::design
