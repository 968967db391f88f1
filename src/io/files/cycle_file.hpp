#pragma once
// CYCLE.csv.

#include <string>
#include <string_view>

#include "actuator/cycle.hpp"

namespace gear3k::io {

/// Greatest size of a cycle's file.
inline constexpr std::size_t kMostCycleBytes = std::size_t{1} << 30U;

/// Reads a duty cycle: columns time_s, torque_nm and speed_rad_s or angle_rad, other columns are
/// not read; a note "# torque: actuator" turns the sign of the torque, "# torque: load" does not.
/// @throws InvalidInput with every error of the file
actuator::Cycle read_cycle(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
actuator::Cycle parse_cycle(std::string_view text, const std::string& name);

}  // namespace gear3k::io
