#pragma once

#include <string>
#include <vector>

#include "train/tooth_set.hpp"

namespace gear3k::report {

/// "S/P1/R1/P2/R2" of tooth counts.
std::string teeth_text(const train::ToothSet& z);

/// The five tooth counts as fields of a table, in the order of teeth_text().
std::vector<std::string> teeth_fields(const train::ToothSet& z);

}  // namespace gear3k::report
