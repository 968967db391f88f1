#pragma once
// Limits of what a stated motor lets the output of a gearbox feel, as constraints of a search.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "units/units.hpp"

namespace gear3k::optimize {

enum class FeltQuantity { kInertia, kBreakaway, kTransparency };

/// Names as in the checks of `gear3k actuator`; keys under actuator.limits.
struct FeltRecord {
  FeltQuantity quantity;
  std::string_view name, key;
  units::Unit unit;
};
inline constexpr std::array<FeltRecord, 3> kFeltRecords{
    {{FeltQuantity::kInertia, "felt_inertia", "actuator.limits.max_felt_inertia_kgm2",
      units::Unit::kKilogramSquareMetre},
     {FeltQuantity::kBreakaway, "breakaway", "actuator.limits.max_breakaway_nm",
      units::Unit::kNewtonMetre},
     {FeltQuantity::kTransparency, "transparency", "actuator.limits.max_transparency",
      units::Unit::kNone}}};
inline const FeltRecord& felt_record(FeltQuantity quantity) {
  return kFeltRecords.at(static_cast<std::size_t>(quantity));
}

/// A limit: at most this value [SI].
struct FeltLimit {
  FeltQuantity quantity = FeltQuantity::kInertia;
  double value = 0.0;
};

/// A motor with its limits; the gearbox is the one that is sought.
struct FeltTask {
  double rotor_inertia_kgm2 = 0.0, coulomb_Nm = 0.0, static_Nm = 0.0;  ///< at the motor's shaft
  double load_inertia_kgm2 = 0.0;                                      ///< at the output
  double transparency_torque_Nm = 0.0;  ///< τ that the motor holds, at the output
  std::vector<FeltLimit> limits{};      ///< not empty
  std::vector<std::string> sources{};   ///< files of the motor
};

/// What the limits see of a gearbox.
template <class T>
struct FeltGearbox {
  double ratio = 1.0;   ///< i, signed
  T forward, backward;  ///< η_f, η_b
  /// Of the rotor and the gears, sped up from the output, no drag; empty where the gears' masses
  /// are not known: i² J_m/η_b then.
  std::optional<T> inertia_kgm2{};
};

/// g ≥ 0 where the limit holds, smooth through η_b = 0:
///
///   inertia       L/J − 1,   J = J_load + i² J_m/η_b, or with the gears' inertia
///   breakaway     L/B − 1,   B = |i| T_s/η_b;  η_b without friction at rest
///   transparency  r_L/r − 1, r = (τ + c1)/((τ − c1) η_f η_b),  r_L = (2 + L)/(2 − L)
///
/// each rises with η_b, the last one with η_f too.  Source: docs/theory §59, §79.
template <class T>
T felt_margin(const FeltTask& task, const FeltLimit& limit, const FeltGearbox<T>& gearbox);

/// By how much the value exceeds its limit [SI] where g = −violation.
double felt_miss(const FeltTask& task, const FeltLimit& limit, double violation);

/// ∂g/∂L where g = 0.
double felt_slope(const FeltLimit& limit);

}  // namespace gear3k::optimize
