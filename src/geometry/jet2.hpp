#pragma once
// Second derivatives: value, gradient and Hessian as one scalar.  Its operators are calls, not
// inlined loops over 81 numbers: formulas are evaluated with it by Ipopt only, and take less to
// compile so.

#include <array>
#include <cstddef>

namespace gear3k {

/// Most design variables that one derivative pass carries: five profile shifts, two working
/// angles and a module.
inline constexpr int kMaxVariables = 8;

/// A value f(x) with its derivatives in the directions r₁ … r₈ and c₁ … c₈, and the mixed ones:
///
///   by_row[i] = ∂f/∂rᵢ,  by_column[j] = ∂f/∂cⱼ,  mixed[i][j] = ∂²f/∂rᵢ∂cⱼ.
///
/// With r = c = x these are the gradient twice and the Hessian; with r and c in different variables
/// they are a block of the Hessian of more than kMaxVariables variables.  Exact to rounding: each
/// operator and function below has its chain rule.  Where a function has no derivative (sqrt at 0,
/// acos at ±1) those of the result are not finite.
struct Jet2 {
  static constexpr std::size_t kCount = kMaxVariables;
  using Slopes = std::array<double, kCount>;

  double value = 0.0;
  Slopes by_row{}, by_column{};
  std::array<Slopes, kCount> mixed{};

  Jet2() = default;
  /// A number: no derivatives.
  explicit Jet2(double number) : value(number) {}
  /// The variable x_k in the directions r = c = x.
  /// @param k  0 … kMaxVariables − 1
  static Jet2 variable(double x, std::size_t k);

  Jet2& operator+=(const Jet2& y);
  Jet2& operator-=(const Jet2& y);
  Jet2& operator*=(const Jet2& y);
  Jet2& operator/=(const Jet2& y);
};

Jet2 operator-(const Jet2& x);
Jet2 operator+(const Jet2& x, const Jet2& y);
Jet2 operator+(const Jet2& x, double y);
Jet2 operator+(double x, const Jet2& y);
Jet2 operator-(const Jet2& x, const Jet2& y);
Jet2 operator-(const Jet2& x, double y);
Jet2 operator-(double x, const Jet2& y);
Jet2 operator*(const Jet2& x, const Jet2& y);
Jet2 operator*(const Jet2& x, double y);
Jet2 operator*(double x, const Jet2& y);
Jet2 operator/(const Jet2& x, const Jet2& y);
Jet2 operator/(const Jet2& x, double y);
Jet2 operator/(double x, const Jet2& y);

/// |x|; at 0 by its sign: as right of 0 at +0.0, as left of it at −0.0.
Jet2 abs(const Jet2& x);
Jet2 sqrt(const Jet2& x);
Jet2 exp(const Jet2& x);
Jet2 log(const Jet2& x);
Jet2 sin(const Jet2& x);
Jet2 cos(const Jet2& x);
Jet2 tan(const Jet2& x);
Jet2 asin(const Jet2& x);
Jet2 acos(const Jet2& x);
Jet2 atan(const Jet2& x);
Jet2 atan2(const Jet2& y, const Jet2& x);
/// x^p for a plain exponent.
Jet2 pow(const Jet2& x, double p);

/// Whether the value and all derivatives are finite.
bool all_finite(const Jet2& x);
/// Whether x is the number `neutral`, without derivatives.
bool is_neutral(const Jet2& x, double neutral);

}  // namespace gear3k
