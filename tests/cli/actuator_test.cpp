// `gear3k actuator`: the contract's JSON, exit codes, figures, designed gearboxes, selections.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace gear3k::actuator_cli_test {
namespace {

using nlohmann::json;
using test::example, test::lines_of, test::ProgramResult, test::Workplace;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The first reference of the actuator's reference numbers.
const std::string kReference =
    "[motor]\nresistance_ohm = 0.5\ntorque_constant_nm_per_a = 0.05\ncoulomb_torque_nm = 0.004\n"
    "[gearbox]\nratio = 50.0\nefficiency_forward = 0.8\nefficiency_backward = 0.6\n"
    "backdriving_torque_nm = 2.0\n";

json result_of(const Workplace& place, std::vector<std::string> options) {
  options.insert(options.begin(), {"actuator", "a.toml", "--format", "json"});
  const ProgramResult result = place.run(options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

TEST(Actuator, PrintsTheFieldsOfTheContract) {
  const Workplace place;
  place.write("a.toml", kReference);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-10,2\n1,-10,2\n");
  const json data = result_of(place, {"--cycle", "c.csv", "--without-each"});
  EXPECT_NEAR(data.at("reflected").at("breakaway_nm").get<double>(), 7.0 / 3.0, 1e-14);
  EXPECT_TRUE(data.at("reflected").at("stiffness_nm_per_rad").at("total").is_null());
  const json& cycle = data.at("cycle");
  EXPECT_NEAR(cycle.at("peak_current_a").get<double>(), 5.58, 1e-13);
  EXPECT_NEAR(cycle.at("electrical_energy_j").at("drawn").get<double>(), 43.4682, 1e-11);
  EXPECT_NEAR(cycle.at("loss_j").at("mesh").get<double>(), 5.5, 1e-12);
  EXPECT_TRUE(cycle.at("without_each").contains("mesh"));
  EXPECT_TRUE(result_of(place, {}).at("cycle").is_null());
}

TEST(Actuator, ATorqueOfTheActuatorHasTheOtherSign) {
  const Workplace place;
  place.write("a.toml", kReference);
  place.write("load.csv", "time_s,torque_nm,speed_rad_s\n0,-10,2\n1,-10,2\n");
  place.write("actuator.csv", "time_s,torque_nm,speed_rad_s\n# torque: actuator\n0,10,2\n1,10,2\n");
  json a = result_of(place, {"--cycle", "load.csv"}).at("cycle");
  json b = result_of(place, {"--cycle", "actuator.csv"}).at("cycle");
  a.erase("name");
  b.erase("name");
  EXPECT_EQ(a, b);
}

TEST(Actuator, StrictEndsWith3WhereALimitIsExceeded) {
  const Workplace place;
  place.write("a.toml", kReference + "[drive]\nbus_voltage_v = 7.0\n");
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-10,2\n1,-10,2\n");
  EXPECT_EQ(place.run({"actuator", "a.toml", "--cycle", "c.csv"}).exit_code, 0);
  const ProgramResult strict = place.run({"actuator", "a.toml", "--cycle", "c.csv", "--strict"});
  EXPECT_EQ(strict.exit_code, 3);
  EXPECT_TRUE(contains(strict.out, "FAILS")) << strict.out;
  EXPECT_EQ(strict.out,
            place.run({"actuator", "a.toml", "--cycle", "c.csv", "--format", "text"}).out);
}

TEST(Actuator, FilesPartedBySemicolonsAreToldSo) {
  const Workplace place;
  place.write("a.toml", kReference);
  place.write("c.csv", "time_s;torque_nm;speed_rad_s\n0;-10;2\n1;-10;2\n");
  EXPECT_EQ(place.run({"actuator", "a.toml", "--cycle", "c.csv"}).err,
            "c.csv:1:1: the header is one field: allowed: fields parted by commas\n");
  place.write("m.csv", "# a note\nmanufacturer;order_code;ratio\n");
  place.write("g.csv", "# two\n# notes\nmanufacturer,order_code,ratio\n");
  place.write("s.toml", "motors = \"m.csv\"\ngearboxes = \"g.csv\"\ncycles = \"c.csv\"\n");
  EXPECT_EQ(place.run({"actuator", "--select", "s.toml", "--out", "out"}).err,
            "m.csv:2:1: the header is one field: allowed: fields parted by commas\n"
            "g.csv:3:1: column efficiency is missing: allowed: columns manufacturer, order_code, "
            "ratio, efficiency\n"
            "c.csv:1:1: the header is one field: allowed: fields parted by commas\n");
  place.write("t.toml", "duration_s = 1.0\n[control]\nmode = \"torque\"\ntable = \"c.csv\"\n");
  EXPECT_EQ(place.run({"simulate", "a.toml", "t.toml"}).err,
            "c.csv:1:1: the header is one field: allowed: fields parted by commas\n");
}

TEST(Actuator, FilesTellAllTheirErrorsAtOnce) {
  const Workplace place;
  place.write("a.toml",
              "[motor]\nresistance_ohm = -1.0\ntorqe_constant_nm_per_a = 0.05\n"
              "[gearbox]\nratio = 0\nefficiency_forward = 0.8\n");
  place.write("c.csv", "time_s,torque_nm,angle_rad\n0,1,2\n0,nan,3\n1,2\n2,x,3\n");
  const ProgramResult result = place.run({"actuator", "a.toml", "--cycle", "c.csv"});
  EXPECT_EQ(result.exit_code, 2);
  for (const char* part :
       {"a.toml:2:1: motor.resistance_ohm = -1", "did you mean motor.torque_constant_nm_per_a",
        "gearbox.ratio = 0", "gearbox.efficiency_backward is missing",
        "c.csv:3:1: time_s = 0 after 0", "c.csv:3:3: torque_nm = \"nan\"", "c.csv:4:1: 2 fields",
        "c.csv:5:3: torque_nm = \"x\""}) {
    EXPECT_TRUE(contains(result.err, part)) << part << '\n' << result.err;
  }
}

TEST(Actuator, OfADesignTakesItsPathFromItsOwnFolder) {
  const Workplace place;
  place.write("a.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n"
              "rotor_inertia_kgm2 = 1e-5\n[gearbox]\ndesign = \"gear.toml\"\n");
  place.write("gear.toml", example("designs/loaded.toml"));
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-5,1\n0.5,3,-1\n1,-5,1\n");
  const json data = result_of(place, {"--cycle", "c.csv"});
  EXPECT_NEAR(data.at("ratio").get<double>(), 96.5161, 5e-5);
  EXPECT_GT(data.at("cycle").at("loss_j").at("P2-R2").get<double>(), 0.0);
  EXPECT_LT(data.at("cycle").at("balance_error").get<double>(), 1e-12);
  EXPECT_GT(data.at("reflected").at("stiffness_nm_per_rad").at("gearbox").get<double>(), 1e5);
}

TEST(Actuator, DrawsItsFigures) {
  const Workplace place;
  place.write("a.toml", kReference);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-10,2\n1,-10,2\n");
  const ProgramResult result = place.run({"actuator", "a.toml", "--cycle", "c.csv", "--impedance",
                                          "1:10:3", "--amplitude", "0.1", "--figures", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const std::string name : {"power", "ledger", "impedance", "drive_backdrive"}) {
    EXPECT_GT(lines_of(place.read("out/" + name + ".csv")).size(), 2U) << name;
    EXPECT_TRUE(contains(place.read("out/" + name + ".svg"), "</svg>")) << name;
  }
}

TEST(Actuator, TellsTheImpedanceOfEveryCause) {
  const Workplace place;
  place.write("a.toml", kReference + "stiffness_nm_per_rad = 900.0\n");
  const std::vector<std::string> options{"--impedance", "1:10:3", "--amplitude", "0.1"};
  const json points = result_of(place, options).at("impedance").at("points");
  for (const json& p : points) {
    for (const auto& [total, causes] :
         {std::pair("impedance_nms_per_rad", "causes_nms_per_rad"),
          std::pair("first_harmonic_nms_per_rad", "first_harmonic_causes_nms_per_rad")}) {
      double real = 0.0;
      double imaginary = 0.0;
      for (const auto& [name, z] : p.at(causes).items()) {
        real += z.at("real").get<double>();
        imaginary += z.at("imaginary").get<double>();
      }
      EXPECT_NEAR(real, p.at(total).at("real").get<double>(), 1e-12);
      EXPECT_NEAR(imaginary, p.at(total).at("imaginary").get<double>(), 1e-12);
    }
  }
  const ProgramResult csv = place.run(
      {"actuator", "a.toml", "--impedance", "1:10:3", "--amplitude", "0.1", "--format", "csv"});
  const auto lines = lines_of(csv.out);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_TRUE(contains(lines[0], ",first_harmonic_mesh_real_nms_per_rad,")) << lines[0];
  EXPECT_EQ(std::ranges::count(lines[0], ','), std::ranges::count(lines[3], ','));
  EXPECT_TRUE(contains(place.run({"actuator", "a.toml", "--impedance", "1:10:3"}).out,
                       "by cause, complex sum"));
}

TEST(Actuator, LimitsOfWhatIsFeltDecideWithStrict) {
  const Workplace place;
  place.write("a.toml", kReference +
                            "[limits]\nmax_felt_inertia_kgm2 = 0.1\nmax_breakaway_nm = 2.3\n"
                            "max_transparency = 0.6\ntransparency_torque_nm = 20.0\n");
  const json data = result_of(place, {});
  EXPECT_EQ(place.run({"actuator", "a.toml", "--strict"}).exit_code, 3);
  const json checks = data.at("checks");
  ASSERT_EQ(checks.size(), 3U);
  EXPECT_EQ(checks.at(1).at("name"), "breakaway");
  EXPECT_FALSE(checks.at(1).at("ok").get<bool>()) << "2.0 + 0.2/0.6 N m";
  // (20 + 0.2)/0.6 + 1 and 0.8 (20 - 0.2) - 1: 0.8 and 0.6 are the efficiencies, 0.2 the motor's.
  const double back = 20.2 / 0.6 + 1.0;
  const double with = 0.8 * 19.8 - 1.0;
  EXPECT_NEAR(data.at("felt").at("transparency").get<double>(), 2.0 * (back - with) / (back + with),
              1e-12);
  place.write("a.toml", kReference + "[limits]\nmax_transparency = 0.6\n");
  const ProgramResult lacks = place.run({"actuator", "a.toml"});
  EXPECT_EQ(lacks.exit_code, 2);
  EXPECT_TRUE(contains(lacks.err, "with limits.transparency_torque_nm")) << lacks.err;
}

const std::string kMotors =
    "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,mass_kg,nominal_current_a,"
    "nominal_voltage_v\nA,small,1.0,0.02,0.1,2.0,24\nA,large,0.3,0.05,0.4,6.0,24\n";
const std::string kGearboxes =
    "manufacturer,order_code,ratio,efficiency,mass_kg,continuous_torque_nm,intermittent_torque_nm\n"
    "B,low,20,0.8,0.2,5,8\nB,high,100,0.7,0.3,5,8\n";

TEST(Selection, WritesEveryPairAndTheFront) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("gearboxes.csv", kGearboxes);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(lines_of(place.read("out/selection.csv")).size(), 5U);
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("pairs"), 4);
  EXPECT_EQ(summary.at("front").size() + 1, lines_of(place.read("out/pareto.csv")).size());
  for (const json& pair : summary.at("front")) {
    EXPECT_TRUE(pair.at("limit").is_null()) << pair;
    EXPECT_TRUE(pair.at("excess").is_null()) << pair;
  }
  // No friction and no thermal resistance stands in the catalogue.
  EXPECT_EQ(
      summary.at("front").at(0).at("unknown"),
      json({"motor_friction", "winding", "gearbox_drag", "rotor_inertia", "gearbox_inertia"}));
  EXPECT_TRUE(contains(result.out, "no friction is published")) << result.out;
}

TEST(Selection, NamesTheCellsThatAPairIsWithout) {
  const Workplace place;
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  const auto unknown = [&](const std::string& motor, const std::string& gearbox,
                           const std::string& more) {
    place.write("motors.csv",
                "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,"
                "rotor_inertia_kgm2,nominal_voltage_v\nA,one,1.0,0.02," +
                    motor + "\n");
    place.write("gearboxes.csv",
                "manufacturer,order_code,ratio,efficiency,input_inertia_kgm2\nB,one,20,0.8," +
                    gearbox + "\n");
    place.write("s.toml",
                "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n"
                "objective = \"inertia\"\n" +
                    more);
    const ProgramResult run =
        place.run({"actuator", "--select", "s.toml", "--out", "out", "--format", "json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out).at("front").at(0).at("unknown").dump();
  };
  const std::string all = unknown("1e-6,24", "1e-7", "");
  const std::string none = unknown(",", "", "");
  for (const char* name : {"rotor_inertia", "gearbox_inertia", "voltage"}) {
    EXPECT_FALSE(contains(all, name)) << all;
    EXPECT_TRUE(contains(none, name)) << none;
  }
  // A stated inertia of 0 is known, and the drive's voltage limits every motor.
  EXPECT_FALSE(contains(unknown("0,", "0", "[drive]\nbus_voltage_v = 24\n"), "voltage"));
  EXPECT_FALSE(contains(unknown("0,", "0", ""), "inertia"));
}

TEST(Selection, TellsTheTransparencyThatNothingLimits) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("gearboxes.csv", kGearboxes);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n"
              "[limits]\ntransparency_torque_nm = 3\n");
  const ProgramResult run =
      place.run({"actuator", "--select", "s.toml", "--out", "out", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json selection = json::parse(run.out);
  for (const json& pair : selection.at("front")) {
    // Without drag and friction: width over mean of 1/eta and eta, as of 3 N m so of any torque.
    const double eta = pair.at("ratio") == 20.0 ? 0.8 : 0.7;
    EXPECT_NEAR(pair.at("felt").at("transparency").get<double>(),
                2.0 * (1.0 / eta - eta) / (1.0 / eta + eta), 1e-12);
  }
}

TEST(Selection, WithoutMotorsIsRefusedWithItsLineAndKeepsEarlierFiles) {
  const Workplace place;
  place.write("gearboxes.csv", kGearboxes);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml", "motors = \"\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n");
  std::filesystem::create_directories(place.file("out"));
  place.write("out/pareto.svg", "old");
  const ProgramResult run = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(run.err.starts_with("s.toml:1:1: motors = \"\": allowed:")) << run.err;
  EXPECT_EQ(place.read("out/pareto.svg"), "old");
}

TEST(Selection, HoldsTheLimitsOfWhatIsFelt) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("gearboxes.csv", kGearboxes);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  const auto run = [&](const std::string& limits) {
    place.write("s.toml",
                "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = "
                "\"c.csv\"\n[load]\ninertia_kgm2 = 0.01\n[limits]\n" +
                    limits);
    return place.run({"actuator", "--select", "s.toml", "--out", "out"});
  };
  // Without drag and friction: width over mean is that of 1/eta and eta.
  const auto over_mean = [](double eta) { return 2.0 * (1.0 / eta - eta) / (1.0 / eta + eta); };
  const ProgramResult some =
      run("max_transparency = 0.5\ntransparency_torque_nm = 3\nmax_felt_inertia_kgm2 = 1\n");
  ASSERT_EQ(some.exit_code, 0) << some.err;
  EXPECT_TRUE(contains(some.out, "transparency")) << some.out;
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("rejected").at("transparency"), 2) << "both with efficiency 0.7";
  for (const json& pair : summary.at("front")) {
    EXPECT_NEAR(pair.at("felt").at("transparency").get<double>(), over_mean(0.8), 1e-12);
    EXPECT_NEAR(pair.at("felt").at("inertia_kgm2").get<double>(), 0.01, 1e-15);
  }
  const ProgramResult none = run("max_transparency = 0.1\ntransparency_torque_nm = 3\n");
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_TRUE(contains(none.err, "exceeds transparency by")) << none.err;
  const ProgramResult heavy = run("max_felt_inertia_kgm2 = 0.005\n");
  EXPECT_EQ(heavy.exit_code, 3);
  EXPECT_TRUE(contains(heavy.err, "exceeds felt_inertia by 100 % of the limit")) << heavy.err;
  const ProgramResult lacks = run("max_transparency = 0.1\n");
  EXPECT_EQ(lacks.exit_code, 2);
  EXPECT_TRUE(contains(lacks.err, "limits.max_transparency: allowed: with")) << lacks.err;
}

TEST(Selection, TellsAllSlipsOfCataloguesAtOnce) {
  const Workplace place;
  place.write("motors.csv", "\xEF\xBB\xBF" + kMotors);
  place.write("gearboxes.csv",
              "manufacturer,order_code,ratio,efficiency\nB,low,0,0.8\nB,short,3\nB,high,10,2\n");
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\n"
              "cycles = \"c.csv\"\nobjective = [\"mass\", \"mass\"]\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  for (const std::string message :
       {"ratio = \"0\": allowed: a number above 0", "3 fields, allowed: 4 as in the header",
        "efficiency = \"2\": allowed: a number above 0 to 1", "objective: \"mass\" twice"}) {
    EXPECT_TRUE(contains(result.err, message)) << message << " is not in\n" << result.err;
  }
  EXPECT_FALSE(contains(result.err, "motors.csv")) << result.err;
}

