#pragma once
// What MODEL files are written and read with alike.

#include <string>
#include <string_view>

#include "calibrate/causes/form_catalogue.hpp"
#include "calibrate/model/cause.hpp"

namespace gear3k::io {

/// Stands before the digits of a fingerprint.
inline constexpr std::string_view kFingerprint = "fnv1a64:";
/// Stands behind the key of a parameter for its standard deviation.
inline constexpr std::string_view kDeviation = "_sd";

/// Lists of a cause: what explained the data as well, and parameters that no gearbox shows.
inline constexpr std::string_view kAlternatives = "alternatives", kImplausible = "implausible",
                                  kEmpirical = "empirical";

/// Of a cause that acts by when a row was measured: the change that later measurements meet, and of
/// what.
inline constexpr std::string_view kLeftBehind = "left_behind", kLeftBehindOn = "left_behind_on";

/// Of a kind: compliance counts beyond the springs of [strength].
inline constexpr std::string_view kBeyondSprings = "beyond_strength_springs";

inline std::string key_of(const calibrate::ParameterRecord& parameter) {
  return calibrate::file_key(parameter.name, parameter.unit);
}
inline std::string key_of(const calibrate::FormConstant& constant) {
  return calibrate::file_key(constant.name, constant.unit);
}

}  // namespace gear3k::io
