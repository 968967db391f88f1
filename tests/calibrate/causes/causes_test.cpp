#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "calibrate/causes/form_catalogue.hpp"
#include "calibrate/fit/linearisation.hpp"
#include "calibrate/model/cause.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/rig_train.hpp"

namespace gear3k::calibrate::causes_test {
namespace {

constexpr double kRounding = 1e-13;
constexpr double kRpm = std::numbers::pi / 30.0;
constexpr double kArcmin = std::numbers::pi / 180.0 / 60.0;

const std::vector<Kind> kKinds{Kind::kTransmission, Kind::kLostMotion, Kind::kTorqueAngle,
                               Kind::kPairLoss};

// The list

TEST(Causes, AreThoseOfTheInterfaceEachOnce) {
  using enum Kind;
  // The table of the interface: which data can show what.
  const std::map<std::string, std::set<Kind>> table{
      {"friction_level", {kTransmission, kPairLoss}},
      {"friction_load", {kTransmission}},
      {"friction_speed", {kTransmission}},
      {"friction_temperature", {kTransmission}},
      {"friction_direction", {kTransmission, kPairLoss}},
      {"drag_constant", {kTransmission}},
      {"drag_viscous", {kTransmission}},
      {"drag_quadratic", {kTransmission}},
      {"bearing_load", {kTransmission, kPairLoss}},
      {"sensor_gain", {kTransmission, kPairLoss}},
      {"sensor_offset", {kTransmission}},
      {"run_step", {kTransmission, kLostMotion, kTorqueAngle, kPairLoss}},
      {"drift", {kTransmission, kLostMotion, kTorqueAngle, kPairLoss}},
      {"runout", {kTransmission, kLostMotion}},
      {"mesh_order", {kTransmission, kLostMotion}},
      {"clearance", {kLostMotion, kTorqueAngle}},
      {"compliance", {kLostMotion, kTorqueAngle}},
      {"thermal_expansion", {kLostMotion}}};
  std::map<std::string, std::set<Kind>> found;
  for (const Cause* cause : causes()) {
    const std::string id(cause->id);
    EXPECT_FALSE(found.contains(id)) << id;
    EXPECT_EQ(find_cause(id), cause);
    EXPECT_FALSE(cause->title.empty()) << id;
    EXPECT_GT(cause->weight, 0.0) << id;
    for (const Kind kind : kKinds) {
      if (!form_catalogue(*cause, kind).empty()) found[id].insert(kind);
    }
  }
  EXPECT_EQ(found, table);
  EXPECT_EQ(find_cause("friction"), nullptr);
}

TEST(Causes, StandInTheUsersTable) {
  std::ifstream file(GEAR3K_SOURCE_DIR "/docs/interface.md");
  std::stringstream text;
  text << file.rdbuf();
  ASSERT_FALSE(text.str().empty());
  for (const Cause* cause : causes()) {
    const std::regex row("\n\\|[^|]*`" + std::string(cause->id) + "`[^|]*\\|");
    EXPECT_TRUE(std::regex_search(text.str(), row)) << cause->id;
  }
}

TEST(Causes, HaveParametersThatMayBeNothing) {
  for (const Cause* cause : causes()) {
    for (const Kind kind : kKinds) {
      for (const CatalogueForm& form : form_catalogue(*cause, kind)) {
        // A form of all sessions has a parameter for each.
        std::vector<FormConstant> constants = form.sets.front();
        for (FormConstant& c : constants) c.value = 3.0;
        const auto parameters =
            cause->parameters({.name = form.name, .constants = constants}, kind);
        EXPECT_FALSE(parameters.empty());
        std::set<std::string> keys;
        for (const ParameterRecord& p : parameters) {
          EXPECT_LE(p.lower, 0.0) << cause->id;
          EXPECT_GE(p.upper, 0.0) << cause->id;
          EXPECT_LT(p.lower, p.upper) << cause->id;
          // A shape is not judged.
          const bool judged = std::isfinite(p.plausible_low) || std::isfinite(p.plausible_high);
          if (judged) {
            EXPECT_LE(p.lower, p.plausible_low) << cause->id;
            // The fit of a shape, which has no unit, may end short of what can be.
            if (!p.unit.empty()) {
              EXPECT_LE(p.plausible_high, p.upper) << cause->id;
            }
          }
          EXPECT_LT(p.plausible_low, p.plausible_high) << cause->id;
          keys.insert(file_key(p.name, p.unit));
        }
        EXPECT_EQ(keys.size(), parameters.size()) << cause->id;
      }
    }
  }
}

// Of readings of 25.3 and 44.122 C in a design of 20 C.
// A transition is as steep as it likes within a few kelvin, the viscosity of an oil is not.
TEST(Causes, OnlyALawOfTemperatureWithoutAShapeOfItsOwnIsBoundedByOils) {
  const auto bounded = [](const char* form) {
    return std::isfinite(candidate("friction_temperature", {.name = form}, Kind::kTransmission)
                             .parameters[0]
                             .plausible_high);
  };
  for (const char* form : {"from_design", "about_middle", "any_level"}) {
    EXPECT_TRUE(bounded(form)) << form;
  }
  for (const char* form : {"any_curve", "any_shape"}) EXPECT_FALSE(bounded(form)) << form;
}

TEST(Causes, ReferenceTemperaturesHaveTheDigitsOfTheData) {
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kTransmission);
  MeasurementSet data = campaign(Kind::kTransmission);
  for (std::size_t k = 0; k < data.rows.size(); ++k) {
    data.rows[k].condition.temperature_K = (k % 2 == 0 ? 25.3 : 44.122) + 273.15;
  }
  std::set<double> found;
  for (const Candidate& c : candidates_for(simulation, data)) {
    for (const FormConstant& constant : c.form.constants) {
      if (constant.name == "reference_temperature") found.insert(constant.value);
    }
  }
  EXPECT_EQ(found, (std::set<double>{20.0, 25.3, 34.711, 44.122}));
}

TEST(Causes, AreNothingToSearchWhereTheDataCannotShowThem) {
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kTransmission);
  const auto ids = [&](auto change) {
    MeasurementSet data = campaign(Kind::kTransmission);
    for (Observation& row : data.rows) change(row.condition);
    std::set<std::string> result;
    for (const Candidate& c : candidates_for(simulation, data)) {
      result.insert(std::string(c.cause->id));
    }
    return result;
  };
  EXPECT_EQ(ids([](Condition&) {}).size(), 15U);
  const auto still = ids([](Condition& c) { c.temperature_K = 300.0; });
  EXPECT_FALSE(still.contains("friction_temperature"));
  // Over less than 3 K.
  for (const auto& [span, told] : {std::pair{2.9, false}, std::pair{3.1, true}}) {
    bool warm = false;
    const auto creeping = ids([&, range = span](Condition& c) {
      c.temperature_K = warm ? 300.0 + range : 300.0;
      warm = !warm;
    });
    EXPECT_EQ(creeping.contains("friction_temperature"), told) << span;
  }
  const auto angle = ids([](Condition& c) { c.output_angle_rad = kUnknown; });
  EXPECT_FALSE(angle.contains("runout"));
  EXPECT_FALSE(angle.contains("mesh_order"));
  const auto load = ids([](Condition& c) { c.output_torque_Nm = 20.0; });
  EXPECT_FALSE(load.contains("friction_load"));
  // A row without load has no place in a law of the load; the others have.
  bool first = true;
  const auto idle = ids([&](Condition& c) {
    if (first) c.output_torque_Nm = 0.0;
    first = false;
  });
  EXPECT_TRUE(idle.contains("friction_load"));
  EXPECT_TRUE(idle.contains("friction_speed"));
  const auto unloaded = ids([](Condition& c) { c.output_torque_Nm = 0.0; });
  EXPECT_FALSE(unloaded.contains("friction_load"));
  EXPECT_TRUE(unloaded.contains("drag_constant"));
  const auto time = ids([](Condition& c) { c.time_s = kUnknown; });
  EXPECT_FALSE(time.contains("drift"));
  EXPECT_TRUE(time.contains("run_step"));
}

