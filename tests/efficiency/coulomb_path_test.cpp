#include "efficiency/coulomb_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "efficiency/mesh_loss_slopes.hpp"
#include "efficiency/train_efficiency.hpp"
#include "geometry/mesh.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::efficiency::coulomb_path_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;

using Vector = std::complex<double>;
double dot(Vector a, Vector b) { return (std::conj(a) * b).real(); }
double cross(Vector a, Vector b) { return (std::conj(a) * b).imag(); }
constexpr Vector kQuarterTurn(0.0, 1.0);

/// A pair as its tip circles bound it.  Lengths in base radii of gear 1.
struct PlanePair {
  int z1 = 0, z2 = 0;
  bool ring = false;
  bool gear1_drives = true;
  double alpha_w = 0.0;
  double tip_radius1 = 0.0, tip_radius2 = 0.0;
};

/// Two rigid gears in the plane: centres on the x axis, pitch point at the origin, the driver turns
/// counter-clockwise.
class RigidGears {
 public:
  explicit RigidGears(const PlanePair& p) : p_(p), radius_{1.0, 1.0 * p.z2 / p.z1} {
    const double cosine = std::cos(p.alpha_w);
    center_ = {Vector(-radius_[0] / cosine, 0.0),
               Vector((p.ring ? -1.0 : 1.0) * radius_[1] / cosine, 0.0)};
    // The driver's material at the pitch point moves along +y (gear 1 and ring) or −y.
    const double w_driver = 1.0;
    const std::size_t driver = p.gear1_drives ? 0 : 1;
    const std::size_t driven = 1 - driver;
    const Vector velocity = kQuarterTurn * w_driver * (0.0 - center_[driver]);
    w_[driver] = w_driver;
    w_[driven] = (velocity / (kQuarterTurn * (0.0 - center_[driven]))).real();
    // The normal force on the driven gear points along the velocity, turned by the working angle so
    // that flanks push: contact runs away from the tangent point of gear 1's base circle when
    // gear 1 drives and towards it when it is driven.
    const double turn = p.gear1_drives || !p.ring ? -p.alpha_w : p.alpha_w;
    action_ = std::polar(1.0, turn) * velocity / std::abs(velocity);
    EXPECT_EQ(dot(center_[0], action_) < 0.0, p.gear1_drives);
    for (const std::size_t gear : {driver, driven}) {
      // Of the tip circle's two crossings with the line, the one on the side of the base circle's
      // tangent point on which the flanks lie.
      foot_[gear] = dot(center_[gear], action_);
      const double tip = gear == 0 ? p.tip_radius1 : p.tip_radius2;
      const double half_chord = std::sqrt(tip * tip - radius_[gear] * radius_[gear]);
      crossing_[gear] = foot_[gear] > 0.0 ? foot_[gear] - half_chord : foot_[gear] + half_chord;
    }
  }

  [[nodiscard]] double base_pitch() const { return 2.0 * kPi / p_.z1; }
  /// Path of contact along the direction of motion; in base pitches from the pitch point.
  [[nodiscard]] double begin() const { return crossing_[p_.gear1_drives ? 1 : 0] / base_pitch(); }
  [[nodiscard]] double end() const { return crossing_[p_.gear1_drives ? 0 : 1] / base_pitch(); }

  /// Moments of the contact forces, one newton normal to each pair, on driver and driven gear.
  struct Moments {
    double driver = 0.0, driven = 0.0;
  };
  [[nodiscard]] Moments moments(double s, double mu) const {
    const std::size_t driver = p_.gear1_drives ? 0 : 1;
    const std::size_t driven = 1 - driver;
    const Vector point = s * base_pitch() * action_;
    const Vector velocity1 = kQuarterTurn * w_[driver] * (point - center_[driver]);
    const Vector velocity2 = kQuarterTurn * w_[driven] * (point - center_[driven]);
    const Vector slip = velocity2 - velocity1;
    EXPECT_NEAR(dot(slip, action_), 0.0, 64.0 * kEps * std::abs(velocity1)) << "flanks part";
    const Vector tangent = kQuarterTurn * action_;
    const double sense = dot(slip, tangent) > 0.0 ? 1.0 : -1.0;
    const Vector force = action_ - mu * sense * tangent;  // on the driven gear
    return {.driver = -cross(point - center_[driver], -force) * w_[driver],
            .driven = cross(point - center_[driven], force) * w_[driven]};
  }

