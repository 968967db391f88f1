#pragma once
// The range of the output of many gearboxes side by side.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "backlash/clearance_model.hpp"

namespace gear3k::backlash {

/// Gearboxes computed side by side.
inline constexpr std::size_t kBatch = 32;
struct alignas(64) Lanes {
  std::array<double, kBatch> lane;
};

/// A number, or one component of a vector, of a deviation.
struct DeviationComponent {
  std::size_t deviation = 0;  ///< index into ClearanceModel::deviations
  std::size_t source = 0;     ///< index into ClearanceModel::sources
  bool y = false;             ///< the second one of a planar deviation
};

/// Width and margin of output_range() for kBatch gearboxes.
struct BatchRange {
  Lanes width_rad;
  Lanes margin_m;
};

/// plays() and output_range() over a batch, with their results bit for bit: every sum is taken in
/// the same order.
class GearboxBatch {
 public:
  explicit GearboxBatch(const ClearanceModel& model);

  /// Deviation by deviation, x before y.
  [[nodiscard]] const std::vector<DeviationComponent>& components() const { return components_; }
  /// @param values  where each component's values of the batch stand [m]
  void ranges(std::span<const Lanes* const> values, BatchRange& result) const;

 private:
  /// Part of a component in a bound.
  struct Term {
    std::size_t component = 0;
    double coefficient = 0.0;
  };
  OutputLevers levers_;
  std::vector<DeviationComponent> components_;
  std::vector<double> middle_m_;
  std::vector<Term> terms_;          ///< of bound after bound
  std::vector<std::size_t> begins_;  ///< of each bound's terms; one more than there are bounds
};

}  // namespace gear3k::backlash
