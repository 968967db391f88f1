#include "tests/wide_rig/hidden_effect.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "tests/wide_rig/part_laws.hpp"

namespace gear3k::wide_rig {
namespace {

constexpr double kTurn = std::numbers::pi / 180.0;
constexpr double kRpmToRad = std::numbers::pi / 30.0;

using Laws = std::vector<std::string>;

const std::map<std::string, Laws>& transmission_laws() {
  static const std::map<std::string, Laws> laws{
      {"friction_level", {"all_meshes", "ring_meshes", "mesh_by_mesh"}},
      {"friction_load", {"power", "power_share", "logarithmic", "saturating", "sigmoid"}},
      {"friction_speed",
       {"power", "stribeck_exponential", "mixed_film", "eyring", "stribeck_viscous"}},
      {"friction_temperature", {"linear", "exponential", "vogel", "grease_transition"}},
      {"friction_direction", {"flank_finish", "backward_only", "pinion_side", "approach_recess"}},
      {"drag_constant",
       {"sun_seal", "output_seal", "carrier_preload", "planet_preload", "two_seals"}},
      {"drag_viscous", {"sun", "carrier", "planet", "grease_power"}},
      {"drag_quadratic", {"sun", "carrier_churning", "churning_power", "splash_onset"}},
      {"bearing_load", {"output_bearing", "planet_pins", "palmgren"}},
      {"sensor_gain", {"constant", "compressive", "warming_bridge"}},
      {"sensor_offset", {"constant", "warming_zero", "creeping_zero"}},
      {"run_step",
       {"friction_sessions", "gain_sessions", "offset_sessions", "drag_sessions",
        "friction_one_step", "gain_one_step", "offset_one_step", "drag_one_step"}},
      {"drift",
       {"friction_linear", "friction_exponential", "friction_power", "friction_logarithmic",
        "friction_weibull", "gain_linear", "gain_exponential", "gain_power", "offset_exponential",
        "offset_logarithmic", "drag_power", "drag_weibull"}},
      {"runout", {"load_proportional", "friction_modulated", "torque_ripple"}},
      {"mesh_order", {"load_proportional", "friction_modulated", "torque_ripple"}},
      {"unknown",
       {"loss_speed_root_load", "resonance", "stick_slip_window", "half_turn_pulse",
        "load_dead_band"}}};
  return laws;
}

const std::map<std::string, Laws>& lost_motion_laws() {
  static const std::map<std::string, Laws> laws{
      {"clearance", {"constant", "seated", "thinned_teeth"}},
      {"compliance",
       {"linear", "hertz_power", "logarithmic", "soft_start", "two_stage", "three_stage",
        "gradual_stages"}},
      {"thermal_expansion", {"linear", "lagging_housing", "two_materials"}},
      {"runout", {"single_wave", "with_harmonics", "one_sided"}},
      {"mesh_order", {"single_wave", "with_harmonics", "one_sided"}},
      {"run_step", {"sessions", "one_step"}},
      {"drift", {"linear", "exponential", "power", "logarithmic", "weibull"}},
      {"unknown", {"torque_resonance", "torque_temperature", "half_turn_pulse"}}};
  return laws;
}

const std::map<std::string, Laws>& pair_loss_laws() {
  static const std::map<std::string, Laws> laws{
      {"friction_level", {"all_pairs", "wear_of_fine_teeth", "loss_power"}},
      {"friction_direction", {"flank_finish", "reducing_only", "approach_recess"}},
      {"bearing_load",
       {"shaft_bearings", "pinion_bearing", "rolling_bearings", "torsion_shafts", "hub_bores",
        "catalogue_bores"}},
      {"sensor_gain", {"loss_reading", "torque_ratio", "compressive"}},
      {"run_step", {"friction_sessions", "friction_one_step", "reading_sessions"}},
      {"unknown", {"common_factors", "tooth_window"}}};
  return laws;
}

const std::map<std::string, Laws>& torque_angle_laws() {
  static const std::map<std::string, Laws> laws{
      {"clearance", {"constant", "seated", "thinned_teeth"}},
      {"compliance",
       {"linear", "hertz_power", "logarithmic", "soft_start", "two_stage", "three_stage",
        "gradual_stages"}},
      {"run_step", {"sessions", "one_step"}},
      {"drift", {"linear", "exponential", "power"}}};
  return laws;
}

const std::map<std::string, Laws>& table_of(const std::string& kind) {
  if (kind == "transmission") return transmission_laws();
  if (kind == "lost_motion") return lost_motion_laws();
  if (kind == "pair_loss") return pair_loss_laws();
  if (kind == "torque_angle") return torque_angle_laws();
  throw std::invalid_argument("no kind of measurement named '" + kind + "'");
}

bool begins_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

double sign_of(rig::DeterministicRandom& random) { return random.uniform() < 0.5 ? -1.0 : 1.0; }

// A scalar law of a row in place of value(a, row, point).
template <typename Shape>
auto times(Shape shape) {
  return [shape](double a, const BenchRow& row, const MeshPoint&) { return a * shape(row); };
}

void positive(HiddenEffect& effect) { effect.smallest = 0.0; }

// Channel and unit of what steps and drifts act on.
void act_on(HiddenEffect& effect, const std::string& target, double typical) {
  effect.acts_on = target;
  if (target == "friction") {
    effect.channel = Channel::friction;
    effect.companions = {"friction_level"};
    effect.start = 0.05;
  } else if (target == "gain") {
    effect.channel = Channel::gain;
    effect.companions = {"sensor_gain", "friction_level"};
    effect.start = 0.01;
  } else if (target == "offset") {
    effect.channel = Channel::offset;
    effect.companions = {"sensor_offset"};
    effect.start = 0.01 * typical;
  } else if (target == "drag") {
    effect.channel = Channel::drag;
    effect.body = Body::sun;
    effect.companions = {"drag_constant"};
    effect.start = 0.01 * typical;
  } else {
    effect.channel = Channel::lost_motion;
    effect.companions = {"clearance"};
    effect.start = 0.01 * typical;
  }
}

// "friction_exponential" to friction and exponential; laws of lost motion name no target.
std::pair<std::string, std::string> target_and_form(const std::string& law,
                                                    const std::string& kind) {
  if (kind != "transmission" && kind != "pair_loss") return {"lost motion", law};
  const std::size_t at = law.find('_');
  return {law.substr(0, at), law.substr(at + 1)};
}

// The lowest orders need more than the turns of the campaign.
TurningBody chosen_order(std::vector<TurningBody> orders, double turns,
                         rig::DeterministicRandom& random) {
  std::vector<TurningBody> seen;
  for (const TurningBody& body : orders) {
    if (body.order * std::max(turns, 1e-9) >= 0.95 && body.order >= 0.8) seen.push_back(body);
  }
  if (seen.empty()) seen = std::move(orders);
  if (seen.empty()) throw std::invalid_argument("nothing turns in this gearbox");
  return seen[random.index(seen.size())];
}

void make_wave(HiddenEffect& effect, const TurningBody& body, bool harmonics, bool one_sided,
               rig::DeterministicRandom& random) {
  const double phase = random.between(0.0, 2.0 * std::numbers::pi);
  const double second = harmonics ? random.between(0.1, 0.45) : 0.0;
  const double third = harmonics ? random.between(0.0, 0.2) : 0.0;
  const double phase2 = random.between(0.0, 2.0 * std::numbers::pi);
  const double order = body.order;
  effect.acts_on += " at " + body.name;
  effect.value = times([=](const BenchRow& row) {
    const double x = order * row.output_angle_deg * kTurn;
    const double wave = std::sin(x + phase) + second * std::sin(2.0 * x + phase2) +
                        third * std::sin(3.0 * x + 2.0 * phase2);
    return one_sided ? std::fabs(std::sin(0.5 * x + phase)) - 2.0 / std::numbers::pi : wave;
  });
  effect.parameters.push_back({"order", "per turn of the output", order, 0.0});
  if (!harmonics && !one_sided) effect.parameters.push_back({"amplitude", "", 0.0, 1.0});
  positive(effect);
}

HiddenEffect friction_effect(const std::string& cause, const std::string& law,
                             const EffectContext& context, rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = cause, .law = law, .acts_on = "friction"};
  const BenchSubject& subject = *context.subject;
  effect.start = 0.05 * sign_of(random);
  const auto scalar = [&](const DrawnLaw& drawn, auto condition) {
    effect.smallest = drawn.smallest;
    effect.largest = drawn.largest;
    effect.start = effect.start < 0.0 ? -drawn.start : drawn.start;
    effect.companions = {"friction_level"};
    effect.value = [drawn, condition](double a, const BenchRow& row, const MeshPoint& point) {
      return drawn.value(a, condition(row, point));
    };
  };
  if (cause == "friction_load") {
    // Meshes see unlike forces: laws with a common reference force, or each mesh by its own load
    // (equal pressures by design).
    const bool by_pressure = !subject.black_box && random.uniform() < 0.3;
    std::array<double, 3> scale{1.0, 1.0, 1.0};
    if (by_pressure) {
      for (std::size_t k = 0; k < 3; ++k) {
        scale[k] = subject.train.force_per_Nm[2] / subject.train.force_per_Nm[k];
      }
    }
    const Span force{subject.force_at(context.load_Nm.low), subject.force_at(context.load_Nm.high)};
    scalar(load_law(law, force, random), [scale](const BenchRow&, const MeshPoint& point) {
      return point.force_N * scale[point.mesh];
    });
  } else if (cause == "friction_speed") {
    const Span speed{subject.sliding_at(context.speed_rpm.low),
                     subject.sliding_at(context.speed_rpm.high)};
    scalar(speed_law(law, speed, random),
           [](const BenchRow&, const MeshPoint& point) { return point.sliding_m_s; });
  } else if (cause == "friction_temperature") {
    scalar(temperature_law(law, context.temperature_c, random),
           [](const BenchRow& row, const MeshPoint&) { return row.temperature_c; });
  } else if (cause == "friction_level") {
    std::array<double, 3> share{1.0, 1.0, 1.0};
    if (law == "ring_meshes") share[0] = 0.0;
    if (law == "mesh_by_mesh") share = {random.between(0.4, 1.6), 1.0, random.between(0.4, 1.6)};
    effect.value = [share](double a, const BenchRow&, const MeshPoint& point) {
      return a * share[point.mesh];
    };
    // Meshes that differ do not lose the same in both directions.
    if (law != "all_meshes") effect.companions = {"friction_direction"};
    if (law == "all_meshes" && !subject.black_box) {
      effect.parameters.push_back({"coefficient", "1", subject.friction, subject.friction});
    }
  } else if (law == "approach_recess") {
    effect.channel = Channel::skew;
    effect.value = times([](const BenchRow&) { return 1.0; });
  } else if (law == "pinion_side") {
    effect.companions = {"friction_level"};
    effect.value = [](double a, const BenchRow&, const MeshPoint& point) {
      return point.a_drives ? a : 0.0;
    };
  } else if (law == "backward_only") {
    effect.companions = {"friction_level"};
    effect.value = times([](const BenchRow& row) { return row.forward ? 0.0 : 1.0; });
  } else {
    effect.value = times([](const BenchRow& row) { return row.forward ? 1.0 : -1.0; });
  }
  return effect;
}

HiddenEffect drag_effect(const std::string& cause, const std::string& law,
                         const EffectContext& context, rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = cause, .law = law, .acts_on = "drag", .channel = Channel::drag};
  const BenchSubject& subject = *context.subject;
  const double top = context.speed_rpm.high;
  // Inner bodies of a black box are not known: what turns there is referred to its fast shaft.
  const auto at = [&](Body body) {
    effect.body =
        subject.black_box && (body == Body::planet || body == Body::carrier) ? Body::sun : body;
    effect.acts_on = std::string("drag on ") + kBodyNames[static_cast<std::size_t>(effect.body)];
  };
  at(Body::sun);
  if (law == "output_seal") at(Body::output);
  if (begins_with(law, "carrier")) at(Body::carrier);
  if (begins_with(law, "planet")) at(Body::planet);
  if (cause == "drag_constant") {
    // A seal at the output, referred to the sun, is felt more when the sun drives.
    const double tilt = law == "two_seals" ? random.between(0.03, 0.08) : 0.0;
    effect.value =
        times([tilt](const BenchRow& row) { return row.forward ? 1.0 + tilt : 1.0 - tilt; });
    if (law == "two_seals") {
      effect.acts_on = "drag on sun and R2";
    } else {
      effect.parameters.push_back({"torque", "Nm", 0.0, 1.0});
    }
  } else if (cause == "drag_viscous") {
    double exponent = 1.0;
    if (law == "grease_power") {
      exponent = random.between(0.75, 1.25);
      effect.companions = {exponent < 1.0 ? "drag_constant" : "drag_quadratic"};
    } else if (effect.body == Body::sun) {
      effect.parameters.push_back({"coefficient", "Nm s/rad", 0.0, 1.0 / (top * kRpmToRad)});
    }
    effect.value =
        times([=](const BenchRow& row) { return std::pow(row.sun_speed_rpm / top, exponent); });
  } else {
    double exponent = 2.0, onset = 0.0;
    if (law == "churning_power") {
      exponent = random.between(1.7, 2.4);
      effect.companions = {"drag_viscous"};
    }
    if (law == "splash_onset") {
      onset = random.between(0.0, 0.2) * top;
      effect.companions = {"drag_viscous", "drag_constant"};
    }
    if (law == "sun") {
      const double top_rad_s = top * kRpmToRad;
      effect.parameters.push_back(
          {"coefficient", "Nm s2/rad2", 0.0, 1.0 / (top_rad_s * top_rad_s)});
    }
    effect.value = times([=](const BenchRow& row) {
      return std::pow(std::max(0.0, row.sun_speed_rpm - onset) / (top - onset), exponent);
    });
  }
  positive(effect);
  effect.start = 0.01 * context.typical;
  return effect;
}