  /// Mean of driven over driving power at `steps` rolling positions; 0 where a pair jams.
  [[nodiscard]] double mean_efficiency(double mu, int steps) const {
    double sum = 0.0;
    int positions = 0;
    for (int i = 0; i < steps; ++i) {
      Moments total;
      int pairs = 0;
      for (double s = begin() + (i + 0.5) / steps; s < end(); s += 1.0) {
        const Moments one = moments(s, mu);
        if (one.driver <= 0.0 || one.driven <= 0.0) return 0.0;
        total.driver += one.driver;
        total.driven += one.driven;
        ++pairs;
      }
      if (pairs == 0) continue;
      sum += total.driven / total.driver;
      ++positions;
    }
    return sum / positions;
  }

  /// The same by Gauss's rule between the positions where a pair comes, goes or passes the pitch
  /// point.
  [[nodiscard]] double gauss_mean(double mu) const {
    const double length = end() - begin();
    std::vector<double> ends{0.0, std::min(1.0, length)};
    for (int k = 0; k <= length; ++k) {
      for (const double at : {length - k, -begin() - k}) {
        if (at > 0.0 && at < ends[1]) ends.push_back(at);
      }
    }
    std::ranges::sort(ends);
    const auto efficiency = [&](double ahead) {
      Moments total;
      for (double s = begin() + ahead; s < end(); s += 1.0) {
        const Moments one = moments(s, mu);
        total.driver += one.driver;
        total.driven += one.driven;
      }
      return total.driven / total.driver;
    };
    double sum = 0.0;
    for (std::size_t k = 1; k < ends.size(); ++k) {
      using Rule = boost::math::quadrature::gauss<double, 30>;
      if (ends[k] > ends[k - 1]) sum += Rule::integrate(efficiency, ends[k - 1], ends[k]);
    }
    return sum / ends.back();
  }

  [[nodiscard]] MeshContact<double> contact() const {
    return {.z1 = p_.z1,
            .z2 = p_.z2,
            .sign = p_.ring ? -1.0 : 1.0,
            .approach_contact_ratio = -begin(),
            .recess_contact_ratio = end(),
            .tan_alpha_w = std::tan(p_.alpha_w),
            .gear1_drives = p_.gear1_drives};
  }

 private:
  PlanePair p_;
  std::array<double, 2> radius_, w_{}, foot_{}, crossing_{};
  std::array<Vector, 2> center_;
  Vector action_;
};

class Random {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }
  bool flip() { return count(0, 1) == 1; }

  /// Tip circles that make shares e1, e2 of the contact ratio, in 1/`grid` of a base pitch; empty
  /// where a tip would lie inside its base circle.
  PlanePair pair(int grid) {
    for (;;) {
      PlanePair p{.z1 = count(12, 60),
                  .z2 = 0,
                  .ring = flip(),
                  .gear1_drives = flip(),
                  .alpha_w = between(15.0, 32.0) * kDegree};
      p.z2 = p.ring ? p.z1 + count(8, 80) : count(12, 110);
      const double e1 = count(-grid / 2, 2 * grid) / (1.0 * grid);
      const double epsilon = count(grid * 6 / 10, grid * 5 / 2) / (1.0 * grid);
      const double e2 = epsilon - e1;
      if (e2 < -0.5 || e2 > 2.0) continue;
      const double pitch = 2.0 * kPi / p.z1;
      const double radius2 = 1.0 * p.z2 / p.z1;
      const double rho1 = std::tan(p.alpha_w) + e1 * pitch;
      const double rho2 = radius2 * std::tan(p.alpha_w) + (p.ring ? -1.0 : 1.0) * e2 * pitch;
      if (rho1 < 0.0 || rho2 < 0.0) continue;
      p.tip_radius1 = std::hypot(1.0, rho1);
      p.tip_radius2 = std::hypot(radius2, rho2);
      return p;
    }
  }

  /// Any contact ratios, also those whose tips would lie inside the base circles.
  MeshContact<double> contact() {
    MeshContact<double> c{.z1 = count(12, 60),
                          .z2 = 0,
                          .sign = flip() ? 1.0 : -1.0,
                          .approach_contact_ratio = between(-0.5, 2.0),
                          .recess_contact_ratio = 0.0,
                          .tan_alpha_w = std::tan(between(15.0, 32.0) * kDegree),
                          .gear1_drives = flip()};
    c.z2 = c.sign < 0.0 ? c.z1 + count(8, 80) : count(12, 110);
    c.recess_contact_ratio = between(0.6, 2.6) - c.approach_contact_ratio;
    return c;
  }

 private:
  std::mt19937_64 generator_{23};
};

