#include "io/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace gear3k::io {

namespace {

/// The fields of a line; empty when a quote is left open.
std::vector<std::string> split_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quoted && c == '"' && k + 1 < line.size() && line[k + 1] == '"') {
      fields.back() += '"';
      ++k;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  if (quoted) fields.clear();
  return fields;
}

}  // namespace

std::optional<std::string> CsvTable::text(const Row& row, const std::string& column) const {
  const auto at = std::ranges::find(header, column);
  if (at == header.end()) {
    throw std::invalid_argument(
        fmt::format("CSV: no column {}, allowed: {}", column, fmt::join(header, ", ")));
  }
  const std::string& field = row.fields[static_cast<std::size_t>(at - header.begin())];
  if (field.empty()) return std::nullopt;
  return field;
}

std::optional<double> CsvTable::number(const Row& row, const std::string& column) const {
  const std::optional<std::string> field = text(row, column);
  if (!field) return std::nullopt;
  double value = 0.0;
  const auto [end, error] = std::from_chars(field->data(), field->data() + field->size(), value);
  if (error != std::errc() || end != field->data() + field->size() || !std::isfinite(value)) {
    throw InvalidInput(format_diagnostics(
        name, {{.position = {.line = row.line, .column = 1},
                .message = fmt::format("{} = \"{}\": allowed: a finite number", column, *field)}}));
  }
  return value;
}

CsvTable parse_csv(const std::string& text, const std::string& name) {
  CsvTable table;
  table.name = name;
  std::vector<Diagnostic> diagnostics;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    if (line.front() == '#') {
      table.notes.push_back(line.substr(1));
    } else if (split_fields(line).empty()) {
      diagnostics.push_back(
          {.position = {.line = number, .column = 1}, .message = "a quote is left open"});
    } else if (table.header.empty()) {
      table.header = split_fields(line);
    } else {
      table.rows.push_back({.line = number, .fields = split_fields(line)});
      const std::size_t fields = table.rows.back().fields.size();
      if (fields != table.header.size()) {
        diagnostics.push_back({.position = {.line = number, .column = 1},
                               .message = fmt::format("{} fields, allowed: {} as in the header",
                                                      fields, table.header.size())});
      }
    }
  }
  if (!diagnostics.empty()) throw InvalidInput(format_diagnostics(name, diagnostics));
  return table;
}

}  // namespace gear3k::io