HiddenEffect sensor_effect(const std::string& cause, const std::string& law,
                           const EffectContext& context, rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = cause, .law = law, .acts_on = "sensor"};
  const bool gain = cause == "sensor_gain";
  effect.channel = gain ? Channel::gain : Channel::offset;
  effect.start = sign_of(random) * (gain ? 0.01 : 0.01 * context.typical);
  const double share = random.between(0.05, 0.2) * sign_of(random);
  const double mid_c = 0.5 * (context.temperature_c.low + context.temperature_c.high);
  const double half_c =
      std::max(1.0, 0.5 * (context.temperature_c.high - context.temperature_c.low));
  const double top_Nm = context.load_Nm.high;
  if (law == "constant") {
    effect.value = times([](const BenchRow&) { return 1.0; });
    effect.parameters.push_back(gain ? HiddenEffect::Parameter{"gain", "1", 1.0, 1.0}
                                     : HiddenEffect::Parameter{"offset", "Nm", 0.0, 1.0});
  } else if (law == "compressive") {
    effect.companions = {"friction_load", "friction_level"};
    effect.value = times([=](const BenchRow& row) {
      return 1.0 - std::fabs(share) * row.output_torque_Nm / top_Nm;
    });
  } else if (law == "creeping_zero") {
    effect.companions = {"drift"};
    effect.value = times(
        [=](const BenchRow& row) { return 1.0 + share * (1.0 - std::exp(-3.0 * row.elapsed)); });
  } else {
    effect.companions = {"friction_temperature", "friction_level"};
    effect.value = times(
        [=](const BenchRow& row) { return 1.0 + share * (row.temperature_c - mid_c) / half_c; });
  }
  if (gain) effect.companions.push_back("friction_level");
  return effect;
}

