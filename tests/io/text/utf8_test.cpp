#include "io/text/utf8.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace gear3k::io {
namespace {

/// Bits of a code point laid out as RFC 3629, section 3, has them; for any number, and any length
/// that holds it: overlong forms and surrogates too.
std::string encoded(std::uint32_t code, std::size_t bytes) {
  if (bytes == 1) return {static_cast<char>(code)};
  std::string text(bytes, ' ');
  for (std::size_t k = bytes; k-- > 1; code >>= 6U) text[k] = static_cast<char>(0x80U | code % 64);
  text[0] = static_cast<char>((0xF00U >> bytes) % 256 | code);
  return text;
}

constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000, 0x200000};

TEST(Utf8, EveryCodePointIsReadBackAndNoOther) {
  std::size_t wrong = 0;
  for (std::size_t bytes = 1; bytes <= 4; ++bytes) {
    // Of two million in four bytes every 31st, the last character among them.
    const std::uint32_t step = bytes < 4 ? 1 : 31;
    for (std::uint32_t code = bytes < 4 ? 0 : 0x10FFFF % step; code < kLeast[bytes + 1];
         code += step) {
      const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
      const bool character = code >= kLeast[bytes] && code <= 0x10FFFF && !surrogate;
      const Utf8Character read = first_character(encoded(code, bytes) + "x");
      const bool right = character ? read.whole && read.code == code && read.bytes == bytes
                                   : !read.whole && read.bytes >= 1 && read.bytes < bytes;
      if (!right) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0U);
}

/// The Unicode Standard, tables 3-8 to 3-11: what one replacement character stands for.
TEST(Utf8, BytesThatAreNoCharacterAreTakenAsUnicodeRecommends) {
  struct Row {
    std::string text;
    std::string lengths;
  };
  const Row rows[] = {{"\xC0\xAF\xE0\x80\xBF\xF0\x81\x82\x41", "111111111"},
                      {"\xED\xA0\x80\xED\xBF\xBF\xED\xAF\x41", "111111111"},
                      {"\xF4\x91\x92\x93\xFF\x41\x80\xBF\x42", "111111111"},
                      {"\xE1\x80\xE2\xF0\x91\x92\xF1\xBF\x41", "21321"}};
  for (const Row& row : rows) {
    std::string_view rest = row.text;
    std::string lengths;
    while (!rest.empty()) {
      const std::size_t bytes = first_character(rest).bytes;
      lengths += static_cast<char>('0' + bytes);
      rest.remove_prefix(bytes);
    }
    EXPECT_EQ(lengths, row.lengths);
  }
}

TEST(Utf8, CharactersOfATextAreCountedWhateverTheirBytes) {
  std::string text = "R1 ";
  for (std::size_t bytes = 1; bytes <= 4; ++bytes) {
    // Code points of this many bytes: the first of them, from "A" on.
    const std::string one = encoded(std::max<std::uint32_t>(kLeast[bytes], 'A'), bytes);
    ASSERT_EQ(one.size(), bytes);
    text += one + one;
  }
  EXPECT_EQ(characters_in(text), 11U);
  EXPECT_EQ(characters_in(""), 0U);
}

}  // namespace
}  // namespace gear3k::io
