#include "geometry/jet2.hpp"

#include <algorithm>
#include <cmath>

namespace gear3k {

namespace {

constexpr std::size_t kCount = Jet2::kCount;

/// f and its derivatives at one number.
struct Function1 {
  double f, f_x, f_xx;
};
/// The same at two.
struct Function2 {
  double f, f_x, f_y, f_xx, f_xy, f_yy;
};

/// f(x): ∂²f/∂r∂c = f_x ∂²x/∂r∂c + f_xx ∂x/∂r ∂x/∂c.
Jet2 chain(const Function1& at, const Jet2& x) {
  Jet2 f(at.f);
  for (std::size_t i = 0; i < kCount; ++i) {
    f.by_row[i] = at.f_x * x.by_row[i];
    f.by_column[i] = at.f_x * x.by_column[i];
    const double curved = at.f_xx * x.by_row[i];
    for (std::size_t j = 0; j < kCount; ++j) {
      f.mixed[i][j] = at.f_x * x.mixed[i][j] + curved * x.by_column[j];
    }
  }
  return f;
}

/// f(x, y), likewise.
Jet2 chain(const Function2& at, const Jet2& x, const Jet2& y) {
  Jet2 f(at.f);
  for (std::size_t i = 0; i < kCount; ++i) {
    f.by_row[i] = at.f_x * x.by_row[i] + at.f_y * y.by_row[i];
    f.by_column[i] = at.f_x * x.by_column[i] + at.f_y * y.by_column[i];
    const double f_x_by_row = at.f_xx * x.by_row[i] + at.f_xy * y.by_row[i];
    const double f_y_by_row = at.f_xy * x.by_row[i] + at.f_yy * y.by_row[i];
    for (std::size_t j = 0; j < kCount; ++j) {
      f.mixed[i][j] = (at.f_x * x.mixed[i][j] + at.f_y * y.mixed[i][j]) +
                      (f_x_by_row * x.by_column[j] + f_y_by_row * y.by_column[j]);
    }
  }
  return f;
}

/// a x + b y
Jet2 sum(double a, const Jet2& x, double b, const Jet2& y) {
  Jet2 f(a * x.value + b * y.value);
  for (std::size_t i = 0; i < kCount; ++i) {
    f.by_row[i] = a * x.by_row[i] + b * y.by_row[i];
    f.by_column[i] = a * x.by_column[i] + b * y.by_column[i];
    for (std::size_t j = 0; j < kCount; ++j) {
      f.mixed[i][j] = a * x.mixed[i][j] + b * y.mixed[i][j];
    }
  }
  return f;
}

template <class Test>
bool all_derivatives(const Jet2& x, const Test& test) {
  return std::ranges::all_of(x.by_row, test) && std::ranges::all_of(x.by_column, test) &&
         std::ranges::all_of(
             x.mixed, [&](const Jet2::Slopes& row) { return std::ranges::all_of(row, test); });
}

}  // namespace

Jet2 Jet2::variable(double x, std::size_t k) {
  Jet2 f(x);
  f.by_row.at(k) = f.by_column.at(k) = 1.0;
  return f;
}

Jet2& Jet2::operator+=(const Jet2& y) { return *this = *this + y; }
Jet2& Jet2::operator-=(const Jet2& y) { return *this = *this - y; }
Jet2& Jet2::operator*=(const Jet2& y) { return *this = *this * y; }
Jet2& Jet2::operator/=(const Jet2& y) { return *this = *this / y; }

Jet2 operator-(const Jet2& x) { return chain({-x.value, -1.0, 0.0}, x); }
Jet2 operator+(const Jet2& x, const Jet2& y) { return sum(1.0, x, 1.0, y); }
Jet2 operator-(const Jet2& x, const Jet2& y) { return sum(1.0, x, -1.0, y); }
Jet2 operator+(const Jet2& x, double y) {
  Jet2 f = x;
  f.value += y;
  return f;
}
Jet2 operator+(double x, const Jet2& y) { return y + x; }
Jet2 operator-(const Jet2& x, double y) { return x + -y; }
Jet2 operator-(double x, const Jet2& y) { return -y + x; }

Jet2 operator*(const Jet2& x, const Jet2& y) {
  return chain({x.value * y.value, y.value, x.value, 0.0, 1.0, 0.0}, x, y);
}
Jet2 operator*(const Jet2& x, double y) { return chain({x.value * y, y, 0.0}, x); }
Jet2 operator*(double x, const Jet2& y) { return y * x; }

Jet2 operator/(const Jet2& x, const Jet2& y) {
  const double f = x.value / y.value;
  const double f_x = 1.0 / y.value;
  return chain({f, f_x, -f * f_x, 0.0, -f_x * f_x, 2.0 * f * f_x * f_x}, x, y);
}
Jet2 operator/(const Jet2& x, double y) { return chain({x.value / y, 1.0 / y, 0.0}, x); }
Jet2 operator/(double x, const Jet2& y) {
  const double f = x / y.value;
  return chain({f, -f / y.value, 2.0 * f / (y.value * y.value)}, y);
}

Jet2 abs(const Jet2& x) { return std::signbit(x.value) ? -x : x; }
Jet2 sqrt(const Jet2& x) {
  const double f = std::sqrt(x.value);
  const double f_x = 0.5 / f;
  return chain({f, f_x, -f_x / (2.0 * x.value)}, x);
}
Jet2 exp(const Jet2& x) {
  const double f = std::exp(x.value);
  return chain({f, f, f}, x);
}
Jet2 log(const Jet2& x) {
  const double f_x = 1.0 / x.value;
  return chain({std::log(x.value), f_x, -f_x * f_x}, x);
}
Jet2 sin(const Jet2& x) {
  const double f = std::sin(x.value);
  return chain({f, std::cos(x.value), -f}, x);
}
Jet2 cos(const Jet2& x) {
  const double f = std::cos(x.value);
  return chain({f, -std::sin(x.value), -f}, x);
}
Jet2 tan(const Jet2& x) {
  const double f = std::tan(x.value);
  const double f_x = 1.0 + f * f;
  return chain({f, f_x, 2.0 * f * f_x}, x);
}
Jet2 asin(const Jet2& x) {
  const double f_x = 1.0 / std::sqrt((1.0 - x.value) * (1.0 + x.value));
  return chain({std::asin(x.value), f_x, x.value * f_x * f_x * f_x}, x);
}
Jet2 acos(const Jet2& x) {
  const double f_x = -1.0 / std::sqrt((1.0 - x.value) * (1.0 + x.value));
  return chain({std::acos(x.value), f_x, x.value * f_x * f_x * f_x}, x);
}
Jet2 atan(const Jet2& x) {
  const double f_x = 1.0 / (1.0 + x.value * x.value);
  return chain({std::atan(x.value), f_x, -2.0 * x.value * f_x * f_x}, x);
}
Jet2 atan2(const Jet2& y, const Jet2& x) {
  // With s = x² + y²: ∂/∂y = x/s, ∂/∂x = −y/s.
  const double s = x.value * x.value + y.value * y.value;
  const double f_y = x.value / s;
  const double f_x = -y.value / s;
  return chain({.f = std::atan2(y.value, x.value),
                .f_x = f_y,
                .f_y = f_x,
                .f_xx = 2.0 * f_y * f_x,
                .f_xy = f_x * f_x - f_y * f_y,
                .f_yy = -2.0 * f_y * f_x},
               y, x);
}
Jet2 pow(const Jet2& x, double p) {
  return chain({std::pow(x.value, p), p * std::pow(x.value, p - 1.0),
                p * (p - 1.0) * std::pow(x.value, p - 2.0)},
               x);
}

bool all_finite(const Jet2& x) {
  return std::isfinite(x.value) &&
         all_derivatives(x, [](double derivative) { return std::isfinite(derivative); });
}

bool is_neutral(const Jet2& x, double neutral) {
  return x.value == neutral &&
         all_derivatives(x, [](double derivative) { return derivative == 0.0; });
}

}  // namespace gear3k
