#pragma once
// Keys of what gears are made of: [material] of all gears, and the table `material` of a gear.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/keys/key_registry.hpp"
#include "strength/rating_task.hpp"

namespace gear3k::io {

/// A material as the file states it.
struct MaterialInput {
  std::optional<std::string> name;
  std::optional<strength::MaterialGroup> group;
  std::optional<double> hardness, youngs_modulus_Pa, poisson_ratio, flank_limit_Pa, root_limit_Pa,
      density_kgm3, yield_strength_Pa;

  bool operator==(const MaterialInput&) const = default;
};
/// Its keys, without the table's name.
std::vector<Key<MaterialInput>> material_keys();

/// The document with every material that is no table, `material = "POM"`, as { name = "POM" }.
/// @param gears  paths of the gears' tables
TomlValue with_material_tables(TomlValue document, const std::vector<std::string>& gears);

/// The material of a table that the file holds; what is unknown or out of the named row's range is
/// said in `reading`.
/// @param path  of the table
/// @returns empty where no material is known by that name
std::optional<strength::GearMaterial> finish_material(const std::string& path,
                                                      const MaterialInput& input,
                                                      FileReading& reading);

/// Says in `reading` what of a material a rating lacks: elastic constants, a hardness.
void check_rated_material(const std::string& path, const strength::GearMaterial& material,
                          FileReading& reading);

/// What a file states of a material: its row and the numbers that differ from the row's.
MaterialInput stated_material(const strength::GearMaterial& material);

/// Names of the table that are like a name, the likest first; at most three.
std::vector<std::string> similar_materials(const std::string& name);

}  // namespace gear3k::io
