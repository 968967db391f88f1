// The ranking keeps what it is asked for, in the order of a full sort.

#include "optimize/zero_shift.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/files/specification_file.hpp"

namespace gear3k::optimize::zero_shift_test {
namespace {

/// Some 20000 sets, many of which are alike at zero shift or do not mesh.
Specification some_sets() {
  Specification spec =
      io::read_specification(std::string(GEAR3K_SOURCE_DIR) + "/examples/ratio-96.toml");
  spec.limits[design::CheckId::kIdenticalPlanets].reset();
  spec.ratio.tolerance = 0.02;
  spec.planets = {3, 4};
  return spec;
}

TEST(ZeroShiftRanking, HoldsFewOfManySetsAndRanksThemAsAllOfThem) {
  const Specification spec = some_sets();
  Progress progress;
  const std::vector<Candidate> all = search_teeth(spec, progress).candidates;
  ASSERT_GT(all.size(), 10'000U);
  const std::vector<ZeroShiftSet> ranked = rank_at_zero_shift(spec, all);
  ASSERT_EQ(ranked.size(), all.size());
  constexpr std::size_t kMost = 100;
  ZeroShiftRanking few(spec, kMost);
  std::size_t pieces = 0, most_held = 0;
  const ToothSearchResult search =
      search_teeth(spec, progress, [&](std::span<const Candidate> piece) {
        few.add(piece);
        ++pieces;
        most_held = std::max(most_held, few.held());
      });
  EXPECT_GT(pieces, 5U);
  EXPECT_LE(most_held, 2 * kMost + 1);
  EXPECT_TRUE(search.candidates.empty());
  EXPECT_EQ(search.candidate_count(), all.size());
  EXPECT_EQ(few.added(), all.size());
  std::size_t rank = 0;
  few.for_each([&](const ZeroShiftSet& set) {
    ASSERT_LT(rank, kMost);
    EXPECT_EQ(set.candidate, ranked[rank].candidate) << rank;
    EXPECT_EQ(set.eta_b, ranked[rank].eta_b);
    ++rank;
  });
  EXPECT_EQ(rank, kMost);
}

TEST(ZeroShiftRanking, PutsSetsThatMeshFirstThenTheMoreEfficientThenTheEarlier) {
  Specification spec = some_sets();
  spec.objectives = {Objective::kForwardEfficiency};
  Progress progress;
  const std::vector<ZeroShiftSet> ranked =
      rank_at_zero_shift(spec, search_teeth(spec, progress).candidates);
  std::size_t alike = 0;
  for (std::size_t k = 1; k < ranked.size(); ++k) {
    const ZeroShiftSet& a = ranked[k - 1];
    const ZeroShiftSet& b = ranked[k];
    ASSERT_GE(a.meshes, b.meshes);
    if (a.meshes != b.meshes) continue;
    ASSERT_GE(a.defined, b.defined);
    if (a.defined != b.defined) continue;
    ASSERT_GE(a.eta_f, b.eta_f);
    if (a.eta_f != b.eta_f) continue;
    ++alike;
    ASSERT_LT(std::tie(a.candidate.planets, a.candidate.teeth),
              std::tie(b.candidate.planets, b.candidate.teeth));
  }
  EXPECT_GT(alike, 100U);
}

TEST(EstimatedCandidates, AreAboutAsManyAsTheSearchFinds) {
  Specification spec = some_sets();
  for (const double tolerance : {0.005, 0.02, 0.2}) {
    spec.ratio.tolerance = tolerance;
    Progress progress;
    const auto found = static_cast<double>(
        search_teeth(spec, progress, [](std::span<const Candidate>) {}).candidate_count());
    // Some 2 · 10⁶ sets or more are visited: 20 % is three times the standard error of the first.
    EXPECT_NEAR(estimated_candidates(spec, 0.0), found, 0.2 * found) << tolerance;
    EXPECT_LT(estimated_candidates(spec, kMostRefinedSets), kMostRefinedSets);
  }
}

TEST(EstimatedCandidates, OfEmptyRangesAreNone) {
  Specification spec = some_sets();
  spec.teeth.P2 = {.min = 30, .max = 20};
  EXPECT_EQ(estimated_candidates(spec, 1.0), 0.0);
  spec = some_sets();
  spec.teeth.R1_max = 10;
  EXPECT_EQ(estimated_candidates(spec, 1.0), 0.0);
}

}  // namespace
}  // namespace gear3k::optimize::zero_shift_test