TEST(Causes, OfOneSessionAreStepsInTimeAsOfNone) {
  MeasurementSet data = campaign(Kind::kTransmission);
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kTransmission);
  const auto steps = [&](int runs) {
    data.runs.assign(static_cast<std::size_t>(runs), "one");
    for (Observation& row : data.rows) row.condition.run = runs - 1;
    std::vector<double> instants;
    for (const Candidate& c : candidates_for(simulation, data)) {
      if (c.cause->id != "run_step") continue;
      EXPECT_EQ(c.form.constants.front().name, "instant");
      instants.push_back(c.form.constants.front().value);
    }
    return instants;
  };
  EXPECT_FALSE(steps(0).empty());
  EXPECT_EQ(steps(1), steps(0));
}

TEST(Causes, HaveEveryFormOfASearchInTheirCatalogue) {
  // What diagnose may write into a model is what a model may hold.
  for (const Kind kind : kKinds) {
    MeasurementSet data = campaign(kind);
    data.runs = {"a", "b", "c", "d"};
    const auto rows = data.rows.size();
    for (std::size_t i = 0; i < rows; ++i) {
      data.rows[i].condition.run = static_cast<int>(4 * i / rows);
    }
    const design::Design design = design_of(rig::bilateral_drive_gear());
    const Subject other =
        kind == Kind::kPairLoss ? Subject(pair_of(design)) : Subject(some_black_box());
    for (const Subject& subject : {Subject(design), other}) {
      for (const Candidate& c : candidates_for(Simulation(subject, kind), data)) {
        const auto catalogue = form_catalogue(*c.cause, kind);
        const auto known = std::ranges::find(catalogue, c.form.name, &CatalogueForm::name);
        ASSERT_NE(known, catalogue.end()) << c.cause->id << ' ' << c.form.name;
        EXPECT_TRUE(c.form.body.empty() || std::ranges::count(known->bodies, c.form.body) == 1)
            << c.form.body;
        EXPECT_TRUE(std::ranges::any_of(known->sets,
                                        [&](const auto& set) {
                                          return std::ranges::equal(set, c.form.constants, {},
                                                                    &FormConstant::name,
                                                                    &FormConstant::name);
                                        }))
            << c.cause->id << ' ' << c.form.name;
      }
    }
  }
}

TEST(Causes, OfNoSizeChangeNothing) {
  design::Design design = design_of(rig::bilateral_drive_gear());
  design.shafts.drag[design::kSunShaft].constant_Nm = 0.004;
  for (const Kind kind : kKinds) {
    const MeasurementSet all = campaign(kind);
    const MeasurementSet data = all.rows.size() > 60 ? thinned(all, 4) : all;
    const Subject other =
        kind == Kind::kPairLoss ? Subject(pair_of(design)) : Subject(some_black_box());
    for (const Subject& subject : {Subject(design), other}) {
      const Simulation simulation(subject, kind);
      const Eigen::VectorXd without = simulated(simulation, data, {}).value();
      for (const Candidate& c : candidates_for(simulation, all)) {
        const Hypothesis none = hypothesis({c}, std::vector<double>(c.parameters.size(), 0.0));
        const Eigen::VectorXd with = simulated(simulation, data, none).value();
        if (c.cause->id == "friction_direction" && c.form.name == "approach_recess") {
          // Adds the difference of the two sides, which is 0, in two steps that each round.
          EXPECT_LT((with - without).cwiseAbs().maxCoeff(), 1e-14 * without.maxCoeff());
          continue;
        }
        const bool by_state = c.cause->remedy == Remedy::kFlanks || c.form.name == "by_mesh";
        if (by_state && kind == Kind::kTransmission) {
          // Friction that depends on the state is settled in another way, the same to rounding.
          EXPECT_LT((with - without).cwiseAbs().maxCoeff(), 1e-12 * without.maxCoeff());
          continue;
        }
        EXPECT_EQ(with, without) << c.cause->id << ' ' << c.form.name;  // bit for bit
      }
    }
  }
}

// What each does on the bilateral drive gear

Hypothesis one(const std::string& id, Form form, std::vector<double> value,
               Kind kind = Kind::kTransmission) {
  return hypothesis({candidate(id, std::move(form), kind)}, std::move(value));
}

Form with_constants(const char* name, std::vector<FormConstant> constants) {
  return {.name = name, .constants = std::move(constants)};
}

class OnTransmission : public testing::Test {
 protected:
  OnTransmission() : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission) {}

  [[nodiscard]] double torque(const Condition& c, const Hypothesis& h = {}) const {
    return simulated(simulation_, c, h);
  }
  [[nodiscard]] static Condition at(design::Direction direction) {
    return {.direction = direction,
            .sun_speed_rad_s = 600.0 * kRpm,
            .output_torque_Nm = 20.0,
            .temperature_K = 308.15};
  }
  /// The same condition as the rig has it.
  [[nodiscard]] static rig::Condition on_rig(const Condition& c) {
    return {.forward = c.direction == design::Direction::kForward,
            .sun_speed_rpm = c.sun_speed_rad_s / kRpm,
            .output_torque_Nm = c.output_torque_Nm,
            .rotation = c.rotation,
            .temperature_c = c.temperature_K - 273.15};
  }
  /// As the rig says, which shares neither code nor formula.
  static double on_rig(const Condition& c, const std::string& id, const std::string& variant,
                       double amplitude) {
    return rig::sun_torque(rig::bilateral_drive_gear(), on_rig(c),
                           {{.id = id, .variant = variant, .amplitude = amplitude}});
  }
  [[nodiscard]] static Hypothesis level(double change) {
    return one("friction_level", {.name = "coefficient"}, {change});
  }
  /// Another cause beside a level.
  [[nodiscard]] static Hypothesis beside_level(const std::string& id, Form form, double value,
                                               double change) {
    return hypothesis(
        {candidate("friction_level", {.name = "coefficient"}), candidate(id, std::move(form))},
        {change, value});
  }

  Simulation simulation_;
  const Condition forward_ = at(design::Direction::kForward);
  const Condition backward_ = at(design::Direction::kBackward);
  /// The rig's quadrature of the sliding over a base pitch.
  static constexpr double kQuadrature = 1e-6;
};

TEST_F(OnTransmission, FrictionLevelIsAnotherCoefficient) {
  design::Design design = design_of(rig::bilateral_drive_gear());
  design.friction.coefficient *= 1.3;
  const Simulation other(design, Kind::kTransmission);
  for (const Condition& c : {forward_, backward_}) {
    EXPECT_NEAR(torque(c, level(0.3)), simulated(other, c), kRounding);
    const double rig = on_rig(c, "friction_level", "", 0.3);
    EXPECT_NEAR(torque(c, level(0.3)), rig, kQuadrature * rig);
  }
}

