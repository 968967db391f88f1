#include "geometry/outline.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/geometry/generated_space.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::geometry::outline_test {
namespace {

using test::flank_half_angle;
using test::polar;
using test::RackTooth;
using test::RingArc;
using test::RingCutter;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

struct Case {
  std::string name;
  GearGeometry<double> gear;
};

GearGeometry<double> gear_with(Gear<double> gear, double alpha_deg = 20.0) {
  gear.module_m = 1e-3;
  return make_gear_geometry(gear, make_pressure_angle(alpha_deg * kPi / 180.0));
}

/// Teeth that end at their tip circle with a land, and flanks that reach it.
std::vector<Case> plain_cases() {
  std::vector<Case> cases;
  const auto external = [&](const std::string& name, int teeth, double x, double q, double rho) {
    cases.push_back(
        {name, gear_with({.teeth = teeth,
                          .kind = GearKind::kExternal,
                          .profile_shift = x,
                          .machining_allowance = q,
                          .tip_shortening = 0.05,
                          .rack = {.addendum = 1.0, .dedendum = 1.25, .root_radius = rho},
                          .cutter = {}})});
  };
  external("z 25", 25, 0.0, 0.0, 0.38);
  external("z 18, shifted and thinned", 18, 0.4, 0.05, 0.3);
  external("z 60, fully rounded root", 60, 0.0, 0.0, 0.6);
  external("z 12, undercut", 12, 0.0, 0.0, 0.2);
  external("z 9, deep undercut", 9, -0.1, 0.02, 0.1);
  external("z 30, sharp corner", 30, 0.1, 0.0, 0.0);
  external("z 101", 101, 0.3, 0.03, 0.38);
  const auto ring = [&](const std::string& name, int teeth, double x, double rho,
                        PinionCutter cutter) {
    cases.push_back(
        {name, gear_with({.teeth = teeth,
                          .kind = GearKind::kRing,
                          .profile_shift = x,
                          .machining_allowance = 0.02,
                          .tip_shortening = 0.0,
                          .rack = {.addendum = 1.0, .dedendum = 1.25, .root_radius = rho},
                          .cutter = cutter})});
  };
  ring("ring 60, arc", 60, 0.0, 0.2, {});
  ring("ring 61, fully rounded root", 61, 0.3, 0.7, {});
  ring("ring 80, cut by 30", 80, 0.4, 0.38,
       {.teeth = 30, .profile_shift = 0.0, .tip_radius = 0.25});
  ring("ring 45, cut by 20", 45, 0.6, 0.38, {.teeth = 20, .profile_shift = 0.1, .tip_radius = 0.1});
  return cases;
}

/// How far a point lies from the generated contour; the middle of the tooth is on the +x axis.
double away_from_contour_m(const GearGeometry<double>& g, const ToothForm<double>& form,
                           const Point& point) {
  const double r = std::hypot(point.x_m, point.y_m);
  const double from_tooth = std::abs(std::atan2(point.y_m, point.x_m));
  const double angle = kPi / g.gear.teeth - from_tooth;  // from the middle of the nearest space
  double least = std::min(std::abs(r - g.tip_radius_m) +
                              (angle < flank_half_angle(g, g.tip_radius_m) - 1e-12 ? 1.0 : 0.0),
                          std::abs(r - g.root_radius_m));
  if (g.gear.kind == GearKind::kExternal) {
    const RackTooth rack(g);
    if (r > rack.root_radius_m() && r <= g.tip_radius_m * (1.0 + 4.0 * kEps)) {
      // The contour at two radii around the point's, for its slope: the angle's deviation counts
      // across the contour.
      const double step = 1e-4 * (r - rack.root_radius_m());
      const double here = rack.at(r).half_angle;
      const double slope =
          (rack.at(r + step).half_angle - rack.at(r - step).half_angle) / (2.0 * step);
      least = std::min(least, r * std::abs(angle - here) / std::hypot(1.0, r * slope));
    }
    return least;
  }
  if (r <= form.form_radius_m * (1.0 + 4.0 * kEps)) {
    return std::min(least, r * std::abs(angle - flank_half_angle(g, r)));
  }
  const test::Spot spot = polar(r, angle);
  if (g.gear.cutter.teeth > 0) {
    const RingCutter cutter(g);
    return std::min(least, std::abs(cutter.nearest_m(spot) - cutter.rounding_m()));
  }
  const RingArc arc(g);
  return std::min(least, std::abs(test::distance_m(spot, arc.center()) - arc.rounding_m()));
}

double distance_to_segment_m(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  const double square = dx * dx + dy * dy;
  const double t =
      square > 0.0 ? std::clamp(((p.x_m - a.x_m) * dx + (p.y_m - a.y_m) * dy) / square, 0.0, 1.0)
                   : 0.0;
  return std::hypot(p.x_m - a.x_m - t * dx, p.y_m - a.y_m - t * dy);
}

double distance_to_line_m(const Point& p, const std::vector<Point>& line) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    least = std::min(least, distance_to_segment_m(p, line[i], line[i + 1]));
  }
  return least;
}

