#pragma once
// What a campaign says that later measurements meet.

#include <optional>
#include <string_view>
#include <vector>

#include "calibrate/fit/fit.hpp"
#include "calibrate/verdict/diagnosis.hpp"

namespace gear3k::calibrate {

/// One change of all rows alike.
struct CommonChange {
  std::string_view law;  ///< what it changes, as AppliedCause::left_behind_on
  double value = 0.0;    ///< [of friction and gain a share, else unit of the response]
};

/// Where it is not known what of an effect goes on after the campaign: the one change that stands
/// for it in the rows as a whole, as one refitted value would,
///
///   x = argmin Σ ρ(w_i (y_i − y_i(x))/s)
///
/// y: measured, y(x): simulated with x in the place of the effect, w: 1/σ where it is
/// stated, else 1, ρ: huber_square(), s: robust deviation without the effect.  It changes what a
/// refit changes (friction or gain, of lost motion the response), whichever has the least sum,
/// unless its sum is much worse than that of a change of what the effect acts on (is_much_worse()).
///
/// It is not known of sessions with a value each, of two sessions, where a cause that does not act
/// by when a row was measured explains as well, and of a formula that explains nothing.
/// Source: docs/theory §30 (later sessions).
/// @param found  what was found, with its alternatives; an effect that is none of these is a
/// formula
/// @returns empty where it goes on as the campaign left it
std::optional<CommonChange> change_left_behind(const Problem& problem, const Hypothesis& fitted,
                                               std::size_t effect,
                                               const std::vector<Effect>& found);

}  // namespace gear3k::calibrate
