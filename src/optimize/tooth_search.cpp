#include "optimize/tooth_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "numerics/parallel.hpp"

namespace gear3k::optimize {

namespace {

struct OuterCount {
  int planets, S, P1;
};

/// zR2 that can meet the ratio for the other counts, widened by a tooth on either side.
/// G2 = 1 − (1 + G1)/i rises with i on either sign of i, hence zR2 falls.
IntegerRange ring2_band(const train::ToothSet& z, const Specification& spec) {
  const double i_low = spec.ratio.target * (1.0 - spec.ratio.tolerance);
  const double i_high = spec.ratio.target * (1.0 + spec.ratio.tolerance);
  const double g1 = train::g1(z);
  const double numerator = static_cast<double>(z.P2) * z.R1 / z.P1;
  const auto ring2_at = [&](double i) {
    const double g2 = 1.0 - (1.0 + g1) / i;
    return g2 > 0.0 ? numerator / g2 : std::numeric_limits<double>::infinity();
  };
  const double a = ring2_at(i_low);
  const double b = ring2_at(i_high);
  const double cap = spec.teeth.R2_max + 1.0;
  return {.min = static_cast<int>(std::floor(std::min({a, b, cap}))) - 1,
          .max = static_cast<int>(std::ceil(std::min(std::max(a, b), cap))) + 1};
}

/// Whether a mesh of which it is asked has a common factor above the limit.
bool has_common_factor(const design::Limits& limits, const train::ToothSet& z) {
  const auto& most = limits[design::CheckId::kHuntingTooth];
  if (!most) return false;
  const auto teeth = train::teeth_of(z);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    const int factor =
        std::gcd(teeth[static_cast<std::size_t>(first)], teeth[static_cast<std::size_t>(second)]);
    if (design::hunts(limits, k) && factor > *most) return true;
  }
  return false;
}

/// Whether a tooth number is not of its list.
bool is_off_list(const design::Limits& limits, const train::ToothSet& z) {
  if (!limits[design::CheckId::kAllowedTeeth]) return false;
  const auto teeth = train::teeth_of(z);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const std::vector<int>& list = limits.allowed_teeth[i];
    if (!list.empty() && std::ranges::find(list, teeth[i]) == list.end()) return true;
  }
  return false;
}

/// Why a set within the ratio is no candidate; empty: it is one.
std::optional<ToothRejection> rejection_of(const Specification& spec, const Candidate& c) {
  const train::ToothSet& z = c.teeth;
  if (is_off_list(spec.limits, z)) return ToothRejection::kAllowedTeeth;
  const int least = spec.teeth.min_internal_difference;
  if (z.R1 - z.P1 < least || z.R2 - z.P2 < least) return ToothRejection::kInternalDifference;
  const bool spaced = spec.limits[design::CheckId::kEqualSpacing].has_value();
  const bool identical = spec.limits[design::CheckId::kIdenticalPlanets].has_value();
  const train::Assembly assembly = train::assembly(z, c.planets);
  if (spaced && !assembly.equal_spacing) return ToothRejection::kEqualSpacing;
  if (identical && !assembly.identical_planets) return ToothRejection::kIdenticalPlanets;
  if (has_common_factor(spec.limits, z)) return ToothRejection::kHuntingTooth;
  return std::nullopt;
}

IntegerRange ring1_range(const OuterCount& outer, const ToothRanges& ranges) {
  const int coaxial = outer.S + 2 * outer.P1;
  return {.min = std::max(1, coaxial - ranges.max_coaxial_offset),
          .max = std::min(ranges.R1_max, coaxial + ranges.max_coaxial_offset)};
}

IntegerRange ring2_range(const train::ToothSet& z, const Specification& spec) {
  const IntegerRange band = ring2_band(z, spec);
  return {.min = std::max(1, band.min), .max = std::min(band.max, spec.teeth.R2_max)};
}

