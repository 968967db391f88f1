// What follows of a set for narrower limits, by hand.

#include "optimize/set_answers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace gear3k::optimize::set_answers_test {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

Candidate candidate(int sun) {
  return {.teeth = {.S = sun, .P1 = 30, .R1 = 72, .P2 = 28, .R2 = 70}, .planets = 3};
}

RefinedSet design(int sun, double eta_b, double lost_motion_rad) {
  RefinedSet set;
  set.candidate = candidate(sun);
  set.status = Status::kOptimal;
  set.eta_b = eta_b;
  set.lost_motion_rad = lost_motion_rad;
  return set;
}

/// Costs are those of efficiency, its negative, and of lost motion.
class Answers : public testing::Test {
 protected:
  Specification spec_;
  SetAnswers answers_{
      spec_,
      {.each = {Objective::kBackwardEfficiency, Objective::kLostMotion}, .slack = {1e-6, 1e-7}}};
};

TEST_F(Answers, ADesignThatKeepsNarrowerLimitsIsTheBestWithinThem) {
  const RefinedSet best = design(12, 0.9, 1e-3);
  answers_.keep({.first = 0, .limits = {kAny, 3e-3}}, {&best, 1});
  const auto known = answers_.answer({.first = 0, .limits = {kAny, 2e-3}}, candidate(12));
  ASSERT_TRUE(known);
  EXPECT_EQ(known->eta_b, 0.9);
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {kAny, 0.5e-3}}, candidate(12)))
      << "it does not keep them: another design may";
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {kAny, 4e-3}}, candidate(12)))
      << "wider limits may have a better one";
  EXPECT_FALSE(answers_.answer({.first = 1, .limits = {kAny, 2e-3}}, candidate(12)));
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {kAny, 2e-3}}, candidate(13)));
}

TEST_F(Answers, WhereALeastCostIsAboveWhatIsAllowedThereIsNone) {
  const RefinedSet least = design(12, 0.5, 1e-3);
  answers_.keep({.first = 1, .limits = {kAny, kAny}}, {&least, 1});
  const auto none = answers_.answer({.first = 0, .limits = {kAny, 0.9e-3}}, candidate(12));
  ASSERT_TRUE(none);
  EXPECT_EQ(none->status, Status::kNoFeasibleFound);
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {kAny, 1e-3 - 0.5e-7}}, candidate(12)))
      << "within the slack it is not told";
}

TEST_F(Answers, ASetWithoutADesignHasNoneWithinNarrowerLimits) {
  RefinedSet none;
  none.candidate = candidate(12);
  none.status = Status::kNoFeasibleFound;
  answers_.keep({.first = 1, .limits = {-0.8, kAny}}, {&none, 1});
  const auto known = answers_.answer({.first = 0, .limits = {-0.85, 1e-3}}, candidate(12));
  ASSERT_TRUE(known);
  EXPECT_EQ(known->status, Status::kNoFeasibleFound);
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {-0.7, 1e-3}}, candidate(12)));
  RefinedSet failed = none;
  failed.candidate = candidate(13);
  failed.status = Status::kFailed;
  answers_.keep({.first = 1, .limits = {-0.8, kAny}}, {&failed, 1});
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {-0.85, 1e-3}}, candidate(13)));
}

TEST_F(Answers, ADesignThatIsNoOptimumAnswersNothingButIsADesign) {
  RefinedSet beside = design(12, 0.9, 1e-3);
  beside.status = Status::kNotStationary;
  answers_.keep({.first = 0, .limits = {kAny, kAny}}, {&beside, 1});
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {kAny, 2e-3}}, candidate(12)));
  EXPECT_FALSE(answers_.answer({.first = 0, .limits = {-0.95, kAny}}, candidate(12)))
      << "a better one may be beside it";
  EXPECT_EQ(answers_.least_cost({.first = 0, .limits = {kAny, 2e-3}}, candidate(12)), -kInfinity);
  EXPECT_EQ(answers_.best_within({.first = 0, .limits = {kAny, 2e-3}})->eta_b, 0.9);
}

TEST_F(Answers, AGridThatWasCutShortProvesNothingButItsDesignCounts) {
  RefinedSet part = design(12, 0.9, 1e-3), none = part;
  none.candidate = candidate(13);
  none.status = Status::kNoFeasibleFound;
  part.grid_cut = none.grid_cut = true;
  answers_.keep({.first = 0, .limits = {kAny, kAny}}, std::array{part, none});
  for (const int sun : {12, 13}) {
    EXPECT_FALSE(answers_.answer({.first = 0, .limits = {kAny, 2e-3}}, candidate(sun))) << sun;
    EXPECT_FALSE(answers_.answer({.first = 1, .limits = {-0.95, kAny}}, candidate(sun))) << sun;
    EXPECT_EQ(answers_.least_cost({.first = 0, .limits = {kAny, 2e-3}}, candidate(sun)),
              -kInfinity);
  }
  const auto best = answers_.best_within({.first = 0, .limits = {kAny, 2e-3}});
  ASSERT_TRUE(best);
  EXPECT_EQ(best->candidate, candidate(12));
}

TEST_F(Answers, TheBestWithinLimitsIsThatOfAnySetAndSearch) {
  EXPECT_FALSE(answers_.best_within({.first = 0, .limits = {kAny, kAny}}));
  const std::array<RefinedSet, 3> sets{design(12, 0.9, 3e-3), design(13, 0.8, 1e-3),
                                       design(14, 0.85, 2e-3)};
  answers_.take({.first = 1, .limits = {kAny, kAny}}, sets);
  EXPECT_EQ(answers_.best_within({.first = 0, .limits = {kAny, kAny}})->eta_b, 0.9);
  EXPECT_EQ(answers_.best_within({.first = 0, .limits = {kAny, 2.5e-3}})->eta_b, 0.85);
  EXPECT_FALSE(answers_.best_within({.first = 0, .limits = {kAny, 0.5e-3}}));
}

}  // namespace
}  // namespace gear3k::optimize::set_answers_test
