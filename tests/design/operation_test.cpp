#include "design/operation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "design/accelerated_train.hpp"
#include "design/scalar_as.hpp"
#include "design/sun_torque.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_train.hpp"
#include "tests/sample.hpp"

namespace gear3k::design::operation_test {
namespace {

using efficiency::Friction, efficiency::FrictionLaw, efficiency::LossModel;
using train::kMeshCount, train::kMeshP2R2, train::kMeshSP1;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

/// A gearbox with all that decides its losses.
struct Gearbox {
  train::TrainParameters<double> parameters;
  train::TrainGeometry<double> geometry;
  Friction<double> friction;
  ShaftLosses<double> shafts;
  std::array<double, 2> face_width_m{};

  [[nodiscard]] LossyTrain<double> train() const {
    return {
        .geometry = geometry, .friction = friction, .shafts = shafts, .face_width_m = face_width_m};
  }
};

class Random : public RandomTrain {
 public:
  explicit Random(std::uint_fast64_t seed) : RandomTrain(seed) {}
  double scale(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }

  /// A train whose meshes are all in contact.
  void geometry(Gearbox& g, bool g2_below_one) {
    for (;;) {
      train::TrainParameters<double> p{};
      p.teeth = teeth(g2_below_one);
      p.planets = count(1, 6);
      const train::ToothSet& z = p.teeth;
      p.pressure_angle_rad = between(18.0, 25.0) * kPi / 180.0;
      p.module_m[0] = between(0.4e-3, 1e-3);
      p.module_m[1] = p.module_m[0] * (z.R1 - z.P1) / (z.R2 - z.P2) * between(0.98, 1.02);
      for (double& x : p.profile_shift) x = between(0.0, 1.0);
      p.center_distance_m = 0.5 * p.module_m[0] * (z.R1 - z.P1) * between(1.0, 1.06);
      const auto result = make_train_geometry(p);
      if (!result) continue;
      const auto in_contact = [](const auto& mesh) { return mesh.contact_ratio > 0.2; };
      if (!std::ranges::all_of(result->meshes, in_contact)) continue;
      g.parameters = p;
      g.geometry = *result;
      return;
    }
  }

  void friction(Friction<double>& f, FrictionLaw law, LossModel model) {
    f = {};
    f.law = law;
    f.model = model;
    f.coefficient = between(0.0, 0.12);
    f.approach_factor = between(0.7, 1.5);
    f.recess_factor = between(0.7, 1.5);
    f.load_exponent = between(-0.3, 0.3);
    f.reference_force_N = scale(1.0, 300.0);
    f.static_coefficient = f.coefficient + between(0.0, 0.1);
    f.stribeck_speed_m_s = scale(1e-3, 1.0);
    f.stribeck_exponent = between(0.6, 2.0);
    f.viscous_s_m = between(0.0, 0.01);
    f.roughness_m = scale(1e-7, 2e-6);
    f.lubricant_factor = between(0.6, 1.2);
    const double thick = scale(20e-6, 400e-6);
    f.lubricant = {.temperature_K = {313.15, 373.15},
                   .viscosity_m2_s = {thick, 0.15 * thick},
                   .density_kgm3 = 870.0};
    double speed = 0.0;
    double force = 0.0;
    for (int i = 0; i < 4; ++i) {
      f.table.sliding_speed_m_s.push_back(speed += scale(1e-3, 0.5));
      f.table.tooth_force_N.push_back(force += scale(1.0, 300.0));
    }
    // As measured: changing a little from node to node.
    for (int i = 0; i < 16; ++i) f.table.coefficient.push_back(between(0.05, 0.1));
  }

  ShaftLosses<double> shafts(double scale_Nm) {
    ShaftLosses<double> s{};
    for (auto& drag : s.drag) {
      if (count(0, 2) == 0) continue;
      drag = {.constant_Nm = between(0.0, scale_Nm),
              .viscous_Nms = between(0.0, scale_Nm) * 1e-3,
              .quadratic_Nms2 = between(0.0, scale_Nm) * 1e-6};
    }
    s.planet_bearing_coefficient = between(0.0, 0.15);
    s.planet_bearing_radius_m = between(0.5e-3, 4e-3);
    return s;
  }