void search_outer(const OuterCount& outer, const Specification& spec, ToothSearchResult& result) {
  const ToothRanges& ranges = spec.teeth;
  train::ToothSet z{.S = outer.S, .P1 = outer.P1};
  const IntegerRange ring1 = ring1_range(outer, ranges);
  for (z.R1 = ring1.min; z.R1 <= ring1.max; ++z.R1) {
    for (z.P2 = ranges.P2.min; z.P2 <= ranges.P2.max; ++z.P2) {
      const IntegerRange ring2 = ring2_range(z, spec);
      for (z.R2 = ring2.min; z.R2 <= ring2.max; ++z.R2) {
        if (1LL * z.P1 * z.R2 == 1LL * z.P2 * z.R1) continue;
        const double ratio = train::ratio(z);
        const double miss = std::abs(ratio / spec.ratio.target - 1.0);
        const bool possible = z.R1 > z.P1 && z.R2 > z.P2;
        if (possible && (result.nearest_ratio == 0.0 ||
                         miss < std::abs(result.nearest_ratio / spec.ratio.target - 1.0))) {
          result.nearest_ratio = ratio;
        }
        if (!ratio_matches(ratio, spec.ratio)) continue;
        ++result.within_ratio;
        const Candidate candidate{.teeth = z, .planets = outer.planets};
        if (const auto why = rejection_of(spec, candidate)) {
          ++result.rejected[static_cast<std::size_t>(*why)];
        } else {
          result.candidates.push_back(candidate);
        }
      }
    }
  }
}

/// Adds the counts of a part that comes after what there is.
void add_counts(const Specification& spec, const ToothSearchResult& part,
                ToothSearchResult& result) {
  result.within_ratio += part.within_ratio;
  for (std::size_t r = 0; r < kToothRejectionCount; ++r) result.rejected[r] += part.rejected[r];
  if (part.nearest_ratio != 0.0 && (result.nearest_ratio == 0.0 ||
                                    std::abs(part.nearest_ratio / spec.ratio.target - 1.0) <
                                        std::abs(result.nearest_ratio / spec.ratio.target - 1.0))) {
    result.nearest_ratio = part.nearest_ratio;
  }
  result.interrupted = result.interrupted || part.interrupted;
}

/// Every (planets, S, P1), in the order of the search.
class OuterCounts {
 public:
  explicit OuterCounts(const Specification& spec)
      : planets_(spec.planets), S_(spec.teeth.S), P1_(spec.teeth.P1) {}
  [[nodiscard]] std::size_t size() const { return planets_.size() * count(S_) * count(P1_); }
  [[nodiscard]] OuterCount at(std::size_t k) const {
    const std::size_t sets = count(S_) * count(P1_);
    return {.planets = planets_[k / sets],
            .S = S_.min + static_cast<int>(k % sets / count(P1_)),
            .P1 = P1_.min + static_cast<int>(k % count(P1_))};
  }

 private:
  static std::size_t count(const IntegerRange& range) {
    return range.max < range.min ? 0 : static_cast<std::size_t>(range.max - range.min) + 1;
  }
  const std::vector<int>& planets_;
  IntegerRange S_, P1_;
};

/// Sets that the search visits for one (S, P1, R1, P2) times the number of R1, and how many of them
/// are candidates by a sample of one.
struct SampledSets {
  double visited = 0.0, candidates = 0.0;
};
/// @param u  in [0, 1)
SampledSets sampled_sets(const Specification& spec, const OuterCounts& outers,
                         const std::array<double, 4>& u) {
  const auto pick = [](const IntegerRange& range, double x) {
    return range.min + static_cast<int>(x * (range.max - range.min + 1));
  };
  const auto size = static_cast<double>(outers.size());
  const OuterCount outer = outers.at(static_cast<std::size_t>(u[0] * size));
  const IntegerRange ring1 = ring1_range(outer, spec.teeth);
  if (ring1.max < ring1.min) return {};
  Candidate c{.teeth = {.S = outer.S, .P1 = outer.P1}, .planets = outer.planets};
  train::ToothSet& z = c.teeth;
  z.R1 = pick(ring1, u[1]);
  z.P2 = pick(spec.teeth.P2, u[2]);
  const IntegerRange ring2 = ring2_range(z, spec);
  if (ring2.max < ring2.min) return {};
  z.R2 = pick(ring2, u[3]);
  const double visited = (ring1.max - ring1.min + 1.0) * (ring2.max - ring2.min + 1.0);
  const bool candidate = 1LL * z.P1 * z.R2 != 1LL * z.P2 * z.R1 &&
                         ratio_matches(train::ratio(z), spec.ratio) && !rejection_of(spec, c);
  return {.visited = visited, .candidates = candidate ? visited : 0.0};
}

}  // namespace

