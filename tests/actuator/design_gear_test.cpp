// A designed train in an actuator: against catalogue values, balances, and effective inertia.
#include "actuator/design_gear.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <variant>

#include "actuator/impedance.hpp"
#include "actuator/reflected.hpp"
#include "design/accelerated_train.hpp"
#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "tests/actuator/reference_actuators.hpp"

namespace gear3k::design_gear_test {
namespace {

using namespace actuator_test;
using actuator::Actuator, actuator::DesignTrain, actuator::DutyCycle;

design::Design example(const char* name) {
  return io::read_design(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/" + name);
}

Actuator with_train(const design::Design& design) {
  Actuator a = hip_reference();
  a.load_inertia_kgm2 = 0.1;
  auto train = std::make_shared<const DesignTrain>(design);
  a.gearbox = actuator::Gearbox{};
  a.gearbox.ratio = train->ratio();
  a.train = std::move(train);
  return a;
}

actuator::Cycle knee() { return walking("knee_walking_digitised.csv", "knee", 25.0); }

/// Without inertia, bearings and drags.
design::Design bare(const char* name) {
  design::Design design = example(name);
  design.masses = {};
  design.shafts = {};
  design.rating.reset();
  return design;
}

TEST(DesignGear, WithConstantFrictionAndNoDragIsACatalogueGearbox) {
  const design::Design design = bare("loaded.toml");
  const Actuator designed = with_train(design);
  Actuator catalogue = designed;
  catalogue.train = nullptr;
  const auto evaluated = design::evaluate(design);
  const auto& efficiency = std::get<design::Evaluation>(evaluated).efficiency;
  catalogue.gearbox.efficiency_forward = *efficiency.forward;
  catalogue.gearbox.efficiency_backward = *efficiency.backward;
  actuator::Cycle resting = knee();
  for (const std::size_t k : {40U, 41U, 42U}) resting.motion[k] = 0.0;
  for (const actuator::Cycle& cycle : {knee(), resting}) {
    const DutyCycle a = run_cycle(designed, cycle);
    const DutyCycle b = run_cycle(catalogue, cycle);
    EXPECT_NEAR(a.drawn_J, b.drawn_J, 1e-12 * b.drawn_J);
    EXPECT_NEAR(a.regenerated_J, b.regenerated_J, 1e-12 * b.drawn_J);
    EXPECT_NEAR(loss_of(a, "S-P1") + loss_of(a, "P1-R1") + loss_of(a, "P2-R2"), loss_of(b, "mesh"),
                1e-12 * b.drawn_J);
    EXPECT_NEAR(a.peak_current_A, b.peak_current_A, 1e-12 * b.peak_current_A);
    EXPECT_NEAR(a.shares->backdriven, b.shares->backdriven, 1e-11);
    EXPECT_LT(a.balance_error, 1e-12);
  }
  const auto ra = reflected(designed);
  const auto rb = reflected(catalogue);
  EXPECT_NEAR(*ra.speeding_up_kgm2, *rb.speeding_up_kgm2, 1e-12);
  EXPECT_NEAR(*ra.slowing_down_kgm2, *rb.slowing_down_kgm2, 1e-12);
}

TEST(DesignGear, ItsFirstHarmonicIsThatOfTheCatalogueGearbox) {
  const design::Design design = bare("loaded.toml");
  Actuator designed = with_train(design);
  designed.motor.coulomb_Nm = 0.002;
  Actuator catalogue = designed;
  catalogue.train = nullptr;
  const auto evaluated = design::evaluate(design);
  const auto& efficiency = std::get<design::Evaluation>(evaluated).efficiency;
  catalogue.gearbox.efficiency_forward = *efficiency.forward;
  catalogue.gearbox.efficiency_backward = *efficiency.backward;
  const actuator::ImpedanceTask task{
      .low_Hz = 2.0, .high_Hz = 2.0, .points = 1, .amplitude_rad = 0.3};
  const auto a = impedance(designed, task).front();
  const auto b = impedance(catalogue, task).front();
  EXPECT_NEAR(std::abs(*a.first_harmonic_Nms - *b.first_harmonic_Nms), 0.0,
              1e-5 * std::abs(*b.first_harmonic_Nms));
}

TEST(DesignGear, ALedgerWithDragsAndBodiesCloses) {
  design::Design design = example("ratio_96_with_losses.toml");
  design.masses.sun_kgm2 = 1e-6;
  design.masses.planet1_kgm2 = 2e-5;
  design.masses.planet2_kgm2 = 1e-5;
  design.masses.planet_mass_kg = 0.05;
  design.masses.carrier_kgm2 = 3e-5;
  design.masses.ring2_kgm2 = 2e-4;
  Actuator a = with_train(design);
  auto train = std::make_shared<DesignTrain>(*a.train);
  train->least_friction_speed_rad_s = 0.1;
  a.train = train;
  ASSERT_GT(a.train->inertia_kgm2(), 1e-3);
  const DutyCycle d = run_cycle(a, knee());
  EXPECT_GT(loss_of(d, "drag_S"), 0.0);
  // Friction by speed and load is no polynomial; the power of every node balances all the same,
  // and the change of the kinetic energy, integrated by itself, is a polynomial.
  EXPECT_LT(d.balance_error, 1e-12);
  const DutyCycle back = [&] {
    actuator::Cycle cycle = knee();
    for (double& x : cycle.load_Nm) x = -x;
    for (double& x : cycle.motion) x = -x;
    return run_cycle(a, cycle);
  }();
  EXPECT_EQ(d.drawn_J, back.drawn_J);
  EXPECT_EQ(d.regenerated_J, back.regenerated_J);
}

TEST(AcceleratedTrain, HasTheEffectiveInertiaOfItsBodies) {
  design::Design design = bare("loaded.toml");
  design.masses.sun_kgm2 = 1e-6;
  design.masses.planet1_kgm2 = 2e-5;
  design.masses.planet2_kgm2 = 1e-5;
  design.masses.planet_mass_kg = 0.05;
  design.masses.carrier_kgm2 = 3e-5;
  design.masses.ring2_kgm2 = 2e-4;
  const auto evaluated = design::evaluate(design);
  const auto& inertia = *std::get<design::Evaluation>(evaluated).inertia;
  Actuator a = with_train(design);
  a.motor.rotor_inertia_kgm2 = 0.0;
  a.load_inertia_kgm2 = 0.0;
  EXPECT_NEAR(a.train->inertia_kgm2(), inertia.lossless_kgm2, 1e-15);
  EXPECT_NEAR(*reflected(a).speeding_up_kgm2, *inertia.backward_kgm2, 1e-14);
}

TEST(AcceleratedTrain, WithoutAccelerationIsTheOperationOfTheTrain) {
  const design::Design design = example("ratio_96_with_losses.toml");
  const DesignTrain train(design);
  const design::LossyTrain<double> lossy = design::lossy_train(design, train.geometry());
  const double sun_speed = 60.0;
  const auto expected = operate<double>(lossy,
                                        {.sun_speed_rad_s = sun_speed,
                                         .output_torque_Nm = 12.0,
                                         .temperature_K = train.temperature_k()},
                                        design::Direction::kForward)
                            .operation;
  ASSERT_TRUE(expected);
  const auto found = design::balance_motion(
      {.lossy = lossy, .bodies = {}}, {.output_speed_rad_s = sun_speed / std::abs(train.ratio()),
                                       .given_torque_Nm = -12.0,
                                       .temperature_K = train.temperature_k()});
  ASSERT_TRUE(found.instant);
  EXPECT_NEAR(std::abs(found.instant->sun_torque_Nm), expected->sun_torque_Nm,
              1e-12 * expected->sun_torque_Nm);
  EXPECT_NEAR(found.instant->bearing_loss_W, expected->bearing_loss_W, 1e-12);
}

}  // namespace
}  // namespace gear3k::design_gear_test
