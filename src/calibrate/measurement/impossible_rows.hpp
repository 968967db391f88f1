#pragma once
// Rows of more power out than in.

#include <optional>
#include <string>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Leaves out rows that give more power than they take (PowerExcess), and names them in the notes:
/// transmission above efficiency 1 at this ratio, pair_loss below 0.
///
/// Rows of transmission that fall together (marked_together()) stay and are noted, and with them
/// those of their directions and rotations that are off by no more: where readings are impossible
/// together a sensor is wrong, or the gearbox there, and they are what tells it from friction.  So
/// do those of few rows where one gain or zero of a sensor, up to a fifth, makes all possible.
/// Other kinds: nothing.
/// @returns what is wrong where more than 20 % of the rows are impossible, which then stay, and
///   fall together in nothing, are possible once forward and backward are exchanged (in all of the
///   set, one session or one file), or are off by more than a fifth of the greatest response that
///   the loads would give without loss; pair_loss: where they are more than 20 %
/// @throws std::invalid_argument when ratio is not a finite number other than 0 (transmission)
[[nodiscard]] std::optional<std::string> leave_out_impossible(MeasurementSet& set, double ratio);

}  // namespace gear3k::calibrate
