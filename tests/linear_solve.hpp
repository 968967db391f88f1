#pragma once
// Small linear systems of witnesses.

#include <Eigen/Core>
#include <cmath>
#include <utility>

namespace gear3k::test {

/// x of A x = b by Gaussian elimination with rows exchanged for the largest pivot; not finite where
/// A is singular.  Takes a few milliseconds to compile, a factorisation of Eigen's a second.
template <class Matrix, class Vector>
Vector solved(Matrix a, Vector b) {
  const Eigen::Index n = a.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < n; ++i) {
      if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
    }
    for (Eigen::Index j = k; j < n; ++j) std::swap(a(k, j), a(pivot, j));
    std::swap(b(k), b(pivot));
    for (Eigen::Index i = k + 1; i < n; ++i) {
      const auto factor = a(i, k) / a(k, k);
      for (Eigen::Index j = k + 1; j < n; ++j) a(i, j) -= factor * a(k, j);
      b(i) -= factor * b(k);
    }
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    for (Eigen::Index j = k + 1; j < n; ++j) b(k) -= a(k, j) * b(j);
    b(k) /= a(k, k);
  }
  return b;
}

}  // namespace gear3k::test
