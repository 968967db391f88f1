#include "geometry/tooth_form.hpp"

// Roots of teeth against tools rolled by force (generated_space.hpp), and the derivatives of all
// that follows from them against differences.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "geometry/interference.hpp"
#include "geometry/rack_point.hpp"
#include "tests/geometry/generated_space.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_numbers.hpp"
#include "tests/sample.hpp"
#include "tests/seeded.hpp"

namespace gear3k::geometry::tooth_form_test {
namespace {

using test::distance_m;
using test::flank_half_angle;
using test::polar;
using test::RackTooth;
using test::RingArc;
using test::RingCutter;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

class Random : public RandomNumbers {
 public:
  using RandomNumbers::RandomNumbers;

  GearGeometry<double> external(double least_shift = -0.6) {
    const double dedendum = between(1.0, 1.4);
    return make_gear_geometry<double>(
        {.teeth = count(8, 120),
         .kind = GearKind::kExternal,
         .module_m = between(0.3e-3, 5e-3),
         .profile_shift = between(least_shift, 1.0),
         .machining_allowance = between(0.0, 0.1),
         .tip_shortening = between(0.0, 0.2),
         .rack = {.addendum = 1.0, .dedendum = dedendum, .root_radius = between(0.0, 0.45)},
         .cutter = {}},
        make_pressure_angle(between(14.5, 28.0) * kPi / 180.0));
  }
  Gear<double> ring_without_tool() {
    return {.teeth = count(40, 140),
            .kind = GearKind::kRing,
            .module_m = between(0.3e-3, 5e-3),
            .profile_shift = between(-0.3, 1.2),
            .machining_allowance = between(0.0, 0.1),
            .tip_shortening = between(0.0, 0.2),
            .rack = {.addendum = 1.0, .dedendum = between(1.0, 1.4), .root_radius = 0.38},
            .cutter = {}};
  }
  GearGeometry<double> arc_ring() {
    for (;;) {
      Gear<double> gear = ring_without_tool();
      gear.rack.root_radius = between(0.05, 0.6);
      const auto ring =
          make_gear_geometry(gear, make_pressure_angle(between(14.5, 28.0) * kPi / 180.0));
      // The space must reach the root circle before its flanks meet.
      if (flank_half_angle(ring, ring.root_radius_m) < 1e-4) continue;
      if (RingArc(ring).center_radius_m() > 1.001 * ring.base_radius_m) return ring;
    }
  }
  GearGeometry<double> cut_ring() {
    for (;;) {
      Gear<double> gear = ring_without_tool();
      gear.cutter = {.teeth = count(12, gear.teeth - 15),
                     .profile_shift = between(-0.1, 0.3),
                     .tip_radius = between(0.0, 0.45)};
      const double target = gear.profile_shift - gear.cutter.profile_shift;
      const auto angle = make_pressure_angle(between(17.0, 28.0) * kPi / 180.0);
      // The cutter must have a working angle well away from 0.
      if (angle.involute + 2.0 * angle.tan * target / (gear.teeth - gear.cutter.teeth) < 3e-3) {
        continue;
      }
      const auto ring = make_gear_geometry(gear, angle);
      if (RingCutter(ring).exists()) return ring;
    }
  }
};

double normal_angle_at(const ToothForm<double>& form, double share) {
  return form.form_normal_angle_rad + share * (kPi / 2.0 - form.form_normal_angle_rad);
}

// Rolling by search: the maximum of a smooth function of angles up to one, to their rounding.
constexpr double kSearchedAngle = 16.0 * kEps;

TEST(RackRoot, FilletIsWhatTheRollingRackLeaves) {
  Random random(31);
  LargestDeviation largest;
  int undercut = 0, one_arc = 0;
  for (int i = 0; i < 400; ++i) {
    const auto g = random.external();
    const RackTooth rack(g);
    const auto form = make_tooth_form(g);
    undercut += form.undercut ? 1 : 0;
    one_arc += rack.one_arc() ? 1 : 0;
    ASSERT_EQ(form.fillet.tool, RootTool::kRack);
    for (const double share : {0.0, 0.03, 0.2, 0.5, 0.8, 0.97}) {
      const auto point = fillet_point(form.fillet, normal_angle_at(form, share));
      const double angle = rack.at(std::max(point.radius_m, rack.root_radius_m())).half_angle;
      // Towards the root circle the radius no longer tells points apart; an angle is what the
      // distance to the rolled contour is divided by the contour's slope.
      const double lean =
          std::abs(point.radius_m * point.angle_slope) /
          std::max(std::hypot(point.radius_slope_m, point.radius_m * point.angle_slope), 1e-300);
      const double away = (point.angle_rad - angle) * std::sqrt(std::max(1.0 - lean * lean, 0.0));
      largest.see(i, away, kSearchedAngle);
    }
  }
  EXPECT_GT(undercut, 20);
  EXPECT_GT(one_arc, 5);
  largest.expect_allowed("angle");
}

TEST(RackRoot, FlankIsWhatTheRollingRackLeavesAboveTheFormCircle) {
  Random random(32);
  LargestDeviation largest;
  for (int i = 0; i < 400; ++i) {
    const auto g = random.external();
    const RackTooth rack(g);
    const auto form = make_tooth_form(g);
    for (const double share : {1e-6, 0.01, 0.1, 0.5, 1.0}) {
      const double radius = form.form_radius_m + share * (g.tip_radius_m - form.form_radius_m);
      const auto cut = rack.at(radius);
      largest.see(i, cut.half_angle - space_half_angle(g, radius), kSearchedAngle);
    }
  }
  largest.expect_allowed("angle");
}

TEST(RackRoot, FormCircleIsWhereTheRacksCornerBeginsToCut) {
  Random random(33);
  LargestDeviation largest;
  for (int i = 0; i < sample(100, 300); ++i) {
    const auto g = random.external();
    if (g.gear.rack.root_radius < 0.02) continue;
    const RackTooth rack(g);
    const auto form = make_tooth_form(g);
    double low = rack.root_radius_m() * (1.0 + 1e-9), high = g.tip_radius_m;
    for (int k = 0; k < 45; ++k) {
      const double middle = 0.5 * (low + high);
      (rack.at(middle).by_corner ? low : high) = middle;
    }
    // The place of a maximum is found to the root of the rounding of its value.
    largest.see(i, 0.5 * (low + high) - form.form_radius_m, 1e-6 * g.gear.module_m * g.gear.teeth);
  }
  largest.expect_allowed("radius");
}

TEST(RackRoot, RoundingIsTheRacksOrTheOneArcThatTouchesBothFlanks) {
  Random random(34);
  LargestDeviation largest;
  int one_arc = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.external();
    const RackTooth rack(g);
    one_arc += rack.one_arc() ? 1 : 0;
    largest.see(i, rack_rounding(g) - rack.rounding_m() / g.gear.module_m, 64.0 * kEps);
    const auto form = make_tooth_form(g);
    largest.see(i, form.fillet.rounding_radius_m - rack.rounding_m(),
                64.0 * kEps * g.gear.module_m);
  }
  EXPECT_GT(one_arc, 20);
  largest.expect_allowed("rounding");
}

TEST(RackRoot, OfADeeperRackThanItsFlanksReachIsThatOfItsPoint) {
  Random random(35);
  LargestDeviation largest;
  for (int i = 0; i < 100; ++i) {
    const auto g = random.external();
    const double m = g.gear.module_m;
    // The depth at which the flanks meet: RackTooth's width there is nothing.
    double low = 0.0, high = 10.0;
    for (int k = 0; k < 200; ++k) {
      const double middle = 0.5 * (low + high);
      const double thickness = m * kPi / 4.0 +
                               0.5 * m * g.gear.machining_allowance / std::cos(g.angle.alpha_rad) -
                               m * middle * std::tan(g.angle.alpha_rad);
      (thickness > 0.0 ? low : high) = middle;
    }
    Gear<double> gear = g.gear;
    gear.rack.dedendum = low;
    gear.rack.root_radius = 0.0;
    const auto pointed = make_gear_geometry(gear, g.angle);
    if (pointed.root_radius_m < 0.2 * pointed.reference_radius_m) continue;
    gear.rack.dedendum = low * random.between(1.0001, 1.3);
    gear.rack.root_radius = g.gear.rack.root_radius;
    const auto deeper = make_gear_geometry(gear, g.angle);
    EXPECT_EQ(rack_rounding(deeper), 0.0);
    largest.see(i, rack_depth(deeper) - low, 64.0 * kEps);
    const auto form = make_tooth_form(deeper);
    const RackTooth rack(pointed);
    for (const double share : {0.05, 0.2, 0.5, 1.0}) {
      const double radius =
          pointed.root_radius_m + share * (g.tip_radius_m - pointed.root_radius_m);
      largest.see(i, contour_half_angle(deeper, form, radius) - rack.at(radius).half_angle, 1e-12);
    }
  }
  largest.expect_allowed("of the point");
}

TEST(RackRoot, ContourIsWhatTheRollingRackLeavesOnEveryRadius) {
  Random random(48);
  LargestDeviation largest;
  for (int i = 0; i < 200; ++i) {
    const auto g = random.external();
    const RackTooth rack(g);
    const auto form = make_tooth_form(g);
    for (const double share : {0.01, 0.1, 0.3, 0.6, 1.0}) {
      const double radius = rack.root_radius_m() + share * (g.tip_radius_m - rack.root_radius_m());
      // On the fillet the radius is that of a searched point of it.
      largest.see(i, contour_half_angle(g, form, radius) - rack.at(radius).half_angle, 1e-12);
    }
  }
  largest.expect_allowed("angle");
}

/// Sine of the angle between the fillet's and the flank's tangent at the form circle.
double kink(const GearGeometry<double>& g, const ToothForm<double>& form) {
  const auto p = fillet_point(form.fillet, form.form_normal_angle_rad);
  const double radial = p.radius_slope_m, around = p.radius_m * p.angle_slope;
  // r dη/dr of an involute is tan α_y; outwards the space of a gear widens, that of a ring narrows.
  const double tan_y =
      form.form_length_m / g.base_radius_m * (g.gear.kind == GearKind::kRing ? -1.0 : 1.0);
  return (radial * tan_y - around) / (std::hypot(radial, around) * std::hypot(1.0, tan_y));
}

/// Fillet and flank meet at the form circle: radius and angle, and without undercut the tangent.
void see_joint(const GearGeometry<double>& g, const ToothForm<double>& form, int i,
               LargestDeviation& place, LargestDeviation& tangent) {
  const auto p = fillet_point(form.fillet, form.form_normal_angle_rad);
  const double rounding = 32.0 * kEps * g.reference_radius_m;
  place.see(i, p.radius_m - form.form_radius_m, rounding);
  place.see(i, p.radius_m * (p.angle_rad - flank_half_angle(g, form.form_radius_m)), rounding);
  place.see(i, std::hypot(form.form_length_m, g.base_radius_m) - form.form_radius_m, rounding);
  if (!form.undercut)
    tangent.see(i, kink(g, form),
                64.0 * kEps / std::min(1.0, form.fillet.rounding_radius_m / g.reference_radius_m));
}

TEST(RackRoot, FilletAndFlankMeetWithOneTangentWithoutUndercut) {
  Random random(35);
  LargestDeviation place, tangent;
  int seen = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto g = random.external();
    if (g.gear.rack.root_radius < 0.02) continue;  // a sharp corner has no tangent
    const auto form = make_tooth_form(g);
    if (!form.undercut) ++seen;
    see_joint(g, form, i, place, tangent);
  }
  EXPECT_GT(seen, 1000);
  place.expect_allowed("place");
  tangent.expect_allowed("tangent");
}

