#pragma once
// SPEC.toml.

#include <string>

#include "io/key_registry.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

/// Reads a SPEC file.
/// @throws InvalidInput with every error of the file
optimize::Specification read_specification(const std::string& path);

/// Table of the keys, in Markdown.
std::string specification_key_table();

}  // namespace gear3k::io