HiddenEffect bearing_effect(const std::string& law, const EffectContext& context,
                            rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = "bearing_load", .law = law, .acts_on = "bearings"};
  effect.channel = Channel::output_bearing;
  if (law == "planet_pins" && !context.subject->black_box) {
    effect.channel = Channel::pin;
    effect.value = times([](const BenchRow&) { return 1.0; });
    effect.start = 0.01;
  } else if (law == "palmgren") {  // f (P/C)^y P: rises somewhat faster than the load
    const double y = random.between(0.05, 0.35), top_Nm = context.load_Nm.high;
    effect.companions = {"friction_load", "friction_level"};
    effect.value =
        times([=](const BenchRow& row) { return std::pow(row.output_torque_Nm / top_Nm, y); });
  } else {
    effect.value = times([](const BenchRow&) { return 1.0; });
  }
  positive(effect);
  return effect;
}

HiddenEffect step_effect(const std::string& law, const EffectContext& context,
                         rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = "run_step", .law = law};
  auto [target, form] = target_and_form(law, context.kind);
  if (target == "reading") target = "gain";
  act_on(effect, target, context.typical);
  const bool one = form == "one_step";
  auto values = session_values(std::max(2, context.sessions), one, random);
  const double sign = sign_of(random);
  if (target == "drag") {  // no session's drag pushes
    const double least = *std::min_element(values.begin(), values.end());
    for (double& v : values) v -= least;
    positive(effect);
  } else {
    effect.start *= sign;
  }
  // A single step begins at the nominal gearbox; of many sessions the mean is a matter of taste.
  if (one || values.size() == 2) effect.companions.clear();
  // The session after the campaign: a step stays, sessions that scatter are like one of them.
  rig::DeterministicRandom next = random;
  const double last = values.back(), drawn = values[next.index(values.size())];
  values.push_back(one || values.size() == 2 ? last : drawn);
  effect.value = times([values](const BenchRow& row) {
    return values[std::min(static_cast<std::size_t>(row.session), values.size() - 1)];
  });
  return effect;
}

