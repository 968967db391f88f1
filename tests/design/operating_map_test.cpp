#include "design/operating_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace gear3k::design::operating_map_test {
namespace {

constexpr double kPi = std::numbers::pi;
/// A dozen roundings of quantities of order 1, and the last step of the friction iteration.
constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();

/// Zero shift at the reference centre distance of every mesh: always defined and in contact.
Design coaxial_design(const train::ToothSet& teeth) {
  Design d;
  d.name = "coaxial";
  const double module_m = 0.8e-3;
  d.train.teeth = teeth;
  d.train.planets = 3;
  d.train.pressure_angle_rad = kPi / 9.0;
  d.train.module_m = {module_m, module_m * (teeth.R1 - teeth.P1) / (teeth.R2 - teeth.P2)};
  d.train.center_distance_m = 0.5 * module_m * (teeth.R1 - teeth.P1);
  d.center_distance_given = true;
  d.map.sun_speed_rad_s = {.from = 20.0, .to = 100.0, .points = 5};
  d.map.output_torque_Nm = {.from = 5.0, .to = 50.0, .points = 4};
  return d;
}
/// G2 = 0.930, i = 121.
Design g2_below_one() { return coaxial_design({.S = 12, .P1 = 39, .R1 = 90, .P2 = 32, .R2 = 79}); }
/// G2 = 1.099, i = −75.
Design g2_above_one() { return coaxial_design({.S = 14, .P1 = 38, .R1 = 90, .P2 = 45, .R2 = 97}); }
/// G2 = 0.997, i = 2431: R2 cannot drive it at usual friction.
Design self_locking() { return coaxial_design({.S = 12, .P1 = 39, .R1 = 90, .P2 = 38, .R2 = 88}); }
std::vector<Design> both_signs() { return {g2_below_one(), g2_above_one()}; }

OperatingMap map_of(const Design& design) {
  auto result = make_operating_map(design);
  if (const auto* undefined = std::get_if<NotDefined>(&result)) {
    throw std::logic_error(undefined->message);
  }
  return std::get<OperatingMap>(std::move(result));
}
Evaluation evaluation_of(const Design& design) { return std::get<Evaluation>(evaluate(design)); }

/// Eqs. 18 (mended) and 19 of the low-backlash paper, and their counterparts for G2 > 1, typed
/// anew.
struct ClosedForm {
  double forward, backward;
};
ClosedForm closed_form(const Design& design) {
  const Evaluation e = evaluation_of(design);
  const double zS = e.teeth.S;
  const double g1 = e.teeth.R1 / zS;
  const double g2 = static_cast<double>(e.teeth.P2 * e.teeth.R1) / (e.teeth.P1 * e.teeth.R2);
  const auto f = [&](std::size_t k) { return e.meshes[k].efficiency_forward; };
  const auto b = [&](std::size_t k) { return e.meshes[k].efficiency_backward; };
  if (g2 < 1.0) {
    return {(1 + f(0) * f(1) * g1) * (1 - g2) / ((1 + g1) * (1 - f(1) * f(2) * g2)),
            b(0) * (1 + g1) * (b(1) * b(2) - g2) / (b(2) * (g1 + b(0) * b(1)) * (1 - g2))};
  }
  return {f(2) * (f(1) + f(0) * g1) * (g2 - 1) / ((1 + g1) * (g2 - f(1) * f(2))),
          b(0) * (1 + g1) * (b(1) * b(2) * g2 - 1) / ((b(0) + b(1) * g1) * (g2 - 1))};
}

TEST(OperatingMap, GridHoldsItsEndsAndIsOrderedBySpeedThenTorque) {
  const OperatingMap map = map_of(g2_below_one());
  EXPECT_EQ(map.sun_speed_rad_s, (std::vector<double>{20.0, 40.0, 60.0, 80.0, 100.0}));
  EXPECT_EQ(map.output_torque_Nm, (std::vector<double>{5.0, 20.0, 35.0, 50.0}));
  ASSERT_EQ(map.points.size(), 20U);
  EXPECT_EQ(map.running.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      EXPECT_EQ(map.points[4 * i + j].point.sun_speed_rad_s, map.sun_speed_rad_s[i]);
      EXPECT_EQ(map.points[4 * i + j].point.output_torque_Nm, map.output_torque_Nm[j]);
    }
  }
}

