#include "train/power_flow.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/scalar.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/linear_solve.hpp"
#include "tests/random_train.hpp"

namespace gear3k::train::power_flow_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Speeds from the pitch velocities when the carrier turns by zP1 zR2 and the planets roll off
/// inside R1, at rest; whole numbers but for the sun's, then scaled to R2 at +1.
struct Speeds {
  double sun, planet, carrier;
  std::array<double, kMeshCount> rolling;  // S, R1, R2 seen from the carrier
};
Speeds speeds_of(const ToothSet& z) {
  const double carrier = 1.0 * z.P1 * z.R2;
  const double planet = -1.0 * z.R1 * z.R2;  // seen from the carrier
  const double sun = 1.0 * z.R1 * z.R2 * z.P1 / z.S;
  const double ring2 = -1.0 * z.R1 * z.P2;
  const double output = carrier + ring2;
  return {.sun = (carrier + sun) / output,
          .planet = (carrier + planet) / output,
          .carrier = carrier / output,
          .rolling = {sun / output, -carrier / output, ring2 / output}};
}

class Random : public RandomTrain {
 public:
  Random() : RandomTrain(24) {}
  /// Efficiencies of all meshes, the same for both drivers.
  std::array<DriverEfficiencies<double>, kMeshCount> efficiencies(double least) {
    std::array<DriverEfficiencies<double>, kMeshCount> eta{};
    for (auto& mesh : eta) mesh.fill(between(least, 1.0));
    return eta;
  }
  /// Different for the two drivers.
  std::array<DriverEfficiencies<double>, kMeshCount> directional(double least) {
    std::array<DriverEfficiencies<double>, kMeshCount> eta{};
    for (auto& mesh : eta) mesh = {between(least, 1.0), between(least, 1.0)};
    return eta;
  }
  BodyTorques<double> torques(double scale) {
    const auto one = [&] { return count(0, 3) == 0 ? 0.0 : between(-scale, scale); };
    return {.sun = one(), .planet = one(), .pin = one(), .carrier = one(), .ring2 = one()};
  }
};

/// Whether gear 1 of a mesh is its central gear.
constexpr std::array<bool, kMeshCount> kCentralIsGear1{true, false, false};

double efficiency_of(const LoadedTrain<double>& t, std::size_t mesh, bool central_drives) {
  return t.efficiency[mesh][central_drives == kCentralIsGear1[mesh] ? 0 : 1];
}

/// Every body on its own: sun, R1, R2, carrier, and the planets (all N in one place).  Planets'
/// centre at the distance 1 from the axis.
struct FreeBodies {
  std::array<double, kMeshCount> central_torque;  ///< of the planets on S, R1, R2
  double sun_torque, output_torque;               ///< from outside
  std::array<bool, kMeshCount> central_drives;
};