TEST(RackRoot, UndercutIsToldByItsMarginAndLosesFlankAboveTheBaseCircle) {
  Random random(36);
  int undercut = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto g = random.external();
    const auto form = make_tooth_form(g);
    const double margin = undercut_margin(g);
    if (std::abs(margin) < 1e-9) continue;
    ASSERT_EQ(form.undercut, margin < 0.0) << i;
    if (!form.undercut) {
      EXPECT_EQ(form.form_normal_angle_rad, form.fillet.normal_angle_rad) << i;
      continue;
    }
    ++undercut;
    EXPECT_GT(form.form_radius_m, g.base_radius_m) << i;
    EXPECT_GT(form.form_length_m, 0.0) << i;
    EXPECT_GT(form.form_normal_angle_rad, form.fillet.normal_angle_rad) << i;
  }
  EXPECT_GT(undercut, 200);
}

TEST(RackRoot, UndercutFilletCrossesTheFlankAtTheFormCircle) {
  Random random(37);
  LargestDeviation place, tangent;
  int seen = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto g = random.external();
    const auto form = make_tooth_form(g);
    if (!form.undercut || undercut_margin(g) > -0.01) continue;
    ++seen;
    see_joint(g, form, i, place, tangent);
    // Beyond the crossing (smaller γ) the fillet would lie in what is already cut away or outside:
    // below it, it lies in the tooth.
    const auto deeper = fillet_point(form.fillet, form.form_normal_angle_rad + 1e-4);
    if (deeper.radius_m > g.base_radius_m) {
      EXPECT_GT(deeper.angle_rad, flank_half_angle(g, deeper.radius_m)) << i;
    }
    EXPECT_GT(std::abs(kink(g, form)), 1e-6) << i;
  }
  EXPECT_GT(seen, 100);
  place.expect_allowed("place");
}

