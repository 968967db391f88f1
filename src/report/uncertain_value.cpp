#include "report/uncertain_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/display.hpp"

namespace gear3k::report {

namespace {

/// Decimals that show two digits of a deviation; negative above 100.
int decimals_of(double deviation) {
  constexpr double kRounding = 1e-9;
  return 1 - static_cast<int>(std::floor(std::log10(deviation) + kRounding));
}
constexpr int kMostDecimals = 6;

}  // namespace

std::string with_interval(const calibrate::ParameterResult& p) {
  const double half = 0.5 * (p.high - p.low);
  if (!std::isfinite(half) || half <= 0.0) {
    return with_unit(fmt::format("{:.4g}", clean(p.value)), p.unit);
  }
  const int decimals = decimals_of(half);
  const bool plain = decimals <= kMostDecimals;
  const auto number = [&](double x) {
    return plain ? fixed(x, std::max(0, decimals)) : fmt::format("{:.4g}", clean(x));
  };
  constexpr double kLopsided = 0.1;  // of the interval's width
  if (std::abs(p.high - p.value - half) > kLopsided * 2.0 * half) {
    return with_unit(
        fmt::format("{} (95 %: {} to {})", number(p.value), number(p.low), number(p.high)), p.unit);
  }
  return with_unit(
      fmt::format("{} ± {}", number(p.value), plain ? number(half) : fmt::format("{:.2g}", half)),
      p.unit);
}

std::string deviation_text(double value, double deviation) {
  if (!std::isfinite(deviation) || deviation <= 0.0) return fmt::format("{:.4g}", clean(value));
  const int decimals = decimals_of(deviation);
  if (decimals > kMostDecimals) return fmt::format("{:.4g} ± {:.2g}", clean(value), deviation);
  return fmt::format("{} ± {}", fixed(value, std::max(0, decimals)),
                     fixed(deviation, std::max(0, decimals)));
}

}  // namespace gear3k::report
