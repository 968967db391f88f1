#pragma once
// What `reproduce` prints of the backdrivability-factors paper.

#include <string>

#include "io/text/json.hpp"
#include "papers/backdrivability.hpp"

namespace gear3k::papers {

std::string backdrivability_table(const BackdrivabilityComparison& c);
io::Json backdrivability_json(const BackdrivabilityComparison& c);
/// Lines of reproduce_csv(): gearbox "backdrivability-factors paper", the ledger under
/// "backdrivability ledger N"; exponents of the laws have the fit as measured.
std::string backdrivability_csv(const BackdrivabilityComparison& c);

}  // namespace gear3k::papers