TEST_F(OnTransmission, FrictionLoadIsAPowerOfTheLoad) {
  // All tooth forces grow with the load: at 2 T friction is 2^n of that at T, and with it all
  // torques are in proportion.
  const Form form =
      with_constants("about_middle", {{.name = "reference_load", .unit = "N", .value = 300.0}});
  constexpr double kExponent = -0.2;
  for (const Condition& c : {forward_, backward_}) {
    Condition twice = c;
    twice.output_torque_Nm *= 2.0;
    const double scaled =
        torque(twice, beside_level("friction_load", form, kExponent, std::exp2(-kExponent) - 1.0));
    EXPECT_NEAR(scaled, 2.0 * torque(c, one("friction_load", form, {kExponent})), 1e-11);
    // And falling friction shows.
    EXPECT_GT(std::abs(torque(twice, one("friction_load", form, {kExponent})) -
                       2.0 * torque(c, one("friction_load", form, {kExponent}))),
              1e-3);
  }
}

TEST_F(OnTransmission, FrictionSpeedIsAPowerOrAnExcessThatDiesAway) {
  const Form power = with_constants("power_about_middle",
                                    {{.name = "reference_speed", .unit = "m/s", .value = 0.1}});
  const Form excess =
      with_constants("slow_excess", {{.name = "speed_scale", .unit = "m/s", .value = 0.05}});
  constexpr double kExponent = -0.3;
  for (const Condition& c : {forward_, backward_}) {
    Condition twice = c;
    twice.sun_speed_rad_s *= 2.0;
    EXPECT_NEAR(torque(twice, beside_level("friction_speed", power, kExponent,
                                           std::exp2(-kExponent) - 1.0)),
                torque(c, one("friction_speed", power, {kExponent})), 1e-11);
    Condition still = c;
    still.sun_speed_rad_s = 0.0;
    EXPECT_NEAR(torque(still, one("friction_speed", excess, {0.7})), torque(still, level(0.7)),
                kRounding);
    Condition fast = c;
    fast.sun_speed_rad_s = 1e5;
    EXPECT_NEAR(torque(fast, one("friction_speed", excess, {0.7})), torque(fast), kRounding);
  }
}

TEST_F(OnTransmission, FrictionTemperatureIsAnExponential) {
  const Form form = with_constants("from_design",
                                   {{.name = "reference_temperature", .unit = "c", .value = 20.0}});
  for (Condition c : {forward_, backward_}) {
    c.temperature_K = 293.15;
    EXPECT_NEAR(torque(c, one("friction_temperature", form, {-0.02})), torque(c), kRounding);
    c.temperature_K = 323.15;
    EXPECT_NEAR(torque(c, one("friction_temperature", form, {-0.02})),
                torque(c, level(std::exp(-0.6) - 1.0)), kRounding);
  }
}

TEST_F(OnTransmission, TemperatureMayActOnTheDrags) {
  design::Design design = design_of(rig::bilateral_drive_gear());
  design.shafts.drag[design::kSunShaft].constant_Nm = 0.01;
  const Simulation dragging(design, Kind::kTransmission);
  const Form form =
      with_constants("drag", {{.name = "reference_temperature", .unit = "c", .value = 20.0}});
  for (Condition c : {forward_, backward_}) {
    c.temperature_K = 313.15;
    const double sign = c.direction == design::Direction::kForward ? 1.0 : -1.0;
    EXPECT_NEAR(simulated(dragging, c, one("friction_temperature", form, {-0.03})),
                torque(c) + sign * 0.01 * std::exp(-0.6), kRounding);
  }
}

TEST_F(OnTransmission, FrictionDirectionDiffersWithTheEndThatDrives) {
  const auto direction = [](const char* form) {
    return one("friction_direction", {.name = form}, {0.2});
  };
  EXPECT_NEAR(torque(forward_, direction("forward_backward")), torque(forward_, level(0.2)),
              kRounding);
  EXPECT_NEAR(torque(backward_, direction("forward_backward")), torque(backward_, level(-0.2)),
              kRounding);
  EXPECT_NEAR(torque(forward_, direction("forward")), torque(forward_, level(0.2)), kRounding);
  EXPECT_EQ(torque(backward_, direction("forward")), torque(backward_));
  EXPECT_NEAR(torque(backward_, direction("backward")), torque(backward_, level(0.2)), kRounding);
  EXPECT_EQ(torque(forward_, direction("backward")), torque(forward_));
}

TEST_F(OnTransmission, FrictionDirectionDiffersBeforeAndBehindThePitchPoint) {
  // To first order in friction as in the rig; at 0.1 the second order is as great, as the two sides
  // nearly balance.
  rig::Gearbox smooth = rig::bilateral_drive_gear();
  smooth.friction = 1e-3;
  const Simulation simulation(design_of(smooth), Kind::kTransmission);
  for (const Condition& c : {forward_, backward_}) {
    const double found =
        simulated(simulation, c, one("friction_direction", {.name = "approach_recess"}, {0.2})) -
        simulated(simulation, c);
    const double rig =
        rig::sun_torque(smooth, on_rig(c), {{.id = "friction_direction", .amplitude = 0.2}}) -
        rig::sun_torque(smooth, on_rig(c));
    EXPECT_NEAR(found, rig, 0.02 * std::abs(rig));
  }
}

TEST_F(OnTransmission, FrictionMayDifferWithTheGearThatDrivesInAMesh) {
  // [§6], G2 = 32·90/(39·81) < 1: forward S drives P1, P1 drives R1 and R2 drives P2; backward the
  // reverse.  Both sides together are the level.
  const auto driving = [](const char* form, double change) {
    return one("friction_direction", {.name = form}, {change});
  };
  for (const Condition& c : {forward_, backward_}) {
    const double nominal = torque(c);
    const double inner = torque(c, driving("driving_inner", 0.2)) - nominal;
    const double outer = torque(c, driving("driving_outer", 0.2)) - nominal;
    const double both = torque(c, level(0.2)) - nominal;
    // To first order the meshes' losses add up.
    EXPECT_NEAR(inner + outer, both, 0.03 * std::abs(both));
    EXPECT_GT(std::min(std::abs(inner), std::abs(outer)), 0.1 * std::abs(both));
  }
}

TEST_F(OnTransmission, FrictionOfTheRingsMayBeAnother) {
  const auto by_mesh = [](double all, double rings) {
    return one("friction_level", {.name = "by_mesh"}, {all, rings});
  };
  for (const Condition& c : {forward_, backward_}) {
    EXPECT_EQ(torque(c, by_mesh(0.3, 0.0)), torque(c, level(0.3)));
    const double rings = torque(c, by_mesh(0.0, 0.2)) - torque(c);
    // 1.2 in all meshes and 1/1.2 of it in the rings is 1.2 in S-P1 alone.
    const double sun = torque(c, by_mesh(0.2, 1.0 / 1.2 - 1.0)) - torque(c);
    const double both = torque(c, level(0.2)) - torque(c);
    EXPECT_NEAR(rings + sun, both, 0.03 * std::abs(both));
    // In a Wolfrom gear the rings lose most: their meshes carry the circulating power.
    EXPECT_GT(std::abs(rings), 3.0 * std::abs(sun));
  }
}

TEST_F(OnTransmission, BothShaftsMayHaveASeal) {
  for (const Condition& c : {forward_, backward_}) {
    const double sign = c.direction == design::Direction::kForward ? 1.0 : -1.0;
    Condition loaded = c;
    loaded.output_torque_Nm += sign * 0.5;
    const double expected = torque(loaded) + sign * 0.01;
    EXPECT_NEAR(
        torque(c, one("drag_constant", {.name = "sun_and_output", .body = "sun"}, {0.01, 0.5})),
        expected, 1e-12);
    EXPECT_NEAR(
        torque(c, one("drag_constant", {.name = "output_and_sun", .body = "output"}, {0.5, 0.01})),
        expected, 1e-12);
  }
}

