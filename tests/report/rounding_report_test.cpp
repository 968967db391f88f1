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

TEST(RoundingReport, NamesTheStepOfModulesWhereThatLeavesNothing) {
  optimize::Specification spec{};
  spec.module[0] = {.range_m = optimize::NumberRange{.min = 0.5e-3, .max = 0.65e-3},
                    .series_m = {}};
  spec.module[1] = spec.module[0];
  spec.round.module_m = 0.7e-3;
  optimize::Rounding rounding;
  rounding.complete = true;
  EXPECT_EQ(rounding_blocked_text(spec, rounding),
            "no rounded design meets every check: no module in its range is a multiple of "
            "round.module_mm = 0.7");
  rounding.module_pairs = 4;
  EXPECT_EQ(
      rounding_blocked_text(spec, rounding),
      "no rounded design meets every check: with none of the modules tried in steps of 0.7 mm "
      "(round.module_mm) was a design of these teeth found, whatever the shifts and the centre "
      "distance");
  // The nearest point is far off: no limit that it misses is named.
  rounding.nearest.emplace();
  rounding.nearest->missed = {
      {.name = "form_circle", .violation = 9.0, .amount = 11.05, .unit = "module"}};
  EXPECT_EQ(rounding_blocked_text(spec, rounding).find("form_circle"), std::string::npos);
  rounding.module_pairs_with_design = 1;
  EXPECT_EQ(rounding_blocked_text(spec, rounding),
            "no rounded design meets every check: the nearest misses form_circle by 11.05 module");
}

}  // namespace
}  // namespace gear3k::report::rounding_report_test
