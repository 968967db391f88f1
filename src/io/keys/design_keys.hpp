#pragma once
// Keys of DESIGN and PAIR, and what they set.

#include <array>
#include <optional>
#include <string>

#include "design/design.hpp"
#include "io/keys/key_registry.hpp"
#include "io/keys/limit_keys.hpp"
#include "io/keys/loss_keys.hpp"
#include "io/keys/strength_keys.hpp"
#include "io/keys/thermal_keys.hpp"
#include "io/keys/tolerance_keys.hpp"

namespace gear3k::io {

/// Greatest machining allowance that a file may state, in modules.
inline constexpr double kGreatestAllowance = 1.0;

/// A gear as the file states it.
struct GearInput {
  int teeth = 0;
  double profile_shift = 0.0, machining_allowance = 0.0, tip_shortening = 0.0;
  std::optional<double> normal_thinning_m;
  std::optional<backlash::DeviationLimits> thickness_allowance_m;
  bool khk_tip = false;
  geometry::PinionCutter cutter;
  std::optional<double> pin_diameter_m;
};

/// What DESIGN and PAIR have in common.
struct CommonInput {
  std::string name;
  bool iso = false;  ///< signs of rings by ISO 21771
  double pressure_angle_rad = units::to_si(20.0, units::Unit::kDegree);
  std::optional<double> center_distance_m;
  geometry::BasicRack<double> rack;
  std::array<GearInput, train::kGearCount> gears{};  ///< of a pair the first two
  LimitInput limits;
  ToleranceInput tolerances;
  StrengthInput strength;
};

struct DesignInput : CommonInput {
  int planets = 3;
  std::array<double, 2> module_m{};
  design::Masses masses;
  std::array<std::optional<double>, train::kGearCount> outer_radius_m;  ///< of the rings
  train::AxialLayout axial;
  ThermalInput thermal;
  LossInput losses;
};

struct PairInput : CommonInput {
  bool internal = false;
  double module_m = 0.0;
  design::Friction friction;
};

const Schema<DesignInput>& design_schema();
/// The key of a DESIGN file that states an input, with its tables: "gears.P1.profile_shift".
const std::string& key_of(const design::InputId& input);
const Schema<PairInput>& pair_schema();

}  // namespace gear3k::io
