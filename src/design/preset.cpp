#include "design/preset.hpp"

#include <algorithm>

namespace gear3k::design {

namespace {

constexpr std::array<PresetLimit, 12> kPresetLimits{
    {{.check = CheckId::kTipThickness, .machined = 0.25, .printed = 0.25},
     {.check = CheckId::kRingTipThickness, .machined = 0.25, .printed = 0.25},
     {.check = CheckId::kFormCircle, .machined = 0.05, .printed = 0.1},
     {.check = CheckId::kRootClearance, .machined = 0.1, .printed = 0.1},
     {.check = CheckId::kTrochoidInterference, .machined = 0.05, .printed = 0.1},
     {.check = CheckId::kPlanetGap, .machined = 0.5, .printed = 0.5},
     {.check = CheckId::kContactRatioMin, .machined = 1.2, .printed = 1.3},
     {.check = CheckId::kNormalBacklash, .machined = 20.0, .printed = 200.0},
     {.check = CheckId::kTipThicknessLength, .machined = 0.15, .printed = 0.4},
     {.check = CheckId::kRootClearanceLength, .machined = 0.08, .printed = 0.2},
     {.check = CheckId::kSpecificSliding, .machined = 3.0, .printed = 3.0},
     {.check = CheckId::kWall, .machined = 1.0, .printed = 1.2}}};

}  // namespace

std::span<const PresetLimit> preset_limits() { return kPresetLimits; }

std::optional<double> preset_limit(Preset preset, CheckId check) {
  if (preset == Preset::kBare) return std::nullopt;
  const auto* const found = std::ranges::find(kPresetLimits, check, &PresetLimit::check);
  if (found == kPresetLimits.end()) return std::nullopt;
  return units::to_si(preset == Preset::kMachined ? found->machined : found->printed,
                      check_record(check).unit);
}

}  // namespace gear3k::design
