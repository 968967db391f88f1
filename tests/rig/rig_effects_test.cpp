// Each cause does what it says, and the data are what the interface's layout asks for.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/rig/rig.hpp"
#include "tests/rig/rig_mesh.hpp"

namespace gear3k::rig::rig_effects_test {
namespace {

HiddenCause cause(const std::string& id, const std::string& variant, double amplitude) {
  return {.id = id, .variant = variant, .amplitude = amplitude, .phase_rad = 0.3};
}

std::vector<std::vector<std::string>> fields(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream text(csv);
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with('#')) continue;
    std::vector<std::string> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    rows.push_back(row);
  }
  return rows;
}

Plan plan_of(Kind kind) {
  switch (kind) {
    case Kind::lost_motion:
      return lost_motion_plan();
    case Kind::pair_loss:
      return pair_loss_plan();
    case Kind::torque_angle: {
      Plan plan = torque_angle_plan();
      plan.sessions = 2;
      return plan;
    }
    default:
      return transmission_plan();
  }
}

using Case = std::tuple<Kind, const char*, const char*>;
class EveryCause : public testing::TestWithParam<Case> {};

TEST_P(EveryCause, ChangesTheRowsAsMuchAsAsked) {
  const auto& [kind, id, variant] = GetParam();
  for (const Gearbox& gearbox : {bilateral_drive_gear(), reversing_gear()}) {
    const Plan plan = plan_of(kind);
    for (const double rms : {0.3, 1.0, 3.0}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const Dataset without = measure(gearbox, plan, {}, seed);
        const Dataset with =
            measure(gearbox, plan, {{.id = id, .variant = variant, .rms_in_noise = rms}}, seed);
        ASSERT_EQ(with.clean.size(), without.clean.size());
        double sum = 0.0;
        for (std::size_t i = 0; i < with.clean.size(); ++i) {
          sum += std::pow((with.clean[i] - without.clean[i]) / without.noise_sd, 2);
        }
        const double found = std::sqrt(sum / static_cast<double>(with.clean.size()));
        EXPECT_NEAR(found, rms, 1e-8) << gearbox.name;
        // The noise does not depend on what is hidden.
        for (std::size_t i = 0; i < with.clean.size(); ++i) {
          EXPECT_NEAR(with.measured[i] - with.clean[i], without.measured[i] - without.clean[i],
                      1e-12 * (1.0 + std::fabs(with.measured[i])));
        }
        ASSERT_EQ(with.truth.size(), 1U);
        EXPECT_EQ(with.truth[0].id, id);
        EXPECT_FALSE(with.truth[0].parameters.empty());
        ASSERT_EQ(with.causes.size(), 1U);
        ASSERT_TRUE(with.causes[0].amplitude.has_value());
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Transmission, EveryCause,
    testing::Values(
        Case{Kind::transmission, "friction_level", ""},
        Case{Kind::transmission, "friction_load", ""},
        Case{Kind::transmission, "friction_speed", ""},
        Case{Kind::transmission, "friction_temperature", ""},
        Case{Kind::transmission, "friction_direction", "approach_recess"},
        Case{Kind::transmission, "friction_direction", "drive"},
        Case{Kind::transmission, "drag_constant", "sun"},
        Case{Kind::transmission, "drag_constant", "output"},
        Case{Kind::transmission, "drag_viscous", ""},
        Case{Kind::transmission, "drag_quadratic", ""},
        Case{Kind::transmission, "bearing_load", "pins"},
        Case{Kind::transmission, "bearing_load", "output"},
        Case{Kind::transmission, "sensor_gain", ""}, Case{Kind::transmission, "sensor_offset", ""},
        Case{Kind::transmission, "run_step", "shift"},
        Case{Kind::transmission, "run_step", "sensor"}, Case{Kind::transmission, "drift", "linear"},
        Case{Kind::transmission, "drift", "saturating"},
        Case{Kind::transmission, "drift", "friction"}, Case{Kind::transmission, "runout", "sun"},
        Case{Kind::transmission, "runout", "planet"}, Case{Kind::transmission, "runout", "carrier"},
        Case{Kind::transmission, "runout", "sun_absolute"},
        Case{Kind::transmission, "runout", "planet_absolute"},
        Case{Kind::transmission, "mesh_order", "stage1"},
        Case{Kind::transmission, "mesh_order", "stage2"}, Case{Kind::transmission, "odd_order", ""},
        Case{Kind::transmission, "resonance", ""}, Case{Kind::transmission, "rotation_load", ""},
        Case{Kind::transmission, "time_oscillation", ""}, Case{Kind::transmission, "corner", ""}));
INSTANTIATE_TEST_SUITE_P(
    OtherKinds, EveryCause,
    testing::Values(
        Case{Kind::lost_motion, "run_step", ""}, Case{Kind::lost_motion, "drift", "linear"},
        Case{Kind::lost_motion, "drift", "saturating"}, Case{Kind::lost_motion, "runout", "sun"},
        Case{Kind::lost_motion, "runout", "planet"}, Case{Kind::lost_motion, "runout", "carrier"},
        Case{Kind::lost_motion, "mesh_order", "stage1"}, Case{Kind::lost_motion, "clearance", ""},
        Case{Kind::lost_motion, "compliance", ""}, Case{Kind::lost_motion, "thermal_expansion", ""},
        Case{Kind::lost_motion, "odd_order", ""}, Case{Kind::lost_motion, "time_oscillation", ""},
        Case{Kind::torque_angle, "clearance", ""}, Case{Kind::torque_angle, "compliance", ""},
        Case{Kind::torque_angle, "drift", "linear"}, Case{Kind::torque_angle, "run_step", ""},
        Case{Kind::pair_loss, "friction_level", ""},
        Case{Kind::pair_loss, "friction_direction", ""}, Case{Kind::pair_loss, "bearing_load", ""},
        Case{Kind::pair_loss, "sensor_gain", ""}, Case{Kind::pair_loss, "run_step", ""}));

class Operating : public testing::Test {
 protected:
  static double torque(const Condition& at, const std::vector<HiddenCause>& causes = {}) {
    return sun_torque(gearbox(), at, causes);
  }
  static const Gearbox& gearbox() {
    static const Gearbox kGearbox = bilateral_drive_gear();
    return kGearbox;
  }
  static constexpr double kRounding = 1e-14;
  const Condition forward_{.forward = true}, backward_{.forward = false};
};

TEST_F(Operating, NoFrictionLeavesTheRatio) {
  for (const Gearbox& any : {bilateral_drive_gear(), low_backlash_gear(), reversing_gear()}) {
    const auto& z = any.teeth;
    const double g1 = static_cast<double>(z[2]) / z[0];
    const double g2 = static_cast<double>(z[3]) * z[2] / (static_cast<double>(z[1]) * z[4]);
    const double lossless = 20.0 * std::fabs((1.0 - g2) / (1.0 + g1));
    for (const Condition& at : {forward_, backward_}) {
      EXPECT_NEAR(sun_torque(any, at, {cause("friction_level", "", -1.0)}), lossless,
                  1e-12 * lossless);
    }
  }
}

TEST_F(Operating, LossesOnTheSunAddForwardAndTakeAwayBackward) {
  const double speed = 600.0 * std::numbers::pi / 30.0;
  for (const auto& [hidden, drag] :
       {std::pair{cause("drag_constant", "", 0.01), 0.01},
        std::pair{cause("drag_viscous", "", 1e-4), 1e-4 * speed},
        std::pair{cause("drag_quadratic", "", 1e-6), 1e-6 * speed * speed}}) {
    for (const int rotation : {1, -1}) {
      Condition f = forward_, b = backward_;
      f.rotation = b.rotation = rotation;
      EXPECT_NEAR(torque(f, {hidden}) - torque(f), drag, kRounding);
      EXPECT_NEAR(torque(b, {hidden}) - torque(b), -drag, kRounding);
    }
  }
}

TEST_F(Operating, SensorOffsetFollowsRotationAndDirection) {
  for (const int rotation : {1, -1}) {
    Condition f = forward_, b = backward_;
    f.rotation = b.rotation = rotation;
    const HiddenCause hidden = cause("sensor_offset", "", 0.01);
    EXPECT_NEAR(torque(f, {hidden}) - torque(f), 0.01 * rotation, kRounding);
    EXPECT_NEAR(torque(b, {hidden}) - torque(b), -0.01 * rotation, kRounding);
    const HiddenCause step = cause("run_step", "sensor", 0.01);
    EXPECT_NEAR(torque(f, {step}) - torque(f), 0.01 * rotation, kRounding);
    EXPECT_NEAR(torque(b, {step}) - torque(b), -0.01 * rotation, kRounding);
  }
}

TEST_F(Operating, FrictionOfADirectionIsALevelInEachDirection) {
  const double s = 0.2;
  EXPECT_NEAR(torque(forward_, {cause("friction_direction", "drive", s)}),
              torque(forward_, {cause("friction_level", "", s)}), kRounding);
  EXPECT_NEAR(torque(backward_, {cause("friction_direction", "drive", s)}),
              torque(backward_, {cause("friction_level", "", -s)}), kRounding);
}

TEST_F(Operating, ReversingAPairSwapsApproachAndRecess) {
  const Condition down{.driving_teeth = 20, .driven_teeth = 80};
  const Condition up{.driving_teeth = 80, .driven_teeth = 20};
  const HiddenCause more = cause("friction_direction", "", 0.3);
  const HiddenCause less = cause("friction_direction", "", -0.3);
  EXPECT_NEAR(pair_loss(gearbox(), 1.0, down, {more}), pair_loss(gearbox(), 1.0, up, {less}),
              kRounding);
  EXPECT_GT(
      std::fabs(pair_loss(gearbox(), 1.0, down, {more}) - pair_loss(gearbox(), 1.0, down, {less})),
      1e-4);
  const double both =
      0.5 * (pair_loss(gearbox(), 1.0, down, {more}) + pair_loss(gearbox(), 1.0, up, {more}));
  EXPECT_NEAR(both, pair_loss(gearbox(), 1.0, down), kRounding);
}

TEST_F(Operating, TemperatureLeavesFrictionAtItsReference) {
  const HiddenCause thinner = cause("friction_temperature", "", 0.2);
  Condition at = forward_;
  EXPECT_NEAR(torque(at, {thinner}), torque(at), kRounding);
  at.temperature_c = 45.0;  // thinner oil, and friction goes with viscosity
  EXPECT_LT(torque(at, {thinner}), torque(at));
}

TEST_F(Operating, FrictionFallsWithSpeedAndRisesWithLoadAsStated) {
  const auto loss = [&](const Condition& at, const HiddenCause& hidden) {
    const double ideal = torque(at, {cause("friction_level", "", -1.0)});
    return torque(at, {hidden}) / ideal - 1.0;
  };
  Condition slow = forward_, fast = forward_;
  slow.sun_speed_rpm = 200.0;
  fast.sun_speed_rpm = 1000.0;
  const HiddenCause stribeck = cause("friction_speed", "", 1.0);
  const HiddenCause plain_level = cause("friction_level", "", 0.0);
  const double more_slow = loss(slow, stribeck) - loss(slow, plain_level);
  const double more_fast = loss(fast, stribeck) - loss(fast, plain_level);
  // The ring meshes, near the law's own speed, have (1 + 2.5^2)/(1 + 0.5^2) = 5.8 between them.
  EXPECT_GT(more_fast, 0.0);
  EXPECT_GT(more_slow, 3.0 * more_fast);
  EXPECT_LT(more_slow, 8.0 * more_fast);

  Condition light = forward_, heavy = forward_;
  light.output_torque_Nm = 5.0;
  heavy.output_torque_Nm = 50.0;
  const HiddenCause rising = cause("friction_load", "", 0.1);
  const double plain = loss(light, cause("friction_level", "", 0.0));
  EXPECT_LT(loss(light, rising), plain);
  EXPECT_GT(loss(heavy, rising), plain);
  // Lossless forces scale with the load and the loss is nearly proportional to friction.
  EXPECT_NEAR(loss(heavy, rising) / loss(light, rising), std::pow(10.0, 0.1), 0.03);
}

TEST_F(Operating, BearingsLoseInBothDirectionsInProportionToLoad) {
  for (const char* variant : {"pins", "output"}) {
    const HiddenCause bearing = cause("bearing_load", variant, 0.01);
    Condition light = forward_;
    light.output_torque_Nm = 5.0;
    const double more = torque(forward_, {bearing}) / torque(forward_) - 1.0;
    EXPECT_GT(more, 1e-4);
    EXPECT_NEAR(torque(light, {bearing}) / torque(light) - 1.0, more, 1e-12);
    EXPECT_LT(torque(backward_, {bearing}), torque(backward_));
  }
}

// Power into the train less power out of it is what the pins turn into heat, when friction in the
// meshes is zero: f r |force| times the planets' speed, with the force known without losses.
TEST_F(Operating, HeatOfThePinsClosesThePowerBalance) {
  const double friction = 1e-5;
  const HiddenCause none = cause("friction_level", "", -1.0);
  const double more =
      torque(forward_, {none, cause("bearing_load", "pins", friction)}) - torque(forward_, {none});
  const Train train = make_train(gearbox());
  // Planets pushed by sun and rings: tangential forces add to zero on a free carrier, radial
  // parts are outwards in S-P1 and inwards on both rings.
  double radial = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    radial += (k == 0 ? 1.0 : -1.0) * 20.0 * train.force_per_Nm[k] *
              std::sin(train.meshes[k].working_angle_rad);
  }
  const double heat =
      friction * train.pin_radius_m * std::fabs(radial) * std::fabs(train.planet_speed);
  EXPECT_NEAR(more * std::fabs(train.ratio), heat, 1e-3 * heat);
}

TEST(Orders, AreThoseOfTheInterface) {
  const std::map<std::string, double> expected{{"sun", 83.5},
                                               {"sun_absolute", 95.9},
                                               {"planet", 29.2},
                                               {"planet_absolute", 16.8},
                                               {"carrier", 12.4}};
  for (const auto& [body, order] : expected) {
    const Dataset data = measure(low_backlash_gear(), transmission_plan(),
                                 {{.id = "runout", .variant = body, .amplitude = 0.01}}, 1);
    EXPECT_NEAR(data.truth[0].order, order, 0.05) << body;  // half a unit of the last digit
    EXPECT_EQ(data.truth[0].body, body.substr(0, body.find('_')));
  }
}

TEST(LostMotion, RepeatsAfterATurnOfTheEccentricBody) {
  const Gearbox gearbox = bilateral_drive_gear();
  const HiddenCause planet = cause("runout", "planet", 5e-6);
  const Dataset data = measure(gearbox, lost_motion_plan(), {planet}, 1);
  Condition at{.output_angle_deg = 10.0};
  const double here = lost_motion_arcmin(gearbox, at, {planet});
  at.output_angle_deg += 360.0 / data.truth[0].order;
  EXPECT_NEAR(lost_motion_arcmin(gearbox, at, {planet}), here, 1e-9 * here);
  at.output_angle_deg += 180.0 / data.truth[0].order;
  EXPECT_GT(std::fabs(lost_motion_arcmin(gearbox, at, {planet}) - here), 1e-3);
}

TEST(LostMotion, GrowsWithTorqueByTwiceTheCompliance) {
  const Gearbox gearbox = bilateral_drive_gear();
  const Condition at{.output_torque_Nm = 3.0};
  const double rigid = lost_motion_arcmin(gearbox, at);
  EXPECT_NEAR(lost_motion_arcmin(gearbox, at, {cause("compliance", "", 0.5)}), rigid + 3.0, 1e-12);
  EXPECT_NEAR(lost_motion_arcmin(gearbox, at, {cause("clearance", "", 2.0)}), rigid + 2.0, 1e-12);
  EXPECT_NEAR(rigid, 24.0, 1.0);  // the published backlash of this gearbox
}

// Moving the axes apart by e opens an external pair by 2 e sin(alpha_w) along the line of action
// and closes an internal one.
TEST(NormalBacklash, FollowsTheCentreDistance) {
  const auto pairs = pairs_of(bilateral_drive_gear());
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = pairs[k].center_distance_m, e = 1e-8;
    const double slope =
        (normal_backlash_m(pairs[k], d + e, 0.0) - normal_backlash_m(pairs[k], d - e, 0.0)) /
        (2.0 * e);
    const double expected = 2.0 * std::sin(make_rig_mesh(pairs[k]).working_angle_rad);
    EXPECT_NEAR(slope, k == 0 ? expected : -expected, 1e-6);
  }
}

