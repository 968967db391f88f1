#include "papers/statement_table.hpp"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

namespace gear3k::papers {

const io::CsvTable::Row& row_named(const io::CsvTable& table, const std::string& column,
                                   const std::string& name) {
  for (const io::CsvTable::Row& row : table.rows) {
    if (table.text(row, column) == name) return row;
  }
  throw std::invalid_argument(fmt::format("{}: no row {}", table.name, name));
}

double required(const io::CsvTable& table, const io::CsvTable::Row& row,
                const std::string& column) {
  const std::optional<double> value = table.number(row, column);
  if (!value) {
    throw std::invalid_argument(fmt::format("{}:{}: no {}", table.name, row.line, column));
  }
  return *value;
}

}  // namespace gear3k::papers
