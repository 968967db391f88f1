#pragma once
// The files that [actuator] and [cycle] of a SPEC name.

#include <memory>
#include <string>
#include <vector>

#include "actuator/co_design.hpp"
#include "io/keys/co_design_keys.hpp"
#include "io/keys/key_registry.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

/// Motors, drive, load and cycles of a SPEC.
/// @param file  the SPEC, from whose folder paths are seen
/// @param reading  of it, for the places of its keys
/// @param notes  gets what of the motor's file is not read
/// @throws InvalidInput with every error of the files
std::shared_ptr<const actuator::CoDesign> read_co_design(const CoDesignInput& input,
                                                         const std::string& file,
                                                         const FileReading& reading,
                                                         std::vector<std::string>& notes);

/// The motor of the input with the limits of what is felt; another one of a co-design that has it
/// alone.
/// @param notes  gets what of the motor's file is not read
/// @throws InvalidInput with every error of the motor's file
optimize::FeltTask read_felt(const CoDesignInput& input, const std::string& file,
                             const FileReading& reading, std::vector<std::string>& notes);
/// The same for the only motor of a co-design.
optimize::FeltTask felt_of(const CoDesignInput& input, const actuator::Motor& motor,
                           std::vector<std::string> sources);

/// What the objective cycle_energy cannot be had with.
void check_cycle_energy(const optimize::Specification& spec, FileReading& reading);

/// What limits of what is felt cannot be had with.
void check_felt_task(const optimize::Specification& spec, FileReading& reading);

}  // namespace gear3k::io
