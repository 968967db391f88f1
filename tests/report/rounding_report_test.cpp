#include "report/rounding_report.hpp"

#include <gtest/gtest.h>

namespace gear3k::report::rounding_report_test {
namespace {

TEST(RoundingReport, OfASearchThatWasCutShortClaimsNoMoreThanIsKnown) {
  const optimize::Specification spec{};
  optimize::Rounding rounding;
  rounding.complete = true;
  EXPECT_EQ(rounding_blocked_text(spec, rounding), "no rounded design meets every check");
  rounding.complete = false;
  EXPECT_EQ(rounding_blocked_text(spec, rounding),
            "no rounded design that meets every check was found; the search was cut short, there "
            "may be one");
}

}  // namespace
}  // namespace gear3k::report::rounding_report_test
