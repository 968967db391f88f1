#pragma once
// What `export` prints: the files that it wrote.

#include <string>
#include <vector>

#include "drawing/drawing.hpp"

namespace gear3k::drawing {

struct ExportedFile {
  std::string path;
  std::string drawing;  ///< S, P1, R1, P2, R2, train
  std::string format;   ///< dxf, svg
  std::size_t contours = 0, points = 0;
};

struct ExportSummary {
  std::string name;  ///< of the design
  double chord_error_m = 0.0;
  std::vector<ExportedFile> files;
  std::vector<std::string> notes;
};

std::string export_table(const ExportSummary& summary);
/// { "tool", "name", "chord_error_um", "files": [ {"path","drawing","format","contours","points"}
/// ],
///   "notes": [...] }
std::string export_json(const ExportSummary& summary);
/// Columns path, drawing, format, contours, points.
std::string export_csv(const ExportSummary& summary);

}  // namespace gear3k::drawing
