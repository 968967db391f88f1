#include "design/sun_torque.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "design/scalar_as.hpp"
#include "efficiency/friction_law.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"

namespace gear3k::design::sun_torque_test {
namespace {

using efficiency::FrictionLaw, efficiency::LossModel;
using train::kMeshCount, train::kMeshP1R1, train::kMeshP2R2, train::kMeshSP1;

constexpr std::array<FrictionLaw, 2> kLaws{FrictionLaw::kConstant, FrictionLaw::kLoadPower};
constexpr std::array<LossModel, 4> kModels{LossModel::kSliding, LossModel::kOhlendorf,
                                           LossModel::kCoulombPath, LossModel::kDirectional};

/// A train whose friction depends on its load, mostly.
struct Subject {
  train::TrainGeometry<double> geometry;
  efficiency::Friction<double> friction;
  ShaftLosses<double> shafts;
  OperatingPoint<double> point;
  Direction direction = Direction::kForward;
};

Subject subject(RandomTrain& random, int number) {
  const auto pick = [&](int every, int count) {
    return static_cast<std::size_t>(number / every % count);
  };
  Subject s{.geometry = random.train(number % 2 == 0), .friction = {}, .shafts = {}, .point = {}};
  const auto in_contact = [](const auto& mesh) { return mesh.contact_ratio > 0.2; };
  while (!std::ranges::all_of(s.geometry.meshes, in_contact)) {
    s.geometry = random.train(number % 2 == 0);
  }
  auto& f = s.friction;
  f.law = kLaws[pick(2, 2)];
  f.model = kModels[pick(4, 4)];
  f.coefficient = random.between(0.02, 0.12);
  f.load_exponent = random.between(-0.3, 0.3);
  f.reference_force_N = random.between(5.0, 100.0);
  s.point = {.sun_speed_rad_s = random.between(1.0, 300.0),
             .output_torque_Nm = random.between(1.0, 40.0),
             .temperature_K = random.between(280.0, 350.0)};
  s.direction = pick(16, 3) < 2 ? Direction::kForward : Direction::kBackward;
  auto& e = f.extension;
  e.load_is_torque = pick(32, 3) > 0;
  e.share_is_of_force = pick(32, 3) > 1;
  e.reference_force_N = random.between(3.0, 60.0);
  if (pick(64, 2) == 0) e.load_exponent = random.between(-0.3, 0.3);
  e.load_bend.half_range = random.between(0.5, 2.0);
  const bool by_load = number % 7 != 0;  // else its derivatives alone are
  if (!by_load) {
    f.law = FrictionLaw::kConstant;
    e.load_exponent = 0.0;
  }
  for (int k = 0; by_load && k < e.load_bend.places; ++k) {
    if (k != e.load_bend.places / 2) {
      e.load_bend.s[static_cast<std::size_t>(k)] = random.between(-0.4, 0.4);
    }
  }
  if (pick(128, 2) == 1) e.approach = random.between(0.8, 1.2);
  if (pick(256, 2) == 1) e.ring_meshes = random.between(0.8, 1.2);
  for (auto& drag : s.shafts.drag) drag.constant_Nm = random.between(0.0, 1e-3);
  s.shafts.planet_bearing_coefficient = random.between(0.0, 0.1);
  s.shafts.planet_bearing_radius_m = pick(512, 2) == 0 || !by_load ? 0.0 : 2e-3;
  s.shafts.output_bearing_share = random.between(0.0, 0.03);
  return s;
}

std::optional<Jet1> torque_of(const Subject& s, const VariedLosses& losses) {
  return SunTorque({.geometry = s.geometry, .face_width_m = {5e-3, 5e-3}}, losses)
      .at(s.point, s.direction);
}
VariedLosses losses_of(const Subject& s) {
  return {.friction = friction_as<Jet1>(s.friction), .shafts = shafts_as<Jet1>(s.shafts)};
}

/// Drag against a shaft's rotation at w_R2 = 1.
double drag_on(const Subject& s, ShaftId shaft, double speed) {
  return std::copysign(s.shafts.drag[shaft].constant_Nm, -speed);
}

/// The moments on the planets about their axes, which add up to none, where S carries a torque, the
/// output's load being what it is and every mesh driven as without friction.
struct Moments {
  const Subject& s;
  train::SpeedRatios speed = train::speed_ratios(s.geometry.teeth);

