#include "io/files/model_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "calibrate/causes/form_catalogue.hpp"
#include "calibrate/causes/free_shape.hpp"
#include "calibrate/causes/reading_change.hpp"
#include "io/files/model_file_keys.hpp"

namespace gear3k::io {

namespace {

using calibrate::AppliedCause, calibrate::CatalogueForm, calibrate::Cause, calibrate::Kind,
    calibrate::kKindNames, calibrate::ParameterRecord;

class CauseReader {
 public:
  CauseReader(Kind kind, TomlReader& reader) : kind_(kind), reader_(reader) {}

  void read_cause(const TomlValue& table, const std::string& path) {
    const Cause* cause = cause_named(table, path);
    if (cause == nullptr || !reader_.is_table(table, path)) return;
    const std::vector<CatalogueForm> catalogue = calibrate::form_catalogue(*cause, kind_);
    if (catalogue.empty()) {
      reader_.error(table.position, fmt::format("{}: {} data cannot show this cause", path,
                                                kKindNames[static_cast<std::size_t>(kind_)]));
      return;
    }
    const auto member = [&](std::string_view key) { return member_of(table, key); };
    const CatalogueForm* form = form_of(table, path, catalogue);
    AppliedCause applied{.id = std::string(cause->id), .form = {}, .value = {}};
    std::vector<std::string> known{"form", std::string(kAlternatives), std::string(kImplausible),
                                   std::string(kEmpirical)};
    if (form != nullptr) {
      applied.form.name = form->name;
      read_constants(table, path, *form, applied.form, known);
      read_parameters(table, path, cause->parameters(applied.form, kind_), applied.value, known);
    } else {
      check_parameters(table, path, parameters_of(*cause, catalogue), known);
    }
    if (const TomlValue* list = member(kAlternatives)) {
      applied.alternatives = alternatives(*list, fmt::format("{}.{}", path, kAlternatives));
    }
    if (const TomlValue* list = member(kImplausible)) {
      applied.implausible = reader_.texts(*list, fmt::format("{}.{}", path, kImplausible));
    }
    if (const TomlValue* flag = member(kEmpirical)) {
      applied.empirical = reader_.truth(*flag, fmt::format("{}.{}", path, kEmpirical));
    }
    if (cause->as_constant != nullptr) {
      known.emplace_back(kLeftBehind);
      known.emplace_back(kLeftBehindOn);
      if (const TomlValue* change = member(kLeftBehind)) {
        applied.left_behind = left_behind(*change, fmt::format("{}.{}", path, kLeftBehind));
      }
      if (const TomlValue* law = member(kLeftBehindOn)) {
        applied.left_behind_on = changed_law(*law, fmt::format("{}.{}", path, kLeftBehindOn));
      }
    }
    if (form == nullptr) {
      for (const CatalogueForm& possible : catalogue) add_keys(possible, known);
    }
    for (const TomlValue& value : table.table) {
      if (std::ranges::find(known, value.key) == known.end()) {
        reader_.unknown(value, "key", fmt::format("{}.{}", path, value.key), known);
      }
    }
    if (form != nullptr) read_.causes.push_back(applied);
  }

  ModelCauses result() { return std::move(read_); }

 private:
  static const TomlValue* member_of(const TomlValue& table, std::string_view key) {
    const auto found = std::ranges::find(table.table, key, &TomlValue::key);
    return found == table.table.end() ? nullptr : &*found;
  }

  static std::vector<std::string> cause_ids() {
    std::vector<std::string> ids;
    ids.reserve(calibrate::causes().size());
    for (const Cause* cause : calibrate::causes()) ids.emplace_back(cause->id);
    return ids;
  }

