#include "geometry/tooth_measures.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "tests/geometry/generated_space.hpp"
#include "tests/largest_deviation.hpp"
#include "tests/random_numbers.hpp"
#include "tests/sample.hpp"

namespace gear3k::geometry::tooth_measures_test {
namespace {

using test::distance_m;
using test::flank_half_angle;
using test::largest_of;
using test::polar;
using test::RackTooth;
using test::RingArc;
using test::Spot;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

class Random : public RandomNumbers {
 public:
  using RandomNumbers::RandomNumbers;

  GearGeometry<double> gear(bool ring) {
    for (;;) {
      Gear<double> gear{
          .teeth = ring ? count(40, 140) : count(9, 120),
          .kind = ring ? GearKind::kRing : GearKind::kExternal,
          .module_m = between(0.3e-3, 5e-3),
          .profile_shift = ring ? between(-0.2, 0.9) : between(-0.4, 0.9),
          .machining_allowance = between(0.0, 0.1),
          .tip_shortening = between(0.0, 0.3),
          .rack = {.addendum = 1.0, .dedendum = 1.25, .root_radius = between(0.1, 0.4)},
          .cutter = {}};
      const auto g =
          make_gear_geometry(gear, make_pressure_angle(between(17.0, 25.0) * kPi / 180.0));
      if (g.tip_radius_m < g.base_radius_m + 0.1 * gear.module_m) continue;
      const double tooth = kPi / gear.teeth - flank_half_angle(g, g.tip_radius_m);
      if (tooth * g.tip_radius_m < 0.05 * gear.module_m) continue;
      if (ring && flank_half_angle(g, g.root_radius_m) < 1e-3) continue;
      return g;
    }
  }
};

double to_rounding(const GearGeometry<double>& g) { return 64.0 * kEps * g.reference_radius_m; }

/// Radii between which there is involute flank, found by rolling the rack (gear) or from the arc's
/// tangent point (ring).
struct FlankRange {
  double low_m, high_m;
};
FlankRange flank_range(const GearGeometry<double>& g) {
  const double form_m = make_tooth_form(g).form_radius_m;
  return {std::min(form_m, g.tip_radius_m), std::max(form_m, g.tip_radius_m)};
}

class MeasuresOfBothKinds : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Kinds, MeasuresOfBothKinds, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& ring) {
                           return ring.param ? "Ring" : "External";
                         });

/// Half the distance of the parallel planes that touch the outer flanks of k teeth (a ring: of k
/// spaces) that stand symmetrically about the axis between them: the farthest that a flank reaches
/// sideways.  `at` gives the half angle of a tooth or space on a radius.
template <class F>
double sideways_m(const GearGeometry<double>& g, int count, double low_m, double high_m,
                  const F& at, double* contact_m) {
  const double between = (count - 1) * kPi / g.gear.teeth;
  return largest_of([&](double r) { return r * std::sin(between + at(r)); }, low_m, high_m, 2000,
                    contact_m);
}

TEST_P(MeasuresOfBothKinds, SpanIsTheDistanceOfTheParallelPlanesThatTouchItsFlanks) {
  Random random(61);
  LargestDeviation length, contact;
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.gear(GetParam());
    const auto span = span_measure(g);
    if (!span) continue;
    ++seen;
    const auto range = flank_range(g);
    const auto half_angle = [&](double r) {
      const double space = flank_half_angle(g, r);
      return GetParam() ? space : kPi / g.gear.teeth - space;
    };
    double touched_m = 0.0;
    const double half_m =
        sideways_m(g, span->count, range.low_m, range.high_m, half_angle, &touched_m);
    length.see(i, span->length_m - 2.0 * half_m, to_rounding(g));
    // The place of a maximum is known to the root of the rounding of its value.
    contact.see(i, span->contact_radius_m - touched_m, 1e-6 * g.reference_radius_m);
    EXPECT_GE(span->contact_radius_m, range.low_m * (1.0 - kEps)) << i;
    EXPECT_LE(span->contact_radius_m, range.high_m * (1.0 + kEps)) << i;
  }
  EXPECT_GT(seen, 1500);
  length.expect_allowed("length");
  contact.expect_allowed("contact");
}