TEST(Selection, NamesTheFrictionThatBreakawayIsWithout) {
  const Workplace place;
  // A no-load current alone leaves open how much of it is Coulomb friction.
  place.write("motors.csv",
              "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,mass_kg,"
              "no_load_current_a,no_load_speed_rad_s,coulomb_torque_nm\n"
              "A,open,1,0.02,0.1,0.2,500,\nA,told,1,0.02,0.1,0.2,500,0.002\n");
  place.write("gearboxes.csv", kGearboxes);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n"
              "objective = [\"breakaway\", \"energy\"]\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "Note: breakaway of")) << result.out;
  const json summary = json::parse(place.read("out/summary.json"));
  ASSERT_FALSE(summary.at("front").empty());
  for (const json& pair : summary.at("front")) {
    const std::string unknown = pair.at("unknown").dump();
    EXPECT_EQ(contains(unknown, "motor_coulomb"), pair.at("motor") == "A open") << pair;
    EXPECT_TRUE(contains(unknown, "gearbox_drag")) << pair;
  }
}

TEST(Selection, RefusesCataloguesWithoutRowsAndRowsTwice) {
  const Workplace place;
  place.write("motors.csv", kMotors + "A,small,2.0,0.02,0.1,2.0,24\n");
  place.write("gearboxes.csv", "manufacturer,order_code,ratio,efficiency\n");
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "gearboxes.csv:1:1: no row below the header")) << result.err;
  EXPECT_TRUE(contains(result.err, "motors.csv:4:1: A small stands twice, first in line 2"))
      << result.err;
}