TEST(RackRoot, FormRadiusIsContinuousAtTheOnsetOfUndercut) {
  Random random(38);
  for (int i = 0; i < 300; ++i) {
    auto g = random.external(-0.2);
    Gear<double> gear = g.gear;
    const double limit = gear.profile_shift - undercut_margin(g);
    if (limit < -1.5 || gear.rack.root_radius < 0.05) continue;
    double last = std::numeric_limits<double>::infinity();
    for (const double step : {1e-2, 1e-4, 1e-6, 1e-8}) {
      gear.profile_shift = limit + step;
      const auto above = make_tooth_form(make_gear_geometry(gear, g.angle));
      gear.profile_shift = limit - step;
      const auto below_gear = make_gear_geometry(gear, g.angle);
      const auto below = make_tooth_form(below_gear);
      ASSERT_FALSE(above.undercut) << i << ", " << step;
      // Less than 1e-5 modules of missing flank counts as none.
      ASSERT_EQ(below.undercut, step / g.angle.sin > 1e-5) << i << ", " << step;
      const double change = std::abs(above.form_radius_m - below.form_radius_m);
      EXPECT_LE(change, last + 4.0 * kEps * below_gear.base_radius_m) << i << ", " << step;
      last = change;
    }
    EXPECT_LT(last, 1e-5 * gear.module_m) << i;
  }
}