TEST(OperatingMap, ConstantFrictionWithoutDragIsTheClosedFormulasEverywhere) {
  for (const Design& design : both_signs()) {
    const OperatingMap map = map_of(design);
    const ClosedForm eta = closed_form(design);
    ASSERT_GT(eta.backward, 0.0);
    const double ratio = std::abs(map.ratio);
    // 1 − G2 and the like cancel: their rounding grows by as much.
    const double tolerance = kRounding * ratio;
    for (const MapPair& pair : map.points) {
      ASSERT_EQ(pair.forward.status, MapStatus::kRuns);
      ASSERT_EQ(pair.backward.status, MapStatus::kRuns);
      const double torque = pair.point.output_torque_Nm;
      EXPECT_NEAR(*pair.forward.operation->efficiency, eta.forward, tolerance);
      EXPECT_NEAR(*pair.backward.operation->efficiency, eta.backward, tolerance);
      EXPECT_NEAR(pair.forward.operation->sun_torque_Nm * ratio * eta.forward, torque,
                  torque * tolerance);
      EXPECT_NEAR(pair.backward.operation->sun_torque_Nm * ratio, torque * eta.backward,
                  torque * tolerance);
    }
  }
}

TEST(OperatingMap, ConstantDragOnTheSunAddsToItsTorqueAndNothingElse) {
  constexpr double kDrag_Nm = 0.011;
  for (Design design : both_signs()) {
    const OperatingMap plain = map_of(design);
    design.shafts.drag[kSunShaft].constant_Nm = kDrag_Nm;
    const OperatingMap dragged = map_of(design);
    for (std::size_t k = 0; k < plain.points.size(); ++k) {
      const auto& before = plain.points[k];
      const auto& after = dragged.points[k];
      EXPECT_NEAR(after.forward.operation->sun_torque_Nm,
                  before.forward.operation->sun_torque_Nm + kDrag_Nm, kRounding);
      EXPECT_NEAR(after.backward.operation->sun_torque_Nm,
                  before.backward.operation->sun_torque_Nm - kDrag_Nm, kRounding);
      for (std::size_t m = 0; m < train::kMeshCount; ++m) {
        EXPECT_NEAR(after.forward.operation->mesh[m].loss_W,
                    before.forward.operation->mesh[m].loss_W, 1e-9);
      }
    }
  }
}

TEST(OperatingMap, HeatIsInputMinusOutputPower) {
  for (Design design : both_signs()) {
    design.friction.law = efficiency::FrictionLaw::kStribeck;
    design.friction.coefficient = 0.05;
    design.friction.static_coefficient = 0.12;
    design.friction.stribeck_speed_m_s = 0.1;
    for (std::size_t shaft = 0; shaft < kShaftCount; ++shaft) {
      design.shafts.drag[shaft] = {
          .constant_Nm = 1e-3, .viscous_Nms = 2e-5, .quadratic_Nms2 = 1e-7};
    }
    design.shafts.planet_bearing_coefficient = 0.004;
    design.shafts.planet_bearing_radius_m = 3e-3;
    design.operating_point =
        OperatingPoint<double>{.sun_speed_rad_s = 50.0, .output_torque_Nm = 12.0};
    const OperatingMap map = map_of(design);
    std::vector<MapPair> pairs = map.points;
    pairs.push_back(map.reference);
    for (const MapPair& pair : pairs) {
      for (const MapPoint* point : {&pair.forward, &pair.backward}) {
        ASSERT_TRUE(point->operation.has_value());
        const auto& o = *point->operation;
        double heat = o.bearing_loss_W;
        for (const auto& mesh : o.mesh) heat += mesh.loss_W;
        for (const double loss : o.drag_loss_W) heat += loss;
        const double sun_W = o.sun_torque_Nm * pair.point.sun_speed_rad_s;
        const double output_W =
            pair.point.output_torque_Nm * pair.point.sun_speed_rad_s / std::abs(map.ratio);
        const double lost = point == &pair.forward ? sun_W - output_W : output_W - sun_W;
        EXPECT_NEAR(heat, lost, kRounding * std::abs(map.ratio) * o.input_power_W);
        EXPECT_GT(heat, 0.0);
        EXPECT_NEAR(o.loss_W, heat, kRounding * o.input_power_W);
      }
    }
  }
}

