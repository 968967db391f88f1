#include "io/text/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gear3k::io {

namespace {

constexpr unsigned kFirstOfSeveral = 0x80;  ///< bytes below are characters of their own

/// A character and the number of its bytes; 0 bytes where the text begins with none.
struct Utf8Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
};

Utf8Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < kFirstOfSeveral) return {.code = lead, .bytes = 1};
  struct Form {
    unsigned mask, lead;
    std::uint32_t least;  ///< that needs so many bytes
  };
  constexpr Form kForms[] = {{0xE0, 0xC0, 0x80}, {0xF0, 0xE0, 0x800}, {0xF8, 0xF0, 0x10000}};
  for (std::size_t k = 0; k < std::size(kForms); ++k) {
    const Form& form = kForms[k];
    const std::size_t bytes = k + 2;
    if ((lead & form.mask) != form.lead || text.size() < bytes) continue;
    std::uint32_t code = lead & ~form.mask;
    for (const char c : text.substr(1, bytes - 1)) {
      const auto byte = static_cast<unsigned char>(c);
      if ((byte & 0xC0U) != kFirstOfSeveral) return {};
      code = code << 6U | (byte & 0x3FU);
    }
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < form.least || code > 0x10FFFF || surrogate) return {};
    return {.code = code, .bytes = bytes};
  }
  return {};
}

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
    if (c.bytes == 0) {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    } else if (is_control(c.code)) {
      result += fmt::format("\\u{:04x}", c.code);
    } else {
      result += text.substr(0, c.bytes);
    }
    text.remove_prefix(std::max<std::size_t>(c.bytes, 1));
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
    if (c.bytes == 0) {
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
