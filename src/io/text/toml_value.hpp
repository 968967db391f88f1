#pragma once
// A TOML document as plain values with their places; the only place that knows the TOML library is
// the .cpp file.

#include <cstdint>
#include <string>
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

/// The value as a message shows it, shortened where long.
std::string as_text(const TomlValue& value);

/// Reads a file.
/// @throws InvalidInput when it cannot be read or is not TOML
TomlValue read_toml(const std::string& path);

/// Its bytes, for more than one use of them: a pipe can be read only once.
/// @throws InvalidInput when it cannot be read
std::string read_toml_text(const std::string& path);

/// Parses a text; `name` stands for the file in messages.
/// @throws InvalidInput when it is not TOML
TomlValue parse_toml(const std::string& text, const std::string& name);

}  // namespace gear3k::io
