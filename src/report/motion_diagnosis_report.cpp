#include "report/motion_diagnosis_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "io/text/json.hpp"
#include "io/text/printable.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

using calibrate::kDriveCauses, calibrate::MotionDiagnosis, calibrate::MotionEffect,
    calibrate::MotionEstimate, calibrate::MotionProposal, calibrate::MotionQuantity;
using io::Json;

constexpr std::array<const char*, 4> kMotionVerdicts{"no_discrepancy", "explained", "ambiguous",
                                                     "unexplained"};

/// Motor-side torques are told at the motor's shaft, damping and inertia too.
double shaft_scale(std::size_t cause, double ratio) {
  switch (cause) {
    case calibrate::kMotorCoulombChange:
      return 1.0 / std::abs(ratio);
    case calibrate::kMotorViscousChange:
    case calibrate::kMotorInertiaChange:
      return 1.0 / (ratio * ratio);
    case calibrate::kClearanceChange:
      return arcmin(1.0);
    default:
      return 1.0;
  }
}

double quantity_scale(const MotionQuantity& q, double ratio) {
  if (q.name == "backlash") return shaft_scale(calibrate::kClearanceChange, ratio);
  if (q.name == "motor_coulomb") return shaft_scale(calibrate::kMotorCoulombChange, ratio);
  if (q.name.starts_with("motor_")) return shaft_scale(calibrate::kMotorInertiaChange, ratio);
  return 1.0;
}

std::string cause_text(std::size_t cause) {
  const auto& c = kDriveCauses.at(cause);
  return c.body.empty() ? std::string(c.id) : fmt::format("{} ({})", c.id, c.body);
}

Json cause_json(std::size_t cause, const MotionEstimate& e, double ratio) {
  const auto& c = kDriveCauses.at(cause);
  const double scale = shaft_scale(cause, ratio);
  Json json{{"id", c.id}};
  if (!c.body.empty()) json["body"] = c.body;
  json["title"] = c.title;
  Json parameter{{"name", c.name}, {"unit", c.unit}, {"value", e.value * scale}};
  Json interval = Json::array();
  interval.push_back(e.low * scale);
  interval.push_back(e.high * scale);
  parameter["ci95"] = interval;
  Json parameters = Json::array();
  parameters.push_back(parameter);
  json["parameters"] = parameters;
  return json;
}

Json motion_effect_json(const MotionEffect& e, double ratio) {
  Json json = cause_json(e.cause, e.estimate, ratio);
  json["probability"] = e.probability;
  json["alternatives"] =
      list_json(e.alternatives, [](const auto& a) { return Json(kDriveCauses.at(a.cause).id); });
  json["alternatives_detail"] = list_json(e.alternatives, [&](const auto& a) {
    Json other = cause_json(a.cause, a.estimate, ratio);
    other["statistic"] = a.statistic;
    other["probability"] = a.probability;
    return other;
  });
  json["evidence"] = {{"delta_bic", e.delta_bic}, {"p_value", e.p_value}};
  return json;
}

Json motion_quantity_json(const MotionQuantity& q, double ratio) {
  const double scale = quantity_scale(q, ratio);
  Json json{{"name", q.name}, {"unit", q.unit}, {"stated", q.stated * scale}};
  json["value"] = q.found ? Json(q.found->value * scale) : Json(nullptr);
  if (q.found) {
    Json interval = Json::array();
    interval.push_back(q.found->low * scale);
    interval.push_back(q.found->high * scale);
    json["ci95"] = interval;
  } else {
    json["ci95"] = nullptr;
  }
  return json;
}

Json motion_proposal_json(const MotionProposal& p, std::size_t first, double ratio) {
  return {{"id", p.id},
          {"advice", p.advice},
          {"separates", list_json(p.separates, [](std::size_t c) { return Json(cause_text(c)); })},
          {"amplitude_rad_s", p.amplitude_rad_s},
          {"frequency_hz", p.frequency_Hz},
          {"duration_s", p.duration_s},
          {"load_nm", p.load_Nm},
          {"inertia_kgm2", p.inertia_kgm2},
          {"expected_statistic", p.expected_statistic},
          {"half_width", p.half_width * shaft_scale(first, ratio)}};
}

Json estimate_json(const MotionEstimate& e) {
  Json interval = Json::array();
  interval.push_back(e.low);
  interval.push_back(e.high);
  return {{"value", e.value}, {"ci95", interval}};
}

const char* flow_name(int flow) { return flow > 0 ? "forward" : "backward"; }

