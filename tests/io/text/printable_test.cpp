#include "io/text/printable.hpp"

#include <gtest/gtest.h>

#include <string>

namespace gear3k::io::printable_test {
namespace {

std::string fault_of(const std::string& text) {
  const std::optional<Diagnostic> fault = first_unprintable(text);
  return fault ? format_diagnostics("f", {*fault}) : "";
}

TEST(Printable, LeavesTextAsItIs) {
  for (const std::string text :
       {"", "plain ~", "µm, Ω, 齿轮, 🛞", "\xC2\xA0", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_EQ(fault_of(text), "");
  }
  EXPECT_EQ(fault_of("a\tb\r\nc"), "");
}

TEST(Printable, EscapesControlCharactersAsTomlDoes) {
  EXPECT_EQ(printable(std::string("\x1b[2J\n\t\0\x7f", 8)),
            "\\u001b[2J\\u000a\\u0009\\u0000\\u007f");
  EXPECT_EQ(printable("a\xC2\x9B"), "a\\u009b");  // the same command in one character
}

TEST(Printable, LeavesTheEndsOfLinesWhereThereAreLines) {
  EXPECT_EQ(printable_lines("a\x1b\r\nb\n"), "a\\u001b\\u000d\nb\n");
}

TEST(Printable, ShowsBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("caf\xE9"), "caf\\xe9");
  // Overlong, a surrogate, above U+10FFFF, a continuation alone, cut short.
  EXPECT_EQ(printable("\xC0\xAF"), "\\xc0\\xaf");
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(printable("\x80"), "\\x80");
  EXPECT_EQ(printable("\xE2\x82"), "\\xe2\\x82");
}

TEST(Printable, FaultsHaveLineAndColumnInCharacters) {
  EXPECT_EQ(fault_of("one\nä\xE9"), "f:2:2: the byte 0xe9 is no text in UTF-8");
  EXPECT_EQ(fault_of("one\r\n\r\nab\x1b"), "f:3:3: the control character U+001B is no text");
  EXPECT_EQ(fault_of(std::string("a\0b", 3)), "f:1:2: the control character U+0000 is no text");
  EXPECT_EQ(fault_of("\xFF\xFE"
                     "a"),
            "f:1:1: the byte 0xff is no text in UTF-8");
}

}  // namespace
}  // namespace gear3k::io::printable_test
