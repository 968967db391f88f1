#pragma once
// How often parts of the data find the same causes.

#include <string_view>
#include <vector>

#include "calibrate/search/search.hpp"

namespace gear3k::calibrate {

/// Share of random halves of the rows in which a search along the linearisation finds each cause:
/// by position in `groups`, sets of causes that count as one.  NaN: too few rows.
std::vector<double> inclusion_frequency(const Problem& problem, const SearchResult& result,
                                        const std::vector<std::vector<std::string_view>>& groups,
                                        const SearchOptions& options);

}  // namespace gear3k::calibrate
