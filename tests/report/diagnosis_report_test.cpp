#include "report/diagnosis_report.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/property_tree/xml_parser.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "io/text/csv_table.hpp"
#include "io/text/gnuplot.hpp"
#include "report/condition_columns.hpp"
#include "report/diagnosis_plot.hpp"

namespace gear3k::report::diagnosis_report_test {
namespace {

using calibrate::Condition, calibrate::Diagnosis, calibrate::Effect, calibrate::Kind,
    calibrate::kUnknown, calibrate::MeasurementSet, calibrate::Verdict;
using nlohmann::json;

constexpr double kRpm = std::numbers::pi / 30.0;
constexpr double kArcmin = std::numbers::pi / 10800.0;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

struct Case {
  std::vector<Diagnosis> diagnoses;
  std::vector<MeasurementSet> sets;
  [[nodiscard]] std::string table() const { return diagnosis_table(diagnoses, sets); }
  [[nodiscard]] json as_json() const { return json::parse(diagnosis_json(diagnoses, sets).text()); }
};

/// Eight rows whose mean sun torque is 0.5 Nm; the simulation lacks 0.021 Nm of drag.
Case dragged() {
  MeasurementSet set;
  set.kind = Kind::kTransmission;
  set.files = {"a.csv"};
  set.runs = {"Monday", "Tuesday"};
  set.fingerprint = 0xabcU;
  Diagnosis d;
  d.subject = "gear";
  for (int k = 0; k < 8; ++k) {
    Condition c;
    c.direction = k % 2 == 0 ? design::Direction::kForward : design::Direction::kBackward;
    c.sun_speed_rad_s = (200.0 + 100.0 * k) * kRpm;
    c.output_torque_Nm = 5.0 + 5.0 * k;
    c.rotation = k < 4 ? 1 : -1;
    c.temperature_K = 298.15;
    c.run = k / 4;
    const double torque = 0.15 + 0.1 * k;
    set.rows.push_back({.condition = c, .response = torque, .file = 0, .line = 3 + k});
    d.rows.push_back({.baseline = torque - 0.021,
                      .extended = torque - 0.001,
                      .sigma = 0.003,
                      .holdout = torque - 0.002,
                      .block = k % 3});
  }
  d.verdict = Verdict::kExplained;
  Effect drag;
  drag.id = "drag_constant";
  drag.title = "load-independent drag";
  drag.form = {.name = "sun", .body = "sun"};
  drag.remedy = calibrate::Remedy::kDrag;
  drag.parameters = {{.name = "torque",
                      .unit = "Nm",
                      .value = 0.021,
                      .low = 0.019,
                      .high = 0.023,
                      .plausible_low = 0.0,
                      .plausible_high = 5.0}};
  drag.delta_bic = 42.5;
  drag.inclusion_frequency = 0.97;
  drag.probability = 0.875;
  drag.no_cause = 0.0625;
  drag.p_value = 1e-6;
  d.effects.push_back(drag);
  d.errors = {.baseline_train = 0.0205,
              .extended_train = 0.0031,
              .baseline_holdout = 0.02,
              .extended_holdout = 0.004,
              .noise_floor = 0.003};
  d.holdout_blocks = "load";
  d.extrapolation = {
      .along = "load", .left_out = 40.0, .rows = 1, .baseline = 0.0208, .extended = 0.0035};
  d.noise_source = calibrate::NoiseSource::kRepeats;
  d.repeat_degrees = 4;
  d.lack_of_fit.f = 30.0;
  d.lack_of_fit.p_value = 1e-5;
  d.lack_of_fit.degrees = 4;
  d.lack_of_fit.pure_degrees = 4;
  d.evidence = {{.id = "drag_constant", .delta_bic = 42.5, .evidence = 25.0},
                {.id = "friction_level", .delta_bic = -2.0, .evidence = 0.5}};
  d.covariates_before = {{.name = "load", .statistic = 20.0, .degrees = 3, .p_value = 2e-4}};
  d.covariates_after = {{.name = "load", .statistic = 2.0, .degrees = 3, .p_value = 0.57}};
  return {.diagnoses = {d}, .sets = {set}};
}

Case ambiguous() {
  Case c = dragged();
  Diagnosis& d = c.diagnoses[0];
  d.verdict = Verdict::kAmbiguous;
  d.effects[0].alternatives = {{.id = "sensor_offset",
                                .title = "offset of the torque sensor",
                                .form = {.name = "constant"},
                                .with_level = true,
                                .statistic = 0.3,
                                .parameters = {{.name = "offset",
                                                .unit = "Nm",
                                                .value = 7.0,
                                                .low = 6.9,
                                                .high = 7.1,
                                                .plausible = false,
                                                .plausible_low = -1.0,
                                                .plausible_high = 1.0}},
                                .remedy = calibrate::Remedy::kSensor}};
  calibrate::NextExperiment next;
  next.separates = {"drag_constant", "sensor_offset"};
  Condition proposed;
  proposed.sun_speed_rad_s = 600.0 * kRpm;
  proposed.output_torque_Nm = 5.0;
  proposed.rotation = -1;
  proposed.temperature_K = kUnknown;
  next.conditions = {{.condition = proposed, .repeats = 6}};
  next.expected_statistic = 25.0;
  next.advice = "Turn the other way.";
  d.next_experiment = next;
  return c;
}

TEST(DiagnosisTable, SaysInPercentHowFarOffTheSimulationIsAndWhy) {
  const std::string text = dragged().table();
  // 0.0205 and 0.003 of a mean of 0.5 Nm.
  EXPECT_TRUE(contains(text, "The simulation is 4.1 % off where noise is 0.6 %")) << text;
  EXPECT_TRUE(contains(text, "from 4 repeats")) << text;
  EXPECT_TRUE(contains(text, "Verdict: explained.")) << text;
  EXPECT_TRUE(contains(
      text, "Cause: load-independent drag at the sun: torque 0.0210 ± 0.0020 Nm. [drag_constant]"))
      << text;
  // 1 - 0.004/0.02.
  EXPECT_TRUE(contains(text, "80 % better")) << text;
  EXPECT_TRUE(contains(text, "beyond the fit, load 40 Nm (1 row)")) << text;
  EXPECT_TRUE(contains(text, "nothing beyond noise")) << text;
}

TEST(DiagnosisTable, TellsHowMuchTheModelsShapeLeavesBeyondRepeats) {
  Case c = dragged();
  EXPECT_TRUE(contains(c.table(), "as given: F(4, 4) = 30, p = 1e-05.\n")) << c.table();
  c.diagnoses[0].lack_of_model = {.f = 2.0, .p_value = 0.26, .degrees = 3, .pure_degrees = 4};
  EXPECT_TRUE(contains(c.table(), "; of the extended model: F(3, 4) = 2, p = 0.26.\n"))
      << c.table();
  c.diagnoses[0].lack_of_model.p_value = 1e-4;
  EXPECT_TRUE(contains(c.table(), "p = 0.0001: its shape leaves more than repeats differ by.\n"))
      << c.table();
}

TEST(DiagnosisTable, TellsAMinorRemainderFromNone) {
  Case c = dragged();
  c.diagnoses.front().remainder.minor = true;
  const std::string text = c.table();
  EXPECT_TRUE(contains(text, "Left over: more than noise makes")) << text;
  EXPECT_FALSE(contains(text, "nothing beyond noise")) << text;
}

TEST(DiagnosisTable, NamesWhatExplainsAsWellWithItsValueAndWhatIsImplausible) {
  const std::string text = ambiguous().table();
  EXPECT_TRUE(contains(text, "Verdict: ambiguous.")) << text;
  EXPECT_TRUE(contains(text, "sensor_offset: offset of the torque sensor")) << text;
  EXPECT_TRUE(contains(text, "offset 7.00 ± 0.10 Nm, with another coefficient of friction"))
      << text;
  EXPECT_TRUE(contains(text, "offset = 7 would not be plausible")) << text;
  EXPECT_TRUE(contains(text, "Next experiment, to tell apart drag_constant, sensor_offset"))
      << text;
  EXPECT_TRUE(contains(text, "Turn the other way.")) << text;
}

TEST(DiagnosisTable, FrictionLevelIsAParameterAndSaysWhenItIsPreferred) {
  Case c = dragged();
  Effect& effect = c.diagnoses[0].effects[0];
  effect.id = "friction_level";
  EXPECT_TRUE(contains(c.table(), "This is a parameter, not a missing effect."));
  EXPECT_FALSE(contains(c.table(), "is preferred"));
  effect.preferred_parameter = true;
  EXPECT_TRUE(contains(c.table(), "the parameter is preferred"));
}

TEST(DiagnosisTable, SaysWhereAValueIsABoundOrNotPlausible) {
  Case c = dragged();
  auto& p = c.diagnoses[0].effects[0].parameters[0];
  EXPECT_FALSE(contains(c.table(), "bound"));
  p.at_bound = true;
  p.plausible = false;
  const std::string text = c.table();
  EXPECT_TRUE(contains(text, "torque stands at a bound of the fit")) << text;
  EXPECT_TRUE(
      contains(text, "torque = 0.021 Nm is physically implausible (0 to 5 would be plausible)"))
      << text;
  EXPECT_TRUE(contains(text,
                       "Verdict: explained.\n  It takes physically implausible values: "
                       "torque 0.021 Nm [drag_constant].\n"))
      << text;
}

TEST(DiagnosisTable, AnUnexplainedRemainderIsDescribed) {
  Case c = dragged();
  Diagnosis& d = c.diagnoses[0];
  d.verdict = Verdict::kUnexplained;
  d.remainder.significant = true;
  d.remainder.along = "angle";
  d.remainder.p_value = 1e-5;
  d.remainder.order = 7.3;
  d.remainder.share = 0.4;
  const std::string text = c.table();
  EXPECT_TRUE(contains(text, "Verdict: unexplained.")) << text;
  EXPECT_TRUE(contains(text, "structure along angle, 7.3 times per turn of the output")) << text;
}

TEST(DiagnosisTable, AWorsePredictionIsSaid) {
  Case c = dragged();
  c.diagnoses[0].errors.extended_holdout = 0.03;
  EXPECT_TRUE(contains(c.table(), "50 % worse"));
}

TEST(DiagnosisTable, ASessionIsCalledByItsLabel) {
  const calibrate::Form form{.name = "from", .constants = {{.name = "first_run", .value = 1.0}}};
  EXPECT_EQ(form_text(form, {"Monday", "Tuesday"}), "from, run Tuesday");
}

TEST(DiagnosisJson, KeepsTheContract) {
  const json data = ambiguous().as_json();
  EXPECT_EQ(data.at("verdict"), "ambiguous");
  const json& effect = data.at("effects").at(0);
  EXPECT_EQ(effect.at("id"), "drag_constant");
  EXPECT_EQ(effect.at("body"), "sun");
  EXPECT_FALSE(effect.contains("order"));
  EXPECT_EQ(effect.at("alternatives"), json({"sensor_offset"}));
  const json& parameter = effect.at("parameters").at(0);
  EXPECT_EQ(parameter.at("name"), "torque");
  EXPECT_EQ(parameter.at("unit"), "Nm");
  EXPECT_EQ(parameter.at("value"), 0.021);
  EXPECT_EQ(parameter.at("ci95"), json({0.019, 0.023}));
  EXPECT_EQ(effect.at("evidence"), json({{"delta_bic", 42.5},
                                         {"inclusion_frequency", 0.97},
                                         {"p_value", 1e-6},
                                         {"probability", 0.875},
                                         {"probability_of_no_cause", 0.0625}}));
  const json& rmse = data.at("rmse");
  EXPECT_EQ(rmse.at("baseline_train"), 0.0205);
  EXPECT_EQ(rmse.at("extended_train"), 0.0031);
  EXPECT_EQ(rmse.at("baseline_holdout"), 0.02);
  EXPECT_EQ(rmse.at("extended_holdout"), 0.004);
  EXPECT_EQ(rmse.at("noise_floor"), 0.003);
  EXPECT_EQ(rmse.at("unit"), "Nm");
  EXPECT_DOUBLE_EQ(data.at("gain").get<double>(), 0.8);
  EXPECT_EQ(data.at("remainder").at("significant"), false);
  EXPECT_TRUE(data.at("remainder").at("along").is_null());
  EXPECT_EQ(data.at("next_experiment").at("separates"), json({"drag_constant", "sensor_offset"}));
  EXPECT_FALSE(data.contains("kinds"));
}

TEST(DiagnosisJson, ProposedConditionsAreRowsOfDataCsv) {
  const json condition = ambiguous().as_json().at("next_experiment").at("conditions").at(0);
  EXPECT_EQ(condition, json({{"direction", "forward"},
                             {"sun_speed_rpm", 600.0},
                             {"output_torque_nm", 5.0},
                             {"rotation", -1},
                             {"repeats", 6}}));
}

TEST(DiagnosisJson, WhatIsNotKnownIsNull) {
  Case c = dragged();
  c.diagnoses[0].errors.baseline_holdout = c.diagnoses[0].errors.extended_holdout = kUnknown;
  c.diagnoses[0].lack_of_fit.degrees = 0;
  c.diagnoses[0].extrapolation = {};
  const json data = c.as_json();
  EXPECT_TRUE(data.at("gain").is_null());
  EXPECT_TRUE(data.at("rmse").at("extended_holdout").is_null());
  EXPECT_TRUE(data.at("next_experiment").is_null());
  EXPECT_TRUE(data.at("lack_of_fit").is_null());
  EXPECT_TRUE(data.at("lack_of_fit_of_extended").is_null());
  EXPECT_TRUE(data.at("extrapolation").is_null());
}

TEST(DiagnosisJson, BodyAndOrderOfARunOut) {
  Case c = dragged();
  c.diagnoses[0].effects[0].form = {.name = "proportional", .body = "planet", .order = 29.2};
  const json effect = c.as_json().at("effects").at(0);
  EXPECT_EQ(effect.at("body"), "planet");
  EXPECT_EQ(effect.at("order"), 29.2);
}

/// The transmission above and lost motion of two rows, 20 arcmin measured, 19 simulated.
Case two_kinds() {
  Case c = dragged();
  MeasurementSet set;
  set.kind = Kind::kLostMotion;
  set.files = {"b.csv"};
  Diagnosis d;
  d.kind = Kind::kLostMotion;
  d.verdict = Verdict::kUnexplained;
  for (int k = 0; k < 2; ++k) {
    Condition condition;
    condition.test_torque_Nm = 1.0 + k;
    condition.output_angle_rad = std::numbers::pi * k;
    set.rows.push_back({.condition = condition, .response = 20.0 * kArcmin, .line = 3 + k});
    d.rows.push_back({.baseline = 19.0 * kArcmin, .extended = 19.0 * kArcmin, .sigma = kArcmin});
  }
  d.errors = {.baseline_train = kArcmin, .extended_train = kArcmin, .noise_floor = 0.5 * kArcmin};
  Effect clearance;
  clearance.id = clearance.title = "clearance";
  clearance.form = {.name = "output"};
  clearance.parameters = {
      {.name = "clearance", .unit = "arcmin", .value = 1.0, .low = 0.5, .high = 1.5}};
  d.effects = {clearance};
  c.diagnoses.push_back(d);
  c.sets.push_back(set);
  return c;
}

TEST(DiagnosisJson, SeveralKindsGiveTheWorstVerdictAndAllEffects) {
  const json data = two_kinds().as_json();
  EXPECT_EQ(data.at("verdict"), "unexplained");
  ASSERT_EQ(data.at("effects").size(), 2U);
  EXPECT_EQ(data.at("effects").at(0).at("kind"), "transmission");
  EXPECT_EQ(data.at("effects").at(1).at("kind"), "lost_motion");
  EXPECT_EQ(data.at("rmse").at("unit"), "Nm");
  ASSERT_EQ(data.at("kinds").size(), 2U);
  EXPECT_EQ(data.at("kinds").at(0).at("verdict"), "explained");
  EXPECT_EQ(data.at("kinds").at(1).at("rmse").at("unit"), "arcmin");
  EXPECT_NEAR(data.at("kinds").at(1).at("rmse").at("baseline_train").get<double>(), 1.0, 1e-12);
}

TEST(DiagnosisJson, OfSeveralKindsNothingOfTheLaterOnesIsHidden) {
  Case c = two_kinds();
  c.diagnoses[1].effects[0].parameters[0].plausible = false;
  calibrate::NextExperiment next;
  next.separates = {"clearance", "compliance"};
  c.diagnoses[1].next_experiment = next;
  const json data = c.as_json();
  ASSERT_EQ(data.at("physically_implausible").size(), 1U);
  EXPECT_EQ(data.at("physically_implausible").at(0).at("kind"), "lost_motion");
  EXPECT_EQ(data.at("next_experiment").at("kind"), "lost_motion");
  EXPECT_EQ(data.at("next_experiment").at("separates").at(0), "clearance");
  EXPECT_TRUE(data.at("kinds").at(0).at("next_experiment").is_null());
}

/// Two loops of one session, measured at the sun, among the rows of lost motion above.
Case looped() {
  Case c = two_kinds();
  MeasurementSet& set = c.sets[1];
  set.files.emplace_back("loops.csv");
  calibrate::Loop loop;
  loop.lost_motion_rad = 25.0 * kArcmin;
  loop.lost_motion_sd_rad = 0.25 * kArcmin;
  loop.stiffness_positive = {.stiffness_Nm_rad = 5000.0, .standard_deviation_Nm_rad = 12.0};
  loop.stiffness_negative = {.stiffness_Nm_rad = 4000.0, .standard_deviation_Nm_rad = 120.0};
  loop.asymmetry = 1000.0 / 4500.0;
  calibrate::Loop bare;
  bare.lost_motion_rad = 20.0 * kArcmin;
  set.loops = {{.file = 1,
                .run = "Monday",
                .sun_locked = false,
                .cutoff_Hz = 3.0,
                .creep = calibrate::Creep{.rad_s = 0.01 * kArcmin,
                                          .standard_deviation_rad_s = 0.002 * kArcmin},
                .loops = {{.number = 2, .loop = loop}, {.number = 4, .loop = bare}}}};
  return c;
}

TEST(DiagnosisTable, TellsEachLoopWithItsStiffnessAndHowItsRecordWasRead) {
  const std::string text = looped().table();
  for (const char* part :
       {"Loops, friction included, at the output (± is one standard deviation)\n",
        "  What was measured at the sun is referred to the output.\n",
        "loops.csv, run Monday          sun     2          25.00 ± 0.25",
        "5000 ± 12          4000 ± 120     22.2 %",
        "                  20                             -                   -          -\n",
        "loops.csv, run Monday: filter cut-off 3 Hz; creep of 0.0100 ± 0.0020 arcmin/s, which "
        "is not taken out"}) {
    EXPECT_TRUE(contains(text, part)) << part << '\n' << text;
  }
  EXPECT_FALSE(contains(two_kinds().table(), "Loops"));
}

TEST(DiagnosisTable, ALoopThatIsNotToldAtZeroTorqueHasNoLostMotion) {
  Case c = looped();
  c.sets[1].loops[0].loops[0].loop.outcome = calibrate::LoopOutcome::kAtEdge;
  EXPECT_FALSE(contains(c.table(), "25.00 ± 0.25")) << c.table();
  EXPECT_TRUE(contains(c.table(), "5000 ± 12")) << c.table();
  const json loop = c.as_json().at("kinds").at(1).at("loops").at(0);
  EXPECT_TRUE(loop.at("lost_motion_arcmin").is_null()) << loop;
  EXPECT_TRUE(loop.at("lost_motion_sd_arcmin").is_null()) << loop;
  EXPECT_EQ(loop.at("stiffness_positive_nm_per_rad"), 5000.0);
}

TEST(DiagnosisTable, WithoutCreepOrTimeLittleIsSaidOfARecord) {
  Case c = looped();
  c.sets[1].loops[0].creep.reset();
  EXPECT_TRUE(contains(c.table(), "run Monday: filter cut-off 3 Hz\n")) << c.table();
  c.sets[1].loops[0].cutoff_Hz = 0.0;
  c.sets[1].loops[0].sun_locked = true;
  EXPECT_FALSE(contains(c.table(), "run Monday:")) << c.table();
  EXPECT_FALSE(contains(c.table(), "measured at the sun is referred")) << c.table();
}

TEST(DiagnosisJson, TellsEachLoopInItsUnits) {
  const json data = looped().as_json();
  ASSERT_EQ(data.at("loops").size(), 2U);
  const json& loop = data.at("loops").at(0);
  EXPECT_EQ(loop.at("kind"), "lost_motion");
  EXPECT_EQ(loop.at("file"), "loops.csv");
  EXPECT_EQ(loop.at("run"), "Monday");
  EXPECT_EQ(loop.at("loop"), 2);
  EXPECT_EQ(loop.at("measured_at"), "sun");
  const auto number = [&](const char* key) { return loop.at(key).get<double>(); };
  EXPECT_DOUBLE_EQ(number("lost_motion_arcmin"), 25.0);
  EXPECT_DOUBLE_EQ(number("lost_motion_sd_arcmin"), 0.25);
  EXPECT_EQ(number("stiffness_positive_nm_per_rad"), 5000.0);
  EXPECT_EQ(number("stiffness_positive_sd_nm_per_rad"), 12.0);
  EXPECT_EQ(number("stiffness_negative_nm_per_rad"), 4000.0);
  EXPECT_EQ(number("stiffness_negative_sd_nm_per_rad"), 120.0);
  EXPECT_DOUBLE_EQ(number("asymmetry"), 2.0 / 9.0);
  EXPECT_EQ(number("filter_cutoff_hz"), 3.0);
  EXPECT_DOUBLE_EQ(number("creep_arcmin_per_s"), 0.01);
  EXPECT_DOUBLE_EQ(number("creep_sd_arcmin_per_s"), 0.002);
  const json& bare = data.at("loops").at(1);
  for (const char* key : {"lost_motion_sd_arcmin", "stiffness_positive_nm_per_rad",
                          "stiffness_negative_sd_nm_per_rad", "asymmetry"}) {
    EXPECT_TRUE(bare.at(key).is_null()) << key;
  }
  EXPECT_TRUE(data.at("kinds").at(0).at("loops").empty());
  EXPECT_TRUE(dragged().as_json().at("loops").empty());
}

DiagnosisSetup with_model() {
  calibrate::ExtendedModel model;
  model.name = "first gear";
  model.files = {"old.csv"};
  model.fingerprint = 0xabcU;
  model.causes = {
      {.id = "drag_constant", .form = {.name = "sun", .body = "sun"}, .value = {0.0125}}};
  return {.seed = 17,
          .false_discovery_rate = 0.01,
          .model = ModelUse{.file = "m.toml", .models = {model}}};
}

TEST(DiagnosisJson, SaysWithWhichModelSeedAndRateItWasMade) {
  const Case c = dragged();
  const json data = json::parse(diagnosis_json(c.diagnoses, c.sets, with_model()).text());
  EXPECT_EQ(data.at("seed"), 17);
  EXPECT_EQ(data.at("false_discovery_rate"), 0.01);
  const json& model = data.at("model");
  EXPECT_EQ(model.at("file"), "m.toml");
  EXPECT_EQ(model.at("causes").at(0).at("parameters").at(0).at("value"), 0.0125);
  EXPECT_EQ(model.at("data").at(0).at("name"), "first gear");
  EXPECT_EQ(model.at("data").at(0).at("data_files"), json::array({"old.csv"}));
  EXPECT_EQ(model.at("data").at(0).at("data_fingerprint"), "fnv1a64:0000000000000abc");
  EXPECT_FALSE(c.as_json().contains("model"));
}

TEST(DiagnosisTable, SaysWithWhichModelItWasMade) {
  const Case c = dragged();
  const std::string text = diagnosis_table(c.diagnoses, c.sets, with_model());
  for (const char* part :
       {"With the model m.toml\n", "measured on \"first gear\" (old.csv; fnv1a64:0000000000000abc)",
        "torque 0.0125 Nm"}) {
    EXPECT_TRUE(contains(text, part)) << part << '\n' << text;
  }
}

TEST(DiagnosisTable, SmallThingsReadWell) {
  Case c = dragged();
  c.diagnoses[0].subject = "";
  c.diagnoses[0].lack_of_fit.p_value = 0.0;
  c.diagnoses[0].remainder.significant = true;
  c.diagnoses[0].remainder.p_value = 1e-120;
  const std::string text = c.table();
  EXPECT_TRUE(text.starts_with("8 rows of kind transmission from a.csv\n")) << text;
  EXPECT_TRUE(contains(text, "F(4, 4) = 30, p < 1e-99.")) << text;
  EXPECT_TRUE(contains(text, "along nothing that the data state (p < 1e-99)")) << text;
  EXPECT_TRUE(contains(text, "beyond the fit, load 40 Nm (1 row)")) << text;
  EXPECT_FALSE(contains(text, "= <")) << text;
}

TEST(ResidualCsv, HasARowPerMeasurementInUnitsOfTheData) {
  const Case c = two_kinds();
  const io::CsvTable table = io::parse_csv(residual_csv(c.diagnoses, c.sets), "residuals.csv");
  ASSERT_EQ(table.rows.size(), 10U);
  const auto& first = table.rows.front();
  EXPECT_EQ(table.text(first, "file"), "a.csv");
  EXPECT_EQ(table.number(first, "line"), 3.0);
  EXPECT_EQ(table.text(first, "direction"), "forward");
  EXPECT_EQ(table.number(first, "sun_speed_rpm"), 200.0);
  EXPECT_EQ(table.number(first, "temperature_c"), 25.0);
  EXPECT_EQ(table.text(first, "run"), "Monday");
  EXPECT_EQ(table.number(first, "measured"), 0.15);
  EXPECT_EQ(table.number(first, "residual_baseline"), 0.021);
  EXPECT_EQ(table.number(first, "residual_extended"), 0.001);
  EXPECT_EQ(table.number(first, "residual_holdout"), 0.002);
  EXPECT_FALSE(table.text(first, "test_torque_nm").has_value());
  const auto& last = table.rows.back();
  EXPECT_EQ(table.text(last, "kind"), "lost_motion");
  EXPECT_EQ(table.text(last, "unit"), "arcmin");
  EXPECT_EQ(table.number(last, "measured"), 20.0);
  EXPECT_EQ(table.number(last, "residual_baseline"), 1.0);
  EXPECT_EQ(table.number(last, "output_angle_deg"), 180.0);
  EXPECT_FALSE(table.text(last, "holdout").has_value());
  EXPECT_FALSE(table.text(last, "direction").has_value());
}

TEST(ResidualCsv, HoldsEveryConditionThatTheDataState) {
  Case c = two_kinds();
  for (auto& row : c.sets[0].rows) row.condition.cycles = 1000.0 * row.line;
  c.sets[1].kind = c.diagnoses[1].kind = Kind::kPairLoss;
  for (auto& row : c.sets[1].rows) {
    row.condition.temperature_K = 313.15;
    row.condition.cycles = 7.0;
  }
  const io::CsvTable table = io::parse_csv(residual_csv(c.diagnoses, c.sets), "residuals.csv");
  EXPECT_EQ(table.number(table.rows.front(), "cycles"), 3000.0);
  EXPECT_EQ(table.number(table.rows.back(), "cycles"), 7.0);
  EXPECT_EQ(table.number(table.rows.back(), "temperature_c"), 40.0);
}

TEST(DiagnosisReport, ResultsAndDataMustGoTogether) {
  Case c = dragged();
  c.diagnoses[0].rows.pop_back();
  EXPECT_THROW(static_cast<void>(c.table()), std::invalid_argument);
  EXPECT_THROW(diagnosis_json({}, {}).text(), std::invalid_argument);
}

TEST(ConditionColumns, CovariatesAreFoundByTheirShortNames) {
  EXPECT_EQ(column_of("load", Kind::kTransmission)->name, "output_torque_nm");
  EXPECT_EQ(column_of("load", Kind::kLostMotion)->name, "test_torque_nm");
  EXPECT_EQ(column_of("driven teeth", Kind::kPairLoss)->name, "driven_teeth");
  EXPECT_EQ(column_of("temperature_c", Kind::kTransmission)->unit, "C");
  EXPECT_FALSE(column_of("humidity", Kind::kTransmission).has_value());
}

TEST(DiagnosisPlots, AreWellFormedAndTellTheirFacts) {
  for (const Case& c : {dragged(), ambiguous(), two_kinds()}) {
    const std::vector<Plot> plots = diagnosis_plots(c.diagnoses, c.sets);
    ASSERT_EQ(plots.size(), 3 * c.sets.size());
    for (const Plot& plot : plots) {
      const std::string svg = io::run_gnuplot(plot.script);
      std::istringstream stream(svg);
      boost::property_tree::ptree tree;
      ASSERT_NO_THROW(boost::property_tree::read_xml(stream, tree)) << plot.name;
      EXPECT_EQ(tree.count("svg"), 1U) << plot.name;
      EXPECT_FALSE(contains(svg, "NaN")) << plot.name;
    }
  }
  const Case c = dragged();
  const std::vector<Plot> plots = diagnosis_plots(c.diagnoses, c.sets);
  EXPECT_EQ(plots[0].name, "measured_vs_simulated");
  EXPECT_TRUE(contains(io::run_gnuplot(plots[0].script), "0.0205 Nm off"));
  EXPECT_EQ(plots[1].name, "residuals");
  EXPECT_TRUE(contains(io::run_gnuplot(plots[1].script), "output torque (Nm)"));
  EXPECT_EQ(plots[2].name, "evidence");
  EXPECT_TRUE(contains(io::run_gnuplot(plots[2].script), "drag_constant"));
}

// A label to the right of 0 would lie across its bar, and lose its minus at the axis.
TEST(DiagnosisPlots, NumbersOfBarsToTheLeftStandLeftOfThem) {
  const Case c = dragged();  // drag_constant 42.5, friction_level -2
  const std::string svg = io::run_gnuplot(diagnosis_plots(c.diagnoses, c.sets)[2].script);
  const auto group_of = [&](const std::string& words) {
    const std::size_t text = svg.find(words + "</text>");
    EXPECT_NE(text, std::string::npos) << words;
    const std::size_t group = svg.rfind("<g transform=\"translate(", text);
    return svg.substr(group, text - group);
  };
  const std::string minus = svg.find(">-2.0 </text>") != std::string::npos ? "-2.0 " : "-2.0";
  const std::string left = group_of(minus);
  const std::string right = group_of("42.5");
  EXPECT_NE(left.find("text-anchor=\"end\""), std::string::npos) << left;
  EXPECT_NE(right.find("text-anchor=\"start\""), std::string::npos) << right;
}

TEST(DiagnosisPlots, WithSeveralKindsNamesEndWithTheKind) {
  const Case c = two_kinds();
  const std::vector<Plot> plots = diagnosis_plots(c.diagnoses, c.sets);
  EXPECT_EQ(plots[0].name, "measured_vs_simulated_transmission");
  EXPECT_EQ(plots[5].name, "evidence_lost_motion");
}

/// With angles over some turns and a line of 3000 orders whose highest is at 2.5.
Case turning(double turns) {
  Case c = dragged();
  for (std::size_t k = 0; k < c.sets[0].rows.size(); ++k) {
    c.sets[0].rows[k].condition.output_angle_rad =
        2.0 * std::numbers::pi * turns * static_cast<double>(k) / 7.0;
  }
  for (int k = 1; k <= 3000; ++k) {
    c.diagnoses[0].periodogram.order.push_back(0.01 * k);
    c.diagnoses[0].periodogram.power.push_back(k == 250 ? 0.625 : 0.001);
  }
  return c;
}

TEST(DiagnosisPlots, APeriodogramIsDrawnOverMoreThanATurnAndKeepsItsPeaks) {
  const Case c = turning(2.0);
  const std::vector<Plot> plots = diagnosis_plots(
      c.diagnoses, c.sets, {{.body = "sun", .order = 7.25}, {.body = "planet", .order = 99.0}});
  ASSERT_EQ(plots.size(), 4U);
  EXPECT_EQ(plots[3].name, "periodogram");
  const std::string& script = plots[3].script;
  const auto block = script.find("$power << EOD\n") + 14;
  const std::string points = script.substr(block, script.find("\nEOD", block) + 1 - block);
  EXPECT_EQ(std::ranges::count(points, '\n'), static_cast<std::ptrdiff_t>(kMostPlottedOrders));
  EXPECT_TRUE(contains(points, "\n2.5 0.625\n"));
  const std::string svg = io::run_gnuplot(script);
  EXPECT_TRUE(contains(svg, "per turn of the output"));
  EXPECT_TRUE(contains(svg, "sun 7.25"));
  EXPECT_FALSE(contains(svg, "planet")) << "its order is beyond those that were looked at";
  const Case less = turning(0.9);
  EXPECT_EQ(diagnosis_plots(less.diagnoses, less.sets).size(), 3U);
}

TEST(DiagnosisPlots, EveryNameIsKnownBeforehand) {
  const std::vector<std::string> names = diagnosis_plot_names();
  Case several = turning(2.0);
  const Case other = two_kinds();
  several.diagnoses.push_back(other.diagnoses[1]);
  several.sets.push_back(other.sets[1]);
  for (const Case& c : {turning(2.0), several}) {
    for (const Plot& plot : diagnosis_plots(c.diagnoses, c.sets)) {
      EXPECT_NE(std::ranges::find(names, plot.name), names.end()) << plot.name;
    }
  }
}

TEST(DiagnosisPlots, ResidualsOfARunOutAreOverTheAngleOfItsBody) {
  Case c = dragged();
  for (auto& row : c.sets[0].rows) row.condition.output_angle_rad = row.condition.output_torque_Nm;
  Effect& effect = c.diagnoses[0].effects[0];
  effect.id = "runout";
  effect.form = {.name = "proportional", .body = "planet", .order = 29.2};
  const std::string script = diagnosis_plots(c.diagnoses, c.sets)[1].script;
  EXPECT_TRUE(contains(script, "angle of planet (deg), 29.2 periods")) << script;
}

TEST(DiagnosisPlots, ResidualsOfADriftAreOverWhatItDriftsAlong) {
  Case c = dragged();
  Effect& effect = c.diagnoses[0].effects[0];
  effect.id = "drift";
  for (auto& row : c.sets[0].rows) {
    row.condition.time_s = 60.0 * row.line;
    row.condition.cycles = 1000.0 * row.line;
  }
  for (const auto& [form, title] :
       {std::pair{"linear_time", "time (s)"}, std::pair{"levelling_cycles", "cycles"}}) {
    effect.form = {.name = form};
    const std::string script = diagnosis_plots(c.diagnoses, c.sets)[1].script;
    EXPECT_TRUE(contains(script, fmt::format("set xlabel '{}'", title)) ||
                contains(script, fmt::format("set xlabel \"{}\"", title)))
        << script;
  }
}

TEST(DiagnosisPlots, LongDataAreThinnedAndSaySo) {
  Case c = dragged();
  while (c.sets[0].rows.size() <= kMostPlottedRows) {
    c.sets[0].rows.push_back(c.sets[0].rows[c.sets[0].rows.size() % 8]);
    c.diagnoses[0].rows.push_back(c.diagnoses[0].rows[0]);
  }
  EXPECT_TRUE(contains(diagnosis_plots(c.diagnoses, c.sets)[0].script, "1 of 2 rows shown"));
}

}  // namespace
}  // namespace gear3k::report::diagnosis_report_test
