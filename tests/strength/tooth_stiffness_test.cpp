#include "strength/tooth_stiffness.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "numerics/gauss_rule.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::strength::tooth_stiffness_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// The gear of ROSS's tests: petrobras/ross, ross/tests/test_gear_element.py (89c8ba9) and
/// ross/gear_element.py: a rack-cut tooth with a full fillet, plane stress, the body by Sainsot,
/// Velex and Duverger (2004).  Formulas as published there; not those of the product.
struct RossGear {
  static constexpr int kTeeth = 62;
  static constexpr double kModule = 2e-3, kWidth = 20e-3, kBore = 35e-3, kE = 206e9, kNu = 0.3;
  static constexpr double kAngle = 20.0 * kPi / 180.0;
  double rp = 0.5 * kModule * kTeeth;
  double rb = rp * std::cos(kAngle);
  double ra = rp + kModule;
  double rf = rp - 1.25 * kModule;
  double rho = 0.25 * kModule / (1.0 - std::sin(kAngle));
  double a = 1.25 * kModule - rho;
  double b = kPi * kModule / 4.0 + kModule * std::tan(kAngle) + rho * std::cos(kAngle);
  double theta_b = kPi / (2.0 * kTeeth) + std::tan(kAngle) - kAngle;
  double alpha_a = std::acos(rb / ra);
  double alpha_c =
      std::acos(rb / std::hypot(rb * std::tan(kAngle) - kModule / std::sin(kAngle), rb));

  [[nodiscard]] double turn(double alpha) const { return std::tan(alpha) - theta_b; }

  /// Half thickness x and height y, and dy by the parameter.
  struct Contour {
    double x, y, dy;
  };
  [[nodiscard]] Contour involute(double tau) const {
    const double sum = tau + theta_b;
    return {.x = rb * (sum * std::cos(tau) - std::sin(tau)),
            .y = rb * (sum * std::sin(tau) + std::cos(tau)),
            .dy = rb * sum * std::cos(tau)};
  }
  [[nodiscard]] Contour transition(double gamma) const {
    using Slope = ceres::Jet<double, 1>;
    const Slope g(gamma, 0);
    const Slope phi = (a * cos(g) / sin(g) + b) / rp;
    const Slope reach = a / sin(g) + rho;
    const Slope x = rp * sin(phi) - reach * cos(g - phi);
    const Slope y = rp * cos(phi) - reach * sin(g - phi);
    return {.x = x.a, .y = y.a, .dy = y.v[0]};
  }

  [[nodiscard]] double sainsot_body(double tau) const {
    const double theta_f = (kPi / 2.0 + 2.0 * std::tan(kAngle) * (1.0 - rho / kModule) +
                            2.0 * rho / kModule / std::cos(kAngle)) /
                           kTeeth;
    const double h = rf / (0.5 * kBore);
    const auto fit = [&](const std::array<double, 6>& c) {
      return c[0] / (theta_f * theta_f) + c[1] * h * h + c[2] * h / theta_f + c[3] / theta_f +
             c[4] * h + c[5];
    };
    const double L = fit({-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045});
    const double M = fit({60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086});
    const double P = fit({-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236});
    const double Q = fit({-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904});
    const double u = (involute(tau).y - rf) / (2.0 * rf * theta_f);
    const double c = std::cos(tau), t = std::tan(tau);
    return c * c / (kE * kWidth) * (L * u * u + M * u + P * (1.0 + Q * t * t));
  }

