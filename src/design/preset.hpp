#pragma once
// Limits that a workshop would state, as named sets.

#include <array>
#include <optional>
#include <span>

#include "design/checks.hpp"

namespace gear3k::design {

/// What a preset makes of one check; Preset::kBare leaves it as its record has it.
struct PresetLimit {
  CheckId check{};
  double machined = 0.0, printed = 0.0;  ///< in the unit of the check's record
};

/// Every limit that presets set, in the order of the registry.
///
/// Source: of each value in docs/interface.md, "Presets": what was read, or our choice with its
/// reason.
std::span<const PresetLimit> preset_limits();

/// The limit of a check by a preset [SI]; empty where the preset does not set it.
std::optional<double> preset_limit(Preset preset, CheckId check);

}  // namespace gear3k::design
