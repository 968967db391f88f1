#pragma once
// What became of the tooth sets of a run of `optimize`, and what blocks a run without a design.

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "optimize/optimizer.hpp"

namespace gear3k::report {

/// Counts over all tooth sets of a result.
struct ResultTally {
  std::array<std::size_t, optimize::kStatusCount> status{};
  /// By status, how many sets each constraint blocks.
  std::array<std::map<std::string, std::size_t>, optimize::kStatusCount> reasons;
  std::size_t grid_cut = 0;                      ///< sets the search of whose grids was cut short
  std::size_t refinements = 0, relaxations = 0;  ///< of all sets, see optimize::RefinedSet
  std::size_t cut_without_design = 0;            ///< of them those in which no design was found
  std::size_t open = 0;                          ///< not reached, as the run was interrupted
  /// Of the sets without a feasible design the one that says most: found rather than proven so,
  /// blocked by one constraint alone, of proven ones by that which blocks most sets, by the least
  /// miss.
  std::optional<optimize::RefinedSet> nearest;
  std::size_t blocked_by_load = 0;  ///< sets that a limit of the load blocks, alone or among others
};
ResultTally tally_of(const optimize::OptimizeResult& result);

/// Whether the solver failed on sets, and found none that misses a limit: then no limit is known to
/// be what blocks.
bool only_failed(const ResultTally& tally);

/// What was not found as the search of grids was cut short, and how it is; "": none was.
std::string grid_cut_text(const optimize::Specification& spec, std::size_t sets);
/// The same of refinements in many searches, between two texts; "": none was.
struct TextAround {
  std::string_view before, after;
};
std::string grid_cuts_text(const optimize::Specification& spec, std::size_t refinements,
                           const TextAround& around = {.before = "  ", .after = "\n"});

/// Counts by status and reason, for the terminal.
std::string optimize_counts_text(const optimize::OptimizeResult& result, const ResultTally& tally);

/// Which constraint blocks a run without a feasible design, and by how much.
std::string blocking_text(const optimize::Specification& spec,
                          const optimize::OptimizeResult& result, const ResultTally& tally);

}  // namespace gear3k::report