/// A point of the contour on one side of the tooth, from its radius and angle from the space.
Point on_side(const GearGeometry<double>& g, double radius_m, double space_angle, double side) {
  const double angle = side * (kPi / g.gear.teeth - space_angle);
  return {.x_m = radius_m * std::cos(angle), .y_m = radius_m * std::sin(angle)};
}

/// Dense points of the contour: root arc, fillet, flank, tip arc, on both sides of the tooth.
std::vector<Point> dense_contour(const GearGeometry<double>& g, const ToothForm<double>& form) {
  std::vector<Point> points;
  const double tip_angle = flank_half_angle(g, g.tip_radius_m);
  const auto end = fillet_point(form.fillet, kPi / 2.0);
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i <= 1000; ++i) {
      const double share = i / 1000.0;
      points.push_back(on_side(g, g.root_radius_m, share * end.angle_rad, side));
      const double gamma =
          form.form_normal_angle_rad + share * (kPi / 2.0 - form.form_normal_angle_rad);
      const auto p = fillet_point(form.fillet, gamma);
      points.push_back(on_side(g, p.radius_m, p.angle_rad, side));
      const double r = form.form_radius_m + share * (g.tip_radius_m - form.form_radius_m);
      points.push_back(on_side(g, r, flank_half_angle(g, r), side));
      points.push_back(
          on_side(g, g.tip_radius_m, tip_angle + share * (kPi / g.gear.teeth - tip_angle), side));
    }
  }
  return points;
}

double signed_area_m2(const std::vector<Point>& points) {
  double twice = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &a = points[i], &b = points[(i + 1) % points.size()];
    twice += a.x_m * b.y_m - b.x_m * a.y_m;
  }
  return 0.5 * twice;
}

double cross(const Point& o, const Point& a, const Point& b) {
  return (a.x_m - o.x_m) * (b.y_m - o.y_m) - (b.x_m - o.x_m) * (a.y_m - o.y_m);
}
bool properly_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  return cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0;
}
/// Two chords of a closed contour that cross, if any.
std::string crossing(const std::vector<Point>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;
      if (properly_cross(p[i], p[i + 1], p[j], p[(j + 1) % n])) return fmt::format("{}, {}", i, j);
    }
  }
  return "";
}

TEST(ToothOutline, PointsLieOnTheGeneratedContour) {
  LargestDeviation largest;
  for (const auto& [name, g] : plain_cases()) {
    const auto form = make_tooth_form(g);
    const auto points = tooth_outline(g, 1e-6);
    EXPECT_GT(points.size(), 20u) << name;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double away_m = away_from_contour_m(g, form, points[i]);
      const double rounding = 64.0 * kEps * g.reference_radius_m;
      EXPECT_LE(away_m, rounding) << name << ", " << i;
      largest.see(static_cast<int>(i), away_m, rounding);
    }
  }
  largest.expect_allowed("distance");
}

TEST(ToothOutline, ChordsLeaveTheContourByNoMoreThanStated) {
  for (const auto& [name, g] : plain_cases()) {
    const auto contour = dense_contour(g, make_tooth_form(g));
    for (const double error_m : {1e-4, 1e-5, 1e-6, 1e-7}) {
      const auto line = tooth_outline(g, error_m);
      double worst = 0.0;
      for (const Point& p : contour) worst = std::max(worst, distance_to_line_m(p, line));
      EXPECT_LE(worst, error_m + 64.0 * kEps * g.reference_radius_m) << name << ", " << error_m;
    }
  }
}

