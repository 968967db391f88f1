#pragma once
// The search for causes together with what its residuals say of the noise.

#include <functional>
#include <string>
#include <vector>

#include "calibrate/search/memory_from_fit.hpp"
#include "calibrate/search/noise_from_fit.hpp"
#include "calibrate/search/search.hpp"

namespace gear3k::calibrate {

/// Searches for causes, again where the residuals show that the rows do not scatter alike: the
/// problem's noise model is changed accordingly.
///
/// Of more than 24,000 rows 12,000 at random places are searched; what was found, and the noise
/// model, are then fitted to all.
/// @param tell      told how far the work of a diagnosis is; the search ends where it says false
/// @param sessions  what sessions scatter beyond what was found
/// @param memory    how the noise remembers
/// @param notes     what a reader wants to know of it, appended
SearchResult search_with_noise(Problem& problem, const std::vector<Candidate>& candidates,
                               const SearchOptions& options,
                               const std::function<bool(double)>& tell, SessionScatter& sessions,
                               MemoryEstimate& memory, std::vector<std::string>& notes);

}  // namespace gear3k::calibrate
