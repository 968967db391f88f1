#include "design/torque_angle_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <tuple>

#include "efficiency/train_efficiency.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"
#include "tests/strength/spring_network.hpp"

namespace gear3k::design::torque_angle_curve_test {
namespace {

constexpr double kRigid_N_m = 1e18;

/// A train whose springs do not depend on their load.
ElasticTrain constant_springs(const train::TrainGeometry<double>& g,
                              const strength::TrainSprings<double>& springs) {
  ElasticTrain train{.train = strength::locked_train(g, springs), .mesh = {}};
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    train.mesh[k] = {{.normal_N = 1.0, .compliance_m_N = 1.0 / springs.mesh_N_m[k]}};
  }
  return train;
}

strength::TrainSprings<double> rigid_meshes() {
  strength::TrainSprings<double> springs;
  springs.mesh_N_m.fill(kRigid_N_m);
  return springs;
}

strength::MeshDriverEfficiencies<double> even(double eta) {
  strength::MeshDriverEfficiencies<double> result;
  for (auto& mesh : result) mesh = {eta, eta};
  return result;
}
strength::MeshDriverEfficiencies<double> random_efficiencies(RandomTrain& random, double least) {
  strength::MeshDriverEfficiencies<double> result;
  for (auto& mesh : result) mesh = {random.between(least, 1.0), random.between(least, 1.0)};
  return result;
}

TorqueAngleTask task_of(const train::TrainGeometry<double>& g,
                        const strength::MeshDriverEfficiencies<double>& efficiency) {
  return {
      .peak_torque_Nm = 20.0, .lost_motion_rad = 1e-3, .teeth = g.teeth, .efficiency = efficiency};
}

TEST(TorqueAngleCurve, WithoutFrictionLoadingAndUnloadingAreTheLineOfTheStiffness) {
  RandomTrain random(573);
  LargestDeviation angle, loop;
  for (int n = 0; n < 100; ++n) {
    const auto g = random.train(n % 2 == 0);
    const auto springs = strength::random_springs(random);
    const auto curve = torque_angle_loop(constant_springs(g, springs), task_of(g, even(1.0)));
    ASSERT_TRUE(curve);
    const double k = strength::train_stiffness(g, springs).output_Nm_rad;
    for (const std::size_t side : {0U, 1U}) {
      for (const auto& point : curve->branch[side]) {
        angle.see(n, point.angle_rad - (0.5e-3 + point.torque_Nm / k), 1e-9 * 20.0 / k);
      }
    }
    loop.see(n, curve->loop_J, 1e-9 * 20.0 * 20.0 / k);
  }
  angle.expect_allowed("angle");
  loop.expect_allowed("loop");
}

TEST(TorqueAngleCurve, BehindTheTrainASpringIsReachedByTheTrainsEfficiencies) {
  RandomTrain random(574);
  LargestDeviation loading, unloading, area;
  int n = 0;
  while (n < 100) {
    const auto g = random.train(n % 2 == 0);
    const auto eta = random_efficiencies(random, 0.99);
    // Closed forms of the efficiencies, by who drives in each mesh.
    const auto by_driver = [&](bool is_forward) {
      efficiency::MeshEfficiencies<double> result{};
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        result[k] = eta[k][train::gear1_drives(static_cast<train::MeshId>(k),
                                               train::g2(g.teeth) < 1.0, is_forward)
                               ? 0
                               : 1];
      }
      return result;
    };
    const double eta_b = efficiency::backward_efficiency(g.teeth, by_driver(false));
    const double eta_f = efficiency::forward_efficiency(g.teeth, by_driver(true));
    if (!(eta_b > 0.05)) continue;
    auto springs = rigid_meshes();
    springs.sun_shaft_Nm_rad = 100.0;
    const double i = train::ratio(g.teeth);
    const double c = 1.0 / (i * i * 100.0);
    const auto curve = torque_angle_loop(constant_springs(g, springs), task_of(g, eta));
    ASSERT_TRUE(curve) << n;
    const double wound = eta_b * c * 20.0;
    for (const auto& point : curve->branch[0]) {
      loading.see(n, point.angle_rad - 0.5e-3 - eta_b * c * point.torque_Nm, 1e-6 * wound);
    }
    for (const auto& point : curve->branch[1]) {
      // Friction holds until the springs drive the output.
      const double expected = std::min(wound, c * point.torque_Nm / eta_f);
      unloading.see(n, point.angle_rad - 0.5e-3 - expected, 1e-6 * wound);
    }
    // What is spent on a side, less what comes back; the kink lies within a step.
    const double lost = wound * 20.0 * (1.0 - eta_b * eta_f);
    area.see(n, curve->loop_J - lost, 1e-3 * lost + 1e-3 * 20.0 * wound / 100.0);
    ++n;
  }
  loading.expect_allowed("loading");
  unloading.expect_allowed("unloading");
  area.expect_allowed("area");
}

