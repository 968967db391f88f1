#include "io/files/actuator_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "actuator/design_gear.hpp"
#include "io/files/design_file.hpp"
#include "io/files/document_kind.hpp"
#include "io/keys/actuator_keys.hpp"
#include "io/text/file_reader.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

namespace {

/// What follows from the keys together.
void resolve_motor(const MotorInput& in, actuator::Motor& motor) {
  motor = in.motor;
  motor.static_Nm = in.static_Nm.value_or(motor.coulomb_Nm);
  if (in.no_load_current_A && in.no_load_speed_rad_s) {
    motor.viscous_Nms = (motor.torque_constant_Nm_A * *in.no_load_current_A - motor.coulomb_Nm) /
                        *in.no_load_speed_rad_s;
  }
  if (in.thermal_resistance_K_W) motor.heat.winding_ambient_K_W = in.thermal_resistance_K_W;
}

/// An efficiency that was measured with the drag in it, without: docs/theory §58.
void take_drag_out(double torque_Nm, actuator::Gearbox& gearbox) {
  const double drag = gearbox.coulomb_Nm;
  gearbox.efficiency_forward =
      std::min(1.0, gearbox.efficiency_forward * (torque_Nm + drag) / torque_Nm);
  gearbox.efficiency_backward =
      std::min(1.0, gearbox.efficiency_backward * torque_Nm / (torque_Nm - drag));
}

void resolve_gearbox(const GearboxInput& in, actuator::Gearbox& gearbox) {
  gearbox = in.gearbox;
  gearbox.static_Nm = in.backdriving_Nm.value_or(in.coulomb_Nm.value_or(0.0));
  gearbox.coulomb_Nm = in.coulomb_Nm.value_or(0.5 * gearbox.static_Nm);
  if (in.efficiency_includes_drag_at_Nm) {
    take_drag_out(*in.efficiency_includes_drag_at_Nm, gearbox);
  }
}

void take_design(const std::string& path, double least_speed_rad_s, actuator::Actuator& result) {
  const design::Design design = read_design(path);
  try {
    auto train = std::make_shared<actuator::DesignTrain>(design);
    train->least_friction_speed_rad_s = least_speed_rad_s;
    result.gearbox = {.ratio = train->ratio(),
                      .stiffness_Nm_rad = train->stiffness_nm_rad(),
                      .backlash_rad = train->backlash_rad(),
                      .mass_kg = train->mass_kg()};
    result.train = std::move(train);
  } catch (const std::invalid_argument& error) {
    throw InvalidInput(fmt::format("{}: {}", path, error.what()));
  }
}

ActuatorFiles actuator_from(const TomlValue& document, const std::string& name) {
  using enum DocumentKind;
  refuse_other_documents(document, name, {kActuator, kBlackBox},
                         "ACTUATOR takes a file with [motor] and [gearbox]");
  FileReading reading(name);
  ActuatorInput input;
  read_by_schema(document, actuator_schema(), input, reading);
  check_actuator(input, reading);
  actuator::Actuator result{.name = input.name,
                            .motor = {},
                            .gearbox = {},
                            .drive = input.drive,
                            .load_inertia_kgm2 = input.load_inertia_kgm2,
                            .felt = input.felt,
                            .train = nullptr};
  std::vector<std::string> inputs{name};
  resolve_motor(input.motor, result.motor);
  CollectedErrors errors;
  errors.attempt([&] { reading.throw_if_invalid(); });
  if (input.gearbox.design.empty()) {
    resolve_gearbox(input.gearbox, result.gearbox);
  } else {
    inputs.push_back((std::filesystem::path(name).parent_path() / input.gearbox.design).string());
    errors.attempt([&] {
      check_named_file(inputs.back(), "gearbox.design", reading.place_of("gearbox.design"));
      take_design(inputs.back(), input.gearbox.least_friction_speed_rad_s.value_or(0.0), result);
    });
  }
  errors.raise();
  if (input.backlash_rad) result.gearbox.backlash_rad = input.backlash_rad;
  std::vector<std::string> stated;
  for (const KeyRecord* record : actuator_schema().records()) {
    if (reading.stated(record->path)) stated.push_back(record->path);
  }
  return {.actuator = std::move(result), .inputs = std::move(inputs), .stated = std::move(stated)};
}

}  // namespace

ActuatorFiles read_actuator(const std::string& path) {
  return actuator_from(read_toml(path), path);
}

actuator::Actuator parse_actuator(const std::string& text, const std::string& name) {
  return actuator_from(parse_toml(text, name), name).actuator;
}

namespace {

/// All but the gearbox.
ActuatorInput input_of(const actuator::Actuator& actuator) {
  return {.name = actuator.name,
          .motor = {.motor = actuator.motor,
                    .no_load_current_A = std::nullopt,
                    .no_load_speed_rad_s = std::nullopt,
                    .static_Nm = actuator.motor.static_Nm,
                    .thermal_resistance_K_W = actuator.motor.heat.winding_ambient_K_W},
          .gearbox = {},
          .drive = actuator.drive,
          .load_inertia_kgm2 = actuator.load_inertia_kgm2,
          .felt = actuator.felt,
          .backlash_rad = std::nullopt};
}

}  // namespace

std::string actuator_text(const actuator::Actuator& actuator) {
  ActuatorInput input = input_of(actuator);
  input.gearbox.gearbox = actuator.gearbox;
  input.gearbox.coulomb_Nm = actuator.gearbox.coulomb_Nm;
  input.gearbox.backdriving_Nm = actuator.gearbox.static_Nm;
  input.backlash_rad = actuator.gearbox.backlash_rad;
  return text_by_schema(actuator_schema(), input);
}

std::string actuator_text(const actuator::Actuator& actuator, const std::string& design) {
  ActuatorInput input = input_of(actuator);
  input.gearbox.design = design;
  return text_by_schema(actuator_schema(), input);
}

std::string actuator_key_table() { return key_table(actuator_schema()); }

}  // namespace gear3k::io
