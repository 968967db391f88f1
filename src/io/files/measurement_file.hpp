#pragma once
// DATA.csv: measurements of gearboxes and gear pairs, read strictly.

#include <string>
#include <vector>

#include "calibrate/measurement/measurement.hpp"
#include "io/text/file_set.hpp"

namespace gear3k::io {

/// A record of torque and angle over time, sample by sample in the order of the file.
struct TorqueAngleFile {
  std::string path;
  bool sun_locked = true;  ///< note `# locked:` sun: measured at the output; output: at the sun
  std::vector<double> time_s, angle_rad, torque_Nm;
  std::vector<std::string> run;  ///< label of each sample; empty without the column
};

struct Measurements {
  /// One per kind that the files hold, in the order of Kind.  That of torque_angle has no rows:
  /// its files, notes and fingerprint go with `loops`.
  std::vector<calibrate::MeasurementSet> sets;
  std::vector<TorqueAngleFile> loops;
};

/// Reads measurement files; those of one kind are pooled.
///
/// Sessions: labels of the column `run` are those of one file; equal labels of several files are
/// one session only where the files carry the note `# runs: shared`.  A file without the column is
/// a session of its own when there are several files of its kind.
///
/// Left out, and named in MeasurementSet::notes with file and lines:
///   - rows without a required value (more than 20 % of a file's rows: an error);
///   - copies of a row, all columns equal, the first one stays, where a column or a fine reading
///     tells copies from repeats (leave_out_copies(); others are kept and counted in a note); in
///     another file, where time_s is stated and every named column but the run is equal;
///   - transmission: rows at a limit of the sensor, that is the greatest or the least sun torque of
///     a file, repeated exactly in five rows or more whose loads differ by more than 5 % and by
///     more than the sensor's resolution can hide (more than half of a file's rows: an error).
/// Units: a note `# unit: NAME` says on which gearbox of a series a file was measured; all files of
/// a kind state one (torque_angle and lost_motion together) or none: MeasurementSet::units. Columns
/// that the kind does not name become covariates when they hold numbers.
///
/// time_s must not go back within a run (torque_angle: must increase), except where rows are
/// plainly not in the order of time (more than one step in ten goes back): noted, as the time of a
/// row does not depend on its place.
/// @throws InvalidInput with all errors of all files, at most 50 of a file
Measurements read_measurements(const std::vector<std::string>& paths);
/// The same from texts; `path` stands for the file in messages.
Measurements parse_measurements(const std::vector<FileText>& files);

}  // namespace gear3k::io
