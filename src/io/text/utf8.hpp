#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gear3k::io {

/// What a text begins with: a character, or bytes that are none.
struct Utf8Character {
  std::uint32_t code = 0;  ///< code point, where it is whole
  std::size_t bytes = 1;   ///< of the character, or of the longest beginning of one; at least 1
  bool whole = false;
};

/// UTF-8 as in RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.  Of bytes that
/// are no character, `bytes` are those that one replacement character stands for, as Unicode
/// recommends: the longest beginning of a character, else one byte.
/// Source: The Unicode Standard, table 3-7 (well-formed UTF-8 byte sequences).
/// @param text  not empty
Utf8Character first_character(std::string_view text);

/// Characters of a text, by the bytes that begin one.
/// @param text  UTF-8
std::size_t characters_in(std::string_view text);

}  // namespace gear3k::io
