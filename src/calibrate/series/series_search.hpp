#pragma once
// Which causes explain the gearboxes of a series together.

#include <deque>
#include <string>
#include <vector>

#include "calibrate/search/search.hpp"
#include "calibrate/series/joint_fit.hpp"

namespace gear3k::calibrate {

/// Score by which another explanation may be worse and still count as one.
inline constexpr double kSeriesAsWell = 6.0;

/// Causes that the search for a series looks through: in their searched forms, without those of the
/// procedure (steps between sessions, drift), which are no gearbox' own.
std::vector<Candidate> series_candidates(const Simulation& simulation, const MeasurementSet& data);

struct SeriesSearch {
  JointFit fit;
  /// By effect: ids of other causes that explain the series within kSeriesAsWell of its score in
  /// its place.
  std::vector<std::vector<std::string>> alternatives;
};

/// Adds causes one by one while they are more than luck, then exchanges and drops them as long as
/// the score of the joint fit falls.
///
/// A candidate is looked for with one value in all gearboxes and with a value in each (k and k U
/// columns); the greatest evidence of either is compared with that of residuals with random signs.
/// @param options  rate: of finding anything where nothing is wrong
SeriesSearch search_series(const std::deque<SeriesUnit>& units,
                           const std::vector<Candidate>& candidates, const SearchOptions& options);

/// The same set without the effects that the score does not need.
JointFit needed(const std::deque<SeriesUnit>& units, JointFit fit);

/// Variance between sessions over that of a row, τ²/σ², from how sessions of one gearbox differ in
/// what the causes leave, over all gearboxes:
///
///   F = [Σ_s n_s r̄_s²/(S − U)]/[Σ (r − r̄_s)²/(n − S)]
///
/// with r less its gearbox' mean, S sessions of gearboxes that have at least two.
/// @returns 0 where P(F) is above 1 %; else max(0, F − 1) S/n
double series_session_variance(const std::deque<SeriesUnit>& units, const JointFit& fit);

}  // namespace gear3k::calibrate
