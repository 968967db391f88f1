#pragma once
// A share with its interval, for tables of rates.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace gear3k::benchmarks {

/// Wilson's 95 % interval of a share, 0 to 1; count > 0.
/// Source: Wilson, Probable inference, J. Amer. Statist. Assoc. 22 (1927).
inline std::array<double, 2> share_interval(int hits, int count) {
  constexpr double kZ = 1.959963984540054;
  const double n = count;
  const double p = hits / n;
  const double middle = (p + kZ * kZ / (2.0 * n)) / (1.0 + kZ * kZ / n);
  const double half =
      kZ / (1.0 + kZ * kZ / n) * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

/// Percent with that interval, 19 characters wide; "-" of nothing.
inline std::string share(int hits, int count) {
  if (count == 0) return fmt::format("{:>19}", "-");
  const auto [low, high] = share_interval(hits, count);
  return fmt::format("{:5.1f} [{:4.1f}, {:5.1f}]", 100.0 * hits / count, 100.0 * low, 100.0 * high);
}

}  // namespace gear3k::benchmarks
