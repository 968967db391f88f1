#include "strength/train_rating.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/interference.hpp"
#include "tests/random_train.hpp"
#include "tests/strength/steel.hpp"

namespace gear3k::strength::train_rating_test {
namespace {

/// A train whose meshes run continuously.
train::TrainGeometry<double> running_train(RandomTrain& random, bool below_one) {
  for (;;) {
    auto g = random.train(below_one);
    if (std::ranges::all_of(g.meshes, [](const auto& mesh) { return mesh.contact_ratio >= 1.0; })) {
      return g;
    }
  }
}

GearMaterial pom() {
  GearMaterial material;
  material.record = *find_material("POM");
  return material;
}

RatingTask task_of(const GearMaterial& material) {
  RatingTask task;
  task.material.fill(material);
  task.torque_Nm = 20.0;
  task.face_width_m = {8e-3, 6e-3};
  task.teeth.root_safety_min = 1.5;
  task.teeth.flank_safety_min = 1.2;
  return task;
}

/// A coefficient of friction for all meshes and both directions.
template <class T>
std::array<std::array<T, train::kMeshCount>, 2> alike(double friction) {
  std::array<std::array<T, train::kMeshCount>, 2> all{};
  for (auto& direction : all) direction.fill(constant<T>(friction));
  return all;
}

/// A train with its roots, as a rating takes it; every mesh loses alike.
template <class T>
struct Rated {
  train::TrainGeometry<T> geometry;
  std::array<geometry::ToothForm<T>, train::kGearCount> forms{};
  std::array<T, 2> face_width_m{};
  MeshDriverEfficiencies<T> efficiency{};

  explicit Rated(const train::TrainGeometry<T>& g, double eta = 0.99) : geometry(g) {
    std::ranges::transform(g.gears, forms.begin(), geometry::make_tooth_form<T>);
    face_width_m = {constant<T>(8e-3), constant<T>(6e-3)};
    for (auto& mesh : efficiency) mesh = {constant<T>(eta), constant<T>(eta)};
  }
  [[nodiscard]] RatedTrain<T> view() const {
    return {.geometry = geometry,
            .forms = forms,
            .face_width_m = face_width_m,
            .efficiency = {efficiency, efficiency},
            .friction = alike<T>(0.05)};
  }
  [[nodiscard]] TrainRating<T> at(const RatingTask& task, Drive drive,
                                  StiffnessPart part = StiffnessPart::kIso) const {
    return rate_train(view(), task, drive, constant<T>(task.torque_Nm), part);
  }
};

/// Least of S/S_min of all teeth.
double least_ratio(const TrainRating<double>& rating, const RatingTask& task) {
  double least = 1e300;
  for (const auto& mesh : rating.mesh) {
    for (const auto& tooth : mesh.teeth) {
      if (tooth.root_limit_stated)
        least = std::min(least, tooth.root_safety / *task.teeth.root_safety_min);
      if (tooth.flank_limit_stated) {
        least = std::min(least, tooth.flank_safety / *task.teeth.flank_safety_min);
      }
    }
  }
  return least;
}

TEST(TrainRating, AtItsCapacityTheLeastSafetyIsTheOneAskedFor) {
  RandomTrain random(61);
  for (int n = 0; n < 200; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0));
    RatingTask task = task_of(n % 3 == 0 ? pom() : steel_700_290());
    task.teeth.cycles = 1e6;
    if (n % 5 == 0) task.misalignment_m = 3e-6;
    for (const Drive drive : {Drive::kForward, Drive::kBackward}) {
      const auto capacity = train_capacity(rated.view(), task, drive);
      ASSERT_TRUE(capacity) << n;
      RatingTask at = task;
      at.torque_Nm = capacity->torque_Nm;
      EXPECT_NEAR(least_ratio(rated.at(at, drive), task), 1.0, 1e-9) << n;
    }
  }
}