TEST(Campaign, OfTransmissionIsBalanced) {
  const Dataset data = measure(bilateral_drive_gear(), transmission_plan(), {}, 7);
  const auto rows = fields(data.csv);
  EXPECT_TRUE(data.csv.starts_with("# kind: transmission\n"));
  const std::vector<std::string> header{"direction",     "sun_speed_rpm", "output_torque_nm",
                                        "sun_torque_nm", "rotation",      "output_angle_deg",
                                        "temperature_c", "time_s",        "run"};
  ASSERT_EQ(rows.size(), 121U);
  EXPECT_EQ(rows[0], header);
  std::map<std::string, int> of;
  std::set<std::string> torques;
  double last_time = 0.0, last_angle = -1.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto& row = rows[i];
    ASSERT_EQ(row.size(), header.size());
    ++of[row[0]];
    ++of["rotation " + row[4]];
    ++of[row[0] + " rotation " + row[4]];
    ++of["rpm " + row[1]];
    ++of["load " + row[2]];
    ++of[row[8]];
    torques.insert(row[3]);
    EXPECT_GT(std::stod(row[7]), last_time);
    EXPECT_GT(std::stod(row[5]), last_angle);
    EXPECT_GE(std::stod(row[6]), 25.0);
    EXPECT_LE(std::stod(row[6]), 45.0);
    last_time = std::stod(row[7]);
    last_angle = std::stod(row[5]);
    EXPECT_NEAR(std::stod(row[3]), data.measured[i - 1], 1e-8 * data.measured[i - 1]);
  }
  EXPECT_EQ(of["forward"], 60);
  EXPECT_EQ(of["backward"], 60);
  EXPECT_EQ(of["rotation 1"], 60);
  EXPECT_EQ(of["rotation -1"], 60);
  EXPECT_EQ(of["forward rotation 1"], 30);
  for (const char* rpm : {"rpm 200", "rpm 400", "rpm 600", "rpm 800", "rpm 1000"}) {
    EXPECT_EQ(of[rpm], 24) << rpm;
  }
  for (const char* load : {"load 5", "load 20", "load 35", "load 50"}) EXPECT_EQ(of[load], 30);
  for (const char* run : {"s1", "s2", "s3", "s4"}) EXPECT_EQ(of[run], 30);
  EXPECT_EQ(torques.size(), 120U);  // the noise is not quantised
}

