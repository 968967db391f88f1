#pragma once
// Lost motion, stiffness and asymmetry from a record of torque and angle with the other shaft
// locked.

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "calibrate/loops/correlated_noise.hpp"

namespace gear3k::calibrate {

/// One measurement on a shaft while the other shaft is locked, in the order of time.
/// Either sign convention; torque, angle or both may be noisy.
struct TorqueAngleRecord {
  std::vector<double> time_s{};   ///< never falling; uneven steps are allowed
  std::vector<double> angle_rad;  ///< unwrapped
  std::vector<double> torque_Nm;
};

struct LoopOptions {
  /// Smallest torque swing that counts as a reversal, as a fraction of the record's torque range.
  double reversal_fraction = 0.15;
  /// A branch that ends short of zero torque by this fraction of its first torque is continued.
  double zero_reach_fraction = 0.01;
  /// A loop whose ends are further apart than this fraction of its lost motion does not close.
  double closing_fraction = 0.2;
  /// A lost motion that changes by more than this fraction at twice the cut-off depends on it; one
  /// whose branches pass zero torque over more than this fraction of it is ambiguous.
  double filter_fraction = 0.05;
  /// Fractions of the loop's smaller filtered peak torque for Loop::travel, each in (0, 1).
  std::vector<double> travel_levels{0.1, 0.25, 0.5, 0.75, 0.9};
};

/// Part of the upper flank whose slope is the stiffness, as fractions of its peak torque.
inline constexpr double kStiffnessFrom = 0.5, kStiffnessTo = 0.9;
/// Cut-off of one pass of the zero-phase filter in units of the loop's frequency; at most a quarter
/// of the sampling frequency.  Both passes halve the amplitude there.
inline constexpr double kCutoffHarmonic = 120.0;
/// Fewest samples of a flank from which scatter or slope are estimated.
inline constexpr std::size_t kFewestFlankSamples = 8;

enum class LoopOutcome {
  kMeasured,
  kPartialBranch,    ///< a branch begins with the record, not after load from the other side
  kZeroNotCrossed,   ///< a branch does not reach zero torque
  kTooFewSamples,    ///< fewer than kFewestFlankSamples between a reversal and zero torque
  kDoesNotClose,     ///< first and last angle differ: creep, slip or a moved sensor
  kZeroAmbiguous,    ///< the torque rests at zero, or passes it more than once, over an angle
  kDependsOnFilter,  ///< zero torque lies where the filter smooths a jump of the angle
  kAtEdge,           ///< zero torque is too near to the dead band's edge for the record to tell it
};

/// In words.
std::string_view loop_outcome_text(LoopOutcome outcome);

/// What would make it kMeasured; empty for that.
std::string_view loop_outcome_remedy(LoopOutcome outcome);

/// Slope of a loading flank.
struct FlankStiffness {
  double stiffness_Nm_rad = 0.0;  ///< positive
  double standard_deviation_Nm_rad = 0.0;
  std::size_t first_sample = 0, last_sample = 0;
};

/// Flanks as for the stiffness: a pair's own, or where that is not loaded the one before it, then
/// without the levels at which a branch that began with the record lies inside the loop.
struct TravelAtTorque {
  double torque_Nm = 0.0;  ///< T > 0
  double angle_rad = 0.0;  ///< from -T on the falling flank to +T on the rising flank
  /// Where the flanks pass -T and +T, in samples of the record, between two of them.
  double fall_sample = 0.0, rise_sample = 0.0;
};

/// A falling branch and the rising branch next to it.
///
/// Lost motion and angles at zero torque are set for kMeasured, kDoesNotClose, kZeroAmbiguous,
/// kDependsOnFilter and kAtEdge and 0 otherwise; only kMeasured is to be trusted.
struct Loop {
  LoopOutcome outcome = LoopOutcome::kMeasured;
  bool falling_first = true;
  std::size_t first_sample = 0, reversal_sample = 0, last_sample = 0;
  double lowest_torque_Nm = 0.0, highest_torque_Nm = 0.0;            ///< filtered
  double falling_zero_angle_rad = 0.0, rising_zero_angle_rad = 0.0;  ///< at zero torque
  /// Where the branches pass zero torque, in samples of the record, between two of them.
  double falling_zero_sample = 0.0, rising_zero_sample = 0.0;
  /// Angle of the falling less that of the rising branch, both at zero torque; positive where the
  /// loop dissipates, whatever the sign of the angle.
  double lost_motion_rad = 0.0;
  double lost_motion_sd_rad = 0.0;            ///< one standard deviation
  double extrapolated_torque_Nm = 0.0;        ///< by which a branch ended short of zero
  double change_at_double_cutoff_rad = 0.0;   ///< of the lost motion, as far as it is filtered
  std::optional<double> closing_error_rad{};  ///< last less first angle, at the same torque
  std::optional<FlankStiffness> stiffness_positive{}, stiffness_negative{};
  std::optional<double> asymmetry{};  ///< (k₊ - k₋)/((k₊ + k₋)/2)
  std::vector<TravelAtTorque> travel{};
};

/// Common drift of the branches' angles at zero torque; it stays in the angles.
struct Creep {
  double rad_s = 0.0;
  double standard_deviation_rad_s = 0.0;
};

enum class RecordOutcome {
  kLoops,           ///< there are loops, each with an outcome of its own
  kTooFewSamples,   ///< fewer than the filter needs
  kTooFewReversals  ///< the torque never turns
};

/// In words.
std::string_view record_outcome_text(RecordOutcome outcome);

/// What would make it kLoops; empty for that.
std::string_view record_outcome_remedy(RecordOutcome outcome);

struct LoopAnalysis {
  RecordOutcome outcome = RecordOutcome::kLoops;
  double cutoff_per_sample = 0.0;  ///< of one pass, in cycles per sample
  double cutoff_Hz = 0.0;          ///< the same at the median time step; 0 where that is 0
  int angle_sense = 1;             ///< -1: the angle falls where the torque rises
  /// Of the angle on all loading flanks [rad²], that of the torque turned into angle; variance 0
  /// where none has enough samples.
  CorrelatedNoise flank_noise{};
  std::optional<Creep> creep{};  ///< empty where no loop closes and no branch repeats
  std::vector<Loop> loops{};     ///< of neighbouring branches: each branch may be in two of them
};

/// Finds the torque reversals, filters, and measures each pair of a falling and a rising branch.
///
/// The filter works on the index of the samples, not on time: torque and angle are filtered alike,
/// so that a straight flank stays on its own line however unevenly it was sampled, and the noise of
/// neighbouring samples stays independent (resampling would correlate it).
/// Lost motion as in the low-backlash paper, section V.A: difference of the two angles where the
/// filtered torque is zero, or zeros_before_jumps() where the dead band's jump is too near for the
/// filter.  Includes the hysteresis of friction.
/// Not seen: a dead band that the torque crosses without friction (both branches then agree at
/// zero torque; see Loop::travel), and noise slower than the filter.
/// Source: docs/theory §31.
/// @throws std::invalid_argument when the columns differ in length, a value is not finite, time
/// runs backwards, or an option is out of its range
LoopAnalysis analyse_loops(const TorqueAngleRecord& record, const LoopOptions& options = {});

}  // namespace gear3k::calibrate
