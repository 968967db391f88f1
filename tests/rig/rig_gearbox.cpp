#include "tests/rig/rig_gearbox.hpp"

#include <cstddef>

#include "tests/rig/number_text.hpp"

namespace gear3k::rig {

Gearbox bilateral_drive_gear() {
  return {.name = "bilateral drive gear",
          .teeth = {12, 39, 90, 32, 81},
          .profile_shift = {0.476, 0.762, 2.0, 0.536, 1.21},
          .machining_allowance = {0.07, 0.07, 0.07, 0.07, 0.07},
          .module1_mm = 0.8,
          .module2_mm = 0.8467,
          .center_distance_mm = 21.268};
}

Gearbox low_backlash_gear() {
  return {.name = "low-backlash gear",
          .teeth = {14, 40, 94, 36, 92},
          .profile_shift = {0.5, 0.0, 0.45, 0.4, 0.29},
          .machining_allowance = {0.03, 0.03, 0.03, 0.03, 0.03},
          .module1_mm = 0.59,
          .module2_mm = 0.58,
          .center_distance_mm = 16.193};
}

Gearbox reversing_gear() {
  return {.name = "reversing gear",
          .teeth = {18, 30, 78, 36, 84},
          .profile_shift = {0.3, 0.2, 0.72, 0.3, 0.49},
          .machining_allowance = {0.02, 0.02, 0.02, 0.02, 0.02},
          .module1_mm = 0.8,
          .module2_mm = 0.81,
          .center_distance_mm = 19.58};
}

std::string design_toml(const Gearbox& gearbox) {
  const std::array<const char*, 5> names{"S", "P1", "R1", "P2", "R2"};
  std::string text = "name = \"" + gearbox.name + "\"\n";
  text += "planets = " + std::to_string(gearbox.planets) + "\n";
  text += "pressure_angle_deg = " + number_text(gearbox.pressure_angle_deg) + "\n";
  text += "center_distance_mm = " + number_text(gearbox.center_distance_mm) + "\n";
  text += "[rack]\naddendum = " + number_text(gearbox.addendum) + "\n";
  text += "[stage1]\nmodule_mm = " + number_text(gearbox.module1_mm) + "\n";
  text += "[stage2]\nmodule_mm = " + number_text(gearbox.module2_mm) + "\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += std::string("[gears.") + names[i] + "]\n";
    text += "teeth = " + std::to_string(gearbox.teeth[i]) + "\n";
    text += "profile_shift = " + number_text(gearbox.profile_shift[i]) + "\n";
    text += "machining_allowance = " + number_text(gearbox.machining_allowance[i]) + "\n";
  }
  text +=
      "[friction]\ncoefficient = " + number_text(gearbox.friction) + "\nloss_model = \"sliding\"\n";
  return text;
}

}  // namespace gear3k::rig
