#pragma once
// Units at the door of the program, each as its value in SI.  Inside, everything is SI.

#include <numbers>

namespace gear3k::units {

inline constexpr double kMillimetre = 1e-3;                       ///< m
inline constexpr double kMicrometre = 1e-6;                       ///< m
inline constexpr double kDegree = std::numbers::pi / 180.0;       ///< rad
inline constexpr double kArcmin = std::numbers::pi / 180.0 / 60;  ///< rad
inline constexpr double kRpm = std::numbers::pi / 30.0;           ///< rad/s
inline constexpr double kAbsoluteZero_c = -273.15;                ///< 0 K in degrees Celsius

}  // namespace gear3k::units
