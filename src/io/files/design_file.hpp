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

/// A DESIGN file that read_design() turns into as_written(design): each number with the fewest
/// digits that read back as it is.
std::string design_text(const design::Design& design);
/// The design as its file is read: the same, but for lengths and angles that no number in the key's
/// unit reads back as (units::decimal_from_si), one last bit off.
/// @throws InvalidInput when a value is out of its key's range
design::Design as_written(const design::Design& design);

/// Tables of the keys, in Markdown.
std::string design_key_table();
std::string pair_key_table();

}  // namespace gear3k::io