/// The bodies in balance when the given central gears drive; nothing else is assumed.
FreeBodies balance_of_bodies(const LoadedTrain<double>& t,
                             const std::array<bool, kMeshCount>& central_drives) {
  const Speeds w = speeds_of(t.teeth);
  const double planet_on_carrier = w.planet - w.carrier;
  // Unknowns: torque Q of each mesh on its central gear, moment p on the planet about its centre,
  // tangential force f on the planet; force h of the carrier's pin on the planet; torques on the
  // sun, on R2 and of the housing on R1.
  enum : Eigen::Index { kQ = 0, kP = 3, kF = 6, kH = 9, kSun, kOutput, kHousing, kUnknowns };
  Eigen::Matrix<double, kUnknowns, kUnknowns> a;
  Eigen::Matrix<double, kUnknowns, 1> b;
  a.setZero();
  b.setZero();
  Eigen::Index row = 0;
  for (Eigen::Index k = 0; k < 3; ++k) {
    // Action and reaction: moments about the main axis.
    a(row, kQ + k) = 1.0, a(row, kP + k) = 1.0, a(row, kF + k) = 1.0, ++row;
    // Power on the driven member is η times that of the driver, in the frame of the carrier.
    const auto mesh = static_cast<std::size_t>(k);
    const double eta = efficiency_of(t, mesh, central_drives[mesh]);
    a(row, kQ + k) = w.rolling[mesh] * (central_drives[mesh] ? eta : 1.0);
    a(row, kP + k) = planet_on_carrier * (central_drives[mesh] ? 1.0 : eta);
    ++row;
  }
  // Sun, R1, R2.
  a(row, kQ + 0) = 1.0, a(row, kSun) = 1.0, b(row) = -t.known.sun, ++row;
  a(row, kQ + 1) = 1.0, a(row, kHousing) = 1.0, ++row;
  a(row, kQ + 2) = 1.0, a(row, kOutput) = 1.0, b(row) = -t.known.ring2, ++row;
  // Planet: moments about its centre, tangential forces.
  for (Eigen::Index k = 0; k < 3; ++k) a(row, kP + k) = 1.0;
  b(row) = -t.known.planet - t.known.pin, ++row;
  for (Eigen::Index k = 0; k < 3; ++k) a(row, kF + k) = 1.0;
  a(row, kH) = 1.0, ++row;
  // Carrier: the planet pushes back on the pin, with its force and with the pin's friction.
  a(row, kH) = -1.0, b(row) = t.known.pin - t.known.carrier, ++row;
  a(row, t.given_end == End::kOutput ? kOutput : kSun) = 1.0, b(row) = t.given_torque_Nm, ++row;
  EXPECT_EQ(row, static_cast<Eigen::Index>(kUnknowns));
  const Eigen::Matrix<double, kUnknowns, 1> x = test::solved(a, b);
  return {.central_torque = {x(kQ), x(kQ + 1), x(kQ + 2)},
          .sun_torque = x(kSun),
          .output_torque = x(kOutput),
          .central_drives = central_drives};
}

/// All balances in which those drive that were assumed to.  Meshes that carry less than `slack`
/// times the largest torque may be driven by either member.
std::vector<FreeBodies> consistent_balances(const LoadedTrain<double>& t, double slack = 0.0) {
  const Speeds w = speeds_of(t.teeth);
  std::vector<FreeBodies> found;
  for (unsigned pattern = 0; pattern < 8; ++pattern) {
    const FreeBodies bodies =
        balance_of_bodies(t, {(pattern & 1U) != 0, (pattern & 2U) != 0, (pattern & 4U) != 0});
    double scale = 0.0;
    for (const double q : bodies.central_torque) scale = std::max(scale, std::abs(q));
    bool consistent = std::isfinite(scale);
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      // The planets brake a central gear that drives.
      const double braked = -bodies.central_torque[k] * w.rolling[k];
      if (std::abs(bodies.central_torque[k]) <= slack * scale) continue;
      if ((braked > 0.0) != bodies.central_drives[k]) consistent = false;
    }
    if (consistent) found.push_back(bodies);
  }
  return found;
}

double largest_torque(const PowerFlow<double>& flow, const LoadedTrain<double>& t) {
  double scale = std::abs(flow.sun_torque_Nm) + std::abs(flow.output_torque_Nm);
  for (const double q : flow.mesh_torque_Nm) scale += std::abs(q);
  const auto& k = t.known;
  for (const double q : {k.sun, k.planet, k.pin, k.carrier, k.ring2}) scale += std::abs(q);
  return scale;
}

