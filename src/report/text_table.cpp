#include "report/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/text/csv_table.hpp"
#include "io/text/printable.hpp"
#include "io/text/utf8.hpp"

namespace gear3k::report {

namespace {

/// All characters that we print are one column wide.
std::size_t width_of(const std::string& text) { return io::characters_in(text); }

/// A field that a spreadsheet does not take for a formula.
std::string no_formula(std::string field) {
  constexpr std::string_view kFormulaBegins = "=+-@";
  const bool begins = !field.empty() && kFormulaBegins.find(field[0]) != std::string_view::npos;
  return begins && !io::csv_number(field) ? "'" + field : field;
}

}  // namespace

void TextTable::add(std::vector<std::string> row) {
  for (std::string& cell : row) cell = io::printable(cell);
  rows_.push_back(std::move(row));
}

std::string TextTable::text(std::size_t indent) const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string result;
  for (const auto& row : rows_) {
    std::string line(indent, ' ');
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(widths[c] - width_of(row[c]), ' ');
      const bool left = std::ranges::find(left_, c) != left_.end();
      line += (c > 0 ? "  " : "") + (left ? row[c] + pad : pad + row[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    result += line + '\n';
  }
  return result;
}

std::string csv_line(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    if (k > 0) line += ',';
    const std::string field = no_formula(io::printable(fields[k]));
    if (field.find_first_of(",\"") == std::string::npos) {
      line += field;
      continue;
    }
    line += '"';
    for (const char c : field) {
      if (c == '"') line += '"';
      line += c;
    }
    line += '"';
  }
  return line + '\n';
}

std::string with_unit(const std::string& number, std::string_view unit) {
  return unit.empty() ? number : fmt::format("{} {}", number, unit);
}

std::string exact(double value) {
  return std::isfinite(value) ? fmt::format("{}", value + 0.0) : "";  // minus zero is zero
}

}  // namespace gear3k::report
