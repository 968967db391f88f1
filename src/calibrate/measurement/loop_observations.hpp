#pragma once
// Torque-angle records as lost motion under test torques.

#include <string>
#include <vector>

#include "calibrate/loops/torque_angle_loop.hpp"
#include "calibrate/measurement/loop_reading.hpp"
#include "calibrate/measurement/measurement.hpp"

namespace gear3k::calibrate {

/// A record of one file, sample by sample in the order of the file.
struct LockedShaftRecord {
  TorqueAngleRecord samples;
  std::vector<std::string> run{};  ///< label of each sample; empty: one session
  bool sun_locked = true;          ///< measured at the output; false: output locked, at the sun
  int file = 0;                    ///< of the set of data
  std::string name{};              ///< of the file, for notes and as a label of its session
};

struct LoopObservations {
  std::vector<std::string> runs;  ///< labels, in order of first appearance
  /// Lost motion at the output; Observation::line is the sample of the record, from 1, at which the
  /// loop begins.
  std::vector<Observation> rows;
  std::vector<std::string> notes;
  std::vector<std::string> remedies{};  ///< what would make loops of what was refused
  std::vector<LoopSession> sessions;    ///< those with loops that were used
  int measured = 0;                     ///< loops used
  int refused = 0;                      ///< loops found and not used, and runs without any
  double record_start_s = kUnknown;     ///< when the first record with such loops begins
};

/// Each loop as rows of lost motion at the output: one at test torque 0, the angle between the
/// branches at zero torque, and the travel between -T and +T on the loading flanks at a few
/// torques.
///
/// Measured at the sun (output locked), angle and torque are referred to the output: θ/|i|, T|i|.
/// Friction torque T_f widens the loop at zero torque and holds the loading flanks back:
///
///   θ(0) = b + T_f c,   travel(T) = b + (T - T_f) c,   c = 1/k₊ + 1/k₋
///
/// with straight flanks; friction_shares() takes what it opens from the first and adds what it
/// takes off to the second, for flanks that may curve, of the loops measured at the same shaft: b +
/// c T is what the gearbox gives without friction, which the lost motion of the design leaves out.
/// Notes say how much.
///
/// The time of a row is the mean of the two at which its branches pass the torque: what drifts
/// within a loop would else look like compliance.  One loop alone has one time: within it nothing
/// tells a drift from what goes with the torque.
/// A record without runs is a session of its own when there are several.
/// Loops that share a branch are not independent: of those, every second one is used.  Sigma is
/// that of the noise at zero torque and in the mean over each travel's band, without that of the
/// friction, which all rows share; scatter is 1 for travels and the ratio of the two sigmas
/// (medians of the session's loops, 1/3 to 3; 1 where one is not known) at zero torque: sessions
/// weigh alike whatever their sampling rate, as noise slower than the filter, which all rows of a
/// loop share, is in no sigma. Source: own derivation; branches as in docs/theory §31.
/// @throws std::invalid_argument when the ratio is not finite or 0, or as analyse_loops()
LoopObservations loop_observations(const std::vector<LockedShaftRecord>& records, double ratio);

/// Adds rows of loops to data of lost motion, or to a set of torque_angle that has none.  Rows of
/// files without sessions become sessions named after their files.  Their sigma is kept where the
/// set's rows have one, and of a single loop: several loops are repeats, which say more.  The
/// sessions go along; those without a row are left out.
/// @param file_offset  of the loops' files in set.files
void add_loops(MeasurementSet& set, const LoopObservations& loops, int file_offset);

}  // namespace gear3k::calibrate
