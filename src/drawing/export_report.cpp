#include "drawing/export_report.hpp"

#include <fmt/format.h>

#include "io/text/json.hpp"
#include "report/display.hpp"
#include "report/text_table.hpp"

namespace gear3k::drawing {

using report::TextTable, report::csv_line, report::tool_json, report::um;

std::string export_table(const ExportSummary& summary) {
  TextTable table({"file", "shows", "contours", "points"});
  table.align_left(1);
  for (const ExportedFile& file : summary.files) {
    table.add({file.path, file.drawing, fmt::format("{}", file.contours),
               fmt::format("{}", file.points)});
  }
  return fmt::format("{}: {} files, chords within {:g} um of the contours\n{}", summary.name,
                     summary.files.size(), um(summary.chord_error_m), table.text(2));
}

std::string export_json(const ExportSummary& summary) {
  io::Json files = io::Json::array();
  for (const ExportedFile& file : summary.files) {
    files.push_back({{"path", file.path},
                     {"drawing", file.drawing},
                     {"format", file.format},
                     {"contours", file.contours},
                     {"points", file.points}});
  }
  const io::Json json{{"tool", tool_json()},
                      {"name", summary.name},
                      {"chord_error_um", um(summary.chord_error_m)},
                      {"files", files},
                      {"notes", summary.notes}};
  // A path may hold any bytes.
  return json.text();
}

std::string export_csv(const ExportSummary& summary) {
  std::string text = csv_line({"path", "drawing", "format", "contours", "points"});
  for (const ExportedFile& file : summary.files) {
    text += csv_line({file.path, file.drawing, file.format, fmt::format("{}", file.contours),
                      fmt::format("{}", file.points)});
  }
  return text;
}

}  // namespace gear3k::drawing