bool ratio_matches(double ratio, const RatioTarget& target) {
  return std::abs(ratio / target.target - 1.0) <= target.tolerance;
}

std::uint64_t ToothSearchResult::candidate_count() const {
  return std::accumulate(rejected.begin(), rejected.end(), within_ratio, std::minus<>());
}

ToothSearchResult search_teeth(const Specification& spec, Progress& progress,
                               const std::function<void(std::span<const Candidate>)>& take) {
  constexpr std::size_t kPiece = 256;
  const OuterCounts outers(spec);
  progress.total = 0;  // while done and phase change, nothing is known
  progress.done = 0;
  progress.phase = Progress::Phase::kSearch;
  progress.total = outers.size();
  ToothSearchResult result;
  std::vector<Candidate> piece;
  for (std::size_t begin = 0; begin < outers.size(); begin += kPiece) {
    std::vector<ToothSearchResult> parts(std::min(kPiece, outers.size() - begin));
    numerics::parallel_for(parts.size(), [&](std::size_t k) {
      if (progress.stop.load(std::memory_order_relaxed)) {
        parts[k].interrupted = true;
      } else {
        search_outer(outers.at(begin + k), spec, parts[k]);
      }
      ++progress.done;
    });
    piece.clear();
    for (const ToothSearchResult& part : parts) {
      add_counts(spec, part, result);
      piece.insert(piece.end(), part.candidates.begin(), part.candidates.end());
    }
    if (!piece.empty()) take(piece);
    if (result.interrupted) break;
  }
  return result;
}

ToothSearchResult search_teeth(const Specification& spec, Progress& progress) {
  std::vector<Candidate> candidates;
  ToothSearchResult result = search_teeth(spec, progress, [&](std::span<const Candidate> piece) {
    candidates.insert(candidates.end(), piece.begin(), piece.end());
  });
  result.candidates = std::move(candidates);
  return result;
}

double estimated_candidates(const Specification& spec, double most) {
  // Additive recurrence with the powers of the root of x⁵ = x + 1 (Roberts, 2018).
  constexpr double kRoot = 1.1673039782614187;
  constexpr std::array<double, 4> kStep{1.0 / kRoot, 1.0 / (kRoot * kRoot),
                                        1.0 / (kRoot * kRoot * kRoot),
                                        1.0 / (kRoot * kRoot * kRoot * kRoot)};
  constexpr int kFirst = 4000;
  const OuterCounts outers(spec);
  if (outers.size() == 0 || spec.teeth.P2.max < spec.teeth.P2.min) return 0.0;
  const double others =
      static_cast<double>(outers.size()) * (spec.teeth.P2.max - spec.teeth.P2.min + 1.0);
  std::array<double, 4> u{0.5, 0.5, 0.5, 0.5};
  double sum = 0.0, greatest = 0.0;
  int taken = 0;
  for (int goal = kFirst; goal <= kEstimateSamples; goal *= 10) {
    for (; taken < goal; ++taken) {
      for (std::size_t k = 0; k < u.size(); ++k) u[k] = std::fmod(u[k] + kStep[k], 1.0);
      const SampledSets sets = sampled_sets(spec, outers, u);
      sum += sets.candidates;
      greatest = std::max(greatest, sets.visited);
    }
    // Ten more in this sample would not make too many.
    if (others * (sum + 10.0 * greatest) / taken < most) break;
  }
  return others * sum / taken;
}

}  // namespace gear3k::optimize