TEST(ToothOutline, ReachesFromMiddleToMiddleOfTheSpacesSymmetrically) {
  for (const auto& [name, g] : plain_cases()) {
    const auto p = tooth_outline(g, 1e-6);
    const double rounding = 64.0 * kEps * g.reference_radius_m;
    const double half = kPi / g.gear.teeth;
    for (const auto& [point, side] : {std::pair{p.front(), -1.0}, std::pair{p.back(), 1.0}}) {
      EXPECT_NEAR(point.x_m, g.root_radius_m * std::cos(half), rounding) << name;
      EXPECT_NEAR(point.y_m, side * g.root_radius_m * std::sin(half), rounding) << name;
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Point& mirrored = p[p.size() - 1 - i];
      EXPECT_NEAR(p[i].x_m, mirrored.x_m, rounding) << name;
      EXPECT_NEAR(p[i].y_m, -mirrored.y_m, rounding) << name;
    }
  }
}

TEST(GearOutline, IsCounterClockwiseClosedAndFreeOfCrossings) {
  for (const auto& [name, g] : plain_cases()) {
    const auto points = gear_outline(g, 2e-5);
    EXPECT_GT(signed_area_m2(points), 0.0) << name;
    EXPECT_EQ(crossing(points), "") << name;
    // The way round passes every angle once: 2 pi in all.
    double turned = 0.0;
    const double shortest = 1e-9 * g.reference_radius_m;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point &a = points[i], &b = points[(i + 1) % points.size()];
      turned += std::atan2(a.x_m * b.y_m - a.y_m * b.x_m, a.x_m * b.x_m + a.y_m * b.y_m);
      EXPECT_GT(std::hypot(a.x_m - b.x_m, a.y_m - b.y_m), shortest) << name << ", repeated " << i;
    }
    EXPECT_NEAR(turned, 2.0 * kPi, 1e-9) << name;
  }
}

TEST(GearOutline, IsTheSameForEveryToothAndHoldsToothZeroOnTheAxis) {
  for (const auto& [name, g] : plain_cases()) {
    const auto points = gear_outline(g, 1e-5);
    const auto z = static_cast<std::size_t>(g.gear.teeth);
    ASSERT_EQ(points.size() % z, 0u) << name;
    const std::size_t share = points.size() / z;
    const double rounding = 64.0 * kEps * g.reference_radius_m;
    const double pitch = 2.0 * kPi / g.gear.teeth;
    const auto turned = placed(points, pitch, {});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point& next = points[(i + share) % points.size()];
      EXPECT_NEAR(turned[i].x_m, next.x_m, rounding) << name;
      EXPECT_NEAR(turned[i].y_m, next.y_m, rounding) << name;
    }
    // Every point of one tooth's outline is one of the gear's.
    for (const Point& p : tooth_outline(g, 1e-5)) {
      const bool found = std::ranges::any_of(points, [&](const Point& q) {
        return std::hypot(p.x_m - q.x_m, p.y_m - q.y_m) < rounding;
      });
      EXPECT_TRUE(found) << name;
    }
  }
}

TEST(GearOutline, AreaOfAGearIsTheIntegralOfItsToothThickness) {
  for (const auto& [name, g] : plain_cases()) {
    if (g.gear.kind == GearKind::kRing) continue;
    const RackTooth rack(g);
    const double rf = rack.root_radius_m(), ra = g.tip_radius_m;
    // Simpson over u, R = rf + (ra − rf) u²: the space's angle rises as a root from the root
    // circle.
    const int n = 4000;
    double sum = 0.0;
    for (int i = 0; i <= n; ++i) {
      const double u = static_cast<double>(i) / n;
      const double r = rf + (ra - rf) * u * u;
      const double tooth = 2.0 * (kPi / g.gear.teeth - rack.at(r, 600).half_angle);
      const double weight = i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
      sum += weight * tooth * r * 2.0 * (ra - rf) * u;
    }
    const double area = kPi * rf * rf + g.gear.teeth * sum / (3.0 * n);
    const double error_m = 1e-9;
    const auto points = gear_outline(g, error_m);
    double length = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point &a = points[i], &b = points[(i + 1) % points.size()];
      length += std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
    }
    // Chords off by at most error_m, and the quadrature of a kinked function.
    EXPECT_NEAR(signed_area_m2(points), area, error_m * length + 1e-8 * area) << name;
  }
}

