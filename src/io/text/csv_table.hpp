#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/diagnostics.hpp"

namespace gear3k::io {

/// The fields of one line after the other; keeps its buffers for long files.
class CsvFields {
 public:
  /// Splits RFC 4180 fields (quotes, doubled quotes; no line breaks inside fields).
  /// @returns false when a quote is left open
  bool split(std::string_view line);

  /// Valid until the next split() and as long as the line.
  [[nodiscard]] const std::vector<std::string_view>& values() const { return values_; }
  /// Where a field begins in its line, from 1.
  [[nodiscard]] int column(std::size_t field) const { return columns_[field]; }

 private:
  std::vector<std::string_view> values_;
  std::vector<int> columns_;
  std::string unquoted_;
};

/// The number that a field without blanks around it holds; infinite or NaN where it says so.
std::optional<double> csv_number(std::string_view field);

/// What is wrong with a header of one field that semicolons or tabs part; "" with any other.
std::string_view wrong_separator(std::size_t fields, std::string_view first);

/// A CSV text: lines beginning with '#' are notes, the first other line is the header.
struct CsvTable {
  struct Row {
    int line = 0;  ///< in the file, from 1
    std::vector<std::string> fields;
  };
  std::string name;  ///< stands for the file in messages
  std::vector<std::string> notes;
  std::vector<std::string> header;
  int header_line = 1;  ///< in the file, from 1
  std::vector<Row> rows;

  /// The field of a row under a column; empty when the field is blank.
  /// @throws std::invalid_argument when there is no such column
  [[nodiscard]] std::optional<std::string> text(const Row& row, const std::string& column) const;
  /// The same as a number.
  /// @throws InvalidInput naming line, column and value when it is no finite number
  [[nodiscard]] std::optional<double> number(const Row& row, const std::string& column) const;
};

/// Parses RFC 4180 fields (quotes, doubled quotes; no line breaks inside fields).
/// @throws InvalidInput for open quotes and rows whose number of fields is not the header's, all at
///         once
CsvTable parse_csv(const std::string& text, const std::string& name);
/// The same, rows that are not as the header is left out and told instead of thrown.
CsvTable parse_csv(const std::string& text, const std::string& name,
                   std::vector<Diagnostic>& diagnostics);

}  // namespace gear3k::io
