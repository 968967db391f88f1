#include "report/model_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/model/model_range.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "io/text/json.hpp"
#include "io/text/printable.hpp"
#include "report/display.hpp"

namespace gear3k::report {

namespace {

using calibrate::AppliedCause, calibrate::ExtendedModel;

/// Standard deviation of a model's n-th parameter; empty without covariance.
std::optional<double> deviation_of(const ExtendedModel& model, std::size_t n) {
  const std::size_t count = calibrate::parameter_count(model);
  if (model.covariance.size() != count * count) return std::nullopt;
  return std::sqrt(model.covariance[n * (count + 1)]);
}

std::string spaced(std::string_view name) {
  std::string text(name);
  std::ranges::replace(text, '_', ' ');
  return text;
}

/// Calls visit(model, cause, record, first parameter's place) for every cause.
template <class Visit>
void for_each_cause(const ModelUse& use, Visit visit) {
  for (const ExtendedModel& model : use.models) {
    std::size_t place = 0;
    for (const AppliedCause& applied : model.causes) {
      const calibrate::Cause* cause = calibrate::find_cause(applied.id);
      if (cause != nullptr) visit(model, applied, *cause, place);
      place += applied.value.size();
    }
  }
}

/// "load-independent drag (drag_constant, sun): torque 0.021 Nm, sd 0.0003"
std::string cause_text(const ExtendedModel& model, const AppliedCause& applied,
                       const calibrate::Cause& cause, std::size_t place) {
  std::string text = fmt::format("{} ({}, {}", cause.title, cause.id, applied.form.name);
  if (!applied.form.body.empty() && applied.form.body != applied.form.name) {
    text += ", " + applied.form.body;
  }
  if (applied.form.order != 0.0) text += fmt::format(", order {:.5g}", applied.form.order);
  text += "):";
  const auto parameters = cause.parameters(applied.form, model.kind);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    text += fmt::format("{} {} {:.5g}", i == 0 ? "" : ",", spaced(parameters[i].name),
                        applied.value[i]);
    if (!parameters[i].unit.empty()) text += fmt::format(" {}", parameters[i].unit);
    if (const auto sd = deviation_of(model, place + i)) text += fmt::format(", sd {:.2g}", *sd);
  }
  return text;
}

/// "law, no cause: loss = 0.012 Nm * (sun_speed/3000 rpm)^1.02"
std::string law_text(const ExtendedModel& model, const calibrate::AppliedLaw& law) {
  return "law, no cause: " + law_formula(law.law, law.value, model.kind);
}

std::string kind_name(const ExtendedModel& model) {
  return std::string(calibrate::kKindNames[static_cast<std::size_t>(model.kind)]);
}

std::string fingerprint_text(const ExtendedModel& model) {
  return fmt::format("fnv1a64:{:016x}", model.fingerprint);
}

/// What the diagnosis of a model left open; "" where nothing, or where it is not known.
std::string verdict_caution(const ExtendedModel& model) {
  using calibrate::Verdict;
  if (model.verdict != Verdict::kAmbiguous && model.verdict != Verdict::kUnexplained) return "";
  const bool ambiguous = model.verdict == Verdict::kAmbiguous;
  std::string text = fmt::format(
      "the diagnosis of {} was {}", kind_name(model),
      ambiguous ? "ambiguous" : "unexplained: something is left that no cause explains");
  const char* separator = ambiguous ? ": " : "; ";
  for (const AppliedCause& applied : model.causes) {
    if (applied.alternatives.empty()) continue;
    text += fmt::format("{}{} could as well be {}", separator, applied.id,
                        fmt::join(applied.alternatives, " or "));
    separator = "; ";
  }
  return text;
}

/// Parameters of a cause that no gearbox shows.
std::vector<std::string> implausible_parameters(const AppliedCause& applied,
                                                const calibrate::Cause& cause,
                                                calibrate::Kind kind) {
  std::vector<std::string> lines;
  const auto records = cause.parameters(applied.form, kind);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const auto& record = records[i];
    const double value = applied.value[i];
    if (value >= record.plausible_low && value <= record.plausible_high) continue;
    lines.push_back(fmt::format("{} {:.4g}{}{} is outside the plausible {:.4g} to {:.4g}",
                                spaced(record.name), clean(value), record.unit.empty() ? "" : " ",
                                record.unit, record.plausible_low, record.plausible_high));
  }
  // Those that follow from the parameters are known by their names only.
  for (const std::string& name : applied.implausible) {
    if (std::ranges::find(records, name, &calibrate::ParameterRecord::name) == records.end()) {
      lines.push_back(fmt::format("{} is outside what is plausible", spaced(name)));
    }
  }
  return lines;
}

}  // namespace

std::vector<std::string> cautions(const ModelUse& use) {
  std::vector<std::string> lines;
  for (const ExtendedModel& model : use.models) {
    const std::string verdict = verdict_caution(model);
    if (!verdict.empty()) lines.push_back(fmt::format("{}: {}", use.file, verdict));
  }
  for_each_cause(use, [&](const ExtendedModel& model, const AppliedCause& applied,
                          const calibrate::Cause& cause, std::size_t /*place*/) {
    if (applied.empirical) {
      lines.push_back(fmt::format("{}: {} is an empirical correction: it explains nothing",
                                  use.file, cause.id));
    }
    for (const std::string& line : implausible_parameters(applied, cause, model.kind)) {
      lines.push_back(fmt::format("{}: {}: {}: distrust", use.file, cause.id, line));
    }
  });
  return lines;
}

