#include "backlash/turn.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "backlash/lost_motion.hpp"
#include "tests/backlash/built_gearbox.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::backlash::turn_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Teeth rolled off with the carrier held: of the sun as many that a whole number of everything
/// follows; then all turns back with R1.
struct Rolled {
  GearAngles revolutions{};  ///< against the carrier
  double output = 0.0;       ///< absolute
};
Rolled rolled(const train::ToothSet& z, double planet_revolutions) {
  const double stage1 = planet_revolutions * z.P1;
  const double stage2 = planet_revolutions * z.P2;
  Rolled r{.revolutions = {-stage1 / z.S, planet_revolutions, stage1 / z.R1, planet_revolutions,
                           stage2 / z.R2}};
  r.output = r.revolutions[train::kR2] - r.revolutions[train::kR1];
  return r;
}

std::vector<DeviationValue> random_values(RandomSubject& random, const ClearanceModel& model) {
  std::vector<DeviationValue> values;
  values.reserve(model.deviations.size());
  for (const Deviation& d : model.deviations) {
    values.push_back(model.sources[d.source].kind == ToleranceKind::kSinglePitch
                         ? DeviationValue{}
                         : random.value(model, d));
  }
  return values;
}

ToothErrors random_errors(RandomSubject& random, const train::ToothSet& z, int planets) {
  ToothErrors errors;
  for (int gear = 0; gear < train::kGearCount; ++gear) {
    auto& list = errors.flank_m[static_cast<std::size_t>(gear)];
    list.resize(flank_count(z, gear, planets));
    for (double& error : list) error = random.between(-5e-6, 5e-6);
  }
  return errors;
}

double greatest_difference(const std::vector<PlanetPlay>& a, const std::vector<PlanetPlay>& b) {
  double greatest = 0.0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      greatest = std::max({greatest, std::abs(a[p][k].lower_m - b[p][k].lower_m),
                           std::abs(a[p][k].upper_m - b[p][k].upper_m)});
    }
  }
  return greatest;
}

TEST(TurningPlays, AreThoseOfTheDisplacedGearsAtEveryAngle) {
  RandomSubject random(91);
  LargestDeviation largest;
  for (int i = 0; i < 100; ++i) {
    const Subject subject = random.subject();
    const Tolerances tolerances = random.tolerances();
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const auto t = at_middle(subject, tolerances);
    const auto values = random_values(random, *model);
    const TurningPlays plays(*model, t.teeth, values);
    for (int k = 0; k < 10; ++k) {
      const Rolled r = rolled(t.teeth, random.between(-20.0, 20.0));
      GearAngles turned{};
      for (std::size_t g = 0; g < turned.size(); ++g) turned[g] = 2.0 * kPi * r.revolutions[g];
      const auto exact = built_plays(t, tolerances, *model, values, turned);
      const double steepest =
          std::ranges::min(t.meshes, {}, [](const auto& m) { return m.alpha_w_rad; }).alpha_w_rad;
      // Second order of 20 + 10 + 10 + 10 µm.
      const double allowed =
          0.75 * 50e-6 * 50e-6 / (t.center_distance_m * std::sin(steepest)) + 1e-12;
      largest.see(i, greatest_difference(plays.at(r.output), exact), allowed);
    }
  }
  largest.expect_allowed("bound");
}