HiddenEffect drift_effect(const std::string& law, const EffectContext& context,
                          rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = "drift", .law = law};
  const auto [target, form] = target_and_form(law, context.kind);
  act_on(effect, target, context.typical);
  const DrawnLaw drawn = time_law(form, random);
  // A drag that grows, or one that the seal loses as it runs in.
  const bool fades = target == "drag" && random.uniform() < 0.4;
  effect.value = [drawn, fades](double a, const BenchRow& row, const MeshPoint&) {
    return fades ? a - drawn.value(a, row.elapsed) : drawn.value(a, row.elapsed);
  };
  if (target == "drag") {
    positive(effect);
  } else {
    effect.start *= sign_of(random);
  }
  return effect;
}

HiddenEffect wave_effect(const std::string& cause, const std::string& law,
                         const EffectContext& context, rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = cause, .law = law};
  const auto bodies = turning_bodies(*context.subject);
  auto possible = cause == "runout" ? bodies : tooth_orders(*context.subject);
  if (!context.orders.empty()) {
    std::erase_if(possible, [&](const TurningBody& b) {
      return std::find(context.orders.begin(), context.orders.end(), b.order) ==
             context.orders.end();
    });
  }
  TurningBody body = chosen_order(std::move(possible), context.turns, random);
  if (context.first_order) body = bodies.back();
  if (context.kind == "lost_motion") {
    effect.channel = Channel::lost_motion;
    effect.acts_on = "lost motion";
    effect.start = 0.01 * context.typical;
  } else if (law == "friction_modulated") {
    effect.channel = Channel::friction;
    effect.acts_on = "friction";
  } else if (law == "torque_ripple") {
    effect.channel = Channel::drag;
    effect.acts_on = "drag";
    effect.start = 0.01 * context.typical;
  } else {
    effect.channel = Channel::gain;
    effect.acts_on = "ratio";
    effect.start = 0.01;
  }
  const bool harmonics =
      law == "with_harmonics" ||
      (context.kind == "transmission" && !context.first_order && random.uniform() < 0.4);
  make_wave(effect, body, harmonics, law == "one_sided", random);
  if (effect.parameters.size() > 1 && effect.channel != Channel::lost_motion) {
    effect.parameters.pop_back();  // amplitude in units of its channel, not of the reading
  } else if (effect.parameters.size() > 1) {
    effect.parameters.back().unit = "arcmin";
  }
  return effect;
}