  [[nodiscard]] bool forward() const { return s.direction == Direction::kForward; }
  [[nodiscard]] bool gear1_drives(std::size_t k) const {
    return train::gear1_drives(static_cast<train::MeshId>(k), train::g2(s.geometry.teeth) < 1.0,
                               forward());
  }
  [[nodiscard]] std::array<double, kMeshCount> torques(double sun) const {
    const double load = (forward() ? -1.0 : 1.0) * s.point.output_torque_Nm;
    const double ring2 = -load - drag_on(s, kOutputShaft, 1.0) +
                         s.shafts.output_bearing_share * s.point.output_torque_Nm;
    return {sun, drag_on(s, kCarrierShaft, speed.carrier) - ring2 - sun, ring2};
  }
  /// Power into the central gear of each mesh agrees with which member drives.
  [[nodiscard]] bool agrees(double sun) const {
    const auto torque = torques(sun);
    const std::array<double, kMeshCount> rolling{speed.sun - speed.carrier, -speed.carrier,
                                                 1.0 - speed.carrier};
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const bool central_drives = gear1_drives(k) == train::central_is_gear1(k);
      if ((torque[k] * rolling[k] < 0.0) != central_drives) return false;
    }
    return true;
  }
  [[nodiscard]] double sum(double sun) const {
    const auto torque = torques(sun);
    const train::ToothSet& z = s.geometry.teeth;
    const double planets = s.geometry.planets;
    const double output_speed = s.point.sun_speed_rad_s / std::abs(speed.sun);
    const std::array<double, kMeshCount> lever{1.0 * z.P1 / z.S, -1.0 * z.P1 / z.R1,
                                               -1.0 * z.P2 / z.R2};
    const std::array<double, kMeshCount> own{std::abs(speed.sun),
                                             std::abs(speed.sun / (speed.sun - 1.0)), 1.0};
    double moment = 0.0, along = 0.0, across = 0.0;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto [first, second] = train::kMeshGears[k];
      const auto& gear1 = s.geometry.gears[static_cast<std::size_t>(first)];
      const auto& gear2 = s.geometry.gears[static_cast<std::size_t>(second)];
      const auto& central = s.geometry.gears[train::kCentralGears[k]];
      const auto& mesh = s.geometry.meshes[k];
      const double force = std::abs(torque[k]) / (planets * central.base_radius_m);
      const auto mu = efficiency::friction_coefficient<double>(
          s.friction, {.normal_force_N = force,
                       .sliding_speed_m_s = output_speed,
                       .sum_speed_m_s = output_speed,
                       .reduced_radius_m = 1e-3,
                       .face_width_m = 5e-3,
                       .temperature_K = s.point.temperature_K,
                       .forward = forward(),
                       .ring2_torque_Nm = std::abs(torque[kMeshP2R2]),
                       .own_torque_Nm = own[k] * std::abs(torque[k])});
      // A law may have no value without load, where nothing rubs and the moments are none.
      if (!mu) {
        EXPECT_EQ(torque[k], 0.0);
        continue;
      }
      const double of_mesh = mesh_factor(s.friction.extension, k != kMeshSP1, gear1_drives(k));
      const double eta = efficiency::mesh_efficiency(
          efficiency::contact_of(gear1, gear2, mesh, gear1_drives(k)),
          efficiency::flank_friction(s.friction, *mu * of_mesh), s.friction.model);
      const bool central_drives = gear1_drives(k) == train::central_is_gear1(k);
      moment += lever[k] * torque[k] * (central_drives ? eta : 1.0 / eta);
      // The force on the planet at its working pitch radius, and what presses it out of the mesh.
      const double pitch_radius =
          central.base_radius_m * std::sqrt(1.0 + std::pow(mesh.tan_alpha_w, 2));
      const double tangential = torque[k] / (planets * pitch_radius);
      along += tangential;
      across += (k == kMeshSP1 ? 1.0 : -1.0) * std::abs(tangential) * mesh.tan_alpha_w;
    }
    const double on_pin = speed.planet - speed.carrier;
    const double bearing = s.shafts.planet_bearing_coefficient * s.shafts.planet_bearing_radius_m *
                           std::hypot(along, across);
    return moment + planets * (drag_on(s, kPlanetShaft, on_pin) - std::copysign(bearing, on_pin));
  }
};

