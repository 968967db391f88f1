#pragma once
// A share with its interval, for tables of rates.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace gear3k::benchmarks {

/// Percent with Wilson's 95 % interval, 19 characters wide; "-" of nothing.
/// Source: Wilson, Probable inference, J. Amer. Statist. Assoc. 22 (1927).
inline std::string share(int hits, int count) {
  if (count == 0) return fmt::format("{:>19}", "-");
  constexpr double kZ = 1.959963984540054;
  const double n = count;
  const double p = hits / n;
  const double middle = (p + kZ * kZ / (2.0 * n)) / (1.0 + kZ * kZ / n);
  const double half =
      kZ / (1.0 + kZ * kZ / n) * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  return fmt::format("{:5.1f} [{:4.1f}, {:5.1f}]", 100.0 * p, 100.0 * std::max(0.0, middle - half),
                     100.0 * std::min(1.0, middle + half));
}

}  // namespace gear3k::benchmarks
