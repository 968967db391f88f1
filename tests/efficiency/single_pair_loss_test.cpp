#include "efficiency/single_pair_loss.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "efficiency/mesh_loss.hpp"
#include "geometry/mesh.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::efficiency::single_pair_loss_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kDegree = std::numbers::pi / 180.0;

struct TeethAndFriction {
  int z1, z2;
  double friction;
};

/// Full teeth of module 0.5 mm at 20 deg, no shift.
SinglePair full_teeth(const TeethAndFriction& c) {
  const double m = 0.5e-3;
  return {.pitch_radius1_m = 0.5 * m * c.z1,
          .pitch_radius2_m = 0.5 * m * c.z2,
          .tip_radius1_m = m * (0.5 * c.z1 + 1.0),
          .tip_radius2_m = m * (0.5 * c.z2 + 1.0),
          .pressure_angle_rad = 20.0 * kDegree,
          .friction = c.friction};
}

class RandomPairs {
 public:
  SinglePair next() {
    const double m = between(0.3e-3, 3e-3);
    const int z1 = std::uniform_int_distribution<int>(10, 150)(engine_);
    const int z2 = std::uniform_int_distribution<int>(10, 150)(engine_);
    return {.pitch_radius1_m = 0.5 * m * z1,
            .pitch_radius2_m = 0.5 * m * z2,
            .tip_radius1_m = m * (0.5 * z1 + between(0.3, 1.2)),
            .tip_radius2_m = m * (0.5 * z2 + between(0.3, 1.2)),
            .pressure_angle_rad = between(14.5, 25.0) * kDegree,
            .friction = between(0.01, 1.0)};
  }
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

 private:
  std::mt19937 engine_{20260};
};

using Vector = std::complex<double>;
double dot(Vector a, Vector b) { return (std::conj(a) * b).real(); }
double cross(Vector a, Vector b) { return (std::conj(a) * b).imag(); }
constexpr Vector kQuarterTurn(0.0, 1.0);

/// Two rigid gears touching at one point: centres on the x axis, pitch point at the origin, the
/// driver (left) turns counter-clockwise.  Friction on each body opposes its own slip on the other.
class TwoRigidGears {
 public:
  explicit TwoRigidGears(const SinglePair& p)
      : p_(p),
        center1_(-p.pitch_radius1_m, 0.0),
        center2_(p.pitch_radius2_m, 0.0),
        // The driver pushes up; the common normal is tangent to both base circles.
        normal_(std::polar(1.0, std::numbers::pi / 2.0 - p.pressure_angle_rad)) {}

  /// Power lost over power put in, with the contact at s along the line of action (s < 0: before
  /// the pitch point), from moments about both centres.
  [[nodiscard]] double loss(double s) const {
    const Powers power = powers(s, 1.0);
    return 1.0 + power.mesh_on_2 / power.mesh_on_1;
  }
  /// The same flanks with gear 2 driving: everything turns backwards.
  [[nodiscard]] double loss_driven_by_2(double s) const {
    const Powers power = powers(s, -1.0);
    return 1.0 + power.mesh_on_1 / power.mesh_on_2;
  }
  /// s where the line of action leaves the tip circle of the driver (the driven gear).
  [[nodiscard]] double end_of_recess() const { return crossing(center1_, p_.tip_radius1_m, 1.0); }
  [[nodiscard]] double begin_of_approach() const {
    return crossing(center2_, p_.tip_radius2_m, -1.0);
  }

 private:
  struct Powers {
    double mesh_on_1, mesh_on_2;  ///< of the contact force, on each gear
  };
  [[nodiscard]] Powers powers(double s, double w1) const {
    const Vector point = s * normal_;
    const double w2 = -w1 * p_.pitch_radius1_m / p_.pitch_radius2_m;
    const Vector slip_of_2 = kQuarterTurn * (w2 * (point - center2_) - w1 * (point - center1_));
    const Vector tangent = kQuarterTurn * normal_;
    const double sense = std::copysign(1.0, dot(slip_of_2, tangent));
    const Vector force_on_2 = normal_ - p_.friction * sense * tangent;
    return {.mesh_on_1 = cross(point - center1_, -force_on_2) * w1,
            .mesh_on_2 = cross(point - center2_, force_on_2) * w2};
  }
  [[nodiscard]] double crossing(Vector center, double radius, double sense) const {
    double inside = 0.0;
    double outside = sense * 4.0 * radius;
    while (true) {
      const double middle = 0.5 * (inside + outside);
      if (middle == inside || middle == outside) return middle;
      (std::abs(middle * normal_ - center) < radius ? inside : outside) = middle;
    }
  }