TEST_F(OnTransmission, DragOnTheSunAddsForwardAndTakesAwayBackward) {
  const double w = 600.0 * kRpm;
  const Form sun{.name = "sun", .body = "sun"};
  for (const auto& [id, value, drag] :
       {std::tuple{"drag_constant", 0.01, 0.01}, std::tuple{"drag_viscous", 1e-4, 1e-4 * w},
        std::tuple{"drag_quadratic", 1e-6, 1e-6 * w * w}}) {
    const Hypothesis h = one(id, sun, {value});
    for (const int rotation : {1, -1}) {
      Condition f = forward_;
      Condition b = backward_;
      f.rotation = b.rotation = rotation;
      EXPECT_NEAR(torque(f, h) - torque(f), drag, kRounding) << id;
      EXPECT_NEAR(torque(b, h) - torque(b), -drag, kRounding) << id;
    }
    // Whatever the load.
    Condition light = forward_;
    light.output_torque_Nm = 5.0;
    EXPECT_NEAR(torque(light, h) - torque(light), drag, kRounding) << id;
  }
}

TEST_F(OnTransmission, DragOnTheOutputIsLoadThatTheTeethCarryMoreOrLess) {
  // 12/39/90/32/81: ratio 5967/62.
  const double w = 600.0 * kRpm / (5967.0 / 62.0);
  const Form output{.name = "output", .body = "output"};
  for (const auto& [id, value, drag] :
       {std::tuple{"drag_constant", 0.5, 0.5}, std::tuple{"drag_viscous", 0.2, 0.2 * w},
        std::tuple{"drag_quadratic", 0.3, 0.3 * w * w}}) {
    for (const Condition& c : {forward_, backward_}) {
      Condition loaded = c;
      loaded.output_torque_Nm += c.direction == design::Direction::kForward ? drag : -drag;
      EXPECT_NEAR(torque(c, one(id, output, {value})), torque(loaded), 1e-12) << id;
    }
  }
}

TEST_F(OnTransmission, ABentDragKeepsItsTorqueAtTheGreatestSpeedAndChangesItsExponentThere) {
  constexpr double kTop = 100.0;
  const Form sun{.name = "sun_any_curve",
                 .constants = {{.name = "top_speed", .unit = "rad/s", .value = kTop}},
                 .body = "sun"};
  for (const auto& [id, coefficient, exponent] :
       {std::tuple{"drag_viscous", 2e-4, 1.0}, std::tuple{"drag_quadratic", 2e-6, 2.0}}) {
    for (const double bend : {-0.4, 0.0, 0.5}) {
      const Hypothesis h = one(id, sun, {coefficient, bend});
      const auto drag = [&](double speed) {
        Condition c = forward_;
        c.sun_speed_rad_s = speed;
        return torque(c, h) - torque(c);
      };
      const double at_top = coefficient * std::pow(kTop, exponent);
      EXPECT_NEAR(drag(kTop), at_top, kRounding) << id;
      // d ln D / d ln ω by a central difference; a parabola has no error of truncation.
      const double slope = (drag(1.01 * kTop) - drag(0.99 * kTop)) / 0.02 / at_top;
      EXPECT_NEAR(slope, exponent + bend, 1e-8) << id;
    }
  }
}

TEST_F(OnTransmission, BearingLoadGrowsWithTheLoad) {
  const Hypothesis pins =
      one("bearing_load", {.name = "planet_bearings", .body = "planet"}, {0.05});
  const Hypothesis output =
      one("bearing_load", {.name = "output_bearing", .body = "output"}, {0.03});
  for (const Condition& c : {forward_, backward_}) {
    const double sign = c.direction == design::Direction::kForward ? 1.0 : -1.0;
    for (const Hypothesis& h : {pins, output}) {
      Condition twice = c;
      twice.output_torque_Nm *= 2.0;
      EXPECT_NEAR(torque(twice, h), 2.0 * torque(c, h), 1e-12);
      EXPECT_GT(sign * (torque(c, h) - torque(c)), 0.0);
    }
    // Of the torque at the shaft 3 % are lost: the teeth of R2 carry 1.03 T forward, 0.97 T
    // backward.
    Condition teeth = c;
    teeth.output_torque_Nm *= 1.0 + sign * 0.03;
    EXPECT_NEAR(torque(c, output), torque(teeth), 1e-12);
  }
}

TEST_F(OnTransmission, TheShareOfAGrowingBearingIsAPowerOfWhatItsShaftCarries) {
  // Without another loss at the output its teeth carry load and bearing: T_3 = T + K forward,
  // T − K backward, with K = λ T (T/T_0)^y.
  constexpr double kShare = 0.03;
  constexpr double kExponent = 0.4;
  constexpr double kTop = 50.0;
  const Hypothesis growing =
      one("bearing_load",
          {.name = "output_bearing_any_exponent",
           .constants = {{.name = "top_torque", .unit = "Nm", .value = kTop}},
           .body = "output"},
          {kShare, kExponent});
  for (Condition c : {forward_, backward_}) {
    const double sign = c.direction == design::Direction::kForward ? 1.0 : -1.0;
    for (const double load : {4.0, 20.0, 50.0}) {
      const double teeth = load + sign * kShare * load * std::pow(load / kTop, kExponent);
      c.output_torque_Nm = load;
      Condition loaded = c;
      loaded.output_torque_Nm = teeth;
      EXPECT_NEAR(torque(c, growing), torque(loaded), 1e-11) << load;
    }
  }
}

TEST_F(OnTransmission, ALawOfTheTorqueChangesAllMeshesByTheSameFactor) {
  // Nothing is lost at the output: its teeth carry the load, and the law is a level at each.
  constexpr double kReference = 15.0;
  constexpr double kExponent = -0.4;
  constexpr double kChange = 0.1;
  const Hypothesis law =
      one("friction_load",
          {.name = "any_level_by_torque",
           .constants = {{.name = "reference_torque", .unit = "Nm", .value = kReference}}},
          {kExponent, kChange});
  for (Condition c : {forward_, backward_}) {
    for (const double load : {4.0, 15.0, 50.0}) {
      c.output_torque_Nm = load;
      const double factor = (1.0 + kChange) * std::pow(load / kReference, kExponent);
      EXPECT_NEAR(torque(c, law), torque(c, level(factor - 1.0)), 1e-11) << load;
    }
  }
}

TEST_F(OnTransmission, AMeshsOwnShareIsThatOfTheTorqueButForLosses) {
  const auto by = [](const char* name) {
    return one(
        "friction_load",
        {.name = name, .constants = {{.name = "reference_torque", .unit = "Nm", .value = 15.0}}},
        {1.2, 0.0});
  };
  rig::Gearbox smooth = rig::bilateral_drive_gear();
  smooth.friction = 1e-6;
  const Simulation lossless(design_of(smooth), Kind::kTransmission);
  for (const Condition& c : {forward_, backward_}) {
    const double none = simulated(lossless, c);
    const double torque_law = simulated(lossless, c, by("any_level_by_torque")) - none;
    const double share_law = simulated(lossless, c, by("any_level_by_share")) - none;
    EXPECT_NEAR(share_law, torque_law, 1e-3 * std::abs(torque_law));
    // With losses the sun's mesh carries more forward and less backward.
    const double sign = c.direction == design::Direction::kForward ? 1.0 : -1.0;
    EXPECT_GT(sign * (std::abs(torque(c, by("any_level_by_share")) - torque(c)) -
                      std::abs(torque(c, by("any_level_by_torque")) - torque(c))),
              0.0);
  }
}

