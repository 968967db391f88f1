#pragma once
// Masses and inertias of the parts, as `analyze` prints them.

#include <string>

#include "design/evaluation.hpp"
#include "report/fields.hpp"

namespace gear3k::report {

/// Table of the parts of which anything is known; nothing when there is none.
std::string mass_table(const design::Evaluation& e);

/// `masses` (every part, null for what is not known) and `total_mass_kg`; rows of what is known.
Fields mass_fields(const design::Evaluation& e);

}  // namespace gear3k::report
