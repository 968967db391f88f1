#include "io/files/measurement_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "io/text/csv_table.hpp"
#include "io/text/text_lines.hpp"

namespace gear3k::io {

namespace {

using calibrate::Kind;
using Column = MeasurementColumn;

/// Finds the columns by their names.  @returns those of the kind that are not there
std::vector<const Column*> match_names(std::vector<HeaderColumn>& header, Kind kind) {
  std::vector<const Column*> absent;
  for (const Column& column : columns_of(kind)) {
    const auto at = std::ranges::find(header, column.name, &HeaderColumn::name);
    if (at == header.end()) {
      absent.push_back(&column);
    } else {
      at->column = &column;
    }
  }
  return absent;
}

}  // namespace

std::string column_list(Kind kind) {
  std::vector<std::string_view> required, optional;
  for (const Column& c : columns_of(kind)) {
    (c.required ? required : optional).push_back(c.name);
  }
  return fmt::format("columns {}, and optionally {}", fmt::join(required, ", "),
                     fmt::join(optional, ", "));
}

MeasurementHeader read_header(std::string_view text, Complaints& complaints) {
  MeasurementHeader header;
  CsvFields fields;
  TextLines lines(text);
  while (lines.next()) {
    if (lines.line().empty() || lines.line().starts_with('#')) continue;
    header.line = lines.number();
    if (!fields.split(lines.line())) {
      complaints.add({.line = header.line, .column = 1}, "a quote is left open");
    }
    header.columns.reserve(fields.values().size());
    for (const std::string_view name : fields.values()) {
      header.columns.push_back(
          {.name = std::string(trimmed(name)), .place = fields.column(header.columns.size())});
    }
    break;
  }
  return header;
}

void match_header(MeasurementHeader& found, Kind kind, Complaints& complaints) {
  std::vector<HeaderColumn>& header = found.columns;
  const auto complain = [&](int place, std::string message) {
    complaints.add({.line = found.line, .column = place}, std::move(message));
  };
  const std::vector<const Column*> absent = match_names(header, kind);
  if (!header.empty()) {
    const auto slip = wrong_separator(header.size(), header[0].name);
    if (!slip.empty()) {
      complain(1, std::string(slip));
      return;
    }
  }
  if (absent.size() == columns_of(kind).size() &&
      std::ranges::all_of(header,
                          [](const HeaderColumn& h) { return csv_number(h.name).has_value(); })) {
    complain(1, "a row before the header, allowed: " + column_list(kind));
    return;
  }
  std::vector<const Column*> meant;
  std::unordered_map<std::string_view, std::size_t> first_place;
  for (std::size_t k = 0; k < header.size(); ++k) {
    const std::string& name = header[k].name;
    if (name.empty()) {
      complain(header[k].place, fmt::format("column {} has no name", k + 1));
      continue;
    }
    const auto [first, added] = first_place.emplace(name, k + 1);
    if (!added) {
      complain(header[k].place,
               fmt::format("column {} stands twice, first as column {}", name, first->second));
    }
    if (header[k].column != nullptr) continue;
    const MeantColumn column = meant_column(name, absent);
    if (column.column == nullptr) continue;
    meant.push_back(column.column);
    complain(header[k].place,
             column.other_unit
                 ? fmt::format("column {}: expected {} (the unit is part of the name; other "
                               "units are not converted)",
                               name, column.column->name)
                 : fmt::format("column {}: did you mean {}?", name, column.column->name));
  }
  for (const Column* column : absent) {
    if (column->required && std::ranges::find(meant, column) == meant.end()) {
      complain(1, fmt::format("column {} is missing: {}", column->name, column->allowed_text()));
    }
  }
}

}  // namespace gear3k::io