double coulomb(const MeshContact<double>& c, double mu) {
  return coulomb_path_efficiency<double>(c, {.coefficient = mu});
}
double sliding(const MeshContact<double>& c, double mu) {
  return mesh_efficiency(c, mu, LossModel::kSliding);
}
MeshContact<double> reversed(MeshContact<double> c) {
  std::swap(c.approach_contact_ratio, c.recess_contact_ratio);
  c.gear1_drives = !c.gear1_drives;
  return c;
}

TEST(CoulombPath, IsTheMeanTorqueRatioOfTwoRigidGearsInThePlane) {
  // Ends of the path and the pitch point lie between the cells: what the midpoint rule then leaves
  // is quartered by halving the step.
  constexpr int kSteps = 256;
  Random random;
  LargestDeviation largest;
  int low = 0, two_and_more = 0, negative = 0, above_one = 0, rings = 0;
  for (int i = 0; i < 600; ++i) {
    const RigidGears gears(random.pair(kSteps));
    const MeshContact<double> contact = gears.contact();
    const double mu = random.between(0.0, 0.3);
    const double fine = gears.mean_efficiency(mu, 2 * kSteps);
    const double truncation = std::abs(fine - gears.mean_efficiency(mu, kSteps));
    largest.see(i, coulomb(contact, mu) - fine, truncation + 64.0 * kEps);
    const double ea = contact.approach_contact_ratio;
    const double er = contact.recess_contact_ratio;
    low += ea + er < 1.0 ? 1 : 0;
    two_and_more += ea + er > 2.0 ? 1 : 0;
    negative += std::min(ea, er) < 0.0 ? 1 : 0;
    above_one += std::max(ea, er) > 1.0 ? 1 : 0;
    rings += contact.sign < 0.0 ? 1 : 0;
  }
  largest.expect_allowed("coulomb_path_rigid_gears");
  for (const int seen : {low, two_and_more, negative, above_one, rings}) EXPECT_GT(seen, 50);
}

TEST(CoulombPath, IsTheMeanOfTheRigidGearsByGaussToRounding) {
  Random random;
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < 300; ++i) {
    const RigidGears gears(random.pair(256));
    const double mu = random.between(0.001, 0.4);
    const MeshContact<double> contact = gears.contact();
    const double eta = coulomb(contact, mu);
    if (eta == 0.0 || mu * contact.tan_alpha_w > 0.2) continue;  // nothing near a pole
    largest.see(i, eta - gears.gauss_mean(mu), 16.0 * kEps);
    ++seen;
  }
  largest.expect_allowed("coulomb_path_gauss");
  EXPECT_GT(seen, 200);
}

TEST(CoulombPath, IsTheRigidGearsTorqueRatioAtEveryPointOfThePath) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 4000; ++i) {
    const RigidGears gears(random.pair(256));
    const double mu = random.between(0.0, 0.5);
    const double s = random.between(gears.begin(), gears.end());
    const auto [driver, driven] = gears.moments(s, mu);
    const double expected = driver > 0.0 && driven > 0.0 ? driven / driver : 0.0;
    largest.see(i, path_efficiency<double>(gears.contact(), {.coefficient = mu}, s) - expected,
                64.0 * kEps * (1.0 + std::abs(expected)));
  }
  largest.expect_allowed("path_rigid_gears");
}

