#pragma once
// How often a tooth is loaded.

namespace gear3k::strength {

/// Turns of the bodies of a train, or speeds, in any one unit; of the planet in the carrier's
/// frame.
template <class T>
struct TrainTurns {
  T sun{}, carrier{}, planet_rolling{}, output{};
};

/// Load cycles of one tooth of each gear.  A planet's tooth meets each of its mates once a turn; a
/// central gear's tooth meets every planet once a turn against the carrier.
///
///   S N |n_S − n_C|,  P1 and P2 |n_P|,  R1 N |n_C|,  R2 N |n_C − n_R2|
///
/// For G2 > 1 both mates of P1 load the same flank: its flank and its root have twice the cycles,
/// whether the load reverses or not.  For G2 < 1 one turn bends the root once to either side.
/// Source: docs/theory §42.
template <class T>
struct LoadCycles {
  T sun{}, planet1{}, fixed_ring{}, planet2{}, output_ring{};
};
/// @param same_flank  G2 > 1: S and R1 load the same flank of P1
template <class T>
LoadCycles<T> load_cycles(const TrainTurns<T>& turns, int planets, bool same_flank);

}  // namespace gear3k::strength
