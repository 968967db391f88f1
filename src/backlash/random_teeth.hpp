#pragma once
// Deviations of single teeth of one built gearbox.

#include <cstdint>

#include "backlash/random_gearbox.hpp"
#include "backlash/turn.hpp"

namespace gear3k::backlash {

/// What belongs to one gearbox of a series: its teeth.
struct ToothSeries {
  std::uint64_t seed = 1, gearbox = 0;
  ScatterOptions scatter{};
};

/// Draws every flank of every gear with a tolerance of its single pitch.  Numbers depend on seed,
/// gearbox, gear and flank only; they are others than those of RandomGearbox.
/// @param numbers  number_table(series.scatter), which takes as long as some thousand flanks
ToothErrors random_teeth(const ClearanceModel& model, const train::ToothSet& z,
                         const ToothSeries& series, const OctaveTable& numbers);
inline ToothErrors random_teeth(const ClearanceModel& model, const train::ToothSet& z,
                                const ToothSeries& series) {
  return random_teeth(model, z, series, number_table(series.scatter));
}

}  // namespace gear3k::backlash
