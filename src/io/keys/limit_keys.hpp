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

/// Records and assignments on a LimitInput.  A pair has no train: its files lack those keys.
std::vector<Key<LimitInput>> limit_keys(bool for_pair);

/// The same keys for a Target that holds a LimitInput.
template <class Target>
void append_limit_keys(std::vector<Key<Target>>& keys, LimitInput Target::*member, bool for_pair) {
  for (const Key<LimitInput>& key : limit_keys(for_pair)) {
    keys.push_back({.record = key.record,
                    .assign = [assign = key.assign, member](Target& target, std::size_t gear,
                                                            const TomlValue& value) {
                      assign(target.*member, gear, value);
                    }});
  }
}

}  // namespace gear3k::io
