#pragma once
// Polynomials of low degree on the unit interval, and where they change sign.

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace gear3k::actuator {

/// Nodes and weights of Gauss on [0, 1], exact to degree five: 1/2 and 1/2 ± √(3/5)/2.
inline constexpr double kGaussOffset = 0.38729833462074168852;
inline constexpr std::array<double, 3> kGaussNodes{0.5 - kGaussOffset, 0.5, 0.5 + kGaussOffset};
inline constexpr std::array<double, 3> kGaussWeights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

/// Σ c_k x^k.
using Quadratic = std::array<double, 3>;
using Quartic = std::array<double, 5>;

constexpr double value_at(const Quadratic& p, double x) { return p[0] + x * (p[1] + x * p[2]); }
constexpr double slope_at(const Quadratic& p, double x) { return p[1] + 2.0 * x * p[2]; }

/// The quadratic through values at 0, 1/2 and 1.
Quadratic through(double at_0, double at_half, double at_1);
/// Product of two.
constexpr Quartic product(const Quadratic& a, const Quadratic& b) {
  return {a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0],
          a[1] * b[2] + a[2] * b[1], a[2] * b[2]};
}

/// append_sign_changes() without its early end.
void append_roots(const Quartic& p, std::vector<double>& roots);

/// Appends the roots within (0, 1) at which a polynomial changes sign, ascending.
///
/// The sign of the coefficients does not change a bit of them.  Accuracy: rounding of the
/// polynomial's value.
inline void append_sign_changes(const Quartic& p, std::vector<double>& roots) {
  // The constant outweighs all others on [0, 1].
  if (std::abs(p[0]) > std::abs(p[1]) + std::abs(p[2]) + std::abs(p[3]) + std::abs(p[4])) return;
  append_roots(p, roots);
}
inline void append_sign_changes(const Quadratic& p, std::vector<double>& roots) {
  if (std::abs(p[0]) > std::abs(p[1]) + std::abs(p[2])) return;
  append_roots({p[0], p[1], p[2], 0.0, 0.0}, roots);
}

/// A sum that keeps what rounding takes away (Neumaier).
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    rest_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  [[nodiscard]] double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0.0, rest_ = 0.0;
};

/// Many of them, with the same values: the rest of each addition by Knuth's formula, which is as
/// exact and needs no branch.
template <std::size_t kCount>
class CompensatedSums {
 public:
  void add(const std::array<double, kCount>& terms) {
    for (std::size_t k = 0; k < kCount; ++k) {
      const double sum = sums_[k] + terms[k];
      const double taken = sum - sums_[k];
      rests_[k] += (sums_[k] - (sum - taken)) + (terms[k] - taken);
      sums_[k] = sum;
    }
  }
  [[nodiscard]] double value(std::size_t k) const { return sums_[k] + rests_[k]; }

 private:
  std::array<double, kCount> sums_{}, rests_{};
};

}  // namespace gear3k::actuator