/// Every kind of root, by turns.
struct AnyRoot {
  GearGeometry<double> gear;
  ToothForm<double> form;
};
AnyRoot any_root(Random& random, int i) {
  const auto g = i % 3 == 0   ? random.external()
                 : i % 3 == 1 ? random.cut_ring()
                              : random.arc_ring();
  return {.gear = g, .form = make_tooth_form(g)};
}

TEST(Fillet, EndsOnTheRootCircleOfTheBasicRack) {
  Random random(39);
  LargestDeviation radius, slope;
  for (int i = 0; i < 3000; ++i) {
    const auto [g, form] = any_root(random, i);
    const auto end = fillet_point(form.fillet, kPi / 2.0);
    const double deep = g.gear.rack.dedendum;
    const double way = g.gear.kind == GearKind::kRing ? 1.0 : -1.0;
    const double rf = g.gear.module_m * (0.5 * g.gear.teeth + way * deep + g.gear.profile_shift);
    radius.see(i, end.radius_m - rf, 32.0 * kEps * g.reference_radius_m);
    slope.see(i, end.radius_slope_m, 16.0 * kEps * g.reference_radius_m);
    EXPECT_GE(end.angle_rad, -1e-12) << i;
    EXPECT_LT(end.angle_rad, flank_half_angle(g, form.form_radius_m)) << i;
  }
  radius.expect_allowed("radius");
  slope.expect_allowed("slope");
}

TEST(Fillet, SlopesAreTheCentralDifferences) {
  Random random(40);
  LargestDeviation radius, angle;
  const double h = 1e-3;
  for (int i = 0; i < 1500; ++i) {
    const auto [g, form] = any_root(random, i);
    // Where the rack's normal turns flat, its point runs off as 1/sin γ: differences are truncated
    // by h⁴ over the fourth power of γ there.
    const double low = form.fillet.normal_angle_rad + 4.0 * h;
    const double gamma = low + random.between(0.0, 1.0) * (kPi / 2.0 - 4.0 * h - low);
    if (!(gamma > 0.2) || !(gamma < kPi / 2.0)) continue;
    const auto at = [&, &fillet = form.fillet](double steps) {
      return fillet_point(fillet, gamma + steps * h);
    };
    const auto p = at(0.0), a = at(-2.0), b = at(-1.0), c = at(1.0), d = at(2.0);
    const double radius_slope =
        (a.radius_m - 8.0 * b.radius_m + 8.0 * c.radius_m - d.radius_m) / (12.0 * h);
    const double angle_slope =
        (a.angle_rad - 8.0 * b.angle_rad + 8.0 * c.angle_rad - d.angle_rad) / (12.0 * h);
    const double size =
        std::abs(p.radius_slope_m) + p.radius_m * std::abs(p.angle_slope) + g.gear.module_m;
    // Truncation of the difference, and the rounding of the radius over the step.
    const double allowed = 1e-8 * size + 4.0 * kEps * g.reference_radius_m / h;
    radius.see(i, p.radius_slope_m - radius_slope, allowed);
    angle.see(i, p.radius_m * (p.angle_slope - angle_slope), allowed);
  }
  radius.expect_allowed("radius");
  angle.expect_allowed("angle");
}

