#pragma once
// Efficiency over speed and load.

#include <optional>
#include <string>

#include "app/model.hpp"
#include "design/operating_map.hpp"

namespace gear3k::app {

struct MapRequest {
  design::Design design;  ///< its `map` states the grid
  std::optional<Model> model = std::nullopt;
  std::string source = "design";  ///< stands for the design in messages
};

struct Map {
  design::OperatingMap map;
  Notes model_notes;  ///< also among the notes of the map
};

/// Efficiency in both directions over the design's grid, no-load and breakaway torque.
/// @throws io::InvalidInput where the geometry is not defined or a mesh has no contact
Map map(const MapRequest& request);

}  // namespace gear3k::app
