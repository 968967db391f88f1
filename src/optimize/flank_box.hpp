#pragma once
// What the flanks of a mesh ask of its module, whatever design a box of them holds: inline, for
// every box of every stage asks.

#include <algorithm>
#include <array>

#include "optimize/stage_relaxation.hpp"
#include "strength/flank_bound.hpp"

namespace gear3k::optimize {

/// A mesh in a box of centre distances and shifts; lengths in modules.
struct FlankBox {
  double base_pitch = 0.0;
  double ratio = 0.0;                            ///< greatest ε
  double low_tangent = 0.0, high_tangent = 0.0;  ///< d sin α_w
  double base1 = 0.0, base2 = 0.0;               ///< base radii
  double base_sum = 0.0;                         ///< base2 ± base1
  std::array<Interval, 2> length{};              ///< ρ_a of gears 1 and 2
  double sign = 1.0;                             ///< +1 external, −1 ring
};

/// Least Z_B² (own 0) or Z_D² (own 1) in a box.
inline double least_single_contact2(const FlankBox& box, std::size_t own) {
  const Interval inner{box.length[own].lo - box.base_pitch, box.length[own].hi - box.base_pitch};
  // Nearer to a tangent point than that strength/flank_stress holds the point.
  const double held = 1e-3 * box.high_tangent;
  if (inner.lo <= held) return 1.0;
  double most = inner.hi * (box.high_tangent + inner.hi);
  if (box.sign > 0.0) {
    if (box.low_tangent - inner.hi <= held) return 1.0;
    const double worst = std::clamp(0.5 * box.high_tangent, inner.lo, inner.hi);
    most = worst * (box.high_tangent - worst);
  }
  const double tan_w = box.low_tangent / box.base_sum;
  return std::max(1.0, box.base1 * box.base2 * tan_w * tan_w / most);
}

/// Least m² [m²] with which the flanks of a mesh carry their load: no design of the box does with
/// less.
///
///   m² tan α_w ≥ load Z_ε² Z²,   Z² the least Z_B² or Z_D² where it applies, else 1
///
/// Source: strength::FlankNeed, docs/theory §36.
inline double least_flank_module2(const strength::FlankNeed& need, const FlankBox& box) {
  double most = 0.0;
  for (std::size_t own = 0; own < 2; ++own) {
    const double load = need.load_m2[own];
    if (load > 0.0) {
      most =
          std::max(most, load * (need.single_contact[own] ? least_single_contact2(box, own) : 1.0));
    }
  }
  if (most <= 0.0) return 0.0;
  constexpr double kHeldContactRatio = 3.0;  // of Z_ε, strength/flank_stress
  const double z_epsilon2 = (4.0 - std::min(box.ratio, kHeldContactRatio)) / 3.0;
  return most * z_epsilon2 * box.base_sum / box.high_tangent;
}

}  // namespace gear3k::optimize
