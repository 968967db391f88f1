#pragma once
// Rows of the data files inside the program.

#include <string>

#include "io/text/csv_table.hpp"

namespace gear3k::papers {

/// The row with a name in a column.
/// @throws std::invalid_argument when there is none
const io::CsvTable::Row& row_named(const io::CsvTable& table, const std::string& column,
                                   const std::string& name);

/// The number of a row under a column.
/// @throws std::invalid_argument when the field is blank
double required(const io::CsvTable& table, const io::CsvTable::Row& row, const std::string& column);

}  // namespace gear3k::papers
