// Campaigns of the rig with hidden causes: found, and nothing found where there is nothing.  A
// small fixed set of what benchmarks/diagnosis_rates measures over many seeds.

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <string>
#include <vector>

#include "numerics/parallel.hpp"
#include "tests/calibrate/diagnosis_scoring.hpp"
#include "tests/sample.hpp"

namespace gear3k::rig::diagnosis_test {
namespace {

/// Campaigns of a scenario of a group, whose rates are held over all of its scenarios together.  Of
/// 26 cases at 95 % fewer than 20 are right once in 1000 runs, at 62 % fewer than 8.
const int group_seeds = sample(1, 16);

/// Greatest k with P(X < k) < chance and least with P(X > k) < chance, X of n cases at a true rate.
int least_of(int cases, double rate, double chance = 0.001) {
  const boost::math::binomial law(cases, rate);
  int k = 0;
  while (k < cases && cdf(law, k) < chance) ++k;
  return k;
}
int most_of(int cases, double rate, double chance = 0.001) {
  const boost::math::binomial law(cases, rate);
  int k = 0;
  while (k < cases && cdf(complement(law, k)) >= chance) ++k;
  return k;
}

/// Least number of right answers and most wrong names among the seeds of one scenario: a guard
/// against what breaks one altogether, by rates that each scenario keeps.  Of four seeds at a true
/// rate of 60 % none is right in 3 % of cases; rates are held by the groups of scenarios below.
struct Bound {
  int right, wrong;
};
Bound bound_of(const std::string& name, int cases) {
  constexpr double kOneOfManyScenarios = 0.01;
  double right = 0.95;
  if (name.starts_with("alone 0.3")) right = 0.6;
  if (name.starts_with("resolved")) right = 0.7;
  if (name.starts_with("pair ") || name.starts_with("triple")) right = 0.9;
  return {.right = least_of(cases, right, kOneOfManyScenarios),
          .wrong = most_of(cases, 0.05, kOneOfManyScenarios)};
}

/// Campaigns of a scenario by itself.  Two of three right at a rate of 95 % are as hard to miss by
/// chance as two of four at 90 % and one of four at 70 %.
int seeds_of(const std::string& name) {
  constexpr int kFew = 3;
  return sample(bound_of(name, kFew).right > 1 ? kFew : kFew + 1, 16);
}

/// Answers to the campaigns of a scenario, which have to keep its bound.
std::vector<Score> scores_of(const Scenario& scenario, std::uint64_t first_seed, int cases) {
  std::vector<Score> scores(static_cast<std::size_t>(cases));
  numerics::parallel_for(scores.size(), [&](std::size_t k) {
    scores[k] = score(scenario, static_cast<std::uint64_t>(k) + first_seed);
  });
  const Bound bound = bound_of(scenario.name, cases);
  std::string answers = scenario.name + "\n";
  for (const Score& s : scores) answers += s.answer + "\n";
  EXPECT_GE(std::ranges::count(scores, true, &Score::right), bound.right) << answers;
  EXPECT_LE(std::ranges::count(scores, true, &Score::wrong), bound.wrong) << answers;
  return scores;
}

/// Groups whose rates are held below, and with them the bound of each of their scenarios.
bool in_group(const Scenario& scenario) {
  const std::string& name = scenario.name;
  return name.starts_with("alone ") || name.starts_with("null ");
}

class Campaign : public testing::TestWithParam<Scenario> {};

TEST_P(Campaign, IsToldAsItIs) { scores_of(GetParam(), 1, seeds_of(GetParam().name)); }

std::vector<Scenario> scenarios_without_group() {
  std::vector<Scenario> list = scenarios();
  std::erase_if(list, in_group);
  return list;
}

std::string test_name(const testing::TestParamInfo<Scenario>& info) {
  std::string name = info.param.name;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Rig, Campaign, testing::ValuesIn(scenarios_without_group()), test_name);

/// Answers to every scenario of a group, each with seeds of its own: one seed gives the same noise
/// whatever is hidden in it, and only different noise makes the cases independent.
struct Count {
  int cases = 0, right = 0, wrong = 0, intervals = 0, inside = 0, doubtful = 0, hidden_doubts = 0;
};
Count count_of(const std::string& group) {
  Count count;
  std::uint64_t first_seed = 101;
  for (const Scenario& scenario : scenarios()) {
    if (!scenario.name.starts_with(group)) continue;
    const std::vector<Score> scores = scores_of(scenario, first_seed, group_seeds);
    first_seed += static_cast<std::uint64_t>(group_seeds);
    for (const Score& s : scores) {
      ++count.cases;
      count.right += s.right ? 1 : 0;
      count.wrong += s.wrong ? 1 : 0;
      count.intervals += s.has_interval ? 1 : 0;
      count.inside += s.has_interval && s.inside ? 1 : 0;
      count.doubtful += s.doubtful ? 1 : 0;
      count.hidden_doubts += s.hides_doubt ? 1 : 0;
    }
  }
  return count;
}

/// Wrong names stay under 5 % in every group.
constexpr double kMostWrong = 0.05;

TEST(Bounds, AreThoseOfTheBinomialLaw) {
  // P(X < 1) = 0.3^8 = 6.6e-5 and P(X < 2) = 1.3e-3 of eight at 70 %; P(X > 3) = 4e-4, P(X > 2) =
  // 6e-3 at 5 %.
  EXPECT_EQ(least_of(8, 0.7), 1);
  EXPECT_EQ(most_of(8, 0.05), 3);
}

// Each cause by itself, as large as the noise: right in 95 %.  Where the parameter is one that
// library and rig define alike, its interval holds the truth about as often as it says.
TEST(Group, OfCausesAsLargeAsTheNoiseIsNamed) {
  const Count count = count_of("alone 1 ");
  ASSERT_GT(count.cases, 25 * group_seeds);
  EXPECT_GE(count.right, least_of(count.cases, 0.95));
  EXPECT_LE(count.wrong, most_of(count.cases, kMostWrong));
  ASSERT_GT(count.intervals, 13 * group_seeds);
  EXPECT_GE(count.inside, least_of(count.intervals, 0.93));
  // Of the few of the usual run all are inside in every other one.
  if (long_samples()) {
    EXPECT_LT(count.inside, count.intervals);
  }
}

// At 0.3 of the noise the table in docs/accuracy.md has 62 % right on average over the scenarios.
TEST(Group, OfCausesOfAThirdOfTheNoiseIsNamedMoreOftenThanNot) {
  const Count count = count_of("alone 0.3 ");
  ASSERT_GT(count.cases, 25 * group_seeds);
  EXPECT_GE(count.right, least_of(count.cases, 0.62));
  EXPECT_LE(count.wrong, most_of(count.cases, kMostWrong));
  // What is likelier to be chance is never `explained`, and the next experiment asks about it.
  EXPECT_GT(count.doubtful, 0);
  EXPECT_EQ(count.hidden_doubts, 0);
}

// Where nothing is wrong, something is found in 5 %.
TEST(Group, OfFaultlessSimulationsHasNothingFound) {
  const Count count = count_of("null ");
  ASSERT_GT(count.cases, 20 * group_seeds);
  EXPECT_GE(count.right, least_of(count.cases, 0.95));
  EXPECT_LE(count.wrong, most_of(count.cases, kMostWrong));
}

}  // namespace
}  // namespace gear3k::rig::diagnosis_test
