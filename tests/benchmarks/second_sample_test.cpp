#include "benchmarks/second_sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/must_show_table.hpp"

namespace gear3k::benchmarks::second_sample_test {
namespace {

void add(std::vector<RateRecord>& records, const std::string& line, int count, int right,
         const std::string& noise = "normal") {
  static std::uint64_t seed = 0;
  for (int k = 0; k < count; ++k) {
    records.push_back({.line = line,
                       .strength = 2.0,
                       .seed = ++seed,
                       .plan = "crossed",
                       .noise = noise,
                       .right = k < right,
                       .all_right = k < right});
  }
}

// The larger root of (p - hits/n)^2 = z^2 p (1 - p) / n, halved down to; what Wilson's limit
// solves.
double upper_limit(int hits, int count) {
  const double share = 1.0 * hits / count;
  double low = share, high = 1.0;
  for (int k = 0; k < 60; ++k) {
    const double p = 0.5 * (low + high);
    const double z = 1.959964;
    ((p - share) * (p - share) < z * z * p * (1.0 - p) / count ? low : high) = p;
  }
  return low;
}

std::vector<std::string> names(const std::vector<TwoSamples>& of) {
  std::vector<std::string> list;
  list.reserve(of.size());
  for (const TwoSamples& s : of) list.push_back(s.name);
  return list;
}

const TableLine* found(const std::vector<TableLine>& table, const std::string& what) {
  const auto at = std::ranges::find_if(
      table, [&](const TableLine& l) { return l.what.find(what) != std::string::npos; });
  return at == table.end() ? nullptr : &*at;
}

TEST(SecondSample, IsOfLawsWithAnyNotRightInTheFirst) {
  std::vector<RateRecord> records;
  add(records, "single pair_loss friction_level all_right", 8, 8);
  add(records, "single pair_loss friction_level one_not", 8, 7);
  add(records, "pair runout+thermal_expansion", 8, 3);
  EXPECT_EQ(names(laws_taken_again(records)),
            std::vector<std::string>{"single pair_loss friction_level one_not"});
  // What the second came to changes nothing of who is taken.
  add(records, "again single pair_loss friction_level one_not", 40, 40);
  add(records, "again single pair_loss friction_level all_right", 40, 0);
  const auto laws = laws_taken_again(records);
  ASSERT_EQ(laws.size(), 1U);
  EXPECT_EQ(laws[0].first, 8);
  EXPECT_EQ(laws[0].first_hits, 7);
  EXPECT_EQ(laws[0].again, 40);
  EXPECT_EQ(laws[0].again_hits, 40);
}

TEST(SecondSample, IsOfPlansWhoseUpperLimitIsAboveEightPercent) {
  for (int hits = 3; hits <= 9; ++hits) {
    std::vector<RateRecord> records;
    add(records, "null transmission t3 crossed", 145, 145 - hits, "t3");
    // Noise that remembers is not of the plan.
    add(records, "null transmission blocks crossed", 29, 0, "blocks");
    const auto plans = plans_taken_again(records);
    EXPECT_EQ(plans.size(), upper_limit(hits, 145) > 0.08 ? 1U : 0U) << hits;
    if (plans.empty()) continue;
    EXPECT_EQ(plans[0].name, "transmission crossed");
    EXPECT_EQ(plans[0].first_hits, hits);
  }
}

TEST(SecondSample, IsJudgedAloneAndLeavesTheFirstAsItIs) {
  std::vector<RateRecord> records;
  add(records, "single pair_loss friction_level good", 8, 8);
  add(records, "single pair_loss friction_level luck", 8, 5);
  add(records, "single pair_loss friction_level poor", 8, 6);
  add(records, "null transmission normal crossed", 145, 135);
  add(records, "null lost_motion normal crossed", 145, 135);
  add(records, "single pair_loss friction_level begun", 8, 7);
  const std::string before = csv_of(must_show_table(records));
  EXPECT_EQ(found(must_show_table(records), "second sample"), nullptr);
  add(records, "again single pair_loss friction_level luck", 40, 38);
  add(records, "again single pair_loss friction_level poor", 40, 33);
  add(records, "again single pair_loss friction_level begun", 39, 20);  // not whole: not judged
  add(records, "again null transmission normal crossed", 400, 384);
  add(records, "again null lost_motion normal crossed", 400, 370);
  for (RateRecord& r : records) {
    if (is_again(r)) r.intervals = 1, r.claims = {{75.0, false}};
  }
  const auto table = must_show_table(records);
  EXPECT_TRUE(csv_of(table).starts_with(before));

  const TableLine* luck = found(table, "luck: first 5 of 8; again");
  ASSERT_NE(luck, nullptr);
  EXPECT_EQ(luck->hits, 38);
  EXPECT_EQ(luck->count, 40);
  const TableLine* laws = found(table, "of these: laws below 88 % in the second sample");
  ASSERT_NE(laws, nullptr);
  EXPECT_EQ(laws->count, 2);
  EXPECT_EQ(laws->hits, 1);  // 33 of 40 is 82.5 %
  const TableLine* plans =
      found(table, "of these: upper limit above 8 % in the second sample, too");
  ASSERT_NE(plans, nullptr);
  EXPECT_EQ(plans->count, 2);
  EXPECT_LT(upper_limit(16, 400), 0.08);
  EXPECT_GT(upper_limit(30, 400), 0.08);
  EXPECT_EQ(plans->hits, 1);
}

}  // namespace
}  // namespace gear3k::benchmarks::second_sample_test