TEST(TorqueAngleCurve, BeforeTheTrainASpringHasNoHysteresis) {
  RandomTrain random(575);
  const auto g = random.train(true);
  auto springs = rigid_meshes();
  springs.ring2_Nm_rad = 1e4;
  const auto curve = torque_angle_loop(constant_springs(g, springs), task_of(g, even(0.98)));
  ASSERT_TRUE(curve);
  EXPECT_NEAR(curve->windup_rad, 20.0 / 1e4, 1e-9 * 20.0 / 1e4);
  EXPECT_NEAR(curve->loop_J, 0.0, 1e-8 * 20.0 * curve->windup_rad);
}

TEST(TorqueAngleCurve, ATrainThatTheOutputCannotDriveKeepsTheTorqueFromWhatIsBehindIt) {
  RandomTrain random(577);
  int n = 0;
  while (n < 30) {
    const auto g = random.train(n % 2 == 0);
    const double eta = 0.95;
    efficiency::MeshEfficiencies<double> all{};
    all.fill(eta);
    if (efficiency::backward_efficiency(g.teeth, all) > -0.05) continue;
    auto springs = rigid_meshes();
    springs.ring2_Nm_rad = 1e4;
    springs.sun_shaft_Nm_rad = 1e-2;
    const auto curve = torque_angle_loop(constant_springs(g, springs), task_of(g, even(eta)));
    ASSERT_TRUE(curve) << n;
    // But for the numerical give of planets that two meshes hold.
    EXPECT_NEAR(curve->windup_rad, 20.0 / 1e4, 1e-5 * 20.0 / 1e4) << n;
    EXPECT_GT(curve->elastic_rad, 1.01 * curve->windup_rad) << n;
    ++n;
  }
}

TEST(TorqueAngleCurve, RigidSpringsLeaveTheLostMotion) {
  RandomTrain random(578);
  const auto g = random.train(true);
  const auto curve = torque_angle_loop(constant_springs(g, rigid_meshes()), task_of(g, even(0.98)));
  ASSERT_TRUE(curve);
  for (std::size_t side = 0; side < curve->branch.size(); ++side) {
    for (const auto& point : curve->branch[side]) {
      EXPECT_NEAR(point.angle_rad, side < 2 ? 0.5e-3 : -0.5e-3, 1e-9);
    }
  }
}

TEST(TorqueAngleCurve, WithoutLostMotionTheSidesMeetAtZeroTorque) {
  RandomTrain random(579);
  const auto g = random.train(false);
  auto task = task_of(g, even(0.99));
  task.lost_motion_rad = 0.0;
  const auto curve = torque_angle_loop(constant_springs(g, strength::random_springs(random)), task);
  ASSERT_TRUE(curve);
  for (const auto& branch : {curve->branch[0].front(), curve->branch[1].back(),
                             curve->branch[2].front(), curve->branch[3].back()}) {
    EXPECT_NEAR(branch.angle_rad, 0.0, 1e-9 * curve->windup_rad);
  }
}

TEST(TorqueAngleCurve, AModelsWindUpIsThatOfEachTorque) {
  RandomTrain random(581);
  const auto g = random.train(true);
  const auto springs = strength::random_springs(random);
  const ElasticTrain train = constant_springs(g, springs);
  const double k = strength::train_stiffness(g, springs).output_Nm_rad;
  for (const bool beyond : {true, false}) {
    auto task = task_of(g, even(1.0));
    task.extension = {.compliance_rad_Nm = 3e-5,
                      .hardening = 0.25,
                      .hardening_torque_Nm = 16.0,
                      .soft = {{{.windup_rad = 2e-3, .torque_Nm = 4.0}}},
                      .beyond_springs = beyond};
    const auto curve = torque_angle_loop(train, task);
    ASSERT_TRUE(curve);
    const auto wound = [&](double torque_Nm) {
      const double soft_rad = torque_Nm < 4.0 ? 0.25e-3 * torque_Nm : 1e-3;
      // T (16/T)^(1/4) = 2 T^(3/4)
      return (beyond ? torque_Nm / k : 0.0) + 3e-5 * 2.0 * std::pow(torque_Nm, 0.75) + soft_rad;
    };
    for (const std::size_t side : {0U, 1U}) {
      for (const auto& point : curve->branch[side]) {
        EXPECT_NEAR(point.angle_rad, 0.5e-3 + wound(point.torque_Nm), 1e-9 * wound(20.0));
      }
    }
    EXPECT_NEAR(curve->elastic_rad, wound(20.0), 1e-9 * wound(20.0));
    for (const StiffnessAtTorque& at : curve->stiffness) {
      const double expected = at.torque_Nm / wound(at.torque_Nm);
      EXPECT_NEAR(at.output_Nm_rad, expected, 1e-9 * expected);
    }
    // Between R2 and the output nothing of it rubs.
    task.efficiency = even(0.98);
    const auto rubbed = torque_angle_loop(train, task);
    task.extension = {};
    const auto plain = torque_angle_loop(train, task);
    ASSERT_TRUE(rubbed && plain);
    EXPECT_GT(plain->loop_J, 0.0);
    EXPECT_NEAR(rubbed->loop_J, plain->loop_J, 1e-9 * 20.0 * wound(20.0));
  }
}

