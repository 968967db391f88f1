#pragma once
// Keys of the load that a gearbox or a pair is to carry: [strength], [material], and where a
// planet's bearings stand in [bearings].

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "io/keys/material_keys.hpp"
#include "strength/rating_task.hpp"

namespace gear3k::io {

/// What the keys set.
struct StrengthInput {
  MaterialInput material;                                        ///< of all gears
  std::array<MaterialInput, train::kGearCount> gear_material{};  ///< in its place; of a pair 1, 2
  std::optional<double> torque_Nm;
  /// But materials, torque, and what other keys state.
  strength::RatingTask task;
  std::optional<std::array<double, 2>> planet_position_m;
  std::optional<double> planet_stiffness_N_m, pin_stiffness_N_m;
  // Of a pair.
  std::optional<double> speed_rad_s, face_width_m;
};

/// Of DESIGN and SPEC.
std::vector<Key<StrengthInput>> train_strength_keys();
/// Of PAIR.
std::vector<Key<StrengthInput>> pair_strength_keys();

/// Paths of the gears' tables: "gears.S", ...
std::vector<std::string> train_gear_tables();
/// Of a PAIR: "gear1", "gear2".
std::vector<std::string> pair_gear_tables();

/// What a file states of a train's task.
StrengthInput stated_strength(const std::optional<strength::RatingTask>& task);

}  // namespace gear3k::io