TEST(CoulombPath, OfAnEmptyPathIsThatOfItsMiddle) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    MeshContact<double> c = random.contact();
    const double middle = random.between(-0.5, 0.5);
    const double gap = random.between(0.0, 0.5);
    c.approach_contact_ratio = -middle - gap;
    c.recess_contact_ratio = middle - gap;
    const double expected = path_efficiency<double>(c, {.coefficient = 0.2}, middle);
    EXPECT_NEAR(coulomb(c, 0.2), expected, 8.0 * kEps);
    // And the path that shrinks to a point tends to it.
    c.approach_contact_ratio = -middle + 1e-7;
    c.recess_contact_ratio = middle;
    EXPECT_NEAR(coulomb(c, 0.2), expected, 1e-6);
  }
}

TEST(CoulombPath, JamsWhereTheFrictionAngleExceedsTheArmOfAFlank) {
  // Approach: the driver's friction arm is μ ρ; at the pitch point ρ/r_b = tan α_w = 1 for 45°.
  MeshContact<double> c{.z1 = 20,
                        .z2 = 40,
                        .sign = 1.0,
                        .approach_contact_ratio = 0.5,
                        .recess_contact_ratio = 1.0,
                        .tan_alpha_w = 1.0,
                        .gear1_drives = true};
  EXPECT_GT(coulomb(c, 0.8), 0.0);
  EXPECT_EQ(coulomb(c, 1.01), 0.0);
}

