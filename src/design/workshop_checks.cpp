// The records of the checks of what a workshop and a range of temperature ask.

#include "design/check_tables.hpp"
#include "design/check_values.hpp"
#include "design/workshop_values.hpp"

namespace gear3k::design::check_tables {

using namespace check_values;

std::span<const CheckRecord> workshop_checks() {
  static const std::array<CheckRecord, 13> kRecords{
      with_values<TipThicknessLength>(
          CheckRecord{.id = CheckId::kTipThicknessLength,
                      .name = "tip_thickness_mm",
                      .title = "tip thickness as a length",
                      .group = "teeth",
                      .unit = Unit::kMillimetre,
                      .scope = CheckScope::kGear,
                      .at_least = true,
                      .default_limit = std::nullopt,
                      .limit_key = "",
                      .help = "least tooth thickness on the tip circle of every gear"}),
      with_values<RootClearanceLength>(
          CheckRecord{.id = CheckId::kRootClearanceLength,
                      .name = "root_clearance_mm",
                      .title = "tip to mate's root circle as a length",
                      .group = "interference",
                      .unit = Unit::kMillimetre,
                      .scope = CheckScope::kMember,
                      .at_least = true,
                      .default_limit = std::nullopt,
                      .limit_key = "",
                      .help = "least length of that clearance, whatever the module"}),
      with_values<SpecificSliding>(
          CheckRecord{.id = CheckId::kSpecificSliding,
                      .name = "specific_sliding",
                      .title = "specific sliding",
                      .group = "contact",
                      .unit = Unit::kNone,
                      .scope = CheckScope::kMember,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .limit_key = "",
                      .help = "greatest -zeta of a flank where its mate's tip touches it: sliding "
                              "over rolling speed"}),
      with_values<Wall>(
          CheckRecord{.id = CheckId::kWall,
                      .name = "wall",
                      .title = "wall under the root",
                      .group = "room",
                      .unit = Unit::kMillimetre,
                      .scope = CheckScope::kWalledGear,
                      .at_least = true,
                      .default_limit = std::nullopt,
                      .limit_key = "size.min_wall_mm",
                      .help = "least wall between the root circle and the bore of S, P1 and P2 or "
                              "the outer surface of a ring, where these are known"}),
      with_values<GearboxDiameter>(
          CheckRecord{.id = CheckId::kGearboxDiameter,
                      .name = "gearbox_diameter",
                      .title = "outer diameter with the rims",
                      .group = "room",
                      .unit = Unit::kMillimetre,
                      .scope = CheckScope::kRing,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .limit_key = "size.max_outer_diameter_mm",
                      .help = "greatest outer diameter of both rings with their rims; of a ring "
                              "without a rim that of its root circle"}),
      with_values<GearboxLength>(
          CheckRecord{.id = CheckId::kGearboxLength,
                      .name = "gearbox_length",
                      .title = "length along the axis",
                      .group = "room",
                      .unit = Unit::kMillimetre,
                      .scope = CheckScope::kSizedTrain,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .limit_key = "size.max_length_mm",
                      .help = "greatest length along the axis: from the first to the last body of "
                              "[axial], without it both face widths side by side"}),
      with_values<SunRootDiameter>(CheckRecord{.id = CheckId::kSunRootDiameter,
                                               .name = "sun_root_diameter",
                                               .title = "root diameter of the sun",
                                               .group = "room",
                                               .unit = Unit::kMillimetre,
                                               .scope = CheckScope::kSun,
                                               .at_least = true,
                                               .default_limit = std::nullopt,
                                               .limit_key = "size.min_sun_root_diameter_mm",
                                               .help = "least root diameter of the sun"}),
      with_values<SameModule>(CheckRecord{.id = CheckId::kSameModule,
                                          .name = "same_module",
                                          .title = "one module for both stages",
                                          .group = "teeth",
                                          .unit = Unit::kMillimetre,
                                          .scope = CheckScope::kTrain,
                                          .at_least = false,
                                          .default_limit = std::nullopt,
                                          .switched_limit = 0.0,
                                          .threshold = false,
                                          .limit_key = "",
                                          .help = "both stages have the same module"}),
      with_values<HuntingTooth>(
          CheckRecord{.id = CheckId::kHuntingTooth,
                      .name = "hunting_tooth",
                      .title = "common factor of a mesh",
                      .group = "teeth",
                      .unit = Unit::kNone,
                      .scope = CheckScope::kMesh,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .switched_limit = 1.0,
                      .limit_key = "",
                      .help = "greatest common factor of the teeth of a mesh; true: 1, every tooth "
                              "meets every tooth"}),
      with_values<ListedTeeth>(
          CheckRecord{.id = CheckId::kAllowedTeeth,
                      .name = "allowed_teeth",
                      .title = "teeth of the list",
                      .group = "teeth",
                      .unit = Unit::kNone,
                      .scope = CheckScope::kListedGear,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .threshold = false,
                      .limit_key = "allowed_teeth",
                      .help = "tooth numbers are of the lists in [allowed_teeth]; the value is how "
                              "far one is from the nearest"}),
      with_values<ThermalBacklash>(
          CheckRecord{.id = CheckId::kThermalBacklash,
                      .name = "thermal_backlash",
                      .title = "normal backlash over temperature",
                      .group = "temperature",
                      .unit = Unit::kMicrometre,
                      .scope = CheckScope::kThermalMesh,
                      .at_least = true,
                      .default_limit = std::nullopt,
                      .switched_limit = 0.0,
                      .limit_key = "",
                      .help = "least normal backlash of every mesh at the ends of [thermal], 0 "
                              "where that is stated"}),
      with_values<ThermalRootClearance>(
          CheckRecord{.id = CheckId::kThermalRootClearance,
                      .name = "thermal_root_clearance",
                      .title = "tip to mate's root over temperature",
                      .group = "temperature",
                      .unit = Unit::kModule,
                      .scope = CheckScope::kThermalMember,
                      .at_least = true,
                      .default_limit = std::nullopt,
                      .switched_limit = 0.0,
                      .limit_key = "",
                      .help = "least radial clearance between a tip circle and the mate's root "
                              "circle at the ends of [thermal], 0 where that is stated"}),
      with_values<ThermalLostMotion>(
          CheckRecord{.id = CheckId::kThermalLostMotion,
                      .name = "thermal_lost_motion",
                      .title = "output lost motion over temperature",
                      .group = "temperature",
                      .unit = Unit::kArcmin,
                      .scope = CheckScope::kThermalTrain,
                      .at_least = false,
                      .default_limit = std::nullopt,
                      .limit_key = "",
                      .help = "greatest kinematic lost motion at the output at the ends of "
                              "[thermal]"}),
  };
  return kRecords;
}

}  // namespace gear3k::design::check_tables