TEST(TrainRating, CapacityIsTheLeastTorqueThatFallsShortWhereKGammaRisesAndFalls) {
  RandomTrain random(71);
  int several = 0;
  for (int n = 0; n < 20; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0));
    RatingTask task = task_of(steel_700_290());
    task.factors.mesh_load_source = MeshLoadSource::kTolerances;
    RatingTask even = task;
    even.factors.mesh_load_source = MeshLoadSource::kNumber;
    const double middle = 0.5 * train_capacity(rated.view(), even, Drive::kForward)->torque_Nm;
    const auto mesh_load = [middle](double torque_Nm) {
      const double off = std::log(torque_Nm / middle) / 0.3;
      MeshLoadFactors factors;
      factors.fill({.value = 1.0 + 4.0 * std::exp(-off * off)});
      return factors;
    };
    const auto ratio_at = [&](double torque_Nm) {
      RatingTask at = even;
      at.factors.mesh_load = mesh_load(torque_Nm)[0].value;
      at.torque_Nm = torque_Nm;
      return least_ratio(rated.at(at, Drive::kForward), at);
    };
    double first = 0.1 * middle;
    while (ratio_at(first) >= 1.0) first *= 1.002;
    several += ratio_at(1.9 * middle) >= 1.0 ? 1 : 0;
    const auto capacity = train_capacity(rated.view(), task, Drive::kForward, mesh_load);
    ASSERT_TRUE(capacity) << n;
    EXPECT_NEAR(capacity->torque_Nm, first, 0.002 * first) << n;
  }
  EXPECT_GT(several, 10);
}

TEST(TrainRating, WantsKGammaOfTheTolerances) {
  RandomTrain random(72);
  const Rated<double> rated(running_train(random, true));
  RatingTask task = task_of(steel_700_290());
  task.factors.mesh_load_source = MeshLoadSource::kTolerances;
  EXPECT_THROW(static_cast<void>(rated.at(task, Drive::kForward)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(train_capacity(rated.view(), task, Drive::kForward)),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(mesh_load_of(task, 3)), std::invalid_argument);
}

TEST(TrainRating, OfEitherDriveEveryMeshCarriesTheLargerForce) {
  RandomTrain random(62);
  for (int n = 0; n < 100; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0), 0.98);
    const RatingTask task = task_of(steel_700_290());
    const auto forward = rated.at(task, Drive::kForward);
    const auto backward = rated.at(task, Drive::kBackward);
    const auto either = rated.at(task, Drive::kEither);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      EXPECT_EQ(either.mesh[k].normal_N,
                std::max(forward.mesh[k].normal_N, backward.mesh[k].normal_N))
          << n;
      for (const std::size_t i : {0U, 1U}) {
        EXPECT_EQ(
            either.mesh[k].teeth[i].root_safety,
            std::min(forward.mesh[k].teeth[i].root_safety, backward.mesh[k].teeth[i].root_safety))
            << n;
      }
    }
  }
}

/// Steel P1 and R1, the rest of POM, driven at a speed that heats it.
RatingTask warm_task() {
  RatingTask task = task_of(pom());
  task.material[train::kP1] = task.material[train::kR1] = steel_700_290();
  task.torque_Nm = 3.0;
  task.teeth.cycles = 1e7;
  task.speed_rad_s = 300.0;
  task.wear_coefficient_m2_N = 1e-15;
  return task;
}