  SinglePair p_;
  Vector center1_, center2_, normal_;
};

TEST(SinglePairLoss, IsThatOfTheForcesOnTwoRigidGearsAtEveryPointOfThePath) {
  RandomPairs random;
  LargestDeviation largest;
  for (int i = 0; i < 2000; ++i) {
    const SinglePair pair = random.next();
    const TwoRigidGears gears(pair);
    const ContactPath path = contact_path(pair);
    const double a = random.between(0.01, 1.0) * path.approach_m;
    const double r = random.between(0.01, 1.0) * path.recess_m;
    // Torques are of order F R; their ratio is taken from 1.
    const double allowed = 64.0 * kEps;
    largest.see(i, approach_torque_loss(pair, a) - gears.loss(-a), allowed);
    largest.see(i, recess_torque_loss(pair, r) - gears.loss(r), allowed);
  }
  largest.expect_allowed("single_pair_force_balance");
}

TEST(SinglePairLoss, IsNotThatOfTheForcesWithTheDistanceFromTheLineOfCentres) {
  const SinglePair pair = full_teeth({.z1 = 16, .z2 = 80, .friction = 0.3});
  const double a = contact_path(pair).approach_m;
  const double forces = TwoRigidGears(pair).loss(-a);
  EXPECT_LT(approach_torque_loss(pair, a * std::cos(pair.pressure_angle_rad)), 0.97 * forces);
}

TEST(SinglePairLoss, ReversedPowerSwitchesTheEquationsAndTheRadii) {
  RandomPairs random;
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    const SinglePair pair = random.next();
    const TwoRigidGears gears(pair);
    const ContactPath path = contact_path(pair);
    const double a = random.between(0.01, 1.0) * path.approach_m;
    const double r = random.between(0.01, 1.0) * path.recess_m;
    const double allowed = 64.0 * kEps;
    largest.see(i, recess_torque_loss(reversed(pair), a) - gears.loss_driven_by_2(-a), allowed);
    largest.see(i, approach_torque_loss(reversed(pair), r) - gears.loss_driven_by_2(r), allowed);
  }
  largest.expect_allowed("single_pair_reversed_power");
}

TEST(ContactPath, EndsWhereTheTipCirclesCrossTheLineOfAction) {
  RandomPairs random;
  for (int i = 0; i < 1000; ++i) {
    const SinglePair pair = random.next();
    const TwoRigidGears gears(pair);
    const ContactPath path = contact_path(pair);
    const double rounding = 64.0 * kEps * (pair.tip_radius1_m + pair.tip_radius2_m);
    EXPECT_NEAR(-gears.begin_of_approach(), path.approach_m, rounding);
    EXPECT_NEAR(gears.end_of_recess(), path.recess_m, rounding);
  }
}

TEST(ContactPath, LeavesTheInvolutesWhereThePinionOfSixteenMeetsMoreThanAHundredAndOneTeeth) {
  // Textbook: at 20 deg with full teeth a 16-tooth pinion runs with 101 teeth at most.
  EXPECT_TRUE(path_on_involutes(full_teeth({.z1 = 16, .z2 = 101, .friction = 0.3})));
  EXPECT_FALSE(path_on_involutes(full_teeth({.z1 = 16, .z2 = 102, .friction = 0.3})));
  EXPECT_FALSE(path_on_involutes(full_teeth({.z1 = 102, .z2 = 16, .friction = 0.3})));
}

