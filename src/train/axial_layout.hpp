#pragma once
// Where the bodies of a train lie along the axis, and which of them pass each other.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "train/train_geometry.hpp"

namespace gear3k::train {

/// Bodies: the five gears (GearId), then the carrier.
inline constexpr int kCarrier = kGearCount;
inline constexpr int kBodyCount = kGearCount + 1;
inline constexpr std::array<std::string_view, kBodyCount> kBodyNames{"S",  "P1", "R1",
                                                                     "P2", "R2", "carrier"};

struct AxialInterval {
  double from_m = 0.0, to_m = 0.0;
};

/// Extent of each body along the axis, where it is known.
struct AxialLayout {
  std::array<std::optional<AxialInterval>, kBodyCount> extent;
  double carrier_radius_m = 0.0;  ///< outer radius of the carrier where it passes a ring's bore
};

/// Two bodies that do not mesh but may pass each other radially.
struct BodyPair {
  int first = 0, second = 0;
};
inline constexpr std::array<BodyPair, 5> kPassingBodies{
    {{kP2, kS}, {kP2, kR1}, {kP1, kR2}, {kCarrier, kR1}, {kCarrier, kR2}}};

/// From the first to the last body whose extent is known; empty where none is.
std::optional<AxialInterval> whole_extent(const AxialLayout& layout);

/// Where gears lie along the axis.
template <class T>
struct GearPlaces {
  std::array<T, kGearCount> from_m, to_m;
};

/// Gears as the layout states them; one that it does not state about the middle of its stage, which
/// is that of the planet's step, else of its ring or the sun, and as wide as the stage's faces; a
/// stage of which nothing is stated beside the other.
/// @param face_width_m  of each stage; 0 = not known
template <class T>
GearPlaces<T> placed_gears(const AxialLayout& layout, const std::array<T, 2>& face_width_m);

/// Length from the first to the last body: gears as placed, and the carrier where it is stated.
template <class T>
T whole_length_m(const AxialLayout& layout, const std::array<T, 2>& face_width_m);

/// Whether the layout states where every gear lies, so that no face width moves one.
bool states_every_gear(const AxialLayout& layout);

/// Length that two bodies have in common along the axis, below 0 where they are apart; empty where
/// one of them has no place.
std::optional<double> common_length_m(const AxialLayout& layout, int first, int second);

/// Indices into kPassingBodies of the pairs that overlap along the axis.
std::vector<int> overlapping_bodies(const AxialLayout& layout);

/// Radial gap between two passing bodies, tip circle to tip circle.
///
///   P2, S        d − ra_P2 − ra_S
///   P2, R1       ra_R1 − d − ra_P2, likewise P1, R2
///   carrier, R   ra_R − r_carrier
///
/// Source: docs/theory §19.
/// @param pair  index into kPassingBodies  @returns [m], negative = overlap
template <class T>
T passing_gap(const TrainGeometry<T>& train, const AxialLayout& layout, int pair);

}  // namespace gear3k::train
