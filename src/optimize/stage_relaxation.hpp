#pragma once
// The least friction losses that the meshes of one stage can have, by branch and bound: what no
// design of a tooth set can undercut, whatever its shifts, modules and centre distance.

#include <array>
#include <cstddef>
#include <optional>

#include "optimize/loss_factor_bounds.hpp"
#include "optimize/shift_range.hpp"
#include "strength/flank_bound.hpp"
#include "strength/root_bound.hpp"

namespace gear3k::optimize {

/// One gear of a stage, in modules.
struct StageGear {
  int teeth = 0;
  Interval profile_shift;
  /// Tip radius less z/2 + x: haP* − k external, k − haP* ring.
  Interval tip_height{1.0, 1.0};
  double root_height = 0.0;  ///< root radius less z/2 + x: −hfP* external, hfP* ring
  double machining_allowance = 0.0;
};

/// What the roots of the sun and of the planet in S-P1, and of the planet in its ring, ask; no
/// table: nothing.
struct StageRoots {
  strength::RootNeed sun{}, planet_of_sun{}, planet_of_ring{};
  const strength::RootTable* sun_table = nullptr;
  const strength::RootTable* planet_table = nullptr;
};

/// A planet in its ring and, in stage 1, with the sun, under those limits that concern the stage
/// alone.  Lengths in modules of the stage.
struct StageTask {
  StageGear planet, ring;
  std::optional<StageGear> sun;
  double pressure_angle_rad = 0.0;
  bool sun_khk_tip = false, planet_khk_tip = false;  ///< tip shortened by the KHK rule of S-P1
  /// Working angles beyond which nothing is looked for [rad].
  double greatest_angle_rad = 0.0;
  Interval distance{0.0, kInfinity};     ///< centre distances that are looked at
  Interval sun_backlash, ring_backlash;  ///< j_bn
  /// sun · j_bn of S-P1 + ring · j_bn of the ring's mesh ≤ most (in any one unit).
  struct LostMotion {
    double sun, ring, most;
  };
  std::optional<LostMotion> lost_motion;
  Interval contact_ratio;              ///< of every mesh
  std::optional<double> interference;  ///< least involute interference margin
  /// Least 1/w of root_sliding() (geometry/sliding.hpp) of every flank.
  std::optional<double> rolling_share;
  std::optional<double> root_clearance;  ///< least root clearance
  /// Neighbouring planets: d half_spacing − tip radius ≥ half_gap.
  struct PlanetGap {
    double half_spacing, half_gap;
  };
  std::optional<PlanetGap> planet_gap;
  bool sliding = true;  ///< least_loss_factor() of the first-order model, else that of Ohlendorf
  /// Loss over loss factor: μ π (1/z1 ± 1/z2).
  double sun_loss = 0.0, ring_loss = 0.0;
  /// Minimised: sun_weight · loss of S-P1 + ring_weight · loss of the ring's mesh.
  double sun_weight = 0.0, ring_weight = 1.0;
  /// What the flanks ask of the stage's module, and what it can be at most [m]: 2 m r_f ≤ the
  /// diameter of the ring's root.
  strength::FlankNeed sun_flank{}, ring_flank{};
  double flank_safety = 1.0;  ///< the least that is asked of a gear
  StageRoots roots{};
  double root_safety = 1.0;  ///< the least that is asked of a gear
  double most_module_m = kInfinity;
  double most_root_diameter_m = kInfinity;
  /// What is minimised instead.
  enum class Least {
    kLoss,
    kDistance,        ///< centre distance [m] at which flanks and roots carry the load
    kInverseDistance  ///< 1/m of the greatest centre distance; with kDistance no need of the load
                      ///< is a limit
  };
  Least least = Least::kLoss;
};

/// When a search ends: no box is left, the lowest one is known to `tolerance` of its bound, or
/// `boxes` were examined.
struct StageEffort {
  int boxes = 200;
  double tolerance = 0.02;
};

/// Where the lowest box lies.
struct StagePoint {
  double center_distance = 0.0;  ///< in modules
  double sun_shift = 0.0, planet_shift = 0.0, ring_shift = 0.0;
};

struct StageBound {
  bool empty = false;          ///< proven: no point meets the limits
  double least = 0.0;          ///< no point that meets them has a smaller weighted loss
  Interval center_distance{};  ///< holds all points that meet the limits
  StagePoint point{};          ///< near the least; need not meet the limits
  bool by_root = false;        ///< a root asks for more there than the flanks do
  int boxes = 0;
};

/// Lower bound of the weighted losses of a stage.
///
/// Branches over centre distance d and the planet's shift x_P.  In a box the shifts of ring and sun
/// are confined by backlash, contact ratio, interference and clearance, each monotone in its
/// variables, and the loss factors by least_loss_factor() on the resulting ranges of e1, e2 and ε.
/// Source: own derivation, docs/theory §32.
/// Valid: exact arithmetic; rounding is covered by kRelaxationSlack in every comparison.
StageBound relax_stage(const StageTask& task, const StageEffort& effort);

/// Centre distances that hold all points which meet the limits, before any search [modules]; empty
/// when there are none.
Interval center_distances(const StageTask& task);

/// Slack of all comparisons, in modules and in shares of the contact ratio.
inline constexpr double kRelaxationSlack = 1e-9;

/// How the teeth of a mesh touch at most.
struct MeshReach {
  double farthest = 0.0;     ///< from the pitch point, in base pitches
  double loss_factor = 0.0;  ///< most_loss_factor()
  double tan_alpha_w = 0.0;  ///< of the working pressure angle
};

/// The same of a stage, of all points that meet its limits.
struct TeethReach {
  bool empty = true;      ///< proven: no point meets them
  double distance = 0.0;  ///< greatest centre distance
  MeshReach sun, ring;
};

/// Contact on both sides of the pitch point, bounded by what relax_stage() leaves of e1, e2 and ε
/// in each box of a grid over centre distance and the planet's shift: from the tips on, as a path
/// of any length may lie wholly on one side.
/// Source: own derivation, docs/theory §75.
TeethReach teeth_reach(const StageTask& task);

}  // namespace gear3k::optimize