/// Power from the ends and from the known torques less the losses, and the sum of magnitudes.
struct PowerBalance {
  double rest, scale;
};
PowerBalance power_balance(const LoadedTrain<double>& t, const PowerFlow<double>& flow) {
  const Speeds w = speeds_of(t.teeth);
  const auto& k = t.known;
  const std::array<double, 10> terms{
      flow.sun_torque_Nm * w.sun,     flow.output_torque_Nm, k.sun * w.sun, k.planet * w.planet,
      k.pin * (w.planet - w.carrier), k.carrier * w.carrier, k.ring2,       -flow.mesh_loss_Nm[0],
      -flow.mesh_loss_Nm[1],          -flow.mesh_loss_Nm[2]};
  PowerBalance result{0.0, 0.0};
  for (const double term : terms) {
    result.rest += term;
    result.scale += std::abs(term);
  }
  return result;
}

class LoadedTrainOfEitherSense : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, LoadedTrainOfEitherSense, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

TEST_P(LoadedTrainOfEitherSense, UnloadedBodiesGiveThePapersEquations18And19AndTheirFormsAboveOne) {
  Random random;
  LargestDeviation forward, backward;
  int seen = 0;
  for (int i = 0; i < 4000; ++i) {
    LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                          .efficiency = random.efficiencies(i % 2 == 0 ? 0.97 : 0.8),
                          .known = {},
                          .given_end = End::kOutput,
                          .given_torque_Nm = 0.0};
    const ToothSet& z = t.teeth;
    const double e1 = t.efficiency[0][0];
    const double e2 = t.efficiency[1][0];
    const double e3 = t.efficiency[2][0];
    const double big = static_cast<double>(z.R1) / z.S;
    const double g = static_cast<double>(z.P2) * z.R1 / (static_cast<double>(z.P1) * z.R2);
    const double margin = g < 1.0 ? e2 * e3 - g : g * e2 * e3 - 1.0;
    if (!(margin > 0.0)) continue;
    ++seen;
    const double eta_f =
        g < 1.0 ? (1.0 + e1 * e2 * big) * (1.0 - g) / ((1.0 + big) * (1.0 - e2 * e3 * g))
                : e3 * (e2 + e1 * big) * (g - 1.0) / ((1.0 + big) * (g - e2 * e3));
    const double eta_b =
        g < 1.0 ? e1 * (1.0 + big) * (e2 * e3 - g) / (e3 * (big + e1 * e2) * (1.0 - g))
                : e1 * (1.0 + big) * (e2 * e3 * g - 1.0) / ((e1 + e2 * big) * (g - 1.0));
    const double w_sun = (1.0 + big) / (1.0 - g);
    const double allowed = 8.0 * kEps * (1.0 + std::abs(w_sun)) / std::min(1.0, margin);
    const double load = random.between(0.1, 100.0);
    for (const End given : {End::kOutput, End::kSun}) {
      t.given_end = given;
      const bool output = given == End::kOutput;
      // Forward: the load acts against R2, the drive along the sun's rotation.
      t.given_torque_Nm = output ? -load : std::copysign(load, w_sun);
      const auto driven = solve_power_flow(t);
      ASSERT_TRUE(driven) << "case " << i;
      EXPECT_EQ(output ? driven->output_torque_Nm : driven->sun_torque_Nm, t.given_torque_Nm);
      forward.see(i, -driven->output_torque_Nm / (driven->sun_torque_Nm * w_sun) - eta_f, allowed);
      t.given_torque_Nm = -t.given_torque_Nm;
      const auto driving = solve_power_flow(t);
      ASSERT_TRUE(driving) << "case " << i;
      backward.see(i, -driving->sun_torque_Nm * w_sun / driving->output_torque_Nm - eta_b, allowed);
      for (std::size_t k = 0; k < kMeshCount; ++k) {
        const auto mesh = static_cast<MeshId>(k);
        EXPECT_EQ(driven->gear1_drives[k], gear1_drives(mesh, GetParam(), true));
        EXPECT_EQ(driving->gear1_drives[k], gear1_drives(mesh, GetParam(), false));
      }
    }
  }
  forward.expect_allowed("forward");
  backward.expect_allowed("backward");
  EXPECT_GT(seen, 500);
}