TEST(TrainRating, OfEitherDriveEveryQuantityOfPlasticsIsTheWorseOne) {
  RandomTrain random(68);
  for (int n = 0; n < 60; ++n) {
    Rated<double> rated(running_train(random, n % 2 == 0));
    RatedTrain<double> view = rated.view();
    // Driven backward the meshes lose three times as much, which heats and wears.
    for (auto& mesh : view.efficiency[1]) mesh = {0.97, 0.97};
    const RatingTask task = warm_task();
    const auto at = [&](Drive drive) {
      return rate_train(view, task, drive, task.torque_Nm, StiffnessPart::kIso);
    };
    const auto forward = at(Drive::kForward), backward = at(Drive::kBackward);
    const auto either = at(Drive::kEither);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      for (const std::size_t i : {0U, 1U}) {
        const auto& f = forward.mesh[k].teeth[i];
        const auto& b = backward.mesh[k].teeth[i];
        const auto& e = either.mesh[k].teeth[i];
        EXPECT_EQ(e.root_safety, std::min(f.root_safety, b.root_safety)) << n;
        EXPECT_EQ(e.flank_safety, std::min(f.flank_safety, b.flank_safety)) << n;
        if (!f.plastic) continue;
        EXPECT_EQ(*e.root_temperature_K, std::max(*f.root_temperature_K, *b.root_temperature_K));
        EXPECT_EQ(*e.wear_m, std::max(*f.wear_m, *b.wear_m)) << n;
      }
    }
  }
}

TEST(TrainRating, TheHeatOfAMeshIsTheLossOfItsFlow) {
  // P_loss = Σ shaft powers: of all meshes together what goes in less what comes out.
  RandomTrain random(69);
  for (int n = 0; n < 60; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0), 0.985);
    for (const bool forward : {true, false}) {
      const auto forces = driven_mesh_forces(rated.geometry, rated.efficiency, 5.0, forward);
      if (!forces) continue;
      const auto flow = train::solve_power_flow(
          train::LoadedTrain<double>{.teeth = rated.geometry.teeth,
                                     .efficiency = rated.efficiency,
                                     .known = {},
                                     .given_end = train::End::kOutput,
                                     .given_torque_Nm = forward ? -5.0 : 5.0});
      ASSERT_TRUE(flow);
      const train::SpeedRatios speeds = train::speed_ratios(rated.geometry.teeth);
      const double shafts = flow->sun_torque_Nm * speeds.sun + flow->output_torque_Nm;
      double lost = 0.0;
      for (const double loss : forces->loss_Nm) {
        EXPECT_GT(loss, 0.0);
        lost += loss * rated.geometry.planets;
      }
      EXPECT_NEAR(lost, shafts, 1e-10 * std::abs(speeds.sun)) << n;
    }
  }
}

TEST(TrainRating, APlanetThatBothMatesLoadOnOneFlankWearsByBoth) {
  RandomTrain random(70);
  for (int n = 0; n < 40; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0));
    RatingTask task = task_of(pom());
    task.torque_Nm = 2.0;
    task.life_s = 3.6e5;
    task.speed_rad_s = 100.0;
    task.wear_coefficient_m2_N = 1e-15;
    const auto rating = rated.at(task, Drive::kForward);
    // Archard's law by hand: 2π T N H_V k_w/(b z l), N turns against each mate.
    const train::SpeedRatios w = train::speed_ratios(rated.geometry.teeth);
    const double turns = std::abs((w.planet - w.carrier) / w.sun) * 100.0 * 3.6e5;
    const auto wear = [&](std::size_t k, std::size_t member, int gear) {
      const auto& g = rated.geometry.gears[static_cast<std::size_t>(gear)];
      const auto& [first, second] = train::kMeshGears[k];
      const double length = active_flank_length(
          g, geometry::active_root_length(rated.geometry.gears[static_cast<std::size_t>(first)],
                                          rated.geometry.gears[static_cast<std::size_t>(second)],
                                          rated.geometry.meshes[k], static_cast<int>(member) + 1));
      return rating.mesh[k].normal_N * g.base_radius_m * turns * (0.01 / 0.05) * 1e-15 /
             (8e-3 * g.gear.teeth * length);
    };
    const double by_sun = wear(train::kMeshSP1, 1, train::kP1);
    const double by_ring = wear(train::kMeshP1R1, 0, train::kP1);
    const double at_sun = *rating.mesh[train::kMeshSP1].teeth[1].wear_m;
    const double at_ring = *rating.mesh[train::kMeshP1R1].teeth[0].wear_m;
    const bool shared = train::g2(rated.geometry.teeth) > 1.0;
    EXPECT_NEAR(at_sun, shared ? by_sun + by_ring : by_sun, 1e-9 * at_sun) << n;
    EXPECT_NEAR(at_ring, shared ? by_sun + by_ring : by_ring, 1e-9 * at_ring) << n;
  }
}

