#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gear3k::report {

/// A table for the terminal: first column left-aligned, the others right-aligned unless said
/// otherwise, two spaces between columns.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  /// Left-aligns a column.
  void align_left(std::size_t column) { left_.push_back(column); }
  /// @param indent  spaces before each line
  [[nodiscard]] std::string text(std::size_t indent) const;

 private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> left_{0};
};

/// One CSV line (RFC 4180: fields with a comma, quote or line break are quoted), with line end.
std::string csv_line(const std::vector<std::string>& fields);

/// A number in full precision for files: shortest text that reads back as the same double; "" for
/// NaN and infinities.
std::string exact(double value);

/// A number and its unit, if it has one.
std::string with_unit(const std::string& number, std::string_view unit);

}  // namespace gear3k::report
