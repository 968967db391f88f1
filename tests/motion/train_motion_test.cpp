// A designed train moved forward: against catalogue values and by its balances.
#include <gtest/gtest.h>

#include <memory>
#include <variant>

#include "actuator/design_gear.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "tests/motion/moving_actuators.hpp"

namespace gear3k::train_motion_test {
namespace {

using namespace motion_test;

design::Design loaded() {
  return io::read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/loaded.toml");
}

Actuator with_train(const design::Design& design) {
  Actuator a = plain_actuator({.fast_kgm2 = 2e-5, .output_kgm2 = 0.05}, 1.0, 1.0);
  a.motor.resistance_ohm = 0.6;
  a.motor.torque_constant_Nm_A = 0.04;
  a.motor.coulomb_Nm = a.motor.static_Nm = 0.003;
  auto train = std::make_shared<const actuator::DesignTrain>(design);
  a.gearbox.ratio = train->ratio();
  a.train = std::move(train);
  return a;
}

Scenario swing() {
  Scenario s;
  s.duration_s = 1.5;
  s.start_angle_rad = 0.3;
  s.command = {.amplitude = 0.08, .frequency_Hz = 0.9};
  s.load.pendulum = {.mass_kg = 1.5, .length_m = 0.3};
  s.solver.relative_tolerance = 1e-8;
  s.solver.absolute_tolerance = 1e-10;
  s.sample_s = 0.1;
  return s;
}

TEST(TrainMotion, WithConstantFrictionAndNoDragIsACatalogueGearbox) {
  design::Design design = loaded();
  design.masses = {};
  design.shafts = {};
  design.rating.reset();
  for (const double gap : {0.0, 0.01}) {
    Actuator designed = with_train(design);
    designed.gearbox.backlash_rad = gap;
    Actuator catalogue = designed;
    catalogue.train = nullptr;
    const auto evaluated = design::evaluate(design);
    const auto& efficiency = std::get<design::Evaluation>(evaluated).efficiency;
    catalogue.gearbox.efficiency_forward = *efficiency.forward;
    catalogue.gearbox.efficiency_backward = *efficiency.backward;
    const Motion a = simulate(designed, swing());
    EXPECT_TRUE(a.notes.empty());
    const Motion b = simulate(catalogue, swing());
    ASSERT_EQ(a.events.size(), b.events.size());
    ASSERT_GT(a.events.size(), 2U);
    for (std::size_t k = 0; k < a.events.size(); ++k) {
      EXPECT_EQ(a.events[k].what, b.events[k].what);
      EXPECT_NEAR(a.events[k].time_s, b.events[k].time_s, 1e-6);
    }
    EXPECT_NEAR(a.end.sides.output_rad, b.end.sides.output_rad, 1e-6);
    const double meshes = loss_of(a, "S-P1") + loss_of(a, "P1-R1") + loss_of(a, "P2-R2");
    EXPECT_NEAR(meshes, loss_of(b, "mesh"), 1e-6);
  }
}

TEST(TrainMotion, ItsBacklashIsTheLostMotionOfTheDesign) {
  const auto evaluated = design::evaluate(loaded());
  EXPECT_NEAR(actuator::DesignTrain(loaded()).backlash_rad(),
              std::get<design::Evaluation>(evaluated).lost_motion.kinematic_rad, 1e-15);
}

TEST(TrainMotion, ItsLedgerClosesWithDragsBearingsAndInertia) {
  for (const double gap : {0.0, 0.005}) {
    Actuator a = with_train(loaded());
    a.gearbox.backlash_rad = gap;
    Scenario s = swing();
    s.solver.relative_tolerance = 1e-10;
    const Motion m = simulate(a, s);
    EXPECT_LT(m.ledger.balance_error, 1e-9);
    EXPECT_TRUE(m.complete);
    EXPECT_GT(m.events.size(), 2U);
  }
}

}  // namespace
}  // namespace gear3k::train_motion_test
