#include "strength/life_factor.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

namespace gear3k::strength {

namespace {

struct LifePoint {
  double cycles, factor;
};
constexpr double kLongestLife = 1e10;

constexpr std::array<LifePoint, 3> kSoftRoot{{{1e4, 2.5}, {3e6, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 3> kHardRoot{{{1e3, 2.5}, {3e6, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 3> kNitridedRoot{{{1e3, 1.6}, {3e6, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 3> kNitrocarburisedRoot{
    {{1e3, 1.1}, {3e6, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 3> kSteelFlank{{{1e5, 1.6}, {5e7, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 4> kPittedFlank{
    {{6e5, 1.6}, {1e7, 1.3}, {1e9, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 3> kNitridedFlank{{{1e5, 1.3}, {2e6, 1.0}, {kLongestLife, 0.85}}};
constexpr std::array<LifePoint, 3> kNitrocarburisedFlank{
    {{1e5, 1.1}, {2e6, 1.0}, {kLongestLife, 0.85}}};

template <class T>
Factor<T> on_life_curve(std::span<const LifePoint> points, const T& cycles) {
  using std::exp, std::log;
  const double n = value_of(cycles);
  Factor<T> factor{.source = sources::kDrivetrain};
  if (n <= points.front().cycles) {
    factor.value = constant<T>(points.front().factor);
    factor.branch = "static";
    return factor;
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    const LifePoint& a = points[i - 1];
    const LifePoint& b = points[i];
    if (n > b.cycles) continue;
    const double exponent = std::log(b.factor / a.factor) / std::log(b.cycles / a.cycles);
    factor.value = a.factor * exp(exponent * log(cycles / a.cycles));
    factor.branch = a.factor > 1.0 ? "finite life" : "long life";
    return factor;
  }
  factor.value = constant<T>(points.back().factor);
  factor.branch = "beyond 1e10 cycles";
  factor.in_range = false;
  return factor;
}

template <class T>
void check_cycles(const T& cycles) {
  if (!(value_of(cycles) >= 0.0)) {
    throw std::invalid_argument(
        fmt::format("life factor: load cycles = {}, allowed: 0 or more", value_of(cycles)));
  }
}

template <class T>
Factor<T> no_life_curve(LifeCurve curve) {
  if (curve == LifeCurve::kPlastic) {
    return {.branch = "life is in the material's limit", .source = sources::kGearPie};
  }
  return {.branch = "no life curve stated", .source = sources::kNotStated};
}

}  // namespace

template <class T>
Factor<T> root_life_factor(MaterialGroup group, LifeCurve curve, const T& cycles) {
  check_cycles(cycles);
  switch (curve) {
    case LifeCurve::kSteel:
      return group == MaterialGroup::kCaseHardened || group == MaterialGroup::kInduction
                 ? on_life_curve<T>(kHardRoot, cycles)
                 : on_life_curve<T>(kSoftRoot, cycles);
    case LifeCurve::kNitrided:
      return on_life_curve<T>(kNitridedRoot, cycles);
    case LifeCurve::kNitrocarburised:
      return on_life_curve<T>(kNitrocarburisedRoot, cycles);
    case LifeCurve::kNone:
    case LifeCurve::kPlastic:
      break;
  }
  return no_life_curve<T>(curve);
}

template <class T>
Factor<T> flank_life_factor(LifeCurve curve, bool pitting_allowed, const T& cycles) {
  check_cycles(cycles);
  switch (curve) {
    case LifeCurve::kSteel:
      return pitting_allowed ? on_life_curve<T>(kPittedFlank, cycles)
                             : on_life_curve<T>(kSteelFlank, cycles);
    case LifeCurve::kNitrided:
      return on_life_curve<T>(kNitridedFlank, cycles);
    case LifeCurve::kNitrocarburised:
      return on_life_curve<T>(kNitrocarburisedFlank, cycles);
    case LifeCurve::kNone:
    case LifeCurve::kPlastic:
      break;
  }
  return no_life_curve<T>(curve);
}

#define INSTANTIATE(T)                                                        \
  template Factor<T> root_life_factor<T>(MaterialGroup, LifeCurve, const T&); \
  template Factor<T> flank_life_factor<T>(LifeCurve, bool, const T&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::strength