  Gearbox gearbox(FrictionLaw law, LossModel model) {
    Gearbox g;
    geometry(g, count(0, 1) == 1);
    friction(g.friction, law, model);
    g.shafts = shafts(scale(1e-5, 1e-2));
    g.face_width_m = {between(3e-3, 12e-3), between(3e-3, 12e-3)};
    return g;
  }
  OperatingPoint<double> point() {
    return {.sun_speed_rad_s = scale(1.0, 600.0),
            .output_torque_Nm = scale(0.01, 50.0),
            .temperature_K = between(270.0, 370.0)};
  }
};

constexpr std::array<FrictionLaw, 5> kLaws{FrictionLaw::kConstant, FrictionLaw::kLoadPower,
                                           FrictionLaw::kStribeck, FrictionLaw::kSchlenk,
                                           FrictionLaw::kTable};
constexpr std::array<LossModel, 4> kModels{LossModel::kSliding, LossModel::kOhlendorf,
                                           LossModel::kCoulombPath, LossModel::kDirectional};
constexpr std::array<Direction, 2> kDirections{Direction::kForward, Direction::kBackward};

/// Speeds at a speed of the sun, from pitch velocities.  R2 turns forward.
struct Speeds {
  double sun, planet, carrier, output;
  std::array<double, kMeshCount> rolling;  // S, R1, R2 seen from the carrier
};
Speeds speeds_of(const train::ToothSet& z, double sun_speed) {
  const double carrier = 1.0 * z.P1 * z.R2;
  const double planet = -1.0 * z.R1 * z.R2;
  const double sun = 1.0 * z.R1 * z.R2 * z.P1 / z.S;
  const double ring2 = -1.0 * z.R1 * z.P2;
  const double unit = std::copysign(sun_speed / (carrier + sun), carrier + ring2);
  return {.sun = unit * (carrier + sun),
          .planet = unit * (carrier + planet),
          .carrier = unit * carrier,
          .output = unit * (carrier + ring2),
          .rolling = {unit * sun, -unit * carrier, unit * ring2}};
}

bool central_drives(std::size_t mesh, bool gear1_drives) {
  return gear1_drives == (mesh == kMeshSP1);
}
const geometry::GearGeometry<double>& central_of(const Gearbox& g, std::size_t mesh) {
  constexpr std::array<int, kMeshCount> kCentral{train::kS, train::kR1, train::kR2};
  return g.geometry.gears[static_cast<std::size_t>(kCentral[mesh])];
}

/// Power that the central gear of a mesh gives (takes), from its heat and efficiency.
double central_power(const MeshOperation<double>& m, std::size_t mesh) {
  const double driving = m.loss_W / (1.0 - m.efficiency);
  return central_drives(mesh, m.gear1_drives) ? driving : driving * m.efficiency;
}

TEST(Operation, InputLessOutputPowerIsTheSumOfTheLosses) {
  Random random(26);
  LargestDeviation power, sum;
  int operating = 0, locked = 0, no_friction = 0, helped = 0;
  for (int i = 0; i < 10000; ++i) {
    const Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                                     kModels[static_cast<std::size_t>(i / 5 % 4)]);
    const OperatingPoint<double> point = random.point();
    const Direction direction = kDirections[static_cast<std::size_t>(i / 20 % 2)];
    const auto result = operate(g.train(), point, direction);
    if (!result.operation) {
      (result.reason == NoOperation::kLocks ? locked : no_friction) += 1;
      continue;
    }
    ++operating;
    const Operation<double>& o = *result.operation;
    const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
    // Of drive and load: forward the sun drives, backward R2.
    const double sun = o.sun_torque_Nm * std::abs(w.sun);
    const double output = o.output_torque_Nm * w.output;
    const double in_less_out = direction == Direction::kForward ? sun - output : output - sun;
    std::vector<double> losses{o.bearing_loss_W};
    for (const auto& m : o.mesh) losses.push_back(m.loss_W);
    losses.insert(losses.end(), o.drag_loss_W.begin(), o.drag_loss_W.end());
    double total = 0.0;
    for (const double loss : losses) {
      EXPECT_GE(loss, 0.0) << "case " << i;
      total += loss;
    }
    const double scale = std::abs(sun) + std::abs(output) + total;
    power.see(i, in_less_out - total, 1e-12 * scale);
    sum.see(i, o.loss_W - total, 8.0 * kEps * total);
    const double driving = direction == Direction::kForward ? sun : output + std::max(0.0, -sun);
    sum.see(i, o.input_power_W - driving, 8.0 * kEps * driving);
    EXPECT_EQ(o.output_torque_Nm, point.output_torque_Nm);
    helped += o.sun_torque_Nm < 0.0 ? 1 : 0;
    if (direction == Direction::kForward) {
      EXPECT_GT(o.sun_torque_Nm, 0.0);
    }
    ASSERT_TRUE(o.efficiency);
    const double eta = direction == Direction::kForward ? output / sun : sun / output;
    EXPECT_NEAR(*o.efficiency, eta, 16.0 * kEps * (1.0 + std::abs(eta)));
    EXPECT_LT(*o.efficiency, 1.0);
  }
  power.expect_allowed("power");
  sum.expect_allowed("sum");
  EXPECT_GT(operating, 9000);
  EXPECT_GT(helped, 200);
  EXPECT_EQ(no_friction, 0);
  RecordProperty("locked", locked);
}

TEST(Operation, ShaftsLoseTheirDragAtTheirOwnSpeeds) {
  Random random(27);
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    const Gearbox g = random.gearbox(FrictionLaw::kConstant, LossModel::kSliding);
    const OperatingPoint<double> point = random.point();
    const auto result = operate(g.train(), point, Direction::kForward);
    ASSERT_TRUE(result.operation);
    const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
    const std::array<double, kShaftCount> speed{w.sun, w.planet - w.carrier, w.carrier, w.output};
    for (std::size_t k = 0; k < kShaftCount; ++k) {
      const auto& d = g.shafts.drag[k];
      const double v = std::abs(speed[k]);
      const double count = k == kPlanetShaft ? g.geometry.planets : 1.0;
      const double expected =
          count * (d.constant_Nm * v + d.viscous_Nms * v * v + d.quadratic_Nms2 * v * v * v);
      largest.see(i, result.operation->drag_loss_W[k] - expected, 32.0 * kEps * expected + 1e-300);
    }
  }
  largest.expect_allowed("drag");
}

TEST(Operation, WithConstantFrictionAndNoDragHasTheTrainsEfficiency) {
  Random random(28);
  LargestDeviation largest;
  int seen = 0, locking = 0;
  for (int i = 0; i < 2000; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, kModels[static_cast<std::size_t>(i % 4)]);
    g.shafts = {};
    const bool forward = i / 4 % 2 == 0;
    OperatingPoint<double> point = random.point();
    if (i % 3 == 0) point.sun_speed_rad_s = 0.0;
    const efficiency::FlankFriction<double> flank{.coefficient = g.friction.coefficient,
                                                  .approach_factor = g.friction.approach_factor,
                                                  .recess_factor = g.friction.recess_factor};
    const auto eta = efficiency::mesh_efficiencies(g.geometry, flank, g.friction.model, forward);
    const auto& z = g.geometry.teeth;
    const auto result =
        operate(g.train(), point, forward ? Direction::kForward : Direction::kBackward);
    if (!result.operation) continue;
    ASSERT_TRUE(result.operation->efficiency);
    const double formula =
        forward ? efficiency::forward_efficiency(z, eta) : efficiency::backward_efficiency(z, eta);
    if (!(formula > 0.0)) {
      EXPECT_LT(*result.operation->efficiency, 0.0) << "case " << i;
      ++locking;
      continue;
    }
    ++seen;
    largest.see(i, *result.operation->efficiency - formula,
                16.0 * kEps * (1.0 + std::abs(train::ratio(z))));
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      EXPECT_EQ(result.operation->mesh[k].efficiency, eta[k]);
      EXPECT_EQ(result.operation->mesh[k].friction, g.friction.coefficient);
    }
  }
  largest.expect_allowed("efficiency");
  EXPECT_GT(seen, 1000);
  EXPECT_GT(locking, 15);
}

TEST(Operation, AtRestHasTheTorquesOfTheOnsetOfMotionAndNoPower) {
  Random random(29);
  for (int i = 0; i < 400; ++i) {
    const FrictionLaw law = kLaws[static_cast<std::size_t>(i % 5)];
    Gearbox g = random.gearbox(law, LossModel::kSliding);
    g.friction.table.sliding_speed_m_s[0] = 1e-9;
    OperatingPoint<double> point = random.point();
    point.sun_speed_rad_s = 0.0;
    for (const Direction direction : kDirections) {
      const auto rest = operate(g.train(), point, direction);
      if (law == FrictionLaw::kSchlenk) {
        EXPECT_FALSE(rest.operation);
        EXPECT_EQ(rest.reason, NoOperation::kNoFriction);
        continue;
      }
      ASSERT_TRUE(rest.operation) << "case " << i;
      EXPECT_EQ(rest.operation->loss_W, 0.0);
      EXPECT_EQ(rest.operation->input_power_W, 0.0);
      auto slow = point;
      slow.sun_speed_rad_s = 1e-12;
      const auto moving = operate(g.train(), slow, direction);
      ASSERT_TRUE(moving.operation);
      // Stribeck's law is not smooth there for exponents below 1.
      const double scale = point.output_torque_Nm;
      EXPECT_NEAR(moving.operation->sun_torque_Nm, rest.operation->sun_torque_Nm, 1e-4 * scale);
      EXPECT_EQ(moving.operation->output_torque_Nm, rest.operation->output_torque_Nm);
    }
  }
}

TEST(Operation, WithLargeDragAtLightLoadTheSunMustBeHelped) {
  Random random(30);
  int seen = 0;
  for (int i = 0; i < 300; ++i) {
    Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)], LossModel::kSliding);
    g.shafts.drag[kSunShaft].constant_Nm = 0.05;
    OperatingPoint<double> point = random.point();
    point.output_torque_Nm = 0.01;  // over the ratio, far below the drag
    const auto result = operate(g.train(), point, Direction::kBackward);
    if (!result.operation) continue;
    ++seen;
    EXPECT_LT(result.operation->sun_torque_Nm, 0.0);
    EXPECT_LT(*result.operation->efficiency, 0.0);
    const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
    EXPECT_NEAR(result.operation->input_power_W, result.operation->loss_W,
                1e-12 * result.operation->loss_W);
    EXPECT_GT(result.operation->input_power_W, point.output_torque_Nm * w.output);
  }
  EXPECT_GT(seen, 250);
}

