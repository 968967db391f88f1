#pragma once
// Minimum, drawn value and maximum of a gearbox built within its tolerances.

#include <optional>
#include <string>

#include "design/tolerance_limits.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// Table "Limits of the built gearbox"; "" without tolerances.
std::string tolerance_table(const std::optional<design::ToleranceLimits>& limits);

/// "tolerances" of docs/interface.md; rows "built <quantity> min | nominal | max".
Fields tolerance_fields(const design::ToleranceLimits& limits);

}  // namespace gear3k::report
