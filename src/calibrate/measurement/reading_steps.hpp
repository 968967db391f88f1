#pragma once
// Readings of a sensor or a display that shows whole steps.

#include <optional>

#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// Readings are `origin` and whole numbers of `step` from there [SI].
struct ReadingSteps {
  double origin = 0.0, step = 0.0;
};

/// The step of the responses, whatever its size; unlike resolution_of() no power of ten.
/// @returns nothing where the responses take no equal steps, or nearly as many values as there are
///          rows, or where those are steps of what was set: repeats agree, or without repeats there
///          are fewer than eight values
std::optional<ReadingSteps> reading_steps(const MeasurementSet& data);

}  // namespace gear3k::calibrate
