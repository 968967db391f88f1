#pragma once
// Life factors: how much more than its endurance limit a material carries for a limited life.

#include "strength/factor.hpp"
#include "strength/material.hpp"

namespace gear3k::strength {

/// Cycles taken where no life is stated.  Their life factor is divided out of the strength.
inline constexpr double kUnstatedCycles = 5e7;

/// Life factor of the root, Y_NT: straight lines in log N and log Y between
///
///   V, St, GGG       (1e4, 2.5)     Eh, IF  (1e3, 2.5)
///   nitrided         (1e3, 1.6)     nitrocarburised  (1e3, 1.1)
///   then for all     (3e6, 1), (1e10, 0.85)
///
/// held beyond the ends: the plateau on the left is the static strength.  Kinks at the points.
/// Source: efvirida/python-gearbox, gfsReboucas/Drivetrain (ISO 6336-3:2006); the report of
/// stage_01.  That nodular iron follows V: data/gear_materials.csv.
/// @param cycles  N ≥ 0; 0: static load
/// @returns 1, said so, for materials without such a curve; those of plastics are in their limits
/// @throws std::invalid_argument when N is negative or NaN
template <class T>
Factor<T> root_life_factor(MaterialGroup group, LifeCurve curve, const T& cycles);

/// Life factor of the flank, Z_NT, likewise:
///
///   hardened, V, St, GGG   (1e5, 1.6), (5e7, 1), (1e10, 0.85)
///   some pitting allowed   (6e5, 1.6), (1e7, 1.3), (1e9, 1), (1e10, 0.85)
///   nitrided               (1e5, 1.3), (2e6, 1), (1e10, 0.85)
///   nitrocarburised        (1e5, 1.1), (2e6, 1), (1e10, 0.85)
///
/// Source: gfsReboucas/Drivetrain, hakangunes258/mekanika (ISO 6336-2:2006).
/// @throws std::invalid_argument as above
template <class T>
Factor<T> flank_life_factor(LifeCurve curve, bool pitting_allowed, const T& cycles);

}  // namespace gear3k::strength
