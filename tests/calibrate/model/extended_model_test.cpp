#include "calibrate/model/extended_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "calibrate/causes/form_catalogue.hpp"
#include "calibrate/model/model_range.hpp"

namespace gear3k::calibrate::extended_model_test {
namespace {

AppliedCause applied(const char* id, const char* form, std::vector<double> value) {
  AppliedCause cause{.id = id, .form = {}, .value = std::move(value)};
  cause.form.name = form;
  return cause;
}

ExtendedModel transmission(std::vector<AppliedCause> causes) {
  ExtendedModel model;
  model.kind = Kind::kTransmission;
  model.causes = std::move(causes);
  model.fingerprint = 7;
  return model;
}

TEST(ExtensionOf, HoldsWhatTheCausesChangeInTheGearbox) {
  AppliedCause load = applied("friction_load", "about_middle", {-0.15});
  load.form.constants = {{.name = "reference_load", .unit = "N", .value = 80.0}};
  ExtendedModel lost_motion;
  lost_motion.kind = Kind::kLostMotion;
  lost_motion.causes = {applied("clearance", "constant", {3.0})};
  const auto e = extension_of({transmission({applied("friction_level", "coefficient", {0.2}), load,
                                             applied("drag_constant", "sun", {0.01}),
                                             applied("drag_constant", "output", {0.3}),
                                             applied("bearing_load", "planet_bearings", {0.5})}),
                               lost_motion});
  EXPECT_NEAR(e.friction.level, 1.2, 1e-15);
  EXPECT_EQ(e.friction.load_exponent, -0.15);
  EXPECT_EQ(e.friction.reference_force_N, 80.0);
  EXPECT_EQ(e.drag[design::kSunShaft].constant_Nm, 0.01);
  EXPECT_EQ(e.drag[design::kOutputShaft].constant_Nm, 0.3);
  EXPECT_NEAR(e.planet_bearing_arm_m, 0.5e-3, 1e-18);
  EXPECT_NEAR(e.lost_motion.clearance_rad, 3.0 * std::numbers::pi / 180.0 / 60.0, 1e-18);
}

TEST(ExtensionOf, SensorAndProcedureLeaveTheGearboxAsItIs) {
  const auto model = transmission(
      {applied("sensor_gain", "gain", {0.1}), applied("sensor_offset", "offset", {0.02})});
  const auto e = extension_of({model});
  EXPECT_EQ(e.friction.level, 1.0);
  EXPECT_FALSE(needs_operating_point(e));
  for (const auto& cause : model.causes) EXPECT_FALSE(changes_gearbox(cause, model.kind));
  EXPECT_TRUE(changes_gearbox(applied("drag_viscous", "sun", {1e-4}), Kind::kTransmission));
}

TEST(ApplyModel, AppliesOneCauseAfterTheOther) {
  Modification m;
  apply_model(transmission({applied("friction_level", "coefficient", {0.5}),
                            applied("friction_level", "coefficient", {0.2}),
                            applied("sensor_offset", "offset", {0.02})}),
              {}, Kind::kTransmission, m);
  EXPECT_NEAR(m.gearbox.friction.level.a, 1.8, 1e-15);
  EXPECT_EQ(m.sensor_offset.a, 0.02);
}

/// What a cause adds to a reading of any time and session, as its campaign left it.
double left_behind(AppliedCause cause, std::vector<FormConstant> constants,
                   Kind kind = Kind::kTransmission, Kind of_model = Kind::kTransmission) {
  cause.form.constants = std::move(constants);
  ExtendedModel model = transmission({std::move(cause)});
  model.kind = of_model;
  std::vector<double> added;
  for (const int run : {-1, 0, 7}) {
    for (const double time_s : {kUnknown, 0.0, 1e6}) {
      Condition condition;
      condition.run = run;
      condition.time_s = condition.cycles = time_s;
      Modification m;
      apply_model(model, condition, kind, m);
      added.push_back(m.added.a);
    }
  }
  EXPECT_EQ(std::ranges::count(added, added.front()), std::ssize(added));
  return added.front();
}

TEST(ApplyModel, StepsStayAsInTheLastSession) {
  const std::vector<FormConstant> second{{.name = "first_run", .unit = "", .value = 1.0}};
  EXPECT_EQ(left_behind(applied("run_step", "from", {0.5}), second), 0.5);
  EXPECT_EQ(left_behind(applied("run_step", "until", {0.5}), second), 0.0);
  EXPECT_EQ(left_behind(applied("run_step", "only", {0.5}), second), 0.0);
  const std::vector<FormConstant> noon{{.name = "instant", .unit = "s", .value = 500.0}};
  EXPECT_EQ(left_behind(applied("run_step", "from", {0.5}), noon), 0.5);
}

TEST(ApplyModel, OfTwoSessionsWithAStepTheMeanIsExpected) {
  const std::vector<FormConstant> of_two{{.name = "first_run", .unit = "", .value = 1.0},
                                         {.name = "sessions", .unit = "", .value = 2.0}};
  EXPECT_EQ(left_behind(applied("run_step", "from", {0.5}), of_two), 0.25);
  EXPECT_EQ(left_behind(applied("run_step", "until", {0.5}), of_two), 0.25);
}

/// Root mean square by which a third session misses the last of two, and their mean.
struct Missed {
  double last = 0.0, mean = 0.0;
};
Missed missed_by_a_third(double drawn_anew, double stays) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 20000;
  Missed squares;
  for (int k = 0; k < kDraws; ++k) {
    const double change = stays * normal(generator);
    const double one = drawn_anew * normal(generator);
    const double two = change + drawn_anew * normal(generator);
    const double three = change + drawn_anew * normal(generator);
    const auto behind = [&](std::vector<FormConstant> constants) {
      return one + left_behind(applied("run_step", "from", {two - one}), std::move(constants));
    };
    const FormConstant second{.name = "first_run", .unit = "", .value = 1.0};
    const double last = behind({second}) - three;
    const double mean = behind({second, {.name = "sessions", .unit = "", .value = 2.0}}) - three;
    squares.last += last * last / kDraws;
    squares.mean += mean * mean / kDraws;
  }
  return {.last = std::sqrt(squares.last), .mean = std::sqrt(squares.mean)};
}

TEST(ApplyModel, TheMeanOfTwoSessionsIsNoWorseThanOneRefittedValueWhateverIsTrue) {
  // A refitted value is the mean of the rows of both.  Drawn anew: √(1 + 1/2) of their deviation,
  // the last √2 (2 % for the draws).
  const Missed anew = missed_by_a_third(1.0, 0.0);
  EXPECT_NEAR(anew.mean, std::sqrt(1.5), 0.025);
  EXPECT_NEAR(anew.last, std::sqrt(2.0), 0.03);
  // That stays: half the step.
  const Missed stays = missed_by_a_third(0.0, 1.0);
  EXPECT_NEAR(stays.mean, 0.5, 0.01);
  EXPECT_EQ(stays.last, 0.0);
}

TEST(ApplyModel, AnotherSessionIsExpectedAtTheMeanOfSessions) {
  EXPECT_EQ(left_behind(applied("run_step", "sessions", {0.5, -0.25, 1.25}),
                        {{.name = "sessions", .unit = "", .value = 3.0}}),
            0.5);
}

TEST(ApplyModel, DriftStaysAsAtTheEnd) {
  const std::vector<FormConstant> hour{{.name = "start", .unit = "s", .value = 100.0},
                                       {.name = "span", .unit = "s", .value = 3600.0},
                                       {.name = "time_constant", .unit = "s", .value = 1800.0}};
  EXPECT_NEAR(left_behind(applied("drift", "linear_time", {0.5}), hour), 1.0, 1e-15);
  EXPECT_NEAR(left_behind(applied("drift", "levelling_time", {0.5}), hour),
              0.5 * (1.0 - std::exp(-2.0)), 1e-15);
  EXPECT_NEAR(left_behind(applied("drift", "dying_time", {0.5}), hour), 0.5 * std::exp(-2.0),
              1e-15);
  // Loops of torque and angle, and rows of lost motion, are of one response [arcmin].
  const double arcmin = std::numbers::pi / 180.0 / 60.0;
  EXPECT_NEAR(left_behind(applied("drift", "linear_time", {0.5}), hour, Kind::kLostMotion,
                          Kind::kTorqueAngle),
              arcmin, 1e-15);
  EXPECT_EQ(left_behind(applied("drift", "linear_time", {0.5}), hour, Kind::kLostMotion,
                        Kind::kTransmission),
            0.0);
}

TEST(ApplyModel, AStatedChangeIsWhatLaterRowsMeet) {
  const std::vector<FormConstant> second{{.name = "first_run", .unit = "", .value = 1.0}};
  const std::vector<FormConstant> noon{{.name = "instant", .unit = "s", .value = 500.0}};
  const std::vector<FormConstant> hour{{.name = "start", .unit = "s", .value = 100.0},
                                       {.name = "span", .unit = "s", .value = 3600.0},
                                       {.name = "time_constant", .unit = "s", .value = 1800.0}};
  const auto changed = [&](AppliedCause cause) {
    cause.left_behind = 0.3;
    return cause;
  };
  EXPECT_EQ(left_behind(changed(applied("run_step", "from", {0.5})), second), 0.3);
  EXPECT_EQ(left_behind(changed(applied("run_step", "until", {0.5})), noon), 0.3);
  EXPECT_EQ(left_behind(changed(applied("run_step", "sessions_gain", {0.5, 0.1, 0.2})),
                        {{.name = "sessions", .unit = "", .value = 3.0}}),
            0.3);
  EXPECT_EQ(left_behind(changed(applied("drift", "linear_time", {0.5})), hour), 0.3);
  AppliedCause of_gain = changed(applied("drift", "linear_cycles_friction", {0.5}));
  of_gain.form.constants = hour;
  of_gain.left_behind_on = kOnGain;
  Modification m;
  apply_model(transmission({of_gain}), {}, Kind::kTransmission, m);
  EXPECT_EQ(m.sensor_gain.a, 1.3);
  EXPECT_EQ(m.friction_level.a, 1.0);
}

TEST(ApplyModel, AnotherKindOfMeasurementSharesTheGearboxNotTheSensor) {
  Modification m;
  apply_model(transmission({applied("friction_level", "coefficient", {0.5}),
                            applied("sensor_gain", "gain", {0.1})}),
              {}, Kind::kLostMotion, m);
  EXPECT_NEAR(m.gearbox.friction.level.a, 1.5, 1e-15);
  EXPECT_EQ(m.sensor_gain.a, 1.0);
}

TEST(ApplyModel, RefusesUnknownCausesAndNumbersOfParameters) {
  Modification m;
  EXPECT_THROW(
      apply_model(transmission({applied("no_such_cause", "x", {1.0})}), {}, Kind::kTransmission, m),
      std::invalid_argument);
  EXPECT_THROW(apply_model(transmission({applied("friction_level", "coefficient", {1.0, 2.0})}), {},
                           Kind::kTransmission, m),
               std::invalid_argument);
}

TEST(FileKey, IsLowerCaseWithTheUnit) {
  EXPECT_EQ(file_key("torque", "Nm"), "torque_nm");
  EXPECT_EQ(file_key("share", ""), "share");
  EXPECT_EQ(file_key("coefficient", "1/K"), "coefficient_per_k");
  EXPECT_EQ(file_key("compliance", "arcmin/Nm"), "compliance_arcmin_per_nm");
  EXPECT_EQ(file_key("expansion", "um/m/K"), "expansion_um_per_m_per_k");
  EXPECT_EQ(file_key("sun_speed", "rpm"), "sun_speed_rpm");
}

TEST(FormCatalogue, EveryCauseHasFormsWithKeysOfTheirOwn) {
  for (const Cause* cause : causes()) {
    std::size_t forms = 0;
    for (const Kind kind :
         {Kind::kTransmission, Kind::kLostMotion, Kind::kTorqueAngle, Kind::kPairLoss}) {
      for (const CatalogueForm& known : form_catalogue(*cause, kind)) {
        ++forms;
        Form form;
        form.name = known.name;
        std::vector<std::string> keys{"form", "body", "order"};
        for (const auto& parameter : cause->parameters(form, kind)) {
          keys.push_back(file_key(parameter.name, parameter.unit));
          keys.push_back(keys.back() + "_sd");
        }
        for (const auto& constant : known.constants) {
          keys.push_back(file_key(constant.name, constant.unit));
        }
        std::sort(keys.begin(), keys.end());
        EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end())
            << cause->id << ' ' << known.name;
      }
    }
    EXPECT_GT(forms, 0U) << cause->id;
  }
}