TEST(SinglePairMean, IsTheBruteForceMeanOfTheForceBalance) {
  RandomPairs random;
  LargestDeviation largest;
  constexpr int kSteps = 4000;
  for (int i = 0; i < 100; ++i) {
    const SinglePair pair = random.next();
    const TwoRigidGears gears(pair);
    const double begin = gears.begin_of_approach();
    const double end = gears.end_of_recess();
    double sum = 0.0;
    for (int k = 0; k < kSteps; ++k) sum += gears.loss(begin + (k + 0.5) / kSteps * (end - begin));
    // Midpoint rule with one kink, at the pitch point: error of order (loss at the tips)/steps².
    const double truncation =
        (std::abs(gears.loss(begin)) + std::abs(gears.loss(end))) / (1.0 * kSteps * kSteps);
    largest.see(i, mean_torque_loss(pair) - sum / kSteps, truncation + 1e4 * kEps);
  }
  largest.expect_allowed("single_pair_mean");
}

/// ∫ μ a C/(μ a + k) da from 0 to L, divided by C L, in long double.
long double mean_in_closed_form(const SinglePair& p) {
  const long double mu = p.friction;
  const long double sine = std::sin(static_cast<long double>(p.pressure_angle_rad));
  const long double cosine = std::cos(static_cast<long double>(p.pressure_angle_rad));
  const long double r1 = p.pitch_radius1_m;
  const long double r2 = p.pitch_radius2_m;
  const auto length = [&](long double tip, long double pitch) {
    return std::sqrt(tip * tip - pitch * pitch * cosine * cosine) - pitch * sine;
  };
  const auto integral = [&](long double end, long double k) {
    return (r1 + r2) / r2 * (end - k / mu * std::log1p(mu * end / k));
  };
  const long double approach = length(p.tip_radius2_m, r2);
  const long double recess = length(p.tip_radius1_m, r1);
  return (integral(approach, r1 * (cosine - mu * sine)) +
          integral(recess, r1 * (cosine + mu * sine))) /
         (approach + recess);
}

TEST(SinglePairMean, QuadratureIsTheClosedFormToRounding) {
  RandomPairs random;
  LargestDeviation largest;
  for (int i = 0; i < 2000; ++i) {
    const SinglePair pair = random.next();
    const auto expected = static_cast<double>(mean_in_closed_form(pair));
    // Radii to lengths cancel about tip radius over length, at most 60 here.
    largest.see(i, mean_torque_loss(pair) - expected, 256.0 * kEps * expected);
  }
  largest.expect_allowed("single_pair_quadrature");
}

struct MeshOf {
  geometry::MeshGeometry<double> mesh;
  double first_order_factor = 0.0;  ///< π (1/z1 + 1/z2)
};
MeshOf mesh_of(int z1, int z2) {
  const auto angle = geometry::make_pressure_angle(20.0 * kDegree);
  const auto gear = [&](int z) {
    return geometry::make_gear_geometry(
        geometry::Gear<double>{.teeth = z,
                               .kind = geometry::GearKind::kExternal,
                               .module_m = 0.5e-3,
                               .profile_shift = 0.0,
                               .machining_allowance = 0.0,
                               .tip_shortening = 0.0,
                               .rack = {}},
        angle);
  };
  const auto g1 = gear(z1);
  const auto g2 = gear(z2);
  return {
      .mesh = geometry::make_mesh_geometry(g1, g2, g1.reference_radius_m + g2.reference_radius_m)
                  .value(),
      .first_order_factor = std::numbers::pi * (1.0 / z1 + 1.0 / z2)};
}

TEST(SinglePairMean, TendsToTheMeanSlidingOverTheWholePathAsFrictionVanishes) {
  const double mu = 1e-7;  // the second order is smaller by μ
  for (const auto& [z1, z2] : {std::pair{16, 80}, {80, 16}, {40, 40}, {30, 120}}) {
    const MeshOf m = mesh_of(z1, z2);
    const double ea = m.mesh.addendum_contact_ratio2;
    const double er = m.mesh.addendum_contact_ratio1;
    const double expected = m.first_order_factor * (ea * ea + er * er) / (ea + er);
    const double loss = mean_torque_loss(full_teeth({.z1 = z1, .z2 = z2, .friction = mu}));
    EXPECT_NEAR(loss / mu, expected, mu) << z1 << "/" << z2;
    // With one pair carrying everything it exceeds the loss with the load shared.
    const double shared = m.first_order_factor * sliding_factor(ea, er);
    EXPECT_GT(loss / mu, 1.1 * shared) << z1 << "/" << z2;
  }
}

