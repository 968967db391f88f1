// Notes of DATA, logs of motion, CYCLE and tables of a SCENARIO that are nearly right, have no part
// in their file or contradict each other; and comments that must stay free.
#include "io/files/header_notes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/files/cycle_file.hpp"
#include "io/files/measurement_file.hpp"
#include "io/files/motion_log_file.hpp"
#include "io/files/scenario_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::header_notes_test {
namespace {

using io::InvalidInput;
using Texts = std::vector<std::string>;

template <class Read>
std::string error_of(const Read& read) {
  try {
    static_cast<void>(read());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// Rows below the notes of each reader; all of them are valid without more notes.
const std::string kTransmission =
    "# kind: transmission\ndirection,sun_speed_rpm,output_torque_nm,sun_torque_nm,run\n"
    "forward,100,5,0.1,a\n";
const std::string kLost =
    "# kind: lost_motion\noutput_angle_deg,test_torque_nm,lost_motion_arcmin\n0,1,20\n";
const std::string kLoop = "# kind: torque_angle\ntime_s,angle_deg,torque_nm\n0,0,0\n1,1,1\n";
const std::string kPairs = "# kind: pair_loss\ndriving_teeth,driven_teeth,loss_factor\n16,80,0.1\n";
const std::string kCycle = "time_s,torque_nm,speed_rad_s\n0,10,2\n1,10,2\n";
const std::string kTable = "time_s,torque_nm\n0,10\n1,10\n";

std::string log_text() {
  std::string text = "# kind: dynamic\ntime_s,speed_rad_s,motor_torque_nm,output_torque_nm\n";
  for (int k = 0; k < 60; ++k) text += fmt::format("{:.2f},{},{},2\n", 0.01 * k, k, k + 1);
  return text;
}

std::string data_error(const std::string& text) {
  return error_of([&] { return io::parse_measurements({{"f.csv", text}}); });
}
std::string log_error(const std::string& text) {
  return error_of([&] {
    return io::parse_motion_log("f.csv", text,
                                {.ratio = 10.0, .torque_constant_Nm_A = 0.05, .load_kgm2 = 0.3});
  });
}
std::string cycle_error(const std::string& text) {
  return error_of([&] { return io::parse_cycle(text, "f.csv"); });
}
std::string table_error(const std::string& text) {
  return error_of([&] {
    motion::Signal signal;
    io::parse_time_table(text, "f.csv", {.columns = {"torque_nm"}, .torque_of_load = true}, signal);
    return signal;
  });
}
Texts data_notes(const std::string& text) {
  return io::parse_measurements({{"f.csv", text}}).sets.at(0).notes;
}

TEST(HeaderNotes, ANoteOfATorqueThatIsNearlyRightIsRefused) {
  struct Case {
    std::string written, shown;
  };
  const std::vector<Case> cases{{"# Torque: actuator", "# Torque: actuator"},
                                {"#TORQUE:load", "# TORQUE: load"},
                                {"# torques: actuator", "# torques: actuator"},
                                {"# torqe: actuator,,", "# torqe: actuator"},
                                {"# troque: Actuator", "# troque: Actuator"},
                                {"# torque = actuator", "# torque = actuator"},
                                {"# Torque=load", "# Torque = load"},
                                {"# torqeu: actuater", "# torqeu: actuater"},
                                {"# Torque: of the load", "# Torque: of the load"}};
  for (const Case& c : cases) {
    const std::string message =
        fmt::format("f.csv:1:1: {}: did you mean # torque:? allowed: load or actuator", c.shown);
    EXPECT_EQ(cycle_error(c.written + "\n" + kCycle), message);
    EXPECT_EQ(table_error(c.written + "\n" + kTable), message);
    EXPECT_EQ(log_error(c.written + "\n" + log_text()), message);
  }
}

TEST(HeaderNotes, ANoteOfDataThatIsNearlyRightIsRefused) {
  struct Case {
    std::string text, message;
  };
  const std::string kinds = "transmission or lost_motion or torque_angle or pair_loss or dynamic";
  const std::string gearbox = "the name of the gearbox that was measured";
  const std::vector<Case> cases{
      {"# Unit: A\n" + kTransmission, "# Unit: A: did you mean # unit:? allowed: " + gearbox},
      {"# uint: A\n" + kTransmission, "# uint: A: did you mean # unit:? allowed: " + gearbox},
      {"# unit = A\n" + kTransmission, "# unit = A: did you mean # unit:? allowed: " + gearbox},
      {"# Sensor: reference\n" + kPairs,
       "# Sensor: reference: did you mean # sensor:? allowed: reference"},
      {"# senser: reference\n" + kLost,
       "# senser: reference: did you mean # sensor:? allowed: reference"},
      {"# Runs: shared\n" + kLost, "# Runs: shared: did you mean # runs:? allowed: shared"},
      {"# Locked: output\n" + kLoop,
       "# Locked: output: did you mean # locked:? allowed: sun or output"},
      {"# lockd: sun\n" + kLoop, "# lockd: sun: did you mean # locked:? allowed: sun or output"},
      {"# Kind: transmission\na,b\n",
       "# Kind: transmission: did you mean # kind:? allowed: " + kinds},
      {"# knid: pair_los\na,b\n", "# knid: pair_los: did you mean # kind:? allowed: " + kinds}};
  for (const Case& c : cases) EXPECT_EQ(data_error(c.text), "f.csv:1:1: " + c.message);
}

TEST(HeaderNotes, ANoteOfALogThatIsNearlyRightIsRefused) {
  for (const char* key : {"Load_inertia_kgm2", "load_inertia_kg_m2", "load_inertia", "Load inertia",
                          "load-inertia-kgm2", "load_inertia_gcm2"}) {
    EXPECT_EQ(log_error(fmt::format("# {}: 0.12\n", key) + log_text()),
              fmt::format("f.csv:1:1: # {}: 0.12: did you mean # load_inertia_kgm2:? allowed: a "
                          "number, at least 0",
                          key));
  }
  EXPECT_EQ(log_error("# load_inertia_kgm2 = 0\n" + log_text()),
            "f.csv:1:1: # load_inertia_kgm2 = 0: did you mean # load_inertia_kgm2:? allowed: a "
            "number, at least 0");
}

TEST(HeaderNotes, ThatHaveNoPartInTheirFileAreRefused) {
  struct Case {
    std::string note, text, message;
  };
  const std::string common = "# kind:, # unit:, # sensor:, # runs:";
  const std::vector<Case> cases{
      {"# torque: actuator", kTransmission, "transmission, allowed: " + common},
      {"# locked: output", kTransmission, "transmission, allowed: " + common},
      {"# load_inertia_kgm2: 0.12", kTransmission, "transmission, allowed: " + common},
      {"# locked: sun", kPairs, "pair_loss, allowed: " + common},
      {"# torque: load", kLost, "lost_motion, allowed: " + common + ", # locked:"}};
  for (const Case& c : cases) {
    EXPECT_EQ(data_error(c.note + "\n" + c.text),
              fmt::format("f.csv:1:1: {}: has no part in kind {}", c.note, c.message));
  }
  for (const char* note : {"# unit: A", "# sensor: reference", "# runs: shared", "# locked: sun"}) {
    EXPECT_EQ(log_error(std::string(note) + "\n" + log_text()),
              fmt::format("f.csv:1:1: {}: has no part in kind dynamic, allowed: # kind:, # "
                          "torque:, # load_inertia_kgm2:",
                          note));
  }
}

TEST(HeaderNotes, OfOneKeyThatDifferAreRefusedByEveryReader) {
  const auto after = [](const std::string& key, const std::string& now, const std::string& before) {
    return fmt::format("f.csv:2:1: # {}: {} after # {}: {}: allowed: one of them", key, now, key,
                       before);
  };
  EXPECT_EQ(data_error("# locked: sun\n# locked: output\n" + kLoop),
            after("locked", "output", "sun"));
  EXPECT_EQ(data_error("# unit: A\n# unit: B\n" + kTransmission), after("unit", "B", "A"));
  EXPECT_EQ(data_error("# kind: lost_motion\n# kind: dynamic\noutput_angle_deg,test_torque_nm,"
                       "lost_motion_arcmin\n0,1,20\n"),
            after("kind", "dynamic", "lost_motion"));
  EXPECT_EQ(log_error("# torque: load\n# torque: actuator\n" + log_text()),
            after("torque", "actuator", "load"));
  EXPECT_EQ(log_error("# load_inertia_kgm2: 0.12\n# load_inertia_kgm2: 0\n" + log_text()),
            after("load_inertia_kgm2", "0", "0.12"));
  EXPECT_EQ(cycle_error("# torque: load\n# torque: actuator\n" + kCycle),
            after("torque", "actuator", "load"));
  EXPECT_EQ(table_error("# torque: actuator\n# torque: load\n" + kTable),
            after("torque", "load", "actuator"));
  // Twice the same says one thing.
  EXPECT_EQ(log_error("# load_inertia_kgm2: 0.12\n# load_inertia_kgm2: 0.120\n" + log_text()), "");
  EXPECT_EQ(cycle_error("# torque: load\n# torque: load\n" + kCycle), "");
  EXPECT_EQ(data_error("# locked: sun\n# locked: sun\n" + kLost), "");
}

TEST(HeaderNotes, AKindOfLogsBelowTheHeaderIsToldItsPlace) {
  EXPECT_EQ(data_error("time_s,speed_rad_s\n# kind: dynamic\n0,1\n"),
            "f.csv:2:1: # kind: dynamic: allowed: above the header");
}

TEST(HeaderNotes, CommasOfSpreadsheetsAreTakenAwayByEveryReader) {
  const auto sign = [](const std::string& note) {
    return io::parse_cycle(note + kCycle, "f.csv").load_Nm.at(0);
  };
  EXPECT_EQ(sign("# torque: actuator,,\n"), -10.0);
  EXPECT_EQ(sign("# torque: actuator , ,\r\n"), -10.0);
  EXPECT_EQ(sign("# torque: load,,\n"), 10.0);
  motion::Signal signal;
  io::parse_time_table("# torque: actuator,\n" + kTable, "f.csv",
                       {.columns = {"torque_nm"}, .torque_of_load = true}, signal);
  EXPECT_EQ(signal.value.at(0), -10.0);
}

TEST(HeaderNotes, FreeTextStaysFree) {
  const Texts comments{"source: a rig of our own",
                       "date: 2024-05-01",
                       "operator: unit 7 of the shop",
                       "note: torque = load times ratio",
                       "mode: 1",
                       "find: see the log book",
                       "mind: the gap",
                       "init: 3 s",
                       "until: noon",
                       "logged: at 1 kHz",
                       "loaded: 5 kg",
                       "located: room 3",
                       "sender: A",
                       "score: 3",
                       "load: a beam",
                       "torque sensor: Kistler 4503A",
                       "Torque sensor calibrated: 2024",
                       "unit under test: A",
                       "rig 2: sensor = reference of the shop",
                       "sum = 3",
                       "torque = measured at the flange",
                       "no colon at all",
                       ":",
                       "= 3",
                       ""};
  std::string head;
  for (const std::string& c : comments) head += "# " + c + "\n";
  for (const std::string& text : {kTransmission, kLost, kPairs, "# locked: sun\n" + kLoop}) {
    EXPECT_EQ(data_error(head + text), "");
  }
  EXPECT_EQ(log_error(head + log_text()), "");
  EXPECT_EQ(cycle_error(head + kCycle), "");
  EXPECT_EQ(table_error(head + kTable), "");
  // One file may be both a log and a table: notes of other readers are none of a table's business.
  EXPECT_EQ(cycle_error("# kind: dynamic\n# load_inertia_kgm2: 0.1\n# unit: Nm\n" + kCycle), "");
}

TEST(HeaderNotes, ThatLookLikeColumnsAreNoted) {
  const auto note = [](const std::string& key, int line, const std::string& would) {
    return fmt::format("f.csv: \"# {}:\" in line {} is no note and does not act; {} would", key,
                       line, would);
  };
  EXPECT_EQ(
      data_notes("# temperature_c: 2000\n# sigma_nm: 0\n# temperature_c: 20\n" + kTransmission),
      (Texts{note("temperature_c", 1, "a column of that name"),
             note("sigma_nm", 2, "a column of that name")}));
  // What stands as a column may be described.
  EXPECT_EQ(data_notes("# sun_torque_nm: computed\n# run: one a day\n" + kTransmission), Texts{});
  EXPECT_EQ(data_notes("# run: shared\n" + kTransmission), (Texts{note("run", 1, "\"# runs:\"")}));
  EXPECT_EQ(data_notes("# run: shared\n" + kLost),
            (Texts{note("run", 1, "a column of that name, or \"# runs:\"")}));
  EXPECT_EQ(data_notes("# units: N mm\n" + kTransmission),
            (Texts{note("units", 1, "\"# unit:\"")}));
  EXPECT_EQ(data_notes("# source: x\n# date: y\n" + kTransmission), Texts{});
  // A known key that says nothing the note takes may be a comment.
  EXPECT_EQ(data_notes("# torque: in N m\n# torque: by a flange\n" + kTransmission),
            (Texts{"f.csv: \"# torque:\" in line 1 has no part in kind transmission and does not "
                   "act"}));
  const auto log = io::parse_motion_log("f.csv", "# motor_angle_rad: 0\n" + log_text(),
                                        {.ratio = 10.0, .load_kgm2 = 0.3});
  EXPECT_EQ(log.notes, (Texts{note("motor_angle_rad", 1, "a column of that name")}));
}

TEST(HeaderNotes, ThatLookLikeColumnsInOtherLettersAreNoted) {
  const auto note = [](const std::string& written, const std::string& column) {
    return fmt::format("f.csv: \"# {}\" in line 1 is no note and does not act; a column {} would",
                       written, column);
  };
  for (const auto& [line, told] : std::vector<std::pair<std::string, std::string>>{
           {"# Temperature_c: 20", note("Temperature_c:", "temperature_c")},
           {"# TEMPERATURE_C: about 20", note("TEMPERATURE_C:", "temperature_c")},
           {"# temperature_c = 20", note("temperature_c =", "temperature_c")},
           {"#temperature_c=20,,,", note("temperature_c =", "temperature_c")},
           {"# Temperature C = 20", note("Temperature C =", "temperature_c")},
           {"# temperature-c: 20", note("temperature-c:", "temperature_c")},
           {"# Cycles: 2000", note("Cycles:", "cycles")}}) {
    EXPECT_EQ(data_notes(line + "\n" + kLost), Texts{told}) << line;
  }
  EXPECT_EQ(io::parse_motion_log("f.csv", "# Motor_angle_rad = 0\n" + log_text(),
                                 {.ratio = 10.0, .load_kgm2 = 0.3})
                .notes,
            Texts{note("Motor_angle_rad =", "motor_angle_rad")});
  // Prose, and what stands as a column.
  for (const char* line :
       {"# Temperature was 20", "# temperature = 20 C in the room", "# Cycles: three a point",
        "# cycles = turns of the output", "# Time: 10:30", "# Test_torque_nm: by a lever",
        "# output_angle_deg = of the encoder", "# lost motion = angle between both", "# x = 3"}) {
    EXPECT_EQ(data_notes(std::string(line) + "\n" + kLost), Texts{}) << line;
  }
}

// Every comment of the project's own tables, as a part of each kind of file.
TEST(HeaderNotes, CommentsOfTheTablesOfTheProjectAreNoSlips) {
  std::size_t comments = 0;
  for (const char* folder : {"data", "examples"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             std::filesystem::path(GEAR3K_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".csv") continue;
      io::HeaderNotes notes(
          {"kind", "locked", "sensor", "runs", "unit", "torque", "load_inertia_kgm2"});
      std::ifstream file(entry.path());
      int number = 0;
      for (std::string line; std::getline(file, line);) {
        ++number;
        if (!line.starts_with('#')) continue;
        ++comments;
        notes.read(line, number, [&](const std::string& message) {
          ADD_FAILURE() << entry.path() << ":" << number << ": " << message;
        });
      }
    }
  }
  EXPECT_GT(comments, 50U);
}

}  // namespace
}  // namespace gear3k::header_notes_test
