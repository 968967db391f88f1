#include "papers/reproduce.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "design/evaluation.hpp"
#include "io/files/design_file.hpp"
#include "papers/published_sources.hpp"

namespace gear3k::papers::reproduce_test {
namespace {

const Reproduction& reproduction() {
  static const Reproduction kResult = reproduce(published_sources());
  return kResult;
}

const ComparedRow& row(std::size_t gearbox, const std::string& quantity) {
  for (const ComparedRow& r : reproduction().gearboxes[gearbox].rows) {
    if (r.quantity.starts_with(quantity)) return r;
  }
  throw std::invalid_argument("no row " + quantity);
}

double figure(int entry, const std::string& name) {
  for (const Figure& f : reproduction().ledger.at(static_cast<std::size_t>(entry - 1)).figures) {
    if (f.name == name) return f.value;
  }
  throw std::invalid_argument("no figure " + name);
}

// Figures of the independent recomputation of the paper, to their printed digits.
TEST(Reproduce, RatiosAndDistancesAreThoseOfTheErrata) {
  EXPECT_NEAR(*row(0, "ratio").equations, 95.907, 0.5e-3);
  EXPECT_NEAR(*row(1, "ratio").equations, 5967.0 / 62.0, 1e-12);
  const double half_digit = 0.5e-4;
  EXPECT_NEAR(*row(0, "zero-backlash centre distance S-P1").equations, 16.2077, half_digit);
  EXPECT_NEAR(*row(0, "zero-backlash centre distance P1-R1").equations, 16.1813, half_digit);
  EXPECT_NEAR(*row(0, "zero-backlash centre distance P2-R2").equations, 16.1752, half_digit);
  EXPECT_NEAR(*row(1, "zero-backlash centre distance S-P1").equations, 21.2679, half_digit);
  EXPECT_NEAR(*row(1, "zero-backlash centre distance P1-R1").equations, 21.2679, half_digit);
  EXPECT_NEAR(*row(1, "zero-backlash centre distance P2-R2").equations, 21.2687, half_digit);
}

TEST(Reproduce, OriginalsContactRatiosNeedShortenedTipsAtTheSunAndFullOnesAtTheRing) {
  const double half_digit = 0.5e-3;
  EXPECT_NEAR(*row(1, "contact ratio S-P1, both tips").equations, 1.232, half_digit);
  EXPECT_NEAR(*row(1, "contact ratio S-P1, full teeth").equations, 1.416, half_digit);
  EXPECT_NEAR(*row(1, "contact ratio P1-R1, full teeth").equations, 1.420, half_digit);
}

// The original's 1.565 is that of P2-R2 at its own distance, not at that of P1-R1.
TEST(Reproduce, ContactRatioOfP2R2IsTheOriginalsAtItsOwnDistance) {
  const ComparedRow& own = row(1, "contact ratio P2-R2, full teeth at d = 21.2687 mm");
  EXPECT_EQ(own.paper, 1.565);
  EXPECT_NEAR(own.equations.value(), 1.565, 0.5e-3);
  const ComparedRow& common = row(1, "contact ratio P2-R2, full teeth at d = 21.2679 mm");
  EXPECT_EQ(common.paper, 1.565);
  EXPECT_LT(common.equations.value(), own.equations.value());
}

TEST(Reproduce, RowsSayWhereTheirNumbersArePrinted) {
  int printed = 0;
  for (const GearboxComparison& g : reproduction().gearboxes) {
    for (const ComparedRow& r : g.rows) {
      EXPECT_EQ(r.paper.has_value(), !r.source.empty()) << g.name << ": " << r.quantity;
      printed += r.paper.has_value() ? 1 : 0;
    }
  }
  EXPECT_EQ(printed, 4 + 6);
  EXPECT_EQ(row(0, "ratio").source, "Table III");
  EXPECT_EQ(row(0, "lost motion by the paper's model").source, "section IV");
  EXPECT_EQ(row(0, "accuracy of the model").source, "section VI");
  EXPECT_EQ(row(0, "backward efficiency").source, "section IV");
  EXPECT_EQ(row(1, "contact ratio P1-R1").source, "Matsuki et al. 2019");
  // 8 arcmin is of an unknown allowance and distance, not of q = 0.
  EXPECT_NEAR(row(0, "lost motion by the paper's model").paper.value(), 8.0, 1e-12);
  EXPECT_FALSE(row(0, "lost motion, q = 0").paper);
}

TEST(Reproduce, InertiaFactorsAreThoseOfTheErrata) {
  EXPECT_NEAR(*row(0, "J_P factor per planet, lossless").equations, 6.5, 0.05);
  EXPECT_NEAR(*row(0, "J_P factor per planet, lossless").exact, 282.0, 0.5);
}

TEST(Reproduce, FrictionFitsAreThoseOfTheErrata) {
  struct Fit {
    std::size_t gearbox;
    double mu, backward_percent, backward_mu;
  };
  for (const Fit& expected : {Fit{0, 0.105, 85.7, 0.128}, Fit{1, 0.136, 88.1, 0.169}}) {
    const FrictionFit& fit = reproduction().gearboxes[expected.gearbox].fits.at(0);
    EXPECT_EQ(fit.model, "ohlendorf");
    EXPECT_NEAR(fit.mu.value(), expected.mu, 0.5e-3);
    EXPECT_NEAR(100.0 * fit.backward.value(), expected.backward_percent, 0.05);
    EXPECT_NEAR(fit.backward_mu.value(), expected.backward_mu, 0.5e-3);
    EXPECT_GT(*fit.backward - fit.measured_backward, 0.025) << "about three points unexplained";
  }
}

TEST(Reproduce, NoLossModelWithOneFrictionExplainsBothDirections) {
  for (const std::size_t gearbox : {0U, 1U}) {
    const GearboxComparison& g = reproduction().gearboxes[gearbox];
    ASSERT_EQ(g.fits.size(), 3U);
    for (const FrictionFit& fit : g.fits) {
      const double points = 100.0 * (fit.backward.value() - fit.measured_backward);
      EXPECT_GT(points, 2.5) << g.name << " " << fit.model;
      EXPECT_LT(points, 4.0) << g.name << " " << fit.model;
    }
  }
}

TEST(Reproduce, FittedFrictionGivesTheMeasuredEfficienciesWhenEvaluated) {
  const PublishedSources sources = published_sources();
  const auto evaluated = [](design::Design design, const design::Friction& friction) {
    design.friction = friction;
    return std::get<design::Evaluation>(design::evaluate(design)).efficiency;
  };
  for (const std::size_t gearbox : {0U, 1U}) {
    const PublishedGearbox& published = gearbox == 0 ? sources.low_backlash : sources.bilateral;
    const GearboxComparison& g = reproduction().gearboxes[gearbox];
    const FrictionFit& path = g.fits.at(2);
    EXPECT_EQ(path.model, "coulomb_path");
    const auto eta = evaluated(published.design, {.coefficient = path.mu.value(),
                                                  .model = efficiency::LossModel::kCoulombPath});
    EXPECT_NEAR(eta.forward.value(), published.measured_forward.value(), 1e-12);
    EXPECT_NEAR(eta.backward.value(), path.backward.value(), 1e-12);
    if (!g.directional) continue;
    const auto both =
        evaluated(published.design, {.coefficient = g.directional->mu,
                                     .model = efficiency::LossModel::kDirectional,
                                     .approach_factor = g.directional->approach_factor,
                                     .recess_factor = g.directional->recess_factor});
    EXPECT_NEAR(both.forward.value(), published.measured_forward.value(), 1e-12);
    EXPECT_NEAR(both.backward.value(), published.measured_backward.value(), 1e-12);
  }
  EXPECT_TRUE(reproduction().gearboxes[0].directional.has_value());
}

TEST(Reproduce, ExplainingAllowanceGivesTheMeasuredLostMotionWhenEvaluated) {
  const PublishedSources sources = published_sources();
  for (const std::size_t gearbox : {0U, 1U}) {
    const PublishedGearbox& published = gearbox == 0 ? sources.low_backlash : sources.bilateral;
    const ComparedRow& q = row(gearbox, "allowance q of every gear");
    const auto lost_motion_at = [&](double allowance) {
      design::Design design = published.design;
      design.train.machining_allowance.fill(allowance);
      return std::get<design::Evaluation>(design::evaluate(design)).lost_motion;
    };
    const double measured = published.measured_lost_motion_rad.value();
    EXPECT_NEAR(lost_motion_at(q.equations.value()).paper_rad, measured, 1e-12);
    EXPECT_NEAR(lost_motion_at(q.exact.value()).kinematic_rad, measured, 1e-12);
  }
}

/// Eqs. 18 (with G2, see the ledger) and 19 with eta = 1 - mu pi (1/z1 +- 1/z2) (1 - eps + e_a^2 +
/// e_r^2) of each mesh, written anew: forward, backward.
std::pair<double, double> efficiencies_by_hand(const design::Evaluation& e, double mu) {
  const auto& z = e.teeth;
  const std::array<double, 3> curvature{1.0 / z.S + 1.0 / z.P1, 1.0 / z.P1 - 1.0 / z.R1,
                                        1.0 / z.P2 - 1.0 / z.R2};
  std::array<double, 3> eta{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = e.meshes[k].approach_contact_ratio, r = e.meshes[k].recess_contact_ratio;
    eta[k] = 1.0 - mu * std::numbers::pi * curvature[k] * (1.0 - a - r + a * a + r * r);
  }
  const double g1 = static_cast<double>(z.R1) / z.S;
  const double g2 = static_cast<double>(z.P2 * z.R1) / (z.P1 * z.R2);
  return {(1.0 + eta[0] * eta[1] * g1) * (1.0 - g2) / ((1.0 - eta[1] * eta[2] * g2) * (1.0 + g1)),
          eta[0] * (1.0 + g1) * (eta[1] * eta[2] - g2) /
              (eta[2] * (g1 + eta[0] * eta[1]) * (1.0 - g2))};
}

// Eq. 18 by hand at mu = 0.1; as the paper prints it, with G1, it is negative.
TEST(Reproduce, Equation18NeedsG2) {
  const design::Evaluation e =
      std::get<design::Evaluation>(design::evaluate(published_sources().low_backlash.design));
  EXPECT_NEAR(figure(1, "eta_f with G2"), efficiencies_by_hand(e, 0.1).first, 1e-12);
  EXPECT_LT(figure(1, "eta_f as printed"), 0.0);
}

// The low-backlash paper's section IV: 84 % backward at about 8 arcmin; 89 % at 2 arcmin.
TEST(Reproduce, SimulatedEfficiencyImpliesAFrictionBetweenBothFits) {
  const ComparedRow& backward = row(0, "backward efficiency (eq. 19), mu = 0.1");
  EXPECT_EQ(backward.paper, 84.0);
  EXPECT_EQ(backward.measured, 82.5);
  const design::Evaluation e =
      std::get<design::Evaluation>(design::evaluate(published_sources().low_backlash.design));
  EXPECT_NEAR(backward.equations.value(), 100.0 * efficiencies_by_hand(e, 0.1).second, 1e-9);
  EXPECT_FALSE(row(1, "backward efficiency").paper);
  EXPECT_EQ(row(1, "backward efficiency").measured, 85.3);

  const double mu = figure(10, "mu of the simulated set");
  EXPECT_NEAR(efficiencies_by_hand(e, mu).second, 0.84, 1e-12);
  EXPECT_NEAR(efficiencies_by_hand(e, figure(10, "at least")).second, 0.845, 1e-12);
  EXPECT_NEAR(efficiencies_by_hand(e, figure(10, "at most")).second, 0.835, 1e-12);
  EXPECT_NEAR(figure(10, "forward with it"), 100.0 * efficiencies_by_hand(e, mu).first, 1e-9);
  // What the finding says: between both fits, and neither measurement is met within the rounding.
  const FrictionFit& fit = reproduction().gearboxes[0].fits.at(0);
  EXPECT_LT(fit.mu.value(), figure(10, "at least"));
  EXPECT_GT(fit.backward_mu.value(), figure(10, "at most"));
}

TEST(Reproduce, SetCalledOptimalIsExceededByThePaperAndByItsOwnTeeth) {
  EXPECT_NEAR(figure(11, "Fig. 8a below the set"), 8.0 - 2.0, 1e-9);
  EXPECT_NEAR(figure(11, "above it"), 89.0 - 84.0, 1e-9);
  EXPECT_EQ(published_sources().task.friction.coefficient, 0.1);
  EXPECT_GT(figure(11, "eta_b reached"), figure(11, "eta_b published") + 4.0);
}

// Section V.A: 7.1 (0.3) arcmin; section IV: approximately 8; section VI: 98.5 and 99 %.
TEST(Reproduce, StatedAccuraciesAreComparedWithTheMeasurement) {
  EXPECT_NEAR(row(0, "lost motion, in brackets").measured.value(), 0.3, 1e-12);
  const ComparedRow& accuracy = row(0, "accuracy of the model");
  EXPECT_NEAR(accuracy.paper.value(), 98.5, 1e-12);
  EXPECT_NEAR(accuracy.equations.value(), 100.0 * (7.1 - 0.9) / 7.1, 1e-9);
  EXPECT_NEAR(row(1, "accuracy of the model").paper.value(), 99.0, 1e-12);
  EXPECT_FALSE(row(1, "accuracy of the model").equations);
  EXPECT_NEAR(figure(4, "measured below stated, over the brackets"), 3.0, 1e-9);
  EXPECT_NEAR(figure(4, "brackets over measured"), 30.0 / 7.1, 1e-9);
  EXPECT_NEAR(figure(4, "what the accuracy leaves"), 0.015 * 7.1, 1e-9);
  EXPECT_NEAR(figure(4, "what the bilateral drive gear's leaves"), 0.24, 1e-9);
  // What the finding says: finer than the brackets; half a unit below the stated 8 is still
  // outside.
  EXPECT_LT(figure(4, "what the accuracy leaves"), 0.3);
  const ComparedRow& stated = row(0, "lost motion by the paper's model");
  EXPECT_GT(stated.paper.value() - 0.5, stated.measured.value() + 0.3);

  // q at both ends of the brackets gives these lost motions when evaluated.
  const ComparedRow& q = row(0, "allowance q of every gear");
  const ComparedRow& range = row(0, "half the range of that q");
  const auto lost_motion_at = [](double allowance) {
    design::Design design = published_sources().low_backlash.design;
    design.train.machining_allowance.fill(allowance);
    return std::get<design::Evaluation>(design::evaluate(design)).lost_motion;
  };
  const double arcmin = std::numbers::pi / (180.0 * 60.0);
  for (const double sign : {-1.0, 1.0}) {
    // The law bends a little: half the range is the mean of both sides.
    const double middle = sign * 0.3 * arcmin + 7.1 * arcmin, allowed = 5e-3 * 0.3 * arcmin;
    const double q17 = q.equations.value() + sign * range.equations.value();
    const double exact = q.exact.value() + sign * range.exact.value();
    EXPECT_NEAR(lost_motion_at(q17).paper_rad, middle, allowed);
    EXPECT_NEAR(lost_motion_at(exact).kinematic_rad, middle, allowed);
  }
}

struct Erratum {
  int number;
  const char* figure;
  double value, half_unit;
};

// What was found by an independent recomputation (also tests/golden/published_3k.toml), to its
// printed digits.
TEST(Reproduce, LedgerHoldsTheFiguresOfTheErrata) {
  ASSERT_EQ(reproduction().ledger.size(), 13U);
  for (const Erratum& e : std::initializer_list<Erratum>{
           {1, "eta_f with G2", 0.8761, 0.5e-4},
           {2, "low-backlash prototype", 95.907, 0.5e-3},
           {2, "bilateral drive gear", 96.242, 0.5e-3},
           {3, "P2-R2 as printed", 21.2759, 0.5e-4},
           {3, "P2-R2 mended", 21.2687, 0.5e-4},
           {4, "zero-backlash S-P1", 16.2077, 0.5e-4},
           {4, "best common distance", 16.193, 0.5e-3},
           {4, "interference there", 12.0, 0.5},
           {4, "interference at mesh 2's own", 20.0, 0.5},
           {4, "measured lost motion at R2's pitch radius", 55.0, 0.5},
           {4, "measured below stated", 11.0, 0.5},
           {5, "low-backlash prototype: zS + zR1", 108.0, 0.0},
           {5, "bilateral drive gear: zS + zR1", 102.0, 0.0},
           {7, "factor from eq. 12 (R1)", 0.5, 1e-12},
           {9, "w'_S/w'_R2 rolling", -7.3, 0.05},
           {9, "J_P factor by eq. 32", 6.5, 0.05},
           {9, "J_P factor by energy", 282.0, 0.5},
           {10, "low-backlash prototype: mu from forward", 0.105, 0.5e-3},
           {10, "bilateral drive gear: mu from forward", 0.136, 0.5e-3},
           {2, "bilateral drive gear off by", 0.04, 0.5e-2},
           {2, "low-backlash prototype off by", -0.30, 0.5e-2},
           {5, "low-backlash prototype: |zR2 zP1 - zR1 zP2|", 296.0, 0.0},
           {5, "low-backlash prototype: N gcd(zP1, zP2)", 12.0, 0.0},
           {5, "bilateral drive gear: |zR2 zP1 - zR1 zP2|", 279.0, 0.0},
           {5, "bilateral drive gear: N gcd(zP1, zP2)", 3.0, 0.0},
           {10, "low-backlash prototype: backward predicted", 85.7, 0.05},
           {10, "low-backlash prototype: mu from backward", 0.128, 0.5e-3},
           {10, "bilateral drive gear: backward predicted", 88.1, 0.05},
           {10, "bilateral drive gear: backward measured", 85.3, 1e-9},
           {10, "bilateral drive gear: mu from backward", 0.169, 0.5e-3},
           {10, "P1-R1 approach", 1.27, 0.5e-2},
           {10, "P2-R2 approach", 1.20, 0.5e-2},
           {11, "eta_b published", 86.3, 0.05},
           {11, "eta_b reached", 90.9, 0.05},
           {13, "strain wave over starting torque", 440.0, 1e-9}}) {
    EXPECT_NEAR(figure(e.number, e.figure), e.value, e.half_unit) << e.number << ": " << e.figure;
  }
  EXPECT_LT(figure(1, "eta_f as printed"), 0.0);
}

TEST(Reproduce, TwoDistancesDifferByWhatTheTableOfDistancesSays) {
  const double difference_mm = *row(0, "zero-backlash centre distance S-P1").equations -
                               *row(0, "zero-backlash centre distance P1-R1").equations;
  EXPECT_NEAR(figure(6, "d1 - d2 of full teeth"), 1e3 * difference_mm, 1e-6);
  EXPECT_GT(figure(6, "interference of P1-R1 at d1"), 0.0);
}

TEST(Reproduce, KinematicLostMotionAddsWhereEquation17TakesTheLarger) {
  EXPECT_NEAR(figure(8, "kinematic"),
              figure(8, "of it S-P1") + figure(8, "P1-R1") + figure(8, "P2-R2"), 1e-9);
  EXPECT_NEAR(figure(8, "eq. 17"), 7.1, 1e-9);
  EXPECT_GT(figure(8, "kinematic"), 1.5 * figure(8, "eq. 17"));
}

TEST(Reproduce, Equation2WithTheWorkingAngleEqualsEquation13) {
  EXPECT_NEAR(figure(12, "with alpha_w1"), figure(12, "by eq. 13"), 1e-9);
  EXPECT_GT(std::abs(figure(12, "j of S-P1 by eqs. 1-6 as printed") - figure(12, "by eq. 13")),
            100.0);
}

TEST(Reproduce, ExampleDesignsAreTheGearboxesOfTheData) {
  const PublishedSources sources = published_sources();
  const std::string folder = std::string(GEAR3K_SOURCE_DIR) + "/examples/designs/";
  for (const auto& [file, published] :
       {std::pair{"low_backlash_prototype.toml", &sources.low_backlash.design},
        std::pair{"bilateral_drive_gear.toml", &sources.bilateral.design}}) {
    const design::Design example = io::read_design(folder + file);
    EXPECT_EQ(example.train.teeth, published->train.teeth);
    EXPECT_EQ(example.train.planets, published->train.planets);
    EXPECT_EQ(example.train.profile_shift, published->train.profile_shift);
    EXPECT_EQ(example.train.module_m, published->train.module_m);
    EXPECT_EQ(example.train.pressure_angle_rad, published->train.pressure_angle_rad);
  }
}

}  // namespace
}  // namespace gear3k::papers::reproduce_test