TEST_F(OnTransmission, ASmoothLawIsALevelAtItsPlaces) {
  const std::vector<double> log_change{0.4, 0.1, -0.2, -0.1};
  const Hypothesis law =
      one("friction_load",
          {.name = "any_smooth_by_torque",
           .constants = {{.name = "reference_torque", .unit = "Nm", .value = 20.0},
                         {.name = "log_half_range", .unit = "", .value = std::log(2.0)}}},
          {0.2, 0.4, 0.1, -0.2, -0.1});
  for (Condition c : {forward_, backward_}) {
    for (int place = 0; place < 5; ++place) {
      c.output_torque_Nm = 20.0 * std::pow(2.0, 0.5 * (place - 2));
      const double change =
          place == 2 ? 0.0 : log_change[static_cast<std::size_t>(place < 2 ? place : place - 1)];
      EXPECT_NEAR(torque(c, law), torque(c, level(1.2 * std::exp(change) - 1.0)), 1e-11) << place;
    }
  }
}

TEST_F(OnTransmission, ALawOfLevelsIsALevelAtEach) {
  const std::vector<double> load_Nm{5.0, 8.0, 11.0, 45.0}, log_change{0.4, 0.1, 0.0, -0.2};
  const double middle = std::sqrt(load_Nm.front() * load_Nm.back());
  const double half = 0.5 * std::log(load_Nm.back() / load_Nm.front());
  const Hypothesis law =
      one("friction_load",
          {.name = "any_smooth_4_levels_by_torque",
           .constants = {{.name = "reference_torque", .unit = "Nm", .value = middle},
                         {.name = "log_half_range", .unit = "", .value = half},
                         {.name = "place_2", .unit = "", .value = std::log(8.0 / middle) / half},
                         {.name = "place_3", .unit = "", .value = std::log(11.0 / middle) / half}}},
          {0.2, 0.4, 0.1, -0.2});
  for (Condition c : {forward_, backward_}) {
    for (std::size_t k = 0; k < load_Nm.size(); ++k) {
      c.output_torque_Nm = load_Nm[k];
      EXPECT_NEAR(torque(c, law), torque(c, level(1.2 * std::exp(log_change[k]) - 1.0)), 1e-11)
          << load_Nm[k];
    }
  }
}

TEST_F(OnTransmission, FrictionOnThePinsIsThatOfTheRig) {
  // Without friction in the meshes, where the rig states how forces shift with it in its own way.
  rig::Gearbox smooth = rig::bilateral_drive_gear();
  smooth.friction = 1e-6;
  const Simulation simulation(design_of(smooth), Kind::kTransmission);
  constexpr double kFriction = 0.02;
  const double radius_mm = 1e3 * rig::make_train(smooth).pin_radius_m;
  for (const Condition& c : {forward_, backward_}) {
    const double rig = rig::sun_torque(
        smooth, on_rig(c), {{.id = "bearing_load", .variant = "pins", .amplitude = kFriction}});
    EXPECT_NEAR(simulated(simulation, c,
                          one("bearing_load", {.name = "planet_bearings", .body = "planet"},
                              {kFriction * radius_mm})),
                rig, 1e-5 * rig);
    EXPECT_GT(std::abs(rig - simulated(simulation, c)), 0.02 * rig);
  }
}

TEST_F(OnTransmission, SensorGainMultipliesAndOffsetFollowsTheSensorsSign) {
  const Hypothesis gain = one("sensor_gain", {.name = "gain"}, {0.05});
  const Hypothesis offset = one("sensor_offset", {.name = "offset"}, {0.01});
  for (const int rotation : {1, -1}) {
    Condition f = forward_;
    Condition b = backward_;
    f.rotation = b.rotation = rotation;
    EXPECT_NEAR(torque(f, gain), 1.05 * torque(f), kRounding);
    EXPECT_NEAR(torque(b, gain), 1.05 * torque(b), kRounding);
    EXPECT_NEAR(torque(f, offset) - torque(f), 0.01 * rotation, kRounding);
    EXPECT_NEAR(torque(b, offset) - torque(b), -0.01 * rotation, kRounding);
    f.reference_sensor = true;  // another sensor
    EXPECT_EQ(torque(f, gain), torque(f));
    EXPECT_EQ(torque(f, offset), torque(f));
  }
}

TEST_F(OnTransmission, ZeroOfTheOutputsSensorIsAnotherLoadInThatSensorsSign) {
  constexpr double kZero_Nm = 0.8;
  const Hypothesis own = one("sensor_offset", {.name = "output"}, {kZero_Nm});
  const Hypothesis alike = one("sensor_offset", {.name = "output_magnitude"}, {kZero_Nm});
  const auto rig_under = [](Condition c, double load_Nm) {
    c.output_torque_Nm = load_Nm;
    return rig::sun_torque(rig::bilateral_drive_gear(), on_rig(c), {});
  };
  for (const int rotation : {1, -1}) {
    Condition f = forward_;
    Condition b = backward_;
    f.rotation = b.rotation = rotation;
    const double kSame = kQuadrature * torque(f);
    // A sensor that reads too much says more than there is: forward along the rotation, backward
    // against it.
    EXPECT_NEAR(torque(f, own), rig_under(f, 20.0 - rotation * kZero_Nm), kSame);
    EXPECT_NEAR(torque(b, own), rig_under(b, 20.0 + rotation * kZero_Nm), kSame);
    EXPECT_NEAR(torque(f, alike), rig_under(f, 20.0 - kZero_Nm), kSame);
    EXPECT_NEAR(torque(b, alike), rig_under(b, 20.0 - kZero_Nm), kSame);
    f.reference_sensor = true;  // another sensor
    EXPECT_EQ(torque(f, own), torque(f));
    EXPECT_EQ(torque(f, alike), torque(f));
  }
}

TEST_F(OnTransmission, ZeroOfTheOutputsSensorLeavesNoLoadAtTheLeast) {
  Condition idle = forward_;
  idle.output_torque_Nm = 0.3;
  Condition none = forward_;
  none.output_torque_Nm = 0.0;
  const Hypothesis zero = one("sensor_offset", {.name = "output_magnitude"}, {0.8});
  EXPECT_NEAR(torque(idle, zero), torque(none), kRounding);
  // Nor does a little more or less of it change anything there, while it does under load.
  MeasurementSet data;
  data.kind = Kind::kTransmission;
  data.rows = {{.condition = idle}, {.condition = forward_}};
  const Problem p{.simulation = simulation_, .data = data, .noise = make_noise_model(data)};
  const Linearisation at = linearise(p, zero, {});
  constexpr double kLittle = 1e-4;
  for (const int row : {0, 1}) {
    const Condition& c = data.rows[static_cast<std::size_t>(row)].condition;
    const auto with_zero = [&](double value) {
      return torque(c, one("sensor_offset", {.name = "output_magnitude"}, {value}));
    };
    EXPECT_NEAR(at.own(row, 0),
                (with_zero(0.8 + kLittle) - with_zero(0.8 - kLittle)) / 2.0 / kLittle, 1e-7);
  }
}

TEST_F(OnTransmission, ZeroOfTheOutputsSensorIsADragThereWhileNothingTurnsBack) {
  const Hypothesis drag = one("drag_constant", {.name = "output", .body = "output"}, {0.5});
  const Hypothesis zero = one("sensor_offset", {.name = "output"}, {-0.5});
  for (const Condition& c : {forward_, backward_}) {
    EXPECT_NEAR(torque(c, zero), torque(c, drag), kRounding * 1e3);
    Condition back = c;
    back.rotation = -1;
    EXPECT_GT(std::abs(torque(back, zero) - torque(back, drag)), 1e-3);
  }
}

