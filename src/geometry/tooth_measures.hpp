#pragma once
// What an inspector measures on a gear, and what the drawing states.

#include <optional>

#include "geometry/tooth_form.hpp"

namespace gear3k::geometry {

/// Base tangent length W_k over k teeth (a ring: over k spaces).
///
///   external: W_k = m cos α ((k − ½) π + z inv α) + 2 x m sin α − q m
///   ring:     W_k = m cos α ((k − ½) π + z inv α) + 2 x m sin α + q m
///
/// k is the whole number whose flanks are touched nearest to the circle d + 2 x m.
/// Source: ISO 21771 (span measurement), docs/theory §21.
struct SpanMeasure {
  int count = 0;                  ///< k
  double length_m = 0.0;          ///< W_k
  double contact_radius_m = 0.0;  ///< sqrt(rb² + (W_k/2)²)
};
/// Empty where the flanks do not carry the measure: contact outside the tip circle or beyond the
/// form circle for every k.
std::optional<SpanMeasure> span_measure(const GearGeometry<double>& g);

/// Dimension over two pins (a ring: between them), spaces as opposite as they can be.
///
///   external: inv α_M = inv α − η + D_M/d_b;  ring: inv α_M = inv α + η − D_M/d_b
///   with η the half angle of the space on the reference circle, r_M = rb/cos α_M
///   M = 2 r_M (cos(π/2z) when z is odd) ± D_M
///
/// Source: ISO 21771 (measurement over balls or pins), docs/theory §21.
struct PinMeasure {
  double pin_diameter_m = 0.0;    ///< D_M
  double over_pins_m = 0.0;       ///< M
  double contact_radius_m = 0.0;  ///< where the pin touches the flank
};
/// @param pin_diameter_m  given, or else the pin that touches the flanks on the circle d + 2 x m,
///   rounded up to 0.01 mm
/// Empty where such a pin finds no seat on the flanks or touches the root circle.
std::optional<PinMeasure> pin_measure(const GearGeometry<double>& g,
                                      std::optional<double> pin_diameter_m);

/// Diameters of the pins that find a seat: from the one that touches on the form circle, or clears
/// the root circle, to the one that touches on the tip circle.
struct PinRange {
  double least_m = 0.0, greatest_m = 0.0;  ///< greatest_m infinite: no pin touches beyond the tip
};
/// Accuracy: 1e-9 of the diameter, by halving between a pin that pin_measure() seats and one that
/// it does not.  @returns empty where no pin finds a seat
std::optional<PinRange> fitting_pins(const GearGeometry<double>& g);

/// Tooth thickness on the reference circle as a chord, and the height of that chord below the tip
/// circle.
///
///   s_c = d sin(s/d),  h_c = ± (ra − r + r (1 − cos(s/d))),  + external, − ring
///
/// Source: ISO 21771 (chordal tooth thickness), docs/theory §21.
struct ChordalThickness {
  double chord_m = 0.0, height_m = 0.0;
};
ChordalThickness chordal_thickness(const GearGeometry<double>& g);

/// Width of the space (arc) on the root circle, by the involutes continued to it; empty where the
/// root circle lies inside the base circle.
std::optional<double> root_space_width(const GearGeometry<double>& g);

/// Chord of the tooth where its flanks end at the fillets.
double form_circle_thickness(const GearGeometry<double>& g, const ToothForm<double>& form);

/// Generating profile shift and root radius when a tool of nominal thickness is fed deeper to thin
/// the tooth by m q, instead of a thicker tool at nominal depth:
///   x_E = x − q/(2 sin α) external, x + q/(2 sin α) ring; the root circle moves with it
/// Source: ISO 21771 (generating profile shift), docs/theory §21.
struct Infeed {
  double profile_shift = 0.0;  ///< x_E
  double root_radius_m = 0.0;
};
Infeed infeed(const GearGeometry<double>& g);

}  // namespace gear3k::geometry