/// Whether the sun's torque passes through zero as R2 is driven harder, by bisection.  Where
/// friction rises without bound at light load, it may jump from nothing to a positive torque
/// instead.
bool has_root(const Gearbox& g, OperatingPoint<double> point) {
  const auto sun_torque = [&](double torque) {
    point.output_torque_Nm = torque;
    const auto result = operate(g.train(), point, Direction::kBackward);
    return result.operation ? result.operation->sun_torque_Nm : -1.0;
  };
  double low = 1e-4;
  double high = low;
  while (!(sun_torque(high) > 0.0)) {
    low = high;
    high *= 1.5;
    if (high > 1e4) return false;
  }
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (sun_torque(middle) > 0.0 ? high : low) = middle;
  }
  return sun_torque(high) < 1e-10 * high;
}

TEST(DriveFreeSun, IsTheRootOfBackwardOperation) {
  Random random(31);
  LargestDeviation root;
  int seen = 0, wrong = 0, missed = 0, none = 0, no_friction = 0;
  for (int i = 0; i < 2000; ++i) {
    const Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                                     kModels[static_cast<std::size_t>(i / 5 % 4)]);
    OperatingPoint<double> point = random.point();
    const auto free = drive_free_sun(g.train(), point);
    if (!free.operation) {
      (free.reason == NoOperation::kLocks ? none : no_friction) += 1;
      if (free.reason == NoOperation::kLocks && has_root(g, point)) ++missed;
      continue;
    }
    ++seen;
    const double torque = free.operation->output_torque_Nm;
    EXPECT_EQ(free.operation->sun_torque_Nm, 0.0);
    EXPECT_GE(torque, 0.0);
    // Without drag inside, R2 turns against its own drag alone and no mesh carries anything, also
    // in a train that locks under load.
    const auto idle = [](const auto& mesh) { return mesh.normal_force_N == 0.0; };
    if (std::ranges::all_of(free.operation->mesh, idle)) {
      const auto& drag = free.operation->drag_loss_W;
      EXPECT_EQ(drag[kSunShaft] + drag[kPlanetShaft] + drag[kCarrierShaft], 0.0) << "case " << i;
      const double w_out = speeds_of(g.geometry.teeth, point.sun_speed_rad_s).output;
      EXPECT_NEAR(torque * w_out, drag[kOutputShaft], 8.0 * kEps * torque * w_out);
      continue;
    }
    const double driven = train::ratio(g.geometry.teeth);
    point.output_torque_Nm = torque;
    const auto again = operate(g.train(), point, Direction::kBackward);
    ASSERT_TRUE(again.operation) << "case " << i;
    root.see(i, again.operation->sun_torque_Nm * driven, 1e-10 * torque);
    // More torque drives the sun, less must be helped, where friction does not rise with load.
    if (g.friction.law == FrictionLaw::kConstant || g.friction.law == FrictionLaw::kStribeck) {
      point.output_torque_Nm = 1.01 * torque;
      const auto more = operate(g.train(), point, Direction::kBackward);
      point.output_torque_Nm = 0.99 * torque;
      const auto less = operate(g.train(), point, Direction::kBackward);
      ASSERT_TRUE(more.operation && less.operation);
      if (!(more.operation->sun_torque_Nm > 0.0 && less.operation->sun_torque_Nm < 0.0)) ++wrong;
    }
  }
  root.expect_allowed("root");
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(missed, 0);
  EXPECT_GT(seen, 800);
  EXPECT_GT(none, 50);
  RecordProperty("none", none);
  RecordProperty("no_friction", no_friction);
}

using Vector = std::complex<double>;
constexpr Vector kQuarterTurn(0.0, 1.0);

/// A mesh drawn with the main axis at the origin and the planet's centre on the x axis.
struct DrawnMesh {
  double sliding_speed, sum_speed, reduced_radius;
};
DrawnMesh draw(const Gearbox& g, const Speeds& w, std::size_t mesh) {
  const auto [first, second] = train::kMeshGears[mesh];
  const auto& gear1 = g.geometry.gears[static_cast<std::size_t>(first)];
  const auto& gear2 = g.geometry.gears[static_cast<std::size_t>(second)];
  const bool ring = mesh != kMeshSP1;
  const auto& planet = ring ? gear1 : gear2;
  const auto& central = ring ? gear2 : gear1;
  const double d = g.geometry.center_distance_m;
  // Pitch circles divide the distance by tooth numbers.
  const double teeth =
      ring ? central.gear.teeth - planet.gear.teeth : central.gear.teeth + planet.gear.teeth;
  const double pitch_radius = d * central.gear.teeth / teeth;
  const Vector pitch(pitch_radius, 0.0);
  const double alpha = std::acos(central.base_radius_m / pitch_radius);
  const Vector action = std::polar(1.0, kPi / 2.0 + alpha);
  const Vector tangent = kQuarterTurn * action;
  const double w_central = w.rolling[mesh];
  const double w_planet = w.planet - w.carrier;
  const auto velocities = [&](Vector point) {
    return std::array<double, 2>{
        (std::conj(tangent) * (kQuarterTurn * w_central * point)).real(),
        (std::conj(tangent) * (kQuarterTurn * w_planet * (point - d))).real()};
  };
  // Shares of the contact ratio from tip circles: distances along the line of action.
  const auto reach = [&](const geometry::GearGeometry<double>& gear) {
    const double foot = std::sqrt(std::pow(gear.base_radius_m / std::cos(alpha), 2) -
                                  gear.base_radius_m * gear.base_radius_m);
    const double tip =
        std::sqrt(gear.tip_radius_m * gear.tip_radius_m - gear.base_radius_m * gear.base_radius_m);
    return std::pair{foot, tip};
  };
  const auto [central_foot, central_tip] = reach(central);
  const auto [planet_foot, planet_tip] = reach(planet);
  const double base_pitch = 2.0 * kPi * central.base_radius_m / central.gear.teeth;
  const double one = (ring ? central_foot - central_tip : central_tip - central_foot);
  const double other = planet_tip - planet_foot;
  constexpr int kSteps = 2000;
  double sum = 0.0;
  int positions = 0;
  for (int i = 0; i < kSteps; ++i) {
    double slip = 0.0;
    int pairs = 0;
    for (double s = (i + 0.5) / kSteps * base_pitch - one; s < other; s += base_pitch) {
      const auto v = velocities(pitch + s * action);
      slip += std::abs(v[0] - v[1]);
      ++pairs;
    }
    if (pairs == 0) continue;
    sum += slip / pairs;
    ++positions;
  }
  const auto rolling = velocities(pitch);
  const double r1 = central_foot;
  const double r2 = planet_foot;
  return {.sliding_speed = sum / positions,
          .sum_speed = std::abs(rolling[0] + rolling[1]),
          // Flanks that curve to opposite sides touch more sharply.
          .reduced_radius = r1 * r2 / (ring ? r1 - r2 : r1 + r2)};
}

