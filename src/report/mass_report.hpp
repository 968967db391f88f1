#pragma once
// Masses and inertias of the parts, as `analyze` prints them.

#include <string>

#include "design/evaluation.hpp"
#include "io/text/json.hpp"

namespace gear3k::report {

/// Table of the parts of which anything is known; nothing when there is none.
std::string mass_table(const design::Evaluation& e);

/// Adds `masses` (every part, null for what is not known) and `total_mass_kg`.
void add_masses(io::Json& json, const design::Evaluation& e);

/// Lines of analysis_csv(): of each part count, mass and inertia, as far as they are known.
std::string mass_csv(const design::Evaluation& e);

}  // namespace gear3k::report
