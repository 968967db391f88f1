// ACTUATOR.toml and CYCLE.csv: what follows from the keys, and what is refused.
#include "io/files/actuator_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "io/files/cycle_file.hpp"
#include "io/text/diagnostics.hpp"

namespace gear3k::actuator_file_test {
namespace {

using io::InvalidInput, io::parse_actuator, io::parse_cycle;

const std::string kMotor =
    "[motor]\nresistance_ohm = 0.5\ntorque_constant_nm_per_a = 0.05\nno_load_current_a = 0.2\n"
    "no_load_speed_rad_s = 500.0\ncoulomb_torque_nm = 0.004\n";
const std::string kGearbox =
    "[gearbox]\nratio = -50.0\nefficiency_forward = 0.75\nefficiency_backward = 0.75\n";

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(parse_actuator(text, "a.toml"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

std::string cycle_error(const std::string& text) {
  try {
    static_cast<void>(parse_cycle(text, "c.csv"));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(ActuatorFile, ViscousFrictionIsWhatCoulombLeavesOfTheNoLoadTorque) {
  const auto a = parse_actuator(kMotor + kGearbox, "a.toml");
  EXPECT_DOUBLE_EQ(a.motor.viscous_Nms, (0.05 * 0.2 - 0.004) / 500.0);
  EXPECT_EQ(a.motor.static_Nm, 0.004);
  EXPECT_EQ(a.gearbox.ratio, -50.0);
}

TEST(ActuatorFile, RunningDragIsHalfOfTheBackdrivingTorque) {
  const auto half = parse_actuator(kMotor + kGearbox + "backdriving_torque_nm = 3.0\n", "a.toml");
  EXPECT_EQ(half.gearbox.coulomb_Nm, 1.5);
  EXPECT_EQ(half.gearbox.static_Nm, 3.0);
  const auto stated = parse_actuator(kMotor + kGearbox + "coulomb_torque_nm = 2.0\n", "a.toml");
  EXPECT_EQ(stated.gearbox.static_Nm, 2.0);
}

TEST(ActuatorFile, ATotalEfficiencyGivesUpItsDrag) {
  const auto a = parse_actuator(kMotor + kGearbox +
                                    "coulomb_torque_nm = 2.0\n"
                                    "efficiency_includes_drag_at_nm = 10.0\n",
                                "a.toml");
  // Forward 10 N m leave of 12 that the mesh gives; backward 8 of 10 enter it.
  EXPECT_DOUBLE_EQ(a.gearbox.efficiency_forward, 0.75 * 12.0 / 10.0);
  EXPECT_DOUBLE_EQ(a.gearbox.efficiency_backward, 0.75 * 10.0 / 8.0);
}

TEST(ActuatorFile, RefusesWhatContradictsItself) {
  EXPECT_NE(error_of(kMotor + "static_torque_nm = 0.001\n" + kGearbox).find("static_torque_nm"),
            std::string::npos);
  EXPECT_NE(error_of(kMotor + kGearbox + "backdriving_torque_nm = 1.0\ncoulomb_torque_nm = 2.0\n")
                .find("gearbox.coulomb_torque_nm = 2"),
            std::string::npos);
  EXPECT_NE(error_of(kMotor + "max_winding_c = 150.0\n" + kGearbox).find("motor.max_winding_c"),
            std::string::npos);
  EXPECT_NE(error_of(kMotor + "winding_housing_k_per_w = 2.0\n" + kGearbox)
                .find("motor.winding_housing_k_per_w: allowed: with motor.housing_ambient_k_per_w"),
            std::string::npos);
  EXPECT_NE(error_of(kMotor + "housing_ambient_k_per_w = 2.0\n" + kGearbox)
                .find("motor.housing_ambient_k_per_w: allowed: with motor.winding_housing_k_per_w"),
            std::string::npos);
  EXPECT_NE(error_of("[gears.S]\nteeth = 3\n").find("looks like a DESIGN"), std::string::npos);
}

TEST(CycleFile, RefusesWhatIsNoCycle) {
  const std::string header = "time_s,torque_nm,speed_rad_s\n";
  EXPECT_NE(cycle_error("").find("no header"), std::string::npos);
  EXPECT_NE(cycle_error(header + "0,1,2\n").find("1 row below"), std::string::npos);
  EXPECT_NE(cycle_error(header + "0,1,2\n1,inf,2\n").find("c.csv:3:3"), std::string::npos);
  EXPECT_NE(cycle_error("time_s,speed_rad_s\n0,1\n1,1\n").find("column torque_nm is missing"),
            std::string::npos);
  EXPECT_NE(cycle_error("time_s,torque_nm,speed_rad_s,angle_rad\n0,1,2,3\n").find("one of them"),
            std::string::npos);
  EXPECT_NE(cycle_error("# torque: motor\n" + header + "0,1,2\n1,1,2\n").find("# torque: motor"),
            std::string::npos);
}

TEST(CycleFile, TellsSlipsOfRowsBesideThoseOfTheHeader) {
  const std::string both =
      cycle_error("time_s,torque_nm,speed_rad_s,angle_rad\n0,1,2,3\n1,nan,2,x\n1,1,y,3\n2,1,2\n");
  for (const std::string message :
       {"c.csv:1:30: columns speed_rad_s and angle_rad: allowed: one of them",
        "c.csv:3:3: torque_nm = \"nan\"", "c.csv:3:9: angle_rad = \"x\"",
        "c.csv:4:5: speed_rad_s = \"y\"", "c.csv:4:1: time_s = 1 after 1", "c.csv:5:1: 3 fields"}) {
    EXPECT_NE(both.find(message), std::string::npos) << message << " is not in\n" << both;
  }
  const std::string lacking = cycle_error("time_s,speed_rad_s\n0,1\n0,x\n");
  for (const std::string message :
       {"c.csv:1:1: column torque_nm is missing", "c.csv:3:1: time_s = 0 after 0",
        "c.csv:3:3: speed_rad_s = \"x\""}) {
    EXPECT_NE(lacking.find(message), std::string::npos) << message << " is not in\n" << lacking;
  }
  const std::string single = cycle_error("time_s,torque_nm,speed_rad_s\n0,inf,2\n");
  EXPECT_NE(single.find("c.csv:2:3: torque_nm"), std::string::npos) << single;
  EXPECT_NE(single.find("c.csv:1:1: 1 row below"), std::string::npos) << single;
}

TEST(CycleFile, ReadsColumnsInAnyOrderAndLeavesOthers) {
  const auto cycle =
      parse_cycle("angle_rad,note,torque_nm,time_s\r\n1,x,2,0\r\n3,y,4,0.5\r\n", "c");
  EXPECT_TRUE(cycle.angles);
  EXPECT_EQ(cycle.motion, (std::vector<double>{1.0, 3.0}));
  EXPECT_EQ(cycle.load_Nm, (std::vector<double>{2.0, 4.0}));
  EXPECT_FALSE(is_periodic(cycle));
}

}  // namespace
}  // namespace gear3k::actuator_file_test
