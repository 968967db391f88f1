#include "io/text/toml_limits.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "io/text/toml_value.hpp"

namespace gear3k::io::toml_limits_test {
namespace {

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int k = 0; k < times; ++k) result += text;
  return result;
}

/// "" where it is read.
std::string refusal_of(const std::string& text) {
  try {
    parse_toml(text, "f.toml");
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(TomlLimits, AKeyOfManyPartsIsRefusedWithItsPlaceBeforeItIsParsed) {
  EXPECT_EQ(refusal_of(fmt::format("{}a = 1\n", repeated("a.", kMostKeyParts - 1))), "");
  const std::string message = "a key 17 parts deep, allowed: at most 16";
  EXPECT_EQ(refusal_of(fmt::format("x = 1\n{}a = 1\n", repeated("a.", kMostKeyParts))),
            fmt::format("f.toml:2:32: {}", message));
  EXPECT_EQ(refusal_of(fmt::format("{}a = 1\n", repeated("a.", 40'000))),
            fmt::format("f.toml:1:32: {}", message));
  EXPECT_EQ(refusal_of(fmt::format("[{}a]\n", repeated("\"ä.\" . ", kMostKeyParts))),
            fmt::format("f.toml:1:{}: {}", 1 + 7 * kMostKeyParts - 1, message));
}

TEST(TomlLimits, ListsAndTablesDeepInEachOtherAreRefusedWithTheirPlace) {
  const auto lists = [](int deep) {
    return fmt::format("a = {}{}\n", repeated("[", deep), repeated("]", deep));
  };
  const auto tables = [](int deep) {
    return fmt::format("a = {}1{}\n", repeated("{a=", deep), repeated("}", deep));
  };
  const std::string message = "lists and tables 17 deep, allowed: at most 16";
  EXPECT_EQ(refusal_of(lists(kMostNesting)), "");
  EXPECT_EQ(refusal_of(tables(kMostNesting)), "");
  EXPECT_EQ(refusal_of(lists(kMostNesting + 1)), fmt::format("f.toml:1:21: {}", message));
  EXPECT_EQ(refusal_of(tables(100'000)), fmt::format("f.toml:1:53: {}", message));
}

TEST(TomlLimits, WhatStandsInStringsAndCommentsDoesNotCount) {
  const std::string deep = fmt::format("{}{}", repeated("[", 30), repeated(".", 30));
  for (const char* form :
       {"# {0}\na = 1\n", "a = \"{0}\"\n", "a = '{0}'\n", "a = \"\\\"{0}\"\n",
        "a = '\\'\nb = '{0}'\n", "a = \"\"\"\n\"\"{0}\n\\\"\"\"\"\n",
        "a = '''\n'{0}\n'''''\nb = 1\n", "a = \"\"\nb = '{0}'\n", "\"{0}\" = 1\n"}) {
    const std::string text = fmt::format(fmt::runtime(form), deep);
    EXPECT_EQ(refusal_of(text), "") << text;
  }
}

TEST(TomlLimits, KeysOfManyLinesAreNoDeepKey) {
  EXPECT_EQ(refusal_of(fmt::format("[a.b.c]\n{}", repeated("# .\n", 40))), "");
  EXPECT_EQ(refusal_of(fmt::format("a = [{}]\n", repeated("1.5, ", 40))), "");
  EXPECT_EQ(refusal_of(fmt::format("a = [\n{}]\n", repeated("[1.5],\n", 40))), "");
}

TEST(TomlLimits, AnOpenStringIsLeftToTheParser) {
  for (const char* text : {"a = \"b\n", "a = 'b", "a = \"\"\"b"}) {
    EXPECT_NE(refusal_of(text).find("not valid TOML"), std::string::npos) << text;
  }
}

TEST(TomlLimits, ALongDocumentIsRefused) {
  const std::string comment(kMostTomlBytes, '#');
  EXPECT_EQ(refusal_of(comment), "");
  EXPECT_EQ(refusal_of(comment + "#"), "f.toml: holds 1048577 bytes, allowed: at most 1048576");
}

}  // namespace
}  // namespace gear3k::io::toml_limits_test
