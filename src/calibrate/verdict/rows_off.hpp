#pragma once
// Rows far off as structure: those of one session or level, and more of them than outliers are.

#include <optional>
#include <string>
#include <vector>

#include "calibrate/verdict/remainder.hpp"

namespace gear3k::calibrate {

/// Where no structure was found in what a fit leaves, rows far off in one sense that are of one
/// level of a covariate (a session, speed, load, direction, ...), or of one in one direction, are
/// structure along it (rows_together()).
/// @param columns  of the fit; far off are rows that are clipped in its residual
/// @param rate     of false discoveries of structure; these rows get twice as much, and the p-value
///                 that is set is half of theirs
/// @returns a sentence that says which level it is; empty where there is none
std::optional<std::string> take_level_off(const Problem& problem, const Columns& columns,
                                          const std::vector<Levels>& levels, double rate,
                                          RemainderSearch& search);

/// P that outliers are as many: each row is one with the probability 0.15, more than any sensor's
/// that is used.
double chance_of_outliers(std::size_t outliers, std::size_t rows);

}  // namespace gear3k::calibrate
