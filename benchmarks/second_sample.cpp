#include "benchmarks/second_sample.hpp"

#include <map>

#include "benchmarks/share.hpp"

namespace gear3k::benchmarks {
namespace {

std::string_view without_again(std::string_view line) {
  return line.starts_with(kAgain) ? line.substr(kAgain.size()) : line;
}

// Both samples of each name; the name is empty of records that belong to none.
template <typename Name, typename Hit>
std::vector<TwoSamples> both_samples(const std::vector<RateRecord>& records, Name name, Hit hit) {
  std::map<std::string, TwoSamples> found;
  for (const RateRecord& r : records) {
    const std::string of = name(r);
    if (of.empty()) continue;
    TwoSamples& two = found[of];
    two.name = of;
    const int one = hit(r) ? 1 : 0;
    (is_again(r) ? two.again : two.first) += 1;
    (is_again(r) ? two.again_hits : two.first_hits) += one;
  }
  std::vector<TwoSamples> list;
  list.reserve(found.size());
  for (auto& [of, two] : found) list.push_back(std::move(two));
  return list;
}

}  // namespace

bool is_again(const RateRecord& r) { return r.line.starts_with(kAgain); }

bool is_null_line(std::string_view line) { return without_again(line).starts_with("null "); }

bool noise_remembers(std::string_view noise) { return noise == "correlated" || noise == "blocks"; }

std::string plan_name(const RateRecord& r) {
  const std::string line(without_again(r.line));
  return line.substr(5, line.find(' ', 5) - 5) + " " + r.plan;
}

std::vector<TwoSamples> laws_taken_again(const std::vector<RateRecord>& records) {
  auto all = both_samples(
      records,
      [](const RateRecord& r) {
        const std::string_view line = without_again(r.line);
        return line.starts_with("single ") ? std::string(line) : "";
      },
      [](const RateRecord& r) { return r.all_right; });
  std::erase_if(all, [](const TwoSamples& s) { return s.first_hits == s.first; });
  return all;
}

std::vector<TwoSamples> plans_taken_again(const std::vector<RateRecord>& records, double percent) {
  auto all = both_samples(
      records,
      [](const RateRecord& r) {
        return is_null_line(r.line) && !noise_remembers(r.noise) ? plan_name(r) : "";
      },
      [](const RateRecord& r) { return !r.all_right; });
  std::erase_if(all, [&](const TwoSamples& s) {
    return s.first == 0 || !(100.0 * share_interval(s.first_hits, s.first)[1] > percent);
  });
  return all;
}

}  // namespace gear3k::benchmarks
