#pragma once
// Mass and inertia of every part of a gearbox, as stated or from geometry.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "design/design.hpp"

namespace gear3k::design {

enum class MassOrigin {
  kStated,   ///< a value of the design
  kGeometry  ///< from sizes and density
};

/// A part of the gearbox; of those that occur several times, one.
struct PartMass {
  /// S, P1, P2, R1, R2, carrier; pin where the design has pins; planet (both steps, mass only)
  /// where its mass is stated: the steps then have none of their own.
  std::string name;
  int count = 1;
  std::optional<double> mass_kg;
  std::optional<double> inertia_kgm2;  ///< about the part's own axis
  MassOrigin mass_origin = MassOrigin::kGeometry, inertia_origin = MassOrigin::kGeometry;
};

struct MassModel {
  std::vector<PartMass> parts;
  /// Σ count · mass; empty unless S, both steps of the planets, R1, R2 and the carrier have one.
  std::optional<double> total_mass_kg;
  std::string total_mass_missing;  ///< parts without mass, with what gives it one
  /// Empty where a moving body's inertia is not known.  A carrier of which nothing is stated counts
  /// as zero (counts_carrier).
  std::optional<inertia::BodyInertias<double>> bodies;
  std::string bodies_missing;  ///< keys
  bool counts_carrier = false;
  /// Pins stand in planets without a bore: both count where the pin is.
  bool pins_in_solid_planets = false;
};

/// Of a train whose MassModel has bodies and !counts_carrier.
inline constexpr std::string_view kCarrierNotCounted =
    "inertia counts no carrier: state inertia.carrier_kgm2, or its carrier_outer_diameter_mm and "
    "carrier_thickness_mm";

/// Mass and inertia of every part.
///
///   gears    hollow cylinders, inertia::gear_body(), of density_of() each
///   carrier  J = ½ m (ro² + ri²) of its plates; as a moving body with its N pins:
///            J + Σ (J_pin + m_pin d²)
///
/// The pins orbit with the carrier at the centre distance d and do not spin with their planets.
/// Pins and plates without a density of their own have that of all gears; a stated carrier inertia
/// holds the pins already.
/// Source: volume integrals, parallel-axis theorem.
/// Does not account for: windows and bores of the plates where planets and pins sit, bearings,
/// shafts, webs, housing.
/// @throws std::invalid_argument where a bore is not below the part's outer radius
MassModel mass_model(const Masses& masses, const train::TrainGeometry<double>& train);

}  // namespace gear3k::design
