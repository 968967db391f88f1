#include "efficiency/mesh_loss.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "geometry/mesh.hpp"
#include "tests/largest_deviation.hpp"

namespace gear3k::efficiency::mesh_loss_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

class Random {
 public:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }

 private:
  std::mt19937_64 generator_{9};
};

/// Twice the mean over one base pitch of the mean |s| of the pairs in contact, by the midpoint
/// rule: at every phase, the pairs on the path from -approach to recess are counted.  Phases
/// without a pair do not enter the mean.
double factor_by_midpoints(double approach, double recess, int steps) {
  double sum = 0.0;
  int phases = 0;
  for (int i = 0; i < steps; ++i) {
    const double phase = (i + 0.5) / steps;
    double sliding = 0.0;
    int pairs = 0;
    for (double s = phase - approach; s < recess; s += 1.0) {
      sliding += std::abs(s);
      ++pairs;
    }
    if (pairs == 0) continue;
    sum += sliding / pairs;
    ++phases;
  }
  return 2.0 * sum / phases;
}

TEST(SlidingFactor, IsTheMeanSlidingByNumericalIntegration) {
  // With approach and recess on the grid, kinks and jumps fall between the cells, and the midpoint
  // rule is exact for the linear pieces.
  constexpr int kSteps = 512;
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 3000; ++i) {
    const double approach = random.count(-kSteps, 3 * kSteps) / static_cast<double>(kSteps);
    const double epsilon = random.count(1, 4 * kSteps) / static_cast<double>(kSteps);
    const double recess = epsilon - approach;
    const double expected = factor_by_midpoints(approach, recess, kSteps);
    largest.see(i, sliding_factor(approach, recess) - expected, 4.0 * kEps * (1.0 + expected));
  }
  largest.expect_allowed("integral");
}

TEST(SlidingFactor, IsTheMeanSlidingForContactRatiosBetweenTheGridPoints) {
  // Truncation: two jumps of at most max |s| may lie up to half a cell off.
  constexpr int kSteps = 4000;
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    const double approach = random.between(-1.0, 3.0);
    const double recess = random.between(0.2, 4.0) - approach;
    const double reach = std::max(std::abs(approach), std::abs(recess)) + 1.0;
    const double in_contact = std::min(1.0, approach + recess);
    largest.see(i, sliding_factor(approach, recess) - factor_by_midpoints(approach, recess, kSteps),
                2.0 * reach / (kSteps * in_contact));
  }
  largest.expect_allowed("integral");
}

TEST(SlidingFactor, HasTheClosedFormOfOneToTwoPairs) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 20000; ++i) {
    const double ea = random.between(-1.0, 2.5);
    const double epsilon = random.between(1.0, 2.0);
    const double er = epsilon - ea;
    double expected = 1.0 - epsilon + ea * ea + er * er;
    for (const double e : {ea, er}) {
      expected -= std::pow(std::max(0.0, e - 1.0), 2) + std::pow(std::max(0.0, -e), 2);
    }
    largest.see(i, sliding_factor(ea, er) - expected, 16.0 * kEps);
  }
  largest.expect_allowed("closed_form");
}

TEST(SlidingFactor, EqualsOhlendorfWithinItsRangeAndIsNotAboveItBeyond) {
  Random random;
  LargestDeviation largest;
  int beyond = 0;
  for (int i = 0; i < 20000; ++i) {
    const double ea = random.between(-0.5, 2.0);
    const double er = random.between(1.0, 2.0) - ea;
    const double sliding = sliding_factor(ea, er);
    const double ohlendorf = ohlendorf_factor(ea, er);
    if (loss_model_in_range(LossModel::kOhlendorf, ea, er)) {
      largest.see(i, sliding - ohlendorf, 4.0 * kEps);
    } else {
      EXPECT_LE(sliding, ohlendorf + 32.0 * kEps) << ea << ", " << er;
      ++beyond;
    }
  }
  largest.expect_allowed("ohlendorf");
  EXPECT_GT(beyond, 5000);
}