TEST(OperatingMap, UnloadedTorquesCarryTheDragsThroughTheTrain) {
  constexpr double kSun_Nm = 0.02;
  constexpr double kOutput_Nm = 0.4;
  constexpr double kViscous_Nms = 1e-4;
  for (Design design : both_signs()) {
    const ClosedForm eta = closed_form(design);
    design.shafts.drag[kSunShaft] = {
        .constant_Nm = kSun_Nm, .viscous_Nms = kViscous_Nms, .quadratic_Nms2 = 0.0};
    design.shafts.drag[kOutputShaft].constant_Nm = kOutput_Nm;
    const OperatingMap map = map_of(design);
    const double ratio = std::abs(map.ratio);
    const auto expect = [&](const UnloadedTorques& torques, double sun_speed_rad_s) {
      const double sun = kSun_Nm + kViscous_Nms * sun_speed_rad_s;
      ASSERT_TRUE(torques.sun.torque_Nm && torques.output.torque_Nm);
      EXPECT_NEAR(*torques.sun.torque_Nm, sun + kOutput_Nm / (ratio * eta.forward),
                  kRounding * ratio);
      EXPECT_NEAR(*torques.output.torque_Nm, kOutput_Nm + sun * ratio / eta.backward,
                  kRounding * ratio * ratio);
      EXPECT_EQ(torques.output.reason, "");
    };
    for (std::size_t i = 0; i < map.running.size(); ++i) {
      expect(map.running[i], map.sun_speed_rad_s[i]);
    }
    expect(map.breakaway, 0.0);
  }
}

TEST(OperatingMap, BreakawayHasStaticFriction) {
  Design design = g2_below_one();
  design.shafts.drag[kSunShaft].constant_Nm = 0.02;
  Design at_static = design;
  at_static.friction.coefficient = 0.15;
  design.friction.law = efficiency::FrictionLaw::kStribeck;
  design.friction.coefficient = 0.04;
  design.friction.static_coefficient = 0.15;
  design.friction.stribeck_speed_m_s = 1e-3;
  const OperatingMap map = map_of(design);
  const double ratio = std::abs(map.ratio);
  EXPECT_NEAR(*map.breakaway.output.torque_Nm, 0.02 * ratio / closed_form(at_static).backward,
              kRounding * ratio * ratio);
  EXPECT_LT(*map.running.back().output.torque_Nm, *map.breakaway.output.torque_Nm);
}

TEST(OperatingMap, ALawWithoutAValueAtRestGivesNoBreakawayButRunningTorques) {
  Design design = g2_below_one();
  design.shafts.drag[kSunShaft].constant_Nm = 0.02;
  design.masses.face_width_m = {8e-3, 8e-3};
  design.friction.law = efficiency::FrictionLaw::kSchlenk;
  design.friction.roughness_m = 0.8e-6;
  design.friction.lubricant_factor = 1.0;
  design.friction.lubricant = {
      .temperature_K = {313.15, 373.15}, .viscosity_m2_s = {220e-6, 19e-6}, .density_kgm3 = 890.0};
  design.operating_point =
      OperatingPoint<double>{.sun_speed_rad_s = 50.0, .output_torque_Nm = 12.0};
  const OperatingMap map = map_of(design);
  for (const MapTorque* torque : {&map.breakaway.sun, &map.breakaway.output}) {
    EXPECT_FALSE(torque->torque_Nm.has_value());
    EXPECT_EQ(torque->status, MapStatus::kNoFriction);
    EXPECT_EQ(torque->reason, "friction law schlenk has no value at rest");
  }
  for (const UnloadedTorques& running : map.running) {
    EXPECT_TRUE(running.sun.torque_Nm && running.output.torque_Nm);
  }
  // The law falls with speed and rises with load: so do the losses of the meshes.
  const auto margin = [&](std::size_t i, std::size_t j) {
    return *map.points[i * map.output_torque_Nm.size() + j].backward.backdriving_margin;
  };
  EXPECT_GT(margin(4, 0), margin(0, 0));
  EXPECT_GT(margin(0, 0), margin(0, 3));
  const auto least = least_margin(map);
  ASSERT_TRUE(least.has_value());
  EXPECT_EQ(*least->backward.backdriving_margin, margin(0, 3));
}

TEST(OperatingMap, ALawWithoutAValueWithoutLoadSaysSo) {
  Design design = g2_below_one();
  design.friction.law = efficiency::FrictionLaw::kLoadPower;
  design.friction.load_exponent = -0.2;
  design.friction.reference_force_N = 50.0;
  design.map.output_torque_Nm.from = 0.0;
  const OperatingMap map = map_of(design);
  EXPECT_EQ(map.running[0].sun.reason, "friction law load_power has no value without tooth load");
  EXPECT_EQ(map.points[0].forward.status, MapStatus::kNoFriction);
  EXPECT_FALSE(map.points[0].forward.operation.has_value());
  EXPECT_FALSE(map.points[0].backward.backdriving_margin.has_value());
  EXPECT_EQ(map.points[1].forward.status, MapStatus::kRuns);
}

