#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "actuator/design_gear.hpp"
#include "actuator/duty_cycle.hpp"

namespace gear3k::actuator {

namespace {

using Variant = std::pair<std::string, Actuator>;

void append_motor_variants(const Actuator& whole, std::vector<Variant>& variants) {
  const auto add = [&](const char* cause) -> Actuator& {
    return variants.emplace_back(cause, whole).second;
  };
  add("copper").motor.resistance_ohm = 0.0;
  Motor& smooth = add("motor_coulomb").motor;
  smooth.coulomb_Nm = 0.0;
  smooth.static_Nm = 0.0;
  add("motor_viscous").motor.viscous_Nms = 0.0;
}

void append_catalogue_variants(const Actuator& whole, std::vector<Variant>& variants) {
  const auto add = [&](const char* cause) -> Gearbox& {
    return variants.emplace_back(cause, whole).second.gearbox;
  };
  Gearbox& smooth = add("gear_coulomb");
  smooth.coulomb_Nm = 0.0;
  smooth.static_Nm = 0.0;
  add("gear_viscous").viscous_Nms = 0.0;
  Gearbox& lossless = add("mesh");
  lossless.efficiency_forward = 1.0;
  lossless.efficiency_backward = 1.0;
}

}  // namespace

std::vector<WithoutCause> without_each(const Actuator& actuator, const Cycle& cycle,
                                       const DutyCycle& whole) {
  std::vector<Variant> variants;
  append_motor_variants(actuator, variants);
  if (actuator.train == nullptr) {
    append_catalogue_variants(actuator, variants);
  } else {
    for (const std::string& cause : design_gear_causes()) {
      variants.emplace_back(cause, actuator).second.train = without(*actuator.train, cause);
    }
  }
  Actuator& light = variants.emplace_back("inertia", actuator).second;
  light.motor.rotor_inertia_kgm2 = 0.0;
  light.gearbox.input_inertia_kgm2 = 0.0;
  light.gearbox.output_inertia_kgm2 = 0.0;
  if (light.train != nullptr) light.train = without(*light.train, "inertia");
  Drive& ideal = variants.emplace_back("drive", actuator).second.drive;
  ideal.efficiency_motoring = 1.0;
  ideal.efficiency_regenerating = 1.0;
  ideal.standby_W = 0.0;

  const double net_J = whole.drawn_J - whole.regenerated_J;
  std::vector<WithoutCause> result;
  result.reserve(variants.size());
  for (const auto& [cause, variant] : variants) {
    const DutyCycle d = run_cycle(variant, cycle);
    result.push_back({.cause = cause,
                      .drawn_J = d.drawn_J,
                      .regenerated_J = d.regenerated_J,
                      .saved_J = net_J - (d.drawn_J - d.regenerated_J)});
  }
  return result;
}

}  // namespace gear3k::actuator
