#pragma once
// A gearbox over temperature, as a table and as fields.

#include <optional>
#include <string>
#include <string_view>

#include "design/thermal_result.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// Least backlash, greatest lost motion and the nearest temperatures of a jam, in a line.
std::string thermal_summary(const design::ThermalResult& thermal);

/// "" without a range.
std::string thermal_table(const std::optional<design::ThermalResult>& thermal);

/// Object of the JSON, and rows of the CSV about "S-P1 at 60 C" and its like.
Fields thermal_fields(const design::ThermalResult& thermal);

/// "drawn", "dry" or "wet".
std::string_view moisture_name(train::Moisture moisture);

}  // namespace gear3k::report