HiddenEffect play_effect(const std::string& cause, const std::string& law,
                         const EffectContext& context, rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = cause, .law = law, .acts_on = "lost motion"};
  effect.channel = Channel::lost_motion;
  effect.start = 0.02 * context.typical;
  const Span torque = context.test_torque_Nm;
  if (cause == "clearance") {
    if (law == "seated") {  // grease and friction of the bearings hold back until some torque
      const double seat_Nm = torque.low * random.between(0.1, 0.3);
      effect.value = times([=](const BenchRow& row) {
        return row.test_torque_Nm > 0.0 ? -std::expm1(-row.test_torque_Nm / seat_Nm) : 1.0;
      });
    } else {
      effect.value = times([](const BenchRow&) { return 1.0; });
    }
    effect.parameters.push_back({"clearance", "arcmin", 0.0, 1.0});
    if (law != "thinned_teeth") positive(effect);
    return effect;
  }
  if (cause == "compliance") {
    const double mid_Nm = torque.low + random.between(0.1, 0.6) * (torque.high - torque.low);
    const double exponent = random.between(0.4, 0.85);
    const double top_Nm = torque.high;
    if (law == "hertz_power") {
      effect.value = times(
          [=](const BenchRow& row) { return std::pow(row.test_torque_Nm / top_Nm, exponent); });
    } else if (law == "logarithmic") {  // stiffness that grows with torque: soft near zero
      const double soft_Nm = std::max(mid_Nm, 0.05 * top_Nm);
      effect.value = times([=](const BenchRow& row) {
        return std::log1p(row.test_torque_Nm / soft_Nm) / std::log1p(top_Nm / soft_Nm);
      });
    } else if (law == "soft_start") {  // a bearing's rollers all carry only from some torque on
      const double share = random.between(0.3, 0.7);
      const double knee_Nm = std::max(mid_Nm, 0.1 * top_Nm);
      effect.value = times([=](const BenchRow& row) {
        return (1.0 - share) * row.test_torque_Nm / top_Nm +
               share * std::min(1.0, row.test_torque_Nm / knee_Nm);
      });
    } else if (law.ends_with("_stage") || law.ends_with("_stages")) {
      const auto wound = stage_law(law, torque, random);
      effect.value = times([=](const BenchRow& row) { return wound(row.test_torque_Nm); });
    } else {
      effect.value = times([=](const BenchRow& row) { return row.test_torque_Nm / top_Nm; });
      effect.parameters.push_back({"compliance", "arcmin/Nm of test torque", 0.0, 1.0 / top_Nm});
    }
    if (law != "linear") effect.companions = {"clearance"};
    positive(effect);
    return effect;
  }
  if (cause == "thermal_expansion") {
    effect.channel = Channel::expansion;
    effect.acts_on = "centre distance";
    const double origin_c = random.uniform() < 0.6 ? 20.0 : random.between(15.0, 30.0);
    const double curve = law == "two_materials" ? random.between(0.003, 0.012) : 0.0;
    const bool lag = law == "lagging_housing";
    effect.value = times([=](const BenchRow& row) {
      const double rise_k = (lag ? row.housing_c : row.temperature_c) - origin_c;
      return rise_k * (1.0 + curve * rise_k);
    });
    if (law == "linear") effect.parameters.push_back({"expansion", "1/K", 0.0, 1.0});
    effect.start = 1e-6 * sign_of(random);
    effect.companions = {"clearance"};
    return effect;
  }
  throw std::invalid_argument("no law '" + law + "' of " + cause);
}