  /// Compliance of the tooth with its beam by the product, [m/N].
  [[nodiscard]] double compliance(double alpha) const {
    static const auto kRule = numerics::gauss_rule<24>();
    const double tau = turn(alpha);
    const double tau_c = turn(alpha_c);
    std::vector<BeamSlice<double>> slices;
    slices.reserve(2 * kRule.size());
    for (const numerics::GaussNode& node : kRule) {
      const double span = kAngle - 0.5 * kPi;
      const Contour root = transition(0.5 * kPi + node.position * span);
      slices.push_back({.height_m = root.y - rf,
                        .thickness_m = 2.0 * root.x,
                        .length_m = node.weight * span * root.dy});
      const Contour flank = involute(tau_c + node.position * (tau - tau_c));
      slices.push_back({.height_m = flank.y - rf,
                        .thickness_m = 2.0 * flank.x,
                        .length_m = node.weight * (tau - tau_c) * flank.dy});
    }
    const Contour at = involute(tau);
    const BeamLoad<double> load{.crossing_height_m = at.y - at.x * std::tan(tau) - rf,
                                .tan_angle = std::tan(tau)};
    const BeamModuli moduli{.normal_Pa = kE, .shear_Pa = kE / (2.0 * (1.0 + kNu))};
    return beam_compliance<double>(slices, load, moduli) / kWidth + sainsot_body(tau);
  }

  [[nodiscard]] double contact_stiffness() const {
    return kPi * kE * kWidth / (4.0 * (1.0 - kNu * kNu));
  }
  [[nodiscard]] double contact_ratio() const {
    return (2.0 * std::sqrt(ra * ra - rb * rb) - 2.0 * rp * std::sin(kAngle)) /
           (2.0 * kPi * rb / kTeeth);
  }
  [[nodiscard]] double pair(double turned) const {
    return 1.0 / (1.0 / contact_stiffness() + compliance(alpha_c + turned) +
                  compliance(alpha_a - turned));
  }
  [[nodiscard]] double mesh(double angle) const {
    const double pitch = (alpha_a - alpha_c) / contact_ratio();
    const double turned = pitch * angle * kTeeth / (2.0 * kPi);
    double k = pair(turned);
    if (turned <= pitch * (contact_ratio() - 1.0)) k += pair(turned + pitch);
    return k;
  }
};

TEST(ToothStiffness, RossNumbersWithRossBodyAndTooth) {
  const RossGear gear;
  LargestDeviation largest;
  largest.see(0, gear.contact_stiffness() - 3555868607.9093266, 1e-6 * 3555868607.9093266);
  EXPECT_NEAR(gear.contact_ratio(), 1.7897798668330458, 1e-12);
  constexpr std::array kPublished{396622921.3581085, 396738680.0375346, 396854147.2919756,
                                  396969323.136738, 397084207.5865779};
  const double step = 2.0 * kPi / RossGear::kTeeth / 999.0;
  for (std::size_t i = 0; i < kPublished.size(); ++i) {
    largest.see(static_cast<int>(i), gear.mesh(static_cast<double>(i) * step) - kPublished[i],
                1e-6 * kPublished[i]);
  }
  double greatest = 0.0;
  for (int i = 0; i < 1000; ++i) greatest = std::max(greatest, gear.mesh(i * step));
  largest.see(0, greatest - 419569438.98401976, 1e-6 * greatest);
  largest.expect_allowed("7 figures, 1e-6");
}

geometry::GearGeometry<double> gear_of(int teeth, geometry::GearKind kind, double shift,
                                       double module = 1e-3) {
  const auto angle = geometry::make_pressure_angle(20.0 * kPi / 180.0);
  return geometry::make_gear_geometry(
      geometry::Gear<double>{
          .teeth = teeth, .kind = kind, .module_m = module, .profile_shift = shift, .rack = {}},
      angle);
}

/// Angle of the contour's tangent with the tooth's axis, from the contour alone.
double tangent_at(const geometry::GearGeometry<double>& g, const geometry::ToothForm<double>& form,
                  double radius) {
  const double h = 1e-5 * g.gear.module_m;
  const auto point = [&](double r) {
    const double psi = kPi / g.gear.teeth - geometry::contour_half_angle(g, form, r);
    return std::array{r * std::cos(psi), r * std::sin(psi)};
  };
  const auto a = point(radius - h), b = point(radius + h);
  return std::atan2(std::abs(b[1] - a[1]), std::abs(b[0] - a[0]));
}

