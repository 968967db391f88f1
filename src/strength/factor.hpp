#pragma once
// One factor of a rating, as a report prints it.

#include <string_view>

#include "geometry/scalar.hpp"

namespace gear3k::strength {

/// A factor with the formula that gave it.  Where a formula has branches, its derivatives are those
/// of the active one; where one branch meets another there is a kink.
template <class T>
struct Factor {
  T value = constant<T>(1.0);
  std::string_view branch{};  ///< which case of the formula is active, or what was not stated
  std::string_view source{};
  bool in_range = true;  ///< false: the value stands, outside the range of its source
};

/// Where formulas and constants were read.
namespace sources {
inline constexpr std::string_view kM56 = "IACS UR M56 Rev.4";
inline constexpr std::string_view kMekanika = "hakangunes258/mekanika (ISO 6336:2006)";
inline constexpr std::string_view kDrivetrain = "gfsReboucas/Drivetrain (ISO 6336:2006)";
inline constexpr std::string_view kDin3990 = "hanslhansl/din3990 (DIN 3990-11)";
inline constexpr std::string_view kVdi2736 = "tkuhn39/semesterthesis (VDI 2736-2)";
inline constexpr std::string_view kGearPie = "cfernandesFEUP/GEARpie";
inline constexpr std::string_view kNotStated = "not stated";
inline constexpr std::string_view kInput = "input";
inline constexpr std::string_view kTolerances = "tolerances";
}  // namespace sources

}  // namespace gear3k::strength
