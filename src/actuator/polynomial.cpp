#include "actuator/polynomial.hpp"

#include <cmath>

namespace gear3k::actuator {

namespace {

double quartic_at(const Quartic& p, double x) {
  return p[0] + x * (p[1] + x * (p[2] + x * (p[3] + x * p[4])));
}

void append_inside(double x, std::vector<double>& roots) {
  if (x > 0.0 && x < 1.0) roots.push_back(x);
}

/// b + c x + d x² without cancellation.
void append_quadratic(double b, double c, double d, std::vector<double>& roots) {
  const double discriminant = c * c - 4.0 * d * b;
  if (!(discriminant > 0.0)) return;
  const double q = -0.5 * (c + std::copysign(std::sqrt(discriminant), c));
  double first = q / d;
  double second = q == 0.0 ? -first : b / q;
  if (first > second) std::swap(first, second);
  append_inside(first, roots);
  append_inside(second, roots);
}

/// The root between two points of unlike sign.
double bisect(const Quartic& p, double low, double high) {
  const bool rises = quartic_at(p, low) < 0.0;
  constexpr int kHalvings = 60;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    ((quartic_at(p, middle) < 0.0) == rises ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Quadratic through(double at_0, double at_half, double at_1) {
  const double curvature = 2.0 * ((at_0 - at_half) + (at_1 - at_half));
  return {at_0, (at_1 - at_0) - curvature, curvature};
}

// NOLINTNEXTLINE(misc-no-recursion): once per degree
void append_roots(const Quartic& p, std::vector<double>& roots) {
  if (p[4] == 0.0 && p[3] == 0.0) {
    if (p[2] != 0.0) {
      append_quadratic(p[0], p[1], p[2], roots);
    } else if (p[1] != 0.0) {
      append_inside(-p[0] / p[1], roots);
    }
    return;
  }
  std::vector<double> ends{0.0};
  append_sign_changes(Quartic{p[1], 2.0 * p[2], 3.0 * p[3], 4.0 * p[4], 0.0}, ends);
  ends.push_back(1.0);
  for (std::size_t k = 1; k < ends.size(); ++k) {
    if (quartic_at(p, ends[k - 1]) * quartic_at(p, ends[k]) < 0.0) {
      append_inside(bisect(p, ends[k - 1], ends[k]), roots);
    }
  }
}

}  // namespace gear3k::actuator
