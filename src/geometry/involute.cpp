#include "geometry/involute.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "geometry/scalar.hpp"

namespace gear3k::geometry {

template <class T>
T involute(const T& angle) {
  using std::tan;
  return tan(angle) - angle;
}

namespace {

constexpr double kRounding = 2.0 * std::numeric_limits<double>::epsilon();

double inverse_involute_value(double value) {
  if (!(value >= 0.0 && std::isfinite(value))) {
    throw std::invalid_argument(
        fmt::format("inverse_involute: value = {} rad, allowed: at least 0, finite", value));
  }
  if (value == 0.0) return 0.0;
  // Both are upper bounds: inv a >= a^3/3, and inv a >= tan a - pi/2.
  double a = std::min(std::cbrt(3.0 * value), std::atan(value + std::numbers::pi / 2.0));
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double t = std::tan(a);
    const double step = (t - a - value) / (t * t);
    a -= step;
    // One ulp of tan a moves the root by eps/tan a.
    if (!(std::abs(step) > kRounding * (a + 1.0 / t))) break;
  }
  return a;
}

}  // namespace

template <class T>
T inverse_involute(const T& value) {
  using std::tan;
  T a = constant<T>(inverse_involute_value(value_of(value)));
  if constexpr (!std::is_floating_point_v<T>) {
    if (value_of(value) == 0.0) {
      throw std::invalid_argument(
          "inverse_involute: value = 0 rad, allowed with derivatives: above 0");
    }
    // A Newton step at the converged value makes the first derivatives exact, a second step those
    // up to the third.
    for (int step = 0; step < 2; ++step) {
      const T t = tan(a);
      a = a - (t - a - value) / (t * t);
    }
  }
  return a;
}

#define INSTANTIATE(T)              \
  template T involute<T>(const T&); \
  template T inverse_involute<T>(const T&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::geometry
