#include "train/axial_layout.hpp"

#include <algorithm>

namespace gear3k::train {

std::optional<AxialInterval> whole_extent(const AxialLayout& layout) {
  std::optional<AxialInterval> whole;
  for (const std::optional<AxialInterval>& body : layout.extent) {
    if (!body) continue;
    if (!whole) whole = body;
    whole->from_m = std::min(whole->from_m, body->from_m);
    whole->to_m = std::max(whole->to_m, body->to_m);
  }
  return whole;
}

std::vector<int> overlapping_bodies(const AxialLayout& layout) {
  std::vector<int> pairs;
  for (int i = 0; i < static_cast<int>(kPassingBodies.size()); ++i) {
    const BodyPair pair = kPassingBodies[static_cast<std::size_t>(i)];
    const auto& a = layout.extent[static_cast<std::size_t>(pair.first)];
    const auto& b = layout.extent[static_cast<std::size_t>(pair.second)];
    if (a && b && a->from_m < b->to_m && b->from_m < a->to_m) pairs.push_back(i);
  }
  return pairs;
}

template <class T>
T passing_gap(const TrainGeometry<T>& train, const AxialLayout& layout, int pair) {
  const auto [first, second] = kPassingBodies[static_cast<std::size_t>(pair)];
  const T& tip2 = train.gears[static_cast<std::size_t>(second)].tip_radius_m;
  if (first == kCarrier) return tip2 - layout.carrier_radius_m;
  const T& tip1 = train.gears[static_cast<std::size_t>(first)].tip_radius_m;
  const T& d = train.center_distance_m;
  return kind_of(second) == geometry::GearKind::kRing ? T(tip2 - d - tip1) : T(d - tip1 - tip2);
}

#define INSTANTIATE(T) template T passing_gap<T>(const TrainGeometry<T>&, const AxialLayout&, int);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::train