TEST(TrainRating, TheCapacityOfPlasticsDoesNotDependOnTheStatedTorque) {
  RandomTrain random(71);
  const Rated<double> rated(running_train(random, true), 0.98);
  RatingTask task = task_of(pom());
  task.teeth.cycles = 1e7;
  task.speed_rad_s = 1000.0;
  double first = 0.0;
  for (double stated = 0.5; stated < 60.0; stated *= 1.23) {
    task.torque_Nm = stated;
    const auto capacity = train_capacity(rated.view(), task, Drive::kForward);
    ASSERT_TRUE(capacity) << stated;
    if (first == 0.0) first = capacity->torque_Nm;
    EXPECT_NEAR(capacity->torque_Nm, first, 1e-9 * first) << stated;
  }
}

TEST(TrainRating, AnOverloadLimitsTheCapacityToo) {
  RandomTrain random(72);
  const Rated<double> rated(running_train(random, true));
  RatingTask task = task_of(steel_700_290());
  const auto plain = train_capacity(rated.view(), task, Drive::kForward);
  task.overload = 10.0;
  const auto peak = train_capacity(rated.view(), task, Drive::kForward);
  ASSERT_TRUE(plain && peak);
  EXPECT_LT(peak->torque_Nm, plain->torque_Nm);
  EXPECT_TRUE(peak->governing.mode == Mode::kOverloadRoot ||
              peak->governing.mode == Mode::kOverloadFlank);
  task.torque_Nm = peak->torque_Nm;
  double least = 1e300;
  for (const auto& mesh : rated.at(task, Drive::kForward).mesh) {
    for (const auto& tooth : mesh.teeth) {
      least =
          std::min({least, *tooth.overload_root_safety / 1.5, *tooth.overload_flank_safety / 1.2});
    }
  }
  EXPECT_NEAR(least, 1.0, 1e-9);
}

TEST(TrainRating, BearingsAndPinAreRatedInTheWorseDirection) {
  RandomTrain random(73);
  for (int n = 0; n < 40; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0), 0.97);
    RatingTask task = task_of(steel_700_290());
    task.supports = PlanetSupports{.position_m = {0.0, 20e-3}, .plane_m = {4e-3, 13e-3}};
    task.pin_diameter_m = 4e-3;
    const auto forward = rated.at(task, Drive::kForward);
    const auto backward = rated.at(task, Drive::kBackward);
    const auto either = rated.at(task, Drive::kEither);
    for (const std::size_t i : {0U, 1U}) {
      EXPECT_EQ(either.bearing_load_N[i],
                std::max(forward.planet->bearing_load_N[i], backward.planet->bearing_load_N[i]));
    }
    EXPECT_EQ(*either.pin_stress_Pa, std::max(*forward.pin_stress_Pa, *backward.pin_stress_Pa));
  }
}

/// The train with all lengths times a factor.
train::TrainGeometry<double> scaled(const train::TrainGeometry<double>& g, double factor) {
  train::TrainGeometry<double> result = g;
  result.center_distance_m *= factor;
  for (auto& gear : result.gears) {
    geometry::Gear<double> given = gear.gear;
    given.module_m *= factor;
    gear = geometry::make_gear_geometry(given, gear.angle);
  }
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    const auto [first, second] = train::kMeshGears[k];
    result.meshes[k] = *geometry::make_mesh_geometry(result.gears[static_cast<std::size_t>(first)],
                                                     result.gears[static_cast<std::size_t>(second)],
                                                     result.center_distance_m);
  }
  return result;
}