std::string diagnosed_model_paragraph(const ModelUse& use) {
  std::string text = fmt::format("With the model {}\n", use.file);
  for (const ExtendedModel& model : use.models) {
    text += fmt::format("  {}, measured on \"{}\" ({}; {})\n", kind_name(model),
                        io::printable(model.name),
                        model.files.empty() ? std::string("files not stated")
                                            : fmt::format("{}", fmt::join(model.files, ", ")),
                        fingerprint_text(model));
    if (model.causes.empty()) text += "    no causes\n";
    const ModelUse one{.file = use.file, .models = {model}};
    for_each_cause(one, [&](const ExtendedModel& m, const AppliedCause& applied,
                            const calibrate::Cause& cause, std::size_t place) {
      std::string when;
      if (cause.leave_behind != nullptr && std::isfinite(applied.left_behind)) {
        when = fmt::format("; later expected to change {} by {:.4g}, as what goes on is not known",
                           applied.left_behind_on.empty() ? "the response" : applied.left_behind_on,
                           clean(applied.left_behind));
      } else if (cause.leave_behind != nullptr) {
        when = "; as that campaign left it";
      }
      text += fmt::format("    {}{}\n", cause_text(m, applied, cause, place), when);
    });
    for (const calibrate::AppliedLaw& law : model.laws) {
      const bool lasts = is_of_campaign(law.law);
      text += fmt::format("    {}{}\n", law_text(model, law),
                          !lasts                ? ""
                          : as_left_behind(law) ? "; as that campaign left it"
                                                : "; of its campaign, no part of this result");
    }
  }
  return text;
}

std::vector<std::string> cause_lines(const ModelUse& use) {
  std::vector<std::string> lines;
  for_each_cause(use, [&](const ExtendedModel& model, const AppliedCause& applied,
                          const calibrate::Cause& cause, std::size_t place) {
    lines.push_back(cause_text(model, applied, cause, place));
    if (!calibrate::changes_gearbox(applied, model.kind)) {
      lines.back() += "; of the measurement, no part of this result";
    }
  });
  for (const ExtendedModel& model : use.models) {
    for (const calibrate::AppliedLaw& law : model.laws) {
      lines.push_back(law_text(model, law) + "; of the readings, no part of this result");
    }
  }
  return lines;
}

std::string model_paragraph(const ModelUse& use) {
  std::string text = fmt::format("\nWith the model {}\n", use.file);
  for (const std::string& line : cause_lines(use)) text += fmt::format("  {}\n", line);
  return text;
}

io::Json model_json(const ModelUse& use) {
  io::Json causes = io::Json::array();
  for_each_cause(use, [&](const ExtendedModel& model, const AppliedCause& applied,
                          const calibrate::Cause& cause, std::size_t place) {
    io::Json one{{"id", cause.id}, {"kind", kind_name(model)}, {"form", applied.form.name}};
    if (!applied.form.body.empty()) one["body"] = applied.form.body;
    if (applied.form.order != 0.0) one["order"] = applied.form.order;
    io::Json parameters = io::Json::array();
    const auto records = cause.parameters(applied.form, model.kind);
    for (std::size_t i = 0; i < records.size(); ++i) {
      parameters.push_back({{"name", records[i].name},
                            {"unit", records[i].unit},
                            {"value", applied.value[i]},
                            {"sd", deviation_of(model, place + i)}});
    }
    one["parameters"] = std::move(parameters);
    one["changes_gearbox"] = calibrate::changes_gearbox(applied, model.kind);
    causes.push_back(std::move(one));
  });
  io::Json laws = io::Json::array();
  for (const ExtendedModel& model : use.models) {
    std::size_t place = 0;
    for (const AppliedCause& cause : model.causes) place += cause.value.size();
    for (const calibrate::AppliedLaw& law : model.laws) {
      io::Json parameters = io::Json::array();
      const auto records = parameters_of(law.law, model.kind);
      for (std::size_t i = 0; i < records.size(); ++i, ++place) {
        parameters.push_back({{"name", records[i].name},
                              {"unit", records[i].unit},
                              {"value", law.value[i]},
                              {"sd", deviation_of(model, place)}});
      }
      laws.push_back({{"name", "law: " + law_title(law.law)},
                      {"kind", kind_name(model)},
                      {"formula", law_formula(law.law, law.value, model.kind)},
                      {"parameters", std::move(parameters)},
                      {"changes_gearbox", false}});
    }
  }
  io::Json data = io::Json::array();
  for (const ExtendedModel& model : use.models) {
    data.push_back(
        {{"kind", kind_name(model)},
         {"name", model.name},
         {"data_files", model.files},
         {"data_fingerprint", fingerprint_text(model)},
         {"verdict",
          model.verdict
              ? io::Json(calibrate::kVerdictNames[static_cast<std::size_t>(*model.verdict)])
              : nullptr}});
  }
  io::Json json{{"file", use.file},
                {"causes", std::move(causes)},
                {"laws", std::move(laws)},
                {"data", std::move(data)}};
  if (use.lost_motion_shift_rad != 0.0) {
    json["lost_motion_limits_lowered_arcmin"] = arcmin(use.lost_motion_shift_rad);
  }
  return json;
}

}  // namespace gear3k::report
