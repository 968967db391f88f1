#pragma once
// The middle one of numbers.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gear3k::numerics {

/// The number that half of the others are not above: of an even count the greater of the two in the
/// middle.
/// @param values  one or more, none NaN
inline double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace gear3k::numerics
