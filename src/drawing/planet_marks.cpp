#include "drawing/planet_marks.hpp"

#include <numbers>

namespace gear3k::drawing {

std::vector<PlanetMarks> planet_marks(const train::ToothSet& z, int planets) {
  const bool all = train::assembly(z, planets).equal_spacing;
  const long long n = planets;
  const long long p1 = z.P1;
  const long long p2 = z.P2;
  const auto remainder = [](long long a, long long m) { return ((a % m) + m) % m; };
  std::vector<PlanetMarks> marks;
  for (long long i = 0; i < (all ? n : 1); ++i) {
    // ψ = θ_i (1 − zR/zP) = 2π i (zP − zR)/(N zP), modulo a tooth
    const long long a = remainder(i * (p1 - z.R1), n);
    const long long b = remainder(i * (p2 - z.R2), n);
    long long best_k = 0;
    long long best = -1;
    for (long long k = 0; k < p1; ++k) {
      const long long beyond = remainder(b * p1 - (a + k * n) * p2, n * p1);
      if (best < 0 || beyond < best) {
        best = beyond;
        best_k = k;
      }
    }
    const double turn = 2.0 * std::numbers::pi;
    // In whole numbers, where 0 has no sign.
    long long from_axis = remainder(a + best_k * n - i * p1, n * p1);
    if (2 * from_axis > n * p1) from_axis -= n * p1;
    marks.push_back(
        {.p1_rad = turn * static_cast<double>(a + best_k * n) / static_cast<double>(n * p1),
         .p1_from_axis_rad = turn * static_cast<double>(from_axis) / static_cast<double>(n * p1),
         .phase_rad = turn * static_cast<double>(best) / static_cast<double>(n * p1 * p2)});
  }
  return marks;
}

}  // namespace gear3k::drawing