struct Tooth {
  int teeth;
  geometry::GearKind kind;
  double shift;
  int cutter_teeth = 0;
};
std::vector<Tooth> teeth() {
  using geometry::GearKind;
  return {{17, GearKind::kExternal, 0.2},  {12, GearKind::kExternal, 0.0},
          {40, GearKind::kExternal, -0.3}, {100, GearKind::kExternal, 0.5},
          {60, GearKind::kRing, 0.0},      {100, GearKind::kRing, 0.4},
          {90, GearKind::kRing, 0.1, 25},  {150, GearKind::kRing, -0.2, 40}};
}
geometry::GearGeometry<double> gear_of(const Tooth& t) {
  geometry::GearGeometry<double> g = gear_of(t.teeth, t.kind, t.shift);
  g.gear.cutter = {.teeth = t.cutter_teeth, .profile_shift = 0.0, .tip_radius = 0.2};
  return g;
}

TEST(ToothStiffness, BaseSectionIsWhereTheContourHasTheAngle) {
  for (const Tooth& t : teeth()) {
    const auto g = gear_of(t);
    const auto form = geometry::make_tooth_form(g);
    const auto section = root_section(g, form);
    const double radius = std::hypot(section.height_m, 0.5 * section.chord_m);
    const double wanted = (t.kind == geometry::GearKind::kExternal ? 30.0 : 60.0) * kPi / 180.0;
    EXPECT_NEAR(tangent_at(g, form, radius), wanted, 1e-5) << t.teeth;
    const double psi = kPi / t.teeth - geometry::contour_half_angle(g, form, radius);
    EXPECT_NEAR(section.chord_m, 2.0 * radius * std::sin(psi), 1e-12);
  }
}

/// The beam by brute force: the contour sampled over its height.
double sampled_beam(const geometry::GearGeometry<double>& g,
                    const geometry::ToothForm<double>& form, double height_c, double tan_angle,
                    const Elasticity& material) {
  const auto section = root_section(g, form);
  const double outwards = g.gear.kind == geometry::GearKind::kExternal ? 1.0 : -1.0;
  const auto chord_at = [&](double height) {
    // The radius whose contour point has this height.
    const double y = section.height_m + outwards * height;
    double low = 0.9 * y, high = 1.1 * y;
    for (int i = 0; i < 60; ++i) {
      const double r = 0.5 * (low + high);
      const double psi = kPi / g.gear.teeth - geometry::contour_half_angle(g, form, r);
      (r * std::cos(psi) < y ? low : high) = r;
    }
    return 2.0 * std::sqrt((low - y) * (low + y));
  };
  constexpr int kSteps = 800;
  double bending = 0.0, area = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double dh = height_c / kSteps;
    const double height = (i + 0.5) * dh;
    const double s = chord_at(height);
    const double u = height - height_c;
    bending += u * u / (s * s * s) * dh;
    area += dh / s;
  }
  const double cos2 = 1.0 / (1.0 + tan_angle * tan_angle);
  const double E = material.youngs_modulus_Pa, nu = material.poissons_ratio;
  const double plane = E / (1.0 - nu * nu);
  return 12.0 * cos2 * bending / plane + 12.0 * (1.0 + nu) / 5.0 * cos2 * area / E +
         (1.0 - cos2) * area / plane;
}

