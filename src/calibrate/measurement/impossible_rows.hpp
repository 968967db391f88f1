#pragma once
// Rows of more power out than in.

#include <optional>
#include <string>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Leaves out rows that give more power than they take, and names them in the notes: transmission
/// above efficiency 1 at this ratio, pair_loss below 0.
///
///   forward  T_sun < T_out/|i|,  backward  T_sun > T_out/|i|
///
/// by more than 3 standard deviations and more than 1 % of T_out/|i| (pair_loss: of 1).  Where the
/// rows state no sigma it is estimated from the scatter of neighbours in load, which repeats are
/// too.  Rows of transmission that fall together into one session, direction, load, speed or
/// twelfth of a turn stay and are noted: where readings are impossible together a sensor is wrong,
/// or the gearbox there, and they are what tells it from friction.  Other kinds: nothing.
/// @returns what is wrong where they are more than 20 % of the rows, which then stay
/// @throws std::invalid_argument when ratio is not a finite number other than 0 (transmission)
[[nodiscard]] std::optional<std::string> leave_out_impossible(MeasurementSet& set, double ratio);

}  // namespace gear3k::calibrate