TEST(SlidingFactor, IsTheSameWhenApproachAndRecessChangePlaces) {
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 5000; ++i) {
    const double ea = random.between(-1.0, 3.0);
    const double er = random.between(0.1, 4.0) - ea;
    const double factor = sliding_factor(ea, er);
    // Over a short share of the pitch the mean divides by that share.
    const double share = std::min(1.0, ea + er);
    largest.see(i, sliding_factor(er, ea) - factor, 8.0 * kEps * (1.0 + factor) / share);
  }
  largest.expect_allowed("symmetry");
}

TEST(SlidingFactor, ContinuesAcrossWholeContactRatiosAndTheEmptyPath) {
  constexpr double kStep = 1e-9;
  for (const double epsilon : {0.0, 1.0, 2.0, 3.0}) {
    for (double ea = -1.0; ea <= 3.0; ea += 0.0625) {
      const double below = sliding_factor(ea, epsilon - kStep - ea);
      const double above = sliding_factor(ea, epsilon + kStep - ea);
      // Lipschitz: |s| and the weights change by a few times the step.
      EXPECT_NEAR(below, above, 20.0 * kStep + (epsilon == 0.0 ? 1e-6 : 0.0))
          << ea << " of " << epsilon;
    }
  }
}

TEST(SlidingFactor, OfAnEmptyPathIsTwiceTheDistanceOfItsMiddle) {
  EXPECT_DOUBLE_EQ(sliding_factor(0.75, -0.75), 1.5);
  EXPECT_DOUBLE_EQ(sliding_factor(-1.0, 0.5), 1.5);
  EXPECT_DOUBLE_EQ(sliding_factor(0.5, -1.0), 1.5);
}

TEST(MeshEfficiency, LosesTheFrictionWorkOfTheContactPointsInThePlane) {
  // Velocities of both flanks at points of the line of action, drawn in the plane; the pairs in
  // contact share the load equally.
  constexpr int kSteps = 256;
  constexpr double kMu = 0.01;
  Random random;
  LargestDeviation largest;
  for (int i = 0; i < 500; ++i) {
    const bool ring = i % 2 == 1;
    const int z1 = random.count(12, 50);
    const int z2 = ring ? z1 + random.count(10, 60) : random.count(12, 90);
    const double ea = random.count(0, 2 * kSteps) / static_cast<double>(kSteps);
    const double er = random.count(1, 2 * kSteps) / static_cast<double>(kSteps);
    const double alpha_w = random.between(15.0, 30.0) * kPi / 180.0;
    // Pitch point at the origin, centres on the x axis, base radii z/2.
    using Vector = std::complex<double>;
    const double rw1 = 0.5 * z1 / std::cos(alpha_w);
    const double rw2 = 0.5 * z2 / std::cos(alpha_w);
    const Vector center1(-rw1, 0.0);
    const Vector center2(ring ? -rw2 : rw2, 0.0);
    const Vector action = std::polar(1.0, kPi / 2.0 - alpha_w);
    const double w1 = 1.0;
    const double w2 = (ring ? 1.0 : -1.0) * rw1 / rw2;
    const double base_pitch = kPi;  // of module 1 over cos alpha: base circles have z/2
    double loss = 0.0;
    int phases = 0;
    for (int k = 0; k < kSteps; ++k) {
      double sum = 0.0;
      int pairs = 0;
      for (double s = (k + 0.5) / kSteps - ea; s < er; s += 1.0) {
        const Vector point = s * base_pitch * action;
        const Vector slip = Vector(0.0, 1.0) * (w1 * (point - center1) - w2 * (point - center2));
        sum += std::abs(slip);
        ++pairs;
      }
      if (pairs == 0) continue;
      loss += kMu * sum / pairs;
      ++phases;
    }
    const double line_speed = w1 * 0.5 * z1;
    const double expected = 1.0 - loss / phases / line_speed;
    const double eta = mesh_efficiency<double>({.z1 = z1,
                                                .z2 = z2,
                                                .sign = ring ? -1.0 : 1.0,
                                                .approach_contact_ratio = ea,
                                                .recess_contact_ratio = er},
                                               kMu, LossModel::kSliding);
    largest.see(i, eta - expected, 4.0 * kEps);
  }
  largest.expect_allowed("friction_work");
}

