#pragma once
// How planets that differ share the load on their common carrier.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "backlash/clearance_model.hpp"
#include "backlash/random_gearbox.hpp"

namespace gear3k::strength {

/// Stiffness of each mesh of one planet, k̄_k b_k [N/m].
using MeshSprings = std::array<double, train::kMeshCount>;
/// Normal forces of the meshes of one planet [N]: above 0 where u stands beyond its upper bound,
/// below 0 where beyond the lower one.
using PlanetForces = std::array<double, train::kMeshCount>;

/// Forces of all planets of a train whose sun and R1 are held while a torque turns R2.
///
/// Every mesh of every planet is a spring behind its play, on both flanks:
///
///   f_k = k_k max(0, u_k − upper_k) − k_k max(0, lower_k − u_k)
///   u_1 = v,   u_2 = w − v,   u_3 = y + e w − κ v,   y = rb_R2 δ_R2
///
/// w of the carrier and y of R2 are common, v is the planet's own; e, κ of backlash::OutputLevers.
/// They are where the energy Σ f²/(2k) − T y/rb_R2 is least, a convex function of quadratic pieces:
/// v by its closed form, w and y by Newton's method with a line search, which ends on the piece.
/// Then Σ_p f_3 = T/rb_R2, Σ_p f_2 = −e T/rb_R2, Σ_p f_1 = (κ − e) T/rb_R2.
/// Source: own derivation, docs/theory §55.
/// Accuracy: those sums hold to 1e-10 of the greatest force, but not better than 1e-14 Σ k|u| over
/// all meshes, to which the flanks' places u are rounded (tested for springs of 1e6 to 1e10 N/m,
/// plays up to 0.5 mm, torques of 1e-4 to 1e4 N m).  The forces themselves are uncertain by that
/// times the ratio of the greatest spring to the least.
///
/// Does not account for: members that shift off their axes to even out the loads, springs other
/// than the meshes' (of planets, pins and bearings, which even them out too), friction.
/// @param planets   plays; a bound may be infinite where nothing is met on that side
/// @param torque_Nm  of any sign, not 0; positive: it turns R2 on
/// @throws std::invalid_argument without planets, unless every spring is above 0, for a torque of 0
///   or a play whose lower bound is above the upper one, and where bounds that are infinite let the
///   torque turn R2 for ever
/// @throws std::runtime_error where the forces found miss that balance by more than
///   1e-9 T/rb_R2 + 1e-12 Σ k|u|
std::vector<PlanetForces> shared_forces(const backlash::OutputLevers& levers,
                                        const MeshSprings& springs_N_m,
                                        std::span<const backlash::PlanetPlay> planets,
                                        double torque_Nm);

/// K_γ of each mesh: N times the force of the planet that carries most over that of all planets;
/// 1 … N while no back flank is loaded, above N where planets work against each other.
std::array<double, train::kMeshCount> mesh_load_factors(const backlash::OutputLevers& levers,
                                                        std::span<const PlanetForces> planets,
                                                        double torque_Nm);

struct PlaySampleOptions {
  std::uint64_t samples = 10'000;  ///< gearboxes drawn
  std::uint64_t seed = 1;
  backlash::ScatterOptions scatter{};
};
/// Plays of random gearboxes: those with the same numbers as in backlash::monte_carlo() with the
/// same seed and scatter.
struct PlaySample {
  backlash::OutputLevers levers{};
  std::size_t planets = 0;
  std::vector<backlash::PlanetPlay> plays{};  ///< planet by planet, of those that assemble
  std::uint64_t drawn = 0, assembled = 0;
};
/// @throws std::invalid_argument for 0 samples
PlaySample draw_plays(const backlash::ClearanceModel& model, const PlaySampleOptions& options);

/// Ranks of n sorted values between which the quantile of what they were drawn from lies, with a
/// probability of 95 % and more.
///
///   P(B < lower) <= 2.5 %,  P(B >= upper) <= 2.5 %,  B binomial of n trials with `probability`
///
/// Source: order statistics, docs/theory §55.
struct QuantileRanks {
  std::uint64_t lower = 0;               ///< 1 … n; 0: too few values below
  std::optional<std::uint64_t> upper{};  ///< empty: too few values above
};
/// @throws std::invalid_argument for a probability outside (0, 1]
QuantileRanks quantile_ranks(std::uint64_t values, double probability);

/// K_γ of each mesh over a series of gearboxes, of each the greater one of both senses of the
/// torque.
struct LoadFactorSeries {
  std::array<double, train::kMeshCount> mean{};
  /// That a share `probability` of the gearboxes does not exceed, mesh by mesh.
  std::array<double, train::kMeshCount> quantile{};
  /// Where that of all gearboxes lies, with a probability of 95 % (quantile_ranks()); below: 1
  /// where there are too few, above: then empty.
  std::array<double, train::kMeshCount> lower{};
  std::array<std::optional<double>, train::kMeshCount> upper{};
};
/// @param probability  in (0, 1]
/// @throws std::invalid_argument for an empty sample, a probability outside, or as shared_forces()
LoadFactorSeries load_factor_series(const PlaySample& sample, const MeshSprings& springs_N_m,
                                    double torque_Nm, double probability);

}  // namespace gear3k::strength