void add_readings(const calibrate::MotionReadings& r, Json& json) {
  json["run_downs"] = {
      {"records", list_json(r.run_downs,
                            [](const calibrate::RunDown& d) {
                              return Json{{"time_s", d.time_s},
                                          {"duration_s", d.duration_s},
                                          {"from_rad_s", d.from_rad_s},
                                          {"to_rad_s", d.to_rad_s}};
                            })},
      {"drag", list_json(r.drags, [](const calibrate::RunDownDrag& d) {
         return Json{
             {"flow", flow_name(d.flow)},
             {"windows", d.windows},
             {"constant_nm", estimate_json(d.constant_Nm)},
             {"viscous_nms_per_rad", d.viscous_Nms ? estimate_json(*d.viscous_Nms) : Json(nullptr)},
             {"stated_constant_nm", d.stated_constant_Nm},
             {"stated_viscous_nms_per_rad", d.stated_viscous_Nms}};
       })}};
  json["reversals"] = {{"of_sense", r.reversals}, {"of_flank", r.flank_changes}};
  json["ripple"] = {{"highest_order", r.highest_order},
                    {"waves", list_json(r.ripple, [](const calibrate::TorqueRipple& w) {
                       return Json{{"shaft", w.shaft},
                                   {"harmonic", w.harmonic},
                                   {"order", w.order},
                                   {"amplitude_nm", w.amplitude_Nm},
                                   {"p_value", w.p_value}};
                     })}};
}

std::string interval_text(const MotionEstimate& e, double scale) {
  return fmt::format("{:.4g} to {:.4g}", e.low * scale, e.high * scale);
}

std::string effects_text(const MotionDiagnosisResult& r) {
  TextTable table({"cause", "value", "95 %", "unit", "probability"});
  table.align_left(3);
  for (const MotionEffect& e : r.diagnosis.effects) {
    const auto add = [&](const std::string& name, std::size_t cause, const MotionEstimate& estimate,
                         double probability) {
      const double scale = shaft_scale(cause, r.ratio);
      table.add({name, fmt::format("{:.4g}", estimate.value * scale),
                 interval_text(estimate, scale), std::string(kDriveCauses.at(cause).unit),
                 fixed(probability, 2)});
    };
    add(cause_text(e.cause), e.cause, e.estimate, e.probability);
    for (const auto& a : e.alternatives) {
      add("  or " + cause_text(a.cause), a.cause, a.estimate, a.probability);
    }
  }
  return table.text(0);
}

/// What the causes predict of what they were not fitted to.
std::string gain_text(const MotionDiagnosis& d) {
  const calibrate::MotionHoldout& held = d.held_out;
  if (held.blocks.empty()) return "These logs are too few to hold some of them out.\n";
  return fmt::format(
      "held out (by {}): {:.4g} N m, {:.4g} as stated: on data that it has not seen the extended "
      "model is {} % {}.\n",
      held.blocks, held.extended_Nm, held.baseline_Nm, fixed(std::abs(percent(held.gain())), 0),
      held.gain() >= 0.0 ? "better" : "worse");
}

std::string quantities_text(const MotionDiagnosisResult& r) {
  TextTable table({"all of them free", "stated", "found", "95 %", "unit"});
  table.align_left(4);
  for (const MotionQuantity& q : r.diagnosis.quantities) {
    const double scale = quantity_scale(q, r.ratio);
    table.add({q.name, fmt::format("{:.4g}", q.stated * scale),
               q.found ? fmt::format("{:.4g}", q.found->value * scale) : "not known",
               q.found ? interval_text(*q.found, scale) : "", q.unit});
  }
  return table.text(0);
}

std::string readings_text(const calibrate::MotionReadings& r) {
  std::string text;
  for (const calibrate::RunDownDrag& d : r.drags) {
    text +=
        fmt::format("run-downs, flow {}: drag {:.4g} ({}) N m, stated {:.4g}", flow_name(d.flow),
                    d.constant_Nm.value, interval_text(d.constant_Nm, 1.0), d.stated_constant_Nm);
    if (d.viscous_Nms) {
      text += fmt::format("; {:.4g} ({}) N m s/rad, stated {:.4g}", d.viscous_Nms->value,
                          interval_text(*d.viscous_Nms, 1.0), d.stated_viscous_Nms);
    }
    text += '\n';
  }
  for (const calibrate::TorqueRipple& w : r.ripple) {
    text += fmt::format(
        "torque ripple: {:.4g} N m at the output, {} times a turn of the {} (order "
        "{:.4g})\n",
        w.amplitude_Nm, w.harmonic, w.shaft, w.order);
  }
  if (r.reversals > 0) {
    text += fmt::format("{} reversals, {} changes of flank\n", r.reversals, r.flank_changes);
  }
  return text.empty() ? text : '\n' + text;
}

}  // namespace

