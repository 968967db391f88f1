#pragma once
// What holding for the built gearboxes cost, as `optimize` prints and writes it.

#include <cstdint>
#include <optional>
#include <string>

#include "backlash/turn_yield.hpp"
#include "io/text/json.hpp"
#include "optimize/cheapest_tolerances.hpp"
#include "optimize/robust.hpp"

namespace gear3k::report {

/// A robust run: its passes, and both designs built again from a seed that the search did not see.
struct RobustRun {
  optimize::RobustResult search;
  std::uint64_t samples = 0, fresh_seed = 0;
  optimize::BuiltOutcome nominal, chosen;
  backlash::TurnYield nominal_turn, chosen_turn;
  /// Of robust.tolerances = "cheapest".
  struct Cheapest {
    backlash::ClearanceModel model;
    backlash::Tolerances stated{}, chosen{};  ///< before and after
    optimize::CheapestTolerances tolerances;
    optimize::BuiltOutcome built;  ///< with these tolerances, the fresh seed
    backlash::TurnYield turn{};    ///< the same over a whole turn
  };
  std::optional<Cheapest> cheapest;
};

/// Both designs side by side, and the cheapest tolerances.
std::string robust_table(const optimize::Specification& spec, const RobustRun& run);

/// Member "robust" of summary.json.
io::Json robust_json(const optimize::Specification& spec, const RobustRun& run);

/// Why no design holds as asked for.
std::string robust_blocking_text(const optimize::Specification& spec,
                                 const optimize::RobustResult& search);

}  // namespace gear3k::report
