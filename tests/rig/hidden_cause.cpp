#include "tests/rig/hidden_cause.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace gear3k::rig {
namespace {

[[noreturn]] void refuse(const HiddenCause& cause, const std::string& why) {
  throw std::invalid_argument("cause " + cause.id + " (" + cause.variant + "): " + why);
}

struct Known {
  const char* id;
  std::vector<std::string> variants;  // the first is the default
  std::vector<Kind> kinds;
  bool in_library = true;
};

const std::vector<Known>& known_causes() {
  using enum Kind;
  static const std::vector<Known> causes{
      {"friction_level", {""}, {transmission, pair_loss}},
      {"friction_load", {""}, {transmission}},
      {"friction_speed", {""}, {transmission}},
      {"friction_temperature", {""}, {transmission}},
      {"friction_direction", {"approach_recess", "drive"}, {transmission, pair_loss}},
      {"drag_constant", {"sun", "output"}, {transmission}},
      {"drag_viscous", {""}, {transmission}},
      {"drag_quadratic", {""}, {transmission}},
      {"bearing_load", {"pins", "output"}, {transmission, pair_loss}},
      {"sensor_gain", {""}, {transmission, pair_loss}},
      {"sensor_offset", {""}, {transmission}},
      {"run_step", {"shift", "sensor"}, {transmission, lost_motion, torque_angle, pair_loss}},
      {"drift", {"linear", "saturating", "friction"}, {transmission, lost_motion, torque_angle}},
      {"runout",
       {"sun", "planet", "carrier", "sun_absolute", "planet_absolute"},
       {transmission, lost_motion}},
      {"mesh_order", {"stage1", "stage2"}, {transmission, lost_motion}},
      {"clearance", {""}, {lost_motion, torque_angle}},
      {"compliance", {""}, {lost_motion, torque_angle}},
      {"thermal_expansion", {""}, {lost_motion}},
      {"odd_order", {""}, {transmission, lost_motion}, false},
      {"resonance", {""}, {transmission}, false},
      {"rotation_load", {""}, {transmission}, false},
      {"time_oscillation", {""}, {transmission, lost_motion}, false},
      {"corner", {""}, {transmission}, false},
  };
  return causes;
}

const Known& find_known(const HiddenCause& cause, Kind kind) {
  for (const Known& known : known_causes()) {
    if (known.id != cause.id) continue;
    if (!cause.variant.empty() && std::find(known.variants.begin(), known.variants.end(),
                                            cause.variant) == known.variants.end()) {
      refuse(cause, "no such variant");
    }
    if (std::find(known.kinds.begin(), known.kinds.end(), kind) == known.kinds.end()) {
      refuse(cause, "this kind of measurement does not show it");
    }
    return known;
  }
  refuse(cause, "unknown");
}

std::string variant_of(const HiddenCause& cause, Kind kind) {
  const Known& known = find_known(cause, kind);
  return cause.variant.empty() ? known.variants.front() : cause.variant;
}

double order_of(const std::string& id, const std::string& variant, const Train& train) {
  const auto& z = train.gearbox.teeth;
  const double output = 1.0;  // all speeds are per absolute output speed
  if (id == "odd_order") return 7.3 * output;
  if (variant == "sun") return std::fabs(train.sun_speed);
  if (variant == "sun_absolute") return std::fabs(train.ratio);
  if (variant == "planet") return std::fabs(train.planet_speed);
  if (variant == "planet_absolute") return std::fabs(train.planet_speed + train.carrier_speed);
  if (variant == "carrier") return std::fabs(train.carrier_speed);
  if (variant == "stage1") return std::fabs(train.planet_speed) * z[1];
  if (variant == "stage2") return std::fabs(train.planet_speed) * z[3];
  return 0.0;
}

const char* response_unit(Kind kind) {
  if (kind == Kind::transmission) return "Nm";
  return kind == Kind::pair_loss ? "" : "arcmin";
}

}  // namespace

