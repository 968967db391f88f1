#pragma once
// Keys of SPEC, and what they set.

#include <optional>

#include "io/keys/co_design_keys.hpp"
#include "io/keys/key_registry.hpp"
#include "io/keys/limit_keys.hpp"
#include "io/keys/loss_keys.hpp"
#include "io/keys/strength_keys.hpp"
#include "io/keys/thermal_keys.hpp"
#include "io/keys/tolerance_keys.hpp"
#include "optimize/specification.hpp"

namespace gear3k::io {

struct SpecificationInput {
  optimize::Specification spec;
  /// Range of the addendum, which becomes spec.rack.addendum less spec.free.tip_shortening.
  std::optional<optimize::NumberRange> free_addendum;
  LimitInput limits;
  LossInput losses;  ///< its operating point
  ToleranceInput tolerances;
  StrengthInput strength;
  ThermalInput thermal;
  CoDesignInput co_design;

  SpecificationInput();
};

const Schema<SpecificationInput>& specification_schema();

}  // namespace gear3k::io
