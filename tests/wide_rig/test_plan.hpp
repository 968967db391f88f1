#pragma once

#include <string>
#include <vector>

#include "tests/rig/deterministic_random.hpp"
#include "tests/wide_rig/bench_row.hpp"
#include "tests/wide_rig/bench_subject.hpp"

namespace gear3k::wide_rig {

/// The conditions of a campaign, before any effect.
struct TestPlan {
  std::string name{};
  BenchColumns columns{};
  std::vector<BenchRow> rows{}, unseen{}, later{};
  int sessions = 1;
  bool sun_torque_set = false;           ///< the output torque is what was read
  std::vector<double> set_torques_Nm{};  ///< per row, of the sun without effects; else empty
  double turns = 0.0;                    ///< of the output; 0: angles not stated
  std::vector<double> aliased_orders{};  ///< coarse grids: two that these angles do not tell apart
};

/// Plans of a kind:
///
/// transmission: crossed (all conditions independent), by_session (loads, speeds or temperatures
/// of its own in each session), even_angles (an even grid over 0.7 to 3 turns of the output),
/// sun_torque_set, one_turn, one_direction (mostly forward), one_rotation, warming_with_speed,
/// warming_with_time, temperature_by_session, load_by_session, coarse_grid (6 to 48 even angles a
/// turn, at which the teeth of a stage repeat like a shaft), coarse_grid_shafts (like another
/// shaft). lost_motion: crossed, by_session, even_angles, one_turn, one_torque, warming_with_time,
/// temperature_by_session, coarse_grid, coarse_grid_shafts. pair_loss: crossed, by_session,
/// one_sense.   torque_angle: loops.
std::vector<std::string> plans_of(const std::string& kind);

/// @param sessions_wanted least number of sessions, 0: any
/// @throws std::invalid_argument for an unknown plan
TestPlan make_plan(const std::string& kind, const std::string& plan, const BenchSubject& subject,
                   int sessions_wanted, rig::DeterministicRandom& random);

}  // namespace gear3k::wide_rig
