#include "io/files/model_laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "calibrate/measurement/response_unit.hpp"
#include "io/files/model_file_keys.hpp"

namespace gear3k::io {

namespace {

using calibrate::AppliedLaw, calibrate::Kind, calibrate::kKindNames, calibrate::Law,
    calibrate::LawCondition, calibrate::LawFactor, calibrate::LawShape, calibrate::ParameterRecord;

class LawReader {
 public:
  LawReader(Kind kind, TomlReader& reader, ModelCauses& parameters)
      : kind_(kind), reader_(reader), parameters_(parameters) {}

  std::optional<AppliedLaw> read(const TomlValue& table, const std::string& path) {
    if (!is_label(table.key)) {
      reader_.error(table.position,
                    fmt::format("unknown law {}: allowed: law, law_2, law_3, ...", path));
      return std::nullopt;
    }
    if (!reader_.is_table(table, path)) return std::nullopt;
    const std::size_t before = reader_.errors();
    table_ = &table;
    path_ = path;
    known_.clear();
    AppliedLaw applied{.law = {}, .value = {}};
    applied.law.action = static_cast<calibrate::LawAction>(
        choice("acts_on", {calibrate::kLawActionNames.begin(), calibrate::kLawActionNames.end()}));
    applied.law.rows = static_cast<calibrate::LawRows>(
        choice("rows", {calibrate::kLawRowsNames.begin(), calibrate::kLawRowsNames.end()}));
    read_factor(applied, 0);
    if (member("shape_2") != nullptr) read_factor(applied, 1);
    if (reader_.errors() == before) read_parameters(table, applied);
    // Of a law that is not understood no key is known to be wrong.
    if (reader_.errors() == before) {
      for (const TomlValue& value : table.table) {
        if (std::ranges::find(known_, value.key) == known_.end()) {
          reader_.unknown(value, "key", fmt::format("{}.{}", path_, value.key), known_);
        }
      }
    }
    if (reader_.errors() != before) return std::nullopt;
    return applied;
  }

 private:
  /// "law", or "law_" and a count from 2 on.
  static bool is_label(std::string_view key) {
    if (key == "law") return true;
    if (!key.starts_with("law_")) return false;
    const std::string_view count = key.substr(4);
    return !count.empty() && count != "1" && count.front() != '0' &&
           std::ranges::all_of(count, [](char c) { return c >= '0' && c <= '9'; });
  }

  const TomlValue* member(std::string_view key) {
    const auto found = std::ranges::find(table_->table, key, &TomlValue::key);
    return found == table_->table.end() ? nullptr : &*found;
  }

  /// A value that must be there; null, and an error, where it is not.
  const TomlValue* needed(const std::string& key, const std::string& allowed) {
    known_.push_back(key);
    const TomlValue* value = member(key);
    if (value == nullptr) {
      reader_.error(table_->position,
                    fmt::format("{}.{} is missing: allowed: {}", path_, key, allowed));
    }
    return value;
  }

  /// The place of a text among those allowed; 0, and an error, where it is none of them.
  std::size_t choice(const std::string& key, const std::vector<std::string>& allowed) {
    const std::string list = fmt::format("\"{}\"", fmt::join(allowed, "\" or \""));
    const TomlValue* value = needed(key, list);
    if (value == nullptr) return 0;
    const auto at = value->kind == TomlValue::Kind::kText ? std::ranges::find(allowed, value->text)
                                                          : allowed.end();
    if (at != allowed.end()) return static_cast<std::size_t>(at - allowed.begin());
    const std::string hint =
        value->kind == TomlValue::Kind::kText ? closest_word(value->text, allowed) : "";
    reader_.refuse(*value, fmt::format("{}.{}", path_, key),
                   hint.empty() ? list : fmt::format("{}; did you mean \"{}\"?", list, hint));
    return 0;
  }

  /// A number that `allows`; 1, and an error, where it is none.
  template <class Allows>
  double number(const std::string& key, const std::string& allowed, Allows allows) {
    const TomlValue* value = needed(key, allowed);
    if (value == nullptr) return 1.0;
    if (value->is_number() && std::isfinite(value->number) && allows(value->number)) {
      return value->number;
    }
    reader_.refuse(*value, fmt::format("{}.{}", path_, key), allowed);
    return 1.0;
  }

