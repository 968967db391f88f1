#pragma once
// Keys of the table [round] of a SPEC: the steps of what is made.

#include <vector>

#include "io/keys/key_registry.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

std::vector<Key<optimize::RoundSteps>> round_keys();

}  // namespace gear3k::io
