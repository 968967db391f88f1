#include "io/text/file_reader.hpp"

#include <gtest/gtest.h>

#include <string>

#include "io/files/measurement_file.hpp"
#include "io/text/diagnostics.hpp"
#include "io/text/toml_value.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::io::file_reader_test {
namespace {

using test::Workplace;

constexpr std::size_t kMost = 200'000;

std::string failure_of(const std::string& path) {
  const FileBytes file = read_bytes(path, "a test file", kMost);
  EXPECT_TRUE(file.failure.empty() || file.bytes.empty());
  return file.failure;
}

TEST(FileReader, ReadsEveryByteUpToTheMost) {
  const Workplace place;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{65'536}, kMost}) {
    std::string text(size, 'x');
    if (size > 1) text[size / 2] = '\0';
    place.write("file", text);
    EXPECT_EQ(read_text(place.file("file").string(), "a test file", kMost), text) << size;
  }
  place.write("file", std::string(kMost + 1, 'x'));
  EXPECT_EQ(failure_of(place.file("file").string()),
            "holds more than 200000 bytes, allowed: a test file of at most 200000 bytes");
}

TEST(FileReader, AnEndlessFileIsNotReadOn) {
  EXPECT_NE(failure_of("/dev/zero").find("holds more than 200000 bytes"), std::string::npos);
}

TEST(FileReader, WhatCannotBeOpenedIsNamedWithItsCause) {
  const Workplace place;
  EXPECT_EQ(failure_of(place.file("absent").string()), "cannot be read: No such file or directory");
  EXPECT_EQ(failure_of(place.work().string()), "is a directory, allowed: a test file");
}

TEST(FileReader, AMissingFileIsToldWithTheKeyThatNamesIt) {
  const Workplace place;
  const auto told = [](const auto& read) -> std::string {
    try {
      read();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(told([&] { check_named_file(place.work() / "absent", "gearbox.design", "a.toml"); }),
            "a.toml: gearbox.design: " + (place.work() / "absent").string() +
                ": cannot be read: No such file or directory");
  place.write("there", "x");
  EXPECT_EQ(told([&] { check_named_file(place.work() / "there", "gearbox.design", "a.toml"); }),
            "");
  EXPECT_EQ(
      told([] {
        text_of_named_file(
            [](const std::string& path) -> std::string { throw InvalidInput(path + ": is empty"); },
            "c.csv", "cycles", "s.toml");
      }),
      "s.toml: cycles: c.csv: is empty");
}

// The first page of a process's memory is never there: a file that opens and cannot be read.
TEST(FileReader, AReadThatFailsIsNotTheEndOfTheFile) {
  const std::string path = "/proc/self/mem";
  EXPECT_EQ(failure_of(path), "cannot be read: Input/output error");
  try {
    read_toml(path);
    FAIL() << "read as an empty document";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()), path + ": cannot be read: Input/output error");
  }
  try {
    read_measurements({path});
    FAIL() << "read as an empty file";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()), path + ": cannot be read: Input/output error");
  }
}

}  // namespace
}  // namespace gear3k::io::file_reader_test