TEST(SpanMeasure, IsTheDistanceOfThePlanesOnTheGearThatTheRackLeaves) {
  // The same with the rolled contour, fillet and all: nothing else of the tooth is in the way.
  Random random(62);
  LargestDeviation length;
  int seen = 0;
  for (int i = 0; i < 50; ++i) {
    const auto g = random.gear(false);
    const auto span = span_measure(g);
    if (!span) continue;
    ++seen;
    const RackTooth rack(g);
    const auto tooth = [&](double r) { return kPi / g.gear.teeth - rack.at(r, 200).half_angle; };
    double touched_m = 0.0;
    const double low_m = span->contact_radius_m - 0.3 * g.gear.module_m;
    const double half_m = largest_of(
        [&](double r) { return r * std::sin((span->count - 1) * kPi / g.gear.teeth + tooth(r)); },
        std::max(low_m, rack.root_radius_m()), g.tip_radius_m, 60, &touched_m);
    length.see(i, span->length_m - 2.0 * half_m, to_rounding(g));
  }
  EXPECT_GT(seen, 30);
  length.expect_allowed("length");
}

TEST_P(MeasuresOfBothKinds, SpanTouchesNearestToTheShiftedCircleOfAllCountsThatItsFlanksCarry) {
  Random random(63);
  for (int i = 0; i < 2000; ++i) {
    const auto g = random.gear(GetParam());
    const auto span = span_measure(g);
    const auto range = flank_range(g);
    const double target_m = g.reference_radius_m + g.gear.profile_shift * g.gear.module_m;
    // The contact of k teeth: half the span, perpendicular to the base circle's radius.
    const double pitch_m = kPi * g.gear.module_m * g.angle.cos;
    const auto contact_m = [&](int k) {
      const double filled = GetParam() ? flank_half_angle(g, g.base_radius_m)
                                       : kPi / g.gear.teeth - flank_half_angle(g, g.base_radius_m);
      const double half_m = 0.5 * (k - 1) * pitch_m + g.base_radius_m * filled;
      return std::hypot(g.base_radius_m, half_m);
    };
    // Nearness as length of flank's normal, in which the counts stand evenly.
    const auto away_m = [&](int k) {
      const auto normal_m = [&](double r) {
        return std::sqrt(std::max(r * r - g.base_radius_m * g.base_radius_m, 0.0));
      };
      return std::abs(normal_m(contact_m(k)) - normal_m(target_m));
    };
    std::optional<int> nearest;
    for (int k = 1; k <= g.gear.teeth; ++k) {
      const double r = contact_m(k);
      if (r < range.low_m || r > range.high_m) continue;
      if (!nearest || away_m(k) < away_m(*nearest)) nearest = k;
    }
    EXPECT_EQ(span.has_value(), nearest.has_value())
        << i << ": z " << g.gear.teeth << " x " << g.gear.profile_shift << ", k "
        << nearest.value_or(0) << " touches at " << contact_m(nearest.value_or(1)) << " in "
        << range.low_m << " to " << range.high_m << ", circle " << target_m;
    if (!span || !nearest) continue;
    EXPECT_LE(away_m(span->count), away_m(*nearest) + to_rounding(g))
        << i << ": z " << g.gear.teeth << " x " << g.gear.profile_shift << " k " << span->count
        << ", nearest " << *nearest;
  }
}

