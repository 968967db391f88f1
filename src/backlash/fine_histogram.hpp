#pragma once
// Counts in many equal bins, from which quantiles and a drawn histogram follow.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gear3k::backlash {

struct HistogramBin {
  double lower = 0.0, upper = 0.0;  ///< in the unit of the values
  std::uint64_t count = 0;
};

/// Integer counts of values in [low, high]; what lies beyond counts in the end bins.  The order of
/// values and of merging does not matter.
class FineHistogram {
 public:
  FineHistogram(double low, double high, std::size_t bins);

  void add(double value) {
    const double place = (value - low_) * bins_per_unit_;
    ++counts_[place >= last_ ? counts_.size() - 1U
              : place > 0.0  ? static_cast<std::size_t>(place)
                             : 0U];
  }
  void merge(const FineHistogram& other);

  [[nodiscard]] std::uint64_t count() const;
  /// Value that `rank` of the values, 0 ≤ rank ≤ count(), do not exceed; straight within its bin.
  /// Resolution: the width of a bin.
  [[nodiscard]] double value_at(double rank) const;
  /// Occupied range in at most `most` bins of a whole number of fine ones each.
  [[nodiscard]] std::vector<HistogramBin> coarse(std::size_t most) const;

 private:
  double low_, bins_per_unit_, last_;
  std::vector<std::uint64_t> counts_;
};

}  // namespace gear3k::backlash
