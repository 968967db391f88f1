#pragma once
// One measurement file: its notes, header and rows.

#include <string>
#include <string_view>

#include "calibrate/measurement/measurement.hpp"
#include "io/files/measurement_notes.hpp"
#include "io/text/complaints.hpp"

namespace gear3k::io {

struct MeasurementText {
  Complaints complaints;
  MeasurementNotes notes;
  calibrate::MeasurementSet set;  ///< of this file alone, without a fingerprint
  bool has_run = false, has_sigma = false;
};

/// Reads a file's text as read_measurements() states; where there are complaints the set may be
/// incomplete.
/// @param path  stands for the file in notes
MeasurementText read_measurement_text(const std::string& path, std::string_view text);

}  // namespace gear3k::io
