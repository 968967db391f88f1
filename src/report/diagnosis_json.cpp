#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "io/text/json.hpp"
#include "report/condition_columns.hpp"
#include "report/diagnosis_report.hpp"
#include "report/display.hpp"
#include "report/series_report.hpp"

namespace gear3k::report {

namespace {

using calibrate::Alternative, calibrate::CovariateTest, calibrate::Diagnosis, calibrate::Effect,
    calibrate::Form, calibrate::MeasurementSet, calibrate::NextExperiment,
    calibrate::ParameterResult, calibrate::Verdict;

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

/// null for what is 0 where it is not known.
io::Json positive_or_null(double value) { return value > 0.0 ? io::Json(value) : nullptr; }

io::Json text_or_null(const std::string& text) { return text.empty() ? nullptr : io::Json(text); }

io::Json parameter_json(const ParameterResult& p) {
  return {{"name", p.name},           {"unit", p.unit},
          {"value", p.value},         {"ci95", {p.low, p.high}},
          {"plausible", p.plausible}, {"plausible_range", {p.plausible_low, p.plausible_high}},
          {"at_bound", p.at_bound},   {"derived", p.derived}};
}

io::Json form_json(const Form& form, const std::vector<std::string>& runs) {
  return {
      {"name", form.name},
      {"constants", list_json(form.constants, [&](const auto& constant) {
         io::Json json{{"name", constant.name}, {"unit", constant.unit}, {"value", constant.value}};
         const auto run = static_cast<std::size_t>(constant.value);
         if (constant.name == "first_run" && run < runs.size()) {
           json["run"] = runs[run];
         }
         return json;
       })}};
}

/// Body and order, where a form has them.
void add_place(io::Json& json, const Form& form) {
  if (!form.body.empty()) json["body"] = form.body;
  if (form.order > 0.0) json["order"] = form.order;
}

io::Json body_json(const Alternative& a, const std::vector<std::string>& runs) {
  io::Json json{{"id", a.id}};
  add_place(json, a.form);
  json["title"] = a.title;
  json["with_level"] = a.with_level;
  json["statistic"] = a.statistic;
  json["form"] = form_json(a.form, runs);
  json["parameters"] = list_json(a.parameters, parameter_json);
  json["remedy"] = kRemedyNames[static_cast<std::size_t>(a.remedy)];
  return json;
}

io::Json lack_json(const calibrate::LackOfFit& lack) {
  if (lack.degrees <= 0 || lack.pure_degrees <= 0) return nullptr;
  return {{"f", lack.f}, {"p_value", lack.p_value}, {"degrees", {lack.degrees, lack.pure_degrees}}};
}

io::Json alternative_json(const Alternative& a, const std::vector<std::string>& runs) {
  io::Json json = body_json(a, runs);
  json["probability"] = a.probability;
  return json;
}

std::vector<std::string> ids_of(const std::vector<Alternative>& alternatives) {
  std::vector<std::string> ids;
  for (const Alternative& a : alternatives) {
    if (std::ranges::find(ids, a.id) == ids.end()) ids.push_back(a.id);
  }
  return ids;
}

io::Json effect_json(const Effect& e, const std::vector<std::string>& runs) {
  io::Json json{{"id", e.id}};
  add_place(json, e.form);
  json["alternatives"] = ids_of(e.alternatives);
  json["parameters"] = list_json(e.parameters, parameter_json);
  json["evidence"] = {{"delta_bic", e.delta_bic},
                      {"inclusion_frequency", e.inclusion_frequency},
                      {"p_value", e.p_value},
                      {"probability", e.probability},
                      {"probability_of_no_cause", e.no_cause}};
  json["title"] = e.title;
  json["form"] = form_json(e.form, runs);
  json["other_bodies"] =
      list_json(e.other_bodies, [&](const Alternative& a) { return body_json(a, runs); });
  json["remedy"] = kRemedyNames[static_cast<std::size_t>(e.remedy)];
  json["preferred_parameter"] = e.preferred_parameter;
  json["alternatives_detail"] =
      list_json(e.alternatives, [&](const Alternative& a) { return alternative_json(a, runs); });
  return json;
}

io::Json law_json(const calibrate::LawResult& law, calibrate::Kind kind) {
  return {{"name", law.name},
          {"formula", law.formula},
          {"acts_on", law.acts_on},
          {"rows", law.rows},
          {"unit", law.unit},
          {"parameters", list_json(law.parameters,
                                   [](const ParameterResult& p) {
                                     return io::Json{{"name", p.name},
                                                     {"unit", p.unit},
                                                     {"value", p.value},
                                                     {"ci95", {p.low, p.high}},
                                                     {"at_bound", p.at_bound}};
                                   })},
          {"held_out_gain", law.held_out_gain},
          {"held_out_error", law.held_out_error / response_text(kind).si},
          {"delta_bic", law.delta_bic},
          {"forms_tried", law.forms},
          {"range", list_json(law.range, [](const calibrate::ConditionRange& r) {
             return io::Json{{"name", r.name}, {"unit", r.unit}, {"low", r.low}, {"high", r.high}};
           })}};
}

io::Json covariate_json(const CovariateTest& test) {
  return {{"name", test.name},
          {"statistic", test.statistic},
          {"degrees", test.degrees},
          {"p_value", test.p_value}};
}

/// A condition by the columns of DATA.csv; what does not matter is left out.
io::Json condition_json(const calibrate::ProposedCondition& proposed, calibrate::Kind kind) {
  io::Json json = io::Json::object();
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

io::Json next_json(const std::optional<NextExperiment>& next, calibrate::Kind kind) {
  if (!next) return nullptr;
  return {{"separates", next->separates},
          {"conditions",
           list_json(next->conditions, [&](const auto& c) { return condition_json(c, kind); })},
          {"expected_statistic", next->expected_statistic},
          {"inseparable", next->inseparable},
          {"advice", next->advice}};
}

double gain_of(const Diagnosis& d) {
  return 1.0 - d.errors.extended_holdout / d.errors.baseline_holdout;
}

io::Json remainder_json(const Diagnosis& d) {
  const auto& r = d.remainder;
  const double si = response_text(d.kind).si;
  const auto scaled = [&](const std::vector<double>& values) {
    return list_json(values, [&](double value) { return value / si; });
  };
  return {{"significant", r.significant},
          {"along", text_or_null(r.along)},
          {"p_value", r.p_value},
          {"order", positive_or_null(r.order)},
          {"share", r.share},
          {"shape",
           {{"at", r.at}, {"mean", scaled(r.mean)}, {"term", scaled(r.term)}, {"rows", r.rows}}}};
}

io::Json rmse_json(const Diagnosis& d) {
  const ResponseText response = response_text(d.kind);
  const auto in_unit = [&](double value) { return value / response.si; };
  return {{"baseline_train", in_unit(d.errors.baseline_train)},
          {"extended_train", in_unit(d.errors.extended_train)},
          {"baseline_holdout", in_unit(d.errors.baseline_holdout)},
          {"extended_holdout", in_unit(d.errors.extended_holdout)},
          {"noise_floor", in_unit(d.errors.noise_floor)},
          {"unit", response.unit}};
}

io::Json extrapolation_json(const Diagnosis& d) {
  const auto& e = d.extrapolation;
  if (e.along.empty()) return nullptr;
  const double si = response_text(d.kind).si;
  return {{"along", e.along},
          {"left_out", e.left_out},
          {"rows", e.rows},
          {"baseline", e.baseline / si},
          {"extended", e.extended / si}};
}

/// Parameters that explain the data with values that no gearbox shows.
io::Json implausible_json(const Diagnosis& d) {
  io::Json list = io::Json::array();
  for (const Effect& effect : d.effects) {
    for (const ParameterResult& p : effect.parameters) {
      if (p.plausible) continue;
      io::Json json{{"id", effect.id}};
      json.update(parameter_json(p));
      list.push_back(std::move(json));
    }
  }
  return list;
}

void add_stiffness(io::Json& json, const std::string& flank,
                   const std::optional<calibrate::FlankStiffness>& stiffness) {
  const std::string key = "stiffness_" + flank;
  json[key + "_nm_per_rad"] = stiffness ? io::Json(stiffness->stiffness_Nm_rad) : nullptr;
  json[key + "_sd_nm_per_rad"] =
      stiffness ? positive_or_null(stiffness->standard_deviation_Nm_rad) : nullptr;
}

/// A loop of a torque-angle record, and what it has in common with the others of its session.
io::Json loop_json(const calibrate::SessionLoop& one, const calibrate::LoopSession& session,
                   const MeasurementSet& set) {
  const auto file = static_cast<std::size_t>(session.file);
  const calibrate::Loop& loop = one.loop;
  const bool at_zero = loop.outcome == calibrate::LoopOutcome::kMeasured;
  const double sd_rad = at_zero ? loop.lost_motion_sd_rad : 0.0;
  io::Json json{
      {"file", file < set.files.size() ? set.files[file] : ""},
      {"run", text_or_null(session.run)},
      {"loop", one.number},
      {"measured_at", session.sun_locked ? "output" : "sun"},
      {"lost_motion_arcmin", at_zero ? io::Json(arcmin(loop.lost_motion_rad)) : io::Json(nullptr)},
      {"lost_motion_sd_arcmin", positive_or_null(arcmin(sd_rad))}};
  add_stiffness(json, "positive", loop.stiffness_positive);
  add_stiffness(json, "negative", loop.stiffness_negative);
  json["asymmetry"] = loop.asymmetry;
  json["filter_cutoff_hz"] = positive_or_null(session.cutoff_Hz);
  const calibrate::Creep creep =
      session.creep.value_or(calibrate::Creep{.rad_s = calibrate::kUnknown});
  json["creep_arcmin_per_s"] = arcmin(creep.rad_s);
  json["creep_sd_arcmin_per_s"] = positive_or_null(arcmin(creep.standard_deviation_rad_s));
  return json;
}

io::Json loops_json(const MeasurementSet& set) {
  io::Json list = io::Json::array();
  for (const calibrate::LoopSession& session : set.loops) {
    for (const calibrate::SessionLoop& one : session.loops) {
      list.push_back(loop_json(one, session, set));
    }
  }
  return list;
}

io::Json correction_json(const Diagnosis& d, const std::vector<std::string>& runs) {
  if (!d.correction) return nullptr;
  const calibrate::Correction& c = *d.correction;
  io::Json json{{"id", c.id}};
  add_place(json, c.form);
  json["form"] = form_json(c.form, runs);
  json["parameters"] = list_json(c.parameters, parameter_json);
  json["held_out_gain"] = c.held_out_gain;
  json["held_out_error"] = c.held_out_error / response_text(d.kind).si;
  return json;
}

io::Json memory_json(const calibrate::MemoryEstimate& m) {
  if (!(m.memory.share > 0.0)) return nullptr;
  return {{"correlation", m.memory.correlation()},
          {"ci95", {m.low, m.high}},
          {"share", m.memory.share},
          {"decay", m.memory.decay},
          {"p_value", m.p_value}};
}

io::Json refit_json(const Diagnosis& d) {
  if (!d.refit) return nullptr;
  const double si = response_text(d.kind).si;
  return {{"id", d.refit->id},
          {"held_out_error", d.refit->refit_error / si},
          {"found_held_out_error", d.refit->found_error / si},
          {"predicts", d.refit->predicts}};
}

io::Json outlier_rows_json(const Diagnosis& d, const MeasurementSet& set) {
  io::Json rows = io::Json::array();
  for (std::size_t k = 0; k < d.rows.size() && k < set.rows.size(); ++k) {
    if (!d.rows[k].outlier) continue;
    const auto file = static_cast<std::size_t>(set.rows[k].file);
    rows.push_back({{"file", file < set.files.size() ? io::Json(set.files[file]) : nullptr},
                    {"line", set.rows[k].line},
                    {"left_out", !std::isfinite(d.rows[k].extended)}});
  }
  return rows;
}

/// Everything about one kind.
io::Json kind_json(const Diagnosis& d, const MeasurementSet& set) {
  const double si = response_text(d.kind).si;
  io::Json json{{"kind", kind_name(d.kind)}, {"verdict", verdict_name(d.verdict)}};
  json["effects"] =
      list_json(d.effects, [&](const Effect& effect) { return effect_json(effect, d.runs); });
  json["physically_implausible"] = implausible_json(d);
  json["correction"] = correction_json(d, d.runs);
  json["best_refit"] = refit_json(d);
  json["laws"] =
      list_json(d.laws, [&](const calibrate::LawResult& law) { return law_json(law, d.kind); });
  json["rmse"] = rmse_json(d);
  json["gain"] = gain_of(d);
  json["weighted_gain"] = d.errors.weighted_gain;
  json["remainder"] = remainder_json(d);
  json["next_experiment"] = next_json(d.next_experiment, d.kind);
  json["data"] = {{"files", set.files},
                  {"rows", set.rows.size()},
                  {"sessions", set.runs.size()},
                  {"fingerprint", fmt::format("fnv1a64:{:016x}", set.fingerprint)},
                  {"noise",
                   {{"source", kNoiseNames[static_cast<std::size_t>(d.noise_source)]},
                    {"stated", d.stated_noise / si},
                    {"repeat_degrees", d.repeat_degrees},
                    {"session_deviation", d.session_deviation / si},
                    {"memory", memory_json(d.memory)}}}};
  json["loops"] = loops_json(set);
  json["p_value"] = d.p_value;
  json["lack_of_fit"] = lack_json(d.lack_of_fit);
  json["lack_of_fit_of_extended"] = lack_json(d.lack_of_model);
  json["holdout_blocks"] = text_or_null(d.holdout_blocks);
  json["extrapolation"] = extrapolation_json(d);
  json["candidates"] = list_json(d.evidence, [](const auto& c) {
    return io::Json{{"id", c.id}, {"delta_bic", c.delta_bic}, {"evidence", c.evidence}};
  });
  json["covariates"] = {{"before", list_json(d.covariates_before, covariate_json)},
                        {"after", list_json(d.covariates_after, covariate_json)}};
  json["conditions_by_session"] = d.conditions_by_session;
  json["outliers"] = std::ranges::count_if(d.rows, [](const auto& row) { return row.outlier; });
  json["outlier_rows"] = outlier_rows_json(d, set);
  if (d.springs_Nm_rad) json["springs_nm_per_rad"] = *d.springs_Nm_rad;
  json["notes"] = d.notes;
  json["series"] = unit_series_json(d);
  return json;
}

/// A list of every kind, one after the other, each item with its kind.
io::Json all_of_kinds(const std::vector<io::Json>& kinds, const char* list) {
  io::Json all = io::Json::array();
  for (const io::Json& kind : kinds) {
    for (io::Json item : kind.at(list).items()) {
      item["kind"] = kind.at("kind");
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

io::Json diagnosis_json(const std::vector<Diagnosis>& diagnoses,
                        const std::vector<MeasurementSet>& sets, const DiagnosisSetup& setup) {
  require_matching(diagnoses, sets);
  io::Json json{{"tool", tool_json()}, {"subject", diagnoses.front().subject}};
  json["seed"] = setup.seed;
  json["false_discovery_rate"] = setup.false_discovery_rate;
  if (setup.model) json["model"] = model_json(*setup.model);
  std::vector<io::Json> kinds;
  kinds.reserve(sets.size());
  for (std::size_t k = 0; k < sets.size(); ++k) kinds.push_back(kind_json(diagnoses[k], sets[k]));
  json.update(kinds.front());
  if (kinds.size() > 1) {
    json["verdict"] = verdict_name(worst_verdict(diagnoses));
    for (const char* list : {"effects", "physically_implausible", "laws", "loops"}) {
      json[list] = all_of_kinds(kinds, list);
    }
    const auto next = std::ranges::find_if(
        kinds, [](const io::Json& one) { return !one.at("next_experiment").is_null(); });
    if (next != kinds.end()) {
      json["next_experiment"] = next->at("next_experiment");
      json["next_experiment"]["kind"] = next->at("kind");
    }
    json["kinds"] = kinds;
  }
  return json;
}

}  // namespace gear3k::report
