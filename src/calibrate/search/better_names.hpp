#pragma once
// Which of several names for the same thing an effect is told by.

#include <vector>

#include "calibrate/search/judge.hpp"
#include "calibrate/search/search.hpp"

namespace gear3k::calibrate {

/// Takes a replacement in the place of an effect where it is the better name for the same thing:
/// the coefficient of friction (a parameter, within χ² 4 and plausible) before a missing effect, a
/// step between sessions before a law (χ² 2), and at a tie what stands earlier in the library.
void prefer_parameters(const Judge& judge, SearchResult& result);

/// Forms of as many parameters that are not searched for (Form::weight 0) in the place of those
/// found, where they explain as well within χ² 2 and are plausible.
void take_unsearched_forms(const Judge& judge, const std::vector<Candidate>& all,
                           SearchResult& result);

/// χ² by which a replacement must be ahead to be likelier than the name: what set_posteriors()
/// makes of either (docs/theory §30).
inline constexpr double kLikelier = 2.2;

/// Takes a replacement that is likelier than the name it may replace.  The coefficient of friction
/// stays, as it is preferred whatever is ahead by less than χ² 4; and so does a name where the
/// values of what is likelier are none that a gearbox shows, or where that is likelier only if its
/// shape costs nothing (Judge::of_any_shape()).
/// @returns whether one was taken: all effects are to be judged anew
bool take_likelier_name(const Judge& judge, SearchResult& result);

/// Takes those that are preferred, forms that are not searched for and the zero of the sensor that
/// was read before another one's, and looks for other bodies that show each cause as well; p-values
/// and BIC become those of the names that stay, and of a form that is not searched for the p-value
/// is that of the form which was.
void take_better_names(const Judge& judge, const std::vector<Candidate>& all, SearchResult& result);

}  // namespace gear3k::calibrate
