#pragma once
// The files that [actuator] and [cycle] of a SPEC name.

#include <memory>
#include <string>

#include "actuator/co_design.hpp"
#include "io/keys/co_design_keys.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

/// Motors, drive, load and cycles of a SPEC.
/// @param file  the SPEC, from whose folder paths are seen
/// @throws InvalidInput with every error of the files
std::shared_ptr<const actuator::CoDesign> read_co_design(const CoDesignInput& input,
                                                         const std::string& file);

/// What the objective cycle_energy cannot be had with.
void check_cycle_energy(const optimize::Specification& spec, FileReading& reading);

}  // namespace gear3k::io