TEST(TorqueAngleCurve, RefusesWhatIsNoLoop) {
  RandomTrain random(580);
  const auto g = random.train(true);
  const ElasticTrain train = constant_springs(g, rigid_meshes());
  for (const auto& [torque_Nm, lost_rad, steps] :
       {std::tuple{0.0, 0.0, 10}, std::tuple{1.0, -1e-4, 10}, std::tuple{1.0, 0.0, 0}}) {
    auto task = task_of(g, even(1.0));
    task.peak_torque_Nm = torque_Nm;
    task.lost_motion_rad = lost_rad;
    task.steps = steps;
    EXPECT_THROW(torque_angle_loop(train, task), std::invalid_argument);
  }
  EXPECT_FALSE(torque_angle_loop(train, task_of(g, even(0.0)))) << "meshes that jam";
}

/// The train with springs that are, up to their peak's force, by turns soft and a hundred times as
/// soft, or that soften by a tenth.
ElasticTrain changing_springs(ElasticTrain train, double peak_torque_Nm, bool jumps) {
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const double compliance = train.mesh[k].front().compliance_m_N;
    const double peak_N =
        peak_torque_Nm * std::abs(train.train.mesh_torque[k][0]) * train.train.normal_N_per_Nm[k];
    if (!jumps) {
      train.mesh[k] = {{.normal_N = 0.1 * peak_N, .compliance_m_N = 1.1 * compliance},
                       {.normal_N = peak_N, .compliance_m_N = compliance}};
      continue;
    }
    train.mesh[k].clear();
    for (int jump = 1; jump <= 8; ++jump) {
      const double normal_N = 0.12 * jump * peak_N;
      const double before = jump % 2 == 0 ? 100.0 : 1.0;
      train.mesh[k].push_back({.normal_N = normal_N, .compliance_m_N = before * compliance});
      train.mesh[k].push_back(
          {.normal_N = normal_N * (1.0 + 1e-9), .compliance_m_N = 100.0 / before * compliance});
    }
  }
  return train;
}

// At a jump the forces that one spring leaves call for the other one: no state has the springs of
// its own forces.
TEST(TorqueAngleCurve, IsNotThereWhereNoStateHasTheSpringsOfItsForces) {
  RandomTrain random(578);
  for (int n = 0; n < 60; ++n) {
    const auto g = random.train(n % 2 == 0);
    const ElasticTrain train = constant_springs(g, strength::random_springs(random));
    const TorqueAngleTask task = task_of(g, random_efficiencies(random, 0.9));
    EXPECT_TRUE(torque_angle_loop(changing_springs(train, task.peak_torque_Nm, false), task)) << n;
    EXPECT_FALSE(torque_angle_loop(changing_springs(train, task.peak_torque_Nm, true), task)) << n;
  }
}

TEST(TorqueAngleCurve, AreaOfTheLoopIsWhatFrictionTakes) {
  RandomTrain random(576);
  LargestDeviation energy;
  int with_loss = 0;
  int lifted = 0;
  for (int n = 0; n < 200; ++n) {
    const auto g = random.train(n % 2 == 0);
    const auto springs = strength::random_springs(random);
    const auto curve = torque_angle_loop(constant_springs(g, springs),
                                         task_of(g, random_efficiencies(random, 0.97)));
    ASSERT_TRUE(curve) << n;
    // Where the sun's flank lifts off within a step, the work of its force there is left out.
    const double allowed = curve->sun_lifts_off ? 1e-4 : 1e-9;
    lifted += curve->sun_lifts_off ? 1 : 0;
    energy.see(n, curve->loop_J - curve->friction_J, allowed * 20.0 * curve->elastic_rad);
    EXPECT_GE(curve->friction_J, -1e-9 * 20.0 * curve->elastic_rad) << n;
    with_loss += curve->friction_J > 1e-4 * 20.0 * curve->elastic_rad ? 1 : 0;
  }
  energy.expect_allowed("energy");
  EXPECT_GT(with_loss, 100);
  EXPECT_GT(lifted, 0);
  EXPECT_LT(lifted, 100);
}

}  // namespace
}  // namespace gear3k::design::torque_angle_curve_test
