#pragma once
// What a check of a scope is of.

#include "design/checks.hpp"

namespace gear3k::design {

/// A check's subject: CheckSubject::member is a gear, a mesh, a pair of bodies or a bearing, and of
/// a member of a mesh CheckSubject::which is 1 or 2.
enum class CheckTarget { kGear, kMesh, kMember, kBodyPair, kPlanetBearing, kPlanetPin, kTrain };

constexpr CheckTarget target_of(CheckScope scope) {
  switch (scope) {
    case CheckScope::kGear:
    case CheckScope::kExternalGear:
    case CheckScope::kRing:
    case CheckScope::kCutRing:
    case CheckScope::kWalledGear:
    case CheckScope::kListedGear:
    case CheckScope::kSun:
    case CheckScope::kPlanetStep:
      return CheckTarget::kGear;
    case CheckScope::kMesh:
    case CheckScope::kInternalMesh:
    case CheckScope::kRatedMesh:
    case CheckScope::kThermalMesh:
      return CheckTarget::kMesh;
    case CheckScope::kTip:
    case CheckScope::kMember:
    case CheckScope::kRatedTooth:
    case CheckScope::kThermalMember:
      return CheckTarget::kMember;
    case CheckScope::kBodyPair:
      return CheckTarget::kBodyPair;
    case CheckScope::kPlanetBearing:
      return CheckTarget::kPlanetBearing;
    case CheckScope::kPlanetPin:
      return CheckTarget::kPlanetPin;
    case CheckScope::kTrain:
    case CheckScope::kSizedTrain:
    case CheckScope::kThermalTrain:
      break;
  }
  return CheckTarget::kTrain;
}

/// Whether a check is of each end of the temperatures (CheckSubject::end).
constexpr bool is_thermal(CheckScope scope) {
  return scope == CheckScope::kThermalMesh || scope == CheckScope::kThermalMember ||
         scope == CheckScope::kThermalTrain;
}

}  // namespace gear3k::design
