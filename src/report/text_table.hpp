#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gear3k::report {

/// A table for the terminal: first column left-aligned, the others right-aligned unless said
/// otherwise, two spaces between columns.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) { add(std::move(header)); }
  /// Cells printable().
  void add(std::vector<std::string> row);
  /// Left-aligns a column.
  void align_left(std::size_t column) { left_.push_back(column); }
  /// @param indent  spaces before each line
  [[nodiscard]] std::string text(std::size_t indent) const;

 private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> left_{0};
};

/// One CSV line (RFC 4180: fields with a comma or quote are quoted), with line end; fields
/// printable().
///
/// Names come from users' files, and spreadsheets run a field that begins with = + - @ as a
/// formula: what begins so and is no number gets an apostrophe before it.  Source: OWASP
/// ASVS 5.0, 1.2.10 (tab and NUL, which it names too, are escaped by printable()); CWE-1236.
std::string csv_line(const std::vector<std::string>& fields);

/// A number in full precision for files: shortest text that reads back as the same double; "" for
/// NaN and infinities.
std::string exact(double value);

/// A number and its unit, if it has one.
std::string with_unit(const std::string& number, std::string_view unit);

}  // namespace gear3k::report