TEST(TrainRating, StressesStayWhereLengthsGrowAndTorqueWithTheirCube) {
  RandomTrain random(63);
  for (int n = 0; n < 200; ++n) {
    const auto small = running_train(random, n % 2 == 0);
    const double s = random.between(0.3, 3.0);
    const Rated<double> one(small);
    Rated<double> other(scaled(small, s));
    for (double& b : other.face_width_m) b *= s;
    const RatingTask task = task_of(steel_700_290());
    RatingTask larger = task;
    larger.torque_Nm *= s * s * s;
    const auto a = one.at(task, Drive::kForward, StiffnessPart::kPath);
    const auto b = other.at(larger, Drive::kForward, StiffnessPart::kPath);
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      for (const std::size_t i : {0U, 1U}) {
        const double root = a.mesh[k].teeth[i].root.stress_Pa;
        const double flank = a.mesh[k].teeth[i].flank_stress_Pa;
        EXPECT_NEAR(b.mesh[k].teeth[i].root.stress_Pa, root, 1e-10 * root) << n;
        EXPECT_NEAR(b.mesh[k].teeth[i].flank_stress_Pa, flank, 1e-10 * flank) << n;
      }
    }
    const double stiffness = a.stiffness->output_Nm_rad * s * s * s;
    EXPECT_NEAR(b.stiffness->output_Nm_rad, stiffness, 1e-9 * stiffness) << n;
    const double i = train::ratio(small.teeth);
    EXPECT_NEAR(a.stiffness->input_Nm_rad * i * i, a.stiffness->output_Nm_rad,
                1e-12 * a.stiffness->output_Nm_rad);
  }
}

TEST(TrainRating, MorePlanetsShareTheLoadAndKGammaTakesItBack) {
  RandomTrain random(64);
  auto g = running_train(random, true);
  g.planets = 3;
  const RatingTask task = task_of(steel_700_290());
  const auto three = Rated<double>(g).at(task, Drive::kForward);
  g.planets = 6;
  RatingTask uneven = task;
  uneven.factors.mesh_load = 2.0;
  const auto six = Rated<double>(g).at(uneven, Drive::kForward);
  for (std::size_t k = 0; k < train::kMeshCount; ++k) {
    EXPECT_NEAR(six.mesh[k].normal_N, 0.5 * three.mesh[k].normal_N, 1e-12 * three.mesh[k].normal_N);
    EXPECT_NEAR(six.mesh[k].teeth[0].root.stress_Pa, three.mesh[k].teeth[0].root.stress_Pa,
                1e-12 * three.mesh[k].teeth[0].root.stress_Pa);
  }
}

// The planet step P1 sees sun and ring on opposite flanks below G2 = 1: an idler, Y_M = 0.7, where
// the joint turns one way only; P2 then is loaded on one flank.
TEST(TrainRating, AnIdlerIsRatedAsReversed) {
  RandomTrain random(65);
  RatingTask task = task_of(steel_700_290());
  task.teeth.load_reversal = false;
  for (const bool below : {true, false}) {
    const auto rating = Rated<double>(running_train(random, below)).at(task, Drive::kForward);
    EXPECT_EQ(rating.mesh[0].teeth[1].root_strength.reversal.value, below ? 0.7 : 1.0);
    EXPECT_EQ(rating.mesh[1].teeth[0].root_strength.reversal.value, below ? 0.7 : 1.0);
    EXPECT_EQ(rating.mesh[2].teeth[0].root_strength.reversal.value, 1.0);
    EXPECT_EQ(rating.mesh[0].teeth[0].root_strength.reversal.value, 1.0);
  }
}

