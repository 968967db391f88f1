#pragma once
// Campaigns of the rig put before `diagnose`, and whether its answer is right.

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "calibrate/verdict/diagnosis.hpp"
#include "tests/rig/rig.hpp"

namespace gear3k::rig {

/// What counts as right.
enum class Expectation {
  kNothing,      ///< verdict no_discrepancy
  kNamed,        ///< every hidden cause named, itself or among the alternatives; nothing else
  kAliases,      ///< as kNamed, and every cause of `aliases` in one effect's list
  kUnexplained,  ///< unexplained, or a significant remainder
  kResolved      ///< as kAliases; then the proposed experiment leaves the true cause alone
};

struct Scenario {
  std::string name;
  Plan plan;
  std::vector<HiddenCause> causes;
  Expectation expectation = Expectation::kNamed;
  std::vector<std::string> aliases = {};
};
// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest looks for this name
inline void PrintTo(const Scenario& scenario, std::ostream* out) { *out << scenario.name; }

struct Score {
  bool right = false;
  bool wrong = false;         ///< something named that was not hidden
  double explanations = 0.0;  ///< mean number of causes that an effect may be; 0: no effect
  bool has_interval = false, inside = false;  ///< of the first hidden cause's parameter
  /// An effect that is likelier to have no cause of the library, and a verdict that hides it.
  bool doubtful = false, hides_doubt = false;
  std::string answer;
};

std::vector<Scenario> scenarios();

/// Diagnoses a campaign of a scenario.
calibrate::Diagnosis diagnose_campaign(const Scenario& scenario, std::uint64_t seed);

Score score(const Scenario& scenario, std::uint64_t seed);

}  // namespace gear3k::rig
