#include "design/measured_lost_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "backlash/lost_motion.hpp"
#include "tests/random_train.hpp"

namespace gear3k::design::measured_lost_motion_test {
namespace {

/// The low-backlash prototypes' kind of train, with some backlash.
train::TrainParameters<double> some_train() {
  train::TrainParameters<double> p{};
  p.teeth = {.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 81};
  p.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.center_distance_m = 21.268e-3;
  p.module_m = {0.8e-3, 0.8467e-3};
  p.profile_shift = {0.476, 0.762, 2.0, 0.536, 2.0};
  p.machining_allowance.fill(0.02);
  return p;
}

/// Lost motion from pitch and tooth thicknesses on the working pitch circles at a distance: own
/// formulas, with the output's share of each mesh by kinematics in the carrier's frame.
double rigid_by_thicknesses(const train::TrainParameters<double>& p) {
  const auto inv = [](double a) { return std::tan(a) - a; };
  const double alpha = p.pressure_angle_rad;
  const auto z = train::teeth_of(p.teeth);
  const auto backlash = [&](std::size_t first, std::size_t second, double module, bool ring) {
    const double z1 = z[first];
    const double z2 = z[second];
    const double base1 = 0.5 * module * z1 * std::cos(alpha);
    const double base2 = 0.5 * module * z2 * std::cos(alpha);
    const double working = std::acos((ring ? base2 - base1 : base1 + base2) / p.center_distance_m);
    const double r1 = base1 / std::cos(working);
    const double r2 = base2 / std::cos(working);
    const auto thickness = [&](double r, double teeth, std::size_t gear, bool is_ring) {
      const double sign = is_ring ? -1.0 : 1.0;
      const double half_angle =
          (0.5 * std::numbers::pi + sign * 2.0 * p.profile_shift[gear] * std::tan(alpha)) / teeth +
          sign * (inv(alpha) - inv(working));
      // The thinning is normal to the flank: of arc on the base circle.
      return r * (2.0 * half_angle -
                  p.machining_allowance[gear] * module / (0.5 * module * teeth * std::cos(alpha)));
    };
    const double pitch = 2.0 * std::numbers::pi * r1 / z1;
    return (pitch - thickness(r1, z1, first, false) - thickness(r2, z2, second, ring)) *
           std::cos(working);
  };
  const double cos_alpha = std::cos(alpha);
  const double j1 = backlash(0, 1, p.module_m[0], false);
  const double j2 = backlash(1, 2, p.module_m[0], true);
  const double j3 = backlash(3, 4, p.module_m[1], true);
  const double g1 = static_cast<double>(p.teeth.R1) / p.teeth.S;
  const double g2 = static_cast<double>(p.teeth.P2) * p.teeth.R1 / (p.teeth.P1 * p.teeth.R2);
  const double ratio = std::abs((1.0 + g1) / (1.0 - g2));
  const double base = 0.5 * cos_alpha;
  return j1 / (ratio * base * p.module_m[0] * p.teeth.S) +
         j2 * (g1 + g2) / ((1.0 + g1) * base * p.module_m[0] * p.teeth.R1) +
         j3 / (base * p.module_m[1] * p.teeth.R2);
}

TEST(MeasuredLostMotion, WithoutExtensionIsThatOfRigidBodiesBitForBit) {
  const auto p = some_train();
  const auto train = train::make_train_geometry(p);
  ASSERT_TRUE(train);
  const double rigid = backlash::output_lost_motion(*train, backlash::normal_backlashes(*train),
                                                    backlash::LostMotionModel::kKinematic);
  EXPECT_EQ(*measured_lost_motion<double>(p, {}, {.torque_Nm = 5.0, .temperature_K = 350.0}),
            rigid);
  EXPECT_EQ(
      *measured_lost_motion<double>(p, *train, {}, {.torque_Nm = 5.0, .temperature_K = 350.0}),
      rigid);
}

TEST(MeasuredLostMotion, HardeningLeavesTheWindUpAtItsTorqueAndRaisesItBelow) {
  const auto p = some_train();
  const auto wound = [&](double hardening, double torque_Nm) {
    const backlash::LostMotionExtension<double> e{
        .compliance_rad_Nm = 2e-5, .hardening = hardening, .hardening_torque_Nm = 8.0};
    const LostMotionTest<double> rest{.torque_Nm = 0.0, .temperature_K = 293.15};
    const LostMotionTest<double> test{.torque_Nm = torque_Nm, .temperature_K = 293.15};
    return *measured_lost_motion<double>(p, e, test) - *measured_lost_motion<double>(p, e, rest);
  };
  constexpr double kRounding = 1e-15;
  EXPECT_NEAR(wound(0.4, 8.0), 2.0 * 8.0 * 2e-5, kRounding);
  // A power of the torque: doubled, it winds up 2^(1 − h) times as far.
  EXPECT_NEAR(wound(0.4, 4.0) / wound(0.4, 2.0), std::pow(2.0, 0.6), 1e-9);
  EXPECT_GT(wound(0.4, 2.0), wound(0.0, 2.0));
  EXPECT_LT(wound(-0.4, 2.0), wound(0.0, 2.0));
}

TEST(MeasuredLostMotion, APreloadedWindUpGrowsStifferInProportionToPreloadAndTorque) {
  const backlash::LostMotionExtension<double> e{
      .compliance_rad_Nm = 2e-5, .hardening_torque_Nm = 8.0, .preload_torque_Nm = 1.5};
  EXPECT_TRUE(changes_lost_motion(e));
  EXPECT_EQ(backlash::windup(e, 0.0), 0.0);
  EXPECT_NEAR(backlash::windup(e, 8.0), 2.0 * 8.0 * 2e-5, 1e-18);
  // Slopes by central differences: dφ/dT (T_p + T) is the same at every torque.
  const auto slope = [&](double torque_Nm) {
    constexpr double kStep = 1e-4;
    return (backlash::windup(e, torque_Nm + kStep) - backlash::windup(e, torque_Nm - kStep)) /
           (2.0 * kStep);
  };
  for (const double torque_Nm : {0.5, 2.0, 12.0}) {
    EXPECT_NEAR(slope(torque_Nm) * (1.5 + torque_Nm), slope(1.0) * 2.5, 1e-7 * slope(1.0));
  }
  // Far above all torques it is the straight wind-up.
  auto stiff = e;
  stiff.preload_torque_Nm = 8e6;
  EXPECT_NEAR(backlash::windup(stiff, 2.0), 2.0 * 2.0 * 2e-5, 1e-10);
  const auto p = some_train();
  EXPECT_NEAR(*measured_lost_motion<double>(p, e, {.torque_Nm = 8.0}),
              rigid_by_thicknesses(p) + 3.2e-4, 1e-13);
}

TEST(MeasuredLostMotion, ClearanceAddsAndWindUpIsTwiceTorqueTimesCompliance) {
  const auto p = some_train();
  const double rigid = rigid_by_thicknesses(p);
  const auto measured = measured_lost_motion<double>(
      p, {.clearance_rad = 1e-3, .compliance_rad_Nm = 2e-4}, {.torque_Nm = 3.0});
  ASSERT_TRUE(measured);
  EXPECT_NEAR(*measured, rigid + 1e-3 + 1.2e-3, 1e-13);
}

TEST(MeasuredLostMotion, ASoftWindUpAloneIsAChangeAndCountsUpToItsTorque) {
  const auto p = some_train();
  const backlash::LostMotionExtension<double> e{
      .soft = {{{.windup_rad = 1.2e-3, .torque_Nm = 8.0}}}};
  EXPECT_TRUE(changes_lost_motion(e));
  EXPECT_FALSE(changes_lost_motion(backlash::LostMotionExtension<double>{}));
  const double rigid = rigid_by_thicknesses(p);
  EXPECT_NEAR(*measured_lost_motion<double>(p, e, {.torque_Nm = 2.0}), rigid + 0.3e-3, 1e-13);
  EXPECT_NEAR(*measured_lost_motion<double>(p, e, {.torque_Nm = 20.0}), rigid + 1.2e-3, 1e-13);
}

TEST(MeasuredLostMotion, ExpansionIsTheRigidTrainAtTheWarmDistance) {
  const auto p = some_train();
  for (const double kelvin : {-40.0, 0.0, 60.0}) {
    const double alpha = 24e-6;
    auto warm = p;
    warm.center_distance_m *= 1.0 + alpha * kelvin;
    const auto measured =
        measured_lost_motion<double>(p, {.expansion_1_K = alpha, .reference_temperature_K = 300.0},
                                     {.torque_Nm = 0.0, .temperature_K = 300.0 + kelvin});
    ASSERT_TRUE(measured);
    EXPECT_NEAR(*measured, rigid_by_thicknesses(warm), 1e-12);
  }
}

TEST(MeasuredLostMotion, WithoutAWorkingAngleThereIsNone) {
  const auto p = some_train();
  EXPECT_FALSE(
      measured_lost_motion<double>(p, {.expansion_1_K = -1e-2}, {.temperature_K = 313.15}));
}

TEST(MeasuredLostMotion, GradientsAreThoseOfCentralDifferences) {
  const auto p = some_train();
  train::TrainParameters<Jet1> j;
  j.teeth = p.teeth;
  j.planets = p.planets;
  j.pressure_angle_rad = constant<Jet1>(p.pressure_angle_rad);
  j.center_distance_m = constant<Jet1>(p.center_distance_m);
  for (std::size_t k = 0; k < 2; ++k) j.module_m[k] = constant<Jet1>(p.module_m[k]);
  for (std::size_t k = 0; k < train::kGearCount; ++k) {
    j.profile_shift[k] = constant<Jet1>(p.profile_shift[k]);
    j.machining_allowance[k] = constant<Jet1>(p.machining_allowance[k]);
    j.rack[k] = {.addendum = constant<Jet1>(1.0),
                 .dedendum = constant<Jet1>(1.25),
                 .root_radius = constant<Jet1>(0.38)};
  }
  const auto at = [&](double alpha) {
    return *measured_lost_motion<double>(p, {.clearance_rad = 1e-3, .expansion_1_K = alpha},
                                         {.torque_Nm = 2.0, .temperature_K = 320.0});
  };
  // Also where α is 0: its slope is not.
  for (const double alpha : {0.0, 20e-6}) {
    const auto jet = measured_lost_motion<Jet1>(
        j,
        {.clearance_rad = Jet1(1e-3, 0),
         .compliance_rad_Nm = Jet1(0.0, 1),
         .expansion_1_K = Jet1(alpha, 2)},
        {.torque_Nm = constant<Jet1>(2.0), .temperature_K = constant<Jet1>(320.0)});
    ASSERT_TRUE(jet);
    EXPECT_EQ(jet->v[0], 1.0);
    EXPECT_EQ(jet->v[1], 4.0);
    const double slope = (at(alpha + 1e-7) - at(alpha - 1e-7)) / 2e-7;
    EXPECT_NEAR(jet->v[2], slope, 1e-6 * std::abs(slope));
  }
}

}  // namespace
}  // namespace gear3k::design::measured_lost_motion_test
