#pragma once
// Whether the rows tell that there is a wave at all, or that sessions differ.

#include <cstddef>

#include "calibrate/fit/fit.hpp"

namespace gear3k::calibrate {

/// Whether an effect of a fit is a wave that the rows do not tell: the amplitude of all harmonics
/// together
///
///   A = √(Σ p²)
///
/// is less than half of its 95 % interval, so that every phase is in it; or it is more than the
/// responses are in the mean, which no run-out is.
/// @param variance  of whitened rows
bool is_no_wave(const Problem& problem, const Hypothesis& h, std::size_t effect, double variance);

/// Whether the deviation of sessions with a value each from their mean is less than half of its
/// 95 % interval.
bool sessions_are_alike(const Problem& problem, const Hypothesis& h, std::size_t effect,
                        double variance);

}  // namespace gear3k::calibrate
