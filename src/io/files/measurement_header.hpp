#pragma once
// The header of a measurement file: which columns stand where.

#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "io/files/measurement_columns.hpp"
#include "io/text/complaints.hpp"

namespace gear3k::io {

struct HeaderColumn {
  std::string name;
  int place = 0;                              ///< where it begins in the line, from 1
  const MeasurementColumn* column = nullptr;  ///< null: a column that the kind does not name
};

struct MeasurementHeader {
  int line = 0;  ///< 0: the file has none
  std::vector<HeaderColumn> columns;
};

/// The first line that is no note, with its names as they stand there.
MeasurementHeader read_header(std::string_view text, Complaints& complaints);

/// Finds the columns that a kind names, and complains about those that are missing or misspelt.
void match_header(MeasurementHeader& header, calibrate::Kind kind, Complaints& complaints);

/// "columns a, b, and optionally c, d"
std::string column_list(calibrate::Kind kind);

}  // namespace gear3k::io