TEST(Selection, WithoutAFeasiblePairEndsWith3AndNamesTheLimit) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("gearboxes.csv", kGearboxes);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-10,1\n0.5,-10,1\n1,-10,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 3);
  // 10 N m against 5 continuous, whatever the motor.
  EXPECT_TRUE(contains(result.err, "exceeds continuous_torque by 100 % of the limit"))
      << result.err;
}

TEST(Selection, WindingThatHeatsUpWithoutEndExceedsWithoutBound) {
  const Workplace place;
  // 30 A rms in 1 Ohm: 900 W and more through 100 K/W.
  place.write(
      "motors.csv",
      "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,rotor_inertia_kgm2,"
      "thermal_resistance_winding_housing_k_per_w,thermal_resistance_housing_ambient_k_per_w"
      "\nA,hot,1,0.01,1e-6,50,50\n");
  place.write("gearboxes.csv", "manufacturer,order_code,ratio,efficiency\nB,ten,10,1\n");
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,-3,1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gearboxes.csv\"\ncycles = \"c.csv\"\n"
              "[limits]\nmax_winding_c = 120\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(contains(result.err, "A hot with B ten, exceeds winding without bound\n"))
      << result.err;
  EXPECT_EQ(lines_of(place.read("out/selection.csv")).at(1),
            "A hot,B ten,infeasible,winding,inf,0");
}

