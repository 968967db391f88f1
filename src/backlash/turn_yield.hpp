#pragma once
// Gearboxes of a series over a whole turn.

#include <cstdint>
#include <optional>

#include "backlash/monte_carlo.hpp"
#include "backlash/turn.hpp"

namespace gear3k::backlash {

struct TurnYieldOptions {
  std::uint64_t gearboxes = 400;  ///< the first ones of the series
  std::uint64_t seed = 1;
  ScatterOptions scatter{};
  std::optional<double> limit_rad{};  ///< of the lost motion; empty: none
};

/// Shares of gearboxes at every position of a turn_window(), with the deviations of all their
/// teeth.
struct TurnYield {
  std::uint64_t gearboxes = 0;
  Proportion assembled;  ///< at every angle
  Proportion yield;      ///< and with no more lost motion than the limit at any
};

/// OpenMP over gearboxes; the same counts at any number of threads.
/// Does not cover: angles between those of the window.
/// @throws std::invalid_argument for 0 gearboxes
TurnYield turn_yield(const ClearanceModel& model, const train::ToothSet& z,
                     const TurnYieldOptions& options);

}  // namespace gear3k::backlash