TEST(TurningPlays, ErrorsOfAllTeethOnASineAreACumulativePitchDeviation) {
  // Tooth by tooth the same displacement, but in steps of a tooth and with the tooth that touches
  // up to a pitch off the line of centres.
  train::TrainParameters<double> p{};
  p.teeth = {.S = 61, .P1 = 120, .R1 = 301, .P2 = 110, .R2 = 290};
  p.planets = 3;
  p.pressure_angle_rad = kPi / 9.0;
  p.module_m = {0.2e-3, 0.2e-3 * 181.0 / 180.0};
  p.center_distance_m = 18.3e-3;
  for (int gear = 0; gear < train::kGearCount; ++gear) {
    const bool on_planet = gear == train::kP1 || gear == train::kP2;
    Tolerances tolerances;
    tolerances.gears[static_cast<std::size_t>(gear)].cumulative_pitch_m = 40e-6;
    tolerances.gears[static_cast<std::size_t>(gear)].single_pitch_m = 20e-6;
    const auto model = clearance_model(p, tolerances);
    ASSERT_TRUE(model);
    const int teeth = train::teeth_of(p.teeth)[static_cast<std::size_t>(gear)];
    ToothErrors errors;
    auto& list = errors.flank_m[static_cast<std::size_t>(gear)];
    list.resize(flank_count(p.teeth, gear, p.planets));
    std::vector<DeviationValue> values(model->deviations.size());
    const std::vector<DeviationValue> none = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Deviation& d = model->deviations[i];
      if (!d.planar) continue;
      const double phase = 1.0 + static_cast<double>(i);
      values[i] = {.x_m = 20e-6 * std::cos(phase), .y_m = 20e-6 * std::sin(phase)};
      for (int tooth = 0; tooth < teeth; ++tooth) {
        for (const bool upper : {false, true}) {
          list[flank_place(teeth, on_planet ? d.planet : 0, tooth, upper)] =
              20e-6 * std::cos(2.0 * kPi * tooth / teeth - phase);
        }
      }
    }
    const TurningPlays smooth(*model, p.teeth, values);
    const TurningPlays stepped(*model, p.teeth, none, errors);
    double greatest = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const double at = 1.3 * k / 2000.0;
      greatest = std::max(greatest, greatest_difference(smooth.at(at), stepped.at(at)));
    }
    EXPECT_LT(greatest, 20e-6 * 2.0 * kPi / teeth * 1.3)
        << train::kGearNames[static_cast<std::size_t>(gear)];
    EXPECT_GT(greatest, 0.0);
  }
}

TEST(TurningPlays, TeethOfAPairChangeTogetherOncePerPitch) {
  RandomSubject random(92);
  for (int i = 0; i < 20; ++i) {
    const Subject subject = random.subject();
    const auto& z = subject.parameters.teeth;
    const int planets = subject.parameters.planets;
    Tolerances tolerances;
    for (auto& g : tolerances.gears) g.single_pitch_m = 5e-6;
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const std::vector<DeviationValue> values(model->deviations.size());
    const TurningPlays plays(*model, z, values, random_errors(random, z, planets));
    // Over a revolution of a planet against the carrier zP1 and zP2 teeth pass.
    const double turn_of_planet = std::abs(rolled(z, 1.0).output);
    constexpr int kSteps = 20000;
    for (std::size_t k = 0; k < train::kMeshCount; ++k) {
      const int passing = k == train::kMeshP2R2 ? z.P2 : z.P1;
      int changes = 0;
      double before = plays.at(0.0).back()[k].upper_m;
      for (int s = 1; s <= kSteps; ++s) {
        const double now = plays.at(turn_of_planet * s / kSteps).back()[k].upper_m;
        // A step of both gears at once: of one after the other there were twice as many.
        changes += std::abs(now - before) > 1e-15 ? 1 : 0;
        before = now;
      }
      EXPECT_NEAR(changes, passing, 1);
    }
  }
}

TEST(TurningPlays, RepeatAfterThePeriodAndTheTeethsHunting) {
  RandomSubject random(93);
  for (int i = 0; i < 50; ++i) {
    const Subject subject = random.subject();
    const Tolerances tolerances = random.tolerances();
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const auto& z = subject.parameters.teeth;
    const TurningPlays plays(*model, z, random_values(random, *model),
                             random_errors(random, z, model->planets));
    const auto period = static_cast<double>(turn_period(z));
    for (int k = 0; k < 20; ++k) {
      const double at = random.between(0.0, 1.0);
      EXPECT_LT(greatest_difference(plays.at(at), plays.at(at + period)), 1e-11);
    }
  }
}

