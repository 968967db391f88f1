#pragma once
// Values as TOML writes them.

#include <fmt/format.h>

#include <string>

#include "io/text/toml_value.hpp"

namespace gear3k::io {

/// The quoted text of TOML.
inline std::string toml_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(code));
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// A finite float as TOML wants it: with a point or an exponent; read back, the same number.
inline std::string toml_number(double value) {
  std::string text = fmt::format("{}", value + 0.0);  // minus zero is zero
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

/// A value as TOML, on one line.
inline std::string toml_text(const TomlValue& value) {
  std::string text;
  switch (value.kind) {
    case TomlValue::Kind::kBoolean:
      return value.boolean ? "true" : "false";
    case TomlValue::Kind::kInteger:
      return fmt::format("{}", value.integer);
    case TomlValue::Kind::kNumber:
      return toml_number(value.number);
    case TomlValue::Kind::kText:
      return toml_quoted(value.text);
    case TomlValue::Kind::kList:
      for (const TomlValue& element : value.list) {
        text += (text.empty() ? "" : ", ") + toml_text(element);
      }
      return "[" + text + "]";
    case TomlValue::Kind::kTable:
      for (const TomlValue& member : value.table) {
        text += fmt::format("{} {} = {}", text.empty() ? "" : ",", member.key, toml_text(member));
      }
      return "{" + text + " }";
    case TomlValue::Kind::kOther:
      break;
  }
  return text;
}

}  // namespace gear3k::io