// A gear's own values act on that gear as those of all would; Z_R has the mean of both gears of a
// mesh.
TEST(TrainRating, ValuesOfOneGearActOnItAsThoseOfAllWould) {
  RandomTrain random(71);
  for (int n = 0; n < 20; ++n) {
    const Rated<double> rated(running_train(random, n % 2 == 0));
    RatingTask task = task_of(steel_700_290());
    task.teeth = {.root_roughness_m = 16e-6,
                  .flank_roughness_m = 3e-6,
                  .cycles = 1e9,
                  .load_reversal = true,
                  .reversal = 0.7};
    task.viscosity40_m2_s = 220e-6;
    task.speed_rad_s = 50.0;
    const StatedTeeth own{.root_roughness_m = 40e-6,
                          .flank_roughness_m = 9e-6,
                          .cycles = 2e5,
                          .load_reversal = true,
                          .reversal = 0.9};
    RatingTask of_all = task, of_mean = task;
    of_all.teeth = own;
    of_mean.teeth.flank_roughness_m = 6e-6;
    const auto others = rated.at(task, Drive::kForward), all = rated.at(of_all, Drive::kForward),
               mean = rated.at(of_mean, Drive::kForward);
    for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
      RatingTask of_gear = task;
      of_gear.gear_teeth[gear] = own;
      const auto rating = rated.at(of_gear, Drive::kForward);
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        const auto& [first, second] = train::kMeshGears[k];
        const bool meshes =
            gear == static_cast<std::size_t>(first) || gear == static_cast<std::size_t>(second);
        for (const std::size_t i : {0U, 1U}) {
          const auto member = static_cast<std::size_t>(train::kMeshGears[k][i]);
          const auto& tooth = rating.mesh[k].teeth[i];
          const auto& as = (member == gear ? all : others).mesh[k].teeth[i];
          EXPECT_EQ(tooth.cycles, as.cycles);
          EXPECT_EQ(tooth.root_strength.strength_Pa, as.root_strength.strength_Pa) << n;
          EXPECT_EQ(tooth.flank_strength.life.value, as.flank_strength.life.value) << n;
          const auto& film = (meshes ? mean : others).mesh[k].teeth[i];
          EXPECT_NEAR(tooth.flank_strength.roughness.value, film.flank_strength.roughness.value,
                      1e-15)
              << n;
        }
      }
    }
  }
}

TEST(TrainRating, LoadReversalOfOneGearIsItsOwn) {
  RandomTrain random(72);
  RatingTask task = task_of(steel_700_290());
  task.teeth.load_reversal = false;
  task.gear_teeth[train::kR2].load_reversal = true;
  task.gear_teeth[train::kR2].reversal = 0.85;
  const auto rating = Rated<double>(running_train(random, false)).at(task, Drive::kForward);
  EXPECT_EQ(rating.mesh[2].teeth[1].root_strength.reversal.value, 0.85);
  EXPECT_EQ(rating.mesh[2].teeth[0].root_strength.reversal.value, 1.0);
  EXPECT_EQ(rating.mesh[0].teeth[0].root_strength.reversal.value, 1.0);
}

TEST(TrainRating, LifeInHoursGivesTheCyclesOfEachGear) {
  RandomTrain random(66);
  const auto g = running_train(random, true);
  RatingTask task = task_of(steel_700_290());
  task.speed_rad_s = 100.0;
  task.life_s = 3600.0 * 500.0;
  const auto hours = Rated<double>(g).at(task, Drive::kForward);
  // A tooth of R1 meets N planets a turn of the carrier.
  const double carrier =
      100.0 / std::abs(train::ratio(g.teeth)) * std::abs(train::speed_ratios(g.teeth).carrier);
  RatingTask counted = task;
  counted.life_s.reset();
  counted.teeth.cycles = g.planets * carrier * 3600.0 * 500.0 / (2.0 * 3.14159265358979323846);
  const auto cycles = Rated<double>(g).at(counted, Drive::kForward);
  EXPECT_NEAR(hours.mesh[1].teeth[1].root_strength.life.value,
              cycles.mesh[1].teeth[1].root_strength.life.value, 1e-12);
  EXPECT_NEAR(hours.mesh[1].teeth[1].flank_strength.life.value,
              cycles.mesh[1].teeth[1].flank_strength.life.value, 1e-12);
}