TEST(Campaign, LeavesOutWhatItIsToldTo) {
  Plan plan = transmission_plan();
  plan.angle = plan.temperature = plan.time = plan.run = plan.rotation = false;
  plan.both_rotations = plan.backward = false;
  plan.sun_speeds_rpm = {600.0};
  const auto rows = fields(measure(bilateral_drive_gear(), plan, {}, 7).csv);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"direction", "sun_speed_rpm", "output_torque_nm",
                                               "sun_torque_nm"}));
  EXPECT_EQ(rows.size(), 1U + 4U * 3U);
  plan = transmission_plan();
  plan.load_by_session = true;
  plan.sigma = true;
  const Dataset swept = measure(bilateral_drive_gear(), plan, {}, 7);
  std::map<int, std::set<double>> loads;
  for (const Condition& row : swept.conditions) loads[row.session].insert(row.output_torque_Nm);
  for (const auto& [session, values] : loads) EXPECT_EQ(values.size(), 1U) << session;
  EXPECT_NE(swept.csv.find(",sigma_nm,run\n"), std::string::npos);
  plan = transmission_plan();
  plan.unequal_repeats = true;
  std::map<std::tuple<bool, double, double>, int> repeats;
  const Dataset unequal = measure(bilateral_drive_gear(), plan, {}, 7);
  for (const Condition& c : unequal.conditions) {
    ++repeats[{c.forward, c.sun_speed_rpm, c.output_torque_Nm}];
  }
  EXPECT_EQ(unequal.conditions.size(), 120U);
  EXPECT_EQ(repeats.size(), 40U);
  std::set<int> counts;
  for (const auto& [condition, count] : repeats) counts.insert(count);
  EXPECT_GT(counts.size(), 2U);
  EXPECT_GE(*counts.begin(), 1);
  EXPECT_LE(*counts.rbegin(), 5);
}