HiddenEffect pair_effect(const std::string& cause, const std::string& law,
                         const EffectContext& context, rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = cause, .law = law, .acts_on = "friction"};
  const double sign = sign_of(random);
  effect.start = 0.05 * sign;
  if (cause == "friction_level") {
    if (law == "wear_of_fine_teeth") {
      effect.value = times([](const BenchRow& row) {
        return std::pow(24.0 / std::min(row.driving_teeth, row.driven_teeth), 0.05);
      });
    } else if (law == "loss_power") {
      effect.value = times([](const BenchRow& row) {
        return 1.0 + 0.05 * std::cos(0.05 * (row.driving_teeth + row.driven_teeth));
      });
    } else {
      effect.value = times([](const BenchRow&) { return 1.0; });
      effect.parameters.push_back(
          {"coefficient", "1", context.subject->friction, context.subject->friction});
    }
  } else if (cause == "friction_direction") {
    const auto reducing = [](const BenchRow& row) { return row.driving_teeth < row.driven_teeth; };
    if (law == "approach_recess") {
      effect.channel = Channel::skew;
      effect.value = times([](const BenchRow&) { return 1.0; });
    } else if (law == "reducing_only") {
      effect.companions = {"friction_level"};
      effect.value = times([=](const BenchRow& row) { return reducing(row) ? 1.0 : 0.0; });
    } else {
      effect.value = times([=](const BenchRow& row) { return reducing(row) ? 1.0 : -1.0; });
    }
  } else if (cause == "bearing_load") {
    // Friction torque of a bearing over that of its gear: coefficient x radius / base radius.
    effect.channel = Channel::loss;
    effect.acts_on = "bearings";
    const double both = law == "pinion_bearing" ? 0.0 : 1.0;
    const double growth = law == "rolling_bearings" ? random.between(0.05, 0.3) : 0.0;
    effect.value = times([=](const BenchRow& row) {
      const double small = std::min(row.driving_teeth, row.driven_teeth);
      const double large = std::max(row.driving_teeth, row.driven_teeth);
      return 24.0 / small * std::pow(small / 24.0, growth) +
             both * 24.0 / large * std::pow(large / 24.0, growth);
    });
    if (law.ends_with("_shafts") || law.ends_with("_bores")) {
      const auto radius = bearing_radius_law(law, random);
      const double half_module_mm = 0.5 * context.subject->module_mm;
      effect.value = times([=](const BenchRow& row) {
        const double one = half_module_mm * row.driving_teeth;
        const double other = half_module_mm * row.driven_teeth;
        return radius(one) / one + radius(other) / other;
      });
    }
    effect.companions = {"friction_level"};
    effect.start = 1e-3;
    positive(effect);
  } else if (law == "torque_ratio") {
    // Loss = 1 - driven power / driving power: a gain of one torque sensor shifts all losses.
    effect.channel = Channel::loss;
    effect.acts_on = "sensor";
    effect.value = times([](const BenchRow&) { return 1.0; });
    effect.companions = {"friction_level"};
    effect.start = 1e-3 * sign;
  } else {
    effect.channel = Channel::gain;
    effect.acts_on = "sensor";
    if (law == "compressive") {
      effect.value = times([](const BenchRow& row) {
        return 1.0 - 2.0 / std::min(row.driving_teeth, row.driven_teeth);
      });
    } else {
      effect.value = times([](const BenchRow&) { return 1.0; });
      effect.parameters.push_back({"gain", "1", 1.0, 1.0});
    }
  }
  return effect;
}

