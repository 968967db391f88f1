#include "optimize/tooth_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "optimize/parallel.hpp"

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

void search_outer(const OuterCount& outer, const Specification& spec, ToothSearchResult& result) {
  const ToothRanges& ranges = spec.teeth;
  train::ToothSet z{.S = outer.S, .P1 = outer.P1};
  const bool equal_spacing = spec.limits[design::CheckId::kEqualSpacing].has_value();
  const bool identical_planets = spec.limits[design::CheckId::kIdenticalPlanets].has_value();
  const int coaxial = z.S + 2 * z.P1;
  const int r1_last = std::min(ranges.R1_max, coaxial + ranges.max_coaxial_offset);
  for (z.R1 = std::max(1, coaxial - ranges.max_coaxial_offset); z.R1 <= r1_last; ++z.R1) {
    for (z.P2 = ranges.P2.min; z.P2 <= ranges.P2.max; ++z.P2) {
      const IntegerRange band = ring2_band(z, spec);
      const int r2_last = std::min(band.max, ranges.R2_max);
      for (z.R2 = std::max(1, band.min); z.R2 <= r2_last; ++z.R2) {
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
        const auto reject = [&](ToothRejection why) {
          ++result.rejected[static_cast<std::size_t>(why)];
        };
        if (z.R1 - z.P1 < ranges.min_internal_difference ||
            z.R2 - z.P2 < ranges.min_internal_difference) {
          reject(ToothRejection::kInternalDifference);
          continue;
        }
        const train::Assembly assembly = train::assembly(z, outer.planets);
        if (equal_spacing && !assembly.equal_spacing) {
          reject(ToothRejection::kEqualSpacing);
        } else if (identical_planets && !assembly.identical_planets) {
          reject(ToothRejection::kIdenticalPlanets);
        } else {
          result.candidates.push_back({.teeth = z, .planets = outer.planets});
        }
      }
    }
  }
}

}  // namespace

bool ratio_matches(double ratio, const RatioTarget& target) {
  return std::abs(ratio / target.target - 1.0) <= target.tolerance;
}

ToothSearchResult search_teeth(const Specification& spec, Progress& progress) {
  std::vector<OuterCount> outer;
  for (const int planets : spec.planets) {
    for (int s = spec.teeth.S.min; s <= spec.teeth.S.max; ++s) {
      for (int p1 = spec.teeth.P1.min; p1 <= spec.teeth.P1.max; ++p1) {
        outer.push_back({.planets = planets, .S = s, .P1 = p1});
      }
    }
  }
  std::vector<ToothSearchResult> parts(outer.size());
  progress.phase = Progress::Phase::kSearch;
  progress.total = outer.size();
  parallel_for(outer.size(), [&](std::size_t k) {
    if (progress.stop.load(std::memory_order_relaxed)) {
      parts[k].interrupted = true;
    } else {
      search_outer(outer[k], spec, parts[k]);
    }
    ++progress.done;
  });
  ToothSearchResult result;
  for (const ToothSearchResult& part : parts) {
    result.within_ratio += part.within_ratio;
    for (std::size_t r = 0; r < kToothRejectionCount; ++r) result.rejected[r] += part.rejected[r];
    result.candidates.insert(result.candidates.end(), part.candidates.begin(),
                             part.candidates.end());
    if (part.nearest_ratio != 0.0 &&
        (result.nearest_ratio == 0.0 ||
         std::abs(part.nearest_ratio / spec.ratio.target - 1.0) <
             std::abs(result.nearest_ratio / spec.ratio.target - 1.0))) {
      result.nearest_ratio = part.nearest_ratio;
    }
    result.interrupted = result.interrupted || part.interrupted;
  }
  return result;
}

}  // namespace gear3k::optimize
