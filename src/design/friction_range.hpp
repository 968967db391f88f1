#pragma once
// Where the friction law of a gearbox leaves the range that it is known in.

#include <string>
#include <vector>

#include "design/evaluation.hpp"

namespace gear3k::design {

/// An oil's viscosity this far outside its two stated temperatures is a guess.
inline constexpr double kFarFromStated_K = 40.0;

/// What the friction of a gearbox at its operating point is not known for, a note each with the
/// meshes and their values, of both drive directions:
///   any law   coefficients cut at efficiency::kGreatestFriction
///   table     sliding speeds or tooth forces beyond its edges (of more than one point)
///   schlenk   line load or sum of speeds below those of the gears that it was fitted to
///             (efficiency::kSchlenkLeastLineLoad_N_m, kSchlenkLeastSumSpeed_m_s)
///   schlenk   viscosity extrapolated by more than kFarFromStated_K
/// @returns empty where all is known, or where the gearbox runs in neither direction
std::vector<std::string> friction_range_notes(const LossyTrain<double>& train,
                                              const OperatingResult& operation);

}  // namespace gear3k::design
