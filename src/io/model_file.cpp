#include "io/model_file.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "calibrate/form_catalogue.hpp"
#include "io/toml_text.hpp"
#include "io/toml_value.hpp"

namespace gear3k::io {

namespace {

using calibrate::AppliedCause, calibrate::Cause, calibrate::CatalogueForm,
    calibrate::ConditionRange, calibrate::ExtendedModel, calibrate::file_key, calibrate::Kind,
    calibrate::kKindNames, calibrate::ParameterRecord;

constexpr std::string_view kFingerprint = "fnv1a64:";
constexpr std::string_view kDeviation = "_sd";
/// Relative differences up to this are roundings of what was written.
constexpr double kRounding = 1e-9;

/// Conditions whose range a model may state, as the columns of measurements.
struct RangeColumn {
  std::string_view name, unit;
};
constexpr std::array<RangeColumn, 12> kRangeColumns{{{"sun_speed", "rpm"},
                                                     {"output_torque", "nm"},
                                                     {"temperature", "c"},
                                                     {"output_angle", "deg"},
                                                     {"time", "s"},
                                                     {"cycles", ""},
                                                     {"test_torque", "nm"},
                                                     {"angle", "deg"},
                                                     {"torque", "nm"},
                                                     {"driving_teeth", ""},
                                                     {"driven_teeth", ""},
                                                     {"module", "mm"}}};

std::string key_of(const RangeColumn& column) { return file_key(column.name, column.unit); }
std::string key_of(const ParameterRecord& parameter) {
  return file_key(parameter.name, parameter.unit);
}

// --- writing

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
    const bool known = std::ranges::any_of(kRangeColumns, [&](const RangeColumn& column) {
      return column.name == range.name && column.unit == range.unit;
    });
    require(known,
            fmt::format("range {} {}: allowed: a column of measurements", range.name, range.unit));
    const bool stated = std::isfinite(range.low) && std::isfinite(range.high);
    text += fmt::format("{} = {}\n", file_key(range.name, range.unit),
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

std::string one_model_text(const ExtendedModel& model) {
  const std::string_view kind = kKindNames[static_cast<std::size_t>(model.kind)];
  std::string text = fmt::format(
      "\n[{}]\nname = {}\ndata_fingerprint = \"{}{:016x}\"\ndata_files = {}\n", kind,
      toml_quoted(model.name), kFingerprint, model.fingerprint, texts_text(model.files));
  text += range_text(model, kind);
  if (model.causes.empty()) text += fmt::format("\n[{}.causes]\n", kind);
  const std::vector<std::string> labels = labels_of(model);
  std::vector<std::string> names;
  std::size_t total = 0;
  for (const AppliedCause& applied : model.causes) total += applied.value.size();
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
      text += fmt::format("{} = {}\n", file_key(constant.name, constant.unit),
                          toml_number(constant.value));
    }
    if (!applied.form.body.empty()) {
      text += fmt::format("body = {}\n", toml_quoted(applied.form.body));
    }
    if (applied.form.order != 0.0) {
      text += fmt::format("order = {}\n", toml_number(applied.form.order));
    }
  }
  return text + covariance_text(model, kind, names);
}

// --- reading

/// Reads a document; every error is kept.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  std::vector<ExtendedModel> models(const TomlValue& document) {
    std::vector<ExtendedModel> result;
    result.reserve(document.table.size());
    const std::vector<std::string> kinds(kKindNames.begin(), kKindNames.end());
    for (const TomlValue& member : document.table) {
      if (std::ranges::find(kinds, member.key) == kinds.end()) {
        unknown(member, "table", member.key, kinds);
      } else if (is_table(member, member.key)) {
        result.push_back(model(member));
      }
    }
    if (document.table.empty()) {
      error({.line = 1, .column = 1},
            fmt::format("no model in the file: allowed: tables [{}]", fmt::join(kinds, "], [")));
    }
    // In the order of the kinds, whatever that of the file.
    std::ranges::stable_sort(result, {}, &ExtendedModel::kind);
    return result;
  }

  void throw_if_invalid() const {
    if (!diagnostics_.empty()) throw InvalidInput(format_diagnostics(file_, diagnostics_));
  }

 private:
  void error(Position position, const std::string& message) {
    diagnostics_.push_back({.position = position, .message = message});
  }

  void unknown(const TomlValue& at, std::string_view what, const std::string& word,
               const std::vector<std::string>& known) {
    const std::string hint = closest_word(word.substr(word.rfind('.') + 1), known);
    error(at.position, fmt::format("unknown {} {}{}; allowed: {}", what, word,
                                   hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                                   fmt::join(known, ", ")));
  }

  void refuse(const TomlValue& value, const std::string& path, const std::string& allowed) {
    error(value.position, fmt::format("{} = {}: allowed: {}", path, as_text(value), allowed));
  }

  bool is_table(const TomlValue& value, const std::string& path) {
    if (value.kind == TomlValue::Kind::kTable) return true;
    refuse(value, path, fmt::format("a table [{}]", path));
    return false;
  }

  std::string text(const TomlValue& value, const std::string& path) {
    if (value.kind != TomlValue::Kind::kText) refuse(value, path, "a text in quotes");
    return value.text;
  }

  /// A finite number; 0 and an error where it is none.
  double number(const TomlValue& value, const std::string& path) {
    if (value.is_number() && std::isfinite(value.number)) return value.number;
    refuse(value, path, "a number");
    return 0.0;
  }

  std::vector<std::string> texts(const TomlValue& value, const std::string& path) {
    std::vector<std::string> result;
    if (value.kind != TomlValue::Kind::kList) {
      refuse(value, path, "a list of texts");
      return result;
    }
    result.reserve(value.list.size());
    for (const TomlValue& element : value.list) result.push_back(text(element, path));
    return result;
  }

  ExtendedModel model(const TomlValue& table) {
    ExtendedModel m;
    m.kind = static_cast<Kind>(std::ranges::find(kKindNames, table.key) - kKindNames.begin());
    const TomlValue* causes = nullptr;
    const TomlValue* covariance = nullptr;
    for (const TomlValue& member : table.table) {
      const std::string path = table.key + "." + member.key;
      if (member.key == "name") {
        m.name = text(member, path);
      } else if (member.key == "data_fingerprint") {
        m.fingerprint = fingerprint(member, path);
      } else if (member.key == "data_files") {
        m.files = texts(member, path);
      } else if (member.key == "range") {
        if (is_table(member, path)) read_ranges(member, path, m);
      } else if (member.key == "causes") {
        causes = &member;
      } else if (member.key == "covariance") {
        covariance = &member;
      } else {
        unknown(member, "key", path,
                {"name", "data_fingerprint", "data_files", "range", "causes", "covariance"});
      }
    }
    names_.clear();
    deviations_.clear();
    const std::size_t before = diagnostics_.size();
    if (causes == nullptr) {
      error(table.position, fmt::format("{0}.causes is missing: allowed: a table [{0}.causes.ID] "
                                        "for each cause, or an empty [{0}.causes]",
                                        table.key));
    } else if (is_table(*causes, table.key + ".causes")) {
      m.causes.reserve(causes->table.size());
      for (const TomlValue& cause : causes->table) {
        read_cause(cause, fmt::format("{}.causes.{}", table.key, cause.key), m);
      }
    }
    // Of causes that are not understood no covariance can be.
    if (diagnostics_.size() == before) read_covariance(covariance, table.key + ".covariance", m);
    return m;
  }

  std::uint64_t fingerprint(const TomlValue& value, const std::string& path) {
    std::uint64_t result = 0;
    const std::string& word = value.text;
    const bool begins = value.kind == TomlValue::Kind::kText && word.starts_with(kFingerprint);
    const char* first = word.data() + (begins ? kFingerprint.size() : 0);
    const char* last = word.data() + word.size();
    constexpr int kHexadecimal = 16;
    const auto read = std::from_chars(first, last, result, kHexadecimal);
    if (begins && last - first == kHexadecimal && read.ec == std::errc() && read.ptr == last) {
      return result;
    }
    refuse(value, path, fmt::format("\"{}\" and 16 hexadecimal digits", kFingerprint));
    return 0;
  }

  void read_ranges(const TomlValue& table, const std::string& path, ExtendedModel& m) {
    m.range.reserve(table.table.size());
    for (const TomlValue& member : table.table) {
      const auto column = std::ranges::find_if(
          kRangeColumns, [&](const RangeColumn& c) { return key_of(c) == member.key; });
      const std::string key = path + "." + member.key;
      if (column == kRangeColumns.end()) {
        std::vector<std::string> known;
        known.reserve(kRangeColumns.size());
        for (const RangeColumn& c : kRangeColumns) known.push_back(key_of(c));
        unknown(member, "range", key, known);
        continue;
      }
      ConditionRange range{.name = std::string(column->name),
                           .unit = std::string(column->unit),
                           .low = calibrate::kUnknown,
                           .high = calibrate::kUnknown};
      const bool list = member.kind == TomlValue::Kind::kList;
      if (list && member.list.size() == 2 && member.list[0].is_number() &&
          member.list[1].is_number() && member.list[0].number <= member.list[1].number &&
          std::isfinite(member.list[0].number) && std::isfinite(member.list[1].number)) {
        range.low = member.list[0].number;
        range.high = member.list[1].number;
      } else if (!list || !member.list.empty()) {
        refuse(member, key, "[low, high], two numbers, low <= high; [] = not stated");
      }
      m.range.push_back(range);
    }
  }

  /// The cause of a table: its name is an id, or an id and a count from 2 on.
  const Cause* cause_named(const TomlValue& table, const std::string& path) {
    std::string id = table.key;
    const auto end = id.find_last_not_of("0123456789");
    if (end != std::string::npos && end + 1 < id.size() && id[end] == '_' && id[end + 1] > '0' &&
        id.substr(end + 1) != "1") {
      id.resize(end);
    }
    const Cause* cause = calibrate::find_cause(id);
    if (cause != nullptr) return cause;
    std::vector<std::string> known;
    known.reserve(calibrate::causes().size());
    for (const Cause* c : calibrate::causes()) known.emplace_back(c->id);
    const std::string hint = closest_word(id, known);
    error(table.position, fmt::format("unknown cause {}{}; allowed: {}", path,
                                      hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                                      fmt::join(known, ", ")));
    return nullptr;
  }

  void read_cause(const TomlValue& table, const std::string& path, ExtendedModel& m) {
    const Cause* cause = cause_named(table, path);
    if (cause == nullptr || !is_table(table, path)) return;
    const std::vector<CatalogueForm> catalogue = calibrate::form_catalogue(*cause, m.kind);
    if (catalogue.empty()) {
      error(table.position, fmt::format("{}: {} data cannot show this cause", path,
                                        kKindNames[static_cast<std::size_t>(m.kind)]));
      return;
    }
    const auto member = [&](std::string_view key) -> const TomlValue* {
      const auto found = std::ranges::find(table.table, key, &TomlValue::key);
      return found == table.table.end() ? nullptr : &*found;
    };
    std::vector<std::string> forms;
    forms.reserve(catalogue.size());
    for (const CatalogueForm& form : catalogue) forms.push_back(form.name);
    const TomlValue* form_value = member("form");
    if (form_value == nullptr) {
      error(table.position,
            fmt::format("{}.form is missing: allowed: \"{}\"", path, fmt::join(forms, "\" or \"")));
      return;
    }
    const std::string form_name = text(*form_value, path + ".form");
    const auto form = std::ranges::find(catalogue, form_name, &CatalogueForm::name);
    if (form == catalogue.end()) {
      if (form_value->kind == TomlValue::Kind::kText) {
        const std::string hint = closest_word(form_name, forms);
        refuse(*form_value, path + ".form",
               fmt::format("\"{}\"{}", fmt::join(forms, "\" or \""),
                           hint.empty() ? "" : fmt::format("; did you mean \"{}\"?", hint)));
      }
      return;
    }
    AppliedCause applied{.id = std::string(cause->id), .form = {}, .value = {}};
    applied.form.name = form_name;
    std::vector<std::string> known{"form"};
    const auto parameters = cause->parameters(applied.form, m.kind);
    applied.value.reserve(parameters.size());
    for (const ParameterRecord& parameter : parameters) {
      const std::string key = key_of(parameter);
      known.push_back(key);
      known.push_back(key + std::string(kDeviation));
      const std::string allowed =
          fmt::format("a number{}{}, {} to {}", parameter.unit.empty() ? "" : " in ",
                      parameter.unit, parameter.lower, parameter.upper);
      const TomlValue* value = member(key);
      double x = 0.0;
      if (value == nullptr) {
        error(table.position, fmt::format("{}.{} is missing: allowed: {}", path, key, allowed));
      } else if (!(value->is_number() && value->number >= parameter.lower &&
                   value->number <= parameter.upper)) {
        refuse(*value, fmt::format("{}.{}", path, key), allowed);
      } else {
        x = value->number;
      }
      applied.value.push_back(x);
      names_.push_back(fmt::format("{}.{}", table.key, key));
      read_deviation(member(key + std::string(kDeviation)),
                     fmt::format("{}.{}{}", path, key, kDeviation));
    }
    read_constants(table, path, *form, applied.form, known);
    for (const TomlValue& value : table.table) {
      if (std::ranges::find(known, value.key) == known.end()) {
        unknown(value, "key", fmt::format("{}.{}", path, value.key), known);
      }
    }
    m.causes.push_back(applied);
  }

  void read_deviation(const TomlValue* value, const std::string& path) {
    Deviation deviation;
    if (value != nullptr) {
      deviation.position = value->position;
      if (value->is_number() && value->number >= 0.0 && std::isfinite(value->number)) {
        deviation.value = value->number;
        deviation.stated = true;
      } else {
        refuse(*value, path, "a number, at least 0");
      }
    }
    deviations_.push_back(deviation);
  }

  /// Constants, body and order of a form; each constant of the form's name is stated in one of its
  /// units.
  void read_constants(const TomlValue& table, const std::string& path, const CatalogueForm& known,
                      calibrate::Form& form, std::vector<std::string>& keys) {
    std::vector<std::string> constant_keys;
    constant_keys.reserve(known.constants.size());
    for (const calibrate::FormConstant& constant : known.constants) {
      constant_keys.push_back(file_key(constant.name, constant.unit));
      keys.push_back(constant_keys.back());
    }
    for (const TomlValue& value : table.table) {
      const auto at = std::ranges::find(constant_keys, value.key);
      if (at == constant_keys.end()) continue;
      calibrate::FormConstant constant =
          known.constants[static_cast<std::size_t>(at - constant_keys.begin())];
      constant.value = number(value, fmt::format("{}.{}", path, value.key));
      // What forces, speeds and times are divided by.
      const bool scale = constant.name.ends_with("load") || constant.name.ends_with("speed") ||
                         constant.name == "speed_scale" || constant.name == "time_constant";
      if (scale && value.is_number() && !(constant.value > 0.0)) {
        refuse(value, fmt::format("{}.{}", path, value.key), "a number above 0");
      }
      form.constants.push_back(constant);
    }
    if (!known.bodies.empty()) {
      keys.emplace_back("body");
      const auto body = std::ranges::find(table.table, "body", &TomlValue::key);
      if (body != table.table.end()) {
        form.body = text(*body, path + ".body");
        if (body->kind == TomlValue::Kind::kText &&
            std::ranges::find(known.bodies, form.body) == known.bodies.end()) {
          refuse(*body, path + ".body", fmt::format("\"{}\"", fmt::join(known.bodies, "\" or \"")));
        }
      }
    }
    if (known.has_order) {
      keys.emplace_back("order");
      const auto order = std::ranges::find(table.table, "order", &TomlValue::key);
      if (order == table.table.end()) {
        error(table.position,
              fmt::format("{}.order is missing: allowed: a number above 0, per output revolution",
                          path));
      } else if (!(order->is_number() && order->number > 0.0 && std::isfinite(order->number))) {
        refuse(*order, path + ".order", "a number above 0, per output revolution");
      } else {
        form.order = order->number;
      }
    }
    require_constants(table, path, known, form);
  }

  /// Every form needs all its constants; where a name is known in several units, or stands for
  /// another one, one of them.
  void require_constants(const TomlValue& table, const std::string& path,
                         const CatalogueForm& known, const calibrate::Form& form) {
    if (known.sets.empty()) return;
    const auto holds = [&](const std::vector<calibrate::FormConstant>& set) {
      return set.size() == form.constants.size() &&
             std::ranges::all_of(set, [&](const calibrate::FormConstant& wanted) {
               return std::ranges::any_of(form.constants, [&](const calibrate::FormConstant& c) {
                 return c.name == wanted.name && c.unit == wanted.unit;
               });
             });
    };
    if (std::ranges::any_of(known.sets, holds)) return;
    std::vector<std::string> choices;
    choices.reserve(known.sets.size());
    for (const auto& set : known.sets) {
      std::vector<std::string> keys;
      keys.reserve(set.size());
      for (const calibrate::FormConstant& c : set) keys.push_back(file_key(c.name, c.unit));
      choices.push_back(fmt::format("{}", fmt::join(keys, " and ")));
    }
    error(table.position,
          fmt::format("{}: form \"{}\" needs {}", path, form.name, fmt::join(choices, ", or ")));
  }

  void read_covariance(const TomlValue* table, const std::string& path, ExtendedModel& m) {
    const std::size_t count = names_.size();
    if (table == nullptr) {
      const auto stated = std::ranges::count_if(deviations_, &Deviation::stated);
      if (stated == 0) return;
      // Without a covariance the parameters are taken as independent.
      m.covariance.assign(count * count, 0.0);
      for (std::size_t i = 0; i < count; ++i) {
        m.covariance[i * (count + 1)] = deviations_[i].value * deviations_[i].value;
      }
      return;
    }
    if (!is_table(*table, path)) return;
    const TomlValue* parameters = nullptr;
    const TomlValue* matrix = nullptr;
    for (const TomlValue& member : table->table) {
      if (member.key == "parameters") {
        parameters = &member;
      } else if (member.key == "matrix") {
        matrix = &member;
      } else {
        unknown(member, "key", path + "." + member.key, {"parameters", "matrix"});
      }
    }
    if (parameters == nullptr || matrix == nullptr) {
      error(table->position,
            fmt::format("{}.{} is missing", path, parameters == nullptr ? "parameters" : "matrix"));
      return;
    }
    const auto order = parameter_order(*parameters, path + ".parameters");
    if (!order) return;
    if (matrix->kind != TomlValue::Kind::kList || matrix->list.size() != count * count) {
      error(matrix->position,
            fmt::format("{}.matrix = {}: allowed: {} numbers, {} by {}, row by row", path,
                        matrix->kind == TomlValue::Kind::kList
                            ? fmt::format("{} elements", matrix->list.size())
                            : as_text(*matrix),
                        count * count, count, count));
      return;
    }
    m.covariance.assign(count * count, 0.0);
    const std::size_t before = diagnostics_.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        m.covariance[(*order)[i] * count + (*order)[j]] =
            number(matrix->list[i * count + j], path + ".matrix");
      }
    }
    if (diagnostics_.size() == before) check_covariance(*matrix, path + ".matrix", m.covariance);
  }

  /// Places of the named parameters among those of the causes; empty where they are not the same.
  std::optional<std::vector<std::size_t>> parameter_order(const TomlValue& value,
                                                          const std::string& path) {
    const std::size_t before = diagnostics_.size();
    const std::vector<std::string> written = texts(value, path);
    if (diagnostics_.size() != before) return std::nullopt;
    std::vector<std::size_t> order;
    order.reserve(written.size());
    std::vector<bool> seen(names_.size(), false);
    for (std::size_t k = 0; k < written.size(); ++k) {
      const auto at = std::ranges::find(names_, written[k]);
      if (at == names_.end()) {
        const std::string hint = closest_word(written[k], names_);
        error(value.list[k].position,
              fmt::format("{}: unknown parameter \"{}\"{}; allowed: {}", path, written[k],
                          hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                          fmt::join(names_, ", ")));
        continue;
      }
      const auto place = static_cast<std::size_t>(at - names_.begin());
      if (seen[place]) {
        error(value.list[k].position, fmt::format("{}: \"{}\" stands twice", path, written[k]));
      }
      seen[place] = true;
      order.push_back(place);
    }
    for (std::size_t k = 0; k < names_.size(); ++k) {
      if (!seen[k]) {
        error(value.position, fmt::format("{}: {} is missing", path, names_[k]));
      }
    }
    if (diagnostics_.size() != before) return std::nullopt;
    return order;
  }

  /// Symmetric, positive semidefinite, and with the standard deviations that the causes state.
  void check_covariance(const TomlValue& at, const std::string& path,
                        const std::vector<double>& c) {
    const std::size_t count = names_.size();
    std::vector<double> sd(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double variance = c[i * (count + 1)];
      if (variance < 0.0) {
        error(at.position, fmt::format("{}: variance of {} = {}: allowed: at least 0", path,
                                       names_[i], variance));
        return;
      }
      sd[i] = std::sqrt(variance);
      constexpr double kPrinted = 1e-6;
      if (deviations_[i].stated &&
          !(std::abs(deviations_[i].value - sd[i]) <= kPrinted * std::max(sd[i], 1e-300))) {
        error(deviations_[i].position,
              fmt::format("{}{} = {}: allowed: {}, the square root of its variance in {}",
                          names_[i], kDeviation, deviations_[i].value, sd[i], path));
      }
    }
    Eigen::MatrixXd correlation(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        const double one = c[i * count + j];
        const double other = c[j * count + i];
        if (i < j && std::abs(one - other) > kRounding * sd[i] * sd[j]) {
          error(at.position, fmt::format("{}: not symmetric: {} with {} is {}, the reverse {}",
                                         path, names_[i], names_[j], one, other));
          return;
        }
        const double scale = sd[i] * sd[j];
        if (scale == 0.0 && one != 0.0) {
          error(at.position, fmt::format("{}: {} with {} is {}, allowed: 0 (a variance is 0)", path,
                                         names_[i], names_[j], one));
          return;
        }
        correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            scale > 0.0 ? one / scale : 0.0;
      }
    }
    if (count == 0) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation,
                                                                Eigen::EigenvaluesOnly);
    const double least = solver.eigenvalues().minCoeff();
    if (least < -kRounding * static_cast<double>(count)) {
      error(at.position,
            fmt::format("{}: not positive semidefinite (least eigenvalue of the correlations "
                        "{:.3g}): allowed: a covariance",
                        path, least));
    }
  }

  struct Deviation {
    Position position;
    double value = 0.0;
    bool stated = false;
  };

  std::string file_;
  std::vector<Diagnostic> diagnostics_;
  // Of the model at hand, parameter by parameter.
  std::vector<std::string> names_;
  std::vector<Deviation> deviations_;
};

std::vector<ExtendedModel> models_from(const TomlValue& document, const std::string& name) {
  Reader reader(name);
  std::vector<ExtendedModel> models = reader.models(document);
  reader.throw_if_invalid();
  return models;
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

std::vector<ExtendedModel> read_model(const std::string& path) {
  return models_from(read_toml(path), path);
}

std::vector<ExtendedModel> parse_model(const std::string& text, const std::string& name) {
  return models_from(parse_toml(text, name), name);
}

}  // namespace gear3k::io
