#pragma once
// Ranking of tooth sets before any refinement: the low-backlash paper's step 2.

#include <array>
#include <vector>

#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// A tooth set at zero profile shift, full teeth thinned by the specification's allowance.
///
/// The centre distance is that of mesh P1-R1 without backlash, d = m1 (zR1 − zP1)/2, and stage 2's
/// module the one that closes mesh P2-R2 there, m2 = 2 d/(zR2 − zP2), whatever the specification's
/// module range.  S-P1 then has play or interferes by the coaxial offset zR1 − zS − 2 zP1.
struct ZeroShiftSet {
  Candidate candidate;
  double ratio = 0.0;
  double module_ratio = 0.0;  ///< m2/m1
  bool defined = false;       ///< S-P1 has a real working angle; else the rest is 0
  /// No mesh interferes (j_bn ≥ 0, with rounding allowed) and every contact ratio is at least 1.
  bool meshes = false;
  std::array<double, train::kMeshCount> contact_ratio{};
  double eta_b = 0.0, eta_f = 0.0;
  double lost_motion_rad = 0.0;  ///< by the specification's model
  double sun_backlash = 0.0;     ///< j_bn of S-P1 in modules of stage 1
};

/// All candidates, those that mesh first, then by the objective, then in the order of candidates.
std::vector<ZeroShiftSet> rank_at_zero_shift(const Specification& spec,
                                             const std::vector<Candidate>& candidates);

}  // namespace gear3k::optimize
