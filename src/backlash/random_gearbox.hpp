#pragma once
// Deviations of built gearboxes by the number of the gearbox: no state, any order.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "backlash/clearance_model.hpp"
#include "backlash/gearbox_batch.hpp"

namespace gear3k::backlash {

/// How deviations scatter within their limits.
struct ScatterOptions {
  Scatter scatter = Scatter::kNormal;
  double sigma_level = 3.0;  ///< standard deviations from the middle to a limit, of kNormal
};

/// Function of (0, 1) as cubic Hermite pieces on cells whose width halves from octave to octave
/// towards both ends.
///
/// Arguments are the middles (r + 1/2)/2³² of 32-bit numbers r.  Truncation: (w/32)⁴ f⁗/384 where w
/// is the distance from the nearer end.
class OctaveTable {
 public:
  struct Node {
    double value = 0.0, slope = 0.0;
  };
  /// @param from_start,from_end  Node(double x), 0 < x ≤ 1/2: the function and its derivative at x
  /// and at 1 − x, each accurate for small x; the slope is by the argument of the function
  template <class FromStart, class FromEnd>
  OctaveTable(FromStart from_start, FromEnd from_end) : cells_(2U * kHalf) {
    for (std::size_t k = 0; k < kHalf; ++k) {
      const double x = 0x1p-32 * place(k);
      const double end = 0x1p-32 * place(k + 1);
      cells_[k] = cubic(k, from_start(x), from_start(end), 1.0);
      cells_[kHalf + k] = cubic(k, from_end(x), from_end(end), -1.0);
    }
  }

  [[nodiscard]] double operator()(std::uint32_t r) const {
    // Distance from the nearer end in units of 2⁻³²: its leading bits are the cell.
    const std::uint32_t half = r >> 31U;
    const auto n = static_cast<std::int32_t>(r ^ (0U - half));
    const double x = static_cast<double>(n) + 0.5;
    const auto k =
        static_cast<std::size_t>(std::bit_cast<std::uint64_t>(x) >> kShift) - kFirst + half * kHalf;
    const std::array<double, 4>& c = cells_[k];
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
  }

 private:
  static constexpr unsigned kBits = 5;  ///< 2⁵ cells an octave
  static constexpr unsigned kShift = 52U - kBits;
  static constexpr std::size_t kFirst = 1022U << kBits;  ///< of x = 1/2
  static constexpr std::size_t kHalf = 32U << kBits;
  /// Where cell k begins.
  static double place(std::size_t k) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(k + kFirst) << kShift);
  }
  /// Coefficients of powers of x itself; what cancels in them is a few rounding errors.
  static std::array<double, 4> cubic(std::size_t k, const Node& a, const Node& b, double direction);

  std::vector<std::array<double, 4>> cells_;
};

/// Points of the unit circle by 32-bit number: direction 2π (r + 1/2)/2³² to 5e-12, radius to
/// rounding.
class UnitCircleTable {
 public:
  UnitCircleTable();
  struct Point {
    double x = 0.0, y = 0.0;
  };
  [[nodiscard]] Point operator()(std::uint32_t r) const {
    const Point& middle = middles_[r >> 24U];
    const double d =
        kRadians * (static_cast<double>(static_cast<std::int32_t>(r & 0xFFFFFFU)) - 8388607.5);
    const double d2 = d * d;
    const double cos = 1.0 - d2 * (1.0 / 2.0 - d2 * (1.0 / 24.0));
    const double sin = d * (1.0 - d2 * (1.0 / 6.0));
    return {.x = middle.x * cos - middle.y * sin, .y = middle.y * cos + middle.x * sin};
  }

 private:
  static constexpr double kRadians = 0x1p-31 * std::numbers::pi;
  std::array<Point, 256> middles_{};
};

/// Deviations of the gearboxes of a series.
///
/// Counter-based: the numbers of a gearbox are Philox4x64-10 of its index, with the seed and the
/// stream as key, so that they depend on nothing else.  Each component of a deviation takes 32
/// bits.  Through quantile functions of
///
///   numbers: normal with σ = half width/sigma_level, cut off at the limits; or uniform,
///   circles: radius of a plane normal distribution with that σ per component, cut off at the
///            circle, or of points spread evenly over it; direction uniform.
///
/// Source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011);
/// library Random123.  Truncation: 2e-7 of the half width at sigma_level ≤ 6 (tables tested against
/// Boost's quantiles).  No value lies beyond its limits.
class RandomGearbox {
 public:
  /// @throws std::invalid_argument unless sigma_level > 0
  RandomGearbox(const ClearanceModel& model, const ScatterOptions& scatter, std::uint64_t seed,
                std::uint64_t stream = 0);

  /// Gearboxes first … first + kBatch − 1: components of their deviations, in the order of
  /// GearboxBatch::components().
  void draw(std::uint64_t first, std::vector<Lanes>& components) const;
  /// One of them, for plays(): bit for bit that of draw().
  [[nodiscard]] std::vector<DeviationValue> deviations(std::uint64_t index) const;

 private:
  struct Source {
    double half_width_m = 0.0;
    bool planar = false;
  };
  std::vector<Source> deviations_;
  std::size_t components_ = 0;
  std::array<std::uint64_t, 2> key_{};
  OctaveTable number_, radius_;
  UnitCircleTable direction_;
};

/// Quantile functions on (0, 1) of a number in ±1 and of a radius in [0, 1].
OctaveTable number_table(const ScatterOptions& scatter);
OctaveTable radius_table(const ScatterOptions& scatter);

}  // namespace gear3k::backlash
