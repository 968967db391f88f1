#pragma once
// What temperatures of lubricants and teeth may be, in keys and in measurements.

namespace gear3k::io {

inline constexpr double kColdest_C = -80.0;
inline constexpr double kHottest_C = 400.0;

}  // namespace gear3k::io
