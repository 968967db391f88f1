#include "io/text/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "io/text/text_lines.hpp"

namespace gear3k::io {

bool CsvFields::split(std::string_view line) {
  values_.clear();
  columns_.clear();
  std::size_t begin = 0;
  if (line.find('"') == std::string_view::npos) {
    while (true) {
      const std::size_t comma = line.find(',', begin);
      values_.push_back(line.substr(begin, comma - begin));
      columns_.push_back(static_cast<int>(begin) + 1);
      if (comma == std::string_view::npos) return true;
      begin = comma + 1;
    }
  }
  unquoted_.clear();
  unquoted_.reserve(line.size());  // the views below point into it
  std::size_t written = 0;
  bool quoted = false;
  const auto end_field = [&](std::size_t next) {
    values_.push_back(std::string_view(unquoted_).substr(written));
    columns_.push_back(static_cast<int>(begin) + 1);
    written = unquoted_.size();
    begin = next;
  };
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quoted && c == '"' && k + 1 < line.size() && line[k + 1] == '"') {
      unquoted_ += '"';
      ++k;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      end_field(k + 1);
    } else {
      unquoted_ += c;
    }
  }
  end_field(line.size());
  return !quoted;
}

std::optional<double> csv_number(std::string_view field) {
  if (field.size() > 1 && field.front() == '+' && field[1] != '-') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

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

std::string_view wrong_separator(std::size_t fields, std::string_view first) {
  const bool wrong = fields == 1 && first.find_first_of(";\t") != std::string_view::npos;
  return wrong ? "the header is one field: allowed: fields parted by commas" : "";
}

CsvTable parse_csv(const std::string& text, const std::string& name) {
  std::vector<Diagnostic> diagnostics;
  CsvTable table = parse_csv(text, name, diagnostics);
  if (!diagnostics.empty()) throw InvalidInput(format_diagnostics(name, diagnostics));
  return table;
}

CsvTable parse_csv(const std::string& text, const std::string& name,
                   std::vector<Diagnostic>& diagnostics) {
  CsvTable table;
  table.name = name;
  std::istringstream stream{std::string(without_mark(text))};
  std::string line;
  CsvFields fields;
  const auto copied = [&] {
    return std::vector<std::string>(fields.values().begin(), fields.values().end());
  };
  for (int number = 1; std::getline(stream, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    if (line.front() == '#') {
      table.notes.push_back(line.substr(1));
    } else if (!fields.split(line)) {
      diagnostics.push_back(
          {.position = {.line = number, .column = 1}, .message = "a quote is left open"});
    } else if (table.header.empty()) {
      table.header = copied();
      table.header_line = number;
    } else {
      const std::size_t count = fields.values().size();
      if (count == table.header.size()) {
        table.rows.push_back({.line = number, .fields = copied()});
      } else {
        diagnostics.push_back({.position = {.line = number, .column = 1},
                               .message = fmt::format("{} fields, allowed: {} as in the header",
                                                      count, table.header.size())});
      }
    }
  }
  return table;
}

}  // namespace gear3k::io
