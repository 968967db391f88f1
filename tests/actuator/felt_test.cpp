// What is felt at the output while the motor holds a torque.
#include "actuator/felt.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <variant>

#include "actuator/design_gear.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "tests/actuator/reference_actuators.hpp"

namespace gear3k::felt_test {
namespace {

using namespace actuator_test;
using actuator::Actuator, actuator::FeltTorque;

TEST(Felt, TorquesAreThoseOfTheBalanceOfBothSides) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.1, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    Actuator a = first_reference();
    a.motor.coulomb_Nm = 0.01 * share(random);
    a.gearbox.efficiency_forward = share(random);
    a.gearbox.efficiency_backward = share(random);
    a.gearbox.coulomb_Nm = 2.0 * share(random);
    const double motor = 1.0 + 30.0 * share(random);
    const FeltTorque felt = felt_torque(a, motor);
    const double c1 = a.gearbox.ratio * a.motor.coulomb_Nm;
    // Moving with it the mesh drives or, against much drag, is driven.
    const double mesh = a.gearbox.efficiency_forward * (motor - c1);
    const double with = mesh - a.gearbox.coulomb_Nm;
    const double against = (motor + c1) / a.gearbox.efficiency_backward + a.gearbox.coulomb_Nm;
    ASSERT_TRUE(felt.moving_with_Nm && felt.pushed_back_Nm);
    EXPECT_NEAR(*felt.moving_with_Nm, with, 1e-12 * against);
    EXPECT_NEAR(*felt.pushed_back_Nm, against, 1e-12 * against);
    if (felt.transparency) {
      EXPECT_NEAR(*felt.transparency, (against - with) / (0.5 * (against + with)), 1e-11);
    }
  }
}

TEST(Felt, WithoutLossesIsTransparentAndSelfLockingIsNotPushedBack) {
  Actuator a = second_reference();
  a.gearbox.efficiency_forward = a.gearbox.efficiency_backward = 1.0;
  EXPECT_NEAR(felt_torque(a, 5.0).transparency.value(), 0.0, 1e-12);
  a.gearbox.efficiency_backward = -0.1;
  const FeltTorque locked = felt_torque(a, 5.0);
  EXPECT_FALSE(locked.pushed_back_Nm);
  EXPECT_FALSE(locked.transparency);
  a.motor.coulomb_Nm = 1.0;
  EXPECT_FALSE(felt_torque(a, 5.0).moving_with_Nm) << "the motor's own friction holds it";
}

TEST(Felt, OfADesignWithConstantFrictionIsThatOfItsEfficiencies) {
  design::Design design =
      io::read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/loaded.toml");
  design.masses = {};
  design.shafts = {};
  design.rating.reset();
  Actuator designed = hip_reference();
  auto train = std::make_shared<const actuator::DesignTrain>(design);
  designed.gearbox = actuator::Gearbox{};
  designed.gearbox.ratio = train->ratio();
  designed.train = std::move(train);
  const auto evaluated = design::evaluate(design);
  const auto& efficiency = std::get<design::Evaluation>(evaluated).efficiency;
  const FeltTorque felt = felt_torque(designed, 10.0);
  EXPECT_NEAR(felt.moving_with_Nm.value(), 10.0 * *efficiency.forward, 1e-9);
  EXPECT_NEAR(felt.pushed_back_Nm.value(), 10.0 / *efficiency.backward, 1e-9);
}

}  // namespace
}  // namespace gear3k::felt_test