/// The law's coefficient in a mesh that runs as drawn, under a force.
std::optional<double> friction_as_drawn(const Gearbox& g, const OperatingPoint<double>& point,
                                        std::size_t mesh, double normal_force_N,
                                        double sliding_speed_m_s) {
  const DrawnMesh drawn = draw(g, speeds_of(g.geometry.teeth, point.sun_speed_rad_s), mesh);
  return efficiency::friction_coefficient<double>(
      g.friction, {.normal_force_N = normal_force_N,
                   .sliding_speed_m_s = sliding_speed_m_s,
                   .sum_speed_m_s = drawn.sum_speed,
                   .reduced_radius_m = drawn.reduced_radius,
                   .face_width_m = g.face_width_m[mesh == kMeshP2R2 ? 1 : 0],
                   .temperature_K = point.temperature_K});
}

TEST(Operation, FrictionIsTheLawAtTheForcesAndSpeedsOfTheResult) {
  Random random(32);
  LargestDeviation friction, force, speed;
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                                     kModels[static_cast<std::size_t>(i / 5 % 4)]);
    const OperatingPoint<double> point = random.point();
    const Direction direction = kDirections[static_cast<std::size_t>(i / 20 % 2)];
    const auto result = operate(g.train(), point, direction);
    if (!result.operation) continue;
    const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
    double largest_force = 0.0;
    for (const auto& m : result.operation->mesh) {
      largest_force = std::max(largest_force, m.normal_force_N);
    }
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto& m = result.operation->mesh[k];
      if (1.0 - m.efficiency < 1e-4) continue;  // the heat no longer tells the power
      ++seen;
      const double line_speed = central_of(g, k).base_radius_m * std::abs(w.rolling[k]);
      const double by_power = central_power(m, k) / (g.geometry.planets * line_speed);
      // Rounding of η, over 1 − η; of the iteration, which ends by the largest torque.
      force.see(i, m.normal_force_N - by_power, 1e-11 * by_power + 1e-13 * largest_force);
      const DrawnMesh drawn = draw(g, w, k);
      // Truncation of the midpoint rule: two jumps half a cell off.
      speed.see(i, m.sliding_speed_m_s - drawn.sliding_speed, 2e-3 * drawn.sliding_speed);
      const auto mu = friction_as_drawn(g, point, k, by_power, m.sliding_speed_m_s);
      ASSERT_TRUE(mu);
      friction.see(i, m.friction - *mu, 1e-10 * *mu);
    }
  }
  friction.expect_allowed("friction");
  force.expect_allowed("force");
  speed.expect_allowed("sliding_speed");
  EXPECT_GT(seen, 3000);
}

TEST(Operation, PlanetBearingsLoseTheirFrictionUnderTheResultantOfTheFlankForces) {
  Random random(33);
  LargestDeviation largest;
  for (int i = 0; i < 1000; ++i) {
    const Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)], LossModel::kSliding);
    const OperatingPoint<double> point = random.point();
    const Direction direction = kDirections[static_cast<std::size_t>(i / 5 % 2)];
    const auto result = operate(g.train(), point, direction);
    if (!result.operation) continue;
    const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
    // The planet's centre on the x axis; each force along the line of action through its pitch
    // point, pressing on the planet's flank.
    Vector resultant = 0.0;
    double scale = 0.0;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto& m = result.operation->mesh[k];
      const auto& central = central_of(g, k);
      const bool ring = k != kMeshSP1;
      const auto& planet =
          g.geometry.gears[static_cast<std::size_t>(k == kMeshP2R2 ? train::kP2 : train::kP1)];
      const double sum = ring ? central.base_radius_m - planet.base_radius_m
                              : central.base_radius_m + planet.base_radius_m;
      const double alpha = std::acos(sum / g.geometry.center_distance_m);
      // A central gear that drives pushes the planet the way it turns itself.
      const double sense =
          std::copysign(1.0, central_drives(k, m.gear1_drives) ? w.rolling[k] : -w.rolling[k]);
      // Away from the sun, away from the ring.
      const Vector into_planet = ring ? Vector(-1.0, 0.0) : Vector(1.0, 0.0);
      const Vector direction_of_force =
          sense * std::cos(alpha) * kQuarterTurn + std::sin(alpha) * into_planet;
      resultant += m.normal_force_N * direction_of_force;
      scale += m.normal_force_N;
    }
    const double turning = g.geometry.planets * g.shafts.planet_bearing_coefficient *
                           g.shafts.planet_bearing_radius_m * std::abs(w.planet - w.carrier);
    largest.see(i, result.operation->bearing_loss_W - turning * std::abs(resultant),
                1e-12 * turning * scale);
  }
  largest.expect_allowed("bearing");
}

// Of a law that needs no state, its coefficient; of the others, the law in the state of the mesh.
TEST(MeshFriction, IsThatOfTheLawWhereTheMeshRuns) {
  Random random(34);
  LargestDeviation friction;
  std::array<int, 5> seen{};
  for (int i = 0; i < 1000; ++i) {
    const auto law = static_cast<std::size_t>(i % 5);
    const Gearbox g = random.gearbox(kLaws[law], LossModel::kSliding);
    const OperatingPoint<double> point = random.point();
    const Direction direction = kDirections[static_cast<std::size_t>(i / 5 % 2)];
    const auto mu = mesh_friction(g.train(), point, direction);
    const auto result = operate(g.train(), point, direction);
    if (!mu || !result.operation) continue;
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const auto& m = result.operation->mesh[k];
      if (1.0 - m.efficiency < 1e-4) continue;  // the heat no longer tells the power
      ++seen[law];
      const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
      const double line_speed = central_of(g, k).base_radius_m * std::abs(w.rolling[k]);
      const double by_power = central_power(m, k) / (g.geometry.planets * line_speed);
      const auto expected = friction_as_drawn(g, point, k, by_power, m.sliding_speed_m_s);
      ASSERT_TRUE(expected);
      friction.see(i, (*mu)[k] - *expected, 1e-10 * *expected);
    }
  }
  friction.expect_allowed("friction");
  for (const int count : seen) EXPECT_GT(count, 300);
}

