#pragma once
// What a TOML document may hold at most, so that reading it takes bounded stack and memory.

#include <cstddef>
#include <optional>
#include <string_view>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

constexpr std::size_t kMostTomlBytes = std::size_t{1} << 20U;
constexpr int kMostKeyParts = 16;  ///< of a key or a table's name: a.b.c has three
constexpr int kMostNesting = 16;   ///< of lists and inline tables in each other

/// The first place where a text goes beyond these, found before it is parsed.
///
/// The library descends by recursion: once for each part of a key without a limit of its own
/// (before 3.5, marzer/tomlplusplus pull request 242), and for each list and table 3.3 kB of stack
/// with sanitizers (its issue 292).
std::optional<Diagnostic> beyond_toml_limits(std::string_view text);

}  // namespace gear3k::io
