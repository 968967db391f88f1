#pragma once
// Forms with free shape and reference in the place of those that a search found.

#include <vector>

#include "calibrate/fit/fit.hpp"

namespace gear3k::calibrate {

/// ln of the weight of a candidate before the data, w; a form that is not searched for has one too,
/// as one among those of its cause.
double log_weight_of(const Candidate& candidate);

/// −(n/2) ln S − (p/2) ln n + Σ ln w: likelihood of a fit with a price for its parameters and the
/// choice of its forms (for known scatter −S/2 in the place of the first term).
double score_of(const Problem& problem, const Fit& fit, double scale);

/// Whether a form that is not searched for may take the place of an effect as the same law with
/// more parameters.
bool may_free(const Hypothesis& h, std::size_t effect, const Candidate& form);

/// The hypothesis with a form in the place of an effect; parameters of the same name keep their
/// values, the others are 0.
Hypothesis in_form(const Hypothesis& h, std::size_t effect, const Candidate& form);

/// Whether an effect is play beside a wind-up: both are in every gearbox, and a wind-up that is
/// soft enough draws play as well.
bool is_play_beside_windup(const Hypothesis& h, std::size_t effect);

/// The fit with effects in forms of more parameters, as long as one has a better score: the shape
/// of a law, its reference and its level are not known before the data.
/// @param all  candidates; those of Form::weight 0 are tried
/// @returns the fit as it is where none is better
Fit with_free_shapes(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale);

/// The fit with an effect of free shape in a plain form beside one more cause, where that has a
/// better score, these with free shapes again: a law that bends and two straight ones can look
/// alike. Play is looked for beside a wind-up of free shape, too.
/// @param found  a fit at this scale; @param most  effects that a fit may have
Fit with_plain_shapes(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                      double scale, int most);

/// The fit without effects that it does not need, or with another cause or another law of the same
/// cause in the place of one, as long as either has a better score; then with free shapes.
/// @param found  a fit at this scale
Fit with_exchanges(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                   double scale);

/// The fit with a law of any smooth curve of load, speed or temperature in the place of one or two
/// effects, where that has a better score: two effects of fixed shape may draw one law that no
/// plain form has.
/// @param found  a fit at this scale
Fit with_smooth_laws(const Problem& problem, const std::vector<Candidate>& all, Fit found,
                     double scale);

}  // namespace gear3k::calibrate
