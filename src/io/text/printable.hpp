#pragma once
// Texts of users that go to terminals: an escape character in a name is a command to them.

#include <optional>
#include <string>
#include <string_view>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

/// The first byte of a text that is no UTF-8, or its first control character but tab and the ends
/// of lines; columns count characters.
///
/// UTF-8 as in RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.  Control
/// characters: U+0000 to U+001F, U+007F to U+009F.
std::optional<Diagnostic> first_unprintable(std::string_view text);

/// With every control character, tabs and ends of lines too, and every byte that is no UTF-8 as
/// TOML escapes a character: \u001b, of such a byte \xff.
std::string printable(std::string_view text);

/// The same of a text of lines, whose ends stay.
std::string printable_lines(std::string_view text);

}  // namespace gear3k::io