  void read_factor(AppliedLaw& applied, std::size_t place) {
    std::vector<std::string> shapes;
    shapes.reserve(calibrate::kLawShapes);
    for (int k = 0; k < calibrate::kLawShapes; ++k) {
      shapes.emplace_back(record_of(static_cast<LawShape>(k)).name);
    }
    std::vector<std::string> names;
    std::vector<std::size_t> places;
    const auto& conditions = calibrate::law_conditions();
    for (std::size_t k = 0; k < conditions.size(); ++k) {
      if (std::ranges::find(conditions[k].kinds, kind_) == conditions[k].kinds.end()) continue;
      names.emplace_back(conditions[k].name);
      places.push_back(k);
    }
    const std::size_t before = reader_.errors();
    LawFactor factor{.shape = static_cast<LawShape>(choice(law_key("shape", place), shapes)),
                     .condition = places[choice(law_key("condition", place), names)]};
    if (reader_.errors() != before) return;
    constexpr double kLeast = 1e-6;
    constexpr double kGreatest = 1e12;
    const std::string origin = law_unit_key("origin", factor, place);
    known_.push_back(origin);
    if (member(origin) != nullptr) {
      factor.origin = number(origin, "a number within 1e+12",
                             [&](double x) { return std::abs(x) <= kGreatest; });
    }
    factor.reference = number(law_unit_key("reference", factor, place), "1e-06 to 1e+12",
                              [&](double x) { return x >= kLeast && x <= kGreatest; });
    if (!record_of(factor.shape).constant.empty()) {
      const bool width = factor.shape != LawShape::kStep;
      factor.constant =
          number(law_constant_key(factor, place), width ? "a number above 0" : "a number",
                 [&](double x) { return !width || x > 0.0; });
    }
    if (has_limits(factor)) read_limits(factor, place);
    if (conditions[factor.condition].of_campaign) {
      const std::string left = law_key("left_behind", place);
      known_.push_back(left);
      if (member(left) != nullptr) {
        applied.left_behind[place] = number(left, "a number", [](double) { return true; });
      }
    }
    applied.law.factors.push_back(factor);
  }

  /// Where the condition ends, where that is stated; what turns or goes on in waves has no end.
  void read_limits(LawFactor& factor, std::size_t place) {
    const auto limit = [&](std::string_view name, double& x, const std::string& allowed,
                           auto allows) {
      const std::string key = law_unit_key(name, factor, place);
      known_.push_back(key);
      if (member(key) == nullptr) return;
      // What stands for a refused number limits no other one.
      const std::size_t before = reader_.errors();
      const double stated = number(key, allowed, allows);
      if (reader_.errors() == before) x = stated;
    };
    limit("least", factor.least, "a number", [](double) { return true; });
    limit("greatest", factor.greatest,
          std::isfinite(factor.least) ? fmt::format("a number, at least {}", factor.least)
                                      : "a number",
          [&](double x) { return x >= factor.least; });
  }

  void read_parameters(const TomlValue& table, AppliedLaw& applied) {
    const std::vector<ParameterRecord> with_offset = parameters_of(
        Law{.action = applied.law.action, .rows = {}, .factors = {}, .offset = true}, kind_);
    applied.law.offset = member(key_of(with_offset[1])) != nullptr;
    for (const ParameterRecord& record : parameters_of(applied.law, kind_)) {
      const std::string key = key_of(record);
      applied.value.push_back(
          number(key,
                 fmt::format("a number{}{}, {} to {}", record.unit.empty() ? "" : " in ",
                             record.unit, record.lower, record.upper),
                 [&](double x) { return x >= record.lower && x <= record.upper; }));
      parameters_.names.push_back(fmt::format("{}.{}", table.key, key));
      const std::string sd = key + std::string(kDeviation);
      known_.push_back(sd);
      StatedDeviation deviation;
      if (const TomlValue* value = member(sd)) {
        deviation.position = value->position;
        if (value->is_number() && value->number >= 0.0 && std::isfinite(value->number)) {
          deviation.value = value->number;
          deviation.stated = true;
        } else {
          reader_.refuse(*value, fmt::format("{}.{}", path_, sd), "a number, at least 0");
        }
      }
      parameters_.deviations.push_back(deviation);
    }
    if (applied.value.size() > static_cast<std::size_t>(calibrate::kMostLawParameters)) {
      reader_.error(table.position,
                    fmt::format("{} has {} parameters: allowed: at most {}", path_,
                                applied.value.size(), calibrate::kMostLawParameters));
    }
  }

  Kind kind_;
  TomlReader& reader_;
  ModelCauses& parameters_;
  const TomlValue* table_ = nullptr;
  std::string path_;
  std::vector<std::string> known_;
};

}  // namespace

std::string law_key(std::string_view name, std::size_t place) {
  return place == 0 ? std::string(name) : fmt::format("{}_{}", name, place + 1);
}

std::string law_unit_key(std::string_view name, const LawFactor& factor, std::size_t place) {
  return calibrate::file_key(law_key(name, place),
                             calibrate::law_conditions()[factor.condition].shown_unit);
}

std::string law_constant_key(const LawFactor& factor, std::size_t place) {
  const std::string_view name = record_of(factor.shape).constant;
  if (factor.shape == LawShape::kStep) return law_unit_key(name, factor, place);
  return law_key(name, place);
}

std::vector<AppliedLaw> read_laws(const TomlValue& table, const std::string& path, Kind kind,
                                  TomlReader& reader, ModelCauses& parameters) {
  std::vector<AppliedLaw> laws;
  LawReader law(kind, reader, parameters);
  for (const TomlValue& one : table.table) {
    if (auto read = law.read(one, fmt::format("{}.{}", path, one.key))) {
      laws.push_back(std::move(*read));
    }
  }
  return laws;
}

}  // namespace gear3k::io
