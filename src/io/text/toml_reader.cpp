#include "io/text/toml_reader.hpp"

#include <fmt/format.h>

#include <cmath>

namespace gear3k::io {

void TomlReader::error(Position position, const std::string& message) {
  complaints_.add(position, message);
}

void TomlReader::unknown(const TomlValue& at, std::string_view what, const std::string& word,
                         const std::vector<std::string>& known) {
  complaints_.add(at.position, [&] {
    const std::string hint = closest_word(word.substr(word.rfind('.') + 1), known);
    return fmt::format("unknown {} {}{}; allowed: {}", what, word,
                       hint.empty() ? "" : fmt::format("; did you mean {}?", hint),
                       fmt::join(known, ", "));
  });
}

void TomlReader::refuse(const TomlValue& value, const std::string& path,
                        const std::string& allowed) {
  error(value.position, fmt::format("{} = {}: allowed: {}", path, as_text(value), allowed));
}

bool TomlReader::is_table(const TomlValue& value, const std::string& path) {
  if (value.kind == TomlValue::Kind::kTable) return true;
  refuse(value, path, fmt::format("a table [{}]", path));
  return false;
}

std::string TomlReader::text(const TomlValue& value, const std::string& path) {
  if (value.kind != TomlValue::Kind::kText) refuse(value, path, "a text in quotes");
  return value.text;
}

double TomlReader::number(const TomlValue& value, const std::string& path) {
  if (value.is_number() && std::isfinite(value.number)) return value.number;
  refuse(value, path, "a number");
  return 0.0;
}

bool TomlReader::truth(const TomlValue& value, const std::string& path) {
  if (value.kind != TomlValue::Kind::kBoolean) refuse(value, path, "true or false");
  return value.boolean;
}

std::vector<std::string> TomlReader::texts(const TomlValue& value, const std::string& path) {
  std::vector<std::string> result;
  if (value.kind != TomlValue::Kind::kList) {
    refuse(value, path, "a list of texts");
    return result;
  }
  result.reserve(value.list.size());
  for (const TomlValue& element : value.list) result.push_back(text(element, path));
  return result;
}

void TomlReader::throw_if_invalid() const {
  if (!complaints_.none()) throw InvalidInput(complaints_.text(file_));
}

}  // namespace gear3k::io
