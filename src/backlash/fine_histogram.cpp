#include "backlash/fine_histogram.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace gear3k::backlash {

FineHistogram::FineHistogram(double low, double high, std::size_t bins)
    : low_(low),
      bins_per_unit_(static_cast<double>(bins) /
                     std::max(high - low, std::numeric_limits<double>::min())),
      last_(static_cast<double>(bins - 1)),
      counts_(bins) {}

void FineHistogram::merge(const FineHistogram& other) {
  for (std::size_t k = 0; k < counts_.size(); ++k) counts_[k] += other.counts_[k];
}

std::uint64_t FineHistogram::count() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

double FineHistogram::value_at(double rank) const {
  double below = 0.0;
  double value = low_;
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    if (counts_[k] == 0) continue;
    const auto here = static_cast<double>(counts_[k]);
    const double share = std::clamp((rank - below) / here, 0.0, 1.0);
    value = low_ + (static_cast<double>(k) + share) / bins_per_unit_;
    below += here;
    if (rank <= below) break;
  }
  return value;
}

std::vector<HistogramBin> FineHistogram::coarse(std::size_t most) const {
  const auto occupied = [](std::uint64_t count) { return count > 0; };
  const auto first = std::find_if(counts_.begin(), counts_.end(), occupied);
  if (first == counts_.end()) return {};
  const auto end = std::find_if(counts_.rbegin(), counts_.rend(), occupied).base();
  const auto begin = static_cast<std::size_t>(first - counts_.begin());
  const auto fine = static_cast<std::size_t>(end - first);
  const std::size_t width = (fine + most - 1) / most;
  std::vector<HistogramBin> bins;
  bins.reserve(fine / width + 1);
  for (std::size_t k = 0; k < fine; k += width) {
    const auto edge = [&](std::size_t at) {
      return low_ + static_cast<double>(begin + at) / bins_per_unit_;
    };
    HistogramBin bin{.lower = edge(k), .upper = edge(k + width), .count = 0};
    for (std::size_t i = k; i < std::min(k + width, fine); ++i) bin.count += counts_[begin + i];
    bins.push_back(bin);
  }
  return bins;
}

}  // namespace gear3k::backlash
