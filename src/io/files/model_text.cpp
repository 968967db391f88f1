// Writing of MODEL files.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "io/files/model_file.hpp"
#include "io/files/model_file_keys.hpp"
#include "io/files/model_laws.hpp"
#include "io/text/toml_text.hpp"

namespace gear3k::io {

namespace {

using calibrate::AppliedCause, calibrate::Cause, calibrate::ConditionRange,
    calibrate::ExtendedModel, calibrate::kKindNames;

void require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument("model_text: " + message);
}

/// Names of a model's causes as tables: the id, of a repeated one the id with its count.
std::vector<std::string> labels_of(const ExtendedModel& model) {
  std::vector<std::string> labels;
  labels.reserve(model.causes.size());
  for (std::size_t k = 0; k < model.causes.size(); ++k) {
    const std::string& id = model.causes[k].id;
    long count = 1;
    for (std::size_t before = 0; before < k; ++before) {
      if (model.causes[before].id == id) ++count;
    }
    labels.push_back(count == 1 ? id : fmt::format("{}_{}", id, count));
  }
  return labels;
}

std::string numbers_text(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", toml_number(number));
  }
  return "[" + text + "]";
}

std::string texts_text(const std::vector<std::string>& texts) {
  std::string text;
  for (const std::string& one : texts) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", toml_quoted(one));
  }
  return "[" + text + "]";
}

std::string range_text(const ExtendedModel& model, std::string_view kind) {
  if (model.range.empty()) return "";
  std::string text =
      fmt::format("\n# range of the data; [] = they do not state it\n[{}.range]\n", kind);
  for (const ConditionRange& range : model.range) {
    const auto* known = std::ranges::find_if(
        calibrate::kConditionQuantities, [&](const calibrate::ConditionQuantity& quantity) {
          return quantity.name == range.name && quantity.unit == range.unit;
        });
    require(known != calibrate::kConditionQuantities.end(),
            fmt::format("range {} {}: allowed: a column of measurements", range.name, range.unit));
    const bool stated = std::isfinite(range.low) && std::isfinite(range.high);
    text += fmt::format("{} = {}\n", known->column,
                        stated ? numbers_text({range.low, range.high}) : "[]");
  }
  return text;
}

std::string covariance_text(const ExtendedModel& model, std::string_view kind,
                            const std::vector<std::string>& names) {
  if (model.covariance.empty()) return "";
  const std::size_t count = names.size();
  std::string text = fmt::format("\n[{}.covariance]\nparameters = {}\nmatrix = [  # row by row\n",
                                 kind, texts_text(names));
  for (std::size_t i = 0; i < count; ++i) {
    text += "  ";
    for (std::size_t j = 0; j < count; ++j) {
      text += fmt::format("{}{}", toml_number(model.covariance[i * count + j]),
                          j + 1 == count ? ",\n" : ", ");
    }
  }
  return text + "]\n";
}

/// A law's table; the names of its parameters go behind those before it.
/// @param total  parameters of the model
std::string law_text(const ExtendedModel& model, std::string_view kind, std::size_t k,
                     std::size_t total, std::vector<std::string>& names) {
  const calibrate::AppliedLaw& applied = model.laws[k];
  const calibrate::Law& law = applied.law;
  const std::string label = k == 0 ? "law" : fmt::format("law_{}", k + 1);
  const auto parameters = parameters_of(law, model.kind);
  require(
      parameters.size() == applied.value.size(),
      fmt::format("a law has {} parameters, allowed: {}", applied.value.size(), parameters.size()));
  std::string text = fmt::format(
      "\n# law, no cause: {}\n[{}.laws.{}]\nacts_on = {}\nrows = {}\n",
      law_formula(law, applied.value, model.kind), kind, label,
      toml_quoted(std::string(calibrate::kLawActionNames[static_cast<std::size_t>(law.action)])),
      toml_quoted(std::string(calibrate::kLawRowsNames[static_cast<std::size_t>(law.rows)])));
  for (std::size_t f = 0; f < law.factors.size(); ++f) {
    const calibrate::LawFactor& factor = law.factors[f];
    require(std::isfinite(factor.origin) && std::isfinite(factor.constant) &&
                factor.reference > 0.0 && std::isfinite(factor.reference),
            "a constant of a law is not finite, or its reference not above 0");
    text +=
        fmt::format("{} = {}\n{} = {}\n", law_key("shape", f),
                    toml_quoted(std::string(record_of(factor.shape).name)), law_key("condition", f),
                    toml_quoted(std::string(calibrate::law_conditions()[factor.condition].name)));
    if (factor.origin != 0.0) {
      text +=
          fmt::format("{} = {}\n", law_unit_key("origin", factor, f), toml_number(factor.origin));
    }
    text += fmt::format("{} = {}\n", law_unit_key("reference", factor, f),
                        toml_number(factor.reference));
    if (!record_of(factor.shape).constant.empty()) {
      text += fmt::format("{} = {}\n", law_constant_key(factor, f), toml_number(factor.constant));
    }
    for (const auto& [name, x] :
         {std::pair{"least", factor.least}, std::pair{"greatest", factor.greatest}}) {
      if (!std::isfinite(x)) continue;
      text += fmt::format("{} = {}\n", law_unit_key(name, factor, f), toml_number(x));
    }
    if (std::isfinite(applied.left_behind[f])) {
      text +=
          fmt::format("{} = {}\n", law_key("left_behind", f), toml_number(applied.left_behind[f]));
    }
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    require(std::isfinite(applied.value[i]), "a law is not finite");
    const std::string key = key_of(parameters[i]);
    text += fmt::format("{} = {}\n", key, toml_number(applied.value[i]));
    if (!model.covariance.empty()) {
      const double variance = model.covariance[names.size() * (total + 1)];
      text += fmt::format("{}{} = {}\n", key, kDeviation, toml_number(std::sqrt(variance)));
    }
    names.push_back(fmt::format("{}.{}", label, key));
  }
  return text;
}

