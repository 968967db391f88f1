#pragma once
// SPEC.toml.

#include <string>

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

/// Table of the keys, in Markdown.
std::string specification_key_table();

}  // namespace gear3k::io