/// The seat of a pin in a tooth space: where its axis stands so that it touches both flanks, and
/// where it does.
struct Seat {
  double axis_m = 0.0, contact_m = 0.0;
};
template <class F>
Seat seat_of(double pin_diameter_m, double low_m, double high_m, bool ring, const F& half_angle) {
  const auto gap_m = [&](double axis_m, double* contact_m) {
    const Spot axis{.x_m = 0.0, .y_m = axis_m};
    return -largest_of([&](double r) { return -distance_m(axis, polar(r, half_angle(r))); }, low_m,
                       high_m, 120, contact_m) -
           0.5 * pin_diameter_m;
  };
  // From where the space is wide, outside a gear and inside a ring, to where the pin is tight.
  const double wide_m = ring ? low_m - pin_diameter_m : high_m + 2.0 * pin_diameter_m;
  const double step_m = (ring ? 0.1 : -0.1) * pin_diameter_m;
  Seat seat{.axis_m = wide_m};
  for (int i = 0; i < 200 && gap_m(seat.axis_m, &seat.contact_m) > 0.0; ++i) seat.axis_m += step_m;
  double free = seat.axis_m - step_m, tight = seat.axis_m;
  for (int i = 0; i < 50; ++i) {
    seat.axis_m = 0.5 * (free + tight);
    (gap_m(seat.axis_m, &seat.contact_m) > 0.0 ? free : tight) = seat.axis_m;
  }
  return seat;
}

/// Over two pins (ring: between them) in the spaces that stand farthest apart.
double over_pins_m(const GearGeometry<double>& g, double axis_m, double pin_diameter_m) {
  double farthest = 0.0;
  for (int k = 0; k < g.gear.teeth; ++k) {
    farthest = std::max(
        farthest, distance_m(polar(axis_m, 0.0), polar(axis_m, 2.0 * kPi * k / g.gear.teeth)));
  }
  return g.gear.kind == GearKind::kRing ? farthest - pin_diameter_m : farthest + pin_diameter_m;
}

TEST_P(MeasuresOfBothKinds, PinsTouchBothFlanksOfTheirSpaces) {
  Random random(64);
  LargestDeviation measure, contact;
  int odd = 0, even = 0;
  for (int i = 0; i < 300; ++i) {
    const auto g = random.gear(GetParam());
    const double pin_m = g.gear.module_m * random.between(1.5, 2.0);
    const auto pins = pin_measure(g, pin_m);
    if (!pins) continue;
    (g.gear.teeth % 2 == 1 ? odd : even) += 1;
    EXPECT_EQ(pins->pin_diameter_m, pin_m);
    const auto range = flank_range(g);
    const Seat seat = seat_of(pin_m, range.low_m, range.high_m, GetParam(),
                              [&](double r) { return flank_half_angle(g, r); });
    measure.see(i, pins->over_pins_m - over_pins_m(g, seat.axis_m, pin_m), 4.0 * to_rounding(g));
    contact.see(i, pins->contact_radius_m - seat.contact_m, 1e-6 * g.reference_radius_m);
  }
  EXPECT_GT(odd, 60);
  EXPECT_GT(even, 60);
  measure.expect_allowed("measure");
  contact.expect_allowed("contact");
}

TEST_P(MeasuresOfBothKinds, PinsSeatOnFlankOrAreRefused) {
  // The seat on the involute continued both ways: it is one of the gear's when it lies between form
  // and tip circle and the pin clears the root circle.
  Random random(65);
  int refused = 0, seated = 0;
  for (int i = 0; i < 150; ++i) {
    const auto g = random.gear(GetParam());
    const double pin_m = g.gear.module_m * random.between(1.1, 3.4);
    const auto pins = pin_measure(g, pin_m);
    const auto range = flank_range(g);
    const double m = g.gear.module_m;
    const Seat seat =
        seat_of(pin_m, g.base_radius_m, std::max(range.high_m, g.root_radius_m) + 2.0 * m,
                GetParam(), [&](double r) { return flank_half_angle(g, r); });
    const double to_root_m = GetParam() ? g.root_radius_m - seat.axis_m - 0.5 * pin_m
                                        : seat.axis_m - 0.5 * pin_m - g.root_radius_m;
    const double room_m =
        std::min({seat.contact_m - range.low_m, range.high_m - seat.contact_m, to_root_m});
    if (std::abs(room_m) < 1e-5 * g.reference_radius_m) continue;
    EXPECT_EQ(pins.has_value(), room_m > 0.0)
        << i << ": z " << g.gear.teeth << ", x " << g.gear.profile_shift << ", pin " << pin_m / m
        << " m, room " << room_m / m << " m";
    (pins ? seated : refused) += 1;
  }
  EXPECT_GT(seated, 30);
  EXPECT_GT(refused, 30);
}