std::string one_model_text(const ExtendedModel& model) {
  const std::string_view kind = kKindNames[static_cast<std::size_t>(model.kind)];
  std::string text = fmt::format(
      "\n[{}]\nname = {}\ndata_fingerprint = \"{}{:016x}\"\ndata_files = {}\n", kind,
      toml_quoted(model.name), kFingerprint, model.fingerprint, texts_text(model.files));
  if (model.verdict) {
    text += fmt::format("verdict = \"{}\"\n",
                        calibrate::kVerdictNames[static_cast<std::size_t>(*model.verdict)]);
  }
  if (model.beyond_springs) text += fmt::format("{} = true\n", kBeyondSprings);
  text += range_text(model, kind);
  if (model.causes.empty()) text += fmt::format("\n[{}.causes]\n", kind);
  const std::vector<std::string> labels = labels_of(model);
  std::vector<std::string> names;
  const std::size_t total = calibrate::parameter_count(model);
  require(model.covariance.empty() || model.covariance.size() == total * total,
          fmt::format("covariance of {} numbers, allowed: {} (none, or {} parameters squared)",
                      model.covariance.size(), total * total, total));
  require(std::ranges::all_of(model.covariance, [](double c) { return std::isfinite(c); }),
          "covariance is not finite");
  names.reserve(total);
  for (std::size_t k = 0; k < model.causes.size(); ++k) {
    const AppliedCause& applied = model.causes[k];
    const Cause* cause = calibrate::find_cause(applied.id);
    require(cause != nullptr, fmt::format("there is no cause {}", applied.id));
    const auto parameters = cause->parameters(applied.form, model.kind);
    require(parameters.size() == applied.value.size(),
            fmt::format("{} has {} parameters, allowed: {}", applied.id, applied.value.size(),
                        parameters.size()));
    text += fmt::format("\n# {}\n[{}.causes.{}]\nform = {}\n", cause->title, kind, labels[k],
                        toml_quoted(applied.form.name));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      require(std::isfinite(applied.value[i]), fmt::format("{} is not finite", applied.id));
      const std::string key = key_of(parameters[i]);
      text += fmt::format("{} = {}\n", key, toml_number(applied.value[i]));
      if (!model.covariance.empty()) {
        const double variance = model.covariance[names.size() * (total + 1)];
        text += fmt::format("{}{} = {}\n", key, kDeviation, toml_number(std::sqrt(variance)));
      }
      names.push_back(fmt::format("{}.{}", labels[k], key));
    }
    for (const calibrate::FormConstant& constant : applied.form.constants) {
      require(std::isfinite(constant.value), fmt::format("{} is not finite", constant.name));
      text += fmt::format("{} = {}\n", key_of(constant), toml_number(constant.value));
    }
    if (!applied.form.body.empty()) {
      text += fmt::format("body = {}\n", toml_quoted(applied.form.body));
    }
    if (applied.form.order != 0.0) {
      text += fmt::format("order = {}\n", toml_number(applied.form.order));
    }
    if (!applied.alternatives.empty()) {
      text += fmt::format("{} = {}\n", kAlternatives, texts_text(applied.alternatives));
    }
    if (!applied.implausible.empty()) {
      text += fmt::format("{} = {}\n", kImplausible, texts_text(applied.implausible));
    }
    if (applied.empirical) text += fmt::format("{} = true\n", kEmpirical);
    if (std::isfinite(applied.left_behind)) {
      text += fmt::format("{} = {}\n", kLeftBehind, toml_number(applied.left_behind));
      if (!applied.left_behind_on.empty()) {
        text += fmt::format("{} = {}\n", kLeftBehindOn, toml_quoted(applied.left_behind_on));
      }
    }
  }
  for (std::size_t k = 0; k < model.laws.size(); ++k) {
    text += law_text(model, kind, k, total, names);
  }
  return text + covariance_text(model, kind, names);
}

}  // namespace

std::string model_text(const std::vector<ExtendedModel>& models) {
  std::string text = "# Extended model, written by gear3k diagnose; read by --model.\n";
  for (std::size_t k = 0; k < models.size(); ++k) {
    for (std::size_t other = 0; other < k; ++other) {
      require(
          models[k].kind != models[other].kind,
          fmt::format("two models of {}", kKindNames[static_cast<std::size_t>(models[k].kind)]));
    }
    text += one_model_text(models[k]);
  }
  return text;
}

}  // namespace gear3k::io
