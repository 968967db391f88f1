#include "io/text/file_set.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <string>
#include <vector>

#include "io/text/diagnostics.hpp"
#include "io/text/held_signals.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::io::file_set_test {
namespace {

using test::Workplace;
using Names = std::vector<std::string>;

std::string failure_of(const std::vector<FileText>& files) {
  try {
    write_files(files, {"input"});
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(FileSet, WritesAllAndReplacesWhatWasThere) {
  const Workplace place;
  place.write("a", "old");
  const std::string a = place.file("a").string();
  const std::string b = place.file("new/deep/b").string();
  EXPECT_EQ(failure_of({{a, "text a"}, {b, "text b"}}), "");
  EXPECT_EQ(place.listing(), (Names{"a", "new", "new/deep", "new/deep/b"}));
  EXPECT_EQ(place.read("a"), "text a");
  EXPECT_EQ(place.read("new/deep/b"), "text b");
}

TEST(FileSet, OneThatCannotBeWrittenLeavesAllAsTheyWere) {
  const Workplace place;
  place.write("a", "old");
  const std::string a = place.file("a").string();
  const std::string b = place.file("new/deep/b").string();
  // A limit on file sizes stands in for a full disk.
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  struct rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = failure_of({{a, "text a"}, {b, std::string(100'000, 'x')}});
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(message, b + ": cannot be written: File too large");
  EXPECT_EQ(place.listing(), Names{"a"});
  EXPECT_EQ(place.read("a"), "old");
}

TEST(FileSet, OneThatCannotHaveItsNameGivesTheOthersTheirOldTextsBack) {
  const Workplace place;
  place.write("a", "old");
  // The folder of the third is made before the second can have the same name.
  const std::string message = failure_of({{place.file("a").string(), "text a"},
                                          {place.file("new").string(), "text new"},
                                          {place.file("x").string(), "text x"},
                                          {place.file("x/b").string(), "text b"}});
  EXPECT_EQ(message, place.file("x").string() + ": cannot be written: Is a directory");
  EXPECT_EQ(place.listing(), Names{"a"});
  EXPECT_EQ(place.read("a"), "old");
}

TEST(FileSet, EveryObstacleIsNamedAtOnce) {
  const Workplace place;
  place.write("file", "");
  std::filesystem::create_directory(place.file("folder"));
  const std::string message = failure_of({{place.file("file/a").string(), ""},
                                          {place.file("folder").string(), ""},
                                          {place.file("new/c").string(), ""}});
  EXPECT_NE(message.find(place.file("file").string() + ": cannot be"), std::string::npos);
  EXPECT_NE(message.find(place.file("folder").string() + ": cannot be written: a folder has"),
            std::string::npos);
  EXPECT_EQ(place.listing(), (Names{"file", "folder"}));
}

volatile std::sig_atomic_t signals_seen = 0;
void see_signal(int) { signals_seen = signals_seen + 1; }

TEST(HeldSignals, WhatComesToOneWithinAnotherWaitsForTheOuterOne) {
  signals_seen = 0;
  const auto before = std::signal(SIGTERM, see_signal);
  {
    const HeldSignals outer;
    std::raise(SIGTERM);
    {
      const HeldSignals inner;
      EXPECT_EQ(signals_seen, 0);
    }
    EXPECT_EQ(signals_seen, 0);
    {
      const HeldSignals inner;
      std::raise(SIGTERM);
    }
    EXPECT_EQ(signals_seen, 0);
  }
  EXPECT_EQ(signals_seen, 1);
  EXPECT_EQ(std::signal(SIGTERM, before), see_signal);
}

}  // namespace
}  // namespace gear3k::io::file_set_test
