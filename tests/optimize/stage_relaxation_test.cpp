#include "optimize/stage_relaxation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "efficiency/mesh_loss.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::optimize::stage_relaxation_test {
namespace {

using rig::DeterministicRandom;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double factor_of(double e1, double e2, bool sliding) {
  return sliding ? efficiency::sliding_factor<double>(e1, e2)
                 : efficiency::ohlendorf_factor<double>(e1, e2);
}

struct Rectangle {
  Interval e1, e2, epsilon;
};

/// The factors at the nodes of a grid that meet the range of ε, corners of the cut included.
template <class Visit>
void visit_grid(const Rectangle& r, bool sliding, int nodes, Visit visit) {
  const auto look = [&](double e1, double e2) {
    constexpr double kRounding = 1e-12;
    if (e1 < r.e1.lo - kRounding || e1 > r.e1.hi + kRounding || e2 < r.e2.lo - kRounding ||
        e2 > r.e2.hi + kRounding || e1 + e2 < r.epsilon.lo - kRounding ||
        e1 + e2 > r.epsilon.hi + kRounding) {
      return;
    }
    visit(factor_of(e1, e2, sliding));
  };
  for (int i = 0; i <= nodes; ++i) {
    const double e1 = r.e1.lo + r.e1.width() * i / nodes;
    for (int k = 0; k <= nodes; ++k) look(e1, r.e2.lo + r.e2.width() * k / nodes);
    for (const double sum : {r.epsilon.lo, r.epsilon.hi}) look(e1, sum - e1);
  }
}
double least_on_grid(const Rectangle& r, bool sliding) {
  double least = kInfinity;
  visit_grid(r, sliding, 80, [&](double factor) { least = std::min(least, factor); });
  return least;
}
double most_on_grid(const Rectangle& r, bool sliding) {
  double most = 0.0;
  visit_grid(r, sliding, 16, [&](double factor) { most = std::max(most, factor); });
  return most;
}

Rectangle random_rectangle(DeterministicRandom& random, const Interval& place,
                           const Interval& epsilon) {
  const auto interval = [&](const Interval& within) {
    const double a = random.between(within.lo, within.hi);
    const double b = random.between(within.lo, within.hi);
    return Interval{std::min(a, b), std::max(a, b)};
  };
  return {.e1 = interval(place), .e2 = interval(place), .epsilon = interval(epsilon)};
}

class LeastLossFactor : public testing::TestWithParam<bool> {};

TEST_P(LeastLossFactor, IsBelowTheFactorAnywhereInTheRectangle) {
  DeterministicRandom random(11);
  int with_points = 0;
  for (int n = 0; n < 1500; ++n) {
    const Rectangle r = random_rectangle(random, {-0.8, 2.6}, {-0.5, 4.5});
    const double bound = least_loss_factor(r.e1, r.e2, r.epsilon, GetParam());
    const double least = least_on_grid(r, GetParam());
    if (least < kInfinity) ++with_points;
    ASSERT_LE(bound, least + 1e-12)
        << "e1 " << r.e1.lo << ".." << r.e1.hi << " e2 " << r.e2.lo << ".." << r.e2.hi << " eps "
        << r.epsilon.lo << ".." << r.epsilon.hi;
  }
  EXPECT_GT(with_points, 700);
}

TEST_P(LeastLossFactor, IsReachedBetweenContactRatiosOfOneAndTwo) {
  DeterministicRandom random(12);
  int compared = 0;
  for (int n = 0; n < 600; ++n) {
    const Rectangle r = random_rectangle(random, {-0.4, 1.9}, {1.0, 2.0});
    const double bound = least_loss_factor(r.e1, r.e2, r.epsilon, GetParam());
    const double least = least_on_grid(r, GetParam());
    if (least == kInfinity) continue;
    ++compared;
    // Half a step of the grid off in each share, slopes at most 3.
    EXPECT_LE(least, bound + 3.0 * (r.e1.width() + r.e2.width()) / 80.0);
  }
  EXPECT_GT(compared, 200);
}

TEST_P(LeastLossFactor, OfAPointIsTheFactorThere) {
  DeterministicRandom random(13);
  for (int n = 0; n < 2000; ++n) {
    const double e1 = random.between(-0.3, 1.5);
    const double e2 = random.between(1.0 - e1, 2.0 - e1);
    const double bound = least_loss_factor({e1, e1}, {e2, e2}, {e1 + e2, e1 + e2}, GetParam());
    EXPECT_NEAR(bound, factor_of(e1, e2, GetParam()), 1e-13);
  }
}

TEST_P(LeastLossFactor, IsInfiniteWhereNothingMeetsTheContactRatio) {
  EXPECT_EQ(least_loss_factor({0.1, 0.2}, {0.3, 0.4}, {1.2, 2.0}, GetParam()), kInfinity);
  EXPECT_EQ(least_loss_factor({1.1, 1.2}, {1.0, 1.4}, {1.2, 2.0}, GetParam()), kInfinity);
}

class MostLossFactor : public testing::TestWithParam<bool> {};

TEST_P(MostLossFactor, IsAboveTheFactorAnywhereInTheRectangle) {
  DeterministicRandom random(14);
  int with_points = 0;
  for (int n = 0; n < 1500; ++n) {
    const Rectangle r = random_rectangle(random, {-2.5, 3.5}, {-0.5, 4.5});
    const double bound = most_loss_factor(r.e1, r.e2, r.epsilon, GetParam());
    const double most = most_on_grid(r, GetParam());
    if (most > 0.0) ++with_points;
    ASSERT_GE(bound, most - 1e-12)
        << "e1 " << r.e1.lo << ".." << r.e1.hi << " e2 " << r.e2.lo << ".." << r.e2.hi << " eps "
        << r.epsilon.lo << ".." << r.epsilon.hi;
  }
  EXPECT_GT(with_points, 700);
}

TEST_P(MostLossFactor, OfAPointIsTheFactorThereBetweenContactRatiosOfOneAndTwo) {
  DeterministicRandom random(15);
  for (int n = 0; n < 2000; ++n) {
    const double e1 = random.between(-2.0, 3.5);
    const double e2 = random.between(1.0 - e1, 2.0 - e1);
    const double bound = most_loss_factor({e1, e1}, {e2, e2}, {e1 + e2, e1 + e2}, GetParam());
    EXPECT_NEAR(bound, factor_of(e1, e2, GetParam()), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, MostLossFactor, testing::Bool(), [](const auto& model) {
  return std::string(model.param ? "Sliding" : "Ohlendorf");
});
INSTANTIATE_TEST_SUITE_P(Models, LeastLossFactor, testing::Bool(), [](const auto& model) {
  return std::string(model.param ? "Sliding" : "Ohlendorf");
});

/// A stage typed anew: gears rolling on each other, in modules, no formula of the library.
struct StageValues {
  bool defined = false;
  double worst_margin = kInfinity;  ///< of the task's limits
  double loss = 0.0;                ///< as the task weights it
};
struct StageGears {
  double d, xS, xP, xR;
};
StageValues stage_at(const StageTask& t, const StageGears& g) {
  const double alpha = t.pressure_angle_rad;
  const auto inv = [](double a) { return std::tan(a) - a; };
  const double pb = std::numbers::pi * std::cos(alpha);
  const double zP = t.planet.teeth, zR = t.ring.teeth;
  const double rbP = 0.5 * zP * std::cos(alpha), rbR = 0.5 * zR * std::cos(alpha);
  StageValues v;
  const auto at_least = [&](double value, double limit) {
    v.worst_margin = std::min(v.worst_margin, value - limit);
  };
  const auto between = [&](double value, const Interval& range) {
    at_least(value, range.lo);
    at_least(range.hi, value);
  };
  const auto flank = [](double ra, double rb) {
    return ra > rb ? std::sqrt(ra * ra - rb * rb) : 0.0;
  };
  const double zS = t.sun ? t.sun->teeth : 0.0;
  double shortening = 0.0;
  if (t.sun) shortening = std::max(0.0, g.xS + g.xP - (g.d - 0.5 * (zS + zP)));
  const double raP =
      0.5 * zP + g.xP + t.planet.tip_height.middle() - (t.planet_khk_tip ? shortening : 0.0);
  const double raR = 0.5 * zR + g.xR + t.ring.tip_height.middle();
  const double rfP = 0.5 * zP + g.xP + t.planet.root_height;
  const double rfR = 0.5 * zR + g.xR + t.ring.root_height;
  const double cosR = (rbR - rbP) / g.d;
  if (!(cosR < 1.0)) return v;
  const double awR = std::acos(cosR);
  // Space of the ring less tooth of the planet on the working pitch circles, along the normal.
  const double rwP = rbP / cosR, rwR = rbR / cosR;
  const double thicknessP =
      2.0 * rwP *
          ((std::numbers::pi / 2.0 + 2.0 * g.xP * std::tan(alpha)) / zP + inv(alpha) - inv(awR)) -
      t.planet.machining_allowance / std::cos(alpha) * rwP / (0.5 * zP);
  const double thicknessR =
      2.0 * rwR *
          ((std::numbers::pi / 2.0 - 2.0 * g.xR * std::tan(alpha)) / zR - inv(alpha) + inv(awR)) -
      t.ring.machining_allowance / std::cos(alpha) * rwR / (0.5 * zR);
  const double jR = (2.0 * std::numbers::pi * rwP / zP - thicknessP - thicknessR) * cosR;
  between(jR, t.ring_backlash);
  const double rhoP = flank(raP, rbP), rhoR = flank(raR, rbR);
  const double eP = (rhoP - rbP * std::tan(awR)) / pb;
  const double eR = (rbR * std::tan(awR) - rhoR) / pb;
  between(eP + eR, t.contact_ratio);
  if (t.interference) at_least(rhoR - g.d * std::sin(awR), *t.interference);
  if (t.root_clearance) {
    at_least(rfR - g.d - raP, *t.root_clearance);
    at_least(raR - g.d - rfP, *t.root_clearance);
  }
  if (t.planet_gap) at_least(g.d * t.planet_gap->half_spacing - raP, t.planet_gap->half_gap);
  v.loss = t.ring_weight * t.ring_loss * factor_of(eP, eR, t.sliding);
  double jS = 0.0;
  if (t.sun) {
    const double rbS = 0.5 * zS * std::cos(alpha);
    const double raS =
        0.5 * zS + g.xS + t.sun->tip_height.middle() - (t.sun_khk_tip ? shortening : 0.0);
    const double rfS = 0.5 * zS + g.xS + t.sun->root_height;
    const double cosS = (rbS + rbP) / g.d;
    if (!(cosS < 1.0)) return v;
    const double awS = std::acos(cosS);
    const auto thickness = [&](double z, double x, double q, double rb) {
      const double rw = rb / cosS;
      return 2.0 * rw *
                 ((std::numbers::pi / 2.0 + 2.0 * x * std::tan(alpha)) / z + inv(alpha) -
                  inv(awS)) -
             q / std::cos(alpha) * rw / (0.5 * z);
    };
    jS = (2.0 * std::numbers::pi * (rbS / cosS) / zS -
          thickness(zS, g.xS, t.sun->machining_allowance, rbS) -
          thickness(zP, g.xP, t.planet.machining_allowance, rbP)) *
         cosS;
    between(jS, t.sun_backlash);
    const double rhoS = flank(raS, rbS);
    const double eS = (rhoS - rbS * std::tan(awS)) / pb;
    const double eP1 = (rhoP - rbP * std::tan(awS)) / pb;
    between(eS + eP1, t.contact_ratio);
    if (t.interference) {
      at_least(g.d * std::sin(awS) - rhoS, *t.interference);
      at_least(g.d * std::sin(awS) - rhoP, *t.interference);
    }
    if (t.root_clearance) {
      at_least(g.d - raS - rfP, *t.root_clearance);
      at_least(g.d - raP - rfS, *t.root_clearance);
    }
    if (t.lost_motion) {
      at_least(t.lost_motion->most, t.lost_motion->sun * jS + t.lost_motion->ring * jR);
    }
    v.loss += t.sun_weight * t.sun_loss * factor_of(eS, eP1, t.sliding);
  }
  v.defined = true;
  return v;
}

StageTask random_stage(DeterministicRandom& random) {
  const auto chance = [&](double p) { return random.uniform() < p; };
  const auto gear = [&](int teeth, bool ring) {
    const double tip = random.between(0.8, 1.1);
    const double lo = random.between(-0.4, 0.4);
    return StageGear{.teeth = teeth,
                     .profile_shift = {lo, lo + random.between(0.1, 1.0)},
                     .tip_height = {ring ? -tip : tip, ring ? -tip : tip},
                     .root_height = ring ? 1.25 : -1.25,
                     .machining_allowance = chance(0.5) ? random.between(0.0, 0.06) : 0.0};
  };
  StageTask t;
  const int zP = 16 + static_cast<int>(random.index(40));
  const int zS = 9 + static_cast<int>(random.index(20));
  const bool with_sun = chance(0.6);
  const int zR = with_sun ? zS + 2 * zP - 2 + static_cast<int>(random.index(5))
                          : zP + 12 + static_cast<int>(random.index(80));
  t.planet = gear(zP, false);
  t.ring = gear(zR, true);
  if (with_sun) t.sun = gear(zS, false);
  t.pressure_angle_rad = random.between(0.3, 0.42);
  t.greatest_angle_rad = 1.39;
  t.sun_khk_tip = with_sun && chance(0.3);
  t.planet_khk_tip = with_sun && chance(0.3);
  const auto backlash = [&]() {
    const double least = chance(0.3) ? -0.05 : 0.0;
    return Interval{chance(0.1) ? -kInfinity : least, chance(0.3) ? kInfinity : 0.35};
  };
  t.sun_backlash = backlash();
  t.ring_backlash = backlash();
  if (with_sun && chance(0.5)) {
    t.lost_motion = StageTask::LostMotion{
        .sun = random.between(0.05, 1.0), .ring = 1.0, .most = random.between(0.05, 0.4)};
  }
  t.contact_ratio = {chance(0.2) ? -kInfinity : random.between(0.8, 1.4),
                     chance(0.4) ? kInfinity : random.between(1.6, 2.5)};
  if (chance(0.6)) t.interference = random.between(-0.2, 0.2);
  if (chance(0.6)) t.root_clearance = random.between(0.0, 0.2);
  if (with_sun && chance(0.4)) {
    t.planet_gap = StageTask::PlanetGap{.half_spacing = std::sin(std::numbers::pi / 3.0),
                                        .half_gap = random.between(-0.5, 0.5)};
  }
  t.sliding = chance(0.6);
  t.sun_loss = with_sun ? 0.1 * std::numbers::pi * (1.0 / zS + 1.0 / zP) : 0.0;
  t.ring_loss = 0.1 * std::numbers::pi * (1.0 / zP - 1.0 / zR);
  t.sun_weight = with_sun ? random.between(0.0, 2.0) : 0.0;
  t.ring_weight = chance(0.2) ? 0.0 : 1.0;
  return t;
}

/// Points of a stage, half of them with shifts that leave the meshes a chosen backlash.
template <class Visit>
void sample_stage(const StageTask& t, DeterministicRandom& random, int points, const Visit& visit) {
  const double c = std::cos(t.pressure_angle_rad), s = std::sin(t.pressure_angle_rad);
  const double inv = s / c - t.pressure_angle_rad;
  const double ring_sum = 0.5 * c * (t.ring.teeth - t.planet.teeth);
  const double sun_sum = t.sun ? 0.5 * c * (t.sun->teeth + t.planet.teeth) : 0.0;
  const double closest = std::max(ring_sum, sun_sum);
  const auto in = [&](const Interval& range) { return random.between(range.lo, range.hi); };
  const auto opening = [&](double sum, double d) {
    const double aw = std::acos(sum / d);
    return 2.0 * sum * (std::tan(aw) - aw - inv);
  };
  for (int n = 0; n < points; ++n) {
    StageGears g{.d = closest * random.between(1.0 + 1e-9, 1.15),
                 .xS = t.sun ? in(t.sun->profile_shift) : 0.0,
                 .xP = in(t.planet.profile_shift),
                 .xR = in(t.ring.profile_shift)};
    if (n % 2 == 0) {
      const double q2 = t.planet.machining_allowance + t.ring.machining_allowance;
      const double j2 = std::max(-0.05, t.ring_backlash.lo) + random.between(0.0, 0.1);
      g.xR = g.xP + (j2 - q2 + opening(ring_sum, g.d)) / (2.0 * s);
      if (t.sun) {
        const double q1 = t.planet.machining_allowance + t.sun->machining_allowance;
        const double j1 = std::max(-0.05, t.sun_backlash.lo) + random.between(0.0, 0.1);
        g.xS = (opening(sun_sum, g.d) + q1 - j1) / (2.0 * s) - g.xP;
        const Interval& xs = t.sun->profile_shift;
        if (g.xS < xs.lo || g.xS > xs.hi) continue;
      }
      const Interval& xr = t.ring.profile_shift;
      if (g.xR < xr.lo || g.xR > xr.hi) continue;
    }
    visit(g, stage_at(t, g));
  }
}

std::string text_of(const StageTask& t, const StageGears& g) {
  return "zS " + std::to_string(t.sun ? t.sun->teeth : 0) + " zP " +
         std::to_string(t.planet.teeth) + " zR " + std::to_string(t.ring.teeth) + " d " +
         std::to_string(g.d) + " x " + std::to_string(g.xS) + " " + std::to_string(g.xP) + " " +
         std::to_string(g.xR);
}

TEST(RelaxStage, NoPointThatMeetsTheLimitsHasLessLossThanTheBound) {
  DeterministicRandom random(21);
  int feasible = 0, stages = 0;
  for (int n = 0; n < 250; ++n) {
    const StageTask t = random_stage(random);
    const StageBound bound = relax_stage(t, {.boxes = 400, .tolerance = 1e-3});
    bool any = false;
    sample_stage(t, random, 1500, [&](const StageGears& g, const StageValues& v) {
      if (!v.defined || v.worst_margin < 0.0) return;
      any = true;
      ++feasible;
      ASSERT_FALSE(bound.empty) << "stage " << n << ": " << text_of(t, g);
      ASSERT_GE(v.loss, bound.least - 1e-12) << "stage " << n << ": " << text_of(t, g);
      ASSERT_GE(g.d, bound.center_distance.lo - 1e-8) << "stage " << n;
      ASSERT_LE(g.d, bound.center_distance.hi + 1e-8) << "stage " << n;
    });
    stages += any ? 1 : 0;
  }
  EXPECT_GT(feasible, 5000);
  EXPECT_GT(stages, 60);
}

TEST(RelaxStage, ComesNearTheLeastLossThatSamplingFinds) {
  DeterministicRandom random(22);
  int compared = 0;
  for (int n = 0; n < 120; ++n) {
    const StageTask t = random_stage(random);
    const StageBound bound = relax_stage(t, {.boxes = 20000, .tolerance = 1e-3});
    if (bound.empty || t.sun || t.ring_weight == 0.0) continue;
    double least = kInfinity;
    sample_stage(t, random, 30000, [&](const StageGears&, const StageValues& v) {
      if (v.defined && v.worst_margin >= 0.0) least = std::min(least, v.loss);
    });
    // Contact ratios outside [1, 2] have cruder bounds.
    if (least == kInfinity || !(t.contact_ratio.lo >= 1.0 && t.contact_ratio.hi <= 2.0)) continue;
    ++compared;
    EXPECT_LT(least, 1.05 * bound.least) << "stage " << n;
  }
  EXPECT_GT(compared, 5);
}

TEST(RelaxStage, MoreBoxesNeverLowerTheBound) {
  DeterministicRandom random(23);
  for (int n = 0; n < 150; ++n) {
    const StageTask t = random_stage(random);
    double before = 0.0;
    bool was_empty = false;
    for (const int boxes : {1, 3, 10, 50, 200, 1000}) {
      const StageBound bound = relax_stage(t, {.boxes = boxes, .tolerance = 0.0});
      EXPECT_TRUE(bound.empty || !was_empty) << "stage " << n;
      was_empty = bound.empty;
      if (bound.empty) continue;
      EXPECT_GE(bound.least, before * (1.0 - 1e-9)) << "stage " << n << " boxes " << boxes;
      before = bound.least;
    }
  }
}

TEST(RelaxStage, EmptyStageHasNoPointOnADenseGrid) {
  DeterministicRandom random(24);
  int empty = 0;
  for (int n = 0; n < 400 && empty < 40; ++n) {
    StageTask t = random_stage(random);
    t.sun.reset();  // two shifts and a distance fit a grid
    t.sun_khk_tip = t.planet_khk_tip = false;
    t.lost_motion.reset();
    // Limits that often contradict each other.
    t.contact_ratio = {random.between(1.3, 2.0), 2.2};
    t.ring_backlash = {0.0, 0.1};
    t.interference = random.between(0.0, 0.5);
    t.ring_weight = 1.0;
    if (!relax_stage(t, {.boxes = 2000, .tolerance = 0.0}).empty) continue;
    ++empty;
    const double sum = 0.5 * std::cos(t.pressure_angle_rad) * (t.ring.teeth - t.planet.teeth);
    constexpr int kNodes = 45;
    for (int i = 0; i < kNodes; ++i) {
      for (int k = 0; k < kNodes; ++k) {
        for (int l = 0; l < kNodes; ++l) {
          const auto at = [](const Interval& range, int node) {
            return range.lo + range.width() * node / (kNodes - 1);
          };
          const StageGears g{.d = sum * (1.0 + 1e-9 + 0.25 * i * i / (kNodes * kNodes)),
                             .xS = 0.0,
                             .xP = at(t.planet.profile_shift, k),
                             .xR = at(t.ring.profile_shift, l)};
          const StageValues v = stage_at(t, g);
          ASSERT_FALSE(v.defined && v.worst_margin >= 0.0) << text_of(t, g);
        }
      }
    }
  }
  EXPECT_GT(empty, 10);
}

TEST(RelaxStage, ShiftRangesWithoutAPointAreEmpty) {
  DeterministicRandom random(25);
  StageTask t = random_stage(random);
  t.ring.profile_shift = {0.5, 0.4};
  EXPECT_TRUE(relax_stage(t, {}).empty);
}

}  // namespace
}  // namespace gear3k::optimize::stage_relaxation_test