constexpr std::size_t kVariables = 8;
/// Sun torque (or that of R2 which turns a free sun), losses, friction of P2-R2 and bearing loss at
/// relative changes x of friction, load, speed, temperature, drag, bearing friction, centre
/// distance (in per cent) and of one shift.
template <class T>
std::optional<std::array<T, 4>> outcome_at(const Gearbox& g, const OperatingPoint<double>& point,
                                           std::optional<Direction> direction,
                                           const std::array<T, kVariables>& x) {
  const auto same = [](double value) { return constant<T>(value); };
  const auto& p = g.parameters;
  train::TrainParameters<T> parameters{};
  parameters.teeth = p.teeth;
  parameters.planets = p.planets;
  parameters.pressure_angle_rad = same(p.pressure_angle_rad);
  parameters.center_distance_m = p.center_distance_m * (1.0 + 0.01 * x[6]);
  for (std::size_t k = 0; k < 2; ++k) parameters.module_m[k] = same(p.module_m[k]);
  for (std::size_t k = 0; k < train::kGearCount; ++k) {
    parameters.profile_shift[k] = same(p.profile_shift[k]);
  }
  parameters.profile_shift[train::kP1] = p.profile_shift[train::kP1] + x[7];
  const auto geometry = make_train_geometry(parameters);
  if (!geometry) return std::nullopt;
  const auto& f = g.friction;
  Friction<T> friction{.coefficient = f.coefficient * (1.0 + x[0]),
                       .model = f.model,
                       .approach_factor = same(f.approach_factor),
                       .recess_factor = same(f.recess_factor),
                       .law = f.law,
                       .load_exponent = same(f.load_exponent),
                       .reference_force_N = same(f.reference_force_N),
                       .static_coefficient = same(f.static_coefficient),
                       .stribeck_speed_m_s = same(f.stribeck_speed_m_s),
                       .stribeck_exponent = same(f.stribeck_exponent),
                       .viscous_s_m = same(f.viscous_s_m),
                       .roughness_m = same(f.roughness_m),
                       .lubricant_factor = f.lubricant_factor * (1.0 + x[0]),
                       .lubricant = {},
                       .table = f.table};
  for (std::size_t k = 0; k < 2; ++k) {
    friction.lubricant.temperature_K[k] = same(f.lubricant.temperature_K[k]);
    friction.lubricant.viscosity_m2_s[k] = same(f.lubricant.viscosity_m2_s[k]);
  }
  friction.lubricant.density_kgm3 = same(f.lubricant.density_kgm3);
  ShaftLosses<T> shafts{};
  for (std::size_t k = 0; k < kShaftCount; ++k) {
    const auto& d = g.shafts.drag[k];
    shafts.drag[k] = {.constant_Nm = d.constant_Nm * (1.0 + x[4]),
                      .viscous_Nms = same(d.viscous_Nms),
                      .quadratic_Nms2 = same(d.quadratic_Nms2)};
  }
  shafts.planet_bearing_coefficient = g.shafts.planet_bearing_coefficient * (1.0 + x[5]);
  shafts.planet_bearing_radius_m = same(g.shafts.planet_bearing_radius_m);
  const LossyTrain<T> lossy{.geometry = *geometry,
                            .friction = friction,
                            .shafts = shafts,
                            .face_width_m = {same(g.face_width_m[0]), same(g.face_width_m[1])}};
  const OperatingPoint<T> at{.sun_speed_rad_s = point.sun_speed_rad_s * (1.0 + x[2]),
                             .output_torque_Nm = point.output_torque_Nm * (1.0 + x[1]),
                             .temperature_K = point.temperature_K * (1.0 + x[3])};
  const auto result = direction ? operate<T>(lossy, at, *direction) : drive_free_sun<T>(lossy, at);
  if (!result.operation) return std::nullopt;
  const auto& o = *result.operation;
  return std::array<T, 4>{direction ? o.sun_torque_Nm : o.output_torque_Nm, o.loss_W,
                          o.mesh[2].friction, o.bearing_loss_W};
}

TEST(Operation, GradientIsThatOfCentralDifferencesForEveryLawAndModel) {
  constexpr double kStep = 1e-4;
  Random random(35);
  LargestDeviation largest;
  int compared = 0, kinks = 0;
  const int cases = sample(240, 900);  // 60: every law, model and direction once
  for (int i = 0; i < cases; ++i) {
    const Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                                     kModels[static_cast<std::size_t>(i / 5 % 4)]);
    const OperatingPoint<double> point = random.point();
    std::optional<Direction> direction;  // empty: by R2 with a free sun
    if (i / 20 % 3 < 2) direction = kDirections[static_cast<std::size_t>(i / 20 % 3)];
    std::array<Jet1, kVariables> jets;
    for (std::size_t v = 0; v < kVariables; ++v) jets[v] = Jet1(0.0, static_cast<int>(v));
    const auto exact = outcome_at<Jet1>(g, point, direction, jets);
    const auto here = outcome_at<double>(g, point, direction, {});
    if (!exact || !here) continue;
    const double torque_scale =
        std::abs((*here)[0]) +
        (direction ? point.output_torque_Nm / std::abs(train::ratio(g.geometry.teeth)) : 0.0);
    for (std::size_t v = 0; v < kVariables; ++v) {
      const auto at = [&](double step) {
        std::array<double, kVariables> x{};
        x[v] = step;
        return outcome_at<double>(g, point, direction, x);
      };
      const std::array points{at(-kStep), at(-0.5 * kStep), at(0.5 * kStep), at(kStep)};
      if (!std::ranges::all_of(points, [](const auto& p) { return p.has_value(); })) continue;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto value = [&](std::size_t p) { return (*points[p])[k]; };
        const double scale = k == 0 ? torque_scale : std::abs((*here)[k]);
        // Second differences quarter with the step, but for a kink (of a table, at a whole contact
        // ratio, where a driver changes) in between.
        const double bend = value(3) - 2.0 * (*here)[k] + value(0);
        const double half_bend = value(2) - 2.0 * (*here)[k] + value(1);
        if (std::abs(bend - 4.0 * half_bend) > 0.1 * std::abs(bend) + 1e-11 * scale) {
          ++kinks;
          continue;
        }
        const double slope = (value(2) - value(1)) / kStep;
        const double coarse = (value(3) - value(0)) / (2.0 * kStep);
        // Truncation: what halving the step changes; rounding and the end of the iteration, which a
        // free sun amplifies near the locking limit.
        const double rounding = direction ? 1e-13 : 2e-12;
        largest.see(i, (*exact)[k].v[static_cast<int>(v)] - slope,
                    std::abs(slope - coarse) + scale * rounding / kStep + 1e-300);
        ++compared;
      }
    }
  }
  largest.expect_allowed("gradient");
  EXPECT_GT(compared, 16 * cases);
  EXPECT_LT(kinks, compared / 50);
}

// --- extensions of a calibrated model

/// With every extension at once.
void extend_by_mesh(Random& random, efficiency::FrictionExtension<double>& e) {
  e.inner_drives = random.between(0.8, 1.2);
  e.outer_drives = random.between(0.8, 1.2);
  e.ring_meshes = random.between(0.8, 1.2);
}

void extend(Random& random, Gearbox& g) {
  auto& e = g.friction.extension;
  e.level = random.between(0.5, 1.3);
  e.load_exponent = random.between(-0.2, 0.2);
  e.reference_force_N = random.scale(5.0, 200.0);
  e.slow_excess = random.between(-0.3, 0.5);
  e.slow_speed_m_s = random.scale(1e-2, 1.0);
  e.speed_exponent = random.between(-0.1, 0.1);
  e.reference_speed_m_s = random.scale(1e-2, 1.0);
  e.temperature_1_K = random.between(-5e-3, 5e-3);
  e.forward = random.between(0.8, 1.2);
  e.backward = random.between(0.8, 1.2);
  e.approach = random.between(0.8, 1.2);
  e.recess = random.between(0.8, 1.2);
  extend_by_mesh(random, e);
  g.shafts.output_bearing_share = random.between(0.0, 0.05);
  g.shafts.drag_temperature_1_K = random.between(-0.02, 0.02);
}

