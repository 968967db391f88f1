#include "optimize/tooth_search.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "io/files/specification_file.hpp"

namespace gear3k::optimize::tooth_search_test {
namespace {

Specification rp96() {
  return io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/rp96.toml");
}

using Teeth = std::tuple<int, int, int, int, int, int>;

/// Whether a set keeps the limits of common factors and of lists, spelt out.
bool keeps_tooth_limits(const design::Limits& limits, int s, int p1, int r1, int p2, int r2) {
  const std::array<std::array<int, 2>, 3> meshes{{{s, p1}, {p1, r1}, {p2, r2}}};
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    if (!limits[design::CheckId::kHuntingTooth]) break;
    const auto& asked = limits.hunting_meshes;
    const auto mesh = static_cast<train::MeshId>(k);
    if (!asked.empty() && std::count(asked.begin(), asked.end(), mesh) == 0) continue;
    for (int factor = 2; factor <= meshes[k][0]; ++factor) {
      const bool common = meshes[k][0] % factor == 0 && meshes[k][1] % factor == 0;
      if (common && factor > *limits[design::CheckId::kHuntingTooth]) return false;
    }
  }
  const std::array<int, 5> teeth{s, p1, r1, p2, r2};
  for (std::size_t i = 0; i < teeth.size(); ++i) {
    const auto& list = limits.allowed_teeth[i];
    const bool free = list.empty() || !limits[design::CheckId::kAllowedTeeth];
    if (!free && std::count(list.begin(), list.end(), teeth[i]) == 0) return false;
  }
  return true;
}

struct BruteForce {
  std::set<Teeth> candidates;
  std::uint64_t within_ratio = 0;
};

/// Five nested loops over every tooth count, with the rules as rp96.md states them.
BruteForce brute_force(const Specification& spec) {
  BruteForce result;
  const ToothRanges& r = spec.teeth;
  for (const int n : spec.planets) {
    for (int s = r.S.min; s <= r.S.max; ++s) {
      for (int p1 = r.P1.min; p1 <= r.P1.max; ++p1) {
        for (int r1 = 1; r1 <= r.R1_max; ++r1) {
          if (std::abs(r1 - (s + 2 * p1)) > r.max_coaxial_offset) continue;
          for (int p2 = r.P2.min; p2 <= r.P2.max; ++p2) {
            for (int r2 = 1; r2 <= r.R2_max; ++r2) {
              const double g1 = static_cast<double>(r1) / s;
              const double g2 = static_cast<double>(p2) * r1 / (static_cast<double>(p1) * r2);
              if (g2 == 1.0) continue;
              const double ratio = (1.0 + g1) / (1.0 - g2);
              if (std::abs(ratio / spec.ratio.target - 1.0) > spec.ratio.tolerance) continue;
              ++result.within_ratio;
              if (r1 - p1 < r.min_internal_difference || r2 - p2 < r.min_internal_difference) {
                continue;
              }
              const bool spaced = (s + r1) % n == 0;
              if (spec.limits[design::CheckId::kEqualSpacing] && !spaced) continue;
              if (spec.limits[design::CheckId::kIdenticalPlanets] &&
                  (!spaced || (r2 * p1 - r1 * p2) % (n * std::gcd(p1, p2)) != 0)) {
                continue;
              }
              if (!keeps_tooth_limits(spec.limits, s, p1, r1, p2, r2)) continue;
              result.candidates.insert({n, s, p1, r1, p2, r2});
            }
          }
        }
      }
    }
  }
  return result;
}

void expect_equal_to_brute_force(const Specification& spec) {
  Progress progress;
  const ToothSearchResult found = search_teeth(spec, progress);
  const BruteForce all = brute_force(spec);
  std::set<Teeth> set;
  for (const Candidate& c : found.candidates) {
    set.insert({c.planets, c.teeth.S, c.teeth.P1, c.teeth.R1, c.teeth.P2, c.teeth.R2});
  }
  EXPECT_EQ(set.size(), found.candidates.size()) << "a set was generated twice";
  EXPECT_EQ(set, all.candidates);
  EXPECT_EQ(found.within_ratio, all.within_ratio);
  EXPECT_EQ(found.within_ratio,
            found.candidates.size() +
                std::accumulate(found.rejected.begin(), found.rejected.end(), std::uint64_t{0}));
  EXPECT_TRUE(std::is_sorted(found.candidates.begin(), found.candidates.end(),
                             [](const Candidate& a, const Candidate& b) {
                               return std::tie(a.planets, a.teeth) < std::tie(b.planets, b.teeth);
                             }));
}

TEST(ToothSearch, Rp96HasThe654SetsOfTheBruteForceLoop) {
  const Specification spec = rp96();
  expect_equal_to_brute_force(spec);
  Progress progress;
  EXPECT_EQ(search_teeth(spec, progress).candidates.size(), 654U);  // docs/rp96.md
}

TEST(ToothSearch, Rp96WithoutIdenticalPlanetsHas2117Sets) {
  Specification spec = rp96();
  spec.limits[design::CheckId::kIdenticalPlanets].reset();
  expect_equal_to_brute_force(spec);
  Progress progress;
  EXPECT_EQ(search_teeth(spec, progress).candidates.size(), 2117U);  // docs/rp96.md
}

TEST(ToothSearch, CommonFactorsAndListsAreThoseOfTheBruteForceLoop) {
  using design::CheckId;
  Specification spec = rp96();
  spec.limits[CheckId::kHuntingTooth] = 1.0;
  expect_equal_to_brute_force(spec);
  Progress progress;
  const ToothSearchResult hunting = search_teeth(spec, progress);
  EXPECT_GT(hunting.candidates.size(), 0U);
  EXPECT_GT(hunting.rejected[static_cast<std::size_t>(ToothRejection::kHuntingTooth)], 0U);
  EXPECT_EQ(hunting.rejected[static_cast<std::size_t>(ToothRejection::kAllowedTeeth)], 0U);
  spec.limits.hunting_meshes = {train::kMeshP2R2};
  expect_equal_to_brute_force(spec);
  EXPECT_GT(search_teeth(spec, progress).candidates.size(), hunting.candidates.size());
  spec.limits[CheckId::kHuntingTooth] = 3.0;
  expect_equal_to_brute_force(spec);
  spec.limits[CheckId::kAllowedTeeth] = 0.0;
  spec.limits.allowed_teeth[train::kS] = {12, 14, 15};
  spec.limits.allowed_teeth[train::kR2] = {90, 93, 96, 99, 102, 105, 108};
  expect_equal_to_brute_force(spec);
  const ToothSearchResult listed = search_teeth(spec, progress);
  EXPECT_GT(listed.candidates.size(), 0U);
  EXPECT_GT(listed.rejected[static_cast<std::size_t>(ToothRejection::kAllowedTeeth)], 0U);
}

TEST(ToothSearch, LosesNothingForRandomSpecifications) {
  std::mt19937 random(7);
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  std::size_t found = 0;
  for (int trial = 0; trial < 30; ++trial) {
    Specification spec = rp96();
    const double magnitude = std::uniform_real_distribution<double>(4.0, 250.0)(random);
    spec.ratio.target = trial % 2 == 0 ? magnitude : -magnitude;
    spec.ratio.tolerance = std::uniform_real_distribution<double>(0.0, 0.05)(random);
    const int s = integer(6, 20);
    const int p1 = integer(12, 40);
    const int p2 = integer(12, 40);
    spec.teeth = {.S = {s, s + 5},
                  .P1 = {p1, p1 + 10},
                  .P2 = {p2, p2 + 10},
                  .R1_max = integer(60, 130),
                  .R2_max = integer(60, 130),
                  .max_coaxial_offset = integer(0, 6),
                  .min_internal_difference = integer(1, 12)};
    spec.planets = {integer(1, 3), integer(4, 6)};
    if (integer(0, 1) == 1) spec.limits[design::CheckId::kIdenticalPlanets].reset();
    if (trial % 7 == 0) spec.limits[design::CheckId::kEqualSpacing].reset();
    expect_equal_to_brute_force(spec);
    Progress progress;
    found += search_teeth(spec, progress).candidates.size();
  }
  EXPECT_GT(found, 1000U) << "the random specifications are too empty to prove anything";
}

TEST(ToothSearch, OrderDoesNotDependOnTheNumberOfThreads) {
  const Specification spec = rp96();
  Progress progress;
  omp_set_num_threads(1);
  const auto one = search_teeth(spec, progress);
  omp_set_num_threads(4);
  const auto four = search_teeth(spec, progress);
  EXPECT_EQ(one.candidates, four.candidates);
  EXPECT_EQ(one.rejected, four.rejected);
}

TEST(ToothSearch, CountsAnewWithTheProgressOfAnotherSearch) {
  Progress progress;
  for (int run = 0; run < 2; ++run) {
    search_teeth(rp96(), progress);
    EXPECT_GT(progress.total, 0U);
    EXPECT_EQ(progress.done, progress.total) << run;
  }
}

TEST(ToothSearch, StopEndsTheSearchAndSaysSo) {
  Progress progress;
  progress.stop = true;
  EXPECT_TRUE(search_teeth(rp96(), progress).interrupted);
}

}  // namespace
}  // namespace gear3k::optimize::tooth_search_test
