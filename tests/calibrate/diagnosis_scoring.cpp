#include "tests/calibrate/diagnosis_scoring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>

#include "io/files/design_file.hpp"
#include "io/files/measurement_file.hpp"

namespace gear3k::rig {

namespace {

calibrate::Diagnosis diagnose_csv(const Gearbox& gearbox, const std::vector<std::string>& csv) {
  const design::Design design = io::parse_design(design_toml(gearbox), "design.toml");
  std::vector<io::FileText> files;
  for (std::size_t k = 0; k < csv.size(); ++k) {
    files.push_back({.path = fmt::format("data{}.csv", k), .text = csv[k]});
  }
  const io::Measurements measurements = io::parse_measurements(files);
  const calibrate::MeasurementSet& set = measurements.sets.at(0);
  const calibrate::Simulation simulation(design, set.kind);
  return *calibrate::diagnose(simulation, set, {});
}

bool names(const calibrate::Effect& effect, const std::string& id) {
  return effect.id == id ||
         std::ranges::any_of(effect.alternatives, [&](const auto& a) { return a.id == id; });
}

/// Whether effects and hidden causes can be matched one to one.
bool matched(const std::vector<calibrate::Effect>& effects, std::vector<std::string> hidden) {
  if (effects.size() != hidden.size()) return false;
  std::ranges::sort(hidden);
  do {
    bool all = true;
    for (std::size_t k = 0; k < hidden.size(); ++k) all = all && names(effects[k], hidden[k]);
    if (all) return true;
  } while (std::ranges::next_permutation(hidden).found);
  return false;
}

/// What was hidden, in the words of the effect found; empty where its form is another one, or where
/// rig and library do not have the same law.
std::optional<TruthParameter> comparable_truth(const Truth& truth, const calibrate::Effect& e) {
  const auto value = [&](const char* name) {
    return std::ranges::find(truth.parameters, name, &TruthParameter::name)->value;
  };
  const std::string& id = truth.id;
  const std::string& form = e.form.name;
  const std::string& variant = truth.variant;
  const auto result = [](const char* name, double v) {
    return std::optional<TruthParameter>({.name = name, .unit = "", .value = v});
  };
  if (id == "friction_level") return result("relative_change", value("factor") - 1.0);
  if (id == "friction_load") return result("exponent", value("exponent"));
  if (id == "friction_speed") {
    // mu (1 + A/(1 + (n/n_s)^2)) at 200 over that at 1000 rpm.
    const auto law = [&](double rpm) {
      const double reduced = rpm / value("stribeck_sun_speed");
      return 1.0 + value("rise_at_rest") / (1.0 + reduced * reduced);
    };
    return result("slow_over_fast", law(200.0) / law(1000.0));
  }
  if (id == "friction_temperature") {
    // d ln(nu)/dT of Vogel's law at 35 C: -1159/(35 + 110)^2.
    return result("coefficient", -value("viscosity_exponent") * 1159.0 / (145.0 * 145.0));
  }
  if (id == "friction_direction" && variant == "drive" && form == "forward_backward") {
    return result("asymmetry", value("forward_excess"));
  }
  const bool same_place = form == (variant.empty() ? "sun" : variant);
  if (id == "drag_constant" && same_place) return result("torque", value("torque"));
  if (id.starts_with("drag_") && same_place) return result("coefficient", value("coefficient"));
  if (id == "bearing_load" && variant == "pins" && form == "planet_bearings") {
    return result("friction_radius", 1e3 * value("friction") * value("pin_radius"));
  }
  if (id == "bearing_load" &&
      (form == "shafts" || (variant == "output" && form == "output_bearing"))) {
    return result("share", value("fraction"));
  }
  if (id == "sensor_gain") return result("gain_error", value("gain"));
  if (id == "sensor_offset") return result("offset", value("offset"));
  if (id == "run_step" && (form == "from" || form == "sensor_from")) {
    return result("step", value("step"));
  }
  if (id == "drift" && variant == "linear" && form.starts_with("linear")) {
    return result("change", value("over_campaign"));
  }
  if (id == "runout" || id == "mesh_order") {
    const auto at = std::ranges::find(truth.parameters, "amplitude", &TruthParameter::name);
    if (at != truth.parameters.end()) return result("amplitude", at->value);
  }
  if (id == "clearance") return result("extra_lost_motion", value("clearance"));
  if (id == "compliance") return result("compliance", value("compliance"));
  if (id == "thermal_expansion") return result("expansion", 1e6 * value("expansion"));
  return std::nullopt;
}

std::string answer_of(const calibrate::Diagnosis& d) {
  std::string text;
  for (const auto& effect : d.effects) {
    text += text.empty() ? "" : " + ";
    text += effect.id + ":" + effect.form.name;
    if (effect.alternatives.empty()) continue;
    text += "(";
    for (const auto& a : effect.alternatives) text += a.id + (a.with_level ? "+level " : " ");
    text.back() = ')';
  }
  if (text.empty())
    text = std::string(calibrate::kVerdictNames[static_cast<std::size_t>(d.verdict)]);
  if (d.remainder.significant) text += " remainder along " + d.remainder.along;
  return text;
}

}  // namespace

namespace {

/// Measures the proposed experiment on the rig and diagnoses old and new rows together.  Resolved:
/// the true cause is named, and none of its aliases beside it.
Score score_after_experiment(const Scenario& scenario, const Gearbox& gearbox, const Dataset& first,
                             const calibrate::Diagnosis& d, std::uint64_t seed) {
  Score result;
  result.answer = "no experiment proposed: " + answer_of(d);
  if (!d.next_experiment) return result;
  constexpr double kRpm = 0.10471975511965977;
  std::vector<std::string> files{first.csv};
  for (const bool reference : {false, true}) {
    std::vector<Condition> conditions;
    for (const auto& proposed : d.next_experiment->conditions) {
      const calibrate::Condition& c = proposed.condition;
      if (c.reference_sensor != reference) continue;
      Condition row;
      row.forward = c.direction == design::Direction::kForward;
      row.sun_speed_rpm = c.sun_speed_rad_s / kRpm;
      row.output_torque_Nm = c.output_torque_Nm;
      row.rotation = c.rotation;
      if (std::isfinite(c.temperature_K)) row.temperature_c = c.temperature_K - 273.15;
      row.time_s = first.conditions.back().time_s + 3600.0;
      row.session = scenario.plan.sessions;
      row.repeats = proposed.repeats;
      conditions.push_back(row);
    }
    if (conditions.empty()) continue;
    std::vector<HiddenCause> causes;
    for (const HiddenCause& cause : first.causes) {
      if (!(reference && cause.id.starts_with("sensor_"))) causes.push_back(cause);
    }
    // The rig writes the columns of a plan; a proposed rotation needs its column.
    Plan plan = scenario.plan;
    plan.rotation = true;
    std::string csv = measure_conditions(gearbox, plan, conditions, causes, first.noise_sd,
                                         seed + 1000003, reference ? "reference" : "next")
                          .csv;
    if (reference) csv.insert(0, "# sensor: reference\n");
    files.push_back(csv);
  }
  const calibrate::Diagnosis after = diagnose_csv(gearbox, files);
  result.answer = answer_of(after);
  const std::string& hidden = scenario.causes[0].id;
  for (const auto& effect : after.effects) {
    if (effect.id != hidden) {
      result.wrong = true;
      continue;
    }
    result.right = std::ranges::none_of(
        scenario.aliases, [&](const std::string& id) { return id != hidden && names(effect, id); });
  }
  result.right = result.right && !result.wrong;
  return result;
}

}  // namespace

calibrate::Diagnosis diagnose_campaign(const Scenario& scenario, std::uint64_t seed) {
  const Gearbox gearbox = bilateral_drive_gear();
  return diagnose_csv(gearbox, {measure(gearbox, scenario.plan, scenario.causes, seed).csv});
}

Score score(const Scenario& scenario, std::uint64_t seed) {
  const Gearbox gearbox = bilateral_drive_gear();
  const Dataset data = measure(gearbox, scenario.plan, scenario.causes, seed);
  const calibrate::Diagnosis d = diagnose_csv(gearbox, {data.csv});
  std::vector<std::string> hidden;
  for (const HiddenCause& cause : scenario.causes) hidden.push_back(cause.id);
  Score result;
  result.answer = answer_of(d);
  const bool named = matched(d.effects, hidden) && !d.remainder.significant;
  // Sessions that are off by half the noise are steps between sessions for whoever sees them.
  const bool off = scenario.plan.noise == Noise::session_offsets;
  for (const auto& effect : d.effects) {
    const bool hit =
        std::ranges::any_of(hidden, [&](const auto& id) { return names(effect, id); }) ||
        (off && names(effect, "run_step"));
    result.wrong = result.wrong || !hit;
    result.explanations += 1.0 + static_cast<double>(effect.alternatives.size());
  }
  if (!d.effects.empty()) result.explanations /= static_cast<double>(d.effects.size());
  result.doubtful = std::ranges::any_of(d.effects, [](const auto& e) { return e.no_cause > 0.5; });
  // Of several effects the next experiment is about one.
  const bool asks =
      d.effects.size() > 1 ||
      (d.next_experiment && std::ranges::count(d.next_experiment->separates, "no_cause") > 0);
  result.hides_doubt = result.doubtful && (d.verdict == calibrate::Verdict::kExplained || !asks);
  switch (scenario.expectation) {
    case Expectation::kNothing:
      result.right = off ? !d.remainder.significant && !result.wrong
                         : d.verdict == calibrate::Verdict::kNoDiscrepancy;
      break;
    case Expectation::kNamed:
      result.right = named;
      break;
    case Expectation::kResolved:
      result = score_after_experiment(scenario, gearbox, data, d, seed);
      break;
    case Expectation::kAliases:
      result.right = named && std::ranges::any_of(d.effects, [&](const auto& effect) {
                       return std::ranges::all_of(
                           scenario.aliases, [&](const auto& id) { return names(effect, id); });
                     });
      break;
    case Expectation::kUnexplained:
      result.right = d.remainder.significant;
      // A cause beside a significant remainder is not named alone: the verdict is `unexplained`,
      // and whoever reads it knows that the cause is not the whole of it.
      result.wrong = !d.effects.empty() && !d.remainder.significant;
      break;
  }
  if (scenario.causes.size() == 1 && d.effects.size() == 1 && d.effects[0].id == hidden[0]) {
    const auto truth = comparable_truth(data.truth.at(0), d.effects[0]);
    for (const auto& p : d.effects[0].parameters) {
      if (!truth || p.name != truth->name) continue;
      result.has_interval = true;
      result.inside = p.low <= truth->value && truth->value <= p.high;
    }
  }
  return result;
}

std::vector<Scenario> scenarios() {
  std::vector<Scenario> list;
  struct Alone {
    const char* id;
    const char* variant;
    double sign;
  };
  const Plan transmission = transmission_plan();
  const std::vector<Alone> in_transmission{{"friction_level", "", 1},
                                           {"friction_load", "", -1},
                                           {"friction_speed", "", 1},
                                           {"friction_temperature", "", 1},
                                           {"friction_direction", "drive", 1},
                                           {"drag_constant", "sun", 1},
                                           {"drag_constant", "output", 1},
                                           {"drag_viscous", "", 1},
                                           {"drag_quadratic", "", 1},
                                           {"bearing_load", "pins", 1},
                                           {"bearing_load", "output", 1},
                                           {"sensor_gain", "", 1},
                                           {"sensor_offset", "", 1},
                                           {"run_step", "shift", 1},
                                           {"run_step", "sensor", 1},
                                           {"drift", "linear", 1},
                                           {"drift", "saturating", 1},
                                           {"runout", "sun", 1},
                                           {"runout", "planet", 1},
                                           {"runout", "carrier", 1},
                                           {"mesh_order", "stage1", 1}};
  const Plan lost = lost_motion_plan();
  const std::vector<Alone> in_lost_motion{
      {"clearance", "", 1}, {"compliance", "", 1},   {"thermal_expansion", "", 1}, {"drift", "", 1},
      {"run_step", "", 1},  {"runout", "planet", 1}, {"mesh_order", "stage2", 1}};
  Plan pairs = pair_loss_plan();
  pairs.repeats = 6;
  const std::vector<Alone> in_pairs{{"friction_level", "", 1},
                                    {"friction_direction", "", 1},
                                    {"bearing_load", "", 1},
                                    {"sensor_gain", "", -1}};
  for (const double rms : {1.0, 0.3}) {
    const auto add = [&](const char* kind, const Plan& plan, const std::vector<Alone>& causes) {
      for (const Alone& c : causes) {
        list.push_back(
            {.name = fmt::format("alone {} {} {} {}", rms, kind, c.id, c.variant),
             .plan = plan,
             .causes = {{.id = c.id, .variant = c.variant, .rms_in_noise = c.sign * rms}}});
      }
    };
    add("transmission", transmission, in_transmission);
    add("lost_motion", lost, in_lost_motion);
    add("pair_loss", pairs, in_pairs);
  }
  const auto null = [&](const char* name, const std::function<void(Plan&)>& change) {
    for (const Plan& base : {transmission, lost, pairs}) {
      Plan plan = base;
      change(plan);
      const char* kind = base.kind == Kind::transmission  ? "transmission"
                         : base.kind == Kind::lost_motion ? "lost_motion"
                                                          : "pair_loss";
      list.push_back({.name = fmt::format("null {} {}", name, kind),
                      .plan = plan,
                      .causes = {},
                      .expectation = Expectation::kNothing});
    }
  };
  null("gaussian", [](Plan&) {});
  null("little noise", [](Plan& p) { p.relative_noise = 1e-4; });
  null("student", [](Plan& p) { p.noise = Noise::student; });
  null("proportional", [](Plan& p) { p.noise = Noise::proportional; });
  null("unequal repeats", [](Plan& p) { p.unequal_repeats = true; });
  null("sessions", [](Plan& p) {
    p.noise = Noise::session_offsets;
    p.sessions = 6;
  });
  null("loads by session", [](Plan& p) { p.load_by_session = true; });
  null("stated sigma", [](Plan& p) { p.sigma = true; });
  const auto several = [&](const char* group, const Plan& plan,
                           const std::vector<std::vector<const char*>>& sets) {
    for (const auto& set : sets) {
      Scenario s{.name = group, .plan = plan, .causes = {}};
      for (const char* id : set) {
        s.name += fmt::format(" {}", id);
        s.causes.push_back({.id = id, .rms_in_noise = 1.0});
      }
      list.push_back(std::move(s));
    }
  };
  several("pair", transmission,
          {{"drag_constant", "friction_speed"},
           {"friction_level", "drag_viscous"},
           {"run_step", "friction_load"},
           {"sensor_offset", "drag_constant"},
           {"runout", "drag_viscous"},
           {"drift", "friction_level"},
           {"sensor_gain", "drag_quadratic"}});
  several("pair", lost, {{"clearance", "compliance"}, {"runout", "thermal_expansion"}});
  several("triple", transmission,
          {{"friction_level", "drag_constant", "sensor_offset"},
           {"run_step", "drag_viscous", "runout"},
           {"friction_speed", "drag_constant", "drift"}});
  several("triple", lost, {{"clearance", "compliance", "runout"}});
  for (const char* id : {"odd_order", "resonance", "rotation_load", "time_oscillation", "corner"}) {
    list.push_back({.name = fmt::format("outside {}", id),
                    .plan = transmission,
                    .causes = {{.id = id, .rms_in_noise = 1.0}},
                    .expectation = Expectation::kUnexplained});
  }
  const auto alias = [&](const char* name, const char* id, const std::vector<std::string>& all,
                         const std::function<void(Plan&)>& change) {
    Scenario s{.name = fmt::format("alias {} {}", name, id),
               .plan = transmission,
               .causes = {{.id = id,
                           .variant = std::string_view(id) == "friction_direction" ? "drive" : "",
                           .rms_in_noise = 1.0}},
               .expectation = Expectation::kAliases,
               .aliases = all};
    change(s.plan);
    list.push_back(std::move(s));
  };
  const auto one_rotation = [](Plan& p) { p.both_rotations = false; };
  alias("one rotation", "drag_constant", {"drag_constant", "sensor_offset"}, one_rotation);
  alias("one rotation", "sensor_offset", {"drag_constant", "sensor_offset"}, one_rotation);
  const auto one_speed = [](Plan& p) {
    p.sun_speeds_rpm = {600.0};
    p.repeats = 15;
  };
  for (const char* id : {"drag_constant", "drag_viscous", "drag_quadratic"}) {
    alias("one speed", id, {"drag_constant", "drag_viscous", "drag_quadratic"}, one_speed);
  }
  const auto forward_only = [](Plan& p) {
    p.backward = false;
    p.repeats = 6;
  };
  for (const char* id : {"friction_level", "bearing_load", "sensor_gain"}) {
    alias("forward only", id,
          {"friction_level", "bearing_load", "friction_direction", "sensor_gain"}, forward_only);
  }
  const auto resolved = [&](const char* name, const char* id, const std::vector<std::string>& all,
                            const std::function<void(Plan&)>& change) {
    alias(name, id, all, change);
    list.back().name = fmt::format("resolved {} {}", name, id);
    list.back().expectation = Expectation::kResolved;
  };
  for (const char* id : {"drag_constant", "sensor_offset"}) {
    resolved("one rotation", id, {"drag_constant", "sensor_offset"}, one_rotation);
  }
  for (const char* id : {"drag_constant", "drag_viscous", "drag_quadratic"}) {
    resolved("one speed", id, {"drag_constant", "drag_viscous", "drag_quadratic"}, one_speed);
  }
  resolved("forward only", "sensor_gain", {"friction_level", "friction_direction", "sensor_gain"},
           forward_only);
  resolved("both directions", "sensor_gain", {"friction_direction", "sensor_gain"}, [](Plan&) {});
  resolved("both directions", "friction_direction", {"friction_direction", "sensor_gain"},
           [](Plan&) {});
  alias("both directions", "sensor_gain", {"sensor_gain", "friction_direction"}, [](Plan&) {});
  alias("both directions", "friction_direction", {"sensor_gain", "friction_direction"},
        [](Plan&) {});
  alias("both directions", "bearing_load", {"bearing_load", "friction_level"}, [](Plan&) {});
  return list;
}

}  // namespace gear3k::rig
