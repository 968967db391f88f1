#include "io/keys/tolerance_keys.hpp"

#include <fmt/format.h>

#include "io/text/toml_text.hpp"
#include "units/units.hpp"

namespace gear3k::io {

namespace {

std::string limits_line(const char* key, const backlash::DeviationLimits& limits, double unit) {
  if (limits.lower == 0.0 && limits.upper == 0.0) return "";
  return fmt::format("{} = [{}, {}]\n", key, toml_number(limits.lower / unit),
                     toml_number(limits.upper / unit));
}

std::string length_line(const char* key, double length_m) {
  return length_m > 0.0 ? fmt::format("{} = {}\n", key, toml_number(length_m / units::kMicrometre))
                        : "";
}

}  // namespace

backlash::Tolerances stated_tolerances(const ToleranceInput& input) {
  backlash::Tolerances result{.gears = {},
                              .center_distance_m = input.center_distance_m,
                              .pin_position_m = input.pin_position_m,
                              .planet_phase_rad = input.planet_phase_rad,
                              .scatter = input.scatter,
                              .sigma_level = input.sigma_level};
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    result.gears[i] = input.gears[i].tolerances;
  }
  return result;
}

backlash::GearTolerances finish_gear_tolerances(const ToleranceInput::Gear& input,
                                                const GradedGear& gear, FileReading& reading) {
  backlash::GearTolerances result = input.tolerances;
  if (input.grade && gear.module_m > 0.0 && gear.reference_diameter_m > 0.0) {
    const auto pitch = backlash::pitch_grade(
        {.module_m = gear.module_m, .reference_diameter_m = gear.reference_diameter_m},
        *input.grade);
    if (!pitch) {
      const std::string key = gear.path + ".accuracy_grade";
      reading.error_at(
          key,
          fmt::format("{} = {}: a gear of module {:.6g} mm and reference diameter {:.6g} mm; "
                      "allowed: module {:g} to {:g} mm and diameter {:g} to {:g} mm, which "
                      "ISO 1328-1:1995 covers",
                      key, *input.grade, gear.module_m * 1e3, gear.reference_diameter_m * 1e3,
                      backlash::kLeastGradedModule_m * 1e3, backlash::kGreatestGradedModule_m * 1e3,
                      backlash::kLeastGradedDiameter_m * 1e3,
                      backlash::kGreatestGradedDiameter_m * 1e3));
      return result;
    }
    if (!input.runout) result.runout_m = pitch->runout_m;
    if (!input.cumulative_pitch) result.cumulative_pitch_m = pitch->cumulative_pitch_m;
    if (!input.single_pitch) result.single_pitch_m = pitch->single_pitch_m;
  }
  return result;
}

std::string tolerances_text(const backlash::Tolerances& tolerances,
                            const design::Sampling& sampling) {
  std::string text =
      "\n[tolerances]\n" +
      limits_line("center_distance_um", tolerances.center_distance_m, units::kMicrometre) +
      length_line("pin_position_um", tolerances.pin_position_m) +
      limits_line("planet_phase_arcmin", tolerances.planet_phase_rad, units::kArcmin);
  text += fmt::format("scatter = \"{}\"\nsigma_level = {}\nsamples = {}\nseed = {}\n",
                      backlash::kScatterNames[static_cast<std::size_t>(tolerances.scatter)],
                      toml_number(tolerances.sigma_level), sampling.samples, sampling.seed);
  for (std::size_t i = 0; i < train::kGearCount; ++i) {
    const backlash::GearTolerances& g = tolerances.gears[i];
    std::string gear = limits_line("tooth_thickness_um", g.tooth_thickness_m, units::kMicrometre) +
                       limits_line("tip_diameter_um", g.tip_diameter_m, units::kMicrometre);
    if (g.root_diameter_m) {
      gear += fmt::format("root_diameter_um = [{}, {}]\n",
                          toml_number(g.root_diameter_m->lower / units::kMicrometre),
                          toml_number(g.root_diameter_m->upper / units::kMicrometre));
    }
    gear += length_line("runout_um", g.runout_m) +
            length_line("cumulative_pitch_um", g.cumulative_pitch_m) +
            length_line("single_pitch_um", g.single_pitch_m);
    if (!gear.empty()) {
      text += fmt::format("\n[tolerances.{}]\n{}", train::kGearNames[i], gear);
    }
  }
  return text;
}

}  // namespace gear3k::io
