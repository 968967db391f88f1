#include "report/model_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "calibrate/model_range.hpp"
#include "report/display.hpp"

namespace gear3k::report {

namespace {

using calibrate::AppliedCause, calibrate::ExtendedModel;
using nlohmann::ordered_json;

/// Standard deviation of a model's n-th parameter; empty without covariance.
std::optional<double> deviation_of(const ExtendedModel& model, std::size_t n) {
  std::size_t count = 0;
  for (const AppliedCause& cause : model.causes) count += cause.value.size();
  if (model.covariance.size() != count * count) return std::nullopt;
  return std::sqrt(model.covariance[n * (count + 1)]);
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

}  // namespace

std::vector<std::string> cause_lines(const ModelUse& use) {
  std::vector<std::string> lines;
  for_each_cause(use, [&](const ExtendedModel& model, const AppliedCause& applied,
                          const calibrate::Cause& cause, std::size_t place) {
    std::string text = fmt::format("{} ({}, {}", cause.title, cause.id, applied.form.name);
    if (!applied.form.body.empty() && applied.form.body != applied.form.name) {
      text += ", " + applied.form.body;
    }
    if (applied.form.order != 0.0) text += fmt::format(", order {:.5g}", applied.form.order);
    text += "):";
    const auto parameters = cause.parameters(applied.form, model.kind);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      std::string name(parameters[i].name);
      for (char& c : name) {
        if (c == '_') c = ' ';
      }
      text += fmt::format("{} {} {:.5g}", i == 0 ? "" : ",", name, applied.value[i]);
      if (!parameters[i].unit.empty()) text += fmt::format(" {}", parameters[i].unit);
      if (const auto sd = deviation_of(model, place + i)) text += fmt::format(", sd {:.2g}", *sd);
    }
    if (!calibrate::changes_gearbox(applied, model.kind)) {
      text += "; of the measurement, no part of this result";
    }
    lines.push_back(text);
  });
  return lines;
}

std::string model_paragraph(const ModelUse& use) {
  std::string text = fmt::format("\nWith the model {}\n", use.file);
  for (const std::string& line : cause_lines(use)) text += fmt::format("  {}\n", line);
  return text;
}

void add_model(ordered_json& json, const ModelUse& use) {
  ordered_json causes = ordered_json::array();
  for_each_cause(use, [&](const ExtendedModel& model, const AppliedCause& applied,
                          const calibrate::Cause& cause, std::size_t place) {
    ordered_json one{{"id", cause.id},
                     {"kind", calibrate::kKindNames[static_cast<std::size_t>(model.kind)]},
                     {"form", applied.form.name}};
    if (!applied.form.body.empty()) one["body"] = applied.form.body;
    if (applied.form.order != 0.0) one["order"] = applied.form.order;
    ordered_json parameters = ordered_json::array();
    const auto records = cause.parameters(applied.form, model.kind);
    for (std::size_t i = 0; i < records.size(); ++i) {
      parameters.push_back({{"name", records[i].name},
                            {"unit", records[i].unit},
                            {"value", applied.value[i]},
                            {"sd", number_or_null(deviation_of(model, place + i))}});
    }
    one["parameters"] = std::move(parameters);
    one["changes_gearbox"] = calibrate::changes_gearbox(applied, model.kind);
    causes.push_back(std::move(one));
  });
  json["model"] = {{"file", use.file}, {"causes", std::move(causes)}};
  if (use.lost_motion_shift_rad != 0.0) {
    json["model"]["lost_motion_limits_lowered_arcmin"] = arcmin(use.lost_motion_shift_rad);
  }
}

}  // namespace gear3k::report