TEST_P(LoadedTrainOfEitherSense, PowerIsBalancedWithAnyTorquesOnTheBodies) {
  Random random;
  LargestDeviation power;
  int solved = 0;
  for (int i = 0; i < 5000; ++i) {
    const LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                                .efficiency = random.directional(i % 2 == 0 ? 0.95 : 0.6),
                                .known = random.torques(i % 3 == 0 ? 0.1 : 2.0),
                                .given_end = i % 4 == 0 ? End::kSun : End::kOutput,
                                .given_torque_Nm = random.between(-3.0, 3.0)};
    const auto flow = solve_power_flow(t);
    if (!flow) {
      EXPECT_EQ(t.given_end, End::kSun) << "case " << i;
      continue;
    }
    ++solved;
    const PowerBalance balance = power_balance(t, *flow);
    // Torques come from differences of levers, which lose up to the ratio's digits.
    power.see(i, balance.rest,
              32.0 * kEps * (balance.scale + largest_torque(*flow, t) * std::abs(ratio(t.teeth))));
    for (const double one : flow->mesh_loss_Nm) EXPECT_GE(one, 0.0) << "case " << i;
  }
  power.expect_allowed("power");
  EXPECT_GT(solved, 4000);
}

TEST_P(LoadedTrainOfEitherSense, AGivenOutputTorqueHasExactlyOneBalanceOfTheFreeBodies) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 3000; ++i) {
    const LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                                .efficiency = random.directional(i % 2 == 0 ? 0.95 : 0.6),
                                .known = random.torques(2.0),
                                .given_end = End::kOutput,
                                .given_torque_Nm = random.between(-3.0, 3.0)};
    const auto balances = consistent_balances(t);
    ASSERT_EQ(balances.size(), 1U) << "case " << i;
    const auto flow = solve_power_flow(t);
    ASSERT_TRUE(flow) << "case " << i;
    const double allowed = 128.0 * kEps * largest_torque(*flow, t);
    largest.see(i, flow->sun_torque_Nm - balances[0].sun_torque, allowed);
    largest.see(i, flow->output_torque_Nm - balances[0].output_torque, allowed);
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      largest.see(i, flow->mesh_torque_Nm[k] - balances[0].central_torque[k], allowed);
      EXPECT_EQ(flow->gear1_drives[k], balances[0].central_drives[k] == kCentralIsGear1[k]);
    }
  }
  largest.expect_allowed("free_bodies");
}

TEST_P(LoadedTrainOfEitherSense, AGivenSunTorqueHasOneBalanceWhereBackdrivableElseNoneOrTwo) {
  Random random;
  LargestDeviation largest;
  std::array<int, 9> count{}, count_backdrivable{};
  int differ = 0;
  for (int i = 0; i < 6000; ++i) {
    const LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                                .efficiency = random.directional(i % 2 == 0 ? 0.97 : 0.8),
                                .known = i % 3 == 0 ? BodyTorques<double>{} : random.torques(2.0),
                                .given_end = End::kSun,
                                .given_torque_Nm = random.between(-3.0, 3.0)};
    const auto balances = consistent_balances(t);
    const auto flow = solve_power_flow(t);
    ASSERT_EQ(flow.has_value(), !balances.empty()) << "case " << i;
    ++count[balances.size()];
    // The least efficiencies of both rings' meshes, whoever drives.
    const double least = std::min(t.efficiency[1][0], t.efficiency[1][1]) *
                         std::min(t.efficiency[2][0], t.efficiency[2][1]);
    const double g = g2(t.teeth);
    if (g < 1.0 ? least > g : g * least > 1.0) ++count_backdrivable[balances.size()];
    if (!flow) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (const FreeBodies& b : balances) {
      nearest = std::min(
          nearest, std::abs(flow->output_torque_Nm - b.output_torque) / largest_torque(*flow, t));
      if (std::abs(b.output_torque - balances[0].output_torque) > 1e-6 * largest_torque(*flow, t)) {
        ++differ;
      }
    }
    // Moments of R1's and R2's meshes on the planets all but cancel near the locking limit.
    const Speeds w = speeds_of(t.teeth);
    const auto moment_per_torque = [&](std::size_t k) {
      const bool central = flow->gear1_drives[k] == kCentralIsGear1[k];
      const double eta = efficiency_of(t, k, central);
      return std::abs(w.rolling[k]) * (central ? eta : 1.0 / eta);
    };
    const double m1 = moment_per_torque(kMeshP1R1);
    const double m2 = moment_per_torque(kMeshP2R2);
    largest.see(i, nearest, 32.0 * kEps * (m1 + m2) / std::abs(m1 - m2));
  }
  largest.expect_allowed("free_bodies");
  RecordProperty("none", count[0]);
  RecordProperty("one", count[1]);
  RecordProperty("two", count[2]);
  RecordProperty("two_that_differ", differ);
  // Backdrivable: as many as random cases make, each with one balance.
  EXPECT_GT(count_backdrivable[1], 500);
  for (const std::size_t n : {0U, 2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
    EXPECT_EQ(count_backdrivable[n], 0) << n;
  }
  for (const std::size_t n : {3U, 4U, 5U, 6U, 7U, 8U}) EXPECT_EQ(count[n], 0) << n;
  // A train that locks turns both ways of a given sun torque: R2 driven, or R2 driving while the
  // sun helps.
  EXPECT_GT(count[0], 100);
  EXPECT_GT(count[2], 100);
}