/// All torques on S with moments in balance, by bisection.
std::vector<double> bisected(const Moments& moments) {
  const double most = 20.0 * moments.s.point.output_torque_Nm;
  constexpr int kIntervals = 4001;
  std::vector<double> roots;
  for (int i = 0; i < kIntervals; ++i) {
    double low = most * (2.0 * i / kIntervals - 1.0);
    double high = most * (2.0 * (i + 1) / kIntervals - 1.0);
    const bool rises = moments.sum(low) < 0.0;
    if (rises == (moments.sum(high) < 0.0)) continue;
    for (double middle = 0.5 * (low + high); middle > low && middle < high;
         middle = 0.5 * (low + high)) {
      ((moments.sum(middle) < 0.0) == rises ? low : high) = middle;
    }
    if (moments.agrees(high)) roots.push_back(high);
  }
  return roots;
}

TEST(SunTorque, IsThatOfBisectedMomentsOnThePlanetsWhereFrictionDependsOnTheLoad) {
  RandomTrain random(41);
  LargestDeviation value;
  int several = 0;
  for (int i = 0; i < 1024; i += 5) {
    const Subject s = subject(random, i);
    const auto torque = torque_of(s, losses_of(s));
    if (!torque) continue;
    const Moments moments{.s = s};
    const auto roots = bisected(moments);
    if (roots.size() != 1) {
      ++several;
      continue;
    }
    const double shaft = drag_on(s, kSunShaft, moments.speed.sun);
    const double sun = (moments.forward() ? 1.0 : -1.0) * std::copysign(1.0, moments.speed.sun) *
                       (-roots.front() - shaft);
    value.see(i, torque->a - sun, 1e-12 * (std::abs(roots.front()) + s.point.output_torque_Nm));
  }
  value.expect_allowed("torque");
  EXPECT_GT(value.seen, 100);
  EXPECT_LT(several, value.seen / 5);
}

constexpr std::size_t kPlaces = kMaxVariables;
/// Losses that friction by load makes the torque depend on in several ways, and their sizes.
std::array<Jet1*, kPlaces> places(VariedLosses& l) {
  auto& e = l.friction.extension;
  return {&e.level,
          &e.load_exponent,
          &e.load_bend.s[0],
          &e.load_bend.s[4],
          &e.load_bend.quadratic,
          &l.shafts.planet_bearing_radius_m,
          &l.shafts.output_bearing_share,
          &l.shafts.drag[kPlanetShaft].constant_Nm};
}
constexpr std::array<double, kPlaces> kSizes{1.0, 1.0, 1.0, 1.0, 1.0, 2e-3, 1.0, 1e-3};

/// Slope per size of a place, of fourth order: truncation is far below rounding over the step.
std::optional<double> difference(const Subject& s, std::size_t place, double step) {
  double sum = 0.0;
  for (const auto& [at, weight] :
       {std::pair(-2.0, 1.0), std::pair(-1.0, -8.0), std::pair(1.0, 8.0), std::pair(2.0, -1.0)}) {
    VariedLosses moved = losses_of(s);
    places(moved)[place]->a += at * step * kSizes[place];
    const auto torque = torque_of(s, moved);
    if (!torque) return std::nullopt;
    sum += weight / (12.0 * step) * torque->a;
  }
  return sum;
}

TEST(SunTorque, HasTheDerivativesOfDifferencesWhereFrictionDependsOnTheLoad) {
  RandomTrain random(42);
  LargestDeviation slope;
  int bent = 0;
  for (int i = 0; i < 1024; ++i) {
    const Subject s = subject(random, i);
    VariedLosses losses = losses_of(s);
    for (std::size_t k = 0; k < kPlaces; ++k) {
      places(losses)[k]->v[static_cast<Eigen::Index>(k)] = 1.0;
    }
    const auto torque = torque_of(s, losses);
    if (!torque) continue;
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const auto wide = difference(s, k, 2e-4);
      const auto narrow = difference(s, k, 1e-4);
      if (!wide || !narrow) continue;
      const double allowed =
          1e-10 * (std::abs(torque->a) + s.point.output_torque_Nm + std::abs(*narrow));
      // A law of the load has bends, at its places and where it ends.
      if (std::abs(*wide - *narrow) > allowed) {
        ++bent;
        continue;
      }
      slope.see(i, torque->v[static_cast<Eigen::Index>(k)] * kSizes[k] - *narrow, allowed);
    }
  }
  slope.expect_allowed("derivatives");
  EXPECT_GT(slope.seen, 4000);
  EXPECT_LT(bent, slope.seen / 50);
}

}  // namespace
}  // namespace gear3k::design::sun_torque_test
