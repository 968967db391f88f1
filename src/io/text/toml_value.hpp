#pragma once
// A TOML document as plain values with their places; the only place that knows the TOML library is
// the .cpp file.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

struct TomlValue {
  enum class Kind { kBoolean, kInteger, kNumber, kText, kList, kTable, kOther };
  Kind kind = Kind::kOther;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;  ///< also set for integers
  std::string text;
  std::vector<TomlValue> list;
  std::vector<TomlValue> table;  ///< in the order of the file
  std::string key;               ///< of a member of a table
  Position position;             ///< of the key, or of a list's element

  [[nodiscard]] bool is_number() const { return kind == Kind::kInteger || kind == Kind::kNumber; }
};

inline TomlValue boolean_value(bool boolean) {
  TomlValue value;
  value.kind = TomlValue::Kind::kBoolean;
  value.boolean = boolean;
  return value;
}
inline TomlValue integer_value(std::int64_t integer) {
  TomlValue value;
  value.kind = TomlValue::Kind::kInteger;
  value.integer = integer;
  value.number = static_cast<double>(integer);
  return value;
}
inline TomlValue number_value(double number) {
  TomlValue value;
  value.kind = TomlValue::Kind::kNumber;
  value.number = number;
  return value;
}
inline TomlValue text_value(std::string text) {
  TomlValue value;
  value.kind = TomlValue::Kind::kText;
  value.text = std::move(text);
  return value;
}
inline TomlValue list_value(std::vector<TomlValue> list) {
  TomlValue value;
  value.kind = TomlValue::Kind::kList;
  value.list = std::move(list);
  return value;
}
inline TomlValue table_value(std::vector<TomlValue> members) {
  TomlValue value;
  value.kind = TomlValue::Kind::kTable;
  value.table = std::move(members);
  return value;
}

/// The value as a message shows it, shortened where long.
std::string as_text(const TomlValue& value);

/// Reads a file.
/// @throws InvalidInput when it cannot be read, is not TOML or goes beyond toml_limits.hpp
TomlValue read_toml(const std::string& path);

/// Its bytes, for more than one use of them: a pipe can be read only once.
/// @throws InvalidInput when it cannot be read
std::string read_toml_text(const std::string& path);

/// Parses a text; `name` stands for the file in messages.
/// @throws InvalidInput when it is not TOML or goes beyond toml_limits.hpp
TomlValue parse_toml(const std::string& text, const std::string& name);

}  // namespace gear3k::io
