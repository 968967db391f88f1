// `optimize` with the objective cycle_energy, and selections among designs that are made for them.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "tests/cli/run_program.hpp"

namespace gear3k::co_design_cli_test {
namespace {

using nlohmann::json;
using test::ProgramResult, test::Workplace;

const std::string kMotors =
    "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,rotor_inertia_kgm2,mass_kg,"
    "nominal_current_a,coulomb_torque_nm,viscous_nms_per_rad\n"
    "A,small,1.2,0.02,1e-6,0.1,2,0.001,1e-6\nA,middle,0.6,0.04,2e-5,0.2,5,0.002,1e-5\n"
    "A,large,0.2,0.08,1e-4,0.9,10,0.004,\n";
const std::string kCycle =
    "time_s,torque_nm,speed_rad_s\n0,-3,1\n0.2,-6,3\n0.5,3,-1\n0.7,2,0\n0.8,2,0\n1,-3,1\n";
/// A few tooth sets.
const std::string kGears =
    "name = \"small\"\n[ratio]\ntarget = 45.0\ntolerance = 0.3\n"
    "[teeth]\nS = [15, 15]\nP1 = [30, 30]\nP2 = [31, 33]\nR1_max = 90\nR2_max = 90\n"
    "[module]\nstage1_mm = { min = 0.5, max = 0.8 }\nstage2_mm = { min = 0.5, max = 0.8 }\n"
    "[backlash]\nmax_output_arcmin = 10.0\nmin_normal_um = 5.0\nmachining_allowance = 0.02\n"
    "[friction]\ncoefficient = 0.08\n";
const std::string kTask =
    "objective = \"cycle_energy\"\n" + kGears +
    "[actuator]\nmotors = \"motors.csv\"\ndrive.efficiency_regenerating = 0.7\n"
    "[cycle]\nfiles = \"c.csv\"\n";

void write_parts(const Workplace& place) {
  place.write("motors.csv", kMotors);
  place.write("c.csv", kCycle);
}

TEST(OptimizeCycleEnergy, LimitThatLeavesNoMotorIsToldWithItsLine) {
  const Workplace place;
  write_parts(place);
  const auto error_of = [&](const std::string& limit) {
    place.write("spec.toml", test::replaced(kTask, "[cycle]", limit + "[cycle]"));
    const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("leave no motor"), std::string::npos) << run.err;
    return run.err;
  };
  const std::string mass = error_of("limits.max_motor_mass_kg = 0.05\n");
  EXPECT_TRUE(mass.starts_with("spec.toml:24:8: ")) << mass;
  place.write("motors.csv",
              "manufacturer,order_code,resistance_ohm,torque_constant_nm_per_a,"
              "rotor_inertia_kgm2\nA,small,1.2,0.02,1e-6\n");
  EXPECT_NE(mass.find("limits leave no motor: actuator.limits.max_motor_mass_kg = 0.05: "),
            std::string::npos)
      << mass;
  const std::string friction = error_of("limits.known_friction = true\n");
  EXPECT_NE(friction.find("limits leave no motor: actuator.limits.known_friction = true: "),
            std::string::npos)
      << friction;
  EXPECT_TRUE(friction.starts_with("spec.toml:24:8: ")) << friction;
}

TEST(OptimizeCycleEnergy, WeightsAreOneForEachCycle) {
  const Workplace place;
  write_parts(place);
  for (const char* files : {"\"c.csv\"", "[\"c.csv\", \"c.csv\", \"c.csv\"]"}) {
    place.write("spec.toml", test::replaced(kTask, "files = \"c.csv\"",
                                            std::string("weights = [1, 2]\nfiles = ") + files));
    const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out"});
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(run.err.starts_with("spec.toml:25:1: cycle.weights: 2 for ")) << run.err;
  }
}

TEST(OptimizeCycleEnergy, ItsActuatorRunsAsItIsAndNeedsTheSameEnergy) {
  const Workplace place;
  write_parts(place);
  place.write("spec.toml", kTask);
  const ProgramResult run =
      place.run({"optimize", "spec.toml", "--certify", "--threads", "1", "--out", "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("\nMotor, of 3, for one cycle:\n"), std::string::npos) << run.out;
  const json co = json::parse(place.read("out/summary.json")).at("co_design");
  const auto energy = co.at("energy_j").get<double>();
  EXPECT_LE(co.at("bound_j").get<double>(), energy);
  EXPECT_FALSE(co.at("gear_inertia").get<bool>());
  const ProgramResult actuator = place.run(
      {"actuator", "out/actuator.toml", "--cycle", "c.csv", "--strict", "--format", "json"});
  ASSERT_EQ(actuator.exit_code, 0) << actuator.err;
  const json electrical = json::parse(actuator.out).at("cycle").at("electrical_energy_j");
  const auto drawn = electrical.at("drawn").get<double>();
  EXPECT_NEAR(drawn - electrical.at("regenerated").get<double>(), energy, 1e-9 * drawn);
  EXPECT_NEAR(co.at("run_energy_j").get<double>(), energy, 1e-9 * drawn);
  EXPECT_NE(place.read("out/refined.csv").find(",cycle_energy_j,motor\n"), std::string::npos);

  ASSERT_EQ(place.run({"optimize", "spec.toml", "--certify", "--threads", "4", "--out", "again"})
                .exit_code,
            0);
  for (const std::string name : {"best.toml", "actuator.toml", "refined.csv", "pareto.csv"}) {
    EXPECT_EQ(place.read("out/" + name), place.read("again/" + name)) << name;
  }
  // All sets refined find the same.
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--out", "all", "--quiet"}).exit_code, 0);
  const json all = json::parse(place.read("all/summary.json")).at("co_design");
  EXPECT_EQ(all.at("motor"), co.at("motor"));
  EXPECT_NEAR(all.at("energy_j").get<double>(), energy, 1e-9 * drawn);
  EXPECT_TRUE(all.at("bound_j").is_null());
}

TEST(OptimizeCycleEnergy, TellsAllErrorsOfItsKeysAndFilesAtOnce) {
  const Workplace place;
  place.write("motors.csv", "manufacturer,order_code,resistance_ohm\nA,x,1\n");
  place.write("c.csv", "time_s,torque_nm\n0,1\n");
  place.write("spec.toml", "objective = [\"cycle_energy\", \"ratio_error\"]\n" + kGears +
                               "[actuator]\nmotors = \"motors.csv\"\nmotor = \"none.toml\"\n"
                               "drive.efficiency_motoring = 1.5\nmoters = 1\n"
                               "[cycle]\nfiles = \"c.csv\"\nweights = [1.0, 2.0]\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(run.exit_code, 2);
  for (const std::string message :
       {"\"cycle_energy\" among others: allowed: by itself", "actuator.drive.efficiency_motoring",
        "moters", "cycle.weights: 2 for 1 cycles", "torque_constant_nm_per_a is missing",
        "none.toml", "c.csv:1:"}) {
    EXPECT_NE(run.err.find(message), std::string::npos) << message << " is not in\n" << run.err;
  }
  place.write("spec.toml", "objective = \"cycle_energy\"\n" + kGears);
  const ProgramResult bare = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(bare.exit_code, 2);
  for (const std::string message : {"without a motor", "without cycle.files"}) {
    EXPECT_NE(bare.err.find(message), std::string::npos) << bare.err;
  }
}

TEST(OptimizeCycleEnergy, HoldsAWindingToTheLowerLimitAndToNoneBelowItsSurroundings) {
  const Workplace place;
  write_parts(place);
  place.write("m.toml",
              "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n"
              "rotor_inertia_kgm2 = 2e-5\nthermal_resistance_k_per_w = 1.0\nmax_winding_c = 110.0\n"
              "[gearbox]\nratio = 45.0\nefficiency_forward = 0.9\nefficiency_backward = 0.9\n");
  const auto run = [&](const std::string& limits) {
    place.write("spec.toml", "objective = \"cycle_energy\"\n" + kGears +
                                 "[actuator]\nmotor = \"m.toml\"\n[actuator.limits]\n" + limits +
                                 "[cycle]\nfiles = \"c.csv\"\n");
    return place.run({"optimize", "spec.toml", "--certify", "--quiet", "--force", "--out", "out"});
  };
  ASSERT_EQ(run("max_winding_c = 90.0\n").exit_code, 0);
  EXPECT_NE(place.read("out/actuator.toml").find("max_winding_c = 90.0\n"), std::string::npos);
  const ProgramResult hot = run("ambient_c = 120.0\n");
  EXPECT_EQ(hot.exit_code, 2);
  EXPECT_NE(hot.err.find("m.toml: motor.max_winding_c = 110: allowed: above "
                         "actuator.limits.ambient_c = 120"),
            std::string::npos)
      << hot.err;
}

TEST(OptimizeCycleEnergy, MotorOfAnActuatorHasItsOwnSurroundingsAndVoltage) {
  const Workplace place;
  write_parts(place);
  const auto run = [&](const std::string& motor, const std::string& more = "") {
    place.write("m.toml",
                "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\n"
                "rotor_inertia_kgm2 = 2e-5\nthermal_resistance_k_per_w = 1.0\n"
                "max_winding_c = 110.0\n" +
                    motor +
                    "[gearbox]\nratio = 45.0\nefficiency_forward = 0.9\n"
                    "efficiency_backward = 0.9\n");
    place.write("spec.toml", "objective = \"cycle_energy\"\n" + kGears +
                                 "[actuator]\nmotor = \"m.toml\"\n" + more +
                                 "[cycle]\nfiles = \"c.csv\"\n");
    return place.run({"optimize", "spec.toml", "--certify", "--force", "--out", "out"});
  };
  const ProgramResult warm =
      run("ambient_c = 60.0\n[drive]\nbus_voltage_v = 24.0\nefficiency_motoring = 0.9\n"
          "[load]\ninertia_kgm2 = 0.003\n");
  ASSERT_EQ(warm.exit_code, 0) << warm.err;
  const json summary = json::parse(place.read("out/summary.json"));
  const json co = summary.at("co_design");
  const ProgramResult alone =
      place.run({"actuator", "out/actuator.toml", "--cycle", "c.csv", "--format", "json"});
  const json cycle = json::parse(alone.out).at("cycle");
  EXPECT_GT(co.at("winding_c").get<double>(), 60.0);
  EXPECT_NEAR(cycle.at("winding_c").get<double>(), co.at("winding_c").get<double>(), 1e-6);
  const std::string actuator = place.read("out/actuator.toml");
  EXPECT_NE(actuator.find("ambient_c = 60.0\n"), std::string::npos) << actuator;
  EXPECT_NE(actuator.find("bus_voltage_v = 24.0\n"), std::string::npos) << actuator;
  EXPECT_EQ(co.at("unknown"), json({"motor_friction", "nominal_current"}));
  // What of the file is not the motor's is not read, and named.
  const std::string unread =
      "m.toml alone, whose drive.efficiency_motoring, load.inertia_kgm2 are not read";
  EXPECT_NE(warm.err.find(unread), std::string::npos) << warm.err;
  EXPECT_NE(summary.at("notes").dump().find(unread), std::string::npos) << summary.at("notes");

  const ProgramResult stated = run("ambient_c = 60.0\n", "limits.ambient_c = 30.0\n");
  ASSERT_EQ(stated.exit_code, 0) << stated.err;
  EXPECT_NE(place.read("out/actuator.toml").find("ambient_c = 30.0\n"), std::string::npos);
  for (const auto& [motor, more, code, message] :
       {std::tuple("ambient_c = 120.0\n", "", 2,
                   "m.toml: motor.max_winding_c = 110: allowed: above motor.ambient_c of m.toml = "
                   "120"),
        std::tuple("ambient_c = 90.0\n", "limits.max_winding_c = 80.0\n", 2,
                   "actuator.limits.max_winding_c = 80: allowed: above motor.ambient_c of m.toml = "
                   "90"),
        std::tuple("[drive]\nbus_voltage_v = 0.5\n", "", 3, "exceeds voltage by"),
        std::tuple("", "limits.known_friction = true\n", 2, "limits leave no motor")}) {
    const ProgramResult refused = run(motor, more);
    EXPECT_EQ(refused.exit_code, code) << refused.err;
    EXPECT_NE(refused.err.find(message), std::string::npos) << refused.err;
  }
}

TEST(OptimizeFelt, OtherObjectivesNameWhatTheyDoNotReadAndRefuseLimitsOfMotors) {
  const Workplace place;
  const auto run = [&](const std::string& keys) {
    place.write("spec.toml", "objective = \"outer_diameter\"\n" + kGears + keys);
    return place.run({"optimize", "spec.toml", "--force", "--out", "out"});
  };
  const ProgramResult noted =
      run("[actuator]\nmotors = \"none.csv\"\ndrive.standby_w = 1\n[cycle]\nfiles = \"no.csv\"\n"
          "[pareto]\npoints = 5\n");
  ASSERT_EQ(noted.exit_code, 0) << noted.err;
  const json notes = json::parse(place.read("out/summary.json")).at("notes");
  ASSERT_EQ(notes.size(), 2U) << notes;
  for (const char* key : {"actuator.motors", "actuator.drive.standby_w", "cycle.files"}) {
    EXPECT_NE(notes.at(0).get<std::string>().find(key), std::string::npos) << notes;
    EXPECT_NE(noted.err.find(key), std::string::npos) << noted.err;
  }
  EXPECT_NE(notes.at(1).get<std::string>().find("pareto.points"), std::string::npos) << notes;
  for (const char* limit : {"drive.bus_voltage_v", "limits.peak_current_factor",
                            "limits.max_winding_c", "limits.max_motor_mass_kg"}) {
    const ProgramResult refused = run(std::string("[actuator]\n") + limit + " = 30\n");
    EXPECT_EQ(refused.exit_code, 2) << limit;
    EXPECT_TRUE(refused.err.starts_with("spec.toml:22:")) << refused.err;
    EXPECT_NE(refused.err.find(std::string(": actuator.") + limit + " limits a motor"),
              std::string::npos)
        << refused.err;
  }
}

TEST(OptimizeCycleEnergy, WithoutAMotorWithinItsLimitsEndsWith3AndNamesTheNearest) {
  const Workplace place;
  place.write("motors.csv", kMotors);
  place.write("c.csv", "time_s,torque_nm,speed_rad_s\n0,-60,3\n0.5,-60,3\n1,-60,3\n");
  place.write("spec.toml", kTask);
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_NE(run.err.find("of the limit"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(place.file("out/best.toml")));
}

TEST(OptimizeCycleEnergy, RefusesMotorsByWhatIsFeltAndNamesTheLimit) {
  const Workplace place;
  write_parts(place);
  const auto run = [&](const std::string& limits) {
    place.write("spec.toml", kTask + "[actuator.limits]\n" + limits);
    return place.run({"optimize", "spec.toml", "--certify", "--quiet", "--force", "--out", "out"});
  };
  const auto co_design = [&] {
    return json::parse(place.read("out/summary.json")).at("co_design");
  };
  ASSERT_EQ(run("max_felt_inertia_kgm2 = 1e6\ntransparency_torque_nm = 6\n").exit_code, 0);
  const json free = co_design();
  const auto inertia = free.at("felt").at("inertia_kgm2").get<double>();
  const auto breakaway = free.at("felt").at("breakaway_nm").get<double>();
  const auto transparency = free.at("felt").at("transparency").get<double>();
  // Below what the best motor has only another one is left, or none.
  const auto limit = [](const char* key, double value) {
    return std::string(key) + " = " + std::to_string(value) + "\n";
  };
  const ProgramResult tight = run(limit("max_felt_inertia_kgm2", 0.9 * inertia));
  ASSERT_EQ(tight.exit_code, 0) << tight.err;
  EXPECT_NE(co_design().at("motor"), free.at("motor"));
  EXPECT_LE(co_design().at("felt").at("inertia_kgm2").get<double>(), 0.9 * inertia);
  EXPECT_GT(co_design().at("energy_j").get<double>(), free.at("energy_j").get<double>());
  EXPECT_LE(co_design().at("bound_j").get<double>(), co_design().at("energy_j").get<double>());
  // The limits go with the actuator, which keeps them.
  EXPECT_NE(place.read("out/actuator.toml").find("max_felt_inertia_kgm2"), std::string::npos);
  EXPECT_EQ(place.run({"actuator", "out/actuator.toml", "--strict", "--quiet"}).exit_code, 0);
  // The screen shows what is felt beside its limit.
  EXPECT_NE(tight.out.find("felt_inertia"), std::string::npos) << tight.out;

  for (const auto& [text, name] :
       {std::pair(limit("max_felt_inertia_kgm2", 1e-5), "felt_inertia"),
        std::pair(limit("max_breakaway_nm", 0.01 * breakaway), "breakaway"),
        std::pair("transparency_torque_nm = 6\n" + limit("max_transparency", 0.01 * transparency),
                  "transparency")}) {
    const ProgramResult none = run(text);
    EXPECT_EQ(none.exit_code, 3) << name;
    EXPECT_NE(none.err.find(std::string("exceeds ") + name + " by "), std::string::npos)
        << none.err;
  }
  const ProgramResult bare = run("max_transparency = 0.5\n");
  EXPECT_EQ(bare.exit_code, 2);
  EXPECT_NE(bare.err.find("actuator.limits.max_transparency: allowed: with "
                          "actuator.limits.transparency_torque_nm"),
            std::string::npos)
      << bare.err;
}

/// A task of another objective with a motor of its own.
const std::string kFeltTask = "objective = \"outer_diameter\"\n" + kGears +
                              "[actuator]\nmotor = \"motor.toml\"\nload.inertia_kgm2 = 0.003\n"
                              "limits.max_felt_inertia_kgm2 = ";
const std::string kFeltMotor =
    "[motor]\nresistance_ohm = 0.6\ntorque_constant_nm_per_a = 0.04\nrotor_inertia_kgm2 = 2e-5\n"
    "coulomb_torque_nm = 0.002\n";

TEST(OptimizeFelt, LeadsAnyObjectiveToADesignThatTheActuatorConfirms) {
  const Workplace place;
  place.write("motor.toml", kFeltMotor +
                                "[gearbox]\nratio = 10.0\nefficiency_forward = 0.9\n"
                                "efficiency_backward = 0.9\n");
  place.write("free.toml", kFeltTask + "10.0\n");
  ASSERT_EQ(place.run({"optimize", "free.toml", "--threads", "1", "--out", "free"}).exit_code, 0);
  const json free = json::parse(place.read("free/summary.json")).at("felt").at(0);
  EXPECT_EQ(free.at("name"), "felt_inertia");
  const double limit = 0.985 * free.at("value").get<double>();
  place.write("felt.toml", kFeltTask + std::to_string(limit) +
                               "\nlimits.max_transparency = 0.9\n"
                               "limits.transparency_torque_nm = 1.0\n");
  const ProgramResult run =
      place.run({"optimize", "felt.toml", "--certify", "--threads", "1", "--out", "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("felt_inertia"), std::string::npos);
  EXPECT_NE(run.out.find("actuator.limits.max_felt_inertia_kgm2"), std::string::npos) << run.out;
  const json felt = json::parse(place.read("out/summary.json")).at("felt");
  ASSERT_EQ(felt.size(), 2U);
  EXPECT_LE(felt[0].at("value").get<double>(), limit * (1.0 + 2e-6));
  // The actuator of the motor and the design says the same of it.
  place.write("actuator.toml", kFeltMotor +
                                   "[gearbox]\ndesign = \"out/best.toml\"\n[load]\n"
                                   "inertia_kgm2 = 0.003\n");
  const ProgramResult actuator = place.run({"actuator", "actuator.toml", "--format", "json"});
  ASSERT_EQ(actuator.exit_code, 0) << actuator.err;
  const json reflected = json::parse(actuator.out).at("reflected");
  EXPECT_NEAR(reflected.at("inertia_kgm2").at("speeding_up").get<double>(),
              felt[0].at("value").get<double>(), 1e-9);
}

TEST(OptimizeFelt, WithoutADesignEndsWith3AndNamesTheLimitWithItsAmount) {
  const Workplace place;
  place.write("motor.toml", kFeltMotor +
                                "[gearbox]\nratio = 10.0\nefficiency_forward = 0.9\n"
                                "efficiency_backward = 0.9\n");
  place.write("spec.toml", kFeltTask + "0.005\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--threads", "1", "--out", "out"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("blocked by felt_inertia"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("misses felt_inertia by "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(" kg m2"), std::string::npos) << run.err;
}

TEST(OptimizeFelt, TellsWhatItsLimitsNeed) {
  const Workplace place;
  place.write("spec.toml",
              "objective = \"outer_diameter\"\n" + kGears +
                  "[actuator]\nlimits.max_breakaway_nm = 1.0\nlimits.max_transparency = 0.2\n");
  const ProgramResult run = place.run({"optimize", "spec.toml", "--out", "out"});
  EXPECT_EQ(run.exit_code, 2);
  for (const char* part : {"without actuator.motor", "limits.transparency_torque_nm"}) {
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  }
}

TEST(Selection, MakesTheDesignsOfATaskOfOptimize) {
  const Workplace place;
  write_parts(place);
  place.write("gears.toml", kGears);
  place.write("s.toml",
              "motors = \"motors.csv\"\ngearboxes = \"gears.toml\"\ncycles = \"c.csv\"\n"
              "objective = \"energy\"\n[drive]\nefficiency_regenerating = 0.7\n");
  const ProgramResult run =
      place.run({"actuator", "--select", "s.toml", "--out", "out", "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json summary = json::parse(place.read("out/summary.json"));
  EXPECT_EQ(summary.at("pairs"), 3 * summary.at("gearboxes").get<int>());
  auto name = summary.at("front").at(0).at("gearbox").get<std::string>();
  std::ranges::replace(name, '/', '_');
  EXPECT_EQ(place.run({"analyze", "out/design_" + name + ".toml", "--strict", "--quiet"}).exit_code,
            0);
  // Choosing both at once is at least as good as choosing among designs of most efficiency.
  place.write("spec.toml", kTask);
  ASSERT_EQ(place.run({"optimize", "spec.toml", "--certify", "--quiet", "--out", "both"}).exit_code,
            0);
  const json both = json::parse(place.read("both/summary.json")).at("co_design");
  EXPECT_LE(both.at("energy_j").get<double>(),
            summary.at("front").at(0).at("energy_j").get<double>() * (1.0 + 1e-9));
}

}  // namespace
}  // namespace gear3k::co_design_cli_test
