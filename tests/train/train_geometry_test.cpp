#include "train/train_geometry.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <string>

namespace gear3k::train::train_geometry_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

/// The low-backlash prototype's data.
TrainParameters<double> prototype() {
  TrainParameters<double> p{.teeth = {.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92},
                            .planets = 3,
                            .pressure_angle_rad = 20.0 * kPi / 180.0,
                            .center_distance_m = 16.18e-3,
                            .module_m = {0.59e-3, 0.58e-3},
                            .profile_shift = {0.5, 0.0, 0.45, 0.4, 0.29},
                            .machining_allowance = {0.01, 0.02, 0.03, 0.04, 0.05},
                            .tip_shortening = {0.1, 0.2, 0.3, 0.15, 0.25},
                            .rack = {}};
  return p;
}

TEST(TrainGeometry, EveryGearHasItsOwnDataAndTheModuleOfItsStage) {
  auto p = prototype();
  p.rack[kP2].addendum = 0.9;
  const auto train = make_train_geometry(p);
  ASSERT_TRUE(train);
  const std::array<double, kGearCount> modules{0.59e-3, 0.59e-3, 0.59e-3, 0.58e-3, 0.58e-3};
  for (std::size_t i = 0; i < kGearCount; ++i) {
    const auto& gear = train->gears[i].gear;
    EXPECT_EQ(gear.teeth, teeth_of(p.teeth)[i]);
    EXPECT_EQ(gear.module_m, modules[i]);
    EXPECT_EQ(gear.profile_shift, p.profile_shift[i]);
    EXPECT_EQ(gear.machining_allowance, p.machining_allowance[i]);
    EXPECT_EQ(gear.tip_shortening, p.tip_shortening[i]);
    EXPECT_EQ(gear.rack.addendum, i == kP2 ? 0.9 : 1.0);
    EXPECT_EQ(gear.kind == geometry::GearKind::kRing, i == kR1 || i == kR2);
  }
}

TEST(TrainGeometry, AllMeshesShareTheCarriersCentreDistance) {
  const auto train = make_train_geometry(prototype());
  ASSERT_TRUE(train);
  EXPECT_EQ(train->center_distance_m, 16.18e-3);
  for (const auto& mesh : train->meshes) EXPECT_EQ(mesh.center_distance_m, 16.18e-3);
}

TEST(TrainGeometry, MeshesPairTheGearsOfTheTrain) {
  const auto train = make_train_geometry(prototype());
  ASSERT_TRUE(train);
  for (std::size_t k = 0; k < kMeshCount; ++k) {
    const auto& first = train->gears[static_cast<std::size_t>(kMeshGears[k][0])];
    const auto& second = train->gears[static_cast<std::size_t>(kMeshGears[k][1])];
    const auto mesh = geometry::make_mesh_geometry(first, second, 16.18e-3);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(train->meshes[k].contact_ratio, mesh->contact_ratio);
    EXPECT_EQ(train->meshes[k].alpha_w_rad, mesh->alpha_w_rad);
  }
}

TEST(TrainGeometry, IsEmptyWhereOneMeshHasNoWorkingAngle) {
  // Base radii of S-P1 add to 0.59 * 27 cos 20 deg = 14.969 mm; the internal ones differ by less
  // (14.969 and 15.261 mm): just below the largest of the three there is no train.
  auto p = prototype();
  const double cos_alpha = std::cos(p.pressure_angle_rad);
  const double largest = 0.58e-3 * (92 - 36) / 2.0 * cos_alpha;
  p.center_distance_m = largest * (1.0 - 1e-9);
  EXPECT_FALSE(make_train_geometry(p));
  p.center_distance_m = largest * (1.0 + 1e-9);
  EXPECT_TRUE(make_train_geometry(p));
}

TEST(TrainGeometry, RefusesValuesOutsideTheRangeOfItsParts) {
  auto p = prototype();
  p.module_m[1] = 0.0;
  EXPECT_THROW(make_train_geometry(p), std::invalid_argument);
  p = prototype();
  p.pressure_angle_rad = 0.0;
  EXPECT_THROW(make_train_geometry(p), std::invalid_argument);
  p = prototype();
  p.teeth.P2 = 0;
  EXPECT_THROW(make_train_geometry(p), std::invalid_argument);
}

TEST(NeighbourGap, IsTheDistanceOfPlanetCentresInThePlaneLessTwoTipRadii) {
  std::mt19937_64 generator(6);
  std::uniform_real_distribution<double> distance(16.0e-3, 17.0e-3);
  for (int i = 0; i < 500; ++i) {
    auto p = prototype();
    p.center_distance_m = distance(generator);
    p.planets = 2 + i % 6;
    const auto train = make_train_geometry(p);
    ASSERT_TRUE(train);
    for (const GearId step : {kP1, kP2}) {
      const auto first = std::polar(p.center_distance_m, 0.3);
      const auto second = std::polar(p.center_distance_m, 0.3 + 2.0 * kPi / p.planets);
      const double expected = std::abs(second - first) -
                              2.0 * train->gears[static_cast<std::size_t>(step)].tip_radius_m;
      EXPECT_NEAR(neighbour_gap(*train, step), expected, 16.0 * kEps * p.center_distance_m);
    }
  }
}

TEST(PublishedGearbox, ZeroBacklashCentreDistancesAreReproduced) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/published_3k.toml");
  int gearboxes = 0;
  for (const toml::node& node : *file["gearbox"].as_array()) {
    const toml::table& box = *node.as_table();
    SCOPED_TRACE(box["id"].value_or("(no id)"));
    const auto number = [&](const char* key, std::size_t i) {
      return (*box[key].as_array())[i].value<double>().value();
    };
    const auto teeth = [&](std::size_t i) { return static_cast<int>(number("teeth", i)); };
    TrainParameters<double> p{
        .teeth = {.S = teeth(0), .P1 = teeth(1), .R1 = teeth(2), .P2 = teeth(3), .R2 = teeth(4)},
        .planets = 3,
        .pressure_angle_rad = box["pressure_angle"].value<double>().value() * kPi / 180.0,
        .center_distance_m = 0.0,
        .module_m = {number("modules", 0) * 1e-3, number("modules", 1) * 1e-3},
        .profile_shift = {},
        .machining_allowance = {},
        .tip_shortening = {},
        .rack = {}};
    for (std::size_t i = 0; i < kGearCount; ++i) p.profile_shift[i] = number("shifts", i);
    const auto gears = make_train_gears(p);
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto d = geometry::zero_backlash_center_distance(
          gears[static_cast<std::size_t>(kMeshGears[k][0])],
          gears[static_cast<std::size_t>(kMeshGears[k][1])]);
      ASSERT_TRUE(d);
      constexpr double kHalfUnit_mm = 0.5e-4;
      EXPECT_NEAR(*d * 1e3, (*box["expect"]["distances"].as_array())[k].value<double>().value(),
                  kHalfUnit_mm)
          << kMeshNames[k];
    }
    ++gearboxes;
  }
  EXPECT_EQ(gearboxes, 2);
}

}  // namespace
}  // namespace gear3k::train::train_geometry_test
