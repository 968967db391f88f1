#include "drawing/export_report.hpp"

#include <fmt/format.h>

#include "io/text/json.hpp"
#include "io/text/printable.hpp"
#include "report/display.hpp"
#include "report/fields.hpp"
#include "report/text_table.hpp"

namespace gear3k::drawing {

using report::Fields, report::TextTable, report::list_json, report::tool_json, report::um;

namespace {

/// A file: an item of the JSON, a line of the CSV.
Fields file_fields(const ExportedFile& file) {
  Fields f;
  f.add("path", file.path, {"path"});
  f.add("drawing", file.drawing, {"drawing"});
  f.add("format", file.format, {"format"});
  f.add("contours", file.contours, {"contours"});
  f.add("points", file.points, {"points"});
  return f;
}

}  // namespace

std::string export_table(const ExportSummary& summary) {
  TextTable table({"file", "shows", "contours", "points"});
  table.align_left(1);
  for (const ExportedFile& file : summary.files) {
    table.add({file.path, file.drawing, fmt::format("{}", file.contours),
               fmt::format("{}", file.points)});
  }
  return fmt::format("{}: {} files, chords within {:g} um of the contours\n{}",
                     io::printable(summary.name), summary.files.size(), um(summary.chord_error_m),
                     table.text(2));
}

std::string export_json(const ExportSummary& summary) {
  const io::Json json{
      {"tool", tool_json()},
      {"name", summary.name},
      {"chord_error_um", um(summary.chord_error_m)},
      {"files",
       list_json(summary.files, [](const ExportedFile& file) { return file_fields(file).json(); })},
      {"notes", summary.notes}};
  return json.text();
}

std::string export_csv(const ExportSummary& summary) {
  std::string text = file_fields({}).csv_header();
  for (const ExportedFile& file : summary.files) text += file_fields(file).csv_values();
  return text;
}

}  // namespace gear3k::drawing