TEST(Fillet, RadiusFallsTowardsTheRootOfAGearAndGrowsTowardsThatOfARing) {
  Random random(41);
  for (int i = 0; i < 900; ++i) {
    const auto [g, form] = any_root(random, i);
    const bool ring = g.gear.kind == GearKind::kRing;
    double last = fillet_point(form.fillet, normal_angle_at(form, 0.0)).radius_m;
    for (int k = 1; k <= 100; ++k) {
      const double r = fillet_point(form.fillet, normal_angle_at(form, 0.01 * k)).radius_m;
      const double step = ring ? r - last : last - r;
      ASSERT_GT(step, -4.0 * kEps * r) << i << ", " << k;
      last = r;
    }
  }
}

TEST(CutterRoot, FilletIsTheEnvelopeOfTheCuttersRoundedCorner) {
  Random random(42);
  LargestDeviation distance;
  int one_arc = 0;
  for (int i = 0; i < 200; ++i) {
    const auto g = random.cut_ring();
    const RingCutter cutter(g);
    const auto form = make_tooth_form(g);
    one_arc += cutter.one_arc() ? 1 : 0;
    distance.see(i, form.fillet.rounding_radius_m - cutter.rounding_m(),
                 32.0 * kEps * g.reference_radius_m);
    ASSERT_EQ(form.fillet.tool, RootTool::kCutter);
    for (const double share : {0.0, 0.1, 0.4, 0.7, 0.95, 1.0}) {
      const auto p = fillet_point(form.fillet, normal_angle_at(form, share));
      const double nearest = cutter.nearest_m(polar(p.radius_m, p.angle_rad));
      distance.see(i, nearest - cutter.rounding_m(), 32.0 * kEps * g.reference_radius_m);
    }
  }
  EXPECT_GT(one_arc, 10);
  EXPECT_LT(one_arc, 150);
  distance.expect_allowed("distance");
}

TEST(CutterRoot, CutterReachesTheBasicRacksRootCircle) {
  Random random(43);
  LargestDeviation largest;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.cut_ring();
    const RingCutter cutter(g);
    const auto form = make_tooth_form(g);
    const double rounding = 32.0 * kEps * g.reference_radius_m;
    largest.see(i, form.cutter_center_distance_m - cutter.center_distance_m(), rounding);
    largest.see(i, form.cutter_tip_radius_m - cutter.tip_radius_m(), rounding);
    largest.see(i, form.cutter_center_distance_m + form.cutter_tip_radius_m - g.root_radius_m,
                rounding);
    EXPECT_FALSE(form.undercut) << i;
  }
  largest.expect_allowed("length");
}

TEST(CutterRoot, FilletAndFlankMeetWithOneTangent) {
  Random random(44);
  LargestDeviation place, tangent;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.cut_ring();
    if (g.gear.cutter.tip_radius < 0.02) continue;
    see_joint(g, make_tooth_form(g), i, place, tangent);
  }
  place.expect_allowed("place");
  tangent.expect_allowed("tangent");
}

TEST(CutterRoot, FlankIsGeneratedFromTheCuttersBaseCircleOn) {
  Random random(45);
  LargestDeviation largest;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.cut_ring();
    const auto form = make_tooth_form(g);
    // Both base circles' tangent points on one line: the difference of their foot points.
    const double cutter_base = g.base_radius_m * g.gear.cutter.teeth / g.gear.teeth;
    const double a0 = RingCutter(g).center_distance_m();
    const double foot = std::sqrt(a0 * a0 - std::pow(g.base_radius_m - cutter_base, 2));
    largest.see(i, form.generated_length_m - foot, 64.0 * kEps * g.reference_radius_m);
  }
  largest.expect_allowed("length");
}

TEST(ArcRoot, ArcTouchesFlankAndRootCircle) {
  Random random(46);
  LargestDeviation place, tangent, distance;
  int full_round = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.arc_ring();
    const RingArc arc(g);
    const auto form = make_tooth_form(g);
    ASSERT_EQ(form.fillet.tool, RootTool::kArc);
    full_round += arc.full_round() ? 1 : 0;
    see_joint(g, form, i, place, tangent);
    const double rounding = 32.0 * kEps * g.reference_radius_m;
    distance.see(i, form.fillet.rounding_radius_m - arc.rounding_m(), rounding);
    for (const double share : {0.0, 0.2, 0.5, 0.8, 1.0}) {
      const auto p = fillet_point(form.fillet, normal_angle_at(form, share));
      distance.see(i, distance_m(polar(p.radius_m, p.angle_rad), arc.center()) - arc.rounding_m(),
                   rounding);
    }
  }
  EXPECT_GT(full_round, 50);
  EXPECT_LT(full_round, 1950);
  place.expect_allowed("place");
  tangent.expect_allowed("tangent");
  distance.expect_allowed("distance");
}

