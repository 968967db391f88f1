#include "sweep/rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/text/json.hpp"
#include "report/text_table.hpp"

namespace gear3k::sweep {

namespace {

std::string shown(const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{:.6g}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) {
    // A message of several lines stands in one.
    std::string line = *text;
    std::ranges::replace(line, '\n', ' ');
    return line;
  }
  return "-";
}

io::Json json_of(const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return *integer;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return nullptr;
}

}  // namespace

std::string text_of(const SqlValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
  if (const auto* number = std::get_if<double>(&value)) return report::exact(*number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return "";
}

Rows rows_of(Statement& statement) {
  Rows rows;
  for (int k = 0; k < statement.columns(); ++k) rows.names.push_back(statement.name(k));
  while (statement.step()) {
    rows.rows.emplace_back();
    for (int k = 0; k < statement.columns(); ++k) {
      rows.rows.back().push_back(statement.value(k));
    }
  }
  return rows;
}

std::string rows_table(const Rows& rows) {
  if (rows.rows.size() == 1 && rows.rows.front().size() == 1) {
    std::string text = text_of(rows.rows.front().front());
    if (text.empty() || text.back() != '\n') text += '\n';
    return text;
  }
  report::TextTable table(rows.names);
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    const bool texts = std::ranges::any_of(rows.rows, [&](const std::vector<SqlValue>& row) {
      return std::holds_alternative<std::string>(row[k]);
    });
    if (texts) table.align_left(k);
  }
  for (const std::vector<SqlValue>& row : rows.rows) {
    std::vector<std::string> cells(row.size());
    std::ranges::transform(row, cells.begin(), shown);
    table.add(std::move(cells));
  }
  return table.text(0);
}

std::string rows_csv(const Rows& rows) {
  std::string text = report::csv_line(rows.names);
  for (const std::vector<SqlValue>& row : rows.rows) {
    std::vector<std::string> fields(row.size());
    std::ranges::transform(row, fields.begin(), text_of);
    text += report::csv_line(fields);
  }
  return text;
}

std::string rows_json(const Rows& rows) {
  io::Json list = io::Json::array();
  std::vector<std::string> names;
  for (const std::string& name : rows.names) {
    const auto is_taken = [&](const std::string& n) {
      return std::ranges::find(names, n) != names.end();
    };
    std::string own = name;
    for (int k = 1; is_taken(own); ++k) own = fmt::format("{}:{}", name, k);
    names.push_back(std::move(own));
  }
  for (const std::vector<SqlValue>& row : rows.rows) {
    io::Json object = io::Json::object();
    for (std::size_t k = 0; k < row.size(); ++k) object[names[k]] = json_of(row[k]);
    list.push_back(std::move(object));
  }
  return list.text();
}

}  // namespace gear3k::sweep
