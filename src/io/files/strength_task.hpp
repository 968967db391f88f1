#pragma once
// The load that a file states, from its keys: what is missing, and what does not fit together.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "design/rating_inputs.hpp"
#include "efficiency/friction_law.hpp"
#include "geometry/gear.hpp"
#include "io/keys/strength_keys.hpp"
#include "train/axial_layout.hpp"

namespace gear3k::io {

/// What else of a train its rating reads.
struct RatedTrainFile {
  std::vector<int> planets;
  std::array<std::optional<double>, 2> face_width_m;
  std::optional<double> sun_speed_rad_s;
  train::AxialLayout axial;
  design::Limits limits;
  bool has_pin = false;                       ///< inertia.pin_diameter_mm is stated
  efficiency::Lubricant<double> lubricant{};  ///< of friction; zeros: not stated
};

/// Materials by gear, where the file states them.
/// @param gears  paths of the gears' tables
design::GearMaterials finish_materials(const StrengthInput& input,
                                       const std::vector<std::string>& gears, FileReading& reading);

/// The task of a file with [strength], which design::rating_of() completes; says in `reading` what
/// it lacks and what does not fit together.  @returns empty without [strength]
std::optional<strength::RatingTask> finish_train_strength(const StrengthInput& input,
                                                          const design::GearMaterials& materials,
                                                          const RatedTrainFile& file,
                                                          FileReading& reading);
/// The whole task of a PAIR.
std::optional<strength::RatingTask> finish_pair_strength(const StrengthInput& input,
                                                         const design::GearMaterials& materials,
                                                         FileReading& reading);

/// Refuses rack.root_radius = 0 of rated rings whose roots it fillets: q_s = s_F/(2 ρ_F) of a sharp
/// corner has no bound, and Y_S is stated for 1 ≤ q_s < 8 (IACS UR M56).  External gears are cut by
/// the rack, which rounds their roots though its own corners are sharp.
/// @param cutter_tables  of the rings that no cutter shapes, by whose teeth one would
void check_ring_corners(const geometry::BasicRack<double>& rack,
                        const std::vector<std::string>& cutter_tables,
                        const std::optional<strength::RatingTask>& task, FileReading& reading);

}  // namespace gear3k::io
