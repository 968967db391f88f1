#pragma once
// DESIGN.toml and PAIR.toml.

#include <string>
#include <variant>

#include "design/design.hpp"
#include "design/evaluation.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// Reads a DESIGN file.
/// @throws InvalidInput with every error of the file
design::Design read_design(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
design::Design parse_design(const std::string& text, const std::string& name);

/// Reads a PAIR file.
design::PairDesign read_pair(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
design::PairDesign parse_pair(const std::string& text, const std::string& name);

/// A DESIGN file that read_design() turns into the same design (numbers in full precision).
std::string design_text(const design::Design& design);

/// Tables of the keys, in Markdown.
std::string design_key_table();
std::string pair_key_table();

}  // namespace gear3k::io
