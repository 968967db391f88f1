#pragma once
// The timing marks of a compound planet: which teeth of P1 and P2 stand in line.

#include <vector>

#include "drawing/drawing.hpp"

namespace gear3k::drawing {

/// How planet i is put in.
struct PlanetMarks {
  double p1_rad = 0.0;  ///< direction of the marked tooth of P1, as TrainPlacement's angles
  double p1_from_axis_rad = 0.0;  ///< the same from the line sun - planet, within half a turn
  double phase_rad = 0.0;  ///< of the marked tooth of P2 beyond it, as small as it can be, >= 0
};

/// The teeth to mark: any tooth of P1 at ψ_P1 + 2π k/zP1 and the next one of P2 beyond it.
///
/// With ψ_P1 = 2π a/(N zP1) and ψ_P2 = 2π b/(N zP2), a and b whole numbers, the phase is
/// 2π ((b zP1 − (a + k N) zP2) mod N zP1)/(N zP1 zP2): the k of the smallest is taken, of equal
/// ones the first.  Planets that are one part have phase 0: their marks stand in line.
/// @returns one for each planet of place_train()
std::vector<PlanetMarks> planet_marks(const train::ToothSet& z, int planets);

}  // namespace gear3k::drawing