TEST(Campaign, LayoutsOfTheOtherKinds) {
  const Gearbox gearbox = bilateral_drive_gear();
  const std::string lost = measure(gearbox, lost_motion_plan(), {}, 1).csv;
  EXPECT_TRUE(
      lost.starts_with("# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin,"
                       "temperature_c,cycles,time_s,run\n"));
  EXPECT_EQ(fields(lost).size(), 121U);
  const std::string loop = measure(gearbox, torque_angle_plan(), {}, 1).csv;
  EXPECT_TRUE(
      loop.starts_with("# kind: torque_angle\n# locked: sun\ntime_s,angle_deg,torque_nm,run\n"));
  const std::string pairs = measure(gearbox, pair_loss_plan(), {}, 1).csv;
  EXPECT_TRUE(pairs.starts_with(
      "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor,module_mm,run\n"));
}

TEST(Campaign, IsTheSameForTheSameSeedOnly) {
  const Gearbox gearbox = bilateral_drive_gear();
  const std::vector<HiddenCause> causes{{.id = "runout", .variant = "sun", .rms_in_noise = 1.0}};
  const auto csv = [&](std::uint64_t seed) {
    return measure(gearbox, transmission_plan(), causes, seed).csv;
  };
  EXPECT_EQ(csv(3), csv(3));
  EXPECT_NE(csv(3), csv(4));
}

