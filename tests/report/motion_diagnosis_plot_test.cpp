#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "report/motion_diagnosis_report.hpp"

namespace gear3k::report::motion_diagnosis_plot_test {
namespace {

/// As many windows, whose flows and senses follow each other in fours.
MotionDiagnosisResult in_fours(int count) {
  MotionDiagnosisResult result;
  result.subject = "knee";
  for (int k = 0; k < count; ++k) {
    result.diagnosis.rows.push_back({.term = {0.1 * k, 1.0, 1.0, 2.0, 1.0},
                                     .motor_Nm = 3.0,
                                     .flow = k % 4 < 2 ? 1 : -1,
                                     .sense = k % 2 == 0 ? 1 : -1});
    result.diagnosis.baseline.push_back(0.5);
    result.diagnosis.extended.push_back(0.1);
  }
  return result;
}

// More windows than are drawn are thinned: of each kind by itself.
TEST(MotionDiagnosisPlots, ThinnedWindowsAreOfAllFlowsAndSenses) {
  const auto plots = motion_diagnosis_plots(in_fours(16000));
  ASSERT_EQ(plots.size(), 2U);
  constexpr std::array<const char*, 4> kKinds{"flow forward, +", "flow forward, -",
                                              "flow backward, +", "flow backward, -"};
  for (const Plot& plot : plots) {
    for (const char* kind : kKinds) EXPECT_NE(plot.script.find(kind), std::string::npos) << kind;
    // Two panels of at most 4000 points and some lines more.
    const auto lines = std::ranges::count(plot.script, '\n');
    EXPECT_GT(lines, 6000) << plot.name;
    EXPECT_LT(lines, 8100) << plot.name;
  }
}

}  // namespace
}  // namespace gear3k::report::motion_diagnosis_plot_test