TEST(OutsideRange, NamesEachQuantityAndByHowMuch) {
  ExtendedModel model = transmission({});
  model.range = {{.name = "sun_speed", .unit = "rpm", .low = 200.0, .high = 1000.0},
                 {.name = "output_torque", .unit = "nm", .low = 5.0, .high = 50.0},
                 {.name = "temperature", .unit = "c", .low = kUnknown, .high = kUnknown}};
  const auto point = [](double rpm, double torque_Nm) {
    return design::OperatingPoint<double>{.sun_speed_rad_s = rpm * std::numbers::pi / 30.0,
                                          .output_torque_Nm = torque_Nm};
  };
  EXPECT_TRUE(outside_range({model}, {.where = "x", .low = point(200, 5), .high = point(1000, 50)})
                  .empty());
  const auto notes =
      outside_range({model}, {.where = "the grid", .low = point(100, 5), .high = point(1500, 60)});
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_NE(notes[0].find("by 100 rpm below and by 500 rpm above"), std::string::npos) << notes[0];
  EXPECT_NE(notes[1].find("by 10 Nm above"), std::string::npos) << notes[1];
  MeasurementSet data;
  data.kind = Kind::kTransmission;
  for (const double temperature_C : {21.0, 27.0}) {
    Observation row;
    row.condition.sun_speed_rad_s = 600.0 * std::numbers::pi / 30.0;
    row.condition.output_torque_Nm = 20.0;
    row.condition.temperature_K = 273.15 + temperature_C;
    data.rows.push_back(row);
  }
  EXPECT_TRUE(outside_range({model}, data).empty());
  ExtendedModel warm = model;
  warm.range[2] = {.name = "temperature", .unit = "c", .low = 21.0, .high = 21.8};
  const auto of_data = outside_range({warm}, data);
  ASSERT_EQ(of_data.size(), 1U);
  EXPECT_NE(of_data[0].find("these data: "), std::string::npos) << of_data[0];
  EXPECT_NE(of_data[0].find("by 5.2 C above"), std::string::npos) << of_data[0];
  // Another kind of data is measured under other conditions.
  data.kind = Kind::kLostMotion;
  EXPECT_TRUE(outside_range({warm}, data).empty());
  const auto middle = middle_of_range({model});
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->sun_speed_rad_s, 600.0 * std::numbers::pi / 30.0, 1e-12);
  EXPECT_EQ(middle->output_torque_Nm, 27.5);
  EXPECT_EQ(middle->temperature_K, 293.15);
}

}  // namespace
}  // namespace gear3k::calibrate::extended_model_test
