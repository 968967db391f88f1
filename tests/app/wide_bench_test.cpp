// `diagnose` on campaigns of the wide rig, whose laws, noise and plans are not those of the
// library: a small fixed set of what benchmarks/wide_rates measures.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "numerics/parallel.hpp"
#include "tests/app/wide_scoring.hpp"
#include "tests/sample.hpp"

namespace gear3k::wide_rig::wide_bench_test {
namespace {

/// Seeds that nothing was tuned on.
constexpr std::uint64_t kFirstSeed = 101;
const auto kSeeds = sample<std::size_t>(2, 4);
constexpr double kStrength = 4.0;

struct Group {
  std::string name;
  std::vector<std::string> lines;
  int least, least_of_long;  ///< of right answers, with 2 and with 4 seeds
};
// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest looks for this name
void PrintTo(const Group& group, std::ostream* out) { *out << group.name; }

class WideBench : public testing::TestWithParam<Group> {};

TEST_P(WideBench, IsToldAsItIs) {
  std::vector<Line> chosen;
  for (const Line& line : lines()) {
    if (std::ranges::count(GetParam().lines, line.name) == 1) chosen.push_back(line);
  }
  ASSERT_EQ(chosen.size(), GetParam().lines.size());
  std::vector<Score> scores(chosen.size() * kSeeds);
  numerics::parallel_for(scores.size(), [&](std::size_t k) {
    scores[k] = score(make_campaign(chosen[k / kSeeds], kStrength, kFirstSeed + k % kSeeds));
  });
  std::string answers;
  for (std::size_t k = 0; k < scores.size(); ++k) {
    answers += chosen[k / kSeeds].name + ": " + scores[k].answer + '\n';
  }
  EXPECT_GE(std::ranges::count(scores, true, &Score::right),
            sample(GetParam().least, GetParam().least_of_long))
      << answers;
}

// Of n answers right at a true rate of 93 % the binomial law leaves fewer than these in less than
// about one case of a thousand (8: P(X < 5) = 1.3e-3, 10: P(X < 6) = 3e-4, 16: P(X < 11) = 4e-4,
// 20: P(X < 14) = 2e-4); where the changes act elsewhere than on the reading as a whole, or a law
// is not one of the library, less is found by chance alone.
INSTANTIATE_TEST_SUITE_P(
    Rig, WideBench,
    testing::Values(Group{"Targets",
                          {"drift on friction", "drift on gain", "gain steps", "friction steps"},
                          5,
                          11},
                    Group{"LostMotion",
                          {"steps of all sessions in lost motion", "first-order wave on one turn",
                           "single lost_motion compliance hertz_power",
                           "single lost_motion runout with_harmonics"},
                          5,
                          11},
                    Group{"FreeShapes",
                          {"single friction_load saturating", "single friction_speed mixed_film",
                           "single friction_speed eyring", "single friction_temperature vogel",
                           "single friction_temperature linear"},
                          6,
                          14},
                    Group{"NothingHidden",
                          {"null transmission normal crossed", "null transmission t3 by_session",
                           "null lost_motion outliers crossed",
                           "null transmission quantised sun_torque_set",
                           "null pair_loss normal crossed"},
                          6,
                          14}),
    [](const testing::TestParamInfo<Group>& group) { return group.param.name; });

}  // namespace
}  // namespace gear3k::wide_rig::wide_bench_test