TEST(ArcRoot, NarrowSpaceIsFullyRound) {
  Random random(47);
  LargestDeviation angle;
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.arc_ring();
    if (!RingArc(g).full_round()) continue;
    ++seen;
    const auto form = make_tooth_form(g);
    EXPECT_LT(form.fillet.rounding_radius_m, g.gear.rack.root_radius * g.gear.module_m);
    angle.see(i, fillet_point(form.fillet, kPi / 2.0).angle_rad, 16.0 * kEps);
  }
  EXPECT_GT(seen, 50);
  angle.expect_allowed("angle");
}

// Derivatives.  Variables: both shifts, both allowances, the tip shortening, the centre distance,
// the module and the basic rack's root radius.
constexpr std::size_t kVariables = 8;
static_assert(kVariables <= static_cast<std::size_t>(kMaxVariables));
template <class T>
using Variables = std::array<T, kVariables>;

constexpr double kStep = 1e-3;        // in units of scales()
constexpr double kTruncation = 3e-8;  // five-point difference, of the largest scaled derivative
constexpr double kValueRounding = 1e-11;

struct Design {
  int teeth1 = 0, teeth2 = 0;
  bool ring = false;
  PinionCutter cutter;
  double pressure_angle_rad = 0.0;
  Variables<double> at{};

  Variables<double> scales() const {
    return {0.5, 0.5, 0.5, 0.5, 0.5, 0.5 * at[6], 0.1 * at[6], 0.5};
  }
};

template <class T>
std::vector<T> quantities(const Design& d, const Variables<T>& v,
                          std::vector<std::string>* names = nullptr) {
  std::vector<T> all;
  const auto add = [&](const std::string& name, const T& value) {
    all.push_back(value);
    if (names != nullptr) names->push_back(name);
  };
  const auto angle = make_pressure_angle(constant<T>(d.pressure_angle_rad));
  const auto gear = [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    const bool ring = d.ring && index == 1;
    Gear<T> g{.teeth = index == 0 ? d.teeth1 : d.teeth2,
              .kind = ring ? GearKind::kRing : GearKind::kExternal,
              .module_m = v[6],
              .profile_shift = v[i],
              .machining_allowance = v[2 + i],
              .tip_shortening = v[4],
              .rack = {},
              .cutter = ring ? d.cutter : PinionCutter{}};
    g.rack.root_radius = v[7];
    return make_gear_geometry(g, angle);
  };
  const auto g1 = gear(0), g2 = gear(1);
  const auto found = make_mesh_geometry(g1, g2, v[5]);
  if (!found) return all;
  const auto& mesh = *found;
  const std::array<ToothForm<T>, 2> forms{make_tooth_form(g1), make_tooth_form(g2)};
  const std::string kind = !d.ring ? "external" : d.cutter.teeth > 0 ? "cut ring" : "arc ring";
  for (const int which : {1, 2}) {
    const auto& form = forms[static_cast<std::size_t>(which - 1)];
    const std::string of = fmt::format("{} {}", kind, which);
    add(of + " form length", form.form_length_m);
    add(of + " form radius", form.form_radius_m);
    add(of + " form normal angle", form.form_normal_angle_rad);
    add(of + " rounding", form.fillet.rounding_radius_m);
    for (const double share : {0.0, 0.4, 0.8}) {
      const T gamma = form.form_normal_angle_rad +
                      share * (constant<T>(kPi / 2.0) - form.form_normal_angle_rad);
      const auto p = fillet_point(form.fillet, gamma);
      add(fmt::format("{} fillet radius {}", of, share), p.radius_m);
      add(fmt::format("{} fillet angle {}", of, share), p.angle_rad);
      add(fmt::format("{} fillet radius slope {}", of, share), p.radius_slope_m);
      add(fmt::format("{} fillet angle slope {}", of, share), p.angle_slope);
    }
    add(of + " form_circle_margin", form_circle_margin(g1, g2, mesh, form, which));
    add(of + " root_clearance", root_clearance(g1, g2, mesh, which));
    add(of + " active_root_length", active_root_length(g1, g2, mesh, which));
    add(of + " tip_fouling_gap",
        tip_fouling_gap(g1, g2, mesh, forms[static_cast<std::size_t>(2 - which)], which));
    add(of + " space half angle", space_half_angle(which == 1 ? g1 : g2, form.form_radius_m));
  }
  if (d.ring) {
    add(kind + " trochoid_margin", trochoid_margin(g1, g2, mesh));
    add(kind + " trimming_margin", trimming_margin(g1, g2, mesh));
    if (d.cutter.teeth > 0) add(kind + " ring_cutter_margin", ring_cutter_margin(g2, forms[1]));
  } else {
    add(kind + " undercut_margin", undercut_margin(g1));
    add(kind + " khk_tip_shortening", khk_tip_shortening<T>({.teeth_sum = d.teeth1 + d.teeth2,
                                                             .module_m = v[6],
                                                             .shift_sum = v[0] + v[1],
                                                             .center_distance_m = v[5]}));
  }
  return all;
}