TEST(TurnPeriod, IsTheLeastNumberOfRevolutionsThatAllBodiesCloseIn) {
  RandomSubject random(94);
  for (int i = 0; i < 200; ++i) {
    const auto z = random.teeth(i % 2 == 0);
    const long long period = turn_period(z);
    // Counted: planets' revolutions in parts that bring every gear's teeth onto each other.
    const auto closes = [&](long long revolutions) {
      // output = q (zP2/zR2 − zP1/zR1) for q revolutions of a planet.
      const long double q =
          static_cast<long double>(revolutions) /
          (static_cast<long double>(z.P2) / z.R2 - static_cast<long double>(z.P1) / z.R1);
      const auto whole = [](long double x) { return std::abs(x - std::round(x)) < 1e-7L; };
      return whole(q) && whole(q * z.P1 / z.S) && whole(q * z.P1 / z.R1) && whole(q * z.P2 / z.R2);
    };
    EXPECT_TRUE(closes(period));
    for (long long n = 1; n < std::min(period, 3000LL); ++n) ASSERT_FALSE(closes(n)) << n;
  }
}

/// The subject with another backlash in every mesh, by the allowances of its central gears.
void set_backlash(Subject& subject, double j_m) {
  const auto j = normal_backlashes(subject.geometry);
  constexpr std::array<std::size_t, 3> kCentral{train::kS, train::kR1, train::kR2};
  for (std::size_t k = 0; k < 3; ++k) {
    subject.parameters.machining_allowance[kCentral[k]] +=
        (j_m - j[k]) / subject.parameters.module_m[k == train::kMeshP2R2 ? 1 : 0];
  }
  subject.geometry = *make_train_geometry(subject.parameters);
}

/// A gearbox with eccentricity of one gear.
struct Eccentric {
  train::TrainParameters<double> parameters;
  train::TrainGeometry<double> geometry;
  Turn result;
};
constexpr double kEccentricity = 15e-6;
Eccentric eccentric(RandomSubject& random, int gear, int planets) {
  Subject subject = random.subject();
  subject.parameters.planets = planets;
  set_backlash(subject, 80e-6);
  Tolerances tolerances;
  tolerances.gears[static_cast<std::size_t>(gear)].runout_m = 2.0 * kEccentricity;
  const auto model = clearance_model(subject.parameters, tolerances);
  std::vector<DeviationValue> values(model->deviations.size(), {.x_m = kEccentricity});
  TurnWindow window = turn_window(subject.parameters.teeth);
  window.samples = 4000;
  return {.parameters = subject.parameters,
          .geometry = *make_train_geometry(subject.parameters),
          .result =
              turn(model->levers, TurningPlays(*model, subject.parameters.teeth, values), window)};
}

TEST(Turn, OfOnePlanetSwingsByTheEccentricityOverTheLever) {
  // Sun, R1, R2, P2: lost motion swings with e sin α_w each side, the error with e along the line
  // of action.
  RandomSubject random(95);
  for (int i = 0; i < 40; ++i) {
    for (const int gear : {train::kS, train::kR1, train::kR2, train::kP2}) {
      const Eccentric box = eccentric(random, gear, 1);
      const auto& t = box.geometry;
      const std::size_t mesh = gear == train::kS    ? train::kMeshSP1
                               : gear == train::kR1 ? train::kMeshP1R1
                                                    : train::kMeshP2R2;
      const double g1 = static_cast<double>(t.teeth.R1) / t.teeth.S;
      const double g2 = static_cast<double>(t.teeth.P2) * t.teeth.R1 /
                        (static_cast<double>(t.teeth.P1) * t.teeth.R2);
      const double lever =
          gear == train::kS ? std::abs((1.0 + g1) / (1.0 - g2)) * t.gears[train::kS].base_radius_m
          : gear == train::kR1 ? (1.0 + g1) / (g1 + g2) * t.gears[train::kR1].base_radius_m
                               : t.gears[train::kR2].base_radius_m;
      double least = 1.0, most = -1.0, low = 1.0, high = -1.0;
      for (const TurnPoint& point : box.result.points) {
        least = std::min(least, point.lost_motion_rad());
        most = std::max(most, point.lost_motion_rad());
        low = std::min(low, box.result.error_forward_rad(point));
        high = std::max(high, box.result.error_forward_rad(point));
      }
      const double swing = 2.0 * kEccentricity / lever;
      // Samples may miss the extremes.
      EXPECT_NEAR(high - low, swing, 2e-2 * swing);
      EXPECT_NEAR(most - least, 2.0 * swing * std::sin(t.meshes[mesh].alpha_w_rad), 2e-2 * swing);
      EXPECT_NEAR(0.5 * (most + least),
                  output_lost_motion(t, normal_backlashes(t), LostMotionModel::kKinematic),
                  2e-2 * swing);
      EXPECT_FALSE(box.result.jams());
    }
  }
}