TEST(ExtendedOperation, InputLessOutputPowerIsTheSumOfTheLosses) {
  Random random(261);
  LargestDeviation power;
  int operating = 0;
  for (int i = 0; i < 4000; ++i) {
    Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                               kModels[static_cast<std::size_t>(i / 5 % 4)]);
    extend(random, g);
    const OperatingPoint<double> point = random.point();
    const Direction direction = kDirections[static_cast<std::size_t>(i / 20 % 2)];
    const auto result = operate(g.train(), point, direction);
    if (!result.operation) continue;
    ++operating;
    const Operation<double>& o = *result.operation;
    const Speeds w = speeds_of(g.geometry.teeth, point.sun_speed_rad_s);
    const double sun = o.sun_torque_Nm * std::abs(w.sun);
    const double output = o.output_torque_Nm * w.output;
    double losses = o.bearing_loss_W;
    for (const auto& m : o.mesh) losses += m.loss_W;
    for (const double loss : o.drag_loss_W) losses += loss;
    const double in_less_out = direction == Direction::kForward ? sun - output : output - sun;
    power.see(i, in_less_out - losses, 1e-12 * (std::abs(sun) + std::abs(output) + losses));
  }
  power.expect_allowed("power");
  EXPECT_GT(operating, 3000);
}

/// The balance of torques settles who drives by itself.
TEST(ExtendedOperation, FactorsByMeshNeedNoOperatingPoint) {
  Random random(264);
  LargestDeviation train, mesh;
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, kModels[static_cast<std::size_t>(i % 4)]);
    g.shafts = {};
    g.friction.extension.level = random.between(0.5, 1.3);
    g.friction.extension.backward = random.between(0.8, 1.2);
    extend_by_mesh(random, g.friction.extension);
    ASSERT_FALSE(efficiency::depends_on_state(g.friction));
    const Direction direction = kDirections[static_cast<std::size_t>(i / 4 % 2)];
    const bool forward = direction == Direction::kForward;
    const auto result = operate(g.train(), random.point(), direction);
    if (!result.operation || !(*result.operation->efficiency > 0.0)) continue;
    const auto& z = g.geometry.teeth;
    const auto flanks = efficiency::constant_friction<double>(g.friction, z, forward);
    const auto eta = efficiency::mesh_efficiencies(g.geometry, flanks, g.friction.model, forward);
    const double alone =
        forward ? efficiency::forward_efficiency(z, eta) : efficiency::backward_efficiency(z, eta);
    if (!(alone > 0.0)) continue;
    ++seen;
    const auto mu = mesh_friction<double>(g.train(), {}, direction);
    ASSERT_TRUE(mu);
    for (std::size_t k = 0; k < kMeshCount; ++k) {
      const double expected = result.operation->mesh[k].friction;
      EXPECT_NEAR((*mu)[k], expected, 4.0 * kEps * expected) << "case " << i;
      mesh.see(i, eta[k] - result.operation->mesh[k].efficiency, 8.0 * kEps);
    }
    train.see(i, *result.operation->efficiency - alone,
              64.0 * kEps * (1.0 + std::abs(train::ratio(z))));
  }
  train.expect_allowed("efficiency");
  mesh.expect_allowed("efficiency of a mesh");
  EXPECT_GT(seen, 1000);
}

TEST(ExtendedOperation, ANeutralExtensionChangesNoBit) {
  Random random(262);
  for (int i = 0; i < 400; ++i) {
    const Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                                     kModels[static_cast<std::size_t>(i / 5 % 4)]);
    const OperatingPoint<double> point = random.point();
    Gearbox neutral = g;
    // Constants without effect while the exponents are 0.
    auto& e = neutral.friction.extension;
    e.reference_force_N = 37.0;
    e.slow_speed_m_s = 0.3;
    e.reference_speed_m_s = 0.7;
    e.reference_temperature_K = 350.0;
    neutral.shafts.drag_reference_temperature_K = 400.0;
    for (const Direction direction : kDirections) {
      const auto plain = operate(g.train(), point, direction);
      const auto extended = operate(neutral.train(), point, direction);
      ASSERT_EQ(plain.operation.has_value(), extended.operation.has_value());
      if (!plain.operation) continue;
      EXPECT_EQ(plain.operation->sun_torque_Nm, extended.operation->sun_torque_Nm);
      EXPECT_EQ(plain.operation->loss_W, extended.operation->loss_W);
    }
  }
}

/// Own derivation: R2's teeth carry the load and the bearing's friction.  Forward
/// M_teeth = M_load + s M_load, backward M_teeth = M_drive − s M_drive; the rest of the train,
/// with friction proportional to load, sees the same gearbox under that torque.
TEST(ExtendedOperation, AnOutputBearingLoadsTheTeethByItsShareOfTheShaftsTorque) {
  Random random(263);
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < 500; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, kModels[static_cast<std::size_t>(i % 4)]);
    g.shafts = {};
    Gearbox with_bearing = g;
    const double share = random.between(0.0, 0.1);
    with_bearing.shafts.output_bearing_share = share;
    const OperatingPoint<double> point = random.point();
    for (const Direction direction : kDirections) {
      const bool forward = direction == Direction::kForward;
      OperatingPoint<double> at_teeth = point;
      at_teeth.output_torque_Nm *= forward ? 1.0 + share : 1.0 - share;
      const auto plain = operate(g.train(), at_teeth, direction);
      const auto bearing = operate(with_bearing.train(), point, direction);
      if (!plain.operation || !bearing.operation) continue;
      // A train that R2 cannot turn is helped at the sun; the teeth's torque then changes sides.
      if (!(plain.operation->sun_torque_Nm > 0.0)) continue;
      ++seen;
      const double expected = plain.operation->sun_torque_Nm;
      largest.see(i, bearing.operation->sun_torque_Nm - expected, 1e-11 * expected);
      const double loss = share * point.output_torque_Nm *
                          std::abs(speeds_of(g.geometry.teeth, point.sun_speed_rad_s).output);
      largest.see(i, bearing.operation->bearing_loss_W - loss, 1e-11 * loss + 1e-300);
    }
  }
  largest.expect_allowed("torque of the sun");
  EXPECT_GT(seen, 500);
}

TEST(ExtendedOperation, AMeshsOwnShareOfTheLoadIsItsForceOverThatOfALosslessTrain) {
  Random random(271);
  LargestDeviation largest;
  int seen = 0;
  for (int i = 0; i < 500; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, kModels[static_cast<std::size_t>(i % 4)]);
    g.friction.coefficient = random.between(0.01, 0.08);
    g.shafts = {};
    Gearbox lossless = g;
    lossless.friction.coefficient = 0.0;
    auto& e = g.friction.extension;
    e.load_exponent = random.between(-0.8, 0.8);
    e.load_is_torque = e.share_is_of_force = true;
    const OperatingPoint<double> point = random.point();
    OperatingPoint<double> at_reference = point;
    at_reference.output_torque_Nm = e.reference_force_N = random.scale(0.1, 20.0);
    for (const Direction direction : kDirections) {
      const auto result = operate(g.train(), point, direction);
      const auto reference = operate(lossless.train(), at_reference, direction);
      if (!result.operation || !reference.operation) continue;
      for (std::size_t k = 0; k < kMeshCount; ++k) {
        const auto& mesh = result.operation->mesh[k];
        const double share = mesh.normal_force_N / reference.operation->mesh[k].normal_force_N;
        const double expected = g.friction.coefficient * std::pow(share, e.load_exponent);
        if (!(share > 1e-3) || !(expected < 0.5)) continue;
        ++seen;
        largest.see(i, mesh.friction - expected, 1e-10 * expected);
      }
    }
  }
  largest.expect_allowed("friction");
  EXPECT_GT(seen, 1000);
}

