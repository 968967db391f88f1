#pragma once
// Ranking of tooth sets before any refinement: the low-backlash paper's step 2.

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <span>
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

/// Tooth sets in the order of what they are at zero shift: those that mesh first, then by the
/// objective, then in the order of the search.
///
/// Of a set its place and its teeth are kept (40 bytes), the rest is computed again when it is
/// asked for, so that the ranking of 10⁷ sets takes 0.4 GB and the first few of any number next to
/// nothing.
class ZeroShiftRanking {
 public:
  /// @param most  how many sets are kept, the first by rank
  explicit ZeroShiftRanking(Specification spec,
                            std::size_t most = std::numeric_limits<std::size_t>::max());

  /// @param candidates  those that follow the ones given before in the order of the search
  void add(std::span<const Candidate> candidates);
  /// Sets that were added.
  [[nodiscard]] std::uint64_t added() const { return added_; }
  /// Sets that are held; between two calls of add() at most twice `most` and one.
  [[nodiscard]] std::size_t held() const { return places_.size(); }
  /// Calls visit with each of the first `most` sets by rank.
  void for_each(const std::function<void(const ZeroShiftSet&)>& visit);

 private:
  struct Place {
    Candidate candidate;
    double cost = 0.0;  ///< less is better: the objective with its sign turned
    bool meshes = false, defined = false;
  };
  static bool before(const Place& a, const Place& b);
  void drop_last();

  Specification spec_;
  std::size_t most_;
  std::uint64_t added_ = 0;
  std::deque<Place> places_;  // grows in place
};

/// All candidates by ZeroShiftRanking.
std::vector<ZeroShiftSet> rank_at_zero_shift(const Specification& spec,
                                             const std::vector<Candidate>& candidates);

}  // namespace gear3k::optimize
