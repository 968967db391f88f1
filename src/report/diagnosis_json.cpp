#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "report/condition_columns.hpp"
#include "report/diagnosis_report.hpp"
#include "report/display.hpp"

namespace gear3k::report {

namespace {

using calibrate::Alternative, calibrate::CovariateTest, calibrate::Diagnosis, calibrate::Effect,
    calibrate::Form, calibrate::MeasurementSet, calibrate::NextExperiment,
    calibrate::ParameterResult, calibrate::Verdict;
using nlohmann::ordered_json;

constexpr std::array<const char*, 3> kNoiseNames{"stated", "repeats", "residuals"};
constexpr std::array<const char*, 10> kRemedyNames{
    "friction_value", "flanks",   "drag",      "bearings",  "sensor",
    "procedure",      "accuracy", "clearance", "stiffness", "housing"};

std::string kind_name(calibrate::Kind kind) {
  return std::string(calibrate::kKindNames[static_cast<std::size_t>(kind)]);
}
std::string verdict_name(Verdict verdict) {
  return std::string(calibrate::kVerdictNames[static_cast<std::size_t>(verdict)]);
}

ordered_json finite(double value) { return number_or_null(value); }

template <class Items, class ToJson>
ordered_json list_of(const Items& items, ToJson to_json) {
  ordered_json list = ordered_json::array();
  for (const auto& item : items) list.push_back(to_json(item));
  return list;
}

ordered_json text_or_null(const std::string& text) {
  return text.empty() ? ordered_json(nullptr) : ordered_json(text);
}

ordered_json parameter_json(const ParameterResult& p) {
  return {{"name", p.name},
          {"unit", p.unit},
          {"value", finite(p.value)},
          {"ci95", {finite(p.low), finite(p.high)}},
          {"plausible", p.plausible},
          {"plausible_range", {finite(p.plausible_low), finite(p.plausible_high)}},
          {"at_bound", p.at_bound},
          {"derived", p.derived}};
}

ordered_json form_json(const Form& form, const std::vector<std::string>& runs) {
  return {{"name", form.name}, {"constants", list_of(form.constants, [&](const auto& constant) {
                                  ordered_json json{{"name", constant.name},
                                                    {"unit", constant.unit},
                                                    {"value", finite(constant.value)}};
                                  const auto run = static_cast<std::size_t>(constant.value);
                                  if (constant.name == "first_run" && run < runs.size()) {
                                    json["run"] = runs[run];
                                  }
                                  return json;
                                })}};
}

/// Body and order, where a form has them.
void add_place(ordered_json& json, const Form& form) {
  if (!form.body.empty()) json["body"] = form.body;
  if (form.order > 0.0) json["order"] = finite(form.order);
}

ordered_json alternative_json(const Alternative& a, const std::vector<std::string>& runs) {
  ordered_json json{{"id", a.id}};
  add_place(json, a.form);
  json["title"] = a.title;
  json["with_level"] = a.with_level;
  json["statistic"] = finite(a.statistic);
  json["form"] = form_json(a.form, runs);
  json["parameters"] = list_of(a.parameters, parameter_json);
  json["remedy"] = kRemedyNames[static_cast<std::size_t>(a.remedy)];
  return json;
}

std::vector<std::string> ids_of(const std::vector<Alternative>& alternatives) {
  std::vector<std::string> ids;
  for (const Alternative& a : alternatives) {
    if (std::ranges::find(ids, a.id) == ids.end()) ids.push_back(a.id);
  }
  return ids;
}

ordered_json effect_json(const Effect& e, const std::vector<std::string>& runs) {
  ordered_json json{{"id", e.id}};
  add_place(json, e.form);
  json["alternatives"] = ids_of(e.alternatives);
  json["parameters"] = list_of(e.parameters, parameter_json);
  json["evidence"] = {{"delta_bic", finite(e.delta_bic)},
                      {"inclusion_frequency", finite(e.inclusion_frequency)},
                      {"p_value", finite(e.p_value)}};
  json["title"] = e.title;
  json["form"] = form_json(e.form, runs);
  json["other_bodies"] =
      list_of(e.other_bodies, [&](const Alternative& a) { return alternative_json(a, runs); });
  json["remedy"] = kRemedyNames[static_cast<std::size_t>(e.remedy)];
  json["preferred_parameter"] = e.preferred_parameter;
  json["alternatives_detail"] =
      list_of(e.alternatives, [&](const Alternative& a) { return alternative_json(a, runs); });
  return json;
}

ordered_json covariate_json(const CovariateTest& test) {
  return {{"name", test.name},
          {"statistic", finite(test.statistic)},
          {"degrees", test.degrees},
          {"p_value", finite(test.p_value)}};
}

/// A condition by the columns of DATA.csv; what does not matter is left out.
ordered_json condition_json(const calibrate::ProposedCondition& proposed, calibrate::Kind kind) {
  ordered_json json = ordered_json::object();
  for (const ConditionColumn& column : condition_columns(kind)) {
    const double value = column.value(proposed.condition);
    if (column.name == "run" || column.name == "time_s" || !std::isfinite(value)) continue;
    if (column.name == "direction") {
      json["direction"] = condition_text(column, proposed.condition, {});
    } else if (column.name == "rotation" || column.unit.empty()) {
      json[std::string(column.name)] = std::lround(value);
    } else {
      json[std::string(column.name)] = value;
    }
  }
  if (proposed.condition.reference_sensor) json["sensor"] = "reference";
  json["repeats"] = proposed.repeats;
  return json;
}

ordered_json next_json(const std::optional<NextExperiment>& next, calibrate::Kind kind) {
  if (!next) return nullptr;
  return {{"separates", next->separates},
          {"conditions",
           list_of(next->conditions, [&](const auto& c) { return condition_json(c, kind); })},
          {"expected_statistic", finite(next->expected_statistic)},
          {"inseparable", next->inseparable},
          {"advice", next->advice}};
}

double gain_of(const Diagnosis& d) {
  return 1.0 - d.errors.extended_holdout / d.errors.baseline_holdout;
}

ordered_json remainder_json(const Diagnosis& d) {
  const auto numbers = [](const std::vector<double>& values) { return list_of(values, finite); };
  const auto& r = d.remainder;
  const double si = response_text(d.kind).si;
  const auto scaled = [&](const std::vector<double>& values) {
    return list_of(values, [&](double value) { return finite(value / si); });
  };
  return {{"significant", r.significant},
          {"along", text_or_null(r.along)},
          {"p_value", finite(r.p_value)},
          {"order", r.order > 0.0 ? finite(r.order) : ordered_json(nullptr)},
          {"share", finite(r.share)},
          {"shape",
           {{"at", numbers(r.at)},
            {"mean", scaled(r.mean)},
            {"term", scaled(r.term)},
            {"rows", r.rows}}}};
}

ordered_json rmse_json(const Diagnosis& d) {
  const ResponseText response = response_text(d.kind);
  const auto in_unit = [&](double value) { return finite(value / response.si); };
  return {{"baseline_train", in_unit(d.errors.baseline_train)},
          {"extended_train", in_unit(d.errors.extended_train)},
          {"baseline_holdout", in_unit(d.errors.baseline_holdout)},
          {"extended_holdout", in_unit(d.errors.extended_holdout)},
          {"noise_floor", in_unit(d.errors.noise_floor)},
          {"unit", response.unit}};
}

ordered_json extrapolation_json(const Diagnosis& d) {
  const auto& e = d.extrapolation;
  if (e.along.empty()) return nullptr;
  const double si = response_text(d.kind).si;
  return {{"along", e.along},
          {"left_out", finite(e.left_out)},
          {"rows", e.rows},
          {"baseline", finite(e.baseline / si)},
          {"extended", finite(e.extended / si)}};
}

/// Parameters that explain the data with values that no gearbox shows.
ordered_json implausible_json(const Diagnosis& d) {
  ordered_json list = ordered_json::array();
  for (const Effect& effect : d.effects) {
    for (const ParameterResult& p : effect.parameters) {
      if (p.plausible) continue;
      ordered_json json{{"id", effect.id}};
      json.update(parameter_json(p));
      list.push_back(std::move(json));
    }
  }
  return list;
}

/// null for what is 0 where it is not known.
ordered_json positive_or_null(double value) {
  return value > 0.0 ? finite(value) : ordered_json(nullptr);
}

void add_stiffness(ordered_json& json, const std::string& flank,
                   const std::optional<calibrate::FlankStiffness>& stiffness) {
  const std::string key = "stiffness_" + flank;
  json[key + "_nm_per_rad"] =
      stiffness ? finite(stiffness->stiffness_Nm_rad) : ordered_json(nullptr);
  json[key + "_sd_nm_per_rad"] =
      stiffness ? positive_or_null(stiffness->standard_deviation_Nm_rad) : ordered_json(nullptr);
}

/// A loop of a torque-angle record, and what it has in common with the others of its session.
ordered_json loop_json(const calibrate::SessionLoop& one, const calibrate::LoopSession& session,
                       const MeasurementSet& set) {
  const auto file = static_cast<std::size_t>(session.file);
  const calibrate::Loop& loop = one.loop;
  ordered_json json{{"file", file < set.files.size() ? set.files[file] : ""},
                    {"run", text_or_null(session.run)},
                    {"loop", one.number},
                    {"measured_at", session.sun_locked ? "output" : "sun"},
                    {"lost_motion_arcmin", finite(arcmin(loop.lost_motion_rad))},
                    {"lost_motion_sd_arcmin", positive_or_null(arcmin(loop.lost_motion_sd_rad))}};
  add_stiffness(json, "positive", loop.stiffness_positive);
  add_stiffness(json, "negative", loop.stiffness_negative);
  json["asymmetry"] = number_or_null(loop.asymmetry);
  json["filter_cutoff_hz"] = positive_or_null(session.cutoff_Hz);
  const calibrate::Creep creep =
      session.creep.value_or(calibrate::Creep{.rad_s = calibrate::kUnknown});
  json["creep_arcmin_per_s"] = finite(arcmin(creep.rad_s));
  json["creep_sd_arcmin_per_s"] = positive_or_null(arcmin(creep.standard_deviation_rad_s));
  return json;
}

ordered_json loops_json(const MeasurementSet& set) {
  ordered_json list = ordered_json::array();
  for (const calibrate::LoopSession& session : set.loops) {
    for (const calibrate::SessionLoop& one : session.loops) {
      list.push_back(loop_json(one, session, set));
    }
  }
  return list;
}

/// Everything about one kind.
ordered_json kind_json(const Diagnosis& d, const MeasurementSet& set) {
  const double si = response_text(d.kind).si;
  ordered_json json{{"kind", kind_name(d.kind)}, {"verdict", verdict_name(d.verdict)}};
  json["effects"] =
      list_of(d.effects, [&](const Effect& effect) { return effect_json(effect, set.runs); });
  json["physically_implausible"] = implausible_json(d);
  json["rmse"] = rmse_json(d);
  json["gain"] = finite(gain_of(d));
  json["weighted_gain"] = finite(d.errors.weighted_gain);
  json["remainder"] = remainder_json(d);
  json["next_experiment"] = next_json(d.next_experiment, d.kind);
  json["data"] = {{"files", set.files},
                  {"rows", set.rows.size()},
                  {"sessions", set.runs.size()},
                  {"fingerprint", fmt::format("fnv1a64:{:016x}", set.fingerprint)},
                  {"noise",
                   {{"source", kNoiseNames[static_cast<std::size_t>(d.noise_source)]},
                    {"repeat_degrees", d.repeat_degrees},
                    {"session_deviation", finite(d.session_deviation / si)}}}};
  json["loops"] = loops_json(set);
  json["p_value"] = finite(d.p_value);
  json["lack_of_fit"] =
      d.lack_of_fit.degrees > 0 && d.lack_of_fit.pure_degrees > 0
          ? ordered_json{{"f", finite(d.lack_of_fit.f)},
                         {"p_value", finite(d.lack_of_fit.p_value)},
                         {"degrees", {d.lack_of_fit.degrees, d.lack_of_fit.pure_degrees}}}
          : ordered_json(nullptr);
  json["holdout_blocks"] = text_or_null(d.holdout_blocks);
  json["extrapolation"] = extrapolation_json(d);
  json["candidates"] = list_of(d.evidence, [](const auto& c) {
    return ordered_json{
        {"id", c.id}, {"delta_bic", finite(c.delta_bic)}, {"evidence", finite(c.evidence)}};
  });
  json["covariates"] = {{"before", list_of(d.covariates_before, covariate_json)},
                        {"after", list_of(d.covariates_after, covariate_json)}};
  json["outliers"] = std::ranges::count_if(d.rows, [](const auto& row) { return row.outlier; });
  json["notes"] = d.notes;
  return json;
}

/// A list of every kind, one after the other, each item with its kind.
ordered_json all_of_kinds(const ordered_json& kinds, const char* list) {
  ordered_json all = ordered_json::array();
  for (const ordered_json& kind : kinds) {
    for (ordered_json item : kind[list]) {
      item["kind"] = kind["kind"];
      all.push_back(std::move(item));
    }
  }
  return all;
}

}  // namespace

void require_matching(const std::vector<Diagnosis>& diagnoses,
                      const std::vector<MeasurementSet>& sets) {
  if (diagnoses.empty() || diagnoses.size() != sets.size()) {
    throw std::invalid_argument(
        fmt::format("diagnosis report: {} results of {} sets of data, allowed: as many, and one "
                    "or more",
                    diagnoses.size(), sets.size()));
  }
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (diagnoses[k].rows.size() == sets[k].rows.size()) continue;
    throw std::invalid_argument(fmt::format("diagnosis report: {} results of {} rows of {} data",
                                            diagnoses[k].rows.size(), sets[k].rows.size(),
                                            kind_name(sets[k].kind)));
  }
}

