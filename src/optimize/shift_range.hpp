#pragma once
// The profile shifts at which one gear meets every limit that depends on it alone.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "optimize/specification.hpp"
#include "optimize/tooth_search.hpp"

namespace gear3k::optimize {

/// Closed interval; empty when lo > hi.
struct Interval {
  double lo = 0.0, hi = 0.0;
  [[nodiscard]] bool empty() const { return !(lo <= hi); }
  [[nodiscard]] double width() const { return hi - lo; }
  [[nodiscard]] double middle() const { return 0.5 * (lo + hi); }
};

/// Modules that a stage can have [m].
Interval module_range(const ModuleChoice& choice);

/// Proof that a tooth set has no feasible point: without this check the proof fails.
struct Infeasibility {
  design::CheckId check{};
  /// By how much the limit would have to give way at least [SI]; 0 when it is not known.
  double miss_si = 0.0;
  double violation = 0.0;  ///< the same, scaled to order 1
  bool alone = true;       ///< else only together with other checks
  /// Owed to the stages' modules instead of the check: none of a list lets both stages have one
  /// centre distance.
  bool of_modules = false;
  /// Owed to a limit of what is felt instead, by the greatest efficiencies.
  std::optional<FeltQuantity> felt{};
};

/// Profile shifts of a gear with the limits that confine them.
struct ShiftRange {
  /// Where undercut, ring_tip_outside_base and (but for the KHK tip rule) tip_thickness hold; never
  /// empty.  Beyond `hi` of a tip too thin, no shift is feasible (docs/theory §32).
  Interval range;
  /// The same for bounds: with the slack that feasible designs may take, less what a ring's root
  /// diameter takes away even at the stage's least module.
  Interval widest;
  /// Set where no shift in profile_shift.range will do.
  std::optional<Infeasibility> infeasible;
};
ShiftRange shift_range(const Specification& spec, int gear, int teeth);

/// Whether shift_range() sees to a check, so that no constraint is needed for it.  Not to the tip
/// thickness: its range leaves out thin tips at large shifts only.
bool in_shift_range(const Specification& spec, const design::CheckInstance& check);

/// The ranges of a tooth set, by train::GearId.
using ShiftRanges = std::array<ShiftRange, train::kGearCount>;

/// shift_range() of all gears of some tooth sets, computed once.
class ShiftTable {
 public:
  ShiftTable(const Specification& spec, std::span<const Candidate> candidates);
  /// @param gear  train::GearId  @param teeth  of a gear of those tooth sets
  [[nodiscard]] const ShiftRange& of(int gear, int teeth) const;
  [[nodiscard]] ShiftRanges of(const train::ToothSet& teeth) const;

 private:
  struct Gear {
    int first = 0;
    std::vector<ShiftRange> by_teeth;
  };
  std::array<Gear, train::kGearCount> gear_;
};

}  // namespace gear3k::optimize