/// Least-squares slope of lg y over lg x.
double slope(const std::vector<std::array<double, 2>>& points) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const auto& [x, y] : points) {
    const double lx = std::log10(x);
    const double ly = std::log10(std::abs(y));
    n += 1.0, sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Largest product of the path's loss per μ and of (tan α_w + |s| 2π/z): bounds the second order.
double second_order_bound(const MeshContact<double>& c) {
  const double reach =
      std::max(std::abs(c.approach_contact_ratio), std::abs(c.recess_contact_ratio));
  const double turning = 2.0 * kPi * (1.0 / c.z1 + c.sign / c.z2);
  return reach * turning * (c.tan_alpha_w + reach * 2.0 * kPi / std::min(c.z1, c.z2));
}

TEST(CoulombPath, DiffersFromTheFirstOrderModelBySecondOrderInFriction) {
  Random random;
  int fitted = 0;
  for (int i = 0; i < 2000; ++i) {
    const MeshContact<double> c = random.contact();
    const double bound = second_order_bound(c);
    std::vector<std::array<double, 2>> points;
    for (const double mu : {1e-4, 3e-4, 1e-3, 3e-3, 1e-2}) {
      const double remainder = coulomb(c, mu) - sliding(c, mu);
      ASSERT_LE(std::abs(remainder), 1.1 * bound * mu * mu + 8.0 * kEps) << "case " << i;
      points.push_back({mu, remainder});
    }
    // Approach and recess may cancel each other's second order; the third one then shows.
    if (std::abs(points[1][1]) < 0.05 * bound * points[1][0] * points[1][0]) continue;
    ASSERT_NEAR(slope(points), 2.0, 0.05) << "case " << i;
    ++fitted;
  }
  EXPECT_GT(fitted, 1000);
}

TEST(CoulombPath, DriveDirectionsDifferBySecondOrderInFriction) {
  Random random;
  int fitted = 0;
  for (int i = 0; i < 2000; ++i) {
    const MeshContact<double> c = random.contact();
    const double bound = second_order_bound(c);
    std::vector<std::array<double, 2>> points;
    for (const double mu : {1e-4, 3e-4, 1e-3, 3e-3, 1e-2}) {
      points.push_back({mu, coulomb(c, mu) - coulomb(reversed(c), mu)});
      ASSERT_LE(std::abs(points.back()[1]), 2.2 * bound * mu * mu + 8.0 * kEps) << "case " << i;
    }
    if (std::abs(points[1][1]) < 0.05 * bound * points[1][0] * points[1][0]) continue;
    ASSERT_NEAR(slope(points), 2.0, 0.05) << "case " << i;
    ++fitted;
  }
  EXPECT_GT(fitted, 500);
}

struct Shifts {
  double x1, x2;
};
/// Efficiency with the pinion of 20 driving less that with the gear of 100, at no backlash.
double pinion_less_wheel_driving(const Shifts& x, double mu) {
  const auto angle = geometry::make_pressure_angle(20.0 * kDegree);
  const auto gear = [&](int z, double shift) {
    return geometry::make_gear_geometry(
        geometry::Gear<double>{.teeth = z,
                               .kind = geometry::GearKind::kExternal,
                               .module_m = 1e-3,
                               .profile_shift = shift,
                               .machining_allowance = 0.0,
                               .tip_shortening = 0.0,
                               .rack = {}},
        angle);
  };
  const auto g1 = gear(20, x.x1);
  const auto g2 = gear(100, x.x2);
  const auto mesh =
      geometry::make_mesh_geometry(g1, g2, *geometry::zero_backlash_center_distance(g1, g2));
  return coulomb(contact_of(g1, g2, *mesh, true), mu) -
         coulomb(contact_of(g1, g2, *mesh, false), mu);
}

TEST(CoulombPath, SignOfTheDifferenceOfDirectionsDependsOnTheShifts) {
  for (const double mu : {0.05, 0.1, 0.2}) {
    const double unshifted = pinion_less_wheel_driving({.x1 = 0.0, .x2 = 0.0}, mu);
    const double shifted = pinion_less_wheel_driving({.x1 = -0.2, .x2 = 0.5}, mu);
    EXPECT_LT(unshifted * shifted, 0.0) << mu << ": " << unshifted << ", " << shifted;
    EXPECT_GT(std::min(std::abs(unshifted), std::abs(shifted)), 1e-3 * mu * mu);
  }
}

TEST(CoulombPath, AtAPointIsTheTorqueLossOfTheDirectionalImpedanceThesis) {
  // Eqs. 2.1 and 2.2 as printed; a along the line of action, R the working pitch radii, 1 drives.
  const auto before = [](double mu, double a, double r1, double r2, double alpha) {
    return mu * a * (r1 + r2) / (r2 * (mu * a + r1 * std::cos(alpha) - mu * r1 * std::sin(alpha)));
  };
  const auto after = [](double mu, double a, double r1, double r2, double alpha) {
    return mu * a * (r1 + r2) / (r2 * (mu * a + r1 * std::cos(alpha) + mu * r1 * std::sin(alpha)));
  };
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 4000; ++i) {
    const double alpha = random.between(14.0, 30.0) * kDegree;
    const MeshContact<double> c{.z1 = random.count(12, 100),
                                .z2 = random.count(12, 100),
                                .sign = 1.0,
                                .approach_contact_ratio = 1.0,
                                .recess_contact_ratio = 1.0,
                                .tan_alpha_w = std::tan(alpha),
                                .gear1_drives = random.flip()};
    const double m = random.between(0.2e-3, 5e-3);
    const double r1 = 0.5 * m * (c.gear1_drives ? c.z1 : c.z2);
    const double r2 = 0.5 * m * (c.gear1_drives ? c.z2 : c.z1);
    const double mu = random.between(0.01, 0.5);
    const double s = random.between(0.0, 0.5);
    const double a = s * kPi * m * std::cos(alpha);
    const FlankFriction<double> friction{.coefficient = mu};
    largest.see(i, 1.0 - path_efficiency<double>(c, friction, -s) - before(mu, a, r1, r2, alpha),
                16.0 * kEps);
    largest.see(i, 1.0 - path_efficiency<double>(c, friction, s) - after(mu, a, r1, r2, alpha),
                16.0 * kEps);
  }
  largest.expect_allowed("thesis_pointwise");
}