Design random_design(Random& random, int kind) {
  for (;;) {
    Design d;
    d.ring = kind > 0;
    d.teeth1 = random.count(9, 45);
    d.teeth2 = d.ring ? std::max(40, d.teeth1 + random.count(18, 60)) : random.count(9, 80);
    if (kind == 2) {
      d.cutter = {.teeth = random.count(18, std::max(18, d.teeth2 - 22)),
                  .profile_shift = random.between(0.0, 0.2),
                  .tip_radius = random.between(0.1, 0.3)};
    }
    d.pressure_angle_rad = random.between(18.0, 25.0) * kPi / 180.0;
    const double m = random.between(0.5e-3, 3e-3);
    d.at = {random.between(-0.3, 0.7),
            random.between(d.ring ? 0.2 : -0.3, d.ring ? 1.0 : 0.7),
            random.between(0.01, 0.08),
            random.between(0.01, 0.08),
            random.between(0.02, 0.15),
            0.0,
            m,
            random.between(0.15, 0.3)};
    const auto angle = make_pressure_angle(d.pressure_angle_rad);
    const auto gear = [&](int teeth, GearKind gear_kind, double x) {
      return make_gear_geometry<double>(
          {.teeth = teeth,
           .kind = gear_kind,
           .module_m = m,
           .profile_shift = x,
           .machining_allowance = 0.0,
           .tip_shortening = d.at[4],
           .rack = {.addendum = 1.0, .dedendum = 1.25, .root_radius = d.at[7]},
           .cutter = d.cutter},
          angle);
    };
    const auto g1 = gear(d.teeth1, GearKind::kExternal, d.at[0]);
    const auto g2 = gear(d.teeth2, d.ring ? GearKind::kRing : GearKind::kExternal, d.at[1]);
    const auto distance = zero_backlash_center_distance(g1, g2);
    if (!distance || g2.tip_radius_m < g2.base_radius_m + 0.2 * m) continue;
    d.at[5] = *distance + (d.ring ? -1.0 : 1.0) * random.between(0.01, 0.1) * m;
    if (kind == 2 && !RingCutter(g2).exists()) continue;
    if (!make_mesh_geometry(g1, g2, d.at[5])) continue;
    // At the onset of undercut fillet and flank cross at a vanishing angle: rounding grows there.
    if (std::abs(undercut_margin(g1)) < 0.05) continue;
    if (!d.ring && std::abs(undercut_margin(g2)) < 0.05) continue;
    return d;
  }
}

Variables<double> moved(const Design& d, std::size_t k, double steps) {
  Variables<double> v = d.at;
  v[k] += steps * kStep * d.scales()[k];
  return v;
}

/// Five-point difference per step, and the same over half the step: where both disagree the
/// function has a kink nearby (another branch of a least, the onset of undercut) and is not
/// compared.
struct Difference {
  std::vector<double> value, doubt;
};
template <class F>
Difference difference(F function) {
  const auto over = [&](double h) {
    const auto a = function(-2.0 * h), b = function(-h), c = function(h), d = function(2.0 * h);
    std::vector<double> result(c.size(), std::numeric_limits<double>::quiet_NaN());
    if (a.size() != c.size() || b.size() != c.size() || d.size() != c.size()) return result;
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * h * kStep);
    }
    return result;
  };
  Difference result{.value = over(0.5), .doubt = over(1.0)};
  for (std::size_t i = 0; i < result.value.size(); ++i) {
    result.doubt[i] = std::abs(result.doubt[i] - result.value[i]);
  }
  return result;
}

class DerivativesOfRoots : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Kinds, DerivativesOfRoots, ::testing::Values(0, 1, 2),
                         [](const ::testing::TestParamInfo<int>& kind) {
                           return kind.param == 0   ? "External"
                                  : kind.param == 1 ? "ArcRing"
                                                    : "CutRing";
                         });

