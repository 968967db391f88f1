#pragma once
// The scalar types that every formula of gear3k is instantiated for: `double`, first derivatives
// (Jet1) and second derivatives (Jet2 = Jet of Jets).

#include <ceres/jet.h>

#include <cmath>
#include <type_traits>

namespace ceres {
// Ceres 2.1 has no operators between a nested Jet and a plain number; with these, a formula reads
// the same for every scalar type.  Each is exact (no derivative is lost: a number has none).
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator+(const Jet<Jet<T, M>, N>& f, double s) {
  return Jet<Jet<T, M>, N>(f.a + s, f.v);
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator+(double s, const Jet<Jet<T, M>, N>& f) {
  return Jet<Jet<T, M>, N>(f.a + s, f.v);
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator-(const Jet<Jet<T, M>, N>& f, double s) {
  return Jet<Jet<T, M>, N>(f.a - s, f.v);
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator-(double s, const Jet<Jet<T, M>, N>& f) {
  return Jet<Jet<T, M>, N>(s - f.a, -f.v);
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator*(const Jet<Jet<T, M>, N>& f, double s) {
  Jet<Jet<T, M>, N> result;
  result.a = f.a * s;
  for (int k = 0; k < N; ++k) result.v[k] = f.v[k] * s;
  return result;
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator*(double s, const Jet<Jet<T, M>, N>& f) {
  return f * s;
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator/(const Jet<Jet<T, M>, N>& f, double s) {
  return f * (1.0 / s);
}
template <class T, int M, int N>
Jet<Jet<T, M>, N> operator/(double s, const Jet<Jet<T, M>, N>& f) {
  return Jet<Jet<T, M>, N>(Jet<T, M>(T(s))) / f;
}
}  // namespace ceres

namespace gear3k {

/// Most design variables that one derivative pass carries: five profile shifts, two working
/// angles and a module.
inline constexpr int kMaxVariables = 8;

using Jet1 = ceres::Jet<double, kMaxVariables>;  ///< value and gradient
using Jet2 = ceres::Jet<Jet1, kMaxVariables>;    ///< value, gradient and Hessian

/// The number under a scalar, without its derivatives.
inline double value_of(double x) { return x; }
template <class T, int N>
double value_of(const ceres::Jet<T, N>& x) {
  return value_of(x.a);
}

/// A scalar with the given value and no derivatives.
template <class T>
T constant(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return value;
  } else {
    return T(constant<typename T::Scalar>(value));
  }
}

/// Whether a parameter has its neutral value and no derivatives, so that it may be left out.
template <class T>
bool is_neutral(const T& parameter, double neutral) {
  if constexpr (std::is_floating_point_v<T>) {
    return parameter == neutral;
  } else {
    if (!is_neutral(parameter.a, neutral)) return false;
    for (int k = 0; k < T::DIMENSION; ++k) {
      if (!is_neutral(parameter.v[k], 0.0)) return false;
    }
    return true;
  }
}

/// The larger (smaller) of two scalars with its derivatives; the first one at a tie.
template <class T>
T larger(const T& a, const T& b) {
  return value_of(a) >= value_of(b) ? a : b;
}
template <class T>
T smaller(const T& a, const T& b) {
  return value_of(a) <= value_of(b) ? a : b;
}

}  // namespace gear3k

/// Instantiates a function template for all scalar types: pass a macro that takes the type.
#define GEAR3K_FOR_EACH_SCALAR(instantiate) \
  instantiate(double) instantiate(::gear3k::Jet1) instantiate(::gear3k::Jet2)
