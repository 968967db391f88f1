// SCENARIO.toml and its tables: what follows from the keys, and what is refused.
#include "io/files/scenario_file.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "io/text/diagnostics.hpp"

namespace gear3k::scenario_file_test {
namespace {

using io::InvalidInput, io::parse_scenario, io::parse_time_table;

const std::string kTop = "duration_s = 2.0\n";

std::string scenario_error(const std::string& text) {
  try {
    static_cast<void>(parse_scenario(text, "s.toml"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

const io::TimeTableKind kLoad{.columns = {"torque_nm", "load_nm"}, .torque_of_load = true};

std::string table_error(const std::string& text) {
  motion::Signal signal;
  try {
    parse_time_table(text, "t.csv", kLoad, signal);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ScenarioFile, TheCommandIsThatOfTheMode) {
  const auto torque = parse_scenario(kTop +
                                         "[control]\nmode = \"torque\"\ntorque_nm = 0.5\n"
                                         "torque_amplitude_nm = 0.25\nfrequency_hz = 3.0\n"
                                         "phase_deg = 90.0\n",
                                     "s.toml")
                          .scenario;
  EXPECT_EQ(torque.control, motion::Control::kTorque);
  EXPECT_EQ(torque.command.constant, 0.5);
  EXPECT_EQ(torque.command.amplitude, 0.25);
  EXPECT_DOUBLE_EQ(torque.command.phase_rad, 0.5 * std::numbers::pi);
  const auto position = parse_scenario(kTop +
                                           "[control]\nmode = \"position\"\nangle_rad = 0.5\n"
                                           "stiffness_nm_per_rad = 20.0\n",
                                       "s.toml")
                            .scenario;
  EXPECT_EQ(position.command.constant, 0.5);
  EXPECT_EQ(position.control_stiffness_Nm_rad, 20.0);
}

TEST(ScenarioFile, TellsAllThatIsWrongAtOnceWithItsPlace) {
  const std::string error = scenario_error(
      "duration_s = -1.0\n[control]\nmode = \"torque\"\nvoltage_v = 3.0\n"
      "torque_amplitude_nm = 1.0\n[load]\npendulum_mass_kg = 1.0\ninertia_kgm = 2.0\n");
  EXPECT_TRUE(has(error, "s.toml:1:1: duration_s = -1")) << error;
  EXPECT_TRUE(has(error,
                  "s.toml:4:1: control.voltage_v: allowed: with control.mode = "
                  "\"voltage\""))
      << error;
  EXPECT_TRUE(has(error,
                  "s.toml:5:1: control.torque_amplitude_nm: allowed: with "
                  "control.frequency_hz"))
      << error;
  EXPECT_TRUE(has(error, "load.pendulum_length_m")) << error;
  EXPECT_TRUE(has(error, "did you mean load.inertia_kgm2")) << error;
}

TEST(ScenarioFile, AModeWantsItsOwnKeys) {
  EXPECT_TRUE(has(scenario_error(kTop + "[control]\nmode = \"position\"\n"),
                  "control.stiffness_nm_per_rad is missing"));
  EXPECT_TRUE(has(scenario_error(kTop + "[control]\nmode = \"open\"\nfrequency_hz = 1.0\n"),
                  "control.frequency_hz: allowed"));
  EXPECT_TRUE(has(scenario_error(kTop + "[control]\nmode = \"torque\"\n[output]\n"
                                        "sample_s = 1e-9\n"),
                  "output.sample_s = 1e-09: allowed: 2e-07 or more"));
  EXPECT_TRUE(has(scenario_error("[motor]\nresistance_ohm = 1\n"), "looks like an ACTUATOR"));
}

TEST(ScenarioFile, RefusesKeysThatDoNothing) {
  const std::string error = scenario_error(
      kTop + "[control]\nmode = \"voltage\"\nfrequency_hz = 2.0\nphase_deg = 3.0\n[load]\n" +
      "frequency_hz = 3.0\nphase_deg = 20.0\nrest_angle_rad = 1.0\npendulum_angle_rad = 1.0\n" +
      "gravity_m_s2 = 3.0\n");
  for (const char* part : {"s.toml:4:1: control.frequency_hz: allowed: with control.voltage_amp",
                           "s.toml:5:1: control.phase_deg: allowed: with control.voltage_amp",
                           "s.toml:7:1: load.frequency_hz: allowed: with load.torque_amplitude_nm",
                           "s.toml:8:1: load.phase_deg: allowed: with load.torque_amplitude_nm",
                           "s.toml:9:1: load.rest_angle_rad: allowed: with load.stiffness_nm_per",
                           "s.toml:10:1: load.pendulum_angle_rad: allowed: with load.pendulum_mass",
                           "s.toml:11:1: load.gravity_m_s2: allowed: with load.pendulum_mass_kg"}) {
    EXPECT_TRUE(has(error, part)) << part << " is not in\n" << error;
  }
}

TEST(ScenarioFile, AMissingTableIsToldBesideTheKeys) {
  const std::string error =
      scenario_error("[control]\nmode = \"torque\"\ntable = \"no/such.csv\"\n");
  EXPECT_TRUE(has(error, "duration_s")) << error;
  EXPECT_TRUE(has(error, "no/such.csv")) << error;
}

TEST(TimeTable, TwoRowsOfATimeAreAJump) {
  motion::Signal signal;
  parse_time_table("# note\nload_nm,time_s\n1,0\n2,1\n5,1\n7,1\n9,2\n", "t.csv", kLoad, signal);
  EXPECT_EQ(signal.time_s, (std::vector<double>{0.0, 1.0, 1.0, 2.0}));
  EXPECT_EQ(signal.value, (std::vector<double>{1.0, 2.0, 7.0, 9.0}));
  EXPECT_EQ(value_at(signal, 1.0, piece_from(signal, 0.5)), 2.0);
  EXPECT_EQ(value_at(signal, 1.0, piece_from(signal, 1.0)), 7.0);
  EXPECT_EQ(slope_at(signal, 1.5, piece_from(signal, 1.5)), 2.0);
  EXPECT_EQ(value_at(signal, 8.0, piece_from(signal, 8.0)), 9.0);
  EXPECT_EQ(value_at(signal, -1.0, piece_from(signal, -1.0)), 1.0);
}

TEST(TimeTable, TorqueOfTheActuatorHasTheOtherSign) {
  const auto values = [](const std::string& text, const io::TimeTableKind& kind) {
    motion::Signal signal;
    parse_time_table(text, "t.csv", kind, signal);
    return signal.value;
  };
  const std::string rows = "time_s,torque_nm\n0,1\n1,-2\n";
  EXPECT_EQ(values("# torque: actuator\n" + rows, kLoad), (std::vector<double>{-1.0, 2.0}));
  EXPECT_EQ(values(rows + "#torque: actuator\n", kLoad), (std::vector<double>{-1.0, 2.0}));
  EXPECT_EQ(values("# torque: load\n" + rows, kLoad), (std::vector<double>{1.0, -2.0}));
  EXPECT_TRUE(
      has(table_error("# torque: motor\n" + rows), "t.csv:1:1: # torque: motor: allowed: load"));
  // A command is no torque of the load.
  EXPECT_EQ(values("# torque: motor\ntime_s,angle_rad\n0,1\n", {.columns = {"angle_rad"}}),
            (std::vector<double>{1.0}));
}

TEST(TimeTable, HasOneHeaderOfEachColumn) {
  EXPECT_TRUE(has(table_error("time_s,torque_mm\n0,1\n"),
                  "t.csv:1:1: column torque_nm or load_nm is missing: allowed: time_s, and "
                  "torque_nm or load_nm; is column torque_mm it?"));
  EXPECT_TRUE(has(table_error("time_s,load_nm,time_s\n0,1,2\n"),
                  "t.csv:1:16: column time_s stands twice, first as column 1"));
  EXPECT_TRUE(has(table_error("time_s,torque_nm,load_nm\n0,1,2\n"),
                  "t.csv:1:18: columns torque_nm and load_nm: allowed: one of them"));
  EXPECT_TRUE(has(table_error("time_s,torque_nm\n0,1\n1,-2e9\n"),
                  "t.csv:3:3: torque_nm = \"-2e9\": allowed: a number from -1e+09 to 1e+09"));
}

TEST(TimeTable, RefusesWhatIsNoTable) {
  EXPECT_TRUE(has(table_error(""), "t.csv:1:1: no header"));
  EXPECT_TRUE(has(table_error("time_s,torque_nm\n"), "no row below the header"));
  EXPECT_TRUE(has(table_error("time_s,torque\n0,1\n"), "column torque_nm or load_nm is missing"));
  const std::string error = table_error("time_s,torque_nm\n0,x\n1,2\n0.5,3\n2\n");
  EXPECT_TRUE(has(error, "t.csv:2:3: torque_nm = \"x\"")) << error;
  EXPECT_TRUE(has(error, "t.csv:4:1: time_s = 0.5 after 1")) << error;
  EXPECT_TRUE(has(error, "t.csv:5:1: 1 fields")) << error;
}

}  // namespace
}  // namespace gear3k::scenario_file_test