  /// The form that a table names; null, and an error, where it names none of the cause's.
  const CatalogueForm* form_of(const TomlValue& table, const std::string& path,
                               const std::vector<CatalogueForm>& catalogue) {
    std::vector<std::string> forms;
    forms.reserve(catalogue.size());
    for (const CatalogueForm& form : catalogue) forms.push_back(form.name);
    const TomlValue* value = member_of(table, "form");
    if (value == nullptr) {
      reader_.error(table.position, fmt::format("{}.form is missing: allowed: \"{}\"", path,
                                                fmt::join(forms, "\" or \"")));
      return nullptr;
    }
    const std::string name = reader_.text(*value, path + ".form");
    const auto form = std::ranges::find(catalogue, name, &CatalogueForm::name);
    if (form != catalogue.end()) return &*form;
    if (value->kind == TomlValue::Kind::kText) {
      const std::string hint = closest_word(name, forms);
      reader_.refuse(*value, path + ".form",
                     fmt::format("\"{}\"{}", fmt::join(forms, "\" or \""),
                                 hint.empty() ? "" : fmt::format("; did you mean \"{}\"?", hint)));
    }
    return nullptr;
  }

  /// Keys that a form may have beside the parameters.
  static void add_keys(const CatalogueForm& form, std::vector<std::string>& keys) {
    const auto add = [&](const std::string& key) {
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
    };
    for (const calibrate::FormConstant& constant : form.constants) add(key_of(constant));
    if (!form.bodies.empty()) add("body");
    if (form.has_order) add("order");
  }

  /// Ids of causes.
  std::vector<std::string> alternatives(const TomlValue& list, const std::string& path) {
    std::vector<std::string> ids = reader_.texts(list, path);
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const TomlValue& value = list.list[k];
      if (value.kind != TomlValue::Kind::kText || calibrate::find_cause(ids[k]) != nullptr) {
        continue;
      }
      const std::string hint = closest_word(ids[k], cause_ids());
      reader_.refuse(value, path,
                     fmt::format("ids of causes{}",
                                 hint.empty() ? "" : fmt::format("; did you mean {}?", hint)));
    }
    return ids;
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
    const std::vector<std::string> known = cause_ids();
    const std::string hint = closest_word(id, known);
    reader_.error(table.position,
                  fmt::format("unknown cause {}{}; allowed: {}", path,
                              hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                              fmt::join(known, ", ")));
    return nullptr;
  }

  static std::string allowed_text(const ParameterRecord& parameter) {
    return fmt::format("a number{}{}, {} to {}", parameter.unit.empty() ? "" : " in ",
                       parameter.unit, parameter.lower, parameter.upper);
  }

  static bool allows(const ParameterRecord& parameter, const TomlValue& value) {
    return value.is_number() && value.number >= parameter.lower && value.number <= parameter.upper;
  }

  void read_parameters(const TomlValue& table, const std::string& path,
                       const std::vector<ParameterRecord>& parameters, std::vector<double>& values,
                       std::vector<std::string>& known) {
    values.reserve(parameters.size());
    for (const ParameterRecord& parameter : parameters) {
      const std::string key = key_of(parameter);
      known.push_back(key);
      known.push_back(key + std::string(kDeviation));
      const TomlValue* value = member_of(table, key);
      double x = 0.0;
      if (value == nullptr) {
        reader_.error(table.position, fmt::format("{}.{} is missing: allowed: {}", path, key,
                                                  allowed_text(parameter)));
      } else if (!allows(parameter, *value)) {
        reader_.refuse(*value, fmt::format("{}.{}", path, key), allowed_text(parameter));
      } else {
        x = value->number;
      }
      values.push_back(x);
      read_.names.push_back(fmt::format("{}.{}", table.key, key));
      read_deviation(member_of(table, key + std::string(kDeviation)),
                     fmt::format("{}.{}{}", path, key, kDeviation));
    }
  }

