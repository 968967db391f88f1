#include "io/text/utf8.hpp"

#include <algorithm>

namespace gear3k::io {

namespace {

/// Bytes that may follow the first one of a character, the first of them within its own range.
struct Continuation {
  std::size_t count;
  unsigned char low, high;
};

Continuation continuation_of(unsigned char first) {
  if (first >= 0xC2 && first <= 0xDF) return {.count = 1, .low = 0x80, .high = 0xBF};
  if (first == 0xE0) return {.count = 2, .low = 0xA0, .high = 0xBF};
  if (first == 0xED) return {.count = 2, .low = 0x80, .high = 0x9F};
  if (first >= 0xE1 && first <= 0xEF) return {.count = 2, .low = 0x80, .high = 0xBF};
  if (first == 0xF0) return {.count = 3, .low = 0x90, .high = 0xBF};
  if (first >= 0xF1 && first <= 0xF3) return {.count = 3, .low = 0x80, .high = 0xBF};
  if (first == 0xF4) return {.count = 3, .low = 0x80, .high = 0x8F};
  return {.count = 0, .low = 0, .high = 0};
}

}  // namespace

Utf8Character first_character(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  if (first < 0x80) return {.code = first, .bytes = 1, .whole = true};
  Continuation next = continuation_of(first);
  const std::size_t wanted = 1 + next.count;
  // The first byte holds six bits less one for each that follows, the others six.
  Utf8Character character{.code = first & (0x3FU >> next.count), .bytes = 1, .whole = false};
  for (; character.bytes < wanted && character.bytes < text.size(); ++character.bytes) {
    const auto byte = static_cast<unsigned char>(text[character.bytes]);
    if (byte < next.low || byte > next.high) break;
    character.code = character.code << 6U | (byte & 0x3FU);
    next.low = 0x80;
    next.high = 0xBF;
  }
  character.whole = next.count > 0 && character.bytes == wanted;
  return character;
}

std::size_t characters_in(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace gear3k::io
