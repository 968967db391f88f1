#pragma once
// Every tooth set that meets the ratio, generated rather than filtered.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "optimize/progress.hpp"
#include "optimize/specification.hpp"

namespace gear3k::optimize {

/// A tooth set with its number of planets.
struct Candidate {
  train::ToothSet teeth;
  int planets = 3;
  // clang-tidy takes the 0 of a rewritten comparison for a pointer.
  auto operator<=>(const Candidate&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Why a set within the tooth ranges and the ratio's tolerance is not a candidate.
enum class ToothRejection {
  kAllowedTeeth,
  kInternalDifference,
  kEqualSpacing,
  kIdenticalPlanets,
  kHuntingTooth
};
inline constexpr std::size_t kToothRejectionCount = 5;
/// Names in result files, in the order of the enum; all but the second are names of checks.
inline constexpr std::array<std::string_view, kToothRejectionCount> kToothRejectionNames{
    "allowed_teeth", "min_internal_difference", "equal_spacing", "identical_planets",
    "hunting_tooth"};

struct ToothSearchResult {
  /// Ordered by planets, S, P1, R1, P2, R2, whatever the number of threads; empty where they were
  /// handed on instead.
  std::vector<Candidate> candidates;
  /// Sets (per number of planets) within all tooth ranges, the coaxial offset and the ratio.
  std::uint64_t within_ratio = 0;
  /// Of those, the rejected ones by their first failing rule in the order of ToothRejection.
  std::array<std::uint64_t, kToothRejectionCount> rejected{};
  /// The ratio nearest to the target, with rings larger than their planets, among the tooth sets
  /// visited (0 when there is none): the closest miss when nothing is within.
  double nearest_ratio = 0.0;
  bool interrupted = false;

  /// Number of candidates, kept or handed on: within_ratio less the rejected ones.
  [[nodiscard]] std::uint64_t candidate_count() const;
};

/// Whether a ratio is within the tolerance of the target.
bool ratio_matches(double ratio, const RatioTarget& target);

/// All tooth sets of a specification.
///
/// For each (S, P1, R1, P2) the ratio confines zR2 to
///   zP2 zR1/(zP1 zR2) = G2 = 1 − (1 + G1)/ratio,
/// so only the few zR2 of that band are visited; each is then tested by ratio_matches() on the
/// exactly computed ratio, with a tooth of slack on the band, so that none is lost to rounding.
/// OpenMP over (S, P1).  Ranges are taken as they are: a range with min > max holds nothing.
/// Which rules apply: the checks of tooth numbers, where they are switched on.
/// @param progress  counts the (S, P1) pairs; its stop ends the search early (result.interrupted)
ToothSearchResult search_teeth(const Specification& spec, Progress& progress);

/// The same, the candidates handed on in their order, some (S, P1) pairs at a time, instead of
/// kept: no more is held than what one such piece has.
/// @param take  called with one piece after the other
ToothSearchResult search_teeth(const Specification& spec, Progress& progress,
                               const std::function<void(std::span<const Candidate>)>& take);

/// About how many candidates a search has.
///
///   n = (number of (planets, S, P1, P2)) · mean over samples of (R1 visited) (R2 visited)
///   [candidate]
///
/// Samples are (S, P1, R1, P2, R2) that search_teeth() would visit, spread evenly.
/// Accuracy: about √(visited sets/(samples · n)); some 10 % with 1 candidate in 4000 visited.
/// @param most  sampling ends where the estimate is clearly below it, else at kEstimateSamples
double estimated_candidates(const Specification& spec, double most);
inline constexpr int kEstimateSamples = 400'000;
/// Candidates of a search that is only ranked, at 40 bytes each, and of one whose sets are bounded
/// and refined, at 70 bytes, 0.4 kB for each refined set and 0.6 kB for each stage.
inline constexpr double kMostRankedSets = 4e7;
inline constexpr double kMostRefinedSets = 1e7;

}  // namespace gear3k::optimize