TEST(Actuator, TableOfTheExamplesSelectionFitsTheScreen) {
  const Workplace place;
  const std::string source = GEAR3K_SOURCE_DIR "/examples/actuators/knee_selection.toml";
  const ProgramResult result = place.run({"actuator", "--select", source, "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const std::string& line : lines_of(result.out)) EXPECT_LE(line.size(), 120U) << line;
  EXPECT_TRUE(contains(result.out, "\n?: not known of the pair: a ")) << result.out;
}

TEST(Actuator, AMissingDesignIsToldWithItsKey) {
  const Workplace place;
  place.write("a.toml",
              "[motor]\ntorque_constant_nm_per_a = 0.05\nresistance_ohm = 0.5\n"
              "[gearbox]\ndesign = \"absent.toml\"\n");
  const ProgramResult result = place.run({"actuator", "a.toml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(
      contains(result.err, "a.toml:5:1: gearbox.design: absent.toml: cannot be read: No such file"))
      << result.err;
}

TEST(Actuator, OptionsThatDoNotGoTogetherAreUsageErrors) {
  const Workplace place;
  place.write("a.toml", kReference);
  EXPECT_EQ(place.run({"actuator"}).exit_code, 1);
  EXPECT_EQ(place.run({"actuator", "a.toml", "--without-each"}).exit_code, 1);
  EXPECT_EQ(place.run({"actuator", "a.toml", "--amplitude", "0.1"}).exit_code, 1);
  EXPECT_EQ(place.run({"actuator", "--select", "a.toml"}).exit_code, 1);
  for (const std::string range : {"1", "1:2", "1:2:", "1,2"}) {
    EXPECT_EQ(place.run({"actuator", "a.toml", "--impedance", range}).exit_code, 1) << range;
  }
  EXPECT_EQ(place.run({"actuator", "a.toml", "--motor", "shorted"}).exit_code, 1);
}

TEST(Options, NoNumberIsInNoRange) {
  const Workplace place;
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"actuator", "a.toml", "--impedance", "1:10:2", "--amplitude", "nan"},
           {"optimize", "s.toml", "--out", "out", "--front-budget", "nan"},
           {"atlas", "50", "--friction", "nan"}}) {
    const ProgramResult result = place.run(command);
    EXPECT_EQ(result.exit_code, 1) << command.back();
    EXPECT_TRUE(contains(result.err, "nan: allowed: a number")) << result.err;
  }
}