TEST(Campaign, NoiseHasTheStatedDeviation) {
  const Gearbox gearbox = bilateral_drive_gear();
  for (const Noise noise :
       {Noise::gaussian, Noise::student, Noise::proportional, Noise::session_offsets}) {
    Plan plan = transmission_plan();
    plan.noise = noise;
    plan.sessions = 6;
    double squares = 0.0, sum = 0.0, beyond = 0.0, n = 0.0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const Dataset data = measure(gearbox, plan, {}, seed);
      for (std::size_t i = 0; i < data.clean.size(); ++i) {
        const double e = (data.measured[i] - data.clean[i]) / data.noise_sd;
        sum += e;
        squares += e * e;
        beyond += std::fabs(e) > 4.0 ? 1.0 : 0.0;
        n += 1.0;
      }
    }
    const double sd = std::sqrt(squares / n);
    EXPECT_NEAR(sum / n, 0.0, noise == Noise::session_offsets ? 0.06 : 0.03);
    if (noise == Noise::gaussian) {
      EXPECT_NEAR(sd, 1.0, 4.0 / std::sqrt(2.0 * n));
      EXPECT_LT(beyond / n, 5e-4);
    } else if (noise == Noise::student) {
      EXPECT_NEAR(sd, 1.0, 0.2);  // its fourth moment does not exist
      // P(|t3| > 4 sqrt 3) = 0.62 %, by the integral of its density.
      EXPECT_NEAR(beyond / n, 0.0062, 0.0025);
    } else if (noise == Noise::proportional) {
      EXPECT_GT(sd, 1.05);
    } else {
      EXPECT_NEAR(sd, std::sqrt(1.25), 0.03);
    }
  }
}

