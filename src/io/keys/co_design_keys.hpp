#pragma once
// Keys of SPEC for motors, drive, load and cycles of the objective cycle_energy.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "io/keys/selection_keys.hpp"

namespace gear3k::io {

/// Motors, drive, load and limits are those of a selection, under `actuator.`.
struct CoDesignInput {
  SelectionInput selection;
  std::string motor;  ///< path of an ACTUATOR file
  std::optional<double> max_motor_mass_kg;
  bool known_friction = false;  ///< motors of unknown friction are left out
};

std::vector<Key<CoDesignInput>> co_design_keys();
/// Those of them that name files.
inline constexpr std::array<std::string_view, 3> kCoDesignFileKeys{
    "actuator.motor", "actuator.motors", "cycle.files"};

/// Whether a limit of what is felt is stated.
bool limits_felt(const CoDesignInput& input);

/// What the keys say together, and with the objective.
/// @param wanted  whether the objective asks for them
void check_co_design(const CoDesignInput& input, bool wanted, FileReading& reading);
/// Keys of these tables that are stated and that an objective other than cycle_energy does not
/// read.
std::vector<std::string> unread_co_design(const CoDesignInput& input, const FileReading& reading);

}  // namespace gear3k::io