TEST_F(OnTransmission, SensorZeroFollowsTheTemperatureInTheSensorsSign) {
  constexpr double kPerKelvin = 0.0004, kReference_c = 30.0, kOffset = -0.003;
  const FormConstant reference{.name = "reference_temperature", .unit = "c", .value = kReference_c};
  const Hypothesis warming =
      one("sensor_offset", with_constants("by_temperature", {reference}), {kPerKelvin});
  const Hypothesis with_zero =
      one("sensor_offset", with_constants("by_temperature_any_zero", {reference}),
          {kPerKelvin, kOffset});
  for (const Condition& given : {forward_, backward_}) {
    const double sign = given.direction == design::Direction::kForward ? 1.0 : -1.0;
    for (const double celsius : {10.0, 30.0, 55.0}) {
      Condition c = given;
      c.temperature_K = 273.15 + celsius;
      const double expected = sign * kPerKelvin * (celsius - kReference_c);
      EXPECT_NEAR(torque(c, warming) - torque(c), expected, kRounding) << celsius;
      EXPECT_NEAR(torque(c, with_zero) - torque(c), expected + sign * kOffset, kRounding);
      c.rotation = -c.rotation;
      EXPECT_NEAR(torque(c, warming) - torque(c), -expected, kRounding) << celsius;
      c.reference_sensor = true;
      EXPECT_EQ(torque(c, warming), torque(c));
    }
    Condition unknown = given;
    unknown.temperature_K = kUnknown;
    EXPECT_EQ(torque(unknown, warming), torque(unknown));
  }
}

TEST_F(OnTransmission, RunStepActsFromASessionOnOrUntilThere) {
  const auto step = [](const char* form, const char* constant, double value) {
    return one("run_step", with_constants(form, {{.name = constant, .unit = "", .value = value}}),
               {0.01});
  };
  for (Condition c : {forward_, backward_}) {
    c.rotation = -1;
    const double sensor = c.direction == design::Direction::kForward ? -0.01 : 0.01;
    for (int run = 0; run < 4; ++run) {
      c.run = run;
      c.time_s = 100.0 * run;
      const bool later = run >= 2;
      const auto change = [&](const Hypothesis& h) { return torque(c, h) - torque(c); };
      EXPECT_NEAR(change(step("from", "first_run", 2.0)), later ? 0.01 : 0.0, kRounding);
      EXPECT_NEAR(change(step("until", "first_run", 2.0)), later ? 0.0 : 0.01, kRounding);
      EXPECT_NEAR(change(step("sensor_from", "first_run", 2.0)), later ? sensor : 0.0, kRounding);
      EXPECT_NEAR(change(step("sensor_until", "first_run", 2.0)), later ? 0.0 : sensor, kRounding);
      EXPECT_NEAR(change(step("from", "instant", 150.0)), later ? 0.01 : 0.0, kRounding);
    }
  }
}

TEST_F(OnTransmission, DriftGrowsLevelsOffOrDiesAway) {
  const auto drift = [](const char* form, double time_constant) {
    return one(
        "drift",
        with_constants(form, {{.name = "start", .unit = "s", .value = 1000.0},
                              {.name = "span", .unit = "s", .value = 400.0},
                              {.name = "time_constant", .unit = "s", .value = time_constant}}),
        {0.02});
  };
  const auto change = [&](double time_s, const Hypothesis& h) {
    Condition c = backward_;
    c.time_s = time_s;
    return (torque(c, h) - torque(c)) / 0.02;
  };
  constexpr double kShare = 1e-11;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double t = 1000.0 + 400.0 * share;
    EXPECT_NEAR(change(t, drift("linear_time", 400.0)), share, kShare);
    EXPECT_NEAR(change(t, drift("centred_time", 400.0)), share - 0.5, kShare);
  }
  // At one time constant: 1 − 1/e and 1/e, 0.63212 and 0.36788 in five digits.
  EXPECT_NEAR(change(1100.0, drift("levelling_time", 100.0)), 0.63212, 5e-6);
  EXPECT_NEAR(change(1100.0, drift("dying_time", 100.0)), 0.36788, 5e-6);
  EXPECT_NEAR(change(1000.0, drift("levelling_time", 100.0)), 0.0, kShare);
  EXPECT_NEAR(change(1000.0, drift("dying_time", 100.0)), 1.0, kShare);
  Condition timeless = forward_;
  EXPECT_EQ(torque(timeless, drift("linear_time", 400.0)), torque(timeless));
}

TEST_F(OnTransmission, WavesOverTheAngleAreConstantOrGrowWithTheTorque) {
  for (const char* id : {"runout", "mesh_order"}) {
    const auto wave = [&](const char* form, double cosine, double sine) {
      return one(id, {.name = form, .body = "sun", .order = 8.0}, {cosine, sine});
    };
    for (Condition c : {forward_, backward_}) {
      const double without = torque(c);
      const auto change = [&](double turn, const Hypothesis& h) {
        c.output_angle_rad = 2.0 * std::numbers::pi * turn;
        return torque(c, h) - without;
      };
      // Order 8: a cosine is at its top after 0 and 1/8 of a turn and at its bottom after 1/16; a
      // sine at its top after 1/32.
      const double constant = 0.003;
      const double share = 0.02;
      for (const auto& [turn, top] :
           {std::pair{0.0, 1.0}, std::pair{1.0 / 16.0, -1.0}, std::pair{3.125, 1.0}}) {
        EXPECT_NEAR(change(turn, wave("constant", constant, 0.0)), top * constant, 1e-13);
        EXPECT_NEAR(change(turn, wave("proportional", share, 0.0)), top * share * without, 1e-13);
      }
      EXPECT_NEAR(change(1.0 / 32.0, wave("constant", 0.0, constant)), constant, 1e-13);
      EXPECT_NEAR(change(1.0 / 32.0, wave("proportional", 0.0, share)), share * without, 1e-13);
      // A torque at the sun has to be brought forward, and is won backward.
      const double sign = c.direction == design::Direction::kForward ? 1.0 : -1.0;
      EXPECT_NEAR(change(0.0, wave("drag", constant, 0.0)), sign * constant, 1e-13);
    }
  }
}

// A black box knows ratio and efficiencies only.

TEST(OnABlackBox, FrictionIsThatOfItsEfficiencies) {
  const BlackBox box = some_black_box();
  const Simulation simulation(box, Kind::kTransmission);
  const Condition f{.sun_speed_rad_s = 60.0, .output_torque_Nm = 20.0};
  Condition b = f;
  b.direction = design::Direction::kBackward;
  const double lossless = 20.0 / (5967.0 / 62.0);
  EXPECT_NEAR(simulated(simulation, f), lossless / 0.85, kRounding);
  EXPECT_NEAR(simulated(simulation, b), lossless * 0.8, kRounding);
  // Twice the friction: twice what is lost of the torque.
  const Hypothesis twice = one("friction_level", {.name = "coefficient"}, {1.0});
  EXPECT_NEAR(simulated(simulation, f, twice) - lossless, 2.0 * (lossless / 0.85 - lossless),
              kRounding);
  EXPECT_NEAR(lossless - simulated(simulation, b, twice), 2.0 * 0.2 * lossless, kRounding);
  const Hypothesis drag = one("drag_constant", {.name = "sun", .body = "sun"}, {0.01});
  EXPECT_NEAR(simulated(simulation, f, drag) - simulated(simulation, f), 0.01, kRounding);
  EXPECT_NEAR(simulated(simulation, b, drag) - simulated(simulation, b), -0.01, kRounding);
  // A seal at the output is more load forward, and less drive backward.
  const Hypothesis seal = one("drag_constant", {.name = "output", .body = "output"}, {1.5});
  EXPECT_NEAR(simulated(simulation, f, seal), 21.5 / (5967.0 / 62.0) / 0.85, kRounding);
  EXPECT_NEAR(simulated(simulation, b, seal), 18.5 / (5967.0 / 62.0) * 0.8, kRounding);
  // What a bearing at the output takes is a share of the load that the gears carry more or less.
  const Hypothesis bearing =
      one("bearing_load", {.name = "output_bearing", .body = "output"}, {0.02});
  EXPECT_NEAR(simulated(simulation, f, bearing), lossless * 1.02 / 0.85, kRounding);
  EXPECT_NEAR(simulated(simulation, b, bearing), lossless * 0.98 * 0.8, kRounding);
  // One that grows with the root of the load: half its share at a quarter of the greatest.
  const Hypothesis growing =
      one("bearing_load",
          {.name = "output_bearing_any_exponent",
           .constants = {{.name = "top_torque", .unit = "Nm", .value = 80.0}},
           .body = "output"},
          {0.04, 0.5});
  EXPECT_NEAR(simulated(simulation, f, growing), lossless * 1.02 / 0.85, kRounding);
  EXPECT_NEAR(simulated(simulation, b, growing), lossless * 0.98 * 0.8, kRounding);
}

