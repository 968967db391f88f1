#pragma once
// The loops of a torque-angle record that became rows of lost motion.

#include <optional>
#include <string>
#include <vector>

#include "calibrate/loops/torque_angle_loop.hpp"

namespace gear3k::calibrate {

/// A loop of a session.
struct SessionLoop {
  int number = 1;  ///< among all loops of the session
  Loop loop;
};

/// What a torque-angle record shows beside its rows of lost motion.  All at the output: what was
/// measured at the sun is referred to it, θ/|i|, T|i| and so k i².
struct LoopSession {
  int file = 0;            ///< of the set of data
  std::string run{};       ///< label; "" = the file is one session
  bool sun_locked = true;  ///< measured at the output; false: output locked, at the sun
  double cutoff_Hz = 0.0;  ///< of the filter, as LoopAnalysis
  std::optional<Creep> creep{};
  std::vector<SessionLoop> loops{};  ///< those that were used
};

}  // namespace gear3k::calibrate