TEST(OperatingMap, ASelfLockingTrainIsHelpedUnderLoadAndLocksWithAFreeSun) {
  Design design = self_locking();
  for (const double drag_Nm : {0.0, 0.01}) {
    design.shafts.drag[kSunShaft].constant_Nm = drag_Nm;
    const OperatingMap map = map_of(design);
    for (const MapPair& pair : map.points) {
      EXPECT_EQ(pair.forward.status, MapStatus::kRuns);
      EXPECT_EQ(pair.backward.status, MapStatus::kHelped);
      EXPECT_LT(pair.backward.operation->sun_torque_Nm, 0.0);
      EXPECT_LT(*pair.backward.backdriving_margin, 0.0);
    }
    for (const UnloadedTorques& running : map.running) {
      EXPECT_TRUE(running.sun.torque_Nm.has_value());
      EXPECT_FALSE(running.output.torque_Nm.has_value());
      EXPECT_EQ(running.output.status, MapStatus::kLocks);
      EXPECT_EQ(running.output.reason, "the train locks: R2 cannot drive the sun");
    }
    EXPECT_FALSE(map.breakaway.output.torque_Nm.has_value());
    EXPECT_EQ(map.notes.back(),
              "20 of 20 points turn backward only with torque on the sun along its rotation");
  }
}

TEST(OperatingMap, TheMarginIsPositiveWhereR2DrivesTheSunOfADragFreeTrain) {
  int driven = 0;
  int helped = 0;
  for (Design design : {g2_below_one(), g2_above_one(), self_locking()}) {
    design.map.sun_speed_rad_s.points = 1;
    design.map.output_torque_Nm.points = 1;
    for (int k = 1; k < 40; ++k) {
      design.friction.coefficient = 0.02 * k;
      const MapPoint point = map_of(design).points[0].backward;
      if (!point.operation || !point.backdriving_margin) continue;
      const bool drives = point.operation->sun_torque_Nm > 0.0;
      EXPECT_EQ(drives, *point.backdriving_margin > 0.0) << design.friction.coefficient;
      (drives ? driven : helped) += 1;
    }
  }
  EXPECT_GT(driven, 10);
  EXPECT_GT(helped, 10);
}

TEST(OperatingMap, MarginOfConstantFrictionIsThatOfTheEvaluation) {
  for (const Design& design : {g2_below_one(), g2_above_one(), self_locking()}) {
    const double margin = evaluation_of(design).efficiency.backdriving_margin;
    for (const MapPair& pair : map_of(design).points) {
      EXPECT_EQ(pair.backward.backdriving_margin, margin);
      EXPECT_FALSE(pair.forward.backdriving_margin.has_value());
    }
  }
}

TEST(OperatingMap, ReferenceIsTheOperatingPointElseTheMostPower) {
  Design design = g2_below_one();
  const OperatingMap without = map_of(design);
  EXPECT_FALSE(without.reference_given);
  EXPECT_EQ(without.reference.point.sun_speed_rad_s, 100.0);
  EXPECT_EQ(without.reference.point.output_torque_Nm, 50.0);
  EXPECT_EQ(without.temperature_K, 293.15);
  design.operating_point = OperatingPoint<double>{
      .sun_speed_rad_s = 33.0, .output_torque_Nm = 7.0, .temperature_K = 350.0};
  const OperatingMap with = map_of(design);
  EXPECT_TRUE(with.reference_given);
  EXPECT_EQ(with.reference.point.sun_speed_rad_s, 33.0);
  EXPECT_EQ(with.reference.point.output_torque_Nm, 7.0);
  EXPECT_EQ(with.temperature_K, 350.0);
  EXPECT_EQ(with.points[0].point.temperature_K, 350.0);
}

// Coaxial gears without shifts and thinning close at their distance; farther apart the rings'
// teeth run into those of the planets, and the sun's come free.
TEST(OperatingMap, NamesTheMeshesThatInterfereAsDrawn) {
  Design design = g2_below_one();
  const auto said = [&] {
    for (const std::string& note : map_of(design).notes) {
      if (note.starts_with("teeth interfere as drawn")) return note;
    }
    return std::string();
  };
  EXPECT_EQ(said(), "");
  design.train.center_distance_m += 0.1e-3;
  EXPECT_EQ(said().find("S-P1"), std::string::npos) << said();
  EXPECT_NE(said().find("normal backlash P1-R1 -"), std::string::npos) << said();
  EXPECT_NE(said().find(" um, P2-R2 -"), std::string::npos) << said();
}