/// With the sun's torque given no mesh knows of the output's bearing, so that their torques repeat
/// before the shaft's does.
TEST(ExtendedOperation, AnOutputBearingTakesItsShareWithAFreeSunToo) {
  Random random(268);
  LargestDeviation operated, balanced;
  int seen = 0, moving = 0;
  for (int i = 0; i < 400; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, kModels[static_cast<std::size_t>(i % 4)]);
    g.shafts.planet_bearing_coefficient = 0.0;
    const double share = random.between(0.05, 0.3);
    g.shafts.output_bearing_share = share;
    const OperatingPoint<double> point = random.point();
    const double output = speeds_of(g.geometry.teeth, point.sun_speed_rad_s).output;
    if (const auto free = drive_free_sun(g.train(), point).operation) {
      ++seen;
      const double loss = share * free->output_torque_Nm * output;
      operated.see(i, free->bearing_loss_W - loss, 1e-10 * loss + 1e-300);
    }
    const auto found =
        balance_motion({.lossy = g.train(), .bodies = {}}, {.output_speed_rad_s = output,
                                                            .given_end = train::End::kSun,
                                                            .given_torque_Nm = 0.0,
                                                            .temperature_K = point.temperature_K});
    if (!found.instant) continue;
    ++moving;
    const double loss = share * std::abs(found.instant->output_torque_Nm) * output;
    balanced.see(i, found.instant->bearing_loss_W - loss, 1e-10 * loss + 1e-300);
  }
  operated.expect_allowed("operation");
  balanced.expect_allowed("balance");
  EXPECT_GT(seen, 50);
  EXPECT_GT(moving, 50);
}

TEST(ExtendedOperation, DragsFollowTheTemperatureTogether) {
  Random random(264);
  LargestDeviation largest;
  for (int i = 0; i < 300; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, LossModel::kSliding);
    OperatingPoint<double> point = random.point();
    const auto cold = operate(g.train(), point, Direction::kForward);
    const double per_kelvin = random.between(-0.03, 0.03);
    g.shafts.drag_temperature_1_K = per_kelvin;
    g.shafts.drag_reference_temperature_K = 300.0;
    const auto warm = operate(g.train(), point, Direction::kForward);
    ASSERT_TRUE(cold.operation && warm.operation);
    const double factor = std::exp(per_kelvin * (point.temperature_K - 300.0));
    for (std::size_t k = 0; k < kShaftCount; ++k) {
      const double expected = factor * cold.operation->drag_loss_W[k];
      largest.see(i, warm.operation->drag_loss_W[k] - expected, 1e-13 * expected + 1e-300);
    }
  }
  largest.expect_allowed("drag");
}

TEST(ExtendedOperation, LevelAndSideAreThoseOfAnotherCoefficient) {
  Random random(265);
  for (int i = 0; i < 200; ++i) {
    const Gearbox g =
        random.gearbox(FrictionLaw::kConstant, kModels[static_cast<std::size_t>(i % 4)]);
    const OperatingPoint<double> point = random.point();
    Gearbox extended = g;
    extended.friction.extension.level = 1.25;
    extended.friction.extension.forward = 0.5;
    extended.friction.extension.backward = 1.5;
    for (const Direction direction : kDirections) {
      Gearbox other = g;
      other.friction.coefficient *= 1.25 * (direction == Direction::kForward ? 0.5 : 1.5);
      const auto a = operate(extended.train(), point, direction);
      const auto b = operate(other.train(), point, direction);
      ASSERT_EQ(a.operation.has_value(), b.operation.has_value());
      if (!a.operation) continue;
      EXPECT_NEAR(a.operation->sun_torque_Nm, b.operation->sun_torque_Nm,
                  1e-12 * std::abs(b.operation->output_torque_Nm));
    }
  }
}

TEST(ExtendedOperation, GradientsByTheModelsParametersAreThoseOfCentralDifferences) {
  Random random(266);
  int seen = 0;
  for (int i = 0; i < 60; ++i) {
    Gearbox g = random.gearbox(FrictionLaw::kConstant, LossModel::kSliding);
    extend(random, g);
    const OperatingPoint<double> point = random.point();
    const auto torque = [&](std::size_t which, double step) -> std::optional<double> {
      Gearbox moved = g;
      auto& e = moved.friction.extension;
      const std::array<double*, 6> places{&e.level,    &e.load_exponent,
                                          &e.approach, &moved.shafts.output_bearing_share,
                                          &e.forward,  &moved.shafts.drag_temperature_1_K};
      *places[which] += step;
      const auto result = operate(moved.train(), point, Direction::kForward);
      if (!result.operation) return std::nullopt;
      return result.operation->sun_torque_Nm;
    };
    // The same through Jets.
    train::TrainParameters<Jet1> p;
    p.teeth = g.parameters.teeth;
    p.planets = g.parameters.planets;
    p.pressure_angle_rad = constant<Jet1>(g.parameters.pressure_angle_rad);
    p.center_distance_m = constant<Jet1>(g.parameters.center_distance_m);
    for (std::size_t k = 0; k < 2; ++k) p.module_m[k] = constant<Jet1>(g.parameters.module_m[k]);
    for (std::size_t k = 0; k < train::kGearCount; ++k) {
      p.profile_shift[k] = constant<Jet1>(g.parameters.profile_shift[k]);
      p.rack[k] = {.addendum = constant<Jet1>(g.parameters.rack[k].addendum),
                   .dedendum = constant<Jet1>(g.parameters.rack[k].dedendum),
                   .root_radius = constant<Jet1>(g.parameters.rack[k].root_radius)};
    }
    const auto geometry = train::make_train_geometry(p);
    ASSERT_TRUE(geometry);
    Friction<Jet1> friction{};
    friction.model = g.friction.model;
    friction.coefficient = constant<Jet1>(g.friction.coefficient);
    friction.approach_factor = constant<Jet1>(g.friction.approach_factor);
    friction.recess_factor = constant<Jet1>(g.friction.recess_factor);
    friction.extension = extension_as<Jet1>(g.friction.extension);
    Extension<double> shafts{};
    shafts.drag = g.shafts.drag;
    const Extension<Jet1> jets = extension_as<Jet1>(shafts);
    ShaftLosses<Jet1> losses{};
    losses.drag = jets.drag;
    losses.planet_bearing_coefficient = constant<Jet1>(g.shafts.planet_bearing_coefficient);
    losses.planet_bearing_radius_m = constant<Jet1>(g.shafts.planet_bearing_radius_m);
    losses.output_bearing_share = constant<Jet1>(g.shafts.output_bearing_share);
    losses.drag_temperature_1_K = constant<Jet1>(g.shafts.drag_temperature_1_K);
    losses.drag_reference_temperature_K = g.shafts.drag_reference_temperature_K;
    auto& e = friction.extension;
    const std::array<Jet1*, 6> places{&e.level,    &e.load_exponent,
                                      &e.approach, &losses.output_bearing_share,
                                      &e.forward,  &losses.drag_temperature_1_K};
    for (std::size_t k = 0; k < places.size(); ++k)
      places[k]->v[static_cast<Eigen::Index>(k)] = 1.0;
    const auto result = operate<Jet1>(
        {.geometry = *geometry, .friction = friction, .shafts = losses, .face_width_m = {}},
        {.sun_speed_rad_s = constant<Jet1>(point.sun_speed_rad_s),
         .output_torque_Nm = constant<Jet1>(point.output_torque_Nm),
         .temperature_K = constant<Jet1>(point.temperature_K)},
        Direction::kForward);
    if (!result.operation) continue;
    ++seen;
    const Jet1& sun = result.operation->sun_torque_Nm;
    for (std::size_t k = 0; k < places.size(); ++k) {
      constexpr double kStep = 1e-5;
      const auto above = torque(k, kStep);
      const auto below = torque(k, -kStep);
      ASSERT_TRUE(above && below);
      // Truncation of third order and the rounding of the torques over the step.
      EXPECT_NEAR(sun.v[static_cast<Eigen::Index>(k)], (*above - *below) / (2.0 * kStep),
                  1e-6 * sun.a + 1e-6 * std::abs(sun.v[static_cast<Eigen::Index>(k)]))
          << "case " << i << " parameter " << k;
    }
  }
  EXPECT_GT(seen, 40);
}

