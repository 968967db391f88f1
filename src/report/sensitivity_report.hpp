#pragma once
// Sensitivities of a gearbox, as `analyze` prints them.

#include <string>

#include "design/sensitivity.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// Change of the efficiencies and the lost motion per step of each input, the most effective on η_b
/// first, and the three strongest inputs of each of the tightest checks; nothing without inputs.
std::string sensitivity_table(const design::Sensitivities& s);

/// `sensitivities`, derivatives per unit of the file, and `tightest_checks`; rows of each input's
/// derivatives as far as they are defined.
Fields sensitivity_fields(const design::Sensitivities& s);

}  // namespace gear3k::report