TEST(CoulombPath, OfARingIsThatOfAnExternalGearWithANegativeToothCount) {
  // One formula for external pairs, driver a and driven b, at the distances of the contact point
  // from the tangent points; only the sign of the ring's tooth count tells the kinds apart.
  const auto external = [](double za, double zb, double tangent, double mu, double s) {
    const double sigma = s < 0.0 ? 1.0 : -1.0;
    const double arm_a = tangent + 2.0 * kPi * s / za;
    const double arm_b = tangent - 2.0 * kPi * s / zb;
    return std::array<double, 2>{1.0 - sigma * mu * arm_a, 1.0 - sigma * mu * arm_b};
  };
  constexpr int kSteps = 512;
  Random random;
  LargestDeviation mean, point;
  for (int i = 0; i < 200; ++i) {
    MeshContact<double> c = random.contact();
    c.sign = -1.0;
    c.z2 = c.z1 + random.count(8, 80);
    // On the grid, as in the rigid gears.
    c.approach_contact_ratio = std::round(c.approach_contact_ratio * kSteps) / kSteps;
    c.recess_contact_ratio = std::round(c.recess_contact_ratio * kSteps) / kSteps;
    const double mu = random.between(0.0, 0.3);
    const double za = c.gear1_drives ? c.z1 : -c.z2;
    const double zb = c.gear1_drives ? -c.z2 : c.z1;
    const auto by_midpoints = [&](int steps) {
      double sum = 0.0;
      int positions = 0;
      for (int k = 0; k < steps; ++k) {
        std::array<double, 2> total{};
        for (double s = (k + 0.5) / steps - c.approach_contact_ratio; s < c.recess_contact_ratio;
             s += 1.0) {
          const auto one = external(za, zb, c.tan_alpha_w, mu, s);
          total[0] += one[0];
          total[1] += one[1];
        }
        if (total[0] == 0.0) continue;
        sum += total[1] / total[0];
        ++positions;
      }
      return sum / positions;
    };
    const double fine = by_midpoints(2 * kSteps);
    const double truncation = std::abs(fine - by_midpoints(kSteps));
    mean.see(i, coulomb(c, mu) - fine, truncation + 64.0 * kEps);
    const double s = random.between(-0.5, 0.5);
    const auto [driving, driven] = external(za, zb, c.tan_alpha_w, mu, s);
    point.see(i, path_efficiency<double>(c, {.coefficient = mu}, s) - driven / driving, 8.0 * kEps);
  }
  mean.expect_allowed("ring_as_negative_teeth");
  point.expect_allowed("ring_as_negative_teeth_pointwise");
}

TEST(CoulombPath, NeverGainsPowerAndLosesMoreWithMoreFriction) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const MeshContact<double> c = random.contact();
    EXPECT_EQ(coulomb(c, 0.0), 1.0);
    // While both tangent points enclose the path (ρ ≥ 0 on both flanks), each point loses.
    double last = 1.0;
    for (const double mu : {0.05, 0.1, 0.2, 0.3}) {
      const double eta = coulomb(c, mu);
      EXPECT_LT(eta, last) << "case " << i << ", mu " << mu;
      last = eta;
    }
  }
}

TEST(Directional, WithFactorsOfOneIsTheCoulombPath) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    const MeshContact<double> c = random.contact();
    const double mu = random.between(0.0, 0.3);
    const FlankFriction<double> even{.coefficient = mu};
    const double expected = coulomb(c, mu);
    EXPECT_EQ(mesh_efficiency(c, even, LossModel::kDirectional), expected);
    EXPECT_EQ(mesh_efficiency(c, even, LossModel::kCoulombPath), expected);
    EXPECT_EQ(mesh_efficiency(c, even, LossModel::kSliding), sliding(c, mu));
    // Other factors act on the path whatever the model is called.
    const FlankFriction<double> uneven{
        .coefficient = mu, .approach_factor = 3.0, .recess_factor = 0.2};
    EXPECT_EQ(mesh_efficiency(c, uneven, LossModel::kCoulombPath),
              mesh_efficiency(c, uneven, LossModel::kDirectional));
  }
}

