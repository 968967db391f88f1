#include "io/text/complaints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace gear3k::io::complaints_test {
namespace {

TEST(Complaints, AreToldInTheOrderOfTheFile) {
  Complaints complaints;
  EXPECT_TRUE(complaints.none());
  complaints.add({.line = 7, .column = 2}, "late");
  complaints.add({.line = 3, .column = 1}, "early");
  EXPECT_FALSE(complaints.none());
  EXPECT_EQ(complaints.text("d.csv"), "d.csv:3:1: early\nd.csv:7:2: late");
}

TEST(Complaints, BeyondTheMostAreCountedButThoseAboutTheWholeFileAreKept) {
  Complaints complaints;
  for (int line = 1; line <= static_cast<int>(Complaints::kMost) + 3; ++line) {
    complaints.add({.line = line, .column = 1}, "wrong");
  }
  complaints.add({}, "too long");
  const std::string text = complaints.text("d.csv");
  EXPECT_TRUE(text.starts_with("d.csv: too long\nd.csv:1:1: wrong\n")) << text;
  EXPECT_TRUE(text.ends_with("d.csv:50:1: wrong\nd.csv: and 3 more")) << text;
  EXPECT_EQ(std::ranges::count(text, '\n'), static_cast<std::ptrdiff_t>(Complaints::kMost) + 1);
}

TEST(Complaints, MessagesThatAreNotKeptAreNotMade) {
  Complaints complaints;
  std::size_t made = 0;
  for (std::size_t k = 0; k < Complaints::kMost + 10; ++k) {
    complaints.add({.line = 1, .column = 1}, [&] {
      ++made;
      return std::string("wrong");
    });
  }
  EXPECT_EQ(made, Complaints::kMost);
  EXPECT_EQ(complaints.count(), Complaints::kMost + 10);
}

}  // namespace
}  // namespace gear3k::io::complaints_test
