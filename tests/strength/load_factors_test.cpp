#include "strength/load_factors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "strength/load_cycles.hpp"

namespace gear3k::strength::load_factors_test {
namespace {

LoadedMesh<double> mesh() {
  return {.tangential_N = 2000.0,
          .face_width_m = 10e-3,
          .application_factor = 1.25,
          .contact_ratio = 1.5,
          .pinion_teeth = 20,
          .tooth_ratio = 2.0,
          .speed_m_s = 3.0};
}

TEST(DynamicFactor, FollowsMethodC) {
  // w = 250 N/mm, V = 0.6/√1.25, grade 6.
  const double v = 0.6 * std::sqrt(4.0 / 5.0);
  const auto factor = dynamic_factor(mesh(), 6);
  EXPECT_NEAR(factor.value, 1.0 + (14.9 / 250.0 + 0.0193) * v * (2.071 - 0.357 * v), 1e-14);
  EXPECT_EQ(factor.branch, "method C");
  auto light = mesh();
  light.tangential_N = 1.0;
  light.speed_m_s = 0.5;
  EXPECT_NEAR(dynamic_factor(light, 8).value, 1.0 + (39.1 / 100.0 + 0.0193) * (v / 6.0) * 2.0,
              1e-14);
  EXPECT_EQ(dynamic_factor(light, 8).branch, "method C, slow");
  EXPECT_EQ(dynamic_factor(mesh(), std::nullopt).value, 1.0);
  auto still = mesh();
  still.speed_m_s = 0.0;
  EXPECT_EQ(dynamic_factor(still, 6).branch, "at rest");
  auto fast = mesh();
  fast.speed_m_s = 20.0;
  // Beyond V = 3 the formula falls and turns negative: it is held.
  EXPECT_FALSE(dynamic_factor(fast, 6).in_range);
  fast.speed_m_s = 3.0 / (v / 3.0);
  const double held = dynamic_factor(fast, 6).value;
  EXPECT_NEAR(held, 1.0 + (14.9 / 250.0 + 0.0193) * 3.0 * (2.071 - 0.357 * 3.0), 1e-12);
  for (const double speed : {20.0, 200.0, 2000.0}) {
    fast.speed_m_s = speed;
    EXPECT_NEAR(dynamic_factor(fast, 6).value, held, 1e-12);
  }
  EXPECT_THROW(dynamic_factor(mesh(), 9), std::invalid_argument);
  EXPECT_THROW(dynamic_factor(mesh(), 2), std::invalid_argument);
}

TEST(FaceLoadFactor, IsSmoothWhereTheWholeFaceBeginsToCarry) {
  // q = F c/(2 w) = 1 at F = 2 w/c = 2 · 250/10 = 50 µm.
  const double c = 10e9;
  EXPECT_NEAR(face_load_factor(mesh(), 25e-6, c).value, 1.5, 1e-12);
  EXPECT_NEAR(face_load_factor(mesh(), 200e-6, c).value, 4.0, 1e-12);
  const double below = face_load_factor(mesh(), 50e-6 * (1.0 - 1e-7), c).value;
  const double above = face_load_factor(mesh(), 50e-6 * (1.0 + 1e-7), c).value;
  EXPECT_NEAR(below, 2.0, 2e-7);
  EXPECT_NEAR((above - 2.0) / (2.0 - below), 1.0, 1e-6);
  EXPECT_EQ(face_load_factor(mesh(), 0.0, c).value, 1.0);
  EXPECT_EQ(face_load_factor(mesh(), 0.0, c).source, sources::kNotStated);
  EXPECT_THROW(face_load_factor(mesh(), -1e-6, c), std::invalid_argument);
  EXPECT_THROW(face_load_factor(mesh(), 1e-6, 0.0), std::invalid_argument);
}

TEST(RootFaceLoadFactor, IsTheFlanksToAPowerBelowOne) {
  EXPECT_NEAR(root_face_load_factor(1.4, 0.2).value, std::pow(1.4, 1.0 / 1.24), 1e-14);
  EXPECT_EQ(root_face_load_factor(1.4, 0.6).value, root_face_load_factor(1.4, 1.0 / 3.0).value);
  EXPECT_EQ(root_face_load_factor(1.0, 0.2).value, 1.0);
}

TEST(TransverseLoadFactors, AreContinuousAtContactRatioTwoAndHeldByTheirLimits) {
  const auto rate = [](double epsilon, double deviation_m) {
    auto loaded = mesh();
    loaded.contact_ratio = epsilon;
    return transverse_load_factors<double>(
        loaded, TransverseDeviation<double>{.base_pitch_deviation_m = deviation_m,
                                            .running_in_m = 0.0,
                                            .stiffness_Pa = 20e9,
                                            .dynamic_factor = 1.0,
                                            .face_load_factor = 1.0});
  };
  // q = 20 · 5/250 = 0.4.
  EXPECT_NEAR(rate(1.9999999, 5e-6).flank.value, 0.9 + 0.4 * 0.4, 1e-6);
  EXPECT_NEAR(rate(2.0000001, 5e-6).flank.value, 0.9 + 0.4 * 0.4, 1e-6);
  EXPECT_EQ(rate(1.5, 1e-6).flank.value, 1.0);
  EXPECT_EQ(rate(1.5, 1e-6).flank.branch, "held at 1");
  EXPECT_NEAR(rate(1.5, 1e-3).flank.value, 3.0 / 2.5, 1e-14);
  EXPECT_NEAR(rate(1.5, 1e-3).root.value, 1.5 / 1.125, 1e-14);
}

TEST(RunningInAllowance, DependsOnTheGroup) {
  EXPECT_DOUBLE_EQ(running_in_allowance(MaterialGroup::kCaseHardened, 1500e6, 20e-6), 1.5e-6);
  EXPECT_DOUBLE_EQ(running_in_allowance(MaterialGroup::kCaseHardened, 1500e6, 90e-6), 3e-6);
  EXPECT_NEAR(running_in_allowance(MaterialGroup::kThroughHardened, 800e6, 20e-6), 4e-6, 1e-18);
  EXPECT_EQ(running_in_allowance(MaterialGroup::kPom, 50e6, 20e-6), 0.0);
  EXPECT_EQ(running_in_allowance(MaterialGroup::kThroughHardened, std::nullopt, 20e-6), 0.0);
  EXPECT_THROW(running_in_allowance(MaterialGroup::kThroughHardened, 0.0, 20e-6),
               std::invalid_argument);
}

TEST(MeshLoadFactor, HasARowFromThreePlanetsOn) {
  EXPECT_EQ(mesh_load_factor(MeshLoadTable::kM56, 3)->value, 1.0);
  EXPECT_EQ(mesh_load_factor(MeshLoadTable::kM56, 5)->value, 1.3);
  EXPECT_EQ(mesh_load_factor(MeshLoadTable::kM56, 9)->value, 1.4);
  EXPECT_EQ(mesh_load_factor(MeshLoadTable::kDrivetrain, 4)->value, 1.25);
  EXPECT_FALSE(mesh_load_factor(MeshLoadTable::kM56, 2));
  EXPECT_THROW(mesh_load_factor(MeshLoadTable::kM56, 0), std::invalid_argument);
}

TEST(LoadCycles, CountMeetingsWithPlanets) {
  const auto cycles = load_cycles<double>(
      {.sun = 100.0, .carrier = -10.0, .planet_rolling = -30.0, .output = 2.0}, 3, true);
  EXPECT_EQ(cycles.sun, 330.0);
  EXPECT_EQ(cycles.planet1, 60.0);
  EXPECT_EQ(cycles.planet2, 30.0);
  EXPECT_EQ(cycles.fixed_ring, 30.0);
  EXPECT_EQ(cycles.output_ring, 36.0);
  EXPECT_THROW(load_cycles<double>({}, 0, false), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::load_factors_test