// Gradients by the module of stage 1, the distance and the shift of the sun.
TEST(TrainRating, SlopesAreThoseOfDifferences) {
  RandomTrain random(67);
  const RatingTask task = task_of(steel_700_290());
  for (int n = 0; n < 20; ++n) {
    const auto g = running_train(random, n % 2 == 0);
    const auto at = [&]<class T>(const T& shift) {
      train::TrainGeometry<T> train;
      train.teeth = g.teeth;
      train.planets = g.planets;
      train.center_distance_m = constant<T>(g.center_distance_m);
      for (std::size_t i = 0; i < train::kGearCount; ++i) {
        const geometry::Gear<double>& given = g.gears[i].gear;
        geometry::Gear<T> gear;
        gear.teeth = given.teeth;
        gear.kind = given.kind;
        gear.module_m = constant<T>(given.module_m);
        gear.profile_shift = constant<T>(given.profile_shift);
        if (i == train::kS) gear.profile_shift = gear.profile_shift + shift;
        gear.machining_allowance = constant<T>(given.machining_allowance);
        gear.tip_shortening = constant<T>(given.tip_shortening);
        gear.rack = {.addendum = constant<T>(given.rack.addendum),
                     .dedendum = constant<T>(given.rack.dedendum),
                     .root_radius = constant<T>(given.rack.root_radius)};
        gear.cutter = given.cutter;
        train.gears[i] = geometry::make_gear_geometry(
            gear, geometry::make_pressure_angle(constant<T>(g.gears[i].angle.alpha_rad)));
      }
      for (std::size_t k = 0; k < train::kMeshCount; ++k) {
        const auto [first, second] = train::kMeshGears[k];
        train.meshes[k] = *geometry::make_mesh_geometry(
            train.gears[static_cast<std::size_t>(first)],
            train.gears[static_cast<std::size_t>(second)], train.center_distance_m);
      }
      const Rated<T> rated(train);
      const auto rating = rated.at(task, Drive::kForward, StiffnessPart::kPath);
      return std::array<T, 4>{rating.mesh[0].teeth[0].root_safety,
                              rating.mesh[0].teeth[0].flank_safety, rating.stiffness->output_Nm_rad,
                              train_capacity(rated.view(), task, Drive::kForward)->torque_Nm};
    };
    const auto exact = at(Jet1(0.0, 0));
    constexpr double kStep = 1e-6;
    const auto above = at(kStep);
    const auto below = at(-kStep);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double slope = (above[i] - below[i]) / (2.0 * kStep);
      const double scale = std::max(std::abs(slope), std::abs(exact[i].a));
      EXPECT_NEAR(exact[i].v[0], slope, 1e-6 * scale) << n << " " << i;
    }
  }
}

TEST(TrainRating, WhatIsNotStatedIsSaid) {
  RandomTrain random(68);
  RatingTask task = task_of(steel_700_290());
  const auto rating = Rated<double>(running_train(random, true)).at(task, Drive::kForward);
  const MeshRating<double>& mesh = rating.mesh[0];
  for (const Factor<double>& factor : {mesh.factors.dynamic, mesh.factors.flank_face,
                                       mesh.factors.root_face, mesh.factors.flank_transverse}) {
    EXPECT_EQ(factor.value, 1.0);
    EXPECT_EQ(factor.source, sources::kNotStated);
    EXPECT_NE(factor.branch, "");
  }
  EXPECT_EQ(mesh.teeth[0].root_strength.life.source, sources::kNotStated);
  EXPECT_EQ(mesh.teeth[0].root_strength.life.value, 1.0);
  EXPECT_FALSE(rating.planet);
}

}  // namespace
}  // namespace gear3k::strength::train_rating_test
