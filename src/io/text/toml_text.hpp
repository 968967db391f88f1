#pragma once
// Values as TOML writes them.

#include <fmt/format.h>

#include <string>

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
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace gear3k::io