Verdict worst_verdict(const std::vector<Diagnosis>& diagnoses) {
  Verdict worst = Verdict::kNoDiscrepancy;
  for (const Diagnosis& d : diagnoses) worst = std::max(worst, d.verdict);
  return worst;
}

std::string diagnosis_json(const std::vector<Diagnosis>& diagnoses,
                           const std::vector<MeasurementSet>& sets, const DiagnosisSetup& setup) {
  require_matching(diagnoses, sets);
  ordered_json json{{"tool", tool_json()}, {"subject", diagnoses.front().subject}};
  json["seed"] = setup.seed;
  json["false_discovery_rate"] = setup.false_discovery_rate;
  if (setup.model) add_model(json, *setup.model);
  ordered_json kinds = ordered_json::array();
  for (std::size_t k = 0; k < sets.size(); ++k) kinds.push_back(kind_json(diagnoses[k], sets[k]));
  json.update(kinds.front());
  if (kinds.size() > 1) {
    json["verdict"] = verdict_name(worst_verdict(diagnoses));
    for (const char* list : {"effects", "physically_implausible", "loops"}) {
      json[list] = all_of_kinds(kinds, list);
    }
    const auto next = std::ranges::find_if(
        kinds, [](const ordered_json& one) { return !one["next_experiment"].is_null(); });
    if (next != kinds.end()) {
      json["next_experiment"] = (*next)["next_experiment"];
      json["next_experiment"]["kind"] = (*next)["kind"];
    }
    json["kinds"] = kinds;
  }
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace gear3k::report