TEST(Campaign, NextExperimentIsMeasuredOnTheSameGearbox) {
  const Gearbox gearbox = bilateral_drive_gear();
  const Dataset first = measure(gearbox, transmission_plan(),
                                {{.id = "runout", .variant = "planet", .rms_in_noise = 1.0},
                                 {.id = "drift", .rms_in_noise = 0.5},
                                 {.id = "run_step", .rms_in_noise = 0.3}},
                                5);
  const Dataset again = measure_conditions(gearbox, transmission_plan(), first.conditions,
                                           first.causes, first.noise_sd, 6, "again");
  EXPECT_EQ(again.clean, first.clean);
  EXPECT_NE(again.measured, first.measured);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(sun_torque(gearbox, first.conditions[i], first.causes), first.clean[i]);
  }
}

TEST(TorqueAngle, BranchesAreApartByTheDeadBandAtZeroTorque) {
  Plan plan = torque_angle_plan();
  plan.samples_per_loop = 2000;
  const Gearbox gearbox = bilateral_drive_gear();
  const double lost = lost_motion_arcmin(gearbox, {});
  const auto gap = [&](const std::vector<HiddenCause>& causes) {
    const Dataset data = measure(gearbox, plan, causes, 1);
    // Second loop: falls through zero at half of it and rises through it at its end.
    return data.clean[3000] - data.clean[4000];
  };
  EXPECT_NEAR(gap({}), lost, 1e-4 * lost);
  EXPECT_NEAR(gap({cause("clearance", "", 3.0)}), lost + 3.0, 1e-4 * lost);
  const double compliance = 0.5;  // friction of the loop holds +-0.3 Nm in the spring
  EXPECT_NEAR(gap({cause("compliance", "", compliance)}), lost + 0.6 * compliance, 1e-4 * lost);
}

