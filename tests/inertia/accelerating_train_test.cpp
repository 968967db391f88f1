// The effective inertia against a simulation in time of a train that a constant torque accelerates.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "inertia/effective_inertia.hpp"
#include "numerics/linear_algebra.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::inertia::accelerating_train_test {
namespace {

constexpr std::size_t kBodies = 4;  // sun, planets, carrier, R2
constexpr std::size_t kMeshes = 3;
enum Body : std::size_t { kSun, kPlanets, kCarrier, kOutput };

/// Sun, carrier, R2 and the planets (all N as one) as bodies of their own; each mesh is a stiff
/// spring and damper along its pitch line.  Lengths in half modules: radii are tooth numbers.
class ElasticTrain {
 public:
  ElasticTrain(const InertialTrain<double>& t, const DirectionalEfficiencies<double>& eta)
      : eta_(eta) {
    const auto& b = t.bodies;
    const double n = t.planets;
    const double orbit = n * b.planet_mass_kg * t.center_distance_m * t.center_distance_m;
    inertia_ = {b.sun_kgm2, n * (b.planet1_kgm2 + b.planet2_kgm2), b.carrier_kgm2 + orbit,
                b.ring2_kgm2};
    const auto& z = t.teeth;
    central_radius_ = {1.0 * z.S, 1.0 * z.R1, 1.0 * z.R2};
    // Where the planet's pitch radius lies from its centre: towards the axis at the sun, away from
    // it at the rings.
    planet_radius_ = {-1.0 * z.P1, 1.0 * z.P1, 1.0 * z.P2};
    const bool g2_below_one = z.P2 * z.R1 < z.P1 * z.R2;
    central_drives_forward_ = {true, !g2_below_one, g2_below_one};
    // Rolling without deflection, R1 at rest, R2 at +1.
    const double planet = -1.0 * z.R1 / z.P1;  // seen from the carrier, at +1
    const double output = 1.0 + planet * z.P2 / z.R2;
    rolling_ = {(1.0 - planet * z.P1 / z.S) / output, (1.0 + planet) / output, 1.0 / output, 1.0};
    choose_springs();
  }

  /// Inertia that the bodies show at `end` as they roll: twice the kinetic energy at unit speed.
  [[nodiscard]] double kinetic(Body end) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kBodies; ++i) sum += inertia_[i] * rolling_[i] * rolling_[i];
    return sum / (rolling_[end] * rolling_[end]);
  }

  /// Torque over the mean acceleration of `end`, after the vibrations of the start have decayed.
  [[nodiscard]] double measured_inertia(Body end) const {
    const double torque = std::copysign(kinetic(end) * std::abs(rolling_[end]), rolling_[end]);
    // The acceleration of R2 is then of order 1; vibration does not reverse any rolling.
    State x{};
    for (std::size_t i = 0; i < kBodies; ++i) x[i] = 1e3 / slowest_ * rolling_[i];
    const double decay = 0.5 * damping_time_ * slowest_ * slowest_;
    const int steps = static_cast<int>(30.0 / decay / step_);
    double middle = 0.0;
    for (int i = 0; i < 2 * steps; ++i) {
      if (i == steps) middle = x[end];
      x = runge_kutta_step(x, end, torque);
    }
    return torque / ((x[end] - middle) / (steps * step_));
  }

 private:
  /// Speeds of the bodies, deflections of the meshes.
  using State = std::array<double, kBodies + kMeshes>;

  /// Speeds of the central gears; R1 stands.
  static std::array<double, kMeshes> central_speeds(const State& x) {
    return {x[kSun], 0.0, x[kOutput]};
  }

  [[nodiscard]] State rates(const State& x, Body end, double torque) const {
    const auto central = central_speeds(x);
    std::array<double, kBodies> moment{};
    moment[end] = torque;
    State rate{};
    for (std::size_t k = 0; k < kMeshes; ++k) {
      // Speeds of the pitch points, seen from the carrier.
      const double v_central = (central[k] - x[kCarrier]) * central_radius_[k];
      const double v_planet = (x[kPlanets] - x[kCarrier]) * planet_radius_[k];
      const double closing = v_central - v_planet;
      rate[kBodies + k] = closing;
      // Force of the central gear on the planet along the pitch line.
      const double force = stiffness_[k] * (x[kBodies + k] + damping_time_ * closing);
      const bool central_drives = force * v_central > 0.0;
      const double eta =
          central_drives == central_drives_forward_[k] ? eta_.forward[k] : eta_.backward[k];
      const double on_central = -force * central_radius_[k] * (central_drives ? 1.0 : eta);
      const double on_planet = force * planet_radius_[k] * (central_drives ? eta : 1.0);
      if (k == 0) moment[kSun] += on_central;
      if (k == 2) moment[kOutput] += on_central;
      moment[kPlanets] += on_planet;
      moment[kCarrier] -= on_central + on_planet;  // angular momentum is kept in the contact
    }
    for (std::size_t i = 0; i < kBodies; ++i) rate[i] = moment[i] / inertia_[i];
    return rate;
  }

  [[nodiscard]] State runge_kutta_step(const State& x, Body end, double torque) const {
    const auto along = [](const State& from, const State& rate, double h) {
      State to = from;
      for (std::size_t i = 0; i < to.size(); ++i) to[i] += h * rate[i];
      return to;
    };
    const State a = rates(x, end, torque);
    const State b = rates(along(x, a, 0.5 * step_), end, torque);
    const State c = rates(along(x, b, 0.5 * step_), end, torque);
    const State d = rates(along(x, c, step_), end, torque);
    State next = x;
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] += step_ / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
    }
    return next;
  }

  /// Springs for frequencies of order 1 without losses; damping that is critical in the slowest
  /// mode, and the step at which the fastest is stable.
  void choose_springs() {
    Eigen::Matrix4d mass = Eigen::Matrix4d::Zero();
    Eigen::Matrix4d spring = Eigen::Matrix4d::Zero();
    for (std::size_t i = 0; i < kBodies; ++i) {
      mass(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) = inertia_[i];
    }
    for (std::size_t k = 0; k < kMeshes; ++k) {
      Eigen::Vector4d deflection = Eigen::Vector4d::Zero();
      if (k == 0) deflection[kSun] = central_radius_[k];
      if (k == 2) deflection[kOutput] = central_radius_[k];
      deflection[kPlanets] = -planet_radius_[k];
      deflection[kCarrier] = planet_radius_[k] - central_radius_[k];
      stiffness_[k] = 1.0 / deflection.cwiseAbs2().cwiseQuotient(mass.diagonal()).sum();
      spring += stiffness_[k] * deflection * deflection.transpose();
    }
    const Eigen::Vector4d root = mass.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd squares =
        numerics::symmetric_eigenvalues(root.asDiagonal() * spring * root.asDiagonal());
    slowest_ = std::sqrt(squares[1]);  // the first is rolling
    const double fastest = std::sqrt(squares[3]);
    damping_time_ = 1.0 / slowest_;
    step_ = 0.5 * std::min(2.0 / (damping_time_ * fastest * fastest), 1.0 / fastest);
  }

  DirectionalEfficiencies<double> eta_;
  std::array<double, kBodies> inertia_{}, rolling_{};
  std::array<double, kMeshes> central_radius_{}, planet_radius_{}, stiffness_{};
  std::array<bool, kMeshes> central_drives_forward_{};
  double slowest_ = 0.0, damping_time_ = 0.0, step_ = 0.0;
};