TEST(MeshEfficiency, TendsToOneAsFrictionVanishes) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const MeshContact<double> contact{.z1 = random.count(12, 40),
                                      .z2 = random.count(50, 90),
                                      .sign = i % 2 == 0 ? 1.0 : -1.0,
                                      .approach_contact_ratio = random.between(-0.2, 1.3),
                                      .recess_contact_ratio = random.between(0.5, 1.3)};
    for (const LossModel model : {LossModel::kSliding, LossModel::kOhlendorf}) {
      EXPECT_EQ(mesh_efficiency(contact, 0.0, model), 1.0);
      const double small = 1.0 - mesh_efficiency(contact, 0.01, model);
      const double large = 1.0 - mesh_efficiency(contact, 0.1, model);
      EXPECT_GT(small, 0.0);
      EXPECT_NEAR(large, 10.0 * small, 32.0 * kEps);
      EXPECT_GT(mesh_efficiency(contact, 0.1, model), 0.0);
    }
  }
}

TEST(LossModel, OhlendorfIsInRangeExactlyForRatiosFromZeroToOneWithASumOfAtLeastOne) {
  for (const double ea : {-0.01, 0.0, 0.5, 1.0, 1.01}) {
    for (const double er : {-0.01, 0.0, 0.5, 1.0, 1.01}) {
      const bool inside = ea >= 0.0 && ea <= 1.0 && er >= 0.0 && er <= 1.0 && ea + er >= 1.0;
      EXPECT_EQ(loss_model_in_range(LossModel::kOhlendorf, ea, er), inside) << ea << ", " << er;
      EXPECT_EQ(loss_model_in_range(LossModel::kSliding, ea, er), ea + er > 0.0);
    }
  }
}

TEST(LossModel, NamesAreThoseOfTheFiles) {
  EXPECT_EQ(kLossModelNames[static_cast<std::size_t>(LossModel::kSliding)], "sliding");
  EXPECT_EQ(kLossModelNames[static_cast<std::size_t>(LossModel::kOhlendorf)], "ohlendorf");
}

TEST(MeshEfficiency, PublishedLossFactorsAreReproducedToTheirPrintedDigits) {
  const toml::table file = toml::parse_file(GEAR3K_SOURCE_DIR "/tests/golden/loss_factors.toml");
  ASSERT_NE(std::string(file["cite"].value_or("")), "");
  ASSERT_NE(std::string(file["locator"].value_or("")), "");
  const double half_unit = 0.5 * std::pow(10.0, -file["decimals"].value<int>().value());
  const double m = file["module"].value<double>().value() * 1e-3;
  const auto angle =
      geometry::make_pressure_angle(file["alpha"].value<double>().value() * kPi / 180.0);
  int cases = 0;
  for (const toml::node& node : *file["case"].as_array()) {
    const toml::table& c = *node.as_table();
    const bool internal = std::string(c["kind"].value_or("")) == "internal";
    const auto gear = [&](const std::string& index, geometry::GearKind kind) {
      geometry::Gear<double> g{.teeth = c["z" + index].value<int>().value(),
                               .kind = kind,
                               .module_m = m,
                               .profile_shift = c["x" + index].value<double>().value(),
                               .machining_allowance = 0.0,
                               .tip_shortening = 0.0,
                               .rack = {}};
      const double full = geometry::make_gear_geometry(g, angle).tip_radius_m;
      const double tip = 0.5e-3 * c["tip_diameter" + index].value<double>().value();
      g.tip_shortening = (internal && index == "2" ? tip - full : full - tip) / m;
      return geometry::make_gear_geometry(g, angle);
    };
    const auto gear1 = gear("1", geometry::GearKind::kExternal);
    const auto gear2 =
        gear("2", internal ? geometry::GearKind::kRing : geometry::GearKind::kExternal);
    const auto mesh = geometry::make_mesh_geometry(
        gear1, gear2, file["center_distance"].value<double>().value() * 1e-3);
    ASSERT_TRUE(mesh);
    const MeshContact<double> contact{.z1 = gear1.gear.teeth,
                                      .z2 = gear2.gear.teeth,
                                      .sign = internal ? -1.0 : 1.0,
                                      .approach_contact_ratio = mesh->addendum_contact_ratio2,
                                      .recess_contact_ratio = mesh->addendum_contact_ratio1};
    const double printed = c["loss_factor"].value<double>().value();
    // The report uses the closed form, also where a share of the contact ratio exceeds 1.
    EXPECT_NEAR(1.0 - mesh_efficiency(contact, 1.0, LossModel::kOhlendorf), printed, half_unit)
        << c["id"].value_or("");
    const double sliding = 1.0 - mesh_efficiency(contact, 1.0, LossModel::kSliding);
    if (loss_model_in_range(LossModel::kOhlendorf, contact.approach_contact_ratio,
                            contact.recess_contact_ratio)) {
      EXPECT_NEAR(sliding, printed, half_unit) << c["id"].value_or("");
    } else {
      EXPECT_LT(sliding, printed - half_unit) << c["id"].value_or("");
    }
    ++cases;
  }
  EXPECT_EQ(cases, 2);
}

