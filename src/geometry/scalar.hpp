#pragma once
// The scalar types that every formula of gear3k is instantiated for: `double`, first derivatives
// (Jet1) and second derivatives (Jet2).

#include <ceres/jet.h>

#include <cmath>

#include "geometry/jet2.hpp"

namespace gear3k {

using Jet1 = ceres::Jet<double, kMaxVariables>;  ///< value and gradient
/// Value and derivative by one torque: for the balance of a train alone, whose friction is
/// instantiated for it beside the others.
using JetTorque = ceres::Jet<double, 1>;

/// The number under a scalar, without its derivatives.
inline double value_of(double x) { return x; }
template <int N>
double value_of(const ceres::Jet<double, N>& x) {
  return x.a;
}
inline double value_of(const Jet2& x) { return x.value; }

/// A scalar with the given value and no derivatives.
template <class T>
T constant(double value) {
  return T(value);
}

/// Whether a parameter has its neutral value and no derivatives, so that it may be left out.
inline bool is_neutral(double parameter, double neutral) { return parameter == neutral; }
template <int N>
bool is_neutral(const ceres::Jet<double, N>& parameter, double neutral) {
  if (parameter.a != neutral) return false;
  for (int k = 0; k < N; ++k) {
    if (parameter.v[k] != 0.0) return false;
  }
  return true;
}

/// |x| with its derivatives; those of x at 0.
template <class T>
T magnitude(const T& x) {
  return value_of(x) < 0.0 ? T(-x) : x;
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
