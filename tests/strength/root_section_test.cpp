#include "strength/root_section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "geometry/outline.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_numbers.hpp"

namespace gear3k::strength::root_section_test {
namespace {

using geometry::Gear;
using geometry::GearGeometry;
using geometry::GearKind;
using geometry::make_gear_geometry;
using geometry::make_pressure_angle;
using geometry::make_tooth_form;
using geometry::PinionCutter;
using geometry::Point;

constexpr double kPi = std::numbers::pi;

class Random : public RandomNumbers {
 public:
  using RandomNumbers::RandomNumbers;

  GearGeometry<double> external() {
    Gear<double> gear{.teeth = count(12, 90),
                      .module_m = between(0.4e-3, 3e-3),
                      .profile_shift = between(-0.3, 0.8),
                      .machining_allowance = between(0.0, 0.05),
                      .rack = {.root_radius = between(0.1, 0.4)}};
    return make_gear_geometry(gear, make_pressure_angle(between(18.0, 25.0) * kPi / 180.0));
  }
  GearGeometry<double> ring(bool with_cutter) {
    Gear<double> gear{.teeth = count(50, 150),
                      .kind = GearKind::kRing,
                      .module_m = between(0.4e-3, 3e-3),
                      .profile_shift = between(0.0, 1.0),
                      .machining_allowance = between(0.0, 0.05),
                      .rack = {.root_radius = between(0.1, 0.3)}};
    if (with_cutter) {
      gear.cutter = {.teeth = count(18, 30),
                     .profile_shift = between(-0.1, 0.2),
                     .tip_radius = between(0.05, 0.25)};
    }
    return make_gear_geometry(gear, make_pressure_angle(between(18.0, 25.0) * kPi / 180.0));
  }
};

struct FoundSection {
  double chord_m = 0.0, height_m = 0.0, fillet_radius_m = 0.0;
  int crossings = 0;
};

/// Radius of the circle through three points.
double circle_radius(const Point& a, const Point& b, const Point& c) {
  const double ab = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
  const double bc = std::hypot(c.x_m - b.x_m, c.y_m - b.y_m);
  const double ca = std::hypot(a.x_m - c.x_m, a.y_m - c.y_m);
  const double twice_area =
      std::abs((b.x_m - a.x_m) * (c.y_m - a.y_m) - (b.y_m - a.y_m) * (c.x_m - a.x_m));
  return ab * bc * ca / (2.0 * twice_area);
}

/// The point of the outline whose chord to the next point has the angle with the tooth's axis, on
/// the half y < 0, below the form circle.
FoundSection search_outline(const GearGeometry<double>& gear, double angle_rad) {
  const auto points = geometry::tooth_outline(gear, 2e-8 * gear.gear.module_m);
  const auto form = make_tooth_form(gear);
  const double outwards = gear.gear.kind == GearKind::kRing ? -1.0 : 1.0;
  FoundSection found;
  const auto lean = [&](std::size_t i) {
    return std::atan2(points[i + 1].y_m - points[i].y_m,
                      outwards * (points[i + 1].x_m - points[i].x_m)) -
           angle_rad;
  };
  for (std::size_t i = 0; i + 2 < points.size(); ++i) {
    const Point& p = points[i + 1];
    const double radius = std::hypot(p.x_m, p.y_m);
    if (p.y_m >= 0.0 || outwards * (radius - form.form_radius_m) > 0.0) break;
    const double before = lean(i), after = lean(i + 1);
    if (!(before > 0.0 && after <= 0.0)) continue;
    ++found.crossings;
    const double share = before / (before - after);
    const Point a{.x_m = 0.5 * (points[i].x_m + p.x_m), .y_m = 0.5 * (points[i].y_m + p.y_m)};
    const Point b{.x_m = 0.5 * (p.x_m + points[i + 2].x_m),
                  .y_m = 0.5 * (p.y_m + points[i + 2].y_m)};
    found.height_m = a.x_m + share * (b.x_m - a.x_m);
    found.chord_m = -2.0 * (a.y_m + share * (b.y_m - a.y_m));
    const std::size_t step = 8;
    if (i >= step && i + step + 1 < points.size()) {
      found.fillet_radius_m = circle_radius(points[i + 1 - step], p, points[i + 1 + step]);
    }
  }
  return found;
}

// The outline's chords are within 2e-8 modules, that is some 2e-4 modules long: interpolation
// between them leaves below 2e-7, and a circle through points 16 chords apart tells its radius to
// 2e-3.
constexpr double kSearchTolerance_modules = 2e-7;
constexpr double kCurvatureTolerance = 2e-3;

void expect_searched(const std::function<GearGeometry<double>(Random&)>& draw, const char* what) {
  Random random(41);
  LargestDeviation chord, height, curvature;
  int found = 0;
  for (int i = 0; i < 60; ++i) {
    const auto gear = draw(random);
    const auto form = make_tooth_form(gear);
    if (form.cutter_room < 0.0) continue;
    const auto section = root_section(gear, form);
    if (!section.on_fillet) continue;
    const auto searched = search_outline(gear, root_tangent_angle(gear.gear.kind));
    ASSERT_EQ(searched.crossings, 1) << what << " " << i;
    ++found;
    const double m = gear.gear.module_m;
    chord.see(i, section.chord_m - searched.chord_m, kSearchTolerance_modules * m);
    height.see(i, section.height_m - searched.height_m, kSearchTolerance_modules * m);
    if (searched.fillet_radius_m > 0.0) {
      curvature.see(i, section.fillet_radius_m - searched.fillet_radius_m,
                    kCurvatureTolerance * searched.fillet_radius_m);
    }
  }
  EXPECT_GE(found, 40) << what;
  chord.expect_allowed(std::string(what) + "_chord");
  height.expect_allowed(std::string(what) + "_height");
  curvature.expect_allowed(std::string(what) + "_curvature");
}

TEST(RootSection, OfARackIsTheOneFoundOnTheOutline) {
  expect_searched([](Random& random) { return random.external(); }, "rack");
}
TEST(RootSection, OfACutterIsTheOneFoundOnTheOutline) {
  expect_searched([](Random& random) { return random.ring(true); }, "cutter");
}
TEST(RootSection, OfAnArcIsTheOneFoundOnTheOutline) {
  expect_searched([](Random& random) { return random.ring(false); }, "arc");
}

TEST(RootSection, ArcCutterAndRackAgreeWhereTeethAreMany) {
  const double m = 1e-3, rho = 0.3, tau = kPi / 4.0;
  const auto angle = make_pressure_angle(20.0 * kPi / 180.0);
  // Chord, depth below the reference circle and radius of the rack's own tooth.
  const double h_f = 1.25;
  const double half_space =
      kPi / 4.0 - h_f * angle.tan - rho * (1.0 - angle.sin) / angle.cos + rho * std::cos(tau);
  const double chord = m * (kPi - 2.0 * half_space);
  const double depth = m * (h_f - rho + rho * std::sin(tau));
  for (const int z : {1000, 10000, 100000}) {
    for (const int kind : {0, 1, 2}) {
      Gear<double> gear{.teeth = z,
                        .kind = kind == 0 ? GearKind::kExternal : GearKind::kRing,
                        .module_m = m,
                        .rack = {.root_radius = rho}};
      if (kind == 1) gear.cutter = {.teeth = z / 2, .profile_shift = 0.0, .tip_radius = rho};
      const auto g = make_gear_geometry(gear, angle);
      const auto section = root_section(g, make_tooth_form(g), tau);
      // Deviations are those of a circle of z teeth from a straight line, and of the position of a
      // difference of two large radii.
      const double allowed = m * (15.0 / z + 1e-15 * z);
      EXPECT_NEAR(section.chord_m, chord, allowed) << z << " " << kind;
      EXPECT_NEAR(std::abs(g.reference_radius_m - section.height_m), depth, allowed)
          << z << " " << kind;
      EXPECT_NEAR(section.fillet_radius_m, rho * m, allowed) << z << " " << kind;
    }
  }
}

TEST(RootSection, OfAnExternalGearIsTheRackFormulaOfTheRules) {
  // The auxiliary quantities E, G, H and the angle, by plain iteration.
  Random random(43);
  LargestDeviation largest;
  for (int i = 0; i < 200; ++i) {
    auto gear = random.external().gear;
    gear.machining_allowance = 0.0;
    gear.teeth += 6;
    const auto g = make_gear_geometry(gear, make_pressure_angle(20.0 * kPi / 180.0));
    const auto form = make_tooth_form(g);
    const auto section = root_section(g, form);
    if (!section.on_fillet || form.full_round) continue;
    const double z = gear.teeth, rho = gear.rack.root_radius, tau = kPi / 6.0;
    const double E = kPi / 4.0 - 1.25 * g.angle.tan - (1.0 - g.angle.sin) * rho / g.angle.cos;
    const double G = rho - 1.25 + gear.profile_shift;
    const double H = (2.0 / z) * (kPi / 2.0 - E) - (kPi / 2.0 - tau);
    double theta = kPi / 6.0;
    for (int n = 0; n < 400; ++n) theta = (2.0 * G / z) * std::tan(theta) - H;
    const double w = G / std::cos(theta) - rho;
    const double chord = z * std::sin(kPi / 2.0 - tau - theta) + 2.0 * w * std::cos(tau);
    const double height = 0.5 * z * std::cos(kPi / 2.0 - tau - theta) + w * std::sin(tau);
    const double c = std::cos(theta);
    const double radius = rho + 2.0 * G * G / (c * (z * c * c - 2.0 * G));
    const double m = gear.module_m;
    largest.see(i, section.chord_m / m - chord, 1e-12);
    largest.see(i, section.height_m / m - height, 1e-12);
    largest.see(i, section.fillet_radius_m / m - radius, 1e-11);
  }
  largest.expect_allowed("rack_formula");
}

TEST(RootSection, RefusesWhatHasNoMeaning) {
  Random random(1);
  const auto external = random.external();
  const auto form = make_tooth_form(external);
  for (const double angle : {0.0, -1.0, kPi / 2.0, std::nan("")}) {
    EXPECT_THROW(root_section(external, form, angle), std::invalid_argument) << angle;
  }
  EXPECT_THROW(virtual_rack_section(external, 0.3), std::invalid_argument);
  EXPECT_THROW(virtual_rack_section(random.ring(true), -0.1), std::invalid_argument);
  EXPECT_THROW(virtual_rack_section(random.ring(true), std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace gear3k::strength::root_section_test