TEST(GearOutline, AreaConvergesToThatOfTheSmoothContourAsChordsShorten) {
  for (const auto& [name, g] : plain_cases()) {
    const double fine = signed_area_m2(gear_outline(g, 1e-10));
    double last = std::numeric_limits<double>::infinity();
    for (const double error_m : {1e-5, 1e-6, 1e-7, 1e-8}) {
      const double change = std::abs(signed_area_m2(gear_outline(g, error_m)) - fine);
      EXPECT_LT(change, last) << name << ", " << error_m;
      last = change;
    }
  }
}

TEST(Placed, TurnsAboutTheOriginAndThenMoves) {
  const auto p = placed({{1.0, 0.0}, {0.0, 2.0}}, kPi / 2.0, {10.0, 20.0});
  ASSERT_EQ(p.size(), 2u);
  EXPECT_NEAR(p[0].x_m, 10.0, 1e-15);
  EXPECT_NEAR(p[0].y_m, 21.0, 1e-14);
  EXPECT_NEAR(p[1].x_m, 8.0, 1e-14);
  EXPECT_NEAR(p[1].y_m, 20.0, 1e-14);
}

TEST(ToothOutline, RefusesAChordErrorThatIsNotAboveZero) {
  const auto g = plain_cases().front().gear;
  for (const double error_m : {0.0, -1e-6, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(tooth_outline(g, error_m), std::invalid_argument) << error_m;
    EXPECT_THROW(gear_outline(g, error_m), std::invalid_argument) << error_m;
  }
}

/// Gears that no workshop would cut, but a search passes by.
std::vector<Case> odd_cases() {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, GearKind kind, int teeth, double x, double k,
                       BasicRack<double> rack, PinionCutter cutter = {}) {
    cases.push_back({name, gear_with({.teeth = teeth,
                                      .kind = kind,
                                      .profile_shift = x,
                                      .machining_allowance = 0.0,
                                      .tip_shortening = k,
                                      .rack = rack,
                                      .cutter = cutter})});
  };
  const BasicRack<double> plain;
  add("pointed below the tip circle", GearKind::kExternal, 10, 1.0, 0.0, plain);
  add("pointed and undercut", GearKind::kExternal, 8, -0.5, 0.0,
      {.addendum = 1.9, .dedendum = 1.25, .root_radius = 0.2});
  add("thinned to a point", GearKind::kExternal, 20, 0.0, 0.0,
      {.addendum = 2.2, .dedendum = 1.25, .root_radius = 0.38});
  add("deeply undercut pinion", GearKind::kExternal, 6, -0.2, 0.0, plain);
  add("tip below the form circle", GearKind::kExternal, 12, -0.3, 1.5, plain);
  add("tip just above the root circle", GearKind::kExternal, 20, 0.0, 2.2, plain);
  add("ring tip inside the base circle", GearKind::kRing, 25, 0.0, 0.0, plain);
  add("cut ring's tip inside the base circle", GearKind::kRing, 30, 0.0, 0.0, plain,
      {.teeth = 15, .profile_shift = 0.0, .tip_radius = 0.2});
  add("ring tip beyond the form circle", GearKind::kRing, 60, 0.0, 2.1,
      {.addendum = 1.0, .dedendum = 1.25, .root_radius = 0.3});
  add("ring of pointed teeth", GearKind::kRing, 60, -0.5, 0.0,
      {.addendum = 2.4, .dedendum = 1.25, .root_radius = 0.3});
  return cases;
}

/// Rings whose root cannot be what was asked for: flanks that meet before the root circle, a cutter
/// too narrow at its tip for both of its roundings.
std::vector<Case> narrow_rings() {
  std::vector<Case> cases;
  const auto add = [&](const std::string& name, int teeth, double alpha_deg, double x,
                       double dedendum, PinionCutter cutter) {
    cases.push_back(
        {name, gear_with({.teeth = teeth,
                          .kind = GearKind::kRing,
                          .profile_shift = x,
                          .machining_allowance = 0.0,
                          .tip_shortening = 0.0,
                          .rack = {.addendum = 1.0, .dedendum = dedendum, .root_radius = 0.3},
                          .cutter = cutter},
                         alpha_deg)});
  };
  add("pointed spaces, 20 degrees", 60, 20.0, 1.85, 1.25, {});
  add("pointed spaces, 25 degrees", 60, 25.0, 0.75, 1.4, {});
  add("ring 80, cut by 30", 80, 20.0, 0.4, 1.25,
      {.teeth = 30, .profile_shift = 0.0, .tip_radius = 0.4});
  add("ring 60, cut by 20", 60, 20.0, 1.0, 1.25,
      {.teeth = 20, .profile_shift = 0.0, .tip_radius = 0.3});
  return cases;
}

