#include "io/text/toml_value.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <tuple>

#include "io/text/file_reader.hpp"
#include "io/text/toml_limits.hpp"

namespace gear3k::io {

namespace {

Position position_of(const toml::source_region& region) {
  return {.line = static_cast<int>(region.begin.line),
          .column = static_cast<int>(region.begin.column)};
}

TomlValue convert(const toml::node& node) {
  TomlValue value;
  value.position = position_of(node.source());
  if (const auto* boolean = node.as_boolean()) {
    value.kind = TomlValue::Kind::kBoolean;
    value.boolean = boolean->get();
  } else if (const auto* integer = node.as_integer()) {
    value.kind = TomlValue::Kind::kInteger;
    value.integer = integer->get();
    value.number = static_cast<double>(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    value.kind = TomlValue::Kind::kNumber;
    value.number = number->get();
  } else if (const auto* text = node.as_string()) {
    value.kind = TomlValue::Kind::kText;
    value.text = text->get();
  } else if (const auto* list = node.as_array()) {
    value.kind = TomlValue::Kind::kList;
    for (const toml::node& element : *list) value.list.push_back(convert(element));
  } else if (const auto* table = node.as_table()) {
    value.kind = TomlValue::Kind::kTable;
    for (const auto& [key, member] : *table) {
      TomlValue converted = convert(member);
      converted.position = position_of(key.source());
      converted.key = key.str();
      value.table.push_back(std::move(converted));
    }
    // The library orders keys by name; files are read from top to bottom.
    std::sort(value.table.begin(), value.table.end(), [](const TomlValue& a, const TomlValue& b) {
      return std::tie(a.position.line, a.position.column) <
             std::tie(b.position.line, b.position.column);
    });
  }
  return value;
}

}  // namespace

std::string as_text(const TomlValue& value) {
  constexpr std::size_t kLongest = 60;
  std::string text;
  switch (value.kind) {
    case TomlValue::Kind::kBoolean:
      text = value.boolean ? "true" : "false";
      break;
    case TomlValue::Kind::kInteger:
      text = fmt::format("{}", value.integer);
      break;
    case TomlValue::Kind::kNumber:
      text = fmt::format("{}", value.number);
      if (text.find_first_of(".en") == std::string::npos) text += ".0";  // as TOML writes it
      break;
    case TomlValue::Kind::kText:
      text = fmt::format("\"{}\"", value.text);
      break;
    case TomlValue::Kind::kList:
      for (const TomlValue& element : value.list) {
        text += (text.empty() ? "[" : ", ") + as_text(element);
      }
      text = text.empty() ? "[]" : text + "]";
      break;
    case TomlValue::Kind::kTable:
      for (const TomlValue& member : value.table) {
        text += fmt::format("{}{} = {}", text.empty() ? "{ " : ", ", member.key, as_text(member));
      }
      text = text.empty() ? "{}" : text + " }";
      break;
    case TomlValue::Kind::kOther:
      text = "a date or time";
      break;
  }
  if (text.size() <= kLongest) return text;
  std::size_t end = kLongest;
  // Not within a character of several bytes (UTF-8 continuation bytes are 10xxxxxx).
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end) + "...";
}

TomlValue parse_toml(const std::string& text, const std::string& name) {
  if (const std::optional<Diagnostic> beyond = beyond_toml_limits(text)) {
    throw InvalidInput(format_diagnostics(name, {*beyond}));
  }
  try {
    return convert(toml::parse(text, name));
  } catch (const toml::parse_error& error) {
    throw InvalidInput(format_diagnostics(
        name, {{.position = position_of(error.source()),
                .message = fmt::format("not valid TOML: {}", error.description())}}));
  }
}

std::string read_toml_text(const std::string& path) {
  return read_text(path, "a TOML file", kMostTomlBytes);
}

TomlValue read_toml(const std::string& path) { return parse_toml(read_toml_text(path), path); }

}  // namespace gear3k::io