Json motion_diagnosis_json(const MotionDiagnosisResult& r) {
  const auto& d = r.diagnosis;
  Json json{{"tool", tool_json()},
            {"kind", "dynamic"},
            {"subject", r.subject},
            {"files", r.files},
            {"verdict", kMotionVerdicts.at(static_cast<std::size_t>(d.verdict))},
            {"windows", {{"forward", d.windows[0]}, {"backward", d.windows[1]}}},
            {"p_value", d.p_value},
            {"lack_of_fit_p_value", d.lack_of_fit}};
  json["effects"] =
      list_json(d.effects, [&](const auto& e) { return motion_effect_json(e, r.ratio); });
  json["quantities"] =
      list_json(d.quantities, [&](const auto& q) { return motion_quantity_json(q, r.ratio); });
  json["rmse"] = {{"baseline_train", d.baseline_Nm},
                  {"extended_train", d.extended_Nm},
                  {"baseline_holdout", d.held_out.baseline_Nm},
                  {"extended_holdout", d.held_out.extended_Nm},
                  {"noise_floor", d.noise_Nm},
                  {"unit", "Nm"}};
  json["gain"] = d.held_out.gain();
  json["holdout_blocks"] = d.held_out.blocks.empty() ? Json(nullptr) : Json(d.held_out.blocks);
  // Which condition it hangs on is not looked for.
  json["remainder"] = {
      {"significant", d.leaves_something()}, {"along", nullptr}, {"p_value", d.lack_of_fit}};
  json["noise_correlation"] = d.correlation;
  json["next_experiment"] =
      d.next ? motion_proposal_json(*d.next, d.effects.front().cause, r.ratio) : Json(nullptr);
  add_readings(r.readings, json);
  json["notes"] = d.notes;
  return json;
}

std::string motion_diagnosis_table(const MotionDiagnosisResult& r) {
  const auto& d = r.diagnosis;
  std::string text = fmt::format(
      "{}: {}\n{} windows forward, {} backward; of a window's mean torque at the output {:.4g} N m "
      "stay, {:.4g} as stated, {:.4g} is noise\n\n",
      r.subject.empty() ? "actuator" : io::printable(r.subject),
      kMotionVerdicts.at(static_cast<std::size_t>(d.verdict)), d.windows[0], d.windows[1],
      d.extended_Nm, d.baseline_Nm, d.noise_Nm);
  if (!d.effects.empty()) text += effects_text(r) + '\n' + gain_text(d) + '\n';
  text += quantities_text(r) + readings_text(r.readings);
  if (d.next) {
    text += fmt::format("\nnext experiment: {}\n", d.next->advice);
    if (d.next->half_width > 0.0) {
      const std::size_t first = d.effects.front().cause;
      text += fmt::format("{} would then be known to +-{:.2g} {}\n", cause_text(first),
                          d.next->half_width * shaft_scale(first, r.ratio),
                          kDriveCauses.at(first).unit);
    }
  }
  for (const std::string& note : d.notes) text += "\nnote: " + io::printable(note);
  if (!d.notes.empty()) text += '\n';
  return text;
}

std::string motion_window_csv(const MotionDiagnosisResult& r) {
  const auto& d = r.diagnosis;
  std::string text =
      "time_s,duration_s,flow,sense,acceleration_rad_s2,speed_rad_s,output_torque_nm,"
      "motor_torque_at_output_nm,baseline_residual_nm,extended_residual_nm,holdout_residual_nm\n";
  for (std::size_t k = 0; k < d.rows.size(); ++k) {
    const auto& w = d.rows[k];
    const double root = w.term[4];
    const std::vector<double>& held = d.held_out.residual;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", exact(w.time_s), exact(w.duration_s),
                        w.flow > 0 ? "forward" : "backward", w.sense, exact(w.term[0] / root),
                        exact(w.term[1] / root), exact(-w.term[3] / root), exact(w.motor_Nm / root),
                        exact(d.baseline[k]), exact(d.extended[k]),
                        std::isfinite(held[k]) ? exact(held[k]) : "");
  }
  return text;
}

}  // namespace gear3k::report
