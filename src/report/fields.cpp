#include "report/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>

#include "report/text_table.hpp"

namespace gear3k::report {

namespace {

/// A value as a field of a CSV.
std::string cell_of(const io::Json& json, const char* yes, const char* no) {
  return std::visit(
      [&](const auto& value) -> std::string {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, bool>) {
          return value ? yes : no;
        } else if constexpr (std::is_same_v<T, double>) {
          return exact(value);
        } else if constexpr (std::is_integral_v<T>) {
          return fmt::format("{}", value);
        } else if constexpr (std::is_same_v<T, std::string>) {
          return value;
        } else {
          return "";
        }
      },
      json.value());
}

bool is_nothing(const io::Json& json) {
  const auto* number = std::get_if<double>(&json.value());
  return json.is_null() || (number != nullptr && !std::isfinite(*number));
}

}  // namespace

void Fields::add(std::string_view key, io::Json value, CsvRow row) {
  add_row(value, std::move(row));
  add(key, std::move(value));
}

void Fields::add_row(io::Json value, CsvRow row) {
  if (row.item.empty()) row.item = item_;
  rows_.push_back({.text = std::move(row), .value = std::move(value)});
}

void Fields::add(std::string_view key, Fields part) {
  add(key, std::move(part.json_));
  take_rows(std::move(part.rows_));
}

void Fields::append(std::string_view key, io::Json value, CsvRow row) {
  add_row(value, std::move(row));
  json_[key].push_back(std::move(value));
}

void Fields::append(std::string_view key, Fields part) {
  json_[key].push_back(std::move(part.json_));
  take_rows(std::move(part.rows_));
}

void Fields::join(Fields part) {
  json_.update(part.json_);
  take_rows(std::move(part.rows_));
}

Fields Fields::at_rank(int rank) && {
  std::ranges::stable_sort(rows_, {}, [](const Row& row) { return row.text.rank; });
  for (Row& row : rows_) row.text.rank = rank;
  return std::move(*this);
}

std::vector<const Fields::Row*> Fields::by_rank() const {
  std::vector<const Row*> rows;
  rows.reserve(rows_.size());
  for (const Row& row : rows_) rows.push_back(&row);
  std::ranges::stable_sort(rows, {}, [](const Row* row) { return row->text.rank; });
  return rows;
}

void Fields::take_rows(std::vector<Row> rows) {
  rows_.insert(rows_.end(), std::make_move_iterator(rows.begin()),
               std::make_move_iterator(rows.end()));
}

std::string Fields::csv_rows() const {
  std::string text;
  for (const Row* row : by_rank()) {
    const CsvRow& t = row->text;
    if (t.limit.empty() && is_nothing(row->value)) continue;
    text += csv_line({t.item, t.quantity, cell_of(row->value, "1", "0"), t.unit, t.limit, t.ok});
  }
  return text;
}

std::vector<FieldRow> Fields::rows() const {
  std::vector<FieldRow> rows;
  for (const Row* row : by_rank()) {
    if (is_nothing(row->value)) continue;
    const CsvRow& t = row->text;
    rows.push_back({.item = t.item, .quantity = t.quantity, .unit = t.unit, .value = row->value});
  }
  return rows;
}

std::string Fields::csv_header() const {
  std::vector<std::string> names;
  for (const Row* row : by_rank()) names.push_back(row->text.quantity);
  return csv_line(names);
}

std::string Fields::csv_values() const {
  std::vector<std::string> cells;
  for (const Row* row : by_rank()) cells.push_back(cell_of(row->value, "true", "false"));
  return csv_line(cells);
}

}  // namespace gear3k::report