/// Surplus of moment on the planets at a torque on the sun's mesh, every mesh losing by the power
/// that flows; the torque on R1 follows from the carrier.
double surplus(const LoadedTrain<double>& t, double sun_mesh_torque) {
  const Speeds w = speeds_of(t.teeth);
  const double output_mesh = -(t.given_torque_Nm + t.known.ring2);
  const std::array<double, kMeshCount> central{
      sun_mesh_torque, t.known.carrier + t.known.planet - sun_mesh_torque - output_mesh,
      output_mesh};
  double power = (t.known.planet + t.known.pin) * (w.planet - w.carrier);  // into the planets
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const double from_central = -central[k] * w.rolling[k];
    power += from_central > 0.0 ? from_central * efficiency_of(t, k, true)
                                : from_central / efficiency_of(t, k, false);
  }
  return power;
}

TEST_P(LoadedTrainOfEitherSense, BisectionOfThePlanetsPowerFindsTheSameSunTorque) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 2000; ++i) {
    const LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                                .efficiency = random.directional(i % 2 == 0 ? 0.95 : 0.6),
                                .known = random.torques(2.0),
                                .given_end = End::kOutput,
                                .given_torque_Nm = random.between(-3.0, 3.0)};
    const auto flow = solve_power_flow(t);
    ASSERT_TRUE(flow);
    double low = -1e4;
    double high = 1e4;
    const bool rising = surplus(t, high) > surplus(t, low);
    while (true) {
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      ((surplus(t, middle) > 0.0) == rising ? high : low) = middle;
    }
    largest.see(i, flow->mesh_torque_Nm[kMeshSP1] - low, 128.0 * kEps * largest_torque(*flow, t));
  }
  largest.expect_allowed("bisection");
}

TEST_P(LoadedTrainOfEitherSense, ALockingTrainsSunMustBeHelpedWhenTheOutputDrives) {
  Random random;
  int seen = 0;
  for (int i = 0; i < 4000; ++i) {
    LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                          .efficiency = random.efficiencies(0.7),
                          .known = {},
                          .given_end = End::kOutput,
                          .given_torque_Nm = 1.0};
    const double product = t.efficiency[1][0] * t.efficiency[2][0];
    const double g = g2(t.teeth);
    const bool locks = g < 1.0 ? product < g : g * product < 1.0;
    const auto flow = solve_power_flow(t);
    ASSERT_TRUE(flow);
    // Power that the sun takes out: negative where it has to be put in.
    const double taken = -flow->sun_torque_Nm * speeds_of(t.teeth).sun;
    EXPECT_EQ(taken < 0.0, locks) << "case " << i;
    if (!locks) continue;
    ++seen;
    // With a free sun there is nothing but standing still.
    t.given_end = End::kSun;
    t.given_torque_Nm = 0.0;
    t.known.sun = std::copysign(1e-3, -speeds_of(t.teeth).sun);  // drag
    EXPECT_FALSE(solve_power_flow(t).has_value()) << "case " << i;
  }
  EXPECT_GT(seen, 500);
}

