#pragma once

namespace gear3k::numerics {

/// x²
constexpr double square(double x) { return x * x; }

}  // namespace gear3k::numerics