  /// Of every form that the cause may take.
  std::vector<ParameterRecord> parameters_of(const Cause& cause,
                                             const std::vector<CatalogueForm>& catalogue) const {
    std::vector<ParameterRecord> all;
    for (const CatalogueForm& possible : catalogue) {
      const auto own = cause.parameters({.name = possible.name}, kind_);
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }

  /// While the form is not known none is required, and what any form allows is allowed.
  void check_parameters(const TomlValue& table, const std::string& path,
                        const std::vector<ParameterRecord>& possible,
                        std::vector<std::string>& known) {
    for (const ParameterRecord& parameter : possible) {
      const std::string key = key_of(parameter);
      if (std::ranges::find(known, key) != known.end()) continue;
      known.push_back(key);
      known.push_back(key + std::string(kDeviation));
      const TomlValue* value = member_of(table, key);
      const bool refused =
          value != nullptr && std::ranges::none_of(possible, [&](const ParameterRecord& other) {
            return key_of(other) == key && allows(other, *value);
          });
      if (refused) {
        reader_.refuse(*value, fmt::format("{}.{}", path, key), allowed_text(parameter));
      }
      read_deviation(member_of(table, key + std::string(kDeviation)),
                     fmt::format("{}.{}{}", path, key, kDeviation));
    }
  }

  double left_behind(const TomlValue& value, const std::string& path) {
    if (value.is_number() && std::isfinite(value.number)) return value.number;
    reader_.refuse(value, path, "a number");
    return calibrate::kUnknown;
  }

  std::string changed_law(const TomlValue& value, const std::string& path) {
    constexpr std::array kLaws{calibrate::kOnFriction, calibrate::kOnGain, calibrate::kOnOffset,
                               calibrate::kOnDrag};
    std::string law = reader_.text(value, path);
    if (std::ranges::find(kLaws, law) != kLaws.end()) return law;
    if (value.kind == TomlValue::Kind::kText) {
      reader_.refuse(value, path, fmt::format("\"{}\"", fmt::join(kLaws, "\" or \"")));
    }
    return "";
  }

  void read_deviation(const TomlValue* value, const std::string& path) {
    StatedDeviation deviation;
    if (value != nullptr) {
      deviation.position = value->position;
      if (value->is_number() && value->number >= 0.0 && std::isfinite(value->number)) {
        deviation.value = value->number;
        deviation.stated = true;
      } else {
        reader_.refuse(*value, path, "a number, at least 0");
      }
    }
    read_.deviations.push_back(deviation);
  }

  /// Puts constants in the order of the form, whatever that of the file.
  static void in_order_of_form(const CatalogueForm& known,
                               std::vector<calibrate::FormConstant>& constants) {
    using calibrate::FormConstant;
    const auto same = [](const FormConstant& a, const FormConstant& b) {
      return a.name == b.name && a.unit == b.unit;
    };
    for (const std::vector<FormConstant>& set : known.sets) {
      if (!std::ranges::is_permutation(set, constants, same)) continue;
      std::vector<FormConstant> ordered = set;
      for (FormConstant& c : ordered) {
        c = *std::ranges::find_if(constants, [&](const FormConstant& k) { return same(k, c); });
      }
      constants = std::move(ordered);
      return;
    }
  }

  /// What a constant's value ought to be; "" where it is.
  static std::string allowed_constant(const calibrate::FormConstant& c) {
    constexpr auto kMostSessions = static_cast<double>(calibrate::kMostSessions);
    constexpr double kAbsoluteZero_c = -273.15;
    const bool whole = std::floor(c.value) == c.value;
    if (c.name == calibrate::kSessions) {
      return whole && c.value >= 1.0 && c.value <= kMostSessions
                 ? ""
                 : fmt::format("an integer from 1 to {}", calibrate::kMostSessions);
    }
    if (c.name == "first_run") {
      constexpr double kMostRuns = 1e9;
      return whole && c.value >= 0.0 && c.value <= kMostRuns ? "" : "an integer from 0";
    }
    if (c.name == "reference_temperature") {
      return c.value > kAbsoluteZero_c ? "" : "a number above -273.15";
    }
    // What forces, speeds, torques and times are divided by.
    constexpr std::array<std::string_view, 10> kScales{
        "radius",     "load",   "speed",   "scale",   "time_constant",
        "half_range", "torque", "slowest", "fastest", "span"};
    const bool scale =
        std::ranges::any_of(kScales, [&](std::string_view end) { return c.name.ends_with(end); });
    return !scale || c.value > 0.0 ? "" : "a number above 0";
  }

  /// Constants, body and order of a form; each constant of the form's name is stated in one of its
  /// units.
  void read_constants(const TomlValue& table, const std::string& path, const CatalogueForm& known,
                      calibrate::Form& form, std::vector<std::string>& keys) {
    for (const calibrate::FormConstant& stated : known.constants) {
      const std::string key = key_of(stated);
      keys.push_back(key);
      const TomlValue* value = member_of(table, key);
      if (value == nullptr) continue;
      calibrate::FormConstant constant = stated;
      constant.value = reader_.number(*value, fmt::format("{}.{}", path, key));
      const std::string allowed = allowed_constant(constant);
      if (value->is_number() && std::isfinite(constant.value) && !allowed.empty()) {
        reader_.refuse(*value, fmt::format("{}.{}", path, key), allowed);
      }
      form.constants.push_back(constant);
    }
    in_order_of_form(known, form.constants);
    require_rising_places(table, path, known);
    if (!known.bodies.empty()) {
      keys.emplace_back("body");
      const auto body = std::ranges::find(table.table, "body", &TomlValue::key);
      if (body != table.table.end()) {
        form.body = reader_.text(*body, path + ".body");
        if (body->kind == TomlValue::Kind::kText &&
            std::ranges::find(known.bodies, form.body) == known.bodies.end()) {
          reader_.refuse(*body, path + ".body",
                         fmt::format("\"{}\"", fmt::join(known.bodies, "\" or \"")));
        }
      }
    }
    if (known.has_order) {
      keys.emplace_back("order");
      const auto order = std::ranges::find(table.table, "order", &TomlValue::key);
      if (order == table.table.end()) {
        reader_.error(
            table.position,
            fmt::format("{}.order is missing: allowed: a number above 0, per output revolution",
                        path));
      } else if (!(order->is_number() && order->number > 0.0 && std::isfinite(order->number))) {
        reader_.refuse(*order, path + ".order", "a number above 0, per output revolution");
      } else {
        form.order = order->number;
      }
    }
    require_constants(table, path, known, form);
  }

  /// A curve through levels has them one after the other; refuses the first that is not.
  void require_rising_places(const TomlValue& table, const std::string& path,
                             const CatalogueForm& known) {
    constexpr double kGap = 0.01, kFirst = -1.0, kLast = 1.0;
    double before = kFirst;
    std::string of_before = "the first place";
    for (const calibrate::FormConstant& c : known.constants) {
      if (!c.name.starts_with(calibrate::kPlace)) continue;
      const std::string key = key_of(c);
      const TomlValue* value = member_of(table, key);
      if (value == nullptr || !value->is_number() || !std::isfinite(value->number)) continue;
      const double place = value->number;
      if (!(place >= before + kGap && place <= kLast - kGap)) {
        reader_.refuse(*value, fmt::format("{}.{}", path, key),
                       fmt::format("a number at least {} above {} ({}), up to {}", kGap, of_before,
                                   before, kLast - kGap));
        return;
      }
      before = place;
      of_before = key;
    }
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
      for (const calibrate::FormConstant& c : set) keys.push_back(key_of(c));
      choices.push_back(fmt::format("{}", fmt::join(keys, " and ")));
    }
    reader_.error(table.position, fmt::format("{}: form \"{}\" needs {}", path, form.name,
                                              fmt::join(choices, ", or ")));
  }

  Kind kind_;
  TomlReader& reader_;
  ModelCauses read_;
};

}  // namespace

ModelCauses read_causes(const TomlValue& table, const std::string& path, Kind kind,
                        TomlReader& reader) {
  CauseReader causes(kind, reader);
  for (const TomlValue& cause : table.table) {
    causes.read_cause(cause, fmt::format("{}.{}", path, cause.key));
  }
  return causes.result();
}

}  // namespace gear3k::io
