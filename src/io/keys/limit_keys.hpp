#pragma once
// Keys of the checks' limits: the same in DESIGN, PAIR and SPEC, generated from the registry of
// checks.

#include <array>
#include <optional>

#include "design/checks.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// Greatest contact ratio that a file may state.
inline constexpr double kGreatestContactRatio = 10.0;

/// Limits as a file states them; finish_limits() turns them into design::Limits.
struct LimitInput {
  design::Limits limits = design::default_limits();
  std::array<std::optional<bool>, design::kCheckCount> switched;
};

/// The limits in force.  A switch set to false wins over a threshold; a switch set to true on a
/// check that has neither a default nor a stated threshold is an error in `reading`.
design::Limits finish_limits(const LimitInput& input, FileReading& reading);

/// What a file states of these limits.
LimitInput stated_limits(const design::Limits& limits);

/// A pair has no train: its files lack those keys.
std::vector<Key<LimitInput>> limit_keys(bool for_pair);

}  // namespace gear3k::io