TEST(Directional, ApproachFactorActsOnApproachAndRecessFactorOnRecess) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    MeshContact<double> c = random.contact();
    const double mu = random.between(0.01, 0.15);
    const double factor = random.between(0.3, 2.0);
    const FlankFriction<double> plain{.coefficient = mu};
    const FlankFriction<double> scaled{.coefficient = mu * factor};
    const FlankFriction<double> in_approach{
        .coefficient = mu, .approach_factor = factor, .recess_factor = 1.0};
    const FlankFriction<double> in_recess{
        .coefficient = mu, .approach_factor = 1.0, .recess_factor = factor};
    const double s = random.between(0.01, 0.8);
    EXPECT_EQ(path_efficiency(c, in_approach, -s), path_efficiency(c, scaled, -s));
    EXPECT_EQ(path_efficiency(c, in_approach, s), path_efficiency(c, plain, s));
    EXPECT_EQ(path_efficiency(c, in_recess, s), path_efficiency(c, scaled, s));
    EXPECT_EQ(path_efficiency(c, in_recess, -s), path_efficiency(c, plain, -s));
    // A path all in recess, or all in approach.
    const double length = random.between(0.6, 1.6);
    c.approach_contact_ratio = -0.05;
    c.recess_contact_ratio = 0.05 + length;
    EXPECT_EQ(coulomb_path_efficiency(c, in_approach), coulomb_path_efficiency(c, plain));
    EXPECT_EQ(coulomb_path_efficiency(c, in_recess), coulomb_path_efficiency(c, scaled));
    std::swap(c.approach_contact_ratio, c.recess_contact_ratio);
    EXPECT_EQ(coulomb_path_efficiency(c, in_recess), coulomb_path_efficiency(c, plain));
    EXPECT_EQ(coulomb_path_efficiency(c, in_approach), coulomb_path_efficiency(c, scaled));
  }
}

/// Efficiency over (e_a, e_r, tan α_w, μ, approach factor, recess factor).
template <class T>
T efficiency_at(const MeshContact<double>& c, const std::array<T, 6>& x) {
  const MeshContact<T> contact{.z1 = c.z1,
                               .z2 = c.z2,
                               .sign = c.sign,
                               .approach_contact_ratio = x[0],
                               .recess_contact_ratio = x[1],
                               .tan_alpha_w = x[2],
                               .gear1_drives = c.gear1_drives};
  return coulomb_path_efficiency<T>(
      contact, {.coefficient = x[3], .approach_factor = x[4], .recess_factor = x[5]});
}

TEST(CoulombPath, GradientIsThatOfCentralDifferencesAwayFromWholeContactRatios) {
  constexpr double kStep = 1e-5;
  Random random;
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < 1000; ++i) {
    const MeshContact<double> c = random.contact();
    const auto near_whole = [](double e) { return std::abs(e - std::round(e)) < 1e-3; };
    const double ea = c.approach_contact_ratio;
    const double er = c.recess_contact_ratio;
    if (near_whole(ea) || near_whole(er) || near_whole(ea + er)) continue;
    const std::array<double, 6> x{ea,
                                  er,
                                  c.tan_alpha_w,
                                  random.between(0.01, 0.3),
                                  random.between(0.5, 1.5),
                                  random.between(0.5, 1.5)};
    std::array<Jet1, 6> jets;
    for (std::size_t k = 0; k < 6; ++k) jets[k] = Jet1(x[k], static_cast<int>(k));
    const Jet1 eta = efficiency_at(c, jets);
    EXPECT_NEAR(eta.a, efficiency_at(c, x), 8.0 * kEps);
    for (std::size_t k = 0; k < 6; ++k) {
      auto above = x;
      auto below = x;
      above[k] += kStep;
      below[k] -= kStep;
      const double difference = (efficiency_at(c, above) - efficiency_at(c, below)) / (2.0 * kStep);
      // Truncation: third derivatives of order 10 times h²/6; rounding ε/h.
      largest.see(i, eta.v[static_cast<int>(k)] - difference,
                  10.0 * kStep * kStep + 8.0 * kEps / kStep);
    }
    ++seen;
  }
  largest.expect_allowed("gradient");
  EXPECT_GT(seen, 800);
}