struct Shares {
  explicit Shares(std::size_t count) : worst(count, 0.0), seen(count, 0), smooth(count, 0) {}
  void see(std::size_t q, double deviation, double allowed) {
    if (deviation == 0.0) return;
    const double share = std::abs(deviation) / allowed;
    if (!(share <= worst[q])) worst[q] = std::isnan(share) ? 1e300 : share;
  }
  std::vector<double> worst;
  std::vector<int> seen, smooth;
};

TEST_P(DerivativesOfRoots, AreTheCentralDifferences) {
  Random random(50 + static_cast<std::uint64_t>(GetParam()));
  std::vector<std::string> names;
  {
    const Design d = random_design(random, GetParam());
    quantities<double>(d, d.at, &names);
  }
  const std::size_t n = names.size();
  ASSERT_GT(n, 20u);
  Shares values(n), gradients(n), hessians(n);
  const auto scaled_gradients = [](const Design& d, const Variables<double>& at) {
    std::vector<double> flat;
    const auto scales = d.scales();
    for (const Jet1& q : quantities<Jet1>(d, seeded1(at))) {
      for (std::size_t k = 0; k < kVariables; ++k) {
        flat.push_back(q.v[static_cast<Eigen::Index>(k)] * scales[k]);
      }
    }
    return flat;
  };
  for (int i = 0; i < 150; ++i) {
    const Design d = random_design(random, GetParam());
    const auto scales = d.scales();
    const auto exact = quantities<double>(d, d.at);
    const auto first = scaled_gradients(d, d.at);
    const auto jets = quantities<Jet2>(d, seeded2(d.at));
    ASSERT_EQ(exact.size(), n);
    ASSERT_EQ(jets.size(), n);
    std::vector<Difference> slopes, curvatures;
    for (std::size_t k = 0; k < kVariables; ++k) {
      slopes.push_back(
          difference([&](double steps) { return quantities<double>(d, moved(d, k, steps)); }));
      curvatures.push_back(
          difference([&](double steps) { return scaled_gradients(d, moved(d, k, steps)); }));
    }
    for (std::size_t q = 0; q < n; ++q) {
      double size1 = std::abs(exact[q]), size2 = 0.0, doubt1 = 0.0, doubt2 = 0.0;
      for (std::size_t k = 0; k < kVariables; ++k) {
        size1 = std::max(size1, std::abs(slopes[k].value[q]));
        doubt1 = std::max(doubt1, slopes[k].doubt[q]);
        for (std::size_t l = 0; l < kVariables; ++l) {
          size2 = std::max(size2, std::abs(curvatures[k].value[q * kVariables + l]));
          doubt2 = std::max(doubt2, curvatures[k].doubt[q * kVariables + l]);
        }
      }
      size2 = std::max(size1, size2);
      ++values.seen[q];
      values.see(q, value_of(jets[q]) - exact[q], kValueRounding * size1);
      // The half step's truncation is a fifteenth of what both differ by.
      if (doubt1 <= kTruncation * size1) {
        ++gradients.smooth[q];
        for (std::size_t k = 0; k < kVariables; ++k) {
          const double jet = jets[q].by_column[k] * scales[k];
          gradients.see(q, jet - slopes[k].value[q], kTruncation * size1);
          gradients.see(q, first[q * kVariables + k] - slopes[k].value[q], kTruncation * size1);
        }
      }
      if (doubt1 <= kTruncation * size1 && doubt2 <= kTruncation * size2) {
        ++hessians.smooth[q];
        for (std::size_t k = 0; k < kVariables; ++k) {
          for (std::size_t l = 0; l < kVariables; ++l) {
            const double jet = jets[q].mixed[k][l] * scales[k] * scales[l];
            hessians.see(q, jet - curvatures[k].value[q * kVariables + l], kTruncation * size2);
          }
        }
      }
    }
  }
  for (std::size_t q = 0; q < n; ++q) {
    EXPECT_LE(values.worst[q], 1.0) << "value of " << names[q];
    EXPECT_LE(gradients.worst[q], 1.0) << "gradient of " << names[q];
    EXPECT_LE(hessians.worst[q], 1.0) << "Hessian of " << names[q];
    EXPECT_GE(gradients.smooth[q], 100) << "gradient of " << names[q];
    EXPECT_GE(hessians.smooth[q], 75) << "Hessian of " << names[q];
  }
}

}  // namespace
}  // namespace gear3k::geometry::tooth_form_test