TEST(Turn, OfSeveralAlikePlanetsLosesLostMotionToEccentricity) {
  RandomSubject random(96);
  for (int i = 0; i < 40; ++i) {
    const int gear = random.count(0, 1) == 1 ? train::kS : train::kR2;
    const Eccentric box = eccentric(random, gear, random.count(3, 5));
    const double drawn = output_lost_motion(box.geometry, normal_backlashes(box.geometry),
                                            LostMotionModel::kKinematic);
    for (const TurnPoint& point : box.result.points) {
      EXPECT_LE(point.lost_motion_rad(), drawn * (1.0 + 1e-12));
    }
  }
}

TEST(Turn, SaysWhereAndByHowMuchItJams) {
  RandomSubject random(97);
  int some = 0;
  for (int i = 0; i < 60; ++i) {
    Subject subject = random.subject();
    subject.parameters.planets = 3;
    set_backlash(subject, 60e-6);
    Tolerances tolerances;
    for (auto& g : tolerances.gears) g.runout_m = random.between(20e-6, 90e-6);
    const auto model = clearance_model(subject.parameters, tolerances);
    ASSERT_TRUE(model);
    const TurningPlays plays(*model, subject.parameters.teeth, random_values(random, *model));
    const auto result = turn(model->levers, plays, {.revolutions = 1.0, .samples = 500});
    std::size_t jammed = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const TurnPoint& point : result.points) {
      const auto range = output_range(model->levers, plays.at(point.angle_rad / (2.0 * kPi)));
      jammed += range.margin_m < 0.0 ? 1U : 0U;
      least = std::min(least, range.margin_m);
    }
    EXPECT_EQ(result.jammed, jammed);
    EXPECT_NEAR(result.least_margin_m, least, 1e-15);
    EXPECT_NEAR(
        output_range(model->levers, plays.at(result.least_margin_angle_rad / (2.0 * kPi))).margin_m,
        least, 1e-15);
    some += jammed > 0 && jammed < result.points.size() ? 1 : 0;
  }
  EXPECT_GT(some, 3);
}

TEST(TurnWindow, HasEightSamplesPerToothOfTheFasterStage) {
  for (const train::ToothSet& z :
       {train::ToothSet{.S = 14, .P1 = 40, .R1 = 94, .P2 = 36, .R2 = 92},
        train::ToothSet{.S = 18, .P1 = 30, .R1 = 78, .P2 = 36, .R2 = 84}}) {
    const TurnWindow window = turn_window(z);
    const Rolled r = rolled(z, 1.0);
    const double teeth =
        std::max(z.P1, z.P2) * window.revolutions / std::abs(r.output);  // that pass
    EXPECT_GE(static_cast<double>(window.samples), 8.0 * teeth * (1.0 - 1e-12));
    EXPECT_LE(static_cast<double>(window.samples), 8.0 * teeth + 1.0);
  }
}

TEST(Turn, RefusesWhatHasNoMeaning) {
  RandomSubject random(98);
  const Subject subject = random.subject();
  const auto& z = subject.parameters.teeth;
  const auto model = clearance_model(subject.parameters, {});
  ASSERT_TRUE(model);
  EXPECT_THROW(TurningPlays(*model, z, std::vector<DeviationValue>(1)), std::invalid_argument);
  ToothErrors errors;
  errors.flank_m[train::kS].resize(3);
  EXPECT_THROW(TurningPlays(*model, z, {}, errors), std::invalid_argument);
  const TurningPlays plays(*model, z, {});
  EXPECT_THROW(turn(model->levers, plays, {.revolutions = 0.0, .samples = 5}),
               std::invalid_argument);
  EXPECT_THROW(turn(model->levers, plays, {.revolutions = 1.0, .samples = 0}),
               std::invalid_argument);
  EXPECT_THROW(turn_window(z, 7), std::invalid_argument);
  EXPECT_THROW(turn_period({.S = 20, .P1 = 20, .R1 = 60, .P2 = 20, .R2 = 60}),
               std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::backlash::turn_test
