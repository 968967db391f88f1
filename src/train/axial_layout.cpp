#include "train/axial_layout.hpp"

#include <algorithm>

#include "geometry/scalar.hpp"

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

namespace {

/// Where a stage lies: as its planet's step does, its ring or the sun; empty where none is stated.
std::optional<AxialInterval> stated_stage(const AxialLayout& layout, int stage) {
  for (const int gear : {kP1, kR1, kS, kP2, kR2}) {
    const auto& extent = layout.extent[static_cast<std::size_t>(gear)];
    if (stage_of(gear) == stage && extent) return extent;
  }
  return std::nullopt;
}

}  // namespace

bool states_every_gear(const AxialLayout& layout) {
  return std::all_of(layout.extent.begin(), layout.extent.begin() + kGearCount,
                     [](const auto& extent) { return extent.has_value(); });
}

template <class T>
GearPlaces<T> placed_gears(const AxialLayout& layout, const std::array<T, 2>& face_width_m) {
  const std::array stated{stated_stage(layout, 0), stated_stage(layout, 1)};
  std::array<T, 2> from{}, to{};
  from[0] = stated[0] ? T(stated[0]->from_m)
                      : (stated[1] ? T(stated[1]->from_m) - face_width_m[0] : T(0.0));
  to[0] = stated[0] ? T(stated[0]->to_m) : T(from[0] + face_width_m[0]);
  from[1] = stated[1] ? T(stated[1]->from_m) : to[0];
  to[1] = stated[1] ? T(stated[1]->to_m) : T(from[1] + face_width_m[1]);
  GearPlaces<T> places{};
  for (int gear = 0; gear < kGearCount; ++gear) {
    const auto i = static_cast<std::size_t>(gear);
    if (const auto& extent = layout.extent[i]) {
      places.from_m[i] = T(extent->from_m);
      places.to_m[i] = T(extent->to_m);
      continue;
    }
    const auto k = static_cast<std::size_t>(stage_of(gear));
    const T middle = 0.5 * (from[k] + to[k]);
    places.from_m[i] = middle - 0.5 * face_width_m[k];
    places.to_m[i] = middle + 0.5 * face_width_m[k];
  }
  return places;
}

template <class T>
T whole_length_m(const AxialLayout& layout, const std::array<T, 2>& face_width_m) {
  const GearPlaces<T> places = placed_gears(layout, face_width_m);
  T from = places.from_m[0];
  T to = places.to_m[0];
  const auto take = [&](const T& least, const T& most) {
    from = smaller(from, least);
    to = larger(to, most);
  };
  for (std::size_t i = 1; i < kGearCount; ++i) take(places.from_m[i], places.to_m[i]);
  if (const auto& carrier = layout.extent[kCarrier]) take(T(carrier->from_m), T(carrier->to_m));
  return to - from;
}

std::optional<double> common_length_m(const AxialLayout& layout, int first, int second) {
  const auto& a = layout.extent[static_cast<std::size_t>(first)];
  const auto& b = layout.extent[static_cast<std::size_t>(second)];
  if (!a || !b) return std::nullopt;
  return std::min(a->to_m, b->to_m) - std::max(a->from_m, b->from_m);
}

std::vector<int> overlapping_bodies(const AxialLayout& layout) {
  std::vector<int> pairs;
  for (int i = 0; i < static_cast<int>(kPassingBodies.size()); ++i) {
    const BodyPair pair = kPassingBodies[static_cast<std::size_t>(i)];
    const std::optional<double> common_m = common_length_m(layout, pair.first, pair.second);
    if (common_m && *common_m > 0.0) pairs.push_back(i);
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

#define INSTANTIATE(T)                                                                 \
  template T passing_gap<T>(const TrainGeometry<T>&, const AxialLayout&, int);         \
  template GearPlaces<T> placed_gears<T>(const AxialLayout&, const std::array<T, 2>&); \
  template T whole_length_m<T>(const AxialLayout&, const std::array<T, 2>&);
GEAR3K_FOR_EACH_SCALAR(INSTANTIATE)
#undef INSTANTIATE

}  // namespace gear3k::train
