#pragma once
// Every form of a law at a grid of its parameters.

#include <vector>

#include "calibrate/laws/law_data.hpp"

namespace gear3k::calibrate {

/// The best trial of every form: of one condition, of two, and waves and pulses at the orders where
/// the residual has most power.  Linear in amplitude and offset, beside the hypothesis' own
/// columns; LawTrial::gain is the sum of squares that it takes off [whitened].
std::vector<LawTrial> scan_forms(const LawData& data);

}  // namespace gear3k::calibrate