/// To first order each side of the pitch point contributes its sliding times its friction: by the
/// midpoint rule over a base pitch, pairs in contact sharing the load equally.
TEST(ApproachAndRecess, ScaleTheirSideOfTheLossInFirstOrderModels) {
  Random random;
  constexpr int kSteps = 20000;
  constexpr double kMu = 1e-5;  // second order far below the tolerance
  for (int i = 0; i < 100; ++i) {
    const bool ring = i % 2 == 1;
    MeshContact<double> c{.z1 = random.count(15, 40),
                          .z2 = random.count(60, 90),
                          .sign = ring ? -1.0 : 1.0,
                          .approach_contact_ratio = random.between(0.2, 1.2),
                          .recess_contact_ratio = random.between(0.2, 1.2),
                          .tan_alpha_w = std::tan(random.between(0.3, 0.5)),
                          .gear1_drives = i % 4 < 2};
    const double approach = random.between(0.3, 1.9);
    const double recess = random.between(0.3, 1.9);
    double sliding = 0.0;
    int phases = 0;
    for (int step = 0; step < kSteps; ++step) {
      double sum = 0.0;
      int pairs = 0;
      for (double s = (step + 0.5) / kSteps - c.approach_contact_ratio; s < c.recess_contact_ratio;
           s += 1.0) {
        sum += std::abs(s) * (s < 0.0 ? approach : recess);
        ++pairs;
      }
      if (pairs == 0) continue;
      sliding += sum / pairs;
      ++phases;
    }
    const double expected = kMu * 2.0 * kPi * (1.0 / c.z1 + c.sign / c.z2) * sliding / phases;
    const double loss =
        1.0 - mesh_efficiency<double>(
                  c, {.coefficient = kMu, .approach_factor = approach, .recess_factor = recess},
                  LossModel::kSliding);
    EXPECT_NEAR(loss, expected, 1e-3 * expected) << i;
  }
}

TEST(ApproachAndRecess, NeutralFactorsChangeNoBit) {
  Random random;
  for (const LossModel model : {LossModel::kSliding, LossModel::kOhlendorf}) {
    const MeshContact<double> c{.z1 = 20,
                                .z2 = 60,
                                .approach_contact_ratio = random.between(0.2, 1.0),
                                .recess_contact_ratio = random.between(0.2, 1.0),
                                .tan_alpha_w = 0.4};
    EXPECT_EQ(mesh_efficiency<double>(c, {.coefficient = 0.1}, model),
              mesh_efficiency<double>(
                  c, {.coefficient = 0.1, .approach_factor = 1.0, .recess_factor = 1.0}, model));
  }
}

}  // namespace
}  // namespace gear3k::efficiency::mesh_loss_test
