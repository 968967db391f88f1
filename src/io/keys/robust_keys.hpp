#pragma once
// Keys of the table [robust] of a SPEC: what the limits have to hold for.

#include <vector>

#include "io/keys/key_registry.hpp"
#include "io/keys/tolerance_keys.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

std::vector<Key<optimize::Robust>> robust_keys();

/// What [robust], [tolerances] and the limits say together.  Accuracy grades are refused: their
/// deviations depend on sizes that the search chooses.
void check_robust(const optimize::Specification& spec, const ToleranceInput& tolerances,
                  FileReading& reading);

}  // namespace gear3k::io
