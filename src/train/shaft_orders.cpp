#include "train/shaft_orders.hpp"

#include <cmath>

namespace gear3k::train {

std::vector<ShaftOrder> shaft_orders(const ToothSet& z) {
  const SpeedRatios w = speed_ratios(z);
  return {{.body = "sun", .order = std::abs(w.sun - w.carrier), .rolling = true},
          {.body = "sun", .order = std::abs(w.sun)},
          {.body = "planet", .order = std::abs(w.planet - w.carrier), .rolling = true},
          {.body = "planet", .order = std::abs(w.planet)},
          {.body = "carrier", .order = std::abs(w.carrier)},
          {.body = "output", .order = std::abs(1.0 - w.carrier), .rolling = true},
          {.body = "output", .order = 1.0}};
}

std::vector<ShaftOrder> mesh_orders(const ToothSet& z) {
  const SpeedRatios w = speed_ratios(z);
  return {{.body = "stage 1", .order = z.R1 * std::abs(w.carrier)},
          {.body = "stage 2", .order = z.R2 * std::abs(1.0 - w.carrier)}};
}

}  // namespace gear3k::train