void add_cause(Effects& effects, const HiddenCause& cause, double amplitude, Kind kind,
               const Train& train) {
  const std::string variant = variant_of(cause, kind);
  const std::string& id = cause.id;
  const Wave wave{.order = order_of(id, variant, train),
                  .amplitude = amplitude,
                  .phase_rad = cause.phase_rad.value_or(0.0)};
  const Drift drift{.amplitude = amplitude,
                    .duration_s = cause.duration_s.value_or(0.0),
                    .cycles = cause.cycles.value_or(0.0),
                    .saturating = variant == "saturating"};
  if (id == "friction_level") {
    effects.friction_factor *= 1.0 + amplitude;
  } else if (id == "friction_load") {
    effects.load_exponent += amplitude;
  } else if (id == "friction_speed") {
    effects.speed_rise += amplitude;
  } else if (id == "friction_temperature") {
    effects.viscosity_exponent += amplitude;
  } else if (id == "friction_direction") {
    if (variant == "drive" && kind == Kind::pair_loss) refuse(cause, "pairs have no sun");
    (variant == "drive" ? effects.drive_skew : effects.approach_skew) += amplitude;
  } else if (id == "drag_constant") {
    (variant == "output" ? effects.output_drag_Nm : effects.sun_drag_Nm) += amplitude;
  } else if (id == "drag_viscous") {
    effects.viscous_Nms_rad += amplitude;
  } else if (id == "drag_quadratic") {
    effects.quadratic_Nms2_rad2 += amplitude;
  } else if (id == "bearing_load") {
    if (kind == Kind::pair_loss) {
      effects.pair_bearing += amplitude;
    } else {
      (variant == "output" ? effects.output_bearing : effects.pin_friction) += amplitude;
    }
  } else if (id == "sensor_gain") {
    effects.gain += amplitude;
  } else if (id == "sensor_offset") {
    effects.offset_Nm += amplitude;
  } else if (id == "run_step") {
    if (variant == "sensor" && kind != Kind::transmission) refuse(cause, "no torque sensor");
    effects.steps.push_back({.amplitude = amplitude,
                             .from_session = cause.from_session.value_or(0),
                             .sensor_sign = variant == "sensor"});
  } else if (id == "drift") {
    if (variant != "friction") {
      effects.drifts.push_back(drift);
    } else if (kind == Kind::transmission && !effects.friction_drift) {
      effects.friction_drift = drift;
    } else {
      refuse(cause, "friction drifts in transmission data only, and once");
    }
  } else if (id == "runout" && kind == Kind::lost_motion) {
    const bool sun = variant.starts_with("sun");
    effects.eccentric.push_back({.meshes = {true, !sun, !sun}, .wave = wave});
  } else if (id == "runout" || (id == "mesh_order" && kind == Kind::transmission)) {
    effects.relative_waves.push_back(wave);
  } else if (id == "mesh_order" || id == "odd_order") {
    effects.added_waves.push_back(wave);
  } else if (id == "clearance") {
    effects.clearance_arcmin += amplitude;
  } else if (id == "compliance") {
    effects.compliance_arcmin_Nm += amplitude;
  } else if (id == "thermal_expansion") {
    effects.expansion_1_K += amplitude;
  } else if (id == "resonance") {
    effects.resonance_Nm += amplitude;
  } else if (id == "rotation_load") {
    effects.rotation_load += amplitude;
  } else if (id == "time_oscillation") {
    effects.oscillations.push_back(drift);
    effects.oscillation_phase_rad.push_back(wave.phase_rad);
  } else if (id == "corner") {
    effects.corner_Nm += amplitude;
  } else {
    refuse(cause, "not applied");
  }
}

double usual_amplitude(const HiddenCause& cause, Kind kind, double noise_sd) {
  const std::string& id = cause.id;
  if (id == "friction_temperature" || id == "friction_load" || id == "friction_level" ||
      id == "friction_speed" || id == "friction_direction") {
    return 0.03;
  }
  if (id == "drift" && cause.variant == "friction") return 0.03;
  if (id == "drag_viscous") return noise_sd / 60.0;
  if (id == "drag_quadratic") return noise_sd / 3600.0;
  if (id == "drag_constant" && cause.variant == "output") return 50.0 * noise_sd;
  if (id == "bearing_load" || id == "sensor_gain") return 0.01;
  if (id == "runout" && kind == Kind::lost_motion) return 2e-6;
  if (id == "runout" || (id == "mesh_order" && kind == Kind::transmission)) return 0.01;
  if (id == "thermal_expansion") return 1e-5;
  if (id == "rotation_load") return noise_sd / 20.0;
  return noise_sd;
}