TEST_P(LoadedTrainOfEitherSense, ATrainThatItsSunDrivesMovesALoadEvenIfItWouldLock) {
  // Of the two balances of a locking train, the one in which R2 is driven.
  Random random;
  int locking = 0;
  for (int i = 0; i < 4000; ++i) {
    const LoadedTrain<double> t{
        .teeth = random.teeth(GetParam()),
        .efficiency = random.efficiencies(0.7),
        .known = {},
        .given_end = End::kSun,
        .given_torque_Nm = std::copysign(random.between(0.1, 1.0), GetParam() ? 1.0 : -1.0)};
    const auto flow = solve_power_flow(t);
    ASSERT_TRUE(flow);
    EXPECT_LT(flow->output_torque_Nm, 0.0) << "case " << i;
    locking += consistent_balances(t).size() == 2 ? 1 : 0;
  }
  EXPECT_GT(locking, 500);
}

TEST_P(LoadedTrainOfEitherSense, TheUnloadedTrainHasNoTorques) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    const LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                                .efficiency = random.efficiencies(0.8),
                                .known = {},
                                .given_end = i % 2 == 0 ? End::kOutput : End::kSun,
                                .given_torque_Nm = 0.0};
    const auto flow = solve_power_flow(t);
    ASSERT_TRUE(flow);
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      EXPECT_EQ(flow->mesh_torque_Nm[k], 0.0);
      EXPECT_EQ(flow->mesh_loss_Nm[k], 0.0);
    }
  }
}

TEST_P(LoadedTrainOfEitherSense, AMeshThatCarriesNothingButRoundingDoesNotLockTheTrain) {
  // The torque on the pins is such that one mesh is free: the sign of its power is that of
  // rounding.
  Random random;
  int seen = 0;
  for (int i = 0; i < 6000; ++i) {
    LoadedTrain<double> t{.teeth = random.teeth(GetParam()),
                          .efficiency = random.directional(0.9),
                          .known = random.torques(2.0),
                          .given_end = End::kOutput,
                          .given_torque_Nm = random.between(-3.0, 3.0)};
    // R1 carries nothing: all that the carrier holds is on S and R2.
    const double sun_mesh = t.known.carrier + t.known.planet + t.given_torque_Nm + t.known.ring2;
    t.known.pin = 0.0;
    const Speeds w = speeds_of(t.teeth);
    t.known.pin = -surplus(t, sun_mesh) / (w.planet - w.carrier);
    EXPECT_TRUE(solve_power_flow(t).has_value()) << "case " << i;
    ++seen;
  }
  EXPECT_GT(seen, 1000);
}

TEST_P(LoadedTrainOfEitherSense, RollingSpeedsAreThoseOfThePitchVelocities) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 1000; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const Speeds w = speeds_of(z);
    const auto rolling = central_rolling_speeds(z);
    const double lever = 1.0 + std::abs(ratio(z));
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      largest.see(i, rolling[k] - w.rolling[k], 8.0 * kEps * lever * lever);
    }
  }
  largest.expect_allowed("rolling");
}

