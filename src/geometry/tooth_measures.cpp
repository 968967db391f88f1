#include "geometry/tooth_measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/involute.hpp"

namespace gear3k::geometry {

namespace {

constexpr double kPinStep_m = 1e-5;
/// Circles between tip and form circle on which a pin is tried, and halvings towards the ends of
/// the pins that fit.
constexpr int kSeatSamples = 32, kSeatHalvings = 40;
/// Over the reference radius: a larger pin stands for all.
constexpr double kLargestPin = 100.0;

double sign_of(const GearGeometry<double>& g) {
  return g.gear.kind == GearKind::kExternal ? 1.0 : -1.0;
}

/// The circle d + 2 x m, on which measurements touch best.
double middle_radius(const GearGeometry<double>& g) {
  return g.reference_radius_m + g.gear.profile_shift * g.gear.module_m;
}

bool on_flank(const GearGeometry<double>& g, double form_radius, double radius_m) {
  return g.gear.kind == GearKind::kExternal ? radius_m >= form_radius && radius_m <= g.tip_radius_m
                                            : radius_m <= form_radius && radius_m >= g.tip_radius_m;
}

double reference_space_half_angle(const GearGeometry<double>& g) {
  return std::numbers::pi / g.gear.teeth -
         reference_tooth_thickness(g) / (2.0 * g.reference_radius_m);
}

/// The pin that touches the flanks on a circle: its centre lies on the middle of the space, on the
/// normal of the contact point.  Empty where the normal does not meet the middle.
std::optional<double> pin_that_touches(const GearGeometry<double>& g, double radius_m) {
  const double sign = sign_of(g);
  const double rb = g.base_radius_m;
  if (!(radius_m > rb)) return std::nullopt;
  const double rho = std::sqrt((radius_m - rb) * (radius_m + rb));
  const double from_tangent = std::atan2(rho, rb) + sign * space_half_angle(g, radius_m);
  const double diameter = 2.0 * sign * (rb * std::tan(from_tangent) - rho);
  if (!(from_tangent > 0.0 && from_tangent < std::numbers::pi / 2.0 && diameter > 0.0)) {
    return std::nullopt;
  }
  return diameter;
}

/// A pin in a space; empty where it finds no seat on the flanks or touches the root circle.
std::optional<PinMeasure> seated_pin(const GearGeometry<double>& g, double form_radius,
                                     double diameter) {
  // Symbols as in ISO 21771.
  const double sign = sign_of(g);
  const double rb = g.base_radius_m;
  const double inv_M =
      g.angle.involute + sign * (diameter / (2.0 * rb) - reference_space_half_angle(g));
  if (!(inv_M > 0.0)) return std::nullopt;
  const double tan_M = std::tan(inverse_involute(inv_M));
  const double r_M = rb * std::hypot(1.0, tan_M);
  const double rho_contact = rb * tan_M - sign * 0.5 * diameter;
  if (!(rho_contact > 0.0)) return std::nullopt;
  const double odd =
      g.gear.teeth % 2 == 0 ? 1.0 : std::cos(std::numbers::pi / (2.0 * g.gear.teeth));
  const PinMeasure measure{.pin_diameter_m = diameter,
                           .over_pins_m = 2.0 * r_M * odd + sign * diameter,
                           .contact_radius_m = std::hypot(rb, rho_contact)};
  const double bottom = r_M - sign * 0.5 * diameter;
  const bool off_root = sign * (bottom - g.root_radius_m) >= 0.0;
  if (!off_root || !on_flank(g, form_radius, measure.contact_radius_m)) return std::nullopt;
  return measure;
}

}  // namespace

std::optional<SpanMeasure> span_measure(const GearGeometry<double>& g) {
  // Symbols as in ISO 21771.
  const double m = g.gear.module_m, z = g.gear.teeth, x = g.gear.profile_shift;
  const double base_pitch = m * std::numbers::pi * g.angle.cos;
  const double shifted = m * g.angle.cos * z * g.angle.involute +
                         (2.0 * x * g.angle.sin - sign_of(g) * g.gear.machining_allowance) * m;
  const auto at = [&](int k) {
    SpanMeasure w{.count = k, .length_m = (k - 0.5) * base_pitch + shifted};
    w.contact_radius_m = std::hypot(g.base_radius_m, 0.5 * w.length_m);
    return w;
  };
  // Half the wanted measure is the flank's normal on the middle circle; 0 inside the base circle.
  const double r = std::max(middle_radius(g), g.base_radius_m);
  const double wanted =
      (2.0 * std::sqrt((r - g.base_radius_m) * (r + g.base_radius_m)) - shifted) / base_pitch + 0.5;
  const double form_radius = make_tooth_form(g).form_radius_m;
  std::optional<SpanMeasure> nearest;
  for (int k = 1; k <= g.gear.teeth; ++k) {
    const SpanMeasure measure = at(k);
    if (!(measure.length_m > 0.0) || !on_flank(g, form_radius, measure.contact_radius_m)) continue;
    if (!nearest || std::abs(k - wanted) < std::abs(nearest->count - wanted)) nearest = measure;
  }
  return nearest;
}

std::optional<PinMeasure> pin_measure(const GearGeometry<double>& g,
                                      std::optional<double> pin_diameter_m) {
  if (!pin_diameter_m) {
    const auto exact = pin_that_touches(g, middle_radius(g));
    if (!exact) return std::nullopt;
    pin_diameter_m = std::ceil(*exact / kPinStep_m - 1e-9) * kPinStep_m;
  }
  return seated_pin(g, make_tooth_form(g).form_radius_m, *pin_diameter_m);
}

std::optional<PinRange> fitting_pins(const GearGeometry<double>& g) {
  const double form_radius = make_tooth_form(g).form_radius_m;
  const auto seated = [&](double diameter) {
    return seated_pin(g, form_radius, diameter).has_value();
  };
  std::optional<double> inside;
  for (int k = 1; k < kSeatSamples && !inside; ++k) {
    const double share = static_cast<double>(k) / kSeatSamples;
    const auto pin = pin_that_touches(g, g.tip_radius_m + share * (form_radius - g.tip_radius_m));
    if (pin && seated(*pin)) inside = pin;
  }
  if (!inside) return std::nullopt;
  const auto end_between = [&](double in, double out) {
    for (int i = 0; i < kSeatHalvings; ++i) {
      const double middle = 0.5 * (in + out);
      (seated(middle) ? in : out) = middle;
    }
    return in;
  };
  double out = 2.0 * *inside;
  const double most = kLargestPin * g.reference_radius_m;
  while (out < most && seated(out)) out *= 2.0;
  return PinRange{.least_m = end_between(*inside, 0.0),
                  .greatest_m = seated(out) ? std::numeric_limits<double>::infinity()
                                            : end_between(*inside, out)};
}

ChordalThickness chordal_thickness(const GearGeometry<double>& g) {
  const double half_angle = reference_tooth_thickness(g) / (2.0 * g.reference_radius_m);
  const double sagitta = g.reference_radius_m * (1.0 - std::cos(half_angle));
  return {.chord_m = 2.0 * g.reference_radius_m * std::sin(half_angle),
          .height_m = sign_of(g) * (g.tip_radius_m - g.reference_radius_m + sagitta)};
}

std::optional<double> root_space_width(const GearGeometry<double>& g) {
  if (!(g.root_radius_m > g.base_radius_m)) return std::nullopt;
  return 2.0 * g.root_radius_m * space_half_angle(g, g.root_radius_m);
}

double form_circle_thickness(const GearGeometry<double>& g, const ToothForm<double>& form) {
  const double half = std::numbers::pi / g.gear.teeth - space_half_angle(g, form.form_radius_m);
  return 2.0 * form.form_radius_m * std::sin(half);
}

Infeed infeed(const GearGeometry<double>& g) {
  const double deeper = sign_of(g) * g.gear.machining_allowance / (2.0 * g.angle.sin);
  return {.profile_shift = g.gear.profile_shift - deeper,
          .root_radius_m = g.root_radius_m - deeper * g.gear.module_m};
}

}  // namespace gear3k::geometry
