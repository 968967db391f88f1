#pragma once
// Minimum, drawn value and maximum of a gearbox built within its tolerances.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "design/tolerance_limits.hpp"

namespace gear3k::report {

/// Table "Limits of the built gearbox"; "" without tolerances.
std::string tolerance_table(const std::optional<design::ToleranceLimits>& limits);

/// Adds "tolerances" by the contract of docs/interface.md; nothing without them.
void add_tolerances(nlohmann::ordered_json& json,
                    const std::optional<design::ToleranceLimits>& limits);

/// Rows "built <quantity> min | nominal | max" under the header of analysis_csv(); "" without
/// tolerances.
std::string tolerance_csv(const std::optional<design::ToleranceLimits>& limits);

}  // namespace gear3k::report
