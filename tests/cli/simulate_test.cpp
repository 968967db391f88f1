// `gear3k simulate`: files, ledger, exit codes, what the inverse hands over.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/other_path.hpp"
#include "tests/cli/run_program.hpp"

namespace gear3k::simulate_cli_test {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::OtherPath, test::ProgramResult, test::replaced;
using test::Workplace;

const std::string kSwinging =
    "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\nrotor_inertia_kgm2 = 2e-5\n"
    "coulomb_torque_nm = 0.004\n"
    "[gearbox]\nratio = 50.0\nefficiency_forward = 0.8\nefficiency_backward = 0.7\n"
    "coulomb_torque_nm = 0.3\nviscous_nms_per_rad = 0.02\n[load]\ninertia_kgm2 = 0.01\n";

TEST(Simulate, WritesMotionEventsLedgerAndFigure) {
  const Workplace place;
  place.write("a.toml", example("actuators/knee.toml"));
  place.write("s.toml", example("actuators/knee_swing.toml"));
  const ProgramResult result =
      place.run({"simulate", "a.toml", "s.toml", "--out", "out", "--format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  EXPECT_EQ(json::parse(place.read("out/ledger.json")), data);
  EXPECT_LT(data.at("ledger").at("balance_error").get<double>(), 1e-9);
  int entered = 0;
  for (const char* mode : {"stick", "forward", "backward"}) {
    entered += data.at("modes").at(mode).at("entries").get<int>();
    EXPECT_GT(data.at("modes").at(mode).at("time_s").get<double>(), 0.0) << mode;
  }
  EXPECT_GE(entered, 12);
  std::size_t events = 0;
  for (const auto& count : data.at("events")) events += count.get<std::size_t>();
  EXPECT_EQ(lines_of(place.read("out/events.csv")).size(), events + 1);
  EXPECT_GT(lines_of(place.read("out/motion.csv")).size(), 1000U);
  EXPECT_FALSE(data.contains("missing_figures"));  // ./run and ./check install gnuplot
  EXPECT_NE(place.read("out/motion.svg").find("backward flow"), std::string::npos);
}

TEST(Simulate, WithoutGnuplotTellsInBothWhatIsMissing) {
  const Workplace place;
  place.write("a.toml", kSwinging);
  place.write("s.toml", "duration_s = 0.1\n[control]\nmode = \"voltage\"\nvoltage_v = 24.0\n");
  ProgramResult result;
  {
    const OtherPath path("");
    result = place.run({"simulate", "a.toml", "s.toml", "--out", "out", "--format", "json"});
  }
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(place.read("out/ledger.json"), result.out);
  const json missing = json::parse(result.out).at("missing_figures");
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing.at(0).at("file"), "motion.svg");
  EXPECT_FALSE(place.has("out/motion.svg"));
}

// 24 V on a shorted-rotor current of 24/0.6 = 40 A at the first instant; the motor's speed at the
// end is below the no-load speed 24/0.04.
TEST(Simulate, TellsWhichLimitsOfMotorAndDriveItPasses) {
  const Workplace place;
  place.write("a.toml", replaced(kSwinging, "[gearbox]",
                                 "max_current_a = 30.0\nmax_speed_rad_s = "
                                 "600.0\n[drive]\nbus_voltage_v = 24.0\n"
                                 "[gearbox]"));
  place.write("s.toml", "duration_s = 0.5\n[control]\nmode = \"voltage\"\nvoltage_v = 24.0\n");
  const ProgramResult result = place.run({"simulate", "a.toml", "s.toml", "--format", "json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json data = json::parse(result.out);
  const json& checks = data.at("checks");
  ASSERT_EQ(checks.size(), 3U);
  EXPECT_EQ(checks[0].at("name"), "current");
  EXPECT_NEAR(checks[0].at("value").get<double>(), 40.0, 1e-9);
  EXPECT_EQ(checks[0].at("ok"), false);
  EXPECT_EQ(checks[1].at("ok"), true);
  EXPECT_EQ(checks[2].at("ok"), true);
  EXPECT_LT(data.at("peak_motor_speed_rad_s").get<double>(), 600.0);
  EXPECT_GT(data.at("peak_motor_speed_rad_s").get<double>(), 300.0);
  EXPECT_NE(data.at("notes").dump().find("current reaches 40 A"), std::string::npos) << data;
}

TEST(Simulate, TheTorqueThatACycleAsksForReturnsTheCycle) {
  const Workplace place;
  place.write("a.toml", kSwinging);
  place.write("c.csv",
              "time_s,torque_nm,speed_rad_s\n0,1,0.5\n0.4,-3,2\n0.9,4,-1.5\n1.5,-2,1\n2,1,0.5\n");
  const ProgramResult inverse =
      place.run({"actuator", "a.toml", "--cycle", "c.csv", "--format", "csv", "--quiet"});
  ASSERT_EQ(inverse.exit_code, 0) << inverse.err;
  place.write("torque.csv", inverse.out);
  place.write("s.toml",
              "duration_s = 2.0\n[start]\noutput_speed_rad_s = 0.5\n[control]\nmode = \"torque\"\n"
              "table = \"torque.csv\"\n[load]\ntable = \"c.csv\"\n[output]\nsample_s = 0.1\n");
  const ProgramResult forward = place.run({"simulate", "a.toml", "s.toml", "--format", "json"});
  ASSERT_EQ(forward.exit_code, 0) << forward.err;
  const json end = json::parse(forward.out).at("end");
  EXPECT_NEAR(end.at("output_speed_rad_s").get<double>(), 0.5, 2e-6);
  const double way = 0.2 * 2.5 + 0.25 * 0.5 + 0.3 * -0.5 + 0.25 * 1.5;
  EXPECT_NEAR(end.at("output_angle_rad").get<double>(), way, 2e-6);
}

TEST(Simulate, NamesAJamAndKeepsGoing) {
  const Workplace place;
  place.write("a.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n"
              "rotor_inertia_kgm2 = 1e-6\n[gearbox]\nratio = 50.0\nefficiency_forward = 0.4\n"
              "efficiency_backward = -0.5\n[load]\ninertia_kgm2 = 0.1\n");
  place.write("s.toml",
              "duration_s = 1.0\n[start]\noutput_speed_rad_s = 1.0\n[control]\nmode = \"open\"\n"
              "[load]\ntorque_nm = 0.2\n");
  const ProgramResult result = place.run({"simulate", "a.toml", "s.toml"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("the self-locking train jams at 0 s"), std::string::npos) << result.out;
  const json data =
      json::parse(place.run({"simulate", "a.toml", "s.toml", "--format", "json"}).out);
  EXPECT_NEAR(data.at("ledger").at("loss_j").at("jam").get<double>(), 0.5 * (0.1 + 2500.0 * 1e-6),
              1e-12);
}

TEST(Simulate, TellsErrorsOfBothFilesAtOnce) {
  const Workplace place;
  place.write("a.toml", kSwinging + "mass_kg = -1.0\n");
  place.write("s.toml", "duration_s = 1.0\n[control]\nmode = \"torqe\"\n");
  const ProgramResult result = place.run({"simulate", "a.toml", "s.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("a.toml:14:"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("s.toml:3:1: control.mode"), std::string::npos) << result.err;
  place.write("swapped.toml", kSwinging);
  const ProgramResult swapped = place.run({"simulate", "swapped.toml", "swapped.toml"});
  EXPECT_EQ(swapped.exit_code, 2);
  EXPECT_NE(swapped.err.find("looks like an ACTUATOR"), std::string::npos) << swapped.err;
}

TEST(Simulate, AnActuatorWithoutInertiaIsRefusedByName) {
  const Workplace place;
  place.write("a.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n[gearbox]\n"
              "ratio = 50.0\nefficiency_forward = 0.4\nefficiency_backward = 0.5\n");
  place.write("s.toml", "duration_s = 1.0\n[control]\nmode = \"open\"\n");
  const ProgramResult result = place.run({"simulate", "a.toml", "s.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("have no inertia"), std::string::npos) << result.err;
}

// The published prototype interferes at its one centre distance; without face widths its gears have
// no inertia.
TEST(Simulate, SaysWhatTheDesignLacksAsActuatorDoes) {
  const Workplace place;
  place.write("d.toml", example("designs/low_backlash_prototype.toml"));
  place.write("a.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n"
              "rotor_inertia_kgm2 = 2e-5\n[gearbox]\ndesign = \"d.toml\"\n"
              "[load]\ninertia_kgm2 = 0.1\n");
  place.write("s.toml", "duration_s = 0.1\n[control]\nmode = \"torque\"\ntorque_nm = 0.1\n");
  const ProgramResult moved = place.run({"simulate", "a.toml", "s.toml", "--format", "json"});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const ProgramResult reflected = place.run({"actuator", "a.toml"});
  for (const char* part : {"fails checks of `gear3k analyze`", "normal backlash", "no inertia"}) {
    EXPECT_NE(json::parse(moved.out).at("notes").dump().find(part), std::string::npos) << moved.out;
    const std::size_t told = moved.err.find(part);
    EXPECT_NE(told, std::string::npos) << moved.err;
    EXPECT_EQ(moved.err.find(part, told + 1), std::string::npos) << "once: " << moved.err;
    EXPECT_NE((reflected.out + reflected.err).find(part), std::string::npos);
  }
}

TEST(Simulate, TooManyEventsEndWithWhatIsDone) {
  const Workplace place;
  place.write("s.toml", place.run({"new", "scenario"}).out + "\n[solver]\nmax_events = 3\n");
  place.write("a.toml", kSwinging);
  const ProgramResult result = place.run({"simulate", "a.toml", "s.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_NE(result.out.find("more than solver.max_events = 3"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(" s of 4 s, 4 events"), std::string::npos) << result.out;
  // Whoever reads stderr alone learns why, quiet or not, and once.
  for (const char* format : {"table", "json", "csv"}) {
    const ProgramResult quiet =
        place.run({"simulate", "a.toml", "s.toml", "--quiet", "--format", format});
    EXPECT_EQ(quiet.exit_code, 4);
    EXPECT_EQ(quiet.err.find("s.toml: ended at "), 0U) << quiet.err;
    EXPECT_EQ(std::ranges::count(quiet.err, '\n'), 1) << quiet.err;
    const ProgramResult loud = place.run({"simulate", "a.toml", "s.toml", "--format", format});
    EXPECT_EQ(loud.err, quiet.err);
  }
  EXPECT_FALSE(json::parse(place.read("out/ledger.json")).at("complete").get<bool>());
}

// Of a motion that would take minutes.
TEST(Simulate, KeepsOnCtrlCWhatIsDone) {
  const Workplace place;
  place.write("a.toml", kSwinging);
  place.write("s.toml",
              "duration_s = 1e6\n[control]\nmode = \"torque\"\ntorque_amplitude_nm = 0.05\n"
              "frequency_hz = 0.7\n[output]\nsample_s = 0.1\n[solver]\nmax_events = 10000000\n");
  test::RunningProgram program = place.start({"simulate", "a.toml", "s.toml", "--out", "out"});
  ASSERT_TRUE(program.wait_until_it_catches(SIGINT, std::chrono::seconds(10)));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  program.send(SIGINT);
  const auto result = program.wait(std::chrono::seconds(20));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->exit_code, 130) << result->err;
  EXPECT_TRUE(result->err.starts_with("s.toml: ended at ")) << result->err;
  EXPECT_TRUE(result->err.ends_with(" s of 1e+06 s: interrupted\n")) << result->err;
  const json data = json::parse(place.read("out/ledger.json"));
  EXPECT_EQ(data.at("complete"), false);
  EXPECT_EQ(data.at("interrupted"), true);
  const double end_s = data.at("end").at("time_s").get<double>();
  EXPECT_GT(end_s, 0.0);
  EXPECT_LT(data.at("ledger").at("balance_error").get<double>(), 1e-9);
  // The rows go up to there, and are those of a run that asks for no more.
  const std::vector<std::string> rows = lines_of(place.read("out/motion.csv"));
  EXPECT_EQ(std::stod(rows.back()), end_s);
  place.write("s.toml",
              "duration_s = 2\n[control]\nmode = \"torque\"\ntorque_amplitude_nm = 0.05\n"
              "frequency_hz = 0.7\n[output]\nsample_s = 0.1\n");
  const ProgramResult whole = place.run({"simulate", "a.toml", "s.toml", "--format", "csv"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::vector<std::string> first = lines_of(whole.out);
  ASSERT_GT(first.size(), 15U);
  ASSERT_GT(rows.size(), 15U);
  for (std::size_t k = 0; k < 15; ++k) EXPECT_EQ(rows[k], first[k]);
}

}  // namespace
}  // namespace gear3k::simulate_cli_test
