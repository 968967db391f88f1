#pragma once
// From a design to the gearbox that the rig builds of it, and its campaign in two halves.

#include <array>
#include <string>
#include <vector>

#include "design/design.hpp"
#include "tests/rig/rig.hpp"

namespace gear3k::rig {

/// The rig's gearbox of a design: teeth, shifts, thinning, modules, centre distance and friction.
/// @throws std::invalid_argument for what the rig cannot build: shortened tips, several racks
Gearbox built(const design::Design& design);

/// Efficiency that the rig measures, without noise.
double measured_efficiency(const Gearbox& gearbox, const Condition& condition,
                           const std::vector<HiddenCause>& causes);

/// A campaign's text as two files: every other session in one, the others in the second.
std::array<std::string, 2> halves_by_session(const std::string& csv);

}  // namespace gear3k::rig