TEST(Actuator, NumbersOfACycleAreThoseOfAnActuator) {
  const Workplace place;
  place.write("a.toml", kReference);
  place.write("c.csv",
              "# torque: load\n# torque: actuator\ntime_s,torque_nm,speed_rad_s\n0,1e160,1\n"
              "1e-308,1,1\n1,1,-2e9\n2,1,1\n");
  const ProgramResult result = place.run({"actuator", "a.toml", "--cycle", "c.csv"});
  EXPECT_EQ(result.exit_code, 2);
  for (const std::string message :
       {"c.csv:2:1: # torque: actuator after # torque: load: allowed: one of them",
        "c.csv:4:3: torque_nm = \"1e160\": allowed: a number from -1e+09 to 1e+09",
        "c.csv:5:1: time_s = 1e-308 after 0: allowed: increasing times, by 1e-09 s or more",
        "c.csv:6:5: speed_rad_s = \"-2e9\": allowed: a number from -1e+09 to 1e+09"}) {
    EXPECT_TRUE(contains(result.err, message)) << message << " is not in\n" << result.err;
  }
}

TEST(Actuator, NotesADesignThatFailsItsChecks) {
  const Workplace place;
  std::string design = place.read(std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/loaded.toml");
  const std::string table = "[backlash]\n";
  const std::size_t at = design.find(table);
  ASSERT_NE(at, std::string::npos);
  design.insert(at + table.size(), "S-P1.min_normal_um = 1000.0\n");
  place.write("d.toml", design);
  place.write("a.toml",
              "[motor]\ntorque_constant_nm_per_a = 0.05\nresistance_ohm = 0.5\n"
              "[gearbox]\ndesign = \"d.toml\"\n");
  const ProgramResult result = place.run({"actuator", "a.toml"});
  EXPECT_TRUE(contains(result.out + result.err, "fails checks of `gear3k analyze`"))
      << result.out << result.err;
}

/// Energy from the bus of `gear3k actuator` with a gearbox.
double energy_with(const Workplace& place, const std::string& gearbox) {
  place.write(
      "one.toml",
      "[motor]\nresistance_ohm = 0.3\ntorque_constant_nm_per_a = 0.05\n[gearbox]\n" + gearbox);
  const ProgramResult run =
      place.run({"actuator", "one.toml", "--cycle", "c.csv", "--format", "json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const json energy = json::parse(run.out).at("cycle").at("electrical_energy_j");
  return energy.at("drawn").get<double>() - energy.at("regenerated").get<double>();
}

TEST(Selection, TakesDesignsAndTheTablesOfOptimize) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("gearboxes.csv", kGearboxes);
  place.write("gear.toml", example("designs/bilateral_drive_gear.toml"));
  place.write("pareto.csv",
              "zS,zP1,zR1,zP2,zR2,status,ratio,eta_b,eta_f,mass_kg\n"
              "12,39,90,32,81,optimal,-96.5,0.9,0.91,0.5\n13,39,90,32,81,infeasible,,,,\n");
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.5,3,-1\n1,-3,1\n");
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = [\"gear.toml\", \"pareto.csv\", "
              "\"gearboxes.csv\"]\ncycles = \"c.csv\"\nobjective = \"energy\"\n");
  const ProgramResult result = place.run({"actuator", "--select", "s.toml", "--out", "out"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(lines_of(place.read("out/selection.csv")).size(), 1U + 2U * 4U);
  const json front = json::parse(place.read("out/summary.json")).at("front");
  ASSERT_EQ(front.size(), 1U);
  // The command of one actuator says which gearbox takes least, and the same energy.
  const double designed = energy_with(place, "design = \"gear.toml\"\n");
  const double refined =
      energy_with(place, "ratio = -96.5\nefficiency_forward = 0.91\nefficiency_backward = 0.9\n");
  EXPECT_LT(designed, refined);
  EXPECT_EQ(front.at(0).at("gearbox"), "bilateral drive gear");
  EXPECT_NEAR(front.at(0).at("energy_j").get<double>(), designed, 1e-9 * designed);

  place.write("gear.toml", example("designs/ratio_96_with_losses.toml"));
  const ProgramResult losses = place.run({"actuator", "--select", "s.toml", "--out", "other"});
  EXPECT_EQ(losses.exit_code, 2);
  EXPECT_TRUE(contains(losses.err, "gear.toml: its losses depend on speed or load")) << losses.err;
}

}  // namespace
}  // namespace gear3k::actuator_cli_test
