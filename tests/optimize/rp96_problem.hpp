#pragma once
// The reference problem RP-96 typed anew from docs/rp96.md, in doubles and modules of stage 1; it
// shares no code with the library.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rp96 {

struct Point {
  int zS, zP1, zR1, zP2, zR2;
  double xS, xP1, xR1, xP2, xR2;
  double m2, d;  // m1 = 1
};

struct Values {
  double eta_b = 0.0, eta_f = 0.0;
  double worst_margin = 0.0;  // of all constraints, each of order 1; negative = infeasible
};

inline double inv(double a) { return std::tan(a) - a; }

inline Values evaluate(const Point& p) {
  const double alpha = 20.0 * std::numbers::pi / 180.0;
  const double ca = std::cos(alpha);
  const double sa = std::sin(alpha);
  const double mu = 0.1;
  double worst = 1e9;
  const auto at_least = [&](double value, double limit) { worst = std::min(worst, value - limit); };

  struct Mesh {
    double m, z1, z2, x1, x2;
    bool ring;
  };
  const std::array<Mesh, 3> meshes{{{1.0, 1.0 * p.zS, 1.0 * p.zP1, p.xS, p.xP1, false},
                                    {1.0, 1.0 * p.zP1, 1.0 * p.zR1, p.xP1, p.xR1, true},
                                    {p.m2, 1.0 * p.zP2, 1.0 * p.zR2, p.xP2, p.xR2, true}}};
  std::array<double, 3> j{}, eta{};
  for (int k = 0; k < 3; ++k) {
    const Mesh& g = meshes[static_cast<std::size_t>(k)];
    const double rb1 = 0.5 * g.m * g.z1 * ca;
    const double rb2 = 0.5 * g.m * g.z2 * ca;
    const double cos_w = (g.ring ? rb2 - rb1 : rb2 + rb1) / p.d;
    if (!(cos_w > 0.0 && cos_w < 1.0)) return {.worst_margin = -1.0};
    const double aw = std::acos(cos_w);
    const double ra1 = g.m * (0.5 * g.z1 + 1.0 + g.x1);
    const double ra2 = g.m * (0.5 * g.z2 + (g.ring ? -1.0 : 1.0) + g.x2);
    const double rho1 = std::sqrt(ra1 * ra1 - rb1 * rb1);
    const double rho2 = std::sqrt(std::max(0.0, ra2 * ra2 - rb2 * rb2));
    const double pb = std::numbers::pi * g.m * ca;
    const double e1 = (rho1 - rb1 * std::tan(aw)) / pb;
    const double e2 = (g.ring ? rb2 * std::tan(aw) - rho2 : rho2 - rb2 * std::tan(aw)) / pb;
    // Backlash from tooth thicknesses on the working circles.
    const double rw1 = rb1 / cos_w;
    const double s1 =
        2.0 * rw1 *
        ((std::numbers::pi / 2.0 + 2.0 * g.x1 * std::tan(alpha)) / g.z1 + inv(alpha) - inv(aw));
    const double rw2 = rb2 / cos_w;
    const double s2 = g.ring ? 2.0 * rw2 *
                                   ((std::numbers::pi / 2.0 - 2.0 * g.x2 * std::tan(alpha)) / g.z2 -
                                    inv(alpha) + inv(aw))
                             : 2.0 * rw2 *
                                   ((std::numbers::pi / 2.0 + 2.0 * g.x2 * std::tan(alpha)) / g.z2 +
                                    inv(alpha) - inv(aw));
    j[static_cast<std::size_t>(k)] = (2.0 * std::numbers::pi * rw1 / g.z1 - s1 - s2) * std::cos(aw);
    at_least(j[static_cast<std::size_t>(k)], 0.0);
    at_least(e1 + e2, 1.2);
    at_least(2.0, e1 + e2);
    const double b = 1.0 - (e1 + e2) + e1 * e1 + e2 * e2;
    eta[static_cast<std::size_t>(k)] =
        1.0 - mu * std::numbers::pi * (1.0 / g.z1 + (g.ring ? -1.0 : 1.0) / g.z2) * b;
    if (g.ring) {
      at_least(rho2, p.d * std::sin(aw));
      at_least(ra2, rb2);
    } else {
      at_least(p.d * std::sin(aw), rho1);
      at_least(p.d * std::sin(aw), rho2);
    }
  }
  struct External {
    double m, z, x;
  };
  for (const External& g :
       {External{1.0, 1.0 * p.zS, p.xS}, {1.0, 1.0 * p.zP1, p.xP1}, {p.m2, 1.0 * p.zP2, p.xP2}}) {
    const double ra = g.m * (0.5 * g.z + 1.0 + g.x);
    const double aa = std::acos(0.5 * g.m * g.z * ca / ra);
    const double s =
        2.0 * ra *
        ((std::numbers::pi / 2.0 + 2.0 * g.x * std::tan(alpha)) / g.z + inv(alpha) - inv(aa));
    at_least(s / g.m, 0.25);
    at_least(g.x, 1.0 - g.z * sa * sa / 2.0);
  }
  const double spacing = 2.0 * p.d * std::sin(std::numbers::pi / 3.0);
  at_least(spacing - 2.0 * (0.5 * p.zP1 + 1.0 + p.xP1), 0.5);
  at_least(spacing - 2.0 * p.m2 * (0.5 * p.zP2 + 1.0 + p.xP2), 0.5);
  const double g1 = 1.0 * p.zR1 / p.zS;
  const double g2 = 1.0 * p.zP2 * p.zR1 / (1.0 * p.zP1 * p.zR2);
  const double ratio = (1.0 + g1) / (1.0 - g2);
  const double arcmin = std::numbers::pi / 180.0 / 60.0;
  const double phi1 = j[0] / ca / (ratio * p.zS / 2.0);
  const double phi2 = j[1] / ca / (p.zR1 / 2.0);
  const double phi3 = j[2] / ca / (p.m2 * p.zR2 / 2.0);
  at_least(1.0, (phi1 + std::max(phi2, phi3)) / (8.0 * arcmin));
  for (const double x : {p.xS, p.xP1, p.xR1, p.xP2, p.xR2}) {
    at_least(x, 0.0);
    at_least(1.0, x);
  }
  Values v;
  v.worst_margin = worst;
  v.eta_f = (1.0 + eta[0] * eta[1] * g1) * (1.0 - g2) / ((1.0 + g1) * (1.0 - eta[1] * eta[2] * g2));
  v.eta_b =
      eta[0] * (1.0 + g1) * (eta[1] * eta[2] - g2) / (eta[2] * (g1 + eta[0] * eta[1]) * (1.0 - g2));
  return v;
}

}  // namespace rp96
