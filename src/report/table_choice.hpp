#pragma once
// What of a result a table for the terminal shows.

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace gear3k::report {

/// Parts of the whole table, in its order.
enum class Section {
  kGears,
  kTeeth,
  kMeshes,
  kLosses,
  kStrength,
  kFlanks,
  kPhases,
  kMasses,
  kChecks,
  kTolerances,
  kThermal,
  kBuilt,
  kSensitivities,
  kNotes
};
inline constexpr std::array<std::string_view, 14> kSectionNames{
    "gears",  "teeth",  "meshes",     "losses",  "strength", "flanks",        "phases",
    "masses", "checks", "tolerances", "thermal", "built",    "sensitivities", "notes"};

struct TableChoice {
  bool full = false;              ///< the whole table, else the first screen and `sections`
  std::vector<Section> sections;  ///< in the order of the enum
  int columns = 100;              ///< of the first screen
};

}  // namespace gear3k::report