// Lost motion

class OnLostMotion : public testing::TestWithParam<Kind> {
 protected:
  OnLostMotion() : simulation_(design_of(rig::bilateral_drive_gear()), GetParam()) {}
  [[nodiscard]] double arcmin(const Condition& c, const Hypothesis& h = {}) const {
    return simulated(simulation_, c, h) / kArcmin;
  }
  Simulation simulation_;
  const Condition row_{.test_torque_Nm = 3.0, .temperature_K = 293.15};
  static constexpr double kAngle = 1e-11;  // arcmin
};

TEST_P(OnLostMotion, WithoutCausesIsThatOfTheRig) {
  EXPECT_NEAR(arcmin(row_),
              rig::lost_motion_arcmin(rig::bilateral_drive_gear(),
                                      {.output_torque_Nm = 3.0, .temperature_c = 20.0}),
              1e-6);
}

TEST_P(OnLostMotion, ClearanceAddsToIt) {
  const Hypothesis h = one("clearance", {.name = "constant"}, {2.5}, GetParam());
  EXPECT_NEAR(arcmin(row_, h) - arcmin(row_), 2.5, kAngle);
}

TEST_P(OnLostMotion, ComplianceAddsTwiceTheTestTorque) {
  const Hypothesis h = one("compliance", {.name = "output"}, {0.4}, GetParam());
  EXPECT_NEAR(arcmin(row_, h) - arcmin(row_), 2.0 * 3.0 * 0.4, kAngle);
  Condition none = row_;
  none.test_torque_Nm = 0.0;
  EXPECT_EQ(arcmin(none, h), arcmin(none));
}

TEST_P(OnLostMotion, TwoStagesAreSoftUpToATorque) {
  const Form form =
      with_constants("two_stage", {{.name = "soft_torque", .unit = "Nm", .value = 2.0},
                                   {.name = "torque_half_range", .unit = "", .value = 1.0}});
  const Hypothesis h = one("compliance", form, {0.4, 1.5, std::log(2.0)}, GetParam());
  const auto wound = [&](double torque_Nm) {
    Condition c = row_;
    c.test_torque_Nm = torque_Nm;
    return arcmin(c, h) - arcmin(c);
  };
  // Up to 4 N m both stages give way, beyond it the stiff one alone.
  EXPECT_NEAR(wound(1.0), 0.8 + 1.5 / 4.0, kAngle);
  EXPECT_NEAR(wound(4.0), 3.2 + 1.5, kAngle);
  EXPECT_NEAR(wound(6.0), 4.8 + 1.5, kAngle);
  EXPECT_NEAR(wound(0.0), 0.0, kAngle);
}

TEST_P(OnLostMotion, SeveralStagesAreSoftUpToTheirTorques) {
  const Form form =
      with_constants("any_stages", {{.name = "soft_torque_1", .unit = "Nm", .value = 2.0},
                                    {.name = "soft_torque_2", .unit = "Nm", .value = 5.0}});
  const Hypothesis h = one("compliance", form, {0.1, 1.5, 2.5}, GetParam());
  const auto wound = [&](double torque_Nm) {
    Condition c = row_;
    c.test_torque_Nm = torque_Nm;
    return arcmin(c, h) - arcmin(c);
  };
  // Slopes of 0.2 + 0.75 + 0.5, then 0.2 + 0.5, then 0.2 arcmin/Nm.
  EXPECT_NEAR(wound(1.0), 1.45, kAngle);
  EXPECT_NEAR(wound(2.0), 2.9, kAngle);
  EXPECT_NEAR(wound(4.0), 2.9 + 2.0 * 0.7, kAngle);
  EXPECT_NEAR(wound(5.0), 2.9 + 3.0 * 0.7, kAngle);
  EXPECT_NEAR(wound(9.0), 5.0 + 4.0 * 0.2, kAngle);
}

TEST_P(OnLostMotion, APreloadMakesTheWindUpGoWithTheLogarithmOfTheTorque) {
  const Form form =
      with_constants("preloaded", {{.name = "preload_torque", .unit = "Nm", .value = 0.5},
                                   {.name = "torque_half_range", .unit = "", .value = 2.0},
                                   {.name = "hardening_torque", .unit = "Nm", .value = 7.0}});
  const Hypothesis h = one("compliance", form, {0.4, std::log(2.0)}, GetParam());
  const auto wound = [&](double torque_Nm) {
    Condition c = row_;
    c.test_torque_Nm = torque_Nm;
    return arcmin(c, h) - arcmin(c);
  };
  // A preload of 1 N m: from 0 to 1 N m as far as from 1 to 3 and from 3 to 7.
  EXPECT_NEAR(wound(7.0), 2.0 * 7.0 * 0.4, kAngle);
  EXPECT_NEAR(wound(1.0), wound(7.0) / 3.0, kAngle);
  EXPECT_NEAR(wound(3.0), wound(7.0) * 2.0 / 3.0, kAngle);
  EXPECT_NEAR(wound(0.0), 0.0, kAngle);
}

TEST_P(OnLostMotion, ADriftOfFreeScaleTellsWhatMovesFromTheFirstToTheLastRow) {
  const std::map<std::string, std::vector<double>> values{
      {"levelling_any_scale_time", {22.0, 3.0}},
      {"levelling_any_scale_any_start_time", {22.0, 3.0, 1.5}},
      {"logarithmic_any_scale_time", {2.0, -1.0}},
      {"onset_any_scale_any_exponent_time", {4.0, 1.0, 0.7}}};
  for (const auto& [name, value] : values) {
    const Form form =
        with_constants(name.c_str(), {{.name = "start", .unit = "s", .value = 1000.0},
                                      {.name = "span", .unit = "s", .value = 400.0},
                                      {.name = "time_constant", .unit = "s", .value = 120.0}});
    const Hypothesis h = one("drift", form, value, GetParam());
    const auto at = [&](double time_s) {
      Condition c = row_;
      c.time_s = time_s;
      return arcmin(c, h);
    };
    const std::vector<Scalar> p(value.begin(), value.end());
    const auto derived = find_cause("drift")->derived(form, p, simulation_, {});
    ASSERT_EQ(derived.size(), 1U) << name;
    EXPECT_EQ(derived[0].record.name, "change_over_data");
    EXPECT_EQ(derived[0].record.unit, "arcmin");
    EXPECT_NEAR(derived[0].value.a, at(1400.0) - at(1000.0), 1e-9) << name;
  }
  const Form plain =
      with_constants("linear_time", {{.name = "start", .unit = "s", .value = 0.0},
                                     {.name = "span", .unit = "s", .value = 1.0},
                                     {.name = "time_constant", .unit = "s", .value = 1.0}});
  EXPECT_TRUE(find_cause("drift")
                  ->derived(plain, std::vector<Scalar>(1, Scalar(2.0)), simulation_, {})
                  .empty());
}

