#pragma once
// The least and the greatest that stated tolerances allow.

#include <vector>

#include "backlash/clearance_model.hpp"

namespace gear3k::backlash {

/// Lost motion (OutputRange::width_rad()) over all deviations within their limits.
struct WorstCase {
  double middle_rad = 0.0;  ///< closed form with every deviation at the middle of its limits
  double greatest_rad = 0.0;
  /// Whether the gearbox of deviations that reach it assembles: greatest_rad is then attained, else
  /// a bound.
  bool greatest_attained = false;
  /// No gearbox that assembles has less; attained if every gearbox assembles.
  double least_rad = 0.0;
  double least_margin_m = 0.0;     ///< attained; negative: some gearbox jams
  double greatest_margin_m = 0.0;  ///< a bound
  [[nodiscard]] bool can_jam() const { return least_margin_m < 0.0; }

  /// By which each source, alone, can raise or lower the lost motion of a gearbox whose planets are
  /// alike, in the order of ClearanceModel::sources; their sum is greatest − middle.
  std::vector<double> share_rad;
  double root_sum_square_rad = 0.0;  ///< √Σ share²
};

/// Bounds over the box (and circles) of the model's deviations, to rounding.
///
/// Width and margin are minima of finitely many linear functions of the deviations: one for each
/// choice of a planet for every bound in the dual forms of output_range().
///
/// Least: the least of the functions' own least values, each Σ half width · |coefficient|
/// (|gradient| in a circle) below its value at the middle.
///
/// Greatest: with one planet for all bounds, one of the functions is the closed form
///
///   φ_p = |f| j1 + e j2 + j3 over rb_R2
///
/// of that planet's own plays, so that width ≤ φ_p for every p, and width ≤ (1/N) Σ_p φ_p, again
/// linear.  The deviations that maximise it make all planets alike: what displaces the sun or a
/// ring cancels in the mean, and what remains is the same on every planet, where width = φ_p = the
/// mean. Source: own derivation, docs/theory §35.
WorstCase worst_case(const ClearanceModel& model);

}  // namespace gear3k::backlash
