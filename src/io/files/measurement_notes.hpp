#pragma once
// What the lines of a measurement file that begin with '#' say.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "io/files/header_notes.hpp"
#include "io/text/complaints.hpp"

namespace gear3k::io {

struct MeasurementNotes {
  std::optional<calibrate::Kind> kind;
  std::optional<bool> sun_locked;
  bool reference_sensor = false, runs_shared = false;

  bool kind_stated = false;  ///< well or not
  int locked_line = 0;       ///< of the note `# locked:`; 0: none
  std::string unit;          ///< gearbox of a series that was measured; "": not stated
  int unit_line = 0;         ///< of the note `# unit:`, well or not; 0: none
  HeaderNotes header{{"kind", "locked", "sensor", "runs", "unit"}};
};

MeasurementNotes read_notes(std::string_view text, Complaints& complaints);

/// The notes that a kind takes.
KindNotes notes_of(calibrate::Kind kind);

/// Complains where the notes do not say what must be known, and of those that have no part in the
/// kind; of a missing kind the columns of the
/// header may tell.
void check_notes(const MeasurementNotes& notes, const std::vector<std::string>& columns,
                 Complaints& complaints);

}  // namespace gear3k::io