TEST(SinglePairMean, IsZeroWithoutFrictionAndGrowsWithIt) {
  double last = mean_torque_loss(full_teeth({.z1 = 16, .z2 = 80, .friction = 0.0}));
  EXPECT_EQ(last, 0.0);
  for (double mu = 0.1; mu < 2.0; mu += 0.1) {
    const double loss = mean_torque_loss(full_teeth({.z1 = 16, .z2 = 80, .friction = mu}));
    EXPECT_GT(loss, last);
    last = loss;
  }
}

TEST(SinglePairMean, DependsOnTeethAndNotOnTheModule) {
  const SinglePair small = full_teeth({.z1 = 18, .z2 = 100, .friction = 0.3});
  SinglePair large = small;
  for (double* length : {&large.pitch_radius1_m, &large.pitch_radius2_m, &large.tip_radius1_m,
                         &large.tip_radius2_m}) {
    *length *= 7.0;
  }
  EXPECT_NEAR(mean_torque_loss(large), mean_torque_loss(small), 256.0 * kEps);
}

TEST(SkewLoss, ChangesSignWithTheDirectionAndAddsUpToTheLoss) {
  RandomPairs random;
  for (int i = 0; i < 200; ++i) {
    const SinglePair pair = random.next();
    EXPECT_EQ(skew_loss(reversed(pair)), -skew_loss(pair));
    EXPECT_EQ(symmetric_loss(reversed(pair)), symmetric_loss(pair));
    EXPECT_NEAR(symmetric_loss(pair) + skew_loss(pair), mean_torque_loss(pair),
                4.0 * kEps * symmetric_loss(pair));
  }
}

TEST(SkewLoss, IsOfSecondOrderInFrictionAndItsSignIsNotAlwaysThatOfTheLargerDriver) {
  const auto second_order = [](const SinglePair& p) {
    const ContactPath path = contact_path(p);
    const double a = path.approach_m;
    const double b = path.recess_m;
    const double r1 = p.pitch_radius1_m;
    const double r2 = p.pitch_radius2_m;
    const double cosine = std::cos(p.pressure_angle_rad);
    return (r1 + r2) / (2.0 * r1 * r2 * cosine * (a + b)) *
           (std::tan(p.pressure_angle_rad) * (a * a - b * b) -
            (1.0 / r1 - 1.0 / r2) * (a * a * a + b * b * b) / (3.0 * cosine));
  };
  const double mu = 1e-4;
  for (const auto& [large, small] : {std::pair{80, 16}, {120, 18}, {120, 60}, {100, 90}}) {
    const SinglePair pair = full_teeth({.z1 = large, .z2 = small, .friction = mu});
    // The third order is smaller by μ times a factor of order 1/(z sin α), here below 10.
    EXPECT_NEAR(skew_loss(pair) / (mu * mu), second_order(pair), 10.0 * mu)
        << large << "/" << small;
  }
  EXPECT_GT(skew_loss(full_teeth({.z1 = 80, .z2 = 16, .friction = 0.3})), 0.0);
  EXPECT_LT(skew_loss(full_teeth({.z1 = 120, .z2 = 60, .friction = 0.3})), 0.0);
}

TEST(SinglePairLoss, OutsideItsRangeNamesWhatIsWrong) {
  const auto message = [](const SinglePair& pair) {
    try {
      static_cast<void>(mean_torque_loss(pair));
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  const SinglePair good = full_teeth({.z1 = 16, .z2 = 80, .friction = 0.3});
  EXPECT_EQ(message(good), "accepted");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double mu : {-0.1, 2.75, nan}) {  // 1/tan 20 deg = 2.747
    SinglePair bad = good;
    bad.friction = mu;
    EXPECT_NE(message(bad).find("friction"), std::string::npos) << mu;
  }
  SinglePair low_tip = good;
  low_tip.tip_radius2_m = low_tip.pitch_radius2_m;
  EXPECT_NE(message(low_tip).find("tip_radius2_m"), std::string::npos);
  SinglePair no_radius = good;
  no_radius.pitch_radius1_m = nan;
  EXPECT_NE(message(no_radius).find("pitch_radius1_m"), std::string::npos);
  EXPECT_THROW(static_cast<void>(approach_torque_loss(good, -1e-6)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(recess_torque_loss(good, nan)), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::efficiency::single_pair_loss_test