void expect_between_root_and_tip_circle(const std::vector<Case>& cases) {
  for (const auto& [name, g] : cases) {
    const double rounding = 64.0 * kEps * g.reference_radius_m;
    const double low = std::min(g.root_radius_m, g.tip_radius_m);
    const double high = std::max(g.root_radius_m, g.tip_radius_m);
    const auto points = tooth_outline(g, 1e-6);
    ASSERT_GE(points.size(), 3u) << name;
    double least = std::numeric_limits<double>::infinity(), most = 0.0, widest = 0.0;
    for (const Point& p : points) {
      ASSERT_TRUE(std::isfinite(p.x_m) && std::isfinite(p.y_m)) << name;
      least = std::min(least, std::hypot(p.x_m, p.y_m));
      most = std::max(most, std::hypot(p.x_m, p.y_m));
      widest = std::max(widest, std::abs(std::atan2(p.y_m, p.x_m)));
    }
    EXPECT_LE(most, high + rounding) << name;
    EXPECT_GE(least, low - rounding) << name;
    EXPECT_LE(widest, kPi / g.gear.teeth + 1e-12) << name;
  }
}

void expect_free_of_crossings(const std::vector<Case>& cases) {
  for (const auto& [name, g] : cases) {
    const auto points = gear_outline(g, 2e-5);
    EXPECT_GT(signed_area_m2(points), 0.0) << name;
    EXPECT_EQ(crossing(points), "") << name;
  }
}

TEST(ToothOutline, OfOddTeethStaysBetweenRootAndTipCircle) {
  expect_between_root_and_tip_circle(odd_cases());
}

TEST(GearOutline, OfOddTeethIsCounterClockwiseAndFreeOfCrossings) {
  expect_free_of_crossings(odd_cases());
}

TEST(ToothOutline, OfARingTooNarrowForItsRootStaysInItsPitchAndRootCircle) {
  expect_between_root_and_tip_circle(narrow_rings());
}

TEST(GearOutline, OfARingTooNarrowForItsRootIsFreeOfCrossings) {
  expect_free_of_crossings(narrow_rings());
}

TEST(ToothOutline, PointedToothEndsWhereItsFlanksMeet) {
  const auto g = odd_cases().front().gear;
  ASSERT_LT(tooth_thickness(g, g.tip_radius_m), 0.0);
  double low = g.reference_radius_m, high = g.tip_radius_m;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (flank_half_angle(g, middle) < kPi / g.gear.teeth ? low : high) = middle;
  }
  const auto points = tooth_outline(g, 1e-7);
  double farthest = 0.0;
  for (const Point& p : points) farthest = std::max(farthest, std::hypot(p.x_m, p.y_m));
  EXPECT_NEAR(farthest, low, 64.0 * kEps * g.reference_radius_m);
}

TEST(ToothOutline, FlankInsideTheBaseCircleOfARingIsRadial) {
  for (const auto& [name, g] : odd_cases()) {
    if (g.gear.kind != GearKind::kRing || !(g.tip_radius_m < g.base_radius_m)) continue;
    const double tooth_half = kPi / g.gear.teeth - flank_half_angle(g, g.base_radius_m);
    int inside = 0;
    for (const Point& p : tooth_outline(g, 1e-7)) {
      const double r = std::hypot(p.x_m, p.y_m);
      if (r > g.base_radius_m * (1.0 - 1e-9)) continue;
      ++inside;
      const double angle = std::abs(std::atan2(p.y_m, p.x_m));
      if (r > g.tip_radius_m * (1.0 + 1e-9)) {
        EXPECT_NEAR(angle, tooth_half, 1e-12) << name;
      }
      EXPECT_LE(angle, tooth_half + 1e-12) << name;
    }
    EXPECT_GE(inside, 2) << name;
  }
}

}  // namespace
}  // namespace gear3k::geometry::outline_test
