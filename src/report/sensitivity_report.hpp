#pragma once
// Sensitivities of a gearbox, as `analyze` prints them.

#include <string>

#include "design/sensitivity.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// Change of the efficiencies and the lost motion per step of each input, the most effective on η_b
/// first, and the three strongest inputs of each of the tightest checks; nothing without inputs.
std::string sensitivity_table(const design::Sensitivities& s);

/// Adds `sensitivities`, derivatives per unit of the file, and `tightest_checks`.
void add_sensitivities(io::Json& json, const design::Sensitivities& s);

/// Lines of analysis_csv(): of each input its derivatives as far as they are defined.
std::string sensitivity_csv(const design::Sensitivities& s);

}  // namespace gear3k::report