TEST_P(MeasuresOfBothKinds, FittingPinsAreThoseThatFindASeat) {
  Random random(69);
  int none = 0, ends = 0;
  for (int i = 0; i < 40; ++i) {
    const auto g = random.gear(GetParam());
    const double m = g.gear.module_m;
    const auto circles = flank_range(g);
    const auto room_m = [&](double pin_m) {
      const Seat seat =
          seat_of(pin_m, g.base_radius_m, std::max(circles.high_m, g.root_radius_m) + 2.0 * m,
                  GetParam(), [&](double r) { return flank_half_angle(g, r); });
      const double to_root_m = GetParam() ? g.root_radius_m - seat.axis_m - 0.5 * pin_m
                                          : seat.axis_m - 0.5 * pin_m - g.root_radius_m;
      return std::min({seat.contact_m - circles.low_m, circles.high_m - seat.contact_m, to_root_m});
    };
    const auto fitting = fitting_pins(g);
    if (!fitting) {
      ++none;
      for (double pin = 1.1; pin < 3.0; pin += 0.1) {
        EXPECT_LT(room_m(pin * m), 1e-5 * g.reference_radius_m) << i << ", pin " << pin << " m";
      }
      continue;
    }
    const auto [least_m, greatest_m] = *fitting;
    EXPECT_GT(room_m(1.01 * least_m), 0.0) << i;
    EXPECT_LT(room_m(0.99 * least_m), 0.0) << i;
    if (!std::isfinite(greatest_m)) continue;
    EXPECT_GT(room_m(0.99 * greatest_m), 0.0) << i;
    EXPECT_LT(room_m(1.01 * greatest_m), 0.0) << i;
    ++ends;
  }
  EXPECT_GT(ends, 20);
  EXPECT_LT(none, 10);
}

TEST(PinMeasure, PinClearsTheRootThatTheRackLeaves) {
  Random random(66);
  int seen = 0;
  for (int i = 0; i < 80; ++i) {
    const auto g = random.gear(false);
    const auto pins = pin_measure(g, std::nullopt);
    if (!pins) continue;
    const double share = g.gear.teeth % 2 == 1 ? std::cos(kPi / (2.0 * g.gear.teeth)) : 1.0;
    const Spot axis{.x_m = 0.0, .y_m = (pins->over_pins_m - pins->pin_diameter_m) / (2.0 * share)};
    const RackTooth rack(g);
    EXPECT_GT(axis.y_m - 0.5 * pins->pin_diameter_m, rack.root_radius_m()) << i;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= 100; ++k) {
      const double r = rack.root_radius_m() + 0.01 * k * (g.tip_radius_m - rack.root_radius_m());
      least = std::min(least, distance_m(axis, polar(r, rack.at(r, 400).half_angle)));
    }
    EXPECT_GE(least, 0.5 * pins->pin_diameter_m - to_rounding(g)) << i;
    ++seen;
  }
  EXPECT_GT(seen, 50);
}

TEST_P(MeasuresOfBothKinds, ProposedPinTouchesOnTheShiftedCircleWithinItsRounding) {
  Random random(67);
  int seen = 0;
  for (int i = 0; i < sample(70, 200); ++i) {
    const auto g = random.gear(GetParam());
    const auto pins = pin_measure(g, std::nullopt);
    if (!pins) continue;
    ++seen;
    const double hundredths = pins->pin_diameter_m / 1e-5;
    EXPECT_NEAR(hundredths, std::round(hundredths), 1e-6) << i;
    const double target_m = g.reference_radius_m + g.gear.profile_shift * g.gear.module_m;
    // Of this pin and the one 0.01 mm thinner, one touches beyond the circle and one short of it.
    const auto touched_m = [&](double pin_m) {
      return seat_of(pin_m, g.base_radius_m,
                     std::max(g.tip_radius_m, g.root_radius_m) + g.gear.module_m, GetParam(),
                     [&](double r) { return flank_half_angle(g, r); })
          .contact_m;
    };
    const double sign = GetParam() ? -1.0 : 1.0;
    const double slack = 1e-6 * g.reference_radius_m;
    EXPECT_GE(sign * (touched_m(pins->pin_diameter_m) - target_m), -slack) << i;
    EXPECT_LE(sign * (touched_m(pins->pin_diameter_m - 1e-5) - target_m), slack) << i;
  }
  EXPECT_GT(seen, sample(42, 120));
}

