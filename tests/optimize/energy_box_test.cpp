// What the meshes of a tooth set lose at most, against gears drawn at random: rolling on each other
// by formulas typed anew, their losses summed over a base pitch.

#include "optimize/energy_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include "efficiency/friction_law.hpp"
#include "optimize/shift_range.hpp"
#include "optimize/stage_relaxation.hpp"
#include "optimize/stage_tasks.hpp"
#include "tests/rig/deterministic_random.hpp"
#include "tests/sample.hpp"

namespace gear3k::optimize::energy_box_test {
namespace {

using design::CheckId;
using efficiency::LossModel;
using rig::DeterministicRandom;

double inv(double angle) { return std::tan(angle) - angle; }
double angle_of(double involute) {
  double lo = 0.0, hi = 1.57;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (lo + hi);
    (inv(middle) < involute ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

/// A mesh at work; z2 of a ring is negative, lengths are in modules.
struct Mesh {
  double z1 = 0.0, z2 = 0.0, e1 = 0.0, e2 = 0.0, tangent = 0.0;
  bool interferes = false;
};

/// Efficiency of a mesh with friction μ_a in approach and μ_r in recess: of the pairs that share
/// the load, at the middles of steps on which their number is the same.
struct Sides {
  double approach, recess;
};
double path_efficiency(const Mesh& m, const Sides& mu, bool first_drives, bool first_order) {
  const double turn = 2.0 * std::numbers::pi;
  const double zd = first_drives ? m.z1 : m.z2, zf = first_drives ? m.z2 : m.z1;
  const double ea = first_drives ? m.e2 : m.e1, er = first_drives ? m.e1 : m.e2;
  const auto lost_share = [&](double start, int pairs) {
    double driving = 0.0, lost = 0.0;
    for (int k = 0; k < pairs; ++k) {
      const double s = start + k;
      const double f = s < 0.0 ? mu.approach : -mu.recess;
      const double torque = first_order ? 1.0 : 1.0 - f * (m.tangent + turn * s / zd);
      const double gone = -f * s * turn * (1.0 / zd + 1.0 / zf);
      if (torque <= 0.0 || (!first_order && torque <= gone)) return 1.0;
      driving += torque;
      lost += gone;
    }
    return lost / driving;
  };
  const double epsilon = ea + er;
  if (epsilon <= 0.0) return 1.0 - lost_share(0.5 * (er - ea), 1);
  const int fewer = static_cast<int>(epsilon);
  const double share = epsilon - fewer;
  constexpr int kSteps = 60;
  double loss = 0.0;
  for (int n = 0; n < kSteps; ++n) {
    const double at = (n + 0.5) / kSteps;
    const double more = lost_share(-ea + share * at, fewer + 1);
    if (fewer == 0) {
      loss += more / kSteps;
    } else {
      loss += (share * more + (1.0 - share) * lost_share(-ea + share + (1.0 - share) * at, fewer)) /
              kSteps;
    }
  }
  return 1.0 - loss;
}

/// As the specification's model has it.
double efficiency_of(const Mesh& m, const Specification& spec,
                     const efficiency::FlankFriction<double>& flank, bool first_drives) {
  const double mu = flank.coefficient;
  const Sides sides{mu * flank.approach_factor, mu * flank.recess_factor};
  const LossModel model = spec.friction.model;
  if (model == LossModel::kCoulombPath || model == LossModel::kDirectional) {
    return path_efficiency(m, sides, first_drives, false);
  }
  const double ohlendorf = 1.0 - std::numbers::pi * (1.0 / m.z1 + 1.0 / m.z2) * mu *
                                     (1.0 - m.e1 - m.e2 + m.e1 * m.e1 + m.e2 * m.e2);
  return (model == LossModel::kOhlendorf ? ohlendorf
                                         : path_efficiency(m, {mu, mu}, first_drives, true)) +
         path_efficiency(m, sides, first_drives, false) -
         path_efficiency(m, {mu, mu}, first_drives, false);
}

/// Shifts and normal backlashes that make a stage; without a sun of the planet and its ring.
struct Stage {
  double sun_shift = 0.0, planet_shift = 0.0, ring_shift = 0.0;
  double sun_backlash = 0.0, ring_backlash = 0.0;
};
struct Meshes {
  std::optional<Mesh> sun;
  Mesh ring;
};

/// Gears of a specification at unit module.
class Maker {
 public:
  Maker(const Specification& spec, const train::ToothSet& z)
      : spec_(spec), z_(train::teeth_of(z)), alpha_(spec.pressure_angle_rad) {}

  /// @param drawn  in stage 1 the ring's shift follows from the centre distance, and is returned
  [[nodiscard]] std::optional<Meshes> stage1(Stage& drawn) const {
    const double sum = z_[train::kS] + z_[train::kP1];
    const double opening = 2.0 * std::sin(alpha_) * (drawn.sun_shift + drawn.planet_shift) -
                           thinning(train::kS, train::kP1) + drawn.sun_backlash;
    const auto distance = distance_at(sum, opening);
    if (!distance) return std::nullopt;
    const double difference = z_[train::kR1] - z_[train::kP1];
    const double cosine = 0.5 * difference * std::cos(alpha_) / *distance;
    if (!(cosine < 1.0)) return std::nullopt;
    const double wide = difference * std::cos(alpha_) * (inv(std::acos(cosine)) - inv(alpha_));
    drawn.ring_shift =
        drawn.planet_shift +
        (wide + drawn.ring_backlash - thinning(train::kP1, train::kR1)) / (2.0 * std::sin(alpha_));
    return Meshes{mesh(train::kS, drawn.sun_shift, train::kP1, drawn.planet_shift, *distance),
                  mesh(train::kP1, drawn.planet_shift, train::kR1, drawn.ring_shift, *distance)};
  }
  [[nodiscard]] std::optional<Meshes> stage2(const Stage& drawn) const {
    const double difference = z_[train::kR2] - z_[train::kP2];
    const double opening = 2.0 * std::sin(alpha_) * (drawn.ring_shift - drawn.planet_shift) +
                           thinning(train::kP2, train::kR2) - drawn.ring_backlash;
    const auto distance = distance_at(difference, opening);
    if (!distance) return std::nullopt;
    return Meshes{std::nullopt,
                  mesh(train::kP2, drawn.planet_shift, train::kR2, drawn.ring_shift, *distance)};
  }

 private:
  [[nodiscard]] double thinning(std::size_t a, std::size_t b) const {
    return spec_.machining_allowance[a] + spec_.machining_allowance[b];
  }
  [[nodiscard]] std::optional<double> distance_at(double teeth, double opening) const {
    const double involute = inv(alpha_) + opening / (teeth * std::cos(alpha_));
    if (!(involute > 1e-6 && involute < 3.0)) return std::nullopt;
    return 0.5 * teeth * std::cos(alpha_) / std::cos(angle_of(involute));
  }
  [[nodiscard]] Mesh mesh(std::size_t first, double x1, std::size_t second, double x2,
                          double distance) const {
    const bool ring = second == train::kR1 || second == train::kR2;
    const double sign = ring ? -1.0 : 1.0;
    const double rb1 = 0.5 * z_[first] * std::cos(alpha_);
    const double rb2 = 0.5 * z_[second] * std::cos(alpha_);
    const auto flank = [&](std::size_t gear, double x, double outwards, double rb) {
      const double tip =
          0.5 * z_[gear] + x + outwards * (spec_.rack.addendum - spec_.tip_shortening[gear]);
      return tip > rb ? std::sqrt(tip * tip - rb * rb) : 0.0;
    };
    const double rho1 = flank(first, x1, 1.0, rb1), rho2 = flank(second, x2, sign, rb2);
    const double line = std::sqrt(distance * distance - (rb2 + sign * rb1) * (rb2 + sign * rb1));
    const double tangent = line / (rb2 + sign * rb1);
    const double pitch = std::numbers::pi * std::cos(alpha_);
    return {.z1 = static_cast<double>(z_[first]),
            .z2 = sign * z_[second],
            .e1 = (rho1 - rb1 * tangent) / pitch,
            .e2 = sign * (rho2 - rb2 * tangent) / pitch,
            .tangent = tangent,
            .interferes = ring ? rho2 < line : rho1 > line || rho2 > line};
  }

  const Specification& spec_;
  std::array<int, train::kGearCount> z_;
  double alpha_;
};

Specification bare_specification() {
  Specification spec;
  spec.limits = {};
  spec.limits[CheckId::kNormalBacklash] = 0.0;
  spec.planets = {1};
  spec.ratio = {.target = 50.0, .tolerance = 0.5};
  spec.module = {ModuleChoice{.range_m = NumberRange{.min = 1e-3, .max = 1e-3}, .series_m = {}},
                 ModuleChoice{.range_m = NumberRange{.min = 1e-3, .max = 1e-3}, .series_m = {}}};
  spec.pressure_angle_rad = 20.0 * std::numbers::pi / 180.0;
  spec.friction.coefficient = 0.08;
  return spec;
}

bool keeps_limits(const Mesh& m, const Specification& spec) {
  const double epsilon = m.e1 + m.e2;
  const auto& least = spec.limits[CheckId::kContactRatioMin];
  const auto& most = spec.limits[CheckId::kContactRatioMax];
  return !(least && epsilon < *least) && !(most && epsilon > *most) &&
         !(spec.limits[CheckId::kInvoluteInterference] && m.interferes);
}

/// Least efficiency of a mesh, driven either way by either friction.
double worst_efficiency(const Mesh& m, const Specification& spec, const train::ToothSet& z,
                        std::size_t mesh) {
  double worst = 1.0;
  for (const bool forward : {false, true}) {
    const auto flank = efficiency::constant_friction<double>(spec.friction, z, forward)[mesh];
    for (const bool first_drives : {false, true}) {
      worst = std::min(worst, efficiency_of(m, spec, flank, first_drives));
    }
  }
  return worst;
}

/// Of the meshes of a set, as the bound of their efficiencies takes it.
std::array<MeshReach, train::kMeshCount> reach_of(const Specification& spec,
                                                  const train::ToothSet& z) {
  const StageTasks tasks(spec);
  const auto shifts = [&](int gear) {
    return shift_range(spec, gear, train::teeth_of(z)[static_cast<std::size_t>(gear)]).widest;
  };
  const Candidate set{.teeth = z, .planets = 1};
  StageTask task1 =
      tasks.stage1(set, {shifts(train::kS), shifts(train::kP1), shifts(train::kR1)}, 1.0);
  StageTask task2 = tasks.stage2(set, {shifts(train::kP2), shifts(train::kR2)}, 1.0, kInfinity);
  task1.least = task2.least = StageTask::Least::kDistance;
  const TeethReach stage1 = teeth_reach(task1);
  return {stage1.sun, stage1.ring, teeth_reach(task2).ring};
}

/// Steps of a base pitch, at kinks.
constexpr double kTruncation = 2e-4;

TEST(LeastMeshEfficiencies, HoldWhereThePathLiesOnOneSideOfThePitchPoint) {
  Specification spec = bare_specification();
  spec.profile_shift = {.min = 2.2, .max = 2.3};
  spec.tip_shortening[train::kP2] = spec.tip_shortening[train::kR2] = 0.2;
  spec.limits[CheckId::kContactRatioMin] = 1.0;
  spec.limits[CheckId::kContactRatioMax] = 1.05;
  spec.limits[CheckId::kInvoluteInterference] = 0.0;
  const train::ToothSet z{.S = 12, .P1 = 28, .R1 = 68, .P2 = 60, .R2 = 100};
  const auto meshes = Maker(spec, z).stage2({.planet_shift = 2.3, .ring_shift = 2.3});
  ASSERT_TRUE(meshes && keeps_limits(meshes->ring, spec));
  ASSERT_LT(meshes->ring.e2, -1.0);
  ASSERT_GT(meshes->ring.e1, 2.0);  // farther than the path is long
  const double worst = worst_efficiency(meshes->ring, spec, z, train::kMeshP2R2);
  const double bound = least_mesh_efficiencies(spec, z, 1)[train::kMeshP2R2];
  EXPECT_LE(bound, worst);
  EXPECT_LT(1.0 - bound, 1.5 * (1.0 - worst));
}

TEST(LeastMeshEfficiencies, HoldWhereTheShiftThatLengthensATipIsNotTheGreatest) {
  Specification spec = bare_specification();
  spec.pressure_angle_rad = 25.0 * std::numbers::pi / 180.0;
  spec.profile_shift = {.min = -1.0, .max = 0.3};
  spec.ring_shift = NumberRange{.min = -4.0, .max = 4.0};
  spec.machining_allowance[train::kS] = spec.machining_allowance[train::kP1] = 0.05;
  spec.limits[CheckId::kContactRatioMin] = 1.0;
  spec.limits[CheckId::kInvoluteInterference] = 0.0;
  const train::ToothSet z{.S = 32, .P1 = 60, .R1 = 152, .P2 = 60, .R2 = 146};
  Stage drawn{.sun_shift = -0.983, .planet_shift = -0.950};
  const auto meshes = Maker(spec, z).stage1(drawn);
  ASSERT_TRUE(meshes && keeps_limits(*meshes->sun, spec) && keeps_limits(meshes->ring, spec));
  ASSERT_GT(drawn.ring_shift, -4.0);
  const double farthest = std::max(meshes->sun->e1, meshes->sun->e2);
  ASSERT_GT(farthest, 1.55);  // with the greatest shift 1.48
  const double bound = reach_of(spec, z)[train::kMeshSP1].farthest;
  EXPECT_GE(bound, farthest);
  EXPECT_LT(bound, 1.5 * farthest);
  EXPECT_LE(least_mesh_efficiencies(spec, z, 1)[train::kMeshSP1],
            worst_efficiency(*meshes->sun, spec, z, train::kMeshSP1));
}

/// Long and short teeth, wide and narrow shifts, all models.
Specification random_specification(DeterministicRandom& random) {
  Specification spec = bare_specification();
  spec.pressure_angle_rad = random.between(15.0, 27.0) * std::numbers::pi / 180.0;
  spec.rack.addendum = random.between(0.6, 2.2);
  spec.rack.dedendum = spec.rack.addendum + 0.25;
  spec.profile_shift = {.min = random.between(-1.0, 0.0), .max = random.between(0.2, 2.3)};
  if (random.uniform() < 0.7) {
    spec.ring_shift =
        NumberRange{.min = random.between(-3.0, 0.0), .max = random.between(0.5, 4.0)};
  }
  for (std::size_t gear = 0; gear < train::kGearCount; ++gear) {
    spec.tip_shortening[gear] = random.uniform() < 0.5 ? 0.0 : random.between(0.0, 0.4);
    spec.machining_allowance[gear] = random.uniform() < 0.5 ? 0.0 : random.between(0.0, 0.05);
  }
  if (random.uniform() < 0.7) spec.limits[CheckId::kContactRatioMin] = random.between(0.7, 1.3);
  if (random.uniform() < 0.6) spec.limits[CheckId::kContactRatioMax] = random.between(1.35, 3.5);
  if (random.uniform() < 0.6) spec.limits[CheckId::kInvoluteInterference] = 0.0;
  spec.friction.coefficient = random.between(0.02, 0.15);
  spec.friction.model = static_cast<LossModel>(random.index(4));
  if (spec.friction.model == LossModel::kDirectional) {
    spec.friction.approach_factor = random.between(0.5, 1.6);
    spec.friction.recess_factor = random.between(0.5, 1.6);
  }
  if (random.uniform() < 0.3) {
    spec.friction.extension.approach = random.between(0.6, 1.8);
    spec.friction.extension.recess = random.between(0.6, 1.8);
  }
  return spec;
}

train::ToothSet random_teeth(DeterministicRandom& random) {
  const auto integer = [&](int least, int most) {
    return least + static_cast<int>(random.index(static_cast<std::size_t>(most - least + 1)));
  };
  train::ToothSet z;
  z.S = integer(10, 34);
  z.P1 = integer(14, 60);
  z.R1 = z.S + 2 * z.P1 + integer(-4, 4);
  z.P2 = integer(14, 60);
  z.R2 = z.P2 + integer(12, 60);
  return z;
}

TEST(LeastMeshEfficiencies, HoldForGearsDrawnAtRandom) {
  std::array<int, train::kMeshCount> judged{};
  int farther = 0, known = 0, sets = 0;
  double nearest = 1e9;
  for (std::uint64_t seed = 1; seed <= sample(150U, 20'000U); ++seed) {
    DeterministicRandom random(seed);
    const Specification spec = random_specification(random);
    const train::ToothSet z = random_teeth(random);
    const auto bound = least_mesh_efficiencies(spec, z, 1);
    const auto reach = reach_of(spec, z);
    ++sets;
    known += *std::ranges::min_element(bound) > 0.0 ? 1 : 0;
    const NumberRange rings = spec.ring_shift.value_or(spec.profile_shift);
    const Maker maker(spec, z);
    const auto judge = [&](const Mesh& m, std::size_t mesh) {
      const double worst = worst_efficiency(m, spec, z, mesh);
      const double loss = 1.0 - worst;
      ++judged.at(mesh);
      farther += std::max(m.e1, m.e2) > m.e1 + m.e2 ? 1 : 0;
      if (bound.at(mesh) > 0.0) nearest = std::min(nearest, (1.0 - bound.at(mesh)) / loss);
      EXPECT_LE(bound.at(mesh), worst + kTruncation * loss)
          << "seed " << seed << " mesh " << mesh << " e1 " << m.e1 << " e2 " << m.e2;
      EXPECT_GE(reach.at(mesh).farthest, std::max(m.e1, m.e2)) << "seed " << seed;
      EXPECT_GE(reach.at(mesh).tan_alpha_w, m.tangent) << "seed " << seed;
    };
    for (int n = 0; n < 60; ++n) {
      const auto shift = [&](const NumberRange& range) {
        // Extremes more often.
        return std::clamp(
            random.between(1.2 * range.min - 0.2 * range.max, 1.2 * range.max - 0.2 * range.min),
            range.min, range.max);
      };
      Stage drawn{.sun_shift = shift(spec.profile_shift),
                  .planet_shift = shift(spec.profile_shift),
                  .ring_shift = shift(rings),
                  .sun_backlash = random.uniform() < 0.5 ? 0.0 : random.between(0.0, 0.2),
                  .ring_backlash = random.uniform() < 0.5 ? 0.0 : random.between(0.0, 0.2)};
      const auto second = maker.stage2(drawn);
      if (second && keeps_limits(second->ring, spec)) judge(second->ring, train::kMeshP2R2);
      const auto first = maker.stage1(drawn);
      if (!first || drawn.ring_shift < rings.min || drawn.ring_shift > rings.max) continue;
      if (!keeps_limits(*first->sun, spec) || !keeps_limits(first->ring, spec)) continue;
      judge(*first->sun, train::kMeshSP1);
      judge(first->ring, train::kMeshP1R1);
    }
  }
  for (const int count : judged) EXPECT_GT(count, 150);
  EXPECT_GT(farther, 100);
  EXPECT_GT(known, sets / 2);
  EXPECT_LT(nearest, 1.3);
}

TEST(LeastMeshEfficiencies, AreUnknownWhereFlanksMayJamOrThePressureAngleIsFree) {
  const train::ToothSet z{.S = 12, .P1 = 28, .R1 = 68, .P2 = 30, .R2 = 70};
  Specification spec = bare_specification();
  EXPECT_GT(least_mesh_efficiencies(spec, z, 1)[train::kMeshSP1], 0.5);
  spec.free.pressure_angle_rad = NumberRange{.min = 0.3, .max = 0.4};
  EXPECT_EQ(least_mesh_efficiencies(spec, z, 1)[train::kMeshSP1], 0.0);
  spec.free.pressure_angle_rad.reset();
  spec.friction.coefficient = 2.0;
  EXPECT_EQ(least_mesh_efficiencies(spec, z, 1)[train::kMeshSP1], 0.0);
}

}  // namespace
}  // namespace gear3k::optimize::energy_box_test
