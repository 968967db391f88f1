#pragma once
// Two names for what one explains, and one name for what is two: which causes a fit is told as.

#include <vector>

#include "calibrate/fit/fit.hpp"

namespace gear3k::calibrate {

/// Waves as one with harmonics, at the order and of the body that score best, where the score of
/// several is not above that by ΔBIC 10: on a grid of angles an order may stand for a harmonic of
/// another.
Fit with_one_wave(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                  double scale);

/// The fit without an effect, the others of free shape, where the score of the two is not above
/// that by ΔBIC 10: a second cause takes up what a law of fixed shape leaves of a law of another
/// one. Not so play beside a wind-up.
/// @param found  a fit at this scale
Fit with_freed_rests(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale);

/// A drift and a step between sessions as one drift of free shape, where the score of the two is
/// not above that by ΔBIC 10: a step takes up what a drift of slightly another shape leaves.
Fit with_one_law_of_time(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                         double scale);

/// The fit with what a drift starts from as a cause of its own, where that is most of what the
/// drift explains and explains as well: a zero error that creeps is a zero error.
/// @param found  a fit at this scale; @param most  effects that a fit may have
Fit with_named_starts(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                      double scale, int most);

/// The fit with what sessions of a value each have in common as a cause of its own, and one step or
/// drift beside it where the data ask for one, where that explains as well: a zero error that moves
/// a little is a zero error.
/// @param found  a fit at this scale; @param most  effects that a fit may have
Fit with_named_means(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale, int most);

/// What all rows have in common where an effect acts, as a cause of one parameter; null where the
/// library has none or it stands beside the effect.
const Candidate* constant_of(const std::vector<Candidate>& all, const Hypothesis& h,
                             std::size_t effect);

}  // namespace gear3k::calibrate
