#pragma once
// SPEC.toml.

#include <string>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "optimize/specification.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::io {

/// Reads a SPEC file.
/// @param most_sets  tooth sets that its ranges may hold, see optimize::estimated_candidates()
/// @throws InvalidInput with every error of the file
optimize::Specification read_specification(const std::string& path,
                                           double most_sets = optimize::kMostRankedSets);
/// The same from a text; `name` stands for the file in messages.
optimize::Specification parse_specification(const std::string& text, const std::string& name,
                                            double most_sets = optimize::kMostRankedSets);

/// The same from a document, whose places the messages name.
optimize::Specification specification_of(const TomlValue& document, const std::string& name,
                                         double most_sets = optimize::kMostRankedSets);

/// Files that [actuator] and [cycle] of a SPEC name, and those that they name.
std::vector<std::string> named_files(const optimize::Specification& spec);

/// A key that a SPEC states.
struct StatedKey {
  StatedValue key;
  /// Whether the SPEC asks for the same without it: it is stated at its default.  Never beside a
  /// preset, which it overrides, nor of tolerances, whose table means something by itself.
  bool usual = false;
};
/// The keys that a SPEC states but its name, in one form whatever its order and the spelling of its
/// values: in the order of docs/keys.md, values as files write them.  What fits no key is left out.
std::vector<StatedKey> stated_keys(const TomlValue& document);

/// What is wrong with keys and values of a part of a SPEC, each by itself; told in `reading`.
void check_keys(const TomlValue& part, FileReading& reading);

/// Table of the keys, in Markdown.
std::string specification_key_table();

}  // namespace gear3k::io