// --- the same torque with derivatives at fixed geometry

template <class T>
train::TrainParameters<T> parameters_as(const train::TrainParameters<double>& from) {
  const auto as = [](double x) { return constant<T>(x); };
  train::TrainParameters<T> p;
  p.teeth = from.teeth;
  p.planets = from.planets;
  p.pressure_angle_rad = as(from.pressure_angle_rad);
  p.center_distance_m = as(from.center_distance_m);
  for (std::size_t k = 0; k < 2; ++k) p.module_m[k] = as(from.module_m[k]);
  for (std::size_t k = 0; k < train::kGearCount; ++k) {
    p.profile_shift[k] = as(from.profile_shift[k]);
    p.rack[k] = {.addendum = as(from.rack[k].addendum),
                 .dedendum = as(from.rack[k].dedendum),
                 .root_radius = as(from.rack[k].root_radius)};
  }
  return p;
}

TEST(SunTorque, IsThatOfTheOperationWithItsDerivativesByTheLosses) {
  Random random(77);
  LargestDeviation value, slope;
  int compared = 0, left_to_operate = 0;
  const auto as = [](double x) { return constant<Jet1>(x); };
  for (int i = 0; i < 1200; ++i) {
    Gearbox g = random.gearbox(kLaws[static_cast<std::size_t>(i % 5)],
                               kModels[static_cast<std::size_t>(i / 5 % 4)]);
    if (i / 40 % 2 == 1) {
      extend(random, g);
      g.friction.extension.load_is_torque = i / 80 % 2 == 1;
      g.friction.extension.share_is_of_force = i / 160 % 2 == 1;
    }
    const OperatingPoint<double> point = random.point();
    const Direction direction = kDirections[static_cast<std::size_t>(i / 20 % 2)];
    const auto& f = g.friction;
    VariedLosses losses;
    losses.friction = {.coefficient = as(f.coefficient),
                       .model = f.model,
                       .approach_factor = as(f.approach_factor),
                       .recess_factor = as(f.recess_factor),
                       .law = f.law,
                       .load_exponent = as(f.load_exponent),
                       .reference_force_N = as(f.reference_force_N),
                       .static_coefficient = as(f.static_coefficient),
                       .stribeck_speed_m_s = as(f.stribeck_speed_m_s),
                       .stribeck_exponent = as(f.stribeck_exponent),
                       .viscous_s_m = as(f.viscous_s_m),
                       .roughness_m = as(f.roughness_m),
                       .lubricant_factor = as(f.lubricant_factor),
                       .lubricant = {.temperature_K = {as(313.15), as(373.15)},
                                     .viscosity_m2_s = {as(f.lubricant.viscosity_m2_s[0]),
                                                        as(f.lubricant.viscosity_m2_s[1])},
                                     .density_kgm3 = as(f.lubricant.density_kgm3)},
                       .table = f.table,
                       .extension = extension_as<Jet1>(f.extension)};
    Extension<double> drags{};
    drags.drag = g.shafts.drag;
    losses.shafts.drag = extension_as<Jet1>(drags).drag;
    losses.shafts.planet_bearing_coefficient = as(1.0);
    losses.shafts.planet_bearing_radius_m =
        as(g.shafts.planet_bearing_coefficient * g.shafts.planet_bearing_radius_m);
    losses.shafts.output_bearing_share = as(g.shafts.output_bearing_share);
    losses.shafts.drag_temperature_1_K = as(g.shafts.drag_temperature_1_K);
    auto& e = losses.friction.extension;
    const std::array<Jet1*, kVariables> places{&e.level,
                                               &e.load_exponent,
                                               &e.approach,
                                               &e.recess,
                                               &e.temperature_1_K,
                                               &losses.shafts.planet_bearing_radius_m,
                                               &losses.shafts.output_bearing_share,
                                               &losses.shafts.drag[kSunShaft].constant_Nm};
    for (std::size_t k = 0; k < kVariables; ++k) {
      places[k]->v[static_cast<Eigen::Index>(k)] = 1.0;
    }
    const auto geometry = train::make_train_geometry(parameters_as<Jet1>(g.parameters));
    ASSERT_TRUE(geometry);
    const auto exact =
        operate<Jet1>({.geometry = *geometry,
                       .friction = losses.friction,
                       .shafts = losses.shafts,
                       .face_width_m = {as(g.face_width_m[0]), as(g.face_width_m[1])}},
                      {.sun_speed_rad_s = as(point.sun_speed_rad_s),
                       .output_torque_Nm = as(point.output_torque_Nm),
                       .temperature_K = as(point.temperature_K)},
                      direction);
    const auto fast = SunTorque({.geometry = g.geometry, .face_width_m = g.face_width_m}, losses)
                          .at(point, direction);
    if (!exact.operation) {
      EXPECT_FALSE(fast) << "case " << i;
      continue;
    }
    if (!fast) {
      ++left_to_operate;
      continue;
    }
    ++compared;
    const Jet1& sun = exact.operation->sun_torque_Nm;
    const double scale =
        std::abs(sun.a) + point.output_torque_Nm / std::abs(train::ratio(g.geometry.teeth));
    value.see(i, fast->a - sun.a, 1e-11 * scale);
    // The iterated derivatives stop one pass behind the values.
    slope.see(i, (fast->v - sun.v).norm(), 1e-8 * (scale + sun.v.norm()));
  }
  value.expect_allowed("torque");
  slope.expect_allowed("derivatives");
  EXPECT_GT(compared, 600);
  EXPECT_LT(left_to_operate, compared / 20);
}

}  // namespace
}  // namespace gear3k::design::operation_test