class Random : public RandomTrain {
 public:
  Random() : RandomTrain(33) {}
  InertialTrain<double> train(bool g2_below_one) {
    return {.teeth = teeth(g2_below_one),
            .planets = count(1, 6),
            .center_distance_m = between(10e-3, 40e-3),
            .bodies = {.sun_kgm2 = between(1e-7, 1e-5),
                       .planet1_kgm2 = between(1e-7, 1e-5),
                       .planet2_kgm2 = between(1e-7, 1e-5),
                       .planet_mass_kg = between(5e-3, 0.2),
                       .carrier_kgm2 = between(1e-6, 1e-4),
                       .ring2_kgm2 = between(1e-5, 1e-3)}};
  }
  DirectionalEfficiencies<double> efficiencies(double least) {
    DirectionalEfficiencies<double> eta{};
    for (std::size_t k = 0; k < kMeshes; ++k) {
      eta.forward[k] = between(least, 1.0);
      eta.backward[k] = std::min(1.0, eta.forward[k] * between(0.99, 1.01));
    }
    return eta;
  }
};

constexpr DirectionalEfficiencies<double> kLossless{.forward = {1.0, 1.0, 1.0},
                                                    .backward = {1.0, 1.0, 1.0}};

/// What the vibrations of the start leave (e^-30 of them at the middle, over the second half), and
/// the rounding of speeds that grow over some thousand steps.
constexpr double kTruncation = 1e-8;

class ElasticTrainOfEitherSense : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Trains, ElasticTrainOfEitherSense, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& below) {
                           return below.param ? "G2BelowOne" : "G2AboveOne";
                         });

TEST_P(ElasticTrainOfEitherSense, EffectiveInertiaIsTheTorqueOverTheAccelerationOfAnElasticTrain) {
  Random random;
  LargestDeviation forward, backward;
  int driven_back = 0;
  double greatest_share_of_losses = 0.0;
  for (int i = 0; i < 12; ++i) {
    const auto t = random.train(GetParam());
    const auto eta = random.efficiencies(i % 2 == 0 ? 0.98 : 0.93);
    const ElasticTrain train(t, eta);
    const auto from_sun = effective_inertia(t, eta, true);
    ASSERT_TRUE(from_sun) << "case " << i;
    forward.see(i, train.measured_inertia(kSun) / *from_sun - 1.0, kTruncation);
    const auto from_output = effective_inertia(t, eta, false);
    if (!from_output) continue;  // cannot be driven back
    ++driven_back;
    backward.see(i, train.measured_inertia(kOutput) / *from_output - 1.0, kTruncation);
    greatest_share_of_losses =
        std::max(greatest_share_of_losses, 1.0 - train.kinetic(kOutput) / *from_output);
  }
  forward.expect_allowed("forward");
  backward.expect_allowed("backward");
  EXPECT_GT(driven_back, 5);
  EXPECT_GT(greatest_share_of_losses, 0.1);
}

TEST_P(ElasticTrainOfEitherSense,
       LosslessInertiaIsTheTorqueOverTheAccelerationAndTheKineticEnergy) {
  Random random;
  LargestDeviation simulated, energy;
  for (int i = 0; i < 6; ++i) {
    const auto t = random.train(GetParam());
    const ElasticTrain train(t, kLossless);
    const double lossless = lossless_inertia(t);
    const double ratio = train::ratio(t.teeth);
    energy.see(i, train.kinetic(kOutput) / lossless - 1.0, 1e-12);
    simulated.see(i, train.measured_inertia(kOutput) / lossless - 1.0, kTruncation);
    simulated.see(i, train.measured_inertia(kSun) * ratio * ratio / lossless - 1.0, kTruncation);
  }
  simulated.expect_allowed("simulated");
  energy.expect_allowed("energy");
}

}  // namespace
}  // namespace gear3k::inertia::accelerating_train_test
