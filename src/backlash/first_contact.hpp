#pragma once
// Which planets carry when the flanks of an assembled gearbox first meet.

#include <span>
#include <vector>

#include "backlash/output_range.hpp"

namespace gear3k::backlash {

/// The gearbox at one end of its output's range, before anything deforms.
struct FirstContact {
  /// Part of the output's torque that each planet's mesh P2-R2 carries; their sum is 1.  Negative:
  /// that planet is wedged between the others and works against them.
  std::vector<double> share;
  /// How much further [m], along R2's line of action, the output would have to move, carrier held,
  /// until this planet carries too; 0 for those that do.
  std::vector<double> room_m;
};

/// Shares are the multipliers of the program that output_range() solves; planets within 1 nm of
/// each other share evenly.
/// Source: own derivation, docs/theory §33.
/// @param greatest  the upper end of the range, else the lower
/// @throws std::invalid_argument where the gearbox does not assemble, or without planets
FirstContact first_contact(const OutputLevers& levers, std::span<const PlanetPlay> planets,
                           bool greatest);

}  // namespace gear3k::backlash
