#include "io/files/table_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "io/text/diagnostics.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

TableColumns::TableColumns(std::vector<std::vector<std::string>> choices) {
  for (std::vector<std::string>& names : choices) {
    std::vector<Column>& columns = choices_.emplace_back();
    for (std::string& name : names) columns.push_back({.name = std::move(name)});
  }
}

void TableColumns::read(const CsvFields& header, const ColumnComplaint& complain) {
  width_ = header.values().size();
  if (const auto slip = wrong_separator(width_, header.values()[0]); !slip.empty()) {
    complain(1, std::string(slip));
    return;
  }
  std::vector<std::string> unknown;
  for (std::size_t k = 0; k < width_; ++k) {
    const std::string_view field = trimmed(header.values()[k]);
    Column* known = nullptr;
    for (std::vector<Column>& columns : choices_) {
      const auto found = std::ranges::find(columns, field, &Column::name);
      if (found != columns.end()) known = &*found;
    }
    if (known == nullptr) {
      unknown.emplace_back(field);
    } else if (known->place) {
      complain(header.column(k),
               fmt::format("column {} stands twice, first as column {}", field, *known->place + 1));
    } else {
      known->place = k;
    }
  }
  for (std::size_t choice = 0; choice < choices_.size(); ++choice) {
    std::vector<Column> stated;
    std::ranges::copy_if(choices_[choice], std::back_inserter(stated),
                         [](const Column& column) { return column.place.has_value(); });
    if (stated.empty()) complain_missing(choice, unknown, complain);
    if (stated.size() < 2) continue;
    complain(header.column(*stated[1].place), fmt::format("columns {} and {}: allowed: one of them",
                                                          stated[0].name, stated[1].name));
  }
}

void TableColumns::complain_missing(std::size_t choice, const std::vector<std::string>& unknown,
                                    const ColumnComplaint& complain) const {
  std::vector<std::string> names;
  for (const Column& column : choices_[choice]) names.push_back(column.name);
  std::vector<std::string> all;
  for (const std::vector<Column>& columns : choices_) {
    for (const Column& column : columns) all.push_back(column.name);
  }
  std::string hint;
  for (const std::string& word : unknown) {
    const std::string near = closest_word(word, all);
    if (std::ranges::find(names, near) != names.end()) {
      hint = fmt::format("; is column {} it?", word);
    }
  }
  complain(1, fmt::format("column {} is missing: allowed: {}{}", fmt::join(names, " or "),
                          this->names(), hint));
}

const TableColumns::Column& TableColumns::taken(std::size_t choice) const {
  const std::vector<Column>& columns = choices_.at(choice);
  const auto stated =
      std::ranges::find_if(columns, [](const Column& column) { return column.place.has_value(); });
  return stated == columns.end() ? columns.front() : *stated;
}

std::optional<std::size_t> TableColumns::place(std::size_t choice) const {
  return taken(choice).place;
}

const std::string& TableColumns::name(std::size_t choice) const { return taken(choice).name; }

std::string TableColumns::names() const {
  std::string text;
  for (std::size_t choice = 0; choice < choices_.size(); ++choice) {
    std::vector<std::string> names;
    for (const Column& column : choices_[choice]) names.push_back(column.name);
    if (choice > 0) text += choice + 1 < choices_.size() ? ", " : ", and ";
    text += fmt::format("{}", fmt::join(names, " or "));
  }
  return text;
}

double TableColumns::number(const CsvFields& row, std::size_t choice,
                            const ColumnComplaint& complain) const {
  std::optional<double> first;
  for (const Column& column : choices_.at(choice)) {
    if (!column.place) continue;
    const std::string_view field = trimmed(row.values()[*column.place]);
    auto value = csv_number(field);
    if (!value || !(std::abs(*value) <= kGreatestInTable)) {
      complain(row.column(*column.place),
               fmt::format("{} = \"{}\": allowed: a number from {:g} to {:g}", column.name, field,
                           -kGreatestInTable, kGreatestInTable));
      value = std::nan("");
    }
    if (!first) first = value;
  }
  return first.value_or(std::nan(""));
}

void TorqueNote::read(std::string_view line, const ColumnComplaint& complain) {
  const auto note =
      notes_.read(line, 0, [&](std::string message) { complain(1, std::move(message)); });
  if (!note) return;
  const std::string& value = note->word;
  whose_ = value;
  if (value == "actuator" || value == "load") return;
  complain(1, fmt::format("# torque: {}: allowed: load (of the load on the output), actuator (of "
                          "the actuator on the load)",
                          value));
}

}  // namespace gear3k::io
