#pragma once
// A formula for what no cause explains: chosen among short forms, and held against blocks of rows
// that it has not seen.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/fit/holdout.hpp"
#include "calibrate/fit/linearisation.hpp"
#include "calibrate/laws/law_forms.hpp"
#include "calibrate/model/law.hpp"

namespace gear3k::calibrate {

struct FoundLaw {
  Law law;
  /// The causes, or none where they fall, with the law as the last effect, fitted together.
  Hypothesis hypothesis;
  double scale = 0.0;  ///< standard deviation of the whitened rows about it
  /// Each row of the data as causes and law predict it with all parameters fitted anew without its
  /// block, the causes along their linearisation [SI].  What the other blocks do not determine is
  /// not known there: an amplitude is then 0.
  Eigen::VectorXd predicted;
  double delta_bic = 0.0;  ///< of the causes alone less that with the law; forms tried are paid for
  /// That the best of N forms takes off as much where there is nothing: at most N P(χ²_k ≥ X), k
  /// the law's numbers, X what it takes off, rows beyond three deviations as three.
  double p_value = 1.0;
  /// What it adds to each row as given, in the fit to all of them [SI].
  Eigen::VectorXd change;
  int forms = 0;   ///< that were tried
  int orders = 1;  ///< of these that a wave or pulse was chosen from
};

/// Looks for a law in what a hypothesis leaves.
///
/// A form has amplitude, perhaps an offset, and one or two factors, three parameters at most; every
/// form is tried at a grid of its parameters, linear in amplitude and offset, beside the
/// hypothesis' own columns; the best are refined by Gauss-Newton steps of all parameters (the
/// simulation linear in its own) with Huber's bound.  The one of the least
///
///   Σ ρ(r/s) + p ln n + 2 ln N
///
/// stays: p parameters and constants, N forms that were tried (of waves and pulses times the orders
/// that were looked through), s the least robust deviation about those refined; what is said of the
/// one that stays is said with that about it, times √(n/ν), ν the rows less all fitted numbers.  It
/// is a law where that is less by 10 than without it, and where rows of held-out blocks, predicted
/// with all parameters fitted anew without them (constants stay), gain more over the hypothesis
/// than the standard error of that gain over blocks. Causes that only imitate the law fall: where a
/// law without them does better by 10, in the same measure with each cause paid for as one of
/// `candidates`, it is given alone.  A form that does more between its rows than they hold
/// (exceeds_its_rows) is none, unless it is better by 20 than all others of the 24 that are refined
/// and does no more there than it differs by in them: what a form that was not refined would reach
/// is not known.
///
/// Of the scope kPlain (nothing else tells of structure) more is asked: rows beyond three
/// deviations count as three in every sum, so that a few far rows make no law; it is less by
/// max(20, −2 ln rate) than without it, and its p-value is at most the rate; beside causes it takes
/// off at least a fiftieth of the squares that there are; and causes fall, each paid for as one of
/// `candidates` as well, one alone only where the law does better by that fiftieth.
/// @param hypothesis  a fit already
/// @param blocks  that are held out together
/// @param candidates  M, from which the causes of the hypothesis were chosen; at least 1
/// @param rate  of false discoveries
std::optional<FoundLaw> find_law(const Problem& problem, const Hypothesis& hypothesis,
                                 const Blocks& blocks, LawScope scope, std::size_t candidates,
                                 double rate = 0.05);

/// Each row as a fit of causes and law without its block predicts it, the causes along their
/// linearisation, the law with all its parameters fitted anew [SI].
/// @param hypothesis  a fit, a law its last effect
/// @param scale  standard deviation of the whitened rows
/// @throws std::invalid_argument when the hypothesis has no effects, or its last is no law
Eigen::VectorXd predict_law_held_out(const Problem& problem, const Hypothesis& hypothesis,
                                     const Blocks& blocks, double scale);

}  // namespace gear3k::calibrate
