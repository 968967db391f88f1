// `gear3k diagnose` with logs of motion: the cause, files, and what is refused.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::diagnose_motion_test {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::ProgramResult, test::Workplace;

void put_example(const Workplace& place) {
  place.write("a.toml", example("actuators/knee.toml"));
  place.write("m.csv", example("measurements/knee_motion.csv"));
}

/// The log with the fields of every row changed.
std::string altered(const std::string& text,
                    const std::function<void(std::vector<std::string>&)>& change) {
  std::istringstream in(text);
  std::string out, line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#' || line[0] == 't') {
      out += line + '\n';
      continue;
    }
    std::istringstream fields(line);
    std::vector<std::string> all;
    for (std::string field; std::getline(fields, field, ',');) all.push_back(field);
    change(all);
    out += fmt::format("{}\n", fmt::join(all, ","));
  }
  return out;
}

/// The log with one column multiplied.
std::string scaled(const std::string& text, std::size_t column, double by) {
  return altered(text, [&](std::vector<std::string>& all) {
    all.at(column) = fmt::format("{}", by * std::stod(all.at(column)));
  });
}

TEST(DiagnoseMotion, ALogThatDoesNotChangeIsRefused) {
  const Workplace place;
  put_example(place);
  std::string text = "# kind: dynamic\ntime_s,speed_rad_s,motor_current_a,output_torque_nm\n";
  for (int k = 0; k < 500; ++k) text += fmt::format("{:.2f},6.4,-0.025,-0.99\n", 0.01 * k);
  place.write("still.csv", text);
  const ProgramResult result = place.run({"diagnose", "a.toml", "still.csv"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("still.csv: the motor's torque does not change"), std::string::npos)
      << result.err;
}

TEST(DiagnoseMotion, NamesTheLossesThatTheLogWasMadeWith) {
  const Workplace place;
  put_example(place);
  const ProgramResult result =
      place.run({"diagnose", "a.toml", "m.csv", "--out", "out", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(json::parse(place.read("out/diagnosis.json")), data);
  EXPECT_EQ(data.at("verdict"), "explained");
  ASSERT_EQ(data.at("effects").size(), 1U);
  const json& effect = data.at("effects")[0];
  EXPECT_EQ(effect.at("id"), "friction_level");
  const json& level = effect.at("parameters")[0];
  EXPECT_LE(level.at("ci95")[0].get<double>(), 0.4);
  EXPECT_GE(level.at("ci95")[1].get<double>(), 0.4);
  const std::size_t windows = data.at("windows").at("forward").get<std::size_t>() +
                              data.at("windows").at("backward").get<std::size_t>();
  EXPECT_EQ(lines_of(place.read("out/residuals.csv")).size(), windows + 1);
  // The fields that results of every kind have.
  const json& errors = data.at("rmse");
  EXPECT_GT(data.at("gain"), 0.8);
  EXPECT_NEAR(data.at("gain").get<double>(),
              1.0 - errors.at("extended_holdout").get<double>() /
                        errors.at("baseline_holdout").get<double>(),
              1e-12);
  EXPECT_EQ(data.at("holdout_blocks"), "time");
  EXPECT_EQ(data.at("remainder").at("significant"), false);
  EXPECT_TRUE(data.at("remainder").at("along").is_null());
  for (const std::string figure : {"out/measured_vs_simulated.svg", "out/residuals.svg"}) {
    EXPECT_NE(place.read(figure).find("</svg>"), std::string::npos) << figure;
  }
  // With the model nothing is left to be found, and it is an actuator like any other.
  const ProgramResult again =
      place.run({"diagnose", "out/model.toml", "m.csv", "--format", "json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(json::parse(again.out).at("verdict"), "no_discrepancy");
  // What was not found stays as it was stated.
  for (const std::string value : {"rotor_inertia_kgm2 = 1.81e-05\n", "input_inertia_kgm2 = 1e-06\n",
                                  "backdriving_torque_nm = 1.0\n", "coulomb_torque_nm = 0.5\n",
                                  "viscous_nms_per_rad = 0.02\n"}) {
    EXPECT_NE(place.read("out/model.toml").find(value), std::string::npos) << value;
  }
  const ProgramResult actuator = place.run({"actuator", "out/model.toml"});
  EXPECT_EQ(actuator.exit_code, 0) << actuator.err;
}

// Which kind its data are a file that cannot be read does not tell.
TEST(DiagnoseMotion, AnActuatorWithoutALogIsToldWhereItHasAPlace) {
  const Workplace place;
  put_example(place);
  const ProgramResult result = place.run({"diagnose", "a.toml", "missing.csv"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("with logs of motion (# kind: dynamic) an ACTUATOR"), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("missing.csv: cannot be read"), std::string::npos) << result.err;
}

// Inertias that are far too small are found to the letter, but no drive differs so from what is
// stated: nothing is left to be explained, and the log is not explained.
TEST(DiagnoseMotion, AnImplausibleCauseLeavesNoRemainder) {
  const Workplace place;
  put_example(place);
  std::string actuator = place.read("a.toml"), log = place.read("m.csv");
  const auto replace = [](std::string& text, const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace(actuator, "rotor_inertia_kgm2 = 1.81e-5", "rotor_inertia_kgm2 = 1e-9");
  replace(actuator, "input_inertia_kgm2 = 1e-6", "input_inertia_kgm2 = 1e-9");
  replace(log, "load_inertia_kgm2: 0.12", "load_inertia_kgm2: 0");
  place.write("light.toml", actuator);
  place.write("alone.csv", log);
  const json data =
      json::parse(place.run({"diagnose", "light.toml", "alone.csv", "--format", "json"}).out);
  EXPECT_EQ(data.at("verdict"), "unexplained");
  EXPECT_GT(data.at("remainder").at("p_value"), 1e-4);
  EXPECT_EQ(data.at("remainder").at("significant"), false);
}

TEST(DiagnoseMotion, AlternativesAreIdsWithTheirNumbersBeside) {
  const Workplace place;
  put_example(place);
  // Without the load's torque nothing tells inertia and losses apart but the drag.
  std::string log;
  for (const std::string& line : lines_of(example("measurements/knee_motion.csv"))) {
    log += (line.empty() || line[0] == '#' ? line : line.substr(0, line.rfind(','))) + '\n';
  }
  place.write("unloaded.csv", log);
  const json data =
      json::parse(place.run({"diagnose", "a.toml", "unloaded.csv", "--format", "json"}).out);
  std::size_t listed = 0;
  for (const json& effect : data.at("effects")) {
    ASSERT_EQ(effect.at("alternatives").size(), effect.at("alternatives_detail").size());
    for (std::size_t k = 0; k < effect.at("alternatives").size(); ++k, ++listed) {
      EXPECT_EQ(effect.at("alternatives")[k], effect.at("alternatives_detail")[k].at("id"));
    }
  }
  EXPECT_GT(listed, 0U) << data.dump(1);
}

/// The log without some of its rows.
std::string thinned(const std::string& text, const std::function<bool(int)>& lost) {
  std::string out;
  int row = 0;
  for (const std::string& line : lines_of(text)) {
    const bool sample = !line.empty() && line[0] != '#' && line[0] != 't';
    if (!sample || !lost(row++)) out += line + '\n';
  }
  return out;
}

TEST(DiagnoseMotion, LostRowsDoNotChangeWhatIsFound) {
  const std::vector<std::function<bool(int)>> losses{[](int row) { return row % 3 == 2; },
                                                     [](int row) { return row % 5 == 4; },
                                                     [](int row) { return row % 2 == 1; }};
  const Workplace place;
  put_example(place);
  for (std::size_t k = 0; k < losses.size(); ++k) {
    place.write("thin.csv", thinned(example("measurements/knee_motion.csv"), losses[k]));
    const json data =
        json::parse(place.run({"diagnose", "a.toml", "thin.csv", "--format", "json"}).out);
    EXPECT_EQ(data.at("verdict"), "explained") << k;
    ASSERT_EQ(data.at("effects").size(), 1U) << k;
    EXPECT_EQ(data.at("effects")[0].at("id"), "friction_level") << k;
    const json& level = data.at("effects")[0].at("parameters")[0];
    EXPECT_NEAR(level.at("value").get<double>(), 0.4, 0.03) << k;
    EXPECT_LE(level.at("ci95")[0].get<double>(), 0.4) << k;
    EXPECT_GE(level.at("ci95")[1].get<double>(), 0.4) << k;
    EXPECT_LT(level.at("ci95")[1].get<double>() - level.at("ci95")[0].get<double>(), 0.05) << k;
  }
}

TEST(DiagnoseMotion, TimeInMillisecondsIsDoubtedAndNeverExplained) {
  const Workplace place;
  put_example(place);
  place.write("ms.csv", scaled(example("measurements/knee_motion.csv"), 0, 1000.0));
  const json data =
      json::parse(place.run({"diagnose", "a.toml", "ms.csv", "--format", "json"}).out);
  EXPECT_EQ(data.at("verdict"), "unexplained");
  const std::string notes = data.at("notes").dump();
  EXPECT_NE(notes.find("milliseconds"), std::string::npos) << notes;
  EXPECT_NE(notes.find("would differ by a factor"), std::string::npos) << notes;
}

TEST(DiagnoseMotion, ATorqueConstantIsNamedFromTheSameLog) {
  const Workplace place;
  put_example(place);
  // As if the true losses were stated; then the current is logged 10 % low.
  std::string drive = example("actuators/knee.toml");
  const auto put = [&](const std::string& key, double value) {
    const auto at = drive.find(key + " = ");
    ASSERT_NE(at, std::string::npos);
    drive.replace(at, drive.find('\n', at) - at, fmt::format("{} = {}", key, value));
  };
  put("efficiency_forward", 1.0 / (1.0 + 1.4 * (1.0 / 0.85 - 1.0)));
  put("efficiency_backward", 1.0 - 1.4 * 0.18);
  place.write("a.toml", drive);
  const ProgramResult null = place.run({"diagnose", "a.toml", "m.csv", "--format", "json"});
  EXPECT_EQ(json::parse(null.out).at("verdict"), "no_discrepancy") << null.out;
  place.write("low.csv", scaled(example("measurements/knee_motion.csv"), 2, 1.0 / 1.1));
  const ProgramResult result = place.run({"diagnose", "a.toml", "low.csv", "--format", "json"});
  const json effects = json::parse(result.out).at("effects");
  ASSERT_EQ(effects.size(), 1U) << result.out;
  EXPECT_EQ(effects[0].at("id"), "torque_constant");
  EXPECT_NEAR(effects[0].at("parameters")[0].at("value").get<double>(), 0.1, 0.01);
}

TEST(DiagnoseMotion, SignalsOfTheOtherSignAreRefused) {
  const Workplace place;
  put_example(place);
  const std::string log = example("measurements/knee_motion.csv");
  place.write("motor.csv", scaled(log, 2, -1.0));
  const ProgramResult motor = place.run({"diagnose", "a.toml", "motor.csv"});
  EXPECT_EQ(motor.exit_code, 2);
  EXPECT_NE(motor.err.find("acts against the motion"), std::string::npos) << motor.err;
  place.write("load.csv", scaled(log, 3, -1.0));
  const ProgramResult load = place.run({"diagnose", "a.toml", "load.csv"});
  EXPECT_EQ(load.exit_code, 2);
  EXPECT_NE(load.err.find("output_torque_nm has the other sign"), std::string::npos) << load.err;
  place.write("turned.csv", "# torque: actuator\n" + scaled(log, 3, -1.0));
  EXPECT_EQ(place.run({"diagnose", "a.toml", "turned.csv"}).exit_code, 0);
}

TEST(DiagnoseMotion, WhatItCannotTakeExitsWithTwo) {
  const Workplace place;
  put_example(place);
  const auto refused = [&](const std::vector<std::string>& words, const std::string& part) {
    const ProgramResult result = place.run(words);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  place.write("other.csv", example("measurements/bilateral_drive_gear_transmission.csv"));
  refused({"diagnose", "a.toml", "m.csv", "other.csv"}, "other.csv");
  place.write("d.toml", "[motor]\nresistance_ohm = 1.0\n");
  refused({"diagnose", "d.toml", "m.csv"}, "d.toml");
  place.write("still.csv", scaled(example("measurements/knee_motion.csv"), 1, 0.0));
  refused({"diagnose", "a.toml", "still.csv"}, "too few stretches");
  // The same log twice would be twice as sure.
  place.write("copy.csv", "\xEF\xBB\xBF" + example("measurements/knee_motion.csv"));
  place.write("again.csv", place.read("copy.csv"));
  refused({"diagnose", "a.toml", "copy.csv", "again.csv"},
          "again.csv: holds the same bytes as copy.csv: allowed: each file once");
  place.write("nameless.csv", "time_s,speed_rad_s,motor_torque_nm\n0,1,1\n");
  refused({"diagnose", "a.toml", "nameless.csv"},
          "is missing, allowed: transmission, lost_motion, torque_angle, pair_loss, dynamic (of an "
          "ACTUATOR)");
  place.write("slip.csv", "# kind: dynamik\ntime_s,speed_rad_s,motor_torque_nm\n0,1,1\n");
  refused({"diagnose", "a.toml", "slip.csv"}, "did you mean dynamic?");
  refused({"diagnose", "a.toml", "m.csv", "--seed", "2"}, "--seed: no effect on logs of motion");
}

/// The log with the angles of both sides: the output's summed up from its speed, the motor's with
/// play and wind-up by the torque of the mesh, 0.14 kg m2 of acceleration and T_L.
std::string with_both_angles(const std::string& text, double play_rad, double compliance,
                             double sign) {
  std::vector<std::vector<double>> rows;
  std::string out;
  for (const std::string& line : lines_of(text)) {
    if (line.empty() || line[0] == '#') {
      out += line + '\n';
    } else if (line[0] == 't') {
      out += "time_s,angle_rad,motor_current_a,output_torque_nm,motor_angle_rad\n";
    } else {
      std::istringstream fields(line);
      rows.emplace_back();
      for (std::string field; std::getline(fields, field, ',');) {
        rows.back().push_back(std::stod(field));
      }
    }
  }
  double angle = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& row = rows[k];
    if (k > 0) angle += 0.5 * (row[1] + rows[k - 1][1]) * (row[0] - rows[k - 1][0]);
    const std::size_t a = k > 2 ? k - 3 : 0, b = std::min(k + 3, rows.size() - 1);
    const double rate = (rows[b][1] - rows[a][1]) / (rows[b][0] - rows[a][0]);
    const double mesh = 0.12 * rate + 0.5 * (row[1] > 0.0 ? 1.0 : -1.0) + 0.02 * row[1] - row[3];
    const double windup = 0.5 * play_rad * (mesh > 0.0 ? 1.0 : -1.0) + compliance * mesh;
    out += fmt::format("{},{:.7f},{},{},{:.6f}\n", row[0], angle, row[2], row[3],
                       sign * 60.0 * (angle + windup) + 2.0);
  }
  return out;
}

TEST(DiagnoseMotion, LogsOfBothSidesShowPlayAndCompliance) {
  const Workplace place;
  place.write("a.toml", example("actuators/knee.toml") + "\n[backlash]\noutput_arcmin = 5.0\n");
  const std::string log = example("measurements/knee_motion.csv");
  const double arcmin = 3.14159265358979 / 10800.0;
  place.write("b.csv", with_both_angles(log, 11.0 * arcmin, 2e-4, 1.0));
  const ProgramResult result = place.run({"diagnose", "a.toml", "b.csv", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  std::vector<std::string> ids;
  for (const json& e : data.at("effects")) {
    ids.push_back(e.at("id").get<std::string>());
    const json& p = e.at("parameters")[0];
    if (e.at("id") == "clearance") {
      EXPECT_EQ(p.at("unit"), "arcmin");
      EXPECT_NEAR(p.at("value").get<double>(), 6.0, 0.4);
    } else if (e.at("id") == "compliance") {
      EXPECT_NEAR(p.at("value").get<double>(), 2e-4, 2e-5);
    }
  }
  EXPECT_EQ(ids, (std::vector<std::string>{"friction_level", "clearance", "compliance"}));
  EXPECT_GT(data.at("reversals").at("of_sense").get<int>(), 5);
  EXPECT_TRUE(data.at("run_downs").at("drag").is_array());
  EXPECT_GT(data.at("ripple").at("highest_order").get<double>(), 10.0);
  const ProgramResult written = place.run({"diagnose", "a.toml", "b.csv", "--out", "out"});
  ASSERT_EQ(written.exit_code, 0) << written.err;
  const ProgramResult again =
      place.run({"diagnose", "out/model.toml", "b.csv", "--format", "json"});
  EXPECT_EQ(json::parse(again.out).at("verdict"), "no_discrepancy") << again.out;
  // Turned the other way round it is refused.
  place.write("r.csv", with_both_angles(log, 11.0 * arcmin, 2e-4, -1.0));
  const ProgramResult reversed = place.run({"diagnose", "a.toml", "r.csv"});
  EXPECT_EQ(reversed.exit_code, 2);
  EXPECT_NE(reversed.err.find("motor_angle_rad turns -0.99"), std::string::npos) << reversed.err;
}

TEST(DiagnoseMotion, AThirdOfTheRowsMayBeLostByChance) {
  const Workplace place;
  put_example(place);
  std::mt19937 random(3);
  place.write("l.csv", thinned(place.read("m.csv"), [&](int) { return random() % 3 == 0; }));
  const ProgramResult result = place.run({"diagnose", "a.toml", "l.csv", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(data.at("verdict"), "explained");
  ASSERT_EQ(data.at("effects").size(), 1U);
  EXPECT_EQ(data.at("effects")[0].at("id"), "friction_level");
  EXPECT_NEAR(data.at("effects")[0].at("parameters")[0].at("value").get<double>(), 0.4, 0.02);
}

// A limit that noise lets go now and then: 3.7 A of 4.6.
TEST(DiagnoseMotion, NumbersThatNoActuatorHasLeaveTheStatedOnes) {
  const Workplace place;
  std::string actuator = example("actuators/knee.toml");
  const std::string loss = "no_load_current_a = 0.234";
  place.write("a.toml",
              actuator.replace(actuator.find(loss), loss.size(), "no_load_current_a = 0"));
  place.write("m.csv", scaled(example("measurements/knee_motion.csv"), 2, 1e-12));
  const ProgramResult result =
      place.run({"diagnose", "a.toml", "m.csv", "--out", "out", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(data.at("verdict"), "unexplained");
  EXPECT_NE(data.at("notes").dump().find("no ACTUATOR can have the numbers"), std::string::npos);
  EXPECT_NE(place.read("out/model.toml").find("torque_constant_nm_per_a = 0.0369\n"),
            std::string::npos);
  EXPECT_EQ(place.run({"actuator", "out/model.toml"}).exit_code, 0);
}

TEST(DiagnoseMotion, AClippedCurrentWithNoiseIsLeftOut) {
  const Workplace place;
  put_example(place);
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 0.02);
  place.write("c.csv", altered(place.read("m.csv"), [&](std::vector<std::string>& all) {
                const double current = std::stod(all.at(2)) + noise(random);
                all.at(2) = fmt::format("{:.4f}", std::clamp(current, -3.7, 3.7));
              }));
  const ProgramResult result = place.run({"diagnose", "a.toml", "c.csv", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  ASSERT_FALSE(data.at("effects").empty());
  EXPECT_EQ(data.at("effects")[0].at("id"), "friction_level");
  EXPECT_NEAR(data.at("effects")[0].at("parameters")[0].at("value").get<double>(), 0.4, 0.03);
  EXPECT_NE(data.at("notes").dump().find("motor_current_a stays at its limit"), std::string::npos);
}

TEST(DiagnoseMotion, ErrorsOfTheActuatorAndOfLogsAreToldTogether) {
  const test::Workplace place;
  place.write("a.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = \"x\"\n"
              "[gearbox]\nratio = 0.0\nefficiency_forward = 0.8\nefficiency_backward = 0.7\n");
  std::string log = "# kind: dynamic\ntime_s,speed_rad_s,motor_current_a\n";
  place.write("bad.csv", log + "0,1,few\n");
  // Without errors but for what is held against the ACTUATOR, which is not known.
  for (int k = 0; k < 60; ++k) log += std::to_string(0.01 * k) + ",1,2\n";
  place.write("good.csv", log);
  const test::ProgramResult run = place.run({"diagnose", "a.toml", "good.csv", "bad.csv"});
  EXPECT_EQ(run.exit_code, 2);
  for (const char* said :
       {"a.toml:3:1: motor.torque_constant_nm_per_a = \"x\": allowed:",
        "a.toml:5:1: gearbox.ratio = 0: allowed: a number, -1e+06 to 1e+06, but 0",
        "bad.csv:3:5: motor_current_a = \"few\": allowed:"}) {
    EXPECT_NE(run.err.find(said), std::string::npos) << said << '\n' << run.err;
  }
  EXPECT_EQ(run.err.find("good.csv"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace gear3k::diagnose_motion_test
