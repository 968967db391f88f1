#pragma once
// Minimum, drawn value and maximum of a gearbox built within its tolerances.

#include <optional>
#include <string>

#include "design/tolerance_limits.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// Table "Limits of the built gearbox"; "" without tolerances.
std::string tolerance_table(const std::optional<design::ToleranceLimits>& limits);

/// Adds "tolerances" by the contract of docs/interface.md; nothing without them.
void add_tolerances(io::Json& json, const std::optional<design::ToleranceLimits>& limits);

/// Rows "built <quantity> min | nominal | max" under the header of analysis_csv(); "" without
/// tolerances.
std::string tolerance_csv(const std::optional<design::ToleranceLimits>& limits);

}  // namespace gear3k::report
