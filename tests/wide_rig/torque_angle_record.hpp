#pragma once

#include <string>
#include <vector>

#include "tests/rig/deterministic_random.hpp"
#include "tests/wide_rig/bench_row.hpp"
#include "tests/wide_rig/bench_subject.hpp"

namespace gear3k::wide_rig {

/// How a torque-angle record is taken: the torque rises and falls between two peaks while the
/// angle is read; the play is crossed within a narrow band of torque, later than at zero by what
/// friction holds.
struct LoopBench {
  bool at_sun = false;  ///< output locked, measured at the sun
  int loops = 4;
  int samples_per_loop = 200;
  double peak_Nm = 20.0;        ///< at the output
  double friction_Nm = 0.4;     ///< at the output
  double crossing_Nm = 0.15;    ///< half width of the band of torque in which the play is crossed
  double crossing_share = 0.3;  ///< of the time of a half loop
  double sample_s = 0.05;
  double angle_noise_arcmin = 0.05;
  double torque_noise_Nm = 0.01;
};

LoopBench random_loop_bench(int loops, double lost_motion_arcmin, rig::DeterministicRandom& random);

/// What the loops show: per loop a row at test torque 0 and six at shares of the peak.
std::vector<BenchRow> loop_conditions(const LoopBench& bench, int sessions);

/// The record as CSV, `# kind: torque_angle`; with `locked: output` angle and torque at the sun.
std::string loop_record(const LoopBench& bench, const BenchSubject& subject,
                        const std::vector<AppliedEffect>& effects, int sessions,
                        rig::DeterministicRandom& random);

}  // namespace gear3k::wide_rig
