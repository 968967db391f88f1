#pragma once
// Keys of what a gearbox loses and where it runs: laws of [friction], [lubricant], [drag],
// [bearings], [operating_point] and [map] of a DESIGN.

#include <optional>
#include <vector>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"

namespace gear3k::io {

/// What the keys set.
struct LossInput {
  design::Friction friction;
  design::ShaftLosses<double> shafts;
  design::OperatingPoint<double> operating_point;
  bool has_point = false;  ///< of what is written: the operating point is stated
  design::MapGrid map;
};

struct LossKey {
  Key<LossInput> key;
  /// The law that reads it; empty: always read.
  std::optional<efficiency::FrictionLaw> law = std::nullopt;
  bool required_by_law = false;
};
/// All of them; those of coefficient and loss model are friction_keys().
const std::vector<LossKey>& loss_keys();

/// Puts what was read into a design whose masses are set; says in `reading` what does not fit
/// together.
void finish_losses(const LossInput& input, design::Design& design, FileReading& reading);

/// What a file states of a design's losses.
LossInput stated_losses(const design::Design& design);

}  // namespace gear3k::io
