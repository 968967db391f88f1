#pragma once
// The gears of a design placed for drawing: each alone, and the assembled train.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "design/evaluation.hpp"
#include "geometry/outline.hpp"

namespace gear3k::drawing {

/// Where each gear of an assembled train stands.  Angles are those of tooth 0, which lies on the
/// +x axis at 0; counter-clockwise is positive.
struct TrainPlacement {
  struct Planet {
    double carrier_rad = 0.0;  ///< θ_i: direction of its axis seen from the sun's
    double p1_rad = 0.0;       ///< ψ_P1
    double p2_rad = 0.0;       ///< ψ_P2
  };
  double sun_rad = 0.0, ring1_rad = 0.0, ring2_rad = 0.0;
  std::vector<Planet> planets;  ///< all N, or planet 0 alone where they cannot be equally spaced
};

/// Turns every gear so that each tooth stands in the middle of its mate's space.
///
/// A mesh with centred backlash is symmetric about the centre line whenever a tooth of one gear and
/// a space of the other lie on it; rolling on moves both flanks' contacts along their lines of
/// action by the same length, so that it stays centred.  Count a gear's phase in its own teeth,
/// z (ψ − direction to the mate), a full turn being one tooth: 0 = tooth on the centre line,
/// π = space on it.  Rolling keeps the sum (external pair) or difference (ring) of the two phases.
/// With the planet in direction θ of the sun and the sun in direction θ + π of the planet, modulo
/// 2π:
///
///   S-P1:   zS (ψ_S − θ) + zP1 (ψ_P1 − θ − π) = π                                        (1)
///   P-R:    zP (ψ_P − θ) − zR (ψ_R − θ) = π                                              (2)
///
/// at any centre distance.  Planet 0 has θ = 0 and both its teeth 0 on the x axis, ψ_P1 = ψ_P2 = 0:
///
///   (1) → ψ_S = π (1 + zP1)/zS,    (2) → ψ_R1 = π/zR1,  ψ_R2 = π/zR2
///
/// The central gears keep these.  For planet i at θ_i = 2π i/N, (2) reads zP ψ_P = (zP − zR) θ_i:
///
///   ψ_P1 = θ_i (1 − zR1/zP1),   ψ_P2 = θ_i (1 − zR2/zP2)                                 (3)
///
/// (1) then asks for (zS + zR1) θ_i = 0 modulo 2π, that is N | zS + zR1: equal_spacing.  From (3),
/// ψ_P2 − ψ_P1 = θ_i (zR1/zP1 − zR2/zP2), which is train::Assembly::planet_phase_rad modulo
/// 2π/lcm(zP1, zP2).  Angles come from integers reduced to less than one tooth: no digits are lost.
/// Source: own derivation, as above; docs/theory §7 for the phases.
/// @throws std::invalid_argument when planets < 1
TrainPlacement place_train(const train::ToothSet& z, int planets);

/// One gear where it stands.
struct DrawnGear {
  std::string name;  ///< layer: S, R1, P2; planets of the train P1_1, P1_2 ...
  train::GearId id = train::kS;
  int planet = 0;  ///< counted from 1; 0 in a central gear and in a gear drawn alone
  double angle_rad = 0.0;
  geometry::Point center;
  std::vector<geometry::Point> contour;  ///< closed, counter-clockwise, in place
  double reference_radius_m = 0.0, base_radius_m = 0.0, tip_radius_m = 0.0, root_radius_m = 0.0;
  std::optional<double> bore_radius_m;   ///< external gears, where the design gives it
  std::optional<double> outer_radius_m;  ///< rings, where the design gives it
  /// Timing mark on a tooth of P1 and of P2 (planet_marks.hpp), in place.
  std::optional<geometry::Point> mark{};
  int teeth = 0;
  double module_m = 0.0, profile_shift = 0.0;
};

struct Drawing {
  std::string name;    ///< of the file, without extension: S, P1, R1, P2, R2, train
  std::string title;   ///< of the design
  std::string remark;  ///< what the reader must know of this drawing; "" = nothing
  std::vector<DrawnGear> gears;
};

/// Radius of a timing mark.
inline double mark_radius_m(const DrawnGear& gear) { return 0.2 * gear.module_m; }

/// A ring's body without an outer diameter is drawn to so many modules beyond its root.
inline constexpr double kDrawnRim = 2.5;
/// The radius to which a ring's body is drawn: the one given, else that of kDrawnRim.
double drawn_outer_radius(const DrawnGear& ring);

struct DrawingSet {
  std::vector<Drawing> drawings;   ///< S, P1, R1, P2, R2, train
  std::vector<std::string> notes;  ///< what a reader of the drawings must know
};

/// Which checks fail; "" where all hold.
std::string failed_checks_text(const std::vector<design::CheckResult>& checks);

/// Every drawing of a design, by its evaluation (which holds the centre distance in use).
///
/// Planets that cannot be equally spaced: the train shows planet 1 alone, and a note says so.
/// Failed checks, planets that are no one part and a centre distance that was not given are notes.
/// @param chord_error_m  greatest distance of a chord from the contour
/// @throws std::invalid_argument unless chord_error_m > 0
DrawingSet make_drawings(const design::Design& design, const design::Evaluation& evaluation,
                         double chord_error_m);

}  // namespace gear3k::drawing
