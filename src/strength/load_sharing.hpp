#pragma once
// How N planets share the load when they do not touch at the same time.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "backlash/clearance_model.hpp"
#include "backlash/random_gearbox.hpp"
#include "geometry/scalar.hpp"

namespace gear3k::strength {

/// Load of planets that stand side by side as springs with gaps.
template <class T>
struct LoadSharing {
  std::vector<T> planet_torque_Nm{};  ///< T_p at the output; their sum is T
  T angle_rad{};                      ///< φ: turn of the output after the first planet touches
  T load_factor{};                    ///< K_γ = N max T_p/T: 1 … N
  std::size_t carrying = 0;           ///< planets with T_p > 0
};

/// Exact solution of Σ κ max(0, φ − g_p) = T, κ = K_out/N.
///
/// With the gaps in order, g_1 ≤ g_2 ≤ …, the first n planets carry iff the next one's gap is not
/// used up: φ = (T/κ + Σ_1^n g)/n ≤ g_{n+1}.  Equal gaps: K_γ = 1; one gap far below the others: N.
/// Source: own derivation, docs/theory §55.
///
/// K_γ is continuous in all arguments, with a kink where a planet begins to carry.
///
/// Does not account for: the carrier that all planets share.  Each planet stands on the output as
/// if the carrier could turn for it alone (its three meshes in series).  Against springs on one
/// carrier that is right within 5 % (means, tested) for P1-R1 and P2-R2 and too low for S-P1, whose
/// force is small beside its deviations: N is safe there.  A sun or ring that is free to shift
/// (with N = 3: K_γ = 1, an input).
/// @param gap_rad     g_p at the output, from any origin; +∞ for a planet that is not there
/// @param output_stiffness_Nm_rad  K_out with all planets carrying
/// @throws std::invalid_argument without planets, for a gap that is not a number, without a finite
///   gap, or unless K_out > 0 and T > 0
template <class T>
LoadSharing<T> load_sharing(std::span<const double> gap_rad, const T& output_stiffness_Nm_rad,
                            const T& torque_Nm);

/// Gaps of the planets of a gearbox at the output: for each planet the end of the output's range
/// with that planet alone (docs/theory §33), less that of the planet that touches first.
/// @param greatest  the load pushes R2 on (its upper end), else it holds it back
/// @throws std::invalid_argument without planets
std::vector<double> planet_gaps(const backlash::OutputLevers& levers,
                                std::span<const backlash::PlanetPlay> planets, bool greatest);

struct PlanetGapOptions {
  std::uint64_t samples = 10'000;  ///< gearboxes drawn
  std::uint64_t seed = 1;
  backlash::ScatterOptions scatter{};
  bool greatest = true;  ///< as planet_gaps()
};
/// Gaps of random gearboxes: those with the same numbers as in backlash::monte_carlo() with the
/// same seed and scatter.
struct PlanetGapSample {
  std::size_t planets = 0;
  std::vector<double> gap_rad{};  ///< planet by planet, gearbox by gearbox, of those that assemble
  std::uint64_t drawn = 0, assembled = 0;
};
/// @throws std::invalid_argument for 0 samples
PlanetGapSample draw_planet_gaps(const backlash::ClearanceModel& model,
                                 const PlanetGapOptions& options);

/// K_γ over a series of gearboxes.
template <class T>
struct LoadFactorDistribution {
  T mean{};
  T quantile{};  ///< that a share `probability` does not exceed: of one gearbox, with its
                 ///< derivatives
};
/// @param probability  in (0, 1]
/// @throws std::invalid_argument for an empty sample, a probability outside, or as load_sharing()
template <class T>
LoadFactorDistribution<T> load_factor_distribution(const PlanetGapSample& sample,
                                                   const T& output_stiffness_Nm_rad,
                                                   const T& torque_Nm, double probability);

}  // namespace gear3k::strength
