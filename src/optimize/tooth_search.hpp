#pragma once
// Every tooth set that meets the ratio, generated rather than filtered.

#include <array>
#include <cstdint>
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
enum class ToothRejection { kInternalDifference, kEqualSpacing, kIdenticalPlanets };
inline constexpr std::size_t kToothRejectionCount = 3;
/// Names in result files, in the order of the enum; the last two are names of checks.
inline constexpr std::array<std::string_view, kToothRejectionCount> kToothRejectionNames{
    "min_internal_difference", "equal_spacing", "identical_planets"};

struct ToothSearchResult {
  /// Ordered by planets, S, P1, R1, P2, R2, whatever the number of threads.
  std::vector<Candidate> candidates;
  /// Sets (per number of planets) within all tooth ranges, the coaxial offset and the ratio.
  std::uint64_t within_ratio = 0;
  /// Of those, the rejected ones by their first failing rule in the order of ToothRejection.
  std::array<std::uint64_t, kToothRejectionCount> rejected{};
  /// The ratio nearest to the target, with rings larger than their planets, among the tooth sets
  /// visited (0 when there is none): the closest miss when nothing is within.
  double nearest_ratio = 0.0;
  bool interrupted = false;
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
/// Which rules apply: the checks equal_spacing and identical_planets, where they are switched on.
/// @param progress  counts the (S, P1) pairs; its stop ends the search early (result.interrupted)
ToothSearchResult search_teeth(const Specification& spec, Progress& progress);

}  // namespace gear3k::optimize