TEST_P(LoadedTrainOfEitherSense, GradientIsThatOfCentralDifferences) {
  Random random;
  LargestDeviation largest;
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 500; ++i) {
    const ToothSet z = random.teeth(GetParam());
    const std::array<double, 8> x{random.between(0.8, 1.0),  random.between(0.8, 1.0),
                                  random.between(0.8, 1.0),  random.between(-1.0, 1.0),
                                  random.between(-1.0, 1.0), random.between(-1.0, 1.0),
                                  random.between(-1.0, 1.0), random.between(1.0, 3.0)};
    const auto train_at = [&](const auto& y) {
      using T = std::decay_t<decltype(y[0])>;
      LoadedTrain<T> t{
          .teeth = z,
          .efficiency = {},
          .known = {.sun = y[3], .planet = y[4], .pin = y[5], .carrier = y[6], .ring2 = T(0.1)},
          .given_end = End::kOutput,
          .given_torque_Nm = y[7]};
      for (std::size_t k = 0; k < kMeshCount; ++k) t.efficiency[k].fill(y[k]);
      return solve_power_flow<T>(t).value();
    };
    std::array<Jet1, 8> jets;
    for (std::size_t k = 0; k < 8; ++k) jets[k] = Jet1(x[k], static_cast<int>(k));
    const PowerFlow<Jet1> flow = train_at(jets);
    const double scale = std::abs(flow.sun_torque_Nm.a) + std::abs(flow.mesh_torque_Nm[1].a) + 3.0;
    for (std::size_t k = 0; k < 8; ++k) {
      auto above = x;
      auto below = x;
      above[k] += kStep;
      below[k] -= kStep;
      const auto up = train_at(above);
      const auto down = train_at(below);
      if (up.gear1_drives != down.gear1_drives) continue;  // a kink between
      const int v = static_cast<int>(k);
      const double allowed = scale * (100.0 * kStep * kStep + 64.0 * kEps / kStep);
      largest.see(i,
                  flow.sun_torque_Nm.v[v] - (up.sun_torque_Nm - down.sun_torque_Nm) / (2.0 * kStep),
                  allowed);
      for (std::size_t m = 0; m < kMeshCount; ++m) {
        largest.see(
            i,
            flow.mesh_loss_Nm[m].v[v] - (up.mesh_loss_Nm[m] - down.mesh_loss_Nm[m]) / (2.0 * kStep),
            allowed * (1.0 + std::abs(speeds_of(z).rolling[m])));
      }
    }
  }
  largest.expect_allowed("gradient");
}

TEST(PowerFlow, FreeSunLocksWhereTheMarginIsExactlyZero) {
  // eta2 eta3 = G2: R2 would need an infinite torque against the sun's drag.
  const ToothSet z{.S = 12, .P1 = 40, .R1 = 80, .P2 = 20, .R2 = 80};
  ASSERT_EQ(g2(z), 0.5);
  LoadedTrain<double> train{.teeth = z,
                            .efficiency = {{{1.0, 1.0}, {0.5, 0.5}, {1.0, 1.0}}},
                            .known = {.sun = -1.0},
                            .given_end = End::kSun,
                            .given_torque_Nm = 0.0};
  EXPECT_FALSE(solve_power_flow(train).has_value());
  train.efficiency[kMeshP1R1].fill(0.6);
  EXPECT_TRUE(solve_power_flow(train).has_value());
}

TEST(PowerFlow, AMeshThatCannotRunWithADriverLocksThatDirectionOnly) {
  const ToothSet z{.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  LoadedTrain<double> train{.teeth = z,
                            .efficiency = {{{0.9, 0.0}, {0.99, 0.99}, {0.99, 0.99}}},
                            .known = {},
                            .given_end = End::kOutput,
                            .given_torque_Nm = -10.0};
  EXPECT_TRUE(solve_power_flow(train).has_value()) << "sun drives";
  train.given_torque_Nm = 10.0;
  EXPECT_FALSE(solve_power_flow(train).has_value()) << "P1 would drive S";
}

}  // namespace
}  // namespace gear3k::train::power_flow_test