// What no cause of the table does.
HiddenEffect unknown_effect(const std::string& law, const EffectContext& context,
                            rig::DeterministicRandom& random) {
  HiddenEffect effect{.cause = "unknown", .law = law, .acts_on = "loss", .channel = Channel::drag};
  effect.start = 0.01 * context.typical;
  positive(effect);
  const double top_rpm = context.speed_rpm.high, top_Nm = context.load_Nm.high;
  if (context.kind == "pair_loss") {
    effect.channel = Channel::loss;
    effect.start = 1e-3;
    if (law == "common_factors") {  // the same teeth meet again and again
      effect.value = times([](const BenchRow& row) {
        return std::gcd(row.driving_teeth, row.driven_teeth) > 2 ? 1.0 : 0.0;
      });
    } else {
      const double at = random.between(50.0, 80.0);
      effect.value = times([at](const BenchRow& row) {
        const double x = (row.driving_teeth + row.driven_teeth - 1.5 * at) / 12.0;
        return std::exp(-x * x);
      });
    }
    return effect;
  }
  if (law == "half_turn_pulse") {
    // A chip that passes: a short pulse at an angle that belongs to no body.
    const double order = random.between(2.3, 6.7), width = random.between(0.05, 0.12);
    effect.value = times([=](const BenchRow& row) {
      const double turn = order * row.output_angle_deg / 360.0;
      const double x = (turn - std::round(turn)) / width;
      return std::exp(-x * x);
    });
    if (context.kind == "lost_motion") effect.channel = Channel::lost_motion;
    return effect;
  }
  if (context.kind == "lost_motion") {
    effect.channel = Channel::lost_motion;
    const double mid_Nm = 0.5 * (context.test_torque_Nm.low + context.test_torque_Nm.high);
    const double mid_c = 0.5 * (context.temperature_c.low + context.temperature_c.high);
    const double half_c = 0.5 * (context.temperature_c.high - context.temperature_c.low) + 1.0;
    const double half_Nm = 0.5 * (context.test_torque_Nm.high - context.test_torque_Nm.low) + 0.01;
    if (law == "torque_resonance") {  // something gives way at one torque and snaps back
      effect.value = times([=](const BenchRow& row) {
        const double x = (row.test_torque_Nm - mid_Nm) / (0.35 * half_Nm);
        return std::exp(-x * x);
      });
    } else {  // the product alone, without the two by themselves
      effect.smallest = -1e9;
      effect.value = times([=](const BenchRow& row) {
        return (row.test_torque_Nm - mid_Nm) / half_Nm * (row.temperature_c - mid_c) / half_c;
      });
    }
    return effect;
  }
  if (law == "loss_speed_root_load") {
    effect.value = times([=](const BenchRow& row) {
      return row.sun_speed_rpm / top_rpm * std::sqrt(row.output_torque_Nm / top_Nm);
    });
  } else if (law == "resonance") {
    const double at = top_rpm * random.between(0.45, 0.7),
                 width = top_rpm * random.between(0.04, 0.1);
    effect.value = times([=](const BenchRow& row) {
      const double x = (row.sun_speed_rpm - at) / width;
      return 1.0 / (1.0 + x * x);
    });
  } else if (law == "stick_slip_window") {  // chatter in a window of speed and load
    const double at_rpm = top_rpm * random.between(0.2, 0.5);
    const double at_Nm = top_Nm * random.between(0.35, 0.6);
    effect.value = times([=](const BenchRow& row) {
      const double x = std::log(row.sun_speed_rpm / at_rpm) / 0.5;
      const double y = std::log(row.output_torque_Nm / at_Nm) / 0.4;
      return std::exp(-x * x - y * y);
    });
  } else {  // load_dead_band: nothing below a load, then all at once, in one sense of rotation
    const double knee_Nm = random.between(0.45, 0.7) * top_Nm;
    effect.value = times([=](const BenchRow& row) {
      return row.rotation > 0.0 && row.output_torque_Nm > knee_Nm ? 1.0 : 0.0;
    });
  }
  return effect;
}

}  // namespace

