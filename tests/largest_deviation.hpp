#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace gear3k {

/// Largest deviation over a test's random cases, as a share of what is allowed.  It is recorded in
/// the test's XML output, from which tools/accuracy.sh prints its part of docs/accuracy.md.
struct LargestDeviation {
  double share = 0.0;
  int at_case = -1;
  long seen = 0;

  void see(int number, double deviation, double allowed) {
    ++seen;
    const double s = std::abs(deviation) / allowed;
    if (s <= share) return;
    share = std::isnan(s) ? std::numeric_limits<double>::infinity() : s;
    at_case = number;
  }
  void expect_allowed(const std::string& what) const {
    EXPECT_GT(seen, 0) << what << ": no case was compared";
    EXPECT_LE(share, 1.0) << what << ", case " << at_case;
    ::testing::Test::RecordProperty(what + "_share_of_tolerance", fmt::format("{:.3g}", share));
  }
};

}  // namespace gear3k
