#include "tests/wide_rig/torque_angle_record.hpp"

#include <algorithm>
#include <cmath>

#include "tests/rig/number_text.hpp"

namespace gear3k::wide_rig {
namespace {

// Loops follow each other in time; a session has its share of them.
BenchRow condition_at(const LoopBench& bench, int sessions, double loop) {
  BenchRow row;
  row.elapsed = std::clamp(loop / bench.loops, 0.0, 1.0);
  row.session = std::clamp(static_cast<int>(loop * sessions / bench.loops), 0, sessions - 1);
  return row;
}

struct LoopPoint {
  double torque_Nm = 0.0;
  double crossed = 0.0;  // -1 to 1: from one flank to the other
};

// The drive turns steadily: loading, then slowly through the play, then loading on the other
// flank. Phase 0 is the negative peak.
LoopPoint point_on_loop(const LoopBench& bench, double phase) {
  const double sense = phase < 0.5 ? 1.0 : -1.0;
  const double half = phase < 0.5 ? 2.0 * phase : 2.0 * phase - 1.0;
  const double loading = 0.5 * (1.0 - bench.crossing_share);
  const double before_Nm = bench.friction_Nm - bench.crossing_Nm;
  const double after_Nm = bench.friction_Nm + bench.crossing_Nm;
  LoopPoint point;
  if (half < loading) {
    point = {-bench.peak_Nm + (bench.peak_Nm + before_Nm) * half / loading, -1.0};
  } else if (half > 1.0 - loading) {
    point = {bench.peak_Nm - (bench.peak_Nm - after_Nm) * (1.0 - half) / loading, 1.0};
  } else {
    const double share = (half - loading) / bench.crossing_share;
    point = {before_Nm + (after_Nm - before_Nm) * share, 2.0 * share - 1.0};
  }
  return {sense * point.torque_Nm, sense * point.crossed};
}

}  // namespace

LoopBench random_loop_bench(int loops, double lost_motion_arcmin,
                            rig::DeterministicRandom& random) {
  LoopBench bench;
  bench.loops = loops;
  bench.at_sun = random.uniform() < 0.3;
  bench.samples_per_loop = 300 + static_cast<int>(random.index(500));
  bench.peak_Nm = random.between(5.0, 40.0);
  bench.friction_Nm = bench.peak_Nm * random.between(0.02, 0.06);
  bench.crossing_Nm = bench.friction_Nm * random.between(0.1, 0.3);
  bench.crossing_share = random.between(0.15, 0.4);
  bench.sample_s = random.between(0.02, 0.2);
  bench.angle_noise_arcmin = lost_motion_arcmin * random.between(0.002, 0.02);
  bench.torque_noise_Nm = bench.peak_Nm * random.between(0.0003, 0.002);
  return bench;
}

std::vector<BenchRow> loop_conditions(const LoopBench& bench, int sessions) {
  std::vector<BenchRow> rows;
  for (int loop = 0; loop < bench.loops; ++loop) {
    for (const double share : {0.0, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}) {
      BenchRow row = condition_at(bench, sessions, loop + 0.5);
      row.test_torque_Nm = share * bench.peak_Nm;
      rows.push_back(row);
    }
  }
  return rows;
}

std::string loop_record(const LoopBench& bench, const BenchSubject& subject,
                        const std::vector<AppliedEffect>& effects, int sessions,
                        rig::DeterministicRandom& random) {
  std::string text = "# kind: torque_angle\n# locked: ";
  text += bench.at_sun ? "output\n" : "sun\n";
  text += sessions > 1 ? "time_s,angle_deg,torque_nm,run\n" : "time_s,angle_deg,torque_nm\n";
  const double ratio = std::fabs(subject.ratio);
  const int samples = bench.loops * bench.samples_per_loop;
  const double pause_s = random.between(60.0, 600.0);
  for (int i = 0; i <= samples; ++i) {
    const double loop = static_cast<double>(i) / bench.samples_per_loop;
    BenchRow row = condition_at(bench, sessions, loop);
    const LoopPoint at = point_on_loop(bench, loop - std::floor(loop));
    const double torque_Nm = at.torque_Nm;
    row.test_torque_Nm = 0.0;
    const double play = lost_motion(subject, row, effects).value;
    row.test_torque_Nm = std::fabs(torque_Nm);
    const double wound = lost_motion(subject, row, effects).value - play;
    const double angle_arcmin = 0.5 * play * at.crossed + std::copysign(0.5 * wound, torque_Nm) +
                                bench.angle_noise_arcmin * random.normal();
    const double read_Nm = torque_Nm + bench.torque_noise_Nm * random.normal();
    const double time_s = i * bench.sample_s + row.session * pause_s;
    text += rig::number_text(time_s, 10) + ',' +
            rig::number_text(angle_arcmin / 60.0 * (bench.at_sun ? ratio : 1.0), 9) + ',' +
            rig::number_text(read_Nm / (bench.at_sun ? ratio : 1.0), 9);
    if (sessions > 1) text += ",s" + std::to_string(row.session + 1);
    text += '\n';
  }
  return text;
}

}  // namespace gear3k::wide_rig
