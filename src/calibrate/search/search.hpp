#pragma once
// Which causes explain a discrepancy: sets of up to three, and what else explains it as well.

#include <cstdint>
#include <vector>

#include "calibrate/fit/columns.hpp"
#include "calibrate/fit/fit.hpp"
#include "calibrate/fit/screen.hpp"

namespace gear3k::calibrate {

/// Effects that a set may have: more than three are hardly told apart by a campaign.
inline constexpr int kMostEffects = 3;

struct SearchOptions {
  double rate = 0.04;  ///< probability of finding something where there is nothing
  std::uint64_t seed = 1;
};

/// Another cause in the place of an effect.
struct Replacement {
  Candidate candidate;
  bool with_level = false;
  double statistic = 0.0;  ///< χ² of the set with it less that of the set found
  Fit fit;
};

struct FoundEffect {
  double p_value = 1.0;    ///< given the other effects
  double delta_bic = 0.0;  ///< of leaving it out
  std::vector<Replacement> replacements;
  std::vector<Replacement> other_bodies;  ///< the same cause elsewhere, as good as here
};

struct SearchResult {
  Fit fit;  ///< of all effects found; of the baseline when there are none
  std::vector<FoundEffect> effects;
  double scale = 0.0;  ///< standard deviation of whitened rows about that fit
  /// The first step: of each candidate by itself.
  std::vector<Candidate> candidates;
  std::vector<Gain> first_gains;
  Screen::Luck first_luck;
  double first_p = 1.0;
  std::size_t rows = 0;  ///< that were searched
};

/// Forms of all causes that the data could show, with the weight of each among its cause's forms.
std::vector<Candidate> candidates_for(const Simulation& simulation, const MeasurementSet& data);

/// @param known  what was found under another noise model, which is taken where it is clearly
///     better than what is found under this one
SearchResult search_causes(const Problem& problem, const std::vector<Candidate>& candidates,
                           const SearchOptions& options, const SearchResult* known = nullptr);

}  // namespace gear3k::calibrate