TEST(ToothStiffness, BeamIsThatOfTheSampledContour) {
  const Elasticity steel{.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3};
  for (const Tooth& t : teeth()) {
    const auto g = gear_of(t);
    const auto form = geometry::make_tooth_form(g);
    const auto tooth = make_elastic_tooth(g, form);
    const double tip = geometry::tip_curvature_radius(g);
    for (const double share : {0.0, 0.4, 1.0}) {
      const double rho = form.form_length_m + share * (tip - form.form_length_m);
      const auto load = flank_load(tooth, rho);
      if (load.beam.crossing_height_m <= 0.0) continue;
      // Load line and flank by coordinates: the line through the contact, tangent to the base
      // circle, crosses the axis at h_c.
      const double r = std::hypot(g.base_radius_m, rho);
      const double psi = kPi / t.teeth - geometry::contour_half_angle(g, form, r);
      const double outwards = t.kind == geometry::GearKind::kExternal ? 1.0 : -1.0;
      const double crossing =
          root_section(g, form).height_m + outwards * load.beam.crossing_height_m;
      EXPECT_NEAR(crossing, r * std::cos(psi) - outwards * r * std::sin(psi) * load.beam.tan_angle,
                  1e-13);
      EXPECT_NEAR(load.depth_m, std::hypot(r * std::sin(psi), r * std::cos(psi) - crossing), 1e-13);
      const double expected =
          sampled_beam(g, form, load.beam.crossing_height_m, load.beam.tan_angle, steel) +
          body_compliance(load.beam, root_section(g, form).chord_m, steel);
      EXPECT_NEAR(tooth_compliance(tooth, load, steel), expected, 1e-6 * expected)
          << t.teeth << " at " << share;
    }
  }
}

TEST(ToothStiffness, ContactIsTheStrainUnderAHalfEllipseOfPressure) {
  const Elasticity material{.youngs_modulus_Pa = 70e9, .poissons_ratio = 0.33};
  const double E = material.plane_strain_modulus();
  const double nu = material.poissons_ratio;
  const double a = 1e-4;
  for (const double depth : {0.2e-4, 1e-4, 5e-4, 2e-3}) {
    // Stresses on the axis of a Hertzian line contact of unit line load, plane strain.
    const double p0 = 2.0 / (kPi * a);
    constexpr int kSteps = 200000;
    double approach = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double z = (i + 0.5) * depth / kSteps;
      const double root = std::hypot(a, z);
      const double along = -p0 * a / root;
      const double across = -p0 * ((a * a + 2.0 * z * z) / (a * root) - 2.0 * z / a);
      approach += -(along - nu / (1.0 - nu) * across) / E * depth / kSteps;
    }
    EXPECT_NEAR(contact_compliance(depth, a, material), approach, 1e-8 * approach);
  }
  // The limit of a depth that is large against the contact.
  const double far = 2.0 / (kPi * E) * (std::log(2.0 * 1e4) - nu / (2.0 * (1.0 - nu)));
  EXPECT_NEAR(contact_compliance(1e4 * a, a, material), far, 1e-8 * far);
}

TEST(ToothStiffness, ComplianceIsContinuousWhereTheLoadCrossesBaseAndFormCircle) {
  const Elasticity steel{.youngs_modulus_Pa = 206e9, .poissons_ratio = 0.3};
  const auto g = gear_of(100, geometry::GearKind::kExternal, 0.0);
  const auto tooth = make_elastic_tooth(g, geometry::make_tooth_form(g));
  for (const double height : {0.0, tooth.form_height_m}) {
    const auto at = [&](double h) {
      const FlankLoad<double> load{.beam = {.crossing_height_m = h, .tan_angle = 0.4}};
      return tooth_compliance(tooth, load, steel);
    };
    const double h = 1e-9;
    const double value = at(height);
    EXPECT_NEAR(at(height + h), at(height - h), 1e-4 * value);
    // ... and so is its slope.
    const double above = (at(height + 2.0 * h) - at(height + h)) / h;
    const double below = (at(height - h) - at(height - 2.0 * h)) / h;
    EXPECT_NEAR(above, below, 1e-3 * std::abs(above)) << height;
  }
}

TEST(ToothStiffness, BadElasticConstantsAreNamed) {
  EXPECT_THROW(check_elasticity({.youngs_modulus_Pa = 0.0, .poissons_ratio = 0.3}),
               std::invalid_argument);
  EXPECT_THROW(check_elasticity({.youngs_modulus_Pa = 2e11, .poissons_ratio = 0.5}),
               std::invalid_argument);
  EXPECT_THROW(check_elasticity({.youngs_modulus_Pa = std::numeric_limits<double>::quiet_NaN(),
                                 .poissons_ratio = 0.3}),
               std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::tooth_stiffness_test
