#pragma once
// Laws and plans of the table of `diagnose` that are measured again, where the first sample of each
// is too small to tell.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/rate_record.hpp"

namespace gear3k::benchmarks {

/// What the lines of a second sample begin with, so that no other count takes them.
inline constexpr std::string_view kAgain = "again ";
/// Campaigns of a second sample: of a law, at all strengths together, and of a plan.
inline constexpr int kAgainOfLaw = 40, kAgainOfPlan = 400;
/// Seeds between the first sample's first and the second's; the first has fewer.
inline constexpr std::uint64_t kAgainSeeds = 500;

/// A line of single causes ("single transmission friction_load power") or a plan of campaigns where
/// nothing is hidden ("transmission even_angles"), in both samples.  Who is taken again is chosen
/// by the first sample; the second, of other seeds, is not biased by that choice and is judged
/// alone.
struct TwoSamples {
  std::string name{};
  int first = 0, first_hits = 0;  ///< campaigns; right ones (law), that say something (plan)
  int again = 0, again_hits = 0;
};

/// Single laws with any campaign of the first sample that is not right.
std::vector<TwoSamples> laws_taken_again(const std::vector<RateRecord>& records);
/// Plans without noise that remembers whose upper 95 % limit of something said is above `percent`.
std::vector<TwoSamples> plans_taken_again(const std::vector<RateRecord>& records,
                                          double percent = 8.0);

bool is_again(const RateRecord& record);
/// Nothing is hidden in it: of either sample.
bool is_null_line(std::string_view line);
/// Noise that is correlated from row to row, or by block.
bool noise_remembers(std::string_view noise);
/// Of a campaign where nothing is hidden: the kind of measurement and its plan.
std::string plan_name(const RateRecord& record);

}  // namespace gear3k::benchmarks
