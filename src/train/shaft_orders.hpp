#pragma once
// Orders that the bodies of a 3K train leave in what varies over the output's angle.

#include <string>
#include <vector>

#include "train/tooth_set.hpp"

namespace gear3k::train {

struct ShaftOrder {
  std::string body;  ///< "sun", "planet", "carrier", "output"; of mesh orders "stage 1", "stage 2"
  double order;      ///< per revolution of the output
  bool rolling = false;  ///< relative to the carrier; that of the fixed ring is the carrier's own
};

/// Revolutions of the bodies per revolution of the output, relative to the carrier and absolute.
std::vector<ShaftOrder> shaft_orders(const ToothSet& z);

/// Teeth of the two stages that mesh per revolution of the output.
std::vector<ShaftOrder> mesh_orders(const ToothSet& z);

}  // namespace gear3k::train