TEST(OperatingMap, SaysWhichAxesOfItsGridNobodyStated) {
  Design design = g2_below_one();
  const auto said = [&] {
    for (const std::string& note : map_of(design).notes) {
      if (note.find("the default of the grid") != std::string::npos) return note;
    }
    return std::string();
  };
  design.map = {.sun_speed_rad_s = {.from = 20.0, .to = 100.0, .points = 3},
                .output_torque_Nm = {.from = 4.0, .to = 40.0, .points = 3}};
  EXPECT_EQ(said(), "");
  design.map.output_torque_Nm = MapGrid{}.output_torque_Nm;
  EXPECT_EQ(said(),
            "5 to 50 N m at R2: the default of the grid, the range of the low-backlash paper's "
            "experiment; that of the design's own duty is stated by map.output_torque_nm");
  design.map.sun_speed_rad_s = MapGrid{}.sun_speed_rad_s;
  EXPECT_TRUE(said().starts_with("200 to 1000 rpm of the sun and 5 to 50 N m at R2: ")) << said();
  design.operating_point = OperatingPoint<double>{
      .sun_speed_rad_s = 60.0, .output_torque_Nm = 20.0, .temperature_K = 293.15};
  EXPECT_EQ(said(), "") << "where it lies is told instead";
}

TEST(OperatingMap, SaysWhereTheOperatingPointLiesOutsideIt) {
  Design design = g2_below_one();  // its map: 20 to 100 rad/s and 5 to 50 N m
  const auto says = [&](double speed_rad_s, double torque_Nm) {
    design.operating_point = OperatingPoint<double>{
        .sun_speed_rad_s = speed_rad_s, .output_torque_Nm = torque_Nm, .temperature_K = 293.15};
    return std::ranges::any_of(map_of(design).notes, [](const std::string& note) {
      return note.find("outside the map") != std::string::npos;
    });
  };
  EXPECT_FALSE(says(60.0, 20.0));
  EXPECT_FALSE(says(60.0, 50.0));
  EXPECT_TRUE(says(101.0, 20.0));
  EXPECT_TRUE(says(19.0, 20.0));
  EXPECT_TRUE(says(60.0, 51.0));
  EXPECT_TRUE(says(60.0, 4.0));
}

TEST(OperatingMap, AnUndefinedGeometryIsSaidAsByEvaluate) {
  Design design = g2_below_one();
  design.train.center_distance_m *= 0.9;
  const auto map = make_operating_map(design);
  const auto evaluation = evaluate(design);
  ASSERT_TRUE(std::holds_alternative<NotDefined>(map));
  EXPECT_EQ(std::get<NotDefined>(map).message, std::get<NotDefined>(evaluation).message);
}

TEST(OperatingMap, AMeshWithoutContactIsNamed) {
  Design design = g2_below_one();
  design.train.tip_shortening[train::kS] = 1.5;
  design.train.tip_shortening[train::kP1] = 1.5;
  const auto map = make_operating_map(design);
  ASSERT_TRUE(std::holds_alternative<NotDefined>(map));
  EXPECT_NE(std::get<NotDefined>(map).message.find("S-P1 has no contact"), std::string::npos);
}

TEST(OperatingMap, AnAxisWithoutPointsIsRefused) {
  Design design = g2_below_one();
  design.map.sun_speed_rad_s.points = 0;
  EXPECT_THROW(make_operating_map(design), std::invalid_argument);
}

TEST(OperatingMap, PlanetBearingsThatLockTheTrainAreToldWithAndWithoutDrag) {
  for (const double drag_Nm : {0.0, 1e-3}) {
    Design d = g2_below_one();
    d.friction.coefficient = 0.05;
    d.shafts.drag[kSunShaft].constant_Nm = drag_Nm;
    const OperatingMap free = map_of(d);
    d.shafts.planet_bearing_coefficient = 1.0;
    d.shafts.planet_bearing_radius_m = 8e-3;
    const OperatingMap locked = map_of(d);
    for (std::size_t k = 0; k < free.points.size(); ++k) {
      EXPECT_GT(locked.points[k].backward.backdriving_margin.value(), 0.0) << "meshes alone";
      EXPECT_TRUE(free.points[k].backward.drives_sun);
      EXPECT_FALSE(locked.points[k].backward.drives_sun);
      EXPECT_EQ(locked.points[k].backward.status, MapStatus::kHelped);
    }
    EXPECT_EQ(free.breakaway.output.status, MapStatus::kRuns);
    EXPECT_EQ(locked.breakaway.output.status, MapStatus::kLocks);
    EXPECT_EQ(locked.running.front().output.status, MapStatus::kLocks);
  }
}

}  // namespace
}  // namespace gear3k::design::operating_map_test
