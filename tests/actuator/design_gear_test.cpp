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

design::Design with_bodies(design::Design design) {
  design.masses.sun_kgm2 = 1e-6;
  design.masses.planet1_kgm2 = 2e-5;
  design.masses.planet2_kgm2 = 1e-5;
  design.masses.planet_mass_kg = 0.05;
  design.masses.carrier_kgm2 = 3e-5;
  design.masses.ring2_kgm2 = 2e-4;
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
  const design::Design design = with_bodies(example("ratio_96_with_losses.toml"));
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

// Drag holds the output at rest until the load is greater: what the motor holds has a kink there.
TEST(DesignGear, HoldingALoadAgainstADragCostsTheSameInOneRowAndInMany) {
  design::Design design = bare("loaded.toml");
  design.shafts.drag[design::kOutputShaft].constant_Nm = 3.0;
  const Actuator a = with_train(design);
  const auto held = [&](int rows, double load_Nm) {
    actuator::Cycle cycle;
    for (int k = 0; k <= rows; ++k) {
      cycle.time_s.push_back(static_cast<double>(k) / rows);
      cycle.motion.push_back(0.0);
      cycle.load_Nm.push_back(load_Nm * k / rows);
    }
    return loss_of(run_cycle(a, cycle), "copper");
  };
  for (const double load_Nm : {4.5, -6.0}) {
    const double exact = held(1, load_Nm);
    EXPECT_GT(exact, 0.0);
    EXPECT_NEAR(held(4000, load_Nm), exact, 1e-7 * exact) << load_Nm;
  }
}

TEST(AcceleratedTrain, HasTheEffectiveInertiaOfItsBodies) {
  const design::Design design = with_bodies(bare("loaded.toml"));
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

TEST(PreparedTrain, OfConstantFrictionHasTheBitsOfTheIteration) {
  // (F/F_0)^0 is 1, and a law that knows the load is iterated.
  design::Design design = bare("loaded.toml");
  const DesignTrain constant(design);
  design.friction.law = efficiency::FrictionLaw::kLoadPower;
  design.friction.load_exponent = 0.0;
  design.friction.reference_force_N = 1.0;
  const DesignTrain iterated(design);
  const auto a = actuator::prepared(constant);
  const auto b = actuator::prepared(iterated);
  ASSERT_TRUE(a.is_linear());
  ASSERT_FALSE(b.is_linear());
  for (const auto end : {train::End::kOutput, train::End::kSun}) {
    for (const double torque : {-7.0, -0.3, 0.4, 12.0}) {
      const design::TrainMotion motion{.output_speed_rad_s = 1.7,
                                       .output_acceleration_rad_s2 = -3.0,
                                       .given_end = end,
                                       .given_torque_Nm = torque};
      const auto fixed = a.balance(motion);
      const auto found = b.balance(motion);
      ASSERT_EQ(fixed.instant.has_value(), found.instant.has_value());
      if (!fixed.instant) continue;
      EXPECT_EQ(fixed.instant->sun_torque_Nm, found.instant->sun_torque_Nm);
      EXPECT_EQ(fixed.instant->output_torque_Nm, found.instant->output_torque_Nm);
      EXPECT_EQ(fixed.instant->mesh_loss_W, found.instant->mesh_loss_W);
    }
  }
}

TEST(DesignGear, TheCausesOfItsFirstHarmonicAddUp) {
  const design::Design design = with_bodies(example("ratio_96_with_losses.toml"));
  Actuator a = with_train(design);
  a.motor.coulomb_Nm = 0.002;
  auto train = std::make_shared<DesignTrain>(*a.train);
  train->least_friction_speed_rad_s = 0.1;
  a.train = train;
  const auto point =
      impedance(a, {.low_Hz = 3.0, .high_Hz = 3.0, .points = 1, .amplitude_rad = 0.2}).front();
  ASSERT_TRUE(point.first_harmonic_Nms);
  std::complex<double> sum;
  double magnitude = 0.0;
  for (const auto& cause : point.harmonic_causes) {
    sum += cause.impedance_Nms;
    magnitude += std::abs(cause.impedance_Nms);
    // What a loss takes is taken in every period.
    const bool loss = cause.name.find("inertia") == std::string::npos;
    EXPECT_GE(cause.impedance_Nms.real(), loss ? 0.0 : -1e-12) << cause.name;
  }
  EXPECT_EQ(point.harmonic_causes.size(), 6U + actuator::design_gear_causes().size());
  // 720 midpoints have the mean of |cos| to 4e-7 of it.
  EXPECT_NEAR(std::abs(sum - *point.first_harmonic_Nms), 0.0, 1e-6 * magnitude);
}

}  // namespace
}  // namespace gear3k::design_gear_test