std::vector<std::string> laws_of(const std::string& cause, const std::string& kind) {
  const auto& table = table_of(kind);
  const auto found = table.find(cause);
  return found == table.end() ? Laws{} : found->second;
}

std::vector<std::string> causes_of(const std::string& kind) {
  std::vector<std::string> causes;
  for (const auto& [cause, laws] : table_of(kind)) {
    if (cause != "unknown") causes.push_back(cause);
  }
  return causes;
}

HiddenEffect make_effect(const std::string& cause, const std::string& law,
                         const EffectContext& context, rig::DeterministicRandom& random) {
  const Laws known = laws_of(cause, context.kind);
  if (std::find(known.begin(), known.end(), law) == known.end()) {
    throw std::invalid_argument("no law '" + law + "' of " + cause + " in " + context.kind);
  }
  if (cause == "unknown") return unknown_effect(law, context, random);
  if (cause == "run_step") return step_effect(law, context, random);
  if (context.kind == "pair_loss") return pair_effect(cause, law, context, random);
  if (cause == "drift") return drift_effect(law, context, random);
  if (cause == "runout" || cause == "mesh_order") return wave_effect(cause, law, context, random);
  if (context.kind != "transmission") return play_effect(cause, law, context, random);
  if (begins_with(cause, "friction")) return friction_effect(cause, law, context, random);
  if (begins_with(cause, "drag")) return drag_effect(cause, law, context, random);
  if (cause == "bearing_load") return bearing_effect(law, context, random);
  return sensor_effect(cause, law, context, random);
}

std::vector<TurningBody> turning_bodies(const BenchSubject& subject) {
  if (subject.black_box) return {{"fast shaft", std::fabs(subject.ratio)}, {"output", 1.0}};
  const rig::Train& train = subject.train;
  return {{"sun relative to the carrier", std::fabs(train.sun_speed)},
          {"sun", std::fabs(train.ratio)},
          {"planet relative to the carrier", std::fabs(train.planet_speed)},
          {"planet", std::fabs(train.planet_speed + train.carrier_speed)},
          {"carrier", std::fabs(train.carrier_speed)},
          {"R2 relative to the carrier", std::fabs(train.output_speed)},
          {"R2", 1.0}};
}

std::vector<TurningBody> tooth_orders(const BenchSubject& subject) {
  if (subject.black_box) return {};
  const rig::Train& train = subject.train;
  return {{"teeth of stage 1", train.gearbox.teeth[0] * std::fabs(train.sun_speed)},
          {"teeth of stage 2", train.gearbox.teeth[4] * std::fabs(train.output_speed)}};
}

}  // namespace gear3k::wide_rig