TEST_P(OnLostMotion, AStepIsInArcminutes) {
  const Hypothesis h =
      one("run_step", with_constants("from", {{.name = "first_run", .unit = "", .value = 1.0}}),
          {1.5}, GetParam());
  Condition later = row_;
  later.run = 1;
  EXPECT_NEAR(arcmin(later, h) - arcmin(later), 1.5, kAngle);
}

INSTANTIATE_TEST_SUITE_P(Kinds, OnLostMotion,
                         testing::Values(Kind::kLostMotion, Kind::kTorqueAngle));

TEST(OnHousing, ThermalExpansionMovesTheAxesApart) {
  const rig::Gearbox gearbox = rig::bilateral_drive_gear();
  const design::Design design = design_of(gearbox);
  const Simulation simulation(design, Kind::kLostMotion);
  const Hypothesis h =
      one("thermal_expansion",
          with_constants("from_design",
                         {{.name = "reference_temperature", .unit = "c", .value = 20.0}}),
          {40.0}, Kind::kLostMotion);
  for (const double celsius : {-10.0, 20.0, 60.0}) {
    const Condition c{.test_torque_Nm = 1.0, .temperature_K = celsius + 273.15};
    // As `analyze` says of a gearbox whose centre distance is that of the temperature.
    design::Design warm = design;
    warm.train.center_distance_m *= 1.0 + 40e-6 * (celsius - 20.0);
    const auto evaluation = design::evaluate(warm);
    const double expected = std::get<design::Evaluation>(evaluation).lost_motion.kinematic_rad;
    EXPECT_NEAR(simulated(simulation, c, h), expected, 1e-14);
    // And as the rig does, from tooth thicknesses.
    EXPECT_NEAR(
        simulated(simulation, c, h) / kArcmin,
        rig::lost_motion_arcmin(gearbox, {.output_torque_Nm = 1.0, .temperature_c = celsius},
                                {{.id = "thermal_expansion", .amplitude = 40e-6}}),
        1e-6);
  }
  // The internal meshes lose more backlash than the external one gains.
  const Condition warm{.temperature_K = 333.15};
  EXPECT_LT(simulated(simulation, warm, h), simulated(simulation, warm));
}

// Pairs

class OnPairs : public testing::Test {
 protected:
  OnPairs() : simulation_(pair_of(design_of(rig::bilateral_drive_gear())), Kind::kPairLoss) {}
  [[nodiscard]] double loss(const Condition& c, const std::string& id, const char* form,
                            double value) const {
    return simulated(simulation_, c, one(id, {.name = form}, {value}, Kind::kPairLoss));
  }
  Simulation simulation_;
  const Condition down_{.driving_teeth = 20, .driven_teeth = 80};
  const Condition up_{.driving_teeth = 80, .driven_teeth = 20};
};

TEST_F(OnPairs, LossIsProportionalToFriction) {
  for (const Condition& c : {down_, up_}) {
    const double without = simulated(simulation_, c);
    EXPECT_NEAR(loss(c, "friction_level", "coefficient", 0.5), 1.5 * without, 1e-15);
    const double rig =
        rig::pair_loss(rig::bilateral_drive_gear(), 1.0,
                       {.driving_teeth = c.driving_teeth, .driven_teeth = c.driven_teeth},
                       {{.id = "friction_level", .amplitude = 0.5}});
    EXPECT_NEAR(loss(c, "friction_level", "coefficient", 0.5), rig, 1e-6 * rig);
  }
}

TEST_F(OnPairs, DrivingFromTheOtherSideSwapsApproachAndRecess) {
  for (const double s : {0.3, -0.3, 1.5}) {
    EXPECT_NEAR(loss(down_, "friction_direction", "approach", s),
                loss(up_, "friction_direction", "recess", s), 1e-14);
    EXPECT_NEAR(loss(down_, "friction_direction", "approach_recess", s),
                loss(up_, "friction_direction", "approach_recess", -s), 1e-14);
    // Both sides together are the level.
    const double without = simulated(simulation_, down_);
    const double sides = loss(down_, "friction_direction", "approach", s) - without +
                         loss(down_, "friction_direction", "recess", s) - without;
    EXPECT_NEAR(sides, s * without, 0.02 * std::abs(s) * without);
  }
}

TEST_F(OnPairs, FrictionMayDifferWithTheGearThatDrives) {
  const auto change = [&](const char* form, int driving, int driven) {
    const Condition c{.driving_teeth = driving, .driven_teeth = driven};
    const Hypothesis h =
        one("friction_direction", {.name = form, .law = kOnFriction}, {0.2}, Kind::kPairLoss);
    return simulated(simulation_, c, h) / simulated(simulation_, c) - 1.0;
  };
  // The loss of the first-order model is proportional to friction.
  constexpr double kRelative = 1e-12;
  EXPECT_NEAR(change("driving_pinion_gear", 20, 40), 0.2, kRelative);
  EXPECT_NEAR(change("driving_pinion_gear", 40, 20), -0.2, kRelative);
  EXPECT_NEAR(change("driving_pinion_gear", 30, 30), 0.0, kRelative);
  EXPECT_NEAR(change("driving_pinion", 20, 40), 0.2, kRelative);
  EXPECT_NEAR(change("driving_pinion", 40, 20), 0.0, kRelative);
  EXPECT_NEAR(change("driving_gear", 20, 40), 0.0, kRelative);
  EXPECT_NEAR(change("driving_gear", 40, 20), 0.2, kRelative);
}

TEST_F(OnPairs, BearingsAddAndGainMultipliesTheEfficiency) {
  const double without = simulated(simulation_, down_);
  EXPECT_NEAR(loss(down_, "bearing_load", "shafts", 0.01) - without, 0.01, 1e-15);
  EXPECT_NEAR(1.0 - loss(down_, "sensor_gain", "gain", -0.02), 0.98 * (1.0 - without), 1e-15);
}

TEST_F(OnPairs, BearingsMayGrowWithTheirGears) {
  Condition c = down_;
  c.module_m = 2e-3;  // radii of 20 and 80 mm
  const auto lost = [&](double exponent) {
    const Form form = with_constants("both_shafts_any_size",
                                     {{.name = "reference_radius", .unit = "mm", .value = 40.0}});
    const Hypothesis h = one("bearing_load", form, {0.08, exponent}, Kind::kPairLoss);
    return simulated(simulation_, c, h) - simulated(simulation_, c);
  };
  // All of one size, as wide as the gears have it, and between the two: 2^(−1/2) and 2^(1/2) times.
  EXPECT_NEAR(lost(0.0), 0.08 / 20.0 + 0.08 / 80.0, 1e-15);
  EXPECT_NEAR(lost(1.0), 2.0 * 0.08 / 40.0, 1e-15);
  EXPECT_NEAR(lost(0.5), 0.08 / 20.0 * std::sqrt(0.5) + 0.08 / 80.0 * std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(lost(0.0), loss(c, "bearing_load", "both_shafts", 0.08) - simulated(simulation_, c),
              1e-15);
}

}  // namespace
}  // namespace gear3k::calibrate::causes_test
