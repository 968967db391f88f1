#pragma once
// How the deviations of gears, pins and carrier move the flanks of every mesh of every planet.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "backlash/output_range.hpp"
#include "backlash/tolerances.hpp"

namespace gear3k::backlash {

/// One stated tolerance: the limits of one or, on planets, of N independent deviations.
struct ToleranceSource {
  ToleranceKind kind{};
  int gear = -1;              ///< train::GearId; −1: the carrier's or the planet's
  double half_width_m = 0.0;  ///< of the interval or circle; planet phase: arc on P2's base circle
  /// "S tooth_thickness", "planet_phase"
  [[nodiscard]] std::string name() const;
};

/// Bodies whose deviations turn with them, in the frame of the carrier.
enum class Body { kCarrier, kSun, kPlanet, kRing1, kRing2 };

/// Part of a deviation in a bound of a mesh's play: bound += coefficient · deviation.
struct PlayEffect {
  std::size_t bound = 0;     ///< index as of bound_index()
  double coefficient = 0.0;  ///< dimensionless
};

/// One independent deviation of a built gearbox.
struct Deviation {
  std::size_t source = 0;  ///< index into ClearanceModel::sources
  Body body = Body::kCarrier;
  int planet = -1;  ///< −1: of a body that all planets share
  /// In a circle about 0, with components x and y in the frame of the carrier (eccentricity,
  /// cumulative pitch, pin); else a number in ± half_width_m, and y has no effect.
  bool planar = false;
  std::vector<PlayEffect> x{}, y{};
};

/// Place of a bound of u_k of a planet: lower bounds at even, upper at odd indices.
constexpr std::size_t bound_index(int planet, int mesh, bool upper) {
  return 2U * (static_cast<std::size_t>(planet) * train::kMeshCount +
               static_cast<std::size_t>(mesh)) +
         (upper ? 1U : 0U);
}

/// Bounds of all plays at the middle of every tolerance, and what each deviation adds, to first
/// order.
///
///   upper_k = + j_k/2 + Δ·(C t + σ S n) − cos α Σ ± f,   lower_k = − j_k/2 + Δ·(C t − σ S n) − ...
///
/// with n the direction from the axis to the planet, t that of increasing angle, C = cos α_w,
/// S = sin α_w, σ = +1 for S-P1 and −1 for the rings, Δ the displacement of the planet's teeth less
/// that of the central gear's, f the displacement of the touching tooth along its reference circle
/// (+ for S and the rings, + for the planet in S-P1 and − in the rings), and a tooth thickness
/// deviation A taking cos α A/2 off each side.  A phase deviation χ of P2 adds rb_P2 χ to u3.
/// Of F_p only what the eccentricity leaves counts here: max(0, F_p − F_r/cos α).
/// A flank stands within ± f_pt/2 of its place, so that no pitch deviates by more than f_pt.
/// Source: own derivation, docs/theory §33.
/// Truncation: second order in displacements, cos² α_w Δ²/(d sin α_w) (0.05 µm for 20 µm at d = 20
/// mm).  Does not cover: a gear of small eccentricity whose pitch
/// uses all of F_p; profile and helix deviations, bearing play, elastic deformation, a sun or
/// carrier that shifts off its axis under load.
struct ClearanceModel {
  OutputLevers levers;
  int planets = 0;
  std::vector<double> middle_m;  ///< by bound_index()
  std::vector<ToleranceSource> sources;
  std::vector<Deviation> deviations;
};

/// Empty where a mesh has no working angle at the middle of the centre distance's limits.
/// @param p  as drawn, centre distance resolved
std::optional<ClearanceModel> clearance_model(const train::TrainParameters<double>& p,
                                              const Tolerances& tolerances);

/// Values of one deviation; y unused unless planar.
struct DeviationValue {
  double x_m = 0.0, y_m = 0.0;
};
/// Plays of a gearbox with these deviations (one for each of model.deviations).
std::vector<PlanetPlay> plays(const ClearanceModel& model, std::span<const DeviationValue> values);

}  // namespace gear3k::backlash