// Up to friction at which what drives varies by more than half over a piece of the path.
TEST(CoulombPath, SecondDerivativesAreThoseOfDifferencesOfTheGradient) {
  constexpr double kStep = 1e-5;
  Random random;
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < 400; ++i) {
    const MeshContact<double> c = random.contact();
    const auto near_whole = [](double e) { return std::abs(e - std::round(e)) < 1e-3; };
    const double ea = c.approach_contact_ratio;
    const double er = c.recess_contact_ratio;
    if (near_whole(ea) || near_whole(er) || near_whole(ea + er)) continue;
    const std::array<double, 6> x{ea, er, c.tan_alpha_w, random.between(0.05, 1.5), 1.0, 0.8};
    std::array<Jet2, 6> jets;
    for (std::size_t k = 0; k < 6; ++k) jets[k] = Jet2::variable(x[k], k);
    const Jet2 eta = efficiency_at(c, jets);
    if (eta.value < 0.1) continue;
    const auto gradient = [&](std::array<double, 6> at, std::size_t k, double step) {
      at[k] += step;
      std::array<Jet1, 6> moved;
      for (std::size_t j = 0; j < 6; ++j) moved[j] = Jet1(at[j], static_cast<int>(j));
      return efficiency_at(c, moved).v;
    };
    double curvature = 0.0;
    for (const Jet2::Slopes& row : eta.mixed) {
      for (const double second : row) curvature = std::max(curvature, std::abs(second));
    }
    for (std::size_t k = 0; k < 6; ++k) {
      const auto above = gradient(x, k, kStep), below = gradient(x, k, -kStep);
      for (std::size_t j = 0; j < 6; ++j) {
        const auto at = static_cast<Eigen::Index>(j);
        // Truncation: fourth derivatives times h²/6, near a pole as the square of the second ones;
        // rounding of slopes over h.
        largest.see(i, eta.mixed[k][j] - (above[at] - below[at]) / (2.0 * kStep),
                    200.0 * kStep * kStep * (1.0 + curvature * curvature) + 1e3 * kEps / kStep);
      }
    }
    ++seen;
  }
  largest.expect_allowed("hessian");
  EXPECT_GT(seen, 200);
}

// A pinion that drives a ring with one pair, in approach up to the pitch point, where its torque
// vanishes as μ tan α_w tends to 1: t_d = μ |s| 2π/z1, and the loss is κ/(2π/z1) all along.
TEST(CoulombPath, IsANumberUpToTheFrictionThatJams) {
  for (const double alpha_w : {0.2, 0.35, 0.6}) {
    for (const int z1 : {5, 12, 20}) {
      MeshContact<double> c{.z1 = z1,
                            .z2 = 60,
                            .sign = -1.0,
                            .approach_contact_ratio = 0.7,
                            .recess_contact_ratio = 0.0,
                            .tan_alpha_w = std::tan(alpha_w)};
      for (int ulps = 4000; ulps >= -10; ulps -= ulps > 20 ? 400 : 1) {
        const double mu = (1.0 - 0.5 * ulps * kEps) / c.tan_alpha_w;
        const double eta = coulomb(c, mu);
        if (ulps <= 0) {
          EXPECT_EQ(eta, 0.0) << ulps;
        } else if (eta != 0.0 || ulps > 1000) {
          EXPECT_NEAR(eta, 1.0 * z1 / 60, 1e-9) << ulps;
        }
        const MeshEfficiencySlopes fast = mesh_efficiency_slopes(
            c, {.coefficient = mu}, LossModel::kCoulombPath, LossSlopes::kByAll);
        EXPECT_TRUE(std::isfinite(fast.efficiency) && std::isfinite(fast.by_coefficient)) << ulps;
        EXPECT_TRUE(all_finite(efficiency_at<Jet2>(
            c, {Jet2::variable(0.7, 0), Jet2::variable(0.0, 1), Jet2::variable(c.tan_alpha_w, 2),
                Jet2::variable(mu, 3), Jet2(1.0), Jet2(1.0)})))
            << ulps;
      }
    }
  }
}

}  // namespace
}  // namespace gear3k::efficiency::coulomb_path_test