Truth truth_of(const HiddenCause& cause, double amplitude, Kind kind, const Train& train) {
  const Known& known = find_known(cause, kind);
  const std::string variant = variant_of(cause, kind);
  const std::string& id = cause.id;
  Truth truth{.id = id,
              .variant = variant,
              .body = "",
              .order = order_of(id, variant, train),
              .in_library = known.in_library,
              .parameters = {}};
  if (id == "friction_level" || id == "friction_speed" ||
      (id == "drift" && variant == "friction")) {
    truth.physical = amplitude >= -1.0;
  } else if (id == "friction_direction") {
    truth.physical = std::fabs(amplitude) <= 1.0;
  }
  std::vector<TruthParameter>& p = truth.parameters;
  const double mu = train.gearbox.friction;
  if (id == "friction_level") {
    p = {{"factor", "", 1.0 + amplitude}, {"coefficient", "", mu * (1.0 + amplitude)}};
  } else if (id == "friction_load") {
    p = {{"exponent", "", amplitude}, {"reference_output_torque", "Nm", 20.0}};
  } else if (id == "friction_speed") {
    p = {{"rise_at_rest", "", amplitude},
         {"stribeck_speed", "m/s", train.stribeck_speed_m_s},
         {"stribeck_sun_speed", "rpm", 400.0}};
  } else if (id == "friction_temperature") {
    p = {{"viscosity_exponent", "", amplitude}, {"reference_temperature", "C", 35.0}};
  } else if (id == "friction_direction") {
    p = {{variant == "drive" ? "forward_excess" : "approach_excess", "", amplitude}};
  } else if (id == "drag_constant") {
    p = {{"torque", "Nm", amplitude}};
  } else if (id == "drag_viscous") {
    p = {{"coefficient", "Nm s/rad", amplitude}};
  } else if (id == "drag_quadratic") {
    p = {{"coefficient", "Nm s2/rad2", amplitude}};
  } else if (id == "bearing_load") {
    if (kind == Kind::pair_loss || variant == "output") {
      p = {{"fraction", "", amplitude}};
    } else {
      p = {{"friction", "", amplitude}, {"pin_radius", "m", train.pin_radius_m}};
    }
  } else if (id == "sensor_gain") {
    p = {{"gain", "", amplitude}};
  } else if (id == "sensor_offset" || id == "run_step") {
    p = {{id == "run_step" ? "step" : "offset", response_unit(kind), amplitude}};
    if (id == "run_step") {
      p.push_back({"from_session", "", static_cast<double>(cause.from_session.value_or(0))});
    }
  } else if (id == "drift") {
    const std::string unit = variant == "friction" ? "" : response_unit(kind);
    p = {{"over_campaign", unit, amplitude}};
    if (cause.duration_s && *cause.duration_s > 0.0) {
      p.push_back({"per_hour", unit.empty() ? "1/h" : unit + "/h",
                   amplitude / (*cause.duration_s / 3600.0)});
    }
  } else if (id == "runout" || id == "mesh_order") {
    truth.body = variant.substr(0, variant.find('_'));
    if (kind == Kind::transmission) {
      p = {{"amplitude", "", amplitude}};
    } else if (id == "runout") {
      p = {{"eccentricity", "m", amplitude}};
    } else {
      p = {{"amplitude", "arcmin", amplitude}};
    }
    p.push_back({"phase", "rad", cause.phase_rad.value_or(0.0)});
  } else if (id == "clearance") {
    p = {{"clearance", "arcmin", amplitude}};
  } else if (id == "compliance") {
    p = {{"compliance", "arcmin/Nm", amplitude}};
  } else if (id == "thermal_expansion") {
    p = {{"expansion", "1/K", amplitude}};
  } else {
    p = {{"amplitude", response_unit(kind), amplitude}};
  }
  return truth;
}

}  // namespace gear3k::rig
