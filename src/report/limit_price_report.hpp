#pragma once
// What holds the best designs back, for tables and summary.json.

#include <string>
#include <vector>

#include "io/text/json.hpp"
#include "optimize/limit_prices.hpp"
#include "optimize/optimizer.hpp"

namespace gear3k::report {

/// An optimum with what holds it back.
struct HeldSet {
  optimize::RefinedSet set;
  optimize::HeldBack held;
};

/// The best design with what holds it back, and the best of every number of planets, by rising
/// number.
struct HeldBackReport {
  HeldSet best;
  std::vector<HeldSet> by_planets;
  /// What is proven of numbers of planets; empty where that was not asked for.
  std::vector<optimize::PlanetsCertificate> proofs{};
  bool all_refined = true;   ///< else only sets that could be the best of all are refined
  bool interrupted = false;  ///< before these were
};

inline constexpr std::size_t kAnyColumns = 1000;

/// "Held back by": a line for every active limit with its price, the bounds of the search that the
/// set sits at, and the better answer that the dearest limit would give if it gave way by a step.
/// @param columns  a table that is wider is told in lines instead
std::string held_back_table(const optimize::Specification& spec, const HeldSet& best,
                            std::size_t columns = kAnyColumns);

/// The best design of every number of planets, with what is proven of it, and the numbers of which
/// none is known, with the reason; "" where there is one number only.
/// @param columns  as above
std::string planets_table(const optimize::Specification& spec, const HeldBackReport& report,
                          std::size_t columns = kAnyColumns);

/// Fields of summary.json: prices, prices_missing, at_bounds, better_estimate, best_per_planets,
/// planets_without_best.
io::Json held_back_json(const optimize::Specification& spec, const HeldBackReport& report);

}  // namespace gear3k::report
