#include "io/text/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "io/text/utf8.hpp"

namespace gear3k::io {

namespace {

bool is_control(std::uint32_t code) { return code < 0x20 || (code >= 0x7F && code <= 0x9F); }

/// Bytes from 0x20 to 0x7E, of which there are many, need no look at what follows.
bool is_plain(char c) { return c >= 0x20 && c < 0x7F; }

std::string escaped(std::string_view text, bool lines) {
  if (std::ranges::all_of(text, is_plain)) return std::string(text);
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    if (is_plain(text.front()) || (lines && text.front() == '\n')) {
      result += text.front();
      text.remove_prefix(1);
      continue;
    }
    const Utf8Character c = first_character(text);
    if (!c.whole) {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    } else if (is_control(c.code)) {
      result += fmt::format("\\u{:04x}", c.code);
    } else {
      result += text.substr(0, c.bytes);
    }
    text.remove_prefix(c.whole ? c.bytes : 1);
  }
  return result;
}

}  // namespace

std::optional<Diagnostic> first_unprintable(std::string_view text) {
  Position position{.line = 1, .column = 1};
  while (!text.empty()) {
    if (is_plain(text.front())) {
      ++position.column;
      text.remove_prefix(1);
      continue;
    }
    const Utf8Character c = first_character(text);
    if (!c.whole) {
      return Diagnostic{.position = position,
                        .message = fmt::format("the byte {:#04x} is no text in UTF-8",
                                               static_cast<unsigned char>(text.front()))};
    }
    if (c.code == '\n') {
      ++position.line;
      position.column = 0;
    } else if (c.code != '\t' && c.code != '\r' && is_control(c.code)) {
      return Diagnostic{
          .position = position,
          .message = fmt::format("the control character U+{:04X} is no text", c.code)};
    }
    ++position.column;
    text.remove_prefix(c.bytes);
  }
  return std::nullopt;
}

std::string printable(std::string_view text) { return escaped(text, false); }

std::string printable_lines(std::string_view text) { return escaped(text, true); }

}  // namespace gear3k::io