TEST_P(MeasuresOfBothKinds, ChordalThicknessIsMeasuredBetweenTheFlanksOnTheReferenceCircle) {
  Random random(68);
  LargestDeviation chord, height;
  for (int i = 0; i < 3000; ++i) {
    const auto g = random.gear(GetParam());
    const double r = g.reference_radius_m;
    const double half = kPi / g.gear.teeth - flank_half_angle(g, r);
    const Spot left = polar(r, -half), right = polar(r, half);
    const auto measured = chordal_thickness(g);
    chord.see(i, measured.chord_m - distance_m(left, right), to_rounding(g));
    height.see(
        i, measured.height_m - (GetParam() ? left.y_m - g.tip_radius_m : g.tip_radius_m - left.y_m),
        to_rounding(g));
  }
  chord.expect_allowed("chord");
  height.expect_allowed("height");
}

TEST_P(MeasuresOfBothKinds, FormCircleThicknessIsTheChordWhereTheFlanksEnd) {
  Random random(69);
  LargestDeviation chord;
  for (int i = 0; i < 3000; ++i) {
    const auto g = random.gear(GetParam());
    const auto form = make_tooth_form(g);
    const double half = kPi / g.gear.teeth - flank_half_angle(g, form.form_radius_m);
    chord.see(i,
              form_circle_thickness(g, form) -
                  distance_m(polar(form.form_radius_m, -half), polar(form.form_radius_m, half)),
              to_rounding(g));
  }
  chord.expect_allowed("chord");
}

TEST_P(MeasuresOfBothKinds, RootSpaceIsAsWideAsTheInvolutesContinuedToTheRootCircle) {
  Random random(70);
  LargestDeviation width;
  int seen = 0, none = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto g = random.gear(GetParam());
    const auto space = root_space_width(g);
    ASSERT_EQ(space.has_value(), g.root_radius_m >= g.base_radius_m) << i;
    if (!space) {
      ++none;
      continue;
    }
    ++seen;
    width.see(i, *space - 2.0 * g.root_radius_m * flank_half_angle(g, g.root_radius_m),
              to_rounding(g));
  }
  EXPECT_GT(seen, 500);
  EXPECT_TRUE(GetParam() || none > 500) << none;
  width.expect_allowed("width");
}

TEST_P(MeasuresOfBothKinds, InfeedOfANominalToolLeavesTheThinnedFlanks) {
  Random random(71);
  LargestDeviation angle, root;
  for (int i = 0; i < 3000; ++i) {
    const auto g = random.gear(GetParam());
    const auto deeper = infeed(g);
    Gear<double> nominal = g.gear;
    nominal.machining_allowance = 0.0;
    nominal.profile_shift = deeper.profile_shift;
    const auto cut = make_gear_geometry(nominal, g.angle);
    for (const double r :
         {1.001 * g.base_radius_m, g.reference_radius_m, 1.1 * g.reference_radius_m}) {
      angle.see(i, flank_half_angle(cut, r) - flank_half_angle(g, r), 16.0 * kEps);
    }
    root.see(i, deeper.root_radius_m - cut.root_radius_m, to_rounding(g));
    const double deeper_m = GetParam() ? deeper.root_radius_m - g.root_radius_m
                                       : g.root_radius_m - deeper.root_radius_m;
    EXPECT_GE(deeper_m, 0.0) << i;
  }
  angle.expect_allowed("angle");
  root.expect_allowed("root");
}

}  // namespace
}  // namespace gear3k::geometry::tooth_measures_test
