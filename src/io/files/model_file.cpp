#include "io/files/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "io/files/document_kind.hpp"
#include "io/files/measurement_columns.hpp"
#include "io/files/model_causes.hpp"
#include "io/files/model_covariance.hpp"
#include "io/files/model_file_keys.hpp"
#include "io/files/model_laws.hpp"
#include "io/text/toml_reader.hpp"
#include "io/text/toml_value.hpp"

namespace gear3k::io {

namespace {

using calibrate::ConditionQuantity, calibrate::ConditionRange, calibrate::ExtendedModel,
    calibrate::kConditionQuantities, calibrate::Kind, calibrate::kKindNames;

std::uint64_t fingerprint(const TomlValue& value, const std::string& path, TomlReader& reader) {
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
  reader.refuse(value, path, fmt::format("\"{}\" and 16 hexadecimal digits", kFingerprint));
  return 0;
}

std::optional<calibrate::Verdict> verdict(const TomlValue& value, const std::string& path,
                                          TomlReader& reader) {
  const auto& names = calibrate::kVerdictNames;
  const auto* known =
      value.kind == TomlValue::Kind::kText ? std::ranges::find(names, value.text) : names.end();
  if (known != names.end()) return static_cast<calibrate::Verdict>(known - names.begin());
  reader.refuse(value, path, fmt::format("\"{}\"", fmt::join(names, "\" or \"")));
  return std::nullopt;
}

/// The column that measurements state a quantity in, of whatever kind they are; null: in none.
const MeasurementColumn* column_of(const ConditionQuantity& quantity) {
  for (std::size_t k = 0; k < kKindNames.size(); ++k) {
    const std::vector<MeasurementColumn>& columns = columns_of(static_cast<Kind>(k));
    const auto found = std::ranges::find(columns, quantity.column, &MeasurementColumn::name);
    if (found != columns.end()) return &*found;
  }
  return nullptr;
}

/// [low, high] or [], not stated.
ConditionRange range_of(const ConditionQuantity& quantity, const TomlValue& value,
                        const std::string& path, TomlReader& reader) {
  ConditionRange range{.name = std::string(quantity.name),
                       .unit = std::string(quantity.unit),
                       .low = calibrate::kUnknown,
                       .high = calibrate::kUnknown};
  const MeasurementColumn* column = column_of(quantity);
  const auto allowed = [&](const TomlValue& end) {
    return end.is_number() && std::isfinite(end.number) &&
           (column == nullptr || column->allows(end.number));
  };
  const bool list = value.kind == TomlValue::Kind::kList;
  if (list && value.list.size() == 2 && allowed(value.list[0]) && allowed(value.list[1]) &&
      value.list[0].number <= value.list[1].number) {
    range.low = value.list[0].number;
    range.high = value.list[1].number;
  } else if (!list || !value.list.empty()) {
    reader.refuse(value, path,
                  fmt::format("[low, high], two numbers, low <= high{}; [] = not stated",
                              column == nullptr || std::isinf(column->min)
                                  ? ""
                                  : fmt::format(", each {}", column->allowed_text())));
  }
  return range;
}

std::vector<ConditionRange> ranges(const TomlValue& table, const std::string& path,
                                   TomlReader& reader) {
  std::vector<ConditionRange> result;
  result.reserve(table.table.size());
  for (const TomlValue& member : table.table) {
    const auto* quantity =
        std::ranges::find(kConditionQuantities, member.key, &ConditionQuantity::column);
    const std::string key = path + "." + member.key;
    if (quantity == kConditionQuantities.end()) {
      std::vector<std::string> known;
      known.reserve(kConditionQuantities.size());
      for (const ConditionQuantity& q : kConditionQuantities) known.emplace_back(q.column);
      reader.unknown(member, "range", key, known);
      continue;
    }
    result.push_back(range_of(*quantity, member, key, reader));
  }
  return result;
}

/// The model of one kind.
ExtendedModel model_of(const TomlValue& table, TomlReader& reader) {
  ExtendedModel m;
  m.kind = static_cast<Kind>(std::ranges::find(kKindNames, table.key) - kKindNames.begin());
  const TomlValue* causes = nullptr;
  const TomlValue* laws = nullptr;
  const TomlValue* covariance = nullptr;
  for (const TomlValue& member : table.table) {
    const std::string path = table.key + "." + member.key;
    if (member.key == "name") {
      m.name = reader.text(member, path);
    } else if (member.key == "data_fingerprint") {
      m.fingerprint = fingerprint(member, path, reader);
    } else if (member.key == "data_files") {
      m.files = reader.texts(member, path);
    } else if (member.key == "verdict") {
      m.verdict = verdict(member, path, reader);
    } else if (member.key == kBeyondSprings) {
      m.beyond_springs = reader.truth(member, path);
    } else if (member.key == "range") {
      if (reader.is_table(member, path)) m.range = ranges(member, path, reader);
    } else if (member.key == "causes") {
      causes = &member;
    } else if (member.key == "laws") {
      laws = &member;
    } else if (member.key == "covariance") {
      covariance = &member;
    } else {
      reader.unknown(member, "key", path,
                     {"name", "data_fingerprint", "data_files", "verdict",
                      std::string(kBeyondSprings), "range", "causes", "laws", "covariance"});
    }
  }
  const std::size_t before = reader.errors();
  ModelCauses read;
  const std::string path = table.key + ".causes";
  if (causes == nullptr) {
    reader.error(table.position,
                 fmt::format("{0}.causes is missing: allowed: a table [{0}.causes.ID] "
                             "for each cause, or an empty [{0}.causes]",
                             table.key));
  } else if (reader.is_table(*causes, path)) {
    read = read_causes(*causes, path, m.kind, reader);
  }
  const std::string laws_path = table.key + ".laws";
  if (laws != nullptr && reader.is_table(*laws, laws_path)) {
    m.laws = read_laws(*laws, laws_path, m.kind, reader, read);
  }
  // Of causes that are not understood no covariance can be.
  if (reader.errors() == before) {
    m.covariance = read_covariance(covariance, table.key + ".covariance", read, reader);
  }
  m.causes = std::move(read.causes);
  return m;
}

std::vector<ExtendedModel> models_of(const TomlValue& document, TomlReader& reader) {
  std::vector<ExtendedModel> result;
  result.reserve(document.table.size());
  const std::vector<std::string> kinds(kKindNames.begin(), kKindNames.end());
  for (const TomlValue& member : document.table) {
    if (std::ranges::find(kinds, member.key) == kinds.end()) {
      reader.unknown(member, "table", member.key, kinds);
    } else if (reader.is_table(member, member.key)) {
      result.push_back(model_of(member, reader));
    }
  }
  if (document.table.empty()) {
    reader.error({.line = 1, .column = 1}, fmt::format("no model in the file: allowed: tables [{}]",
                                                       fmt::join(kinds, "], [")));
  }
  // In the order of the kinds, whatever that of the file.
  std::ranges::stable_sort(result, {}, &ExtendedModel::kind);
  return result;
}

std::vector<ExtendedModel> models_from(const TomlValue& document, const std::string& name) {
  refuse_other_documents(document, name, {DocumentKind::kModel},
                         "--model takes a model.toml of diagnose");
  TomlReader reader(name);
  std::vector<ExtendedModel> models = models_of(document, reader);
  reader.throw_if_invalid();
  return models;
}

}  // namespace

std::vector<ExtendedModel> read_model(const std::string& path) {
  return models_from(read_toml(path), path);
}

std::vector<ExtendedModel> parse_model(const std::string& text, const std::string& name) {
  return models_from(parse_toml(text, name), name);
}

}  // namespace gear3k::io