// Approach and recess nearly balance in this gearbox, so that a large change of its torque by
// them asks for more than friction can give.
TEST(HiddenCauses, BeyondPhysicsAreMarked) {
  const Gearbox gearbox = bilateral_drive_gear();
  for (const auto& [rms, physical] : {std::pair{0.3, true}, std::pair{3.0, false}}) {
    const HiddenCause hidden{.id = "friction_direction", .rms_in_noise = rms};
    EXPECT_EQ(measure(gearbox, transmission_plan(), {hidden}, 1).truth[0].physical, physical);
  }
}

TEST(HiddenCauses, ThatMakeNoSenseAreRefused) {
  const Gearbox gearbox = bilateral_drive_gear();
  const auto refused = [&](const Plan& plan, const HiddenCause& hidden) {
    EXPECT_THROW(measure(gearbox, plan, {hidden}, 1), std::invalid_argument) << hidden.id;
  };
  refused(transmission_plan(), {.id = "friction", .amplitude = 0.1});
  refused(transmission_plan(), {.id = "friction_level"});
  refused(transmission_plan(), {.id = "runout", .variant = "ring", .amplitude = 0.1});
  refused(transmission_plan(), {.id = "clearance", .amplitude = 0.1});
  refused(pair_loss_plan(), {.id = "drag_constant", .amplitude = 0.1});
  Plan one = transmission_plan();
  one.sessions = 1;
  refused(one, {.id = "run_step", .rms_in_noise = 1.0});
  Plan slow = transmission_plan();
  slow.sun_speeds_rpm = {1000.0};
  refused(slow, {.id = "corner", .rms_in_noise = 1.0});
  EXPECT_FALSE(measure(gearbox, transmission_plan(), {{.id = "corner", .rms_in_noise = 1.0}}, 1)
                   .truth[0]
                   .in_library);
}

}  // namespace
}  // namespace gear3k::rig::rig_effects_test
