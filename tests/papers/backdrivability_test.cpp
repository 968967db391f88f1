// The backdrivability-factors paper against its printed numbers, hand sums and other derivations.

#include "papers/backdrivability.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "papers/backdrivability_figures.hpp"
#include "papers/backdrivability_report.hpp"
#include "papers/published_sources.hpp"
#include "papers/reproduce.hpp"

namespace gear3k::papers::backdrivability_test {
namespace {

const BackdrivabilitySources& sources() {
  static const BackdrivabilitySources kSources = published_sources().backdrivability;
  return kSources;
}
const BackdrivabilityComparison& comparison() {
  static const BackdrivabilityComparison kResult = compare_backdrivability(sources());
  return kResult;
}
const ComparedRow& row(const std::string& quantity) {
  for (const ComparedRow& r : comparison().rows) {
    if (r.quantity.starts_with(quantity)) return r;
  }
  throw std::invalid_argument("no row " + quantity);
}
const ScalingLaw& law(const std::string& name) {
  for (const ScalingLaw& l : comparison().laws) {
    if (l.name == name) return l;
  }
  throw std::invalid_argument("no law " + name);
}
double figure(const std::string& where, const std::string& name) {
  for (const LedgerEntry& entry : comparison().ledger) {
    if (entry.where != where) continue;
    for (const Figure& f : entry.figures) {
      if (f.name == name) return f.value;
    }
  }
  throw std::invalid_argument("no figure " + name + " of " + where);
}

// Products and quotients of Table I's printed numbers by hand.
TEST(Backdrivability, OwnEquationsAreHandSumsOfTableOne) {
  EXPECT_NEAR(*row("Table I, eq. 24").equations, 1.3815833e-5, 1e-12);
  EXPECT_NEAR(*row("eq. 37: fraction").equations, 0.447 / (90.0 * 0.0295) / (90.0 * 0.0295), 1e-12);
  EXPECT_NEAR(*row("eq. 38").equations, 0.198948, 1e-9);
  EXPECT_NEAR(*row("eq. 41").equations, 0.27792, 1e-12);
  EXPECT_NEAR(*row("eq. 42").equations, 0.1944, 1e-12);
  EXPECT_NEAR(*row("eq. 45: factor of w").equations, 0.248948, 1e-9);
  EXPECT_NEAR(*row("eq. 45: factor of the acceleration").equations, 0.47232, 1e-12);
  EXPECT_NEAR(*row("eq. 45: factor of the angle").equations, 8750.0, 1e-9);
  EXPECT_EQ(*row("eq. 39").equations, 17.0);
}

TEST(Backdrivability, PrintedColumnIsTenTimesItsOwnEquationsWhereTheErrataSayIt) {
  for (const char* quantity :
       {"Table I, eq. 24", "eq. 38", "eq. 41", "eq. 42", "eq. 45: factor of the acceleration"}) {
    EXPECT_NEAR(*row(quantity).paper / *row(quantity).equations, 10.0, 0.16) << quantity;
  }
}

// 0.75 at 54 N m with 17 N m of drag: the input gives 54/0.75 = 72 at the output, 71 arrive in the
// mesh, 1 is lost; backward 1 of 71 again.
TEST(Backdrivability, CorrectedMeshLosesOneOfSeventyOne) {
  EXPECT_NEAR(mesh_efficiency(sources().statements), 71.0 / 72.0, 1e-15);
  EXPECT_NEAR(backward_mesh_efficiency(sources().statements), 70.0 / 71.0, 1e-15);
  EXPECT_NEAR(*row("eq. 40").exact, 1.0 / 71.0, 1e-15);
  EXPECT_NEAR(*row("eq. 41").exact, 0.27792 * 71.0 / 70.0, 1e-12);
  EXPECT_NEAR(*row("eq. 45: factor of w").exact, 0.198948 + 0.05 * 70.0 / 71.0, 1e-9);
  EXPECT_NEAR(*row("eq. 45: Coulomb").exact, 17.0 * 70.0 / 71.0, 1e-12);
}

// Driven from outside at constant acceleration with the motor off: what the corrected column says
// of the torque is what a duty cycle needs without a motor torque.
TEST(Backdrivability, CorrectedEq45GivesNoMotorTorqueInADutyCycle) {
  const actuator::Actuator a = knee_actuator(sources().statements, KneeNumbers::kCorrected);
  const double eta_b = *row("eq. 45: factor of tau").exact;
  constexpr double kAcceleration = 3.0;
  const auto torque = [&](double w) {
    return (*row("eq. 45: Coulomb").exact + *row("eq. 45: factor of w").exact * w +
            *row("eq. 45: factor of the acceleration").exact * kAcceleration) /
           eta_b;
  };
  actuator::Cycle cycle;
  cycle.time_s = {0.0, 1.0};
  cycle.motion = {1.0, 1.0 + kAcceleration};
  cycle.load_Nm = {torque(cycle.motion[0]), torque(cycle.motion[1])};
  const actuator::DutyCycle d = actuator::run_cycle(a, cycle, true);
  EXPECT_LT(d.peak_motor_torque_Nm, 1e-12);
}

// A hand-made table that follows y = 3 x1^2.5 x2^-1 in one series, twice that in the other.
TEST(Backdrivability, FitFindsTheExponentsOfExactPowerLaws) {
  ScalingLaw exact;
  exact.name = "exact";
  exact.factors.resize(2);
  for (const double x1 : {1.0, 2.0, 5.0}) {
    for (const double x2 : {1.0, 3.0, 7.0}) {
      const double y = 3.0 * std::pow(x1, 2.5) / x2;
      exact.points.push_back({.series = "a", .y = y, .x = {x1, x2}});
      exact.points.push_back({.series = "b", .y = 2.0 * y, .x = {x1, x2}});
    }
  }
  fit(exact);
  EXPECT_NEAR(exact.factors[0].exponent, 2.5, 1e-13);
  EXPECT_NEAR(exact.factors[1].exponent, -1.0, 1e-13);
  EXPECT_LT(exact.factors[0].band, 1e-13);
  EXPECT_NEAR(exact.series[1].intercept - exact.series[0].intercept, std::log(2.0), 1e-13);
  EXPECT_NEAR(exact.series[0].intercept, std::log(3.0), 1e-13);
}

// Least squares through (0, 0), (1, 1), (2, 3) in logarithms: slope 3/2, residuals 1/6, -1/3, 1/6,
// s^2 = 1/6, of the slope 1/12; t of 0.975 and 1 degree of freedom 12.7062.
TEST(Backdrivability, BandIsThatOfALineThroughThreePoints) {
  ScalingLaw three;
  three.factors.resize(1);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, std::pair{1.0, 1.0}, std::pair{2.0, 3.0}}) {
    three.points.push_back({.series = "", .y = std::exp(y), .x = {std::exp(x)}});
  }
  fit(three);
  EXPECT_NEAR(three.factors[0].exponent, 1.5, 1e-13);
  EXPECT_NEAR(three.scatter, std::sqrt(1.0 / 6.0), 1e-13);
  EXPECT_NEAR(three.factors[0].band, 12.7062 / std::sqrt(12.0), 1e-4);
}

TEST(Backdrivability, FitRefusesWhatHasNoAnswer) {
  ScalingLaw none;
  EXPECT_THROW(fit(none), std::invalid_argument);
  ScalingLaw two;
  two.factors.resize(1);
  two.points = {{.series = "", .y = 1.0, .x = {1.0}}, {.series = "", .y = 2.0, .x = {2.0}}};
  EXPECT_THROW(fit(two), std::invalid_argument);
  ScalingLaw dependent;
  dependent.factors.resize(2);
  for (const double x : {1.0, 2.0, 3.0, 4.0, 5.0}) {
    dependent.points.push_back({.series = "", .y = x, .x = {x, x * x}});
  }
  EXPECT_THROW(fit(dependent), std::invalid_argument);
}

// Made by normal equations with an indicator column per series, in another language; t from tables.
TEST(Backdrivability, ExponentsAreThoseOfAnotherRegression) {
  struct Expected {
    const char* name;
    std::size_t rows, factor;
    double exponent, error, quantile;  ///< standard error, and t of 0.975
  };
  EXPECT_EQ(law("planetary_inertia").frames, 84U);
  EXPECT_EQ(law("motor_inertia_over_torque").frames, 126U);
  for (const Expected& e : {Expected{"motor_inertia", 23, 0, 3.46806, 0.05800, 2.08596},
                            {"motor_inertia", 23, 1, 0.87639, 0.03161, 2.08596},
                            {"motor_torque", 23, 0, 2.50558, 0.04102, 2.08596},
                            {"motor_torque", 23, 1, 0.75811, 0.02236, 2.08596},
                            {"motor_inertia_over_torque", 126, 0, 1.56600, 0.04596, 1.97993},
                            {"planetary_torque", 84, 0, 0.93894, 0.03860, 1.99254},
                            // 634 rows of 84 frames, clustered by frame
                            {"planetary_inertia", 634, 0, 1.36118, 0.08173, 1.98896},
                            {"planetary_inertia", 634, 1, 2.19676, 0.07704, 1.98896},
                            {"strain_wave_torque", 4, 0, 3.66220, 0.60864, 4.30265},
                            {"strain_wave_stiffness", 4, 0, 3.21967, 0.16884, 4.30265},
                            {"strain_wave_last_stiffness", 4, 0, 3.58768, 0.20027, 4.30265},
                            {"stiffness_over_torque", 4, 0, 0.94515, 0.10449, 4.30265}}) {
    const ScalingLaw& l = law(e.name);
    EXPECT_EQ(l.points.size(), e.rows) << e.name;
    EXPECT_NEAR(l.factors[e.factor].exponent, e.exponent, 0.6e-5) << e.name;
    EXPECT_NEAR(l.factors[e.factor].band, e.quantile * e.error, 3e-5) << e.name;
  }
}

TEST(Backdrivability, LedgerHasTheFiguresOfTheErrata) {
  EXPECT_NEAR(figure("eqs. 3 to 5, Fig. 2: planets", "relative spin squared"), 854.0, 0.5);
  EXPECT_NEAR(figure("eqs. 3 to 5, Fig. 2: planets", "carrier's speed squared"), 155.0, 0.5);
  EXPECT_NEAR(figure("eqs. 3 to 5, Fig. 2: planets", "absolute spin squared"), 282.0, 0.5);
  EXPECT_NEAR(figure("eqs. 41, 42, 45", "gearbox"), 0.278, 0.0005);
  EXPECT_NEAR(figure("eqs. 41, 42, 45", "motor"), 0.194, 0.0005);
  EXPECT_NEAR(figure("Table I: D_mD; eqs. 38, 45", "D_mD"), 14.0, 0.5);
  EXPECT_NEAR(figure("eq. 37", "fraction as printed"), 0.0634, 0.00005);
  EXPECT_NEAR(figure("eq. 37", "with 0.75 outside the square"), 0.0475, 0.0001);
  EXPECT_NEAR(figure("eqs. 40, 45: 0.2 and 17 N m", "forward at 46 N m with both"), 55.0, 0.5);
  EXPECT_NEAR(figure("eqs. 40, 45: 0.2 and 17 N m", "mesh alone"), 98.6, 0.05);
  EXPECT_NEAR(figure("eqs. 1, 45: stiffness", "in series"), 8750.0, 1e-6);
  EXPECT_EQ(figure("eq. 24", "motors"), 25.0);
  EXPECT_NEAR(figure("eq. 24", "median"), 37.0, 0.5);
  // 34 N m over 0.75 and 120.
  EXPECT_NEAR(figure("Table I, eq. 39: 34 N m", "motor torque that starts it"), 0.37778, 1e-5);
  EXPECT_LT(figure("Table I, eq. 39: 34 N m", "RT1 off its rule, at most"), 0.5);
  // (13.9 - 6.5)/(13.9 - 4.6)
  EXPECT_NEAR(figure("Sec. 4.1: I to II", "share"), 79.57, 0.005);
}

TEST(Backdrivability, EveryLedgerEntryShowsFigures) {
  int number = 0;
  for (const LedgerEntry& entry : comparison().ledger) {
    EXPECT_EQ(entry.number, ++number);
    EXPECT_FALSE(entry.figures.empty()) << entry.where;
  }
  EXPECT_GE(number, 20);
}

// The digitised curves alone, moment times speed: positive where the knee drives the leg, its load;
// by midpoints, the curves joined by straight lines over a stride that repeats.
TEST(Backdrivability, OneWorkOfTheKneeHasOneNameInAllTexts) {
  using Curve = std::vector<std::pair<double, double>>;
  std::map<std::string, Curve> curves;
  std::ifstream file(GEAR3K_SOURCE_DIR "/data/knee_walking_digitised.csv");
  for (std::string line; std::getline(file, line);) {
    const std::size_t first = line.find(',');
    if (line.starts_with('#') || line.starts_with("series") || first == std::string::npos) continue;
    const std::size_t second = line.find(',', first + 1);
    curves[line.substr(0, first)].emplace_back(std::stod(line.substr(first + 1)),
                                               std::stod(line.substr(second + 1)));
  }
  ASSERT_EQ(curves.size(), 2U);
  const auto at = [](const Curve& curve, double x) {
    auto next = std::ranges::find_if(curve, [&](const auto& p) { return p.first >= x; });
    const bool inside = next != curve.begin() && next != curve.end();
    if (next == curve.end()) next = curve.begin();
    const auto& to = *next;
    const auto& from = next == curve.begin() ? curve.back() : *(next - 1);
    const double gap = inside ? to.first - from.first : to.first + 100.0 - from.first;
    const double gone = x >= from.first ? x - from.first : x + 100.0 - from.first;
    return from.second + (to.second - from.second) * gone / gap;
  };
  constexpr int kSteps = 20000;
  constexpr double kStride_s = 1.1;
  double to_the_load = 0.0;
  double back = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double x = 100.0 * (k + 0.5) / kSteps;
    const double power = 75.0 * at(curves.at("knee_moment_nm_per_kg"), x) *
                         at(curves.at("knee_angular_velocity_deg_s"), x) * std::numbers::pi / 180.0;
    (power > 0.0 ? to_the_load : back) += std::abs(power) * kStride_s / kSteps;
  }
  // Where the curves meet over the end of the stride is ours: some hundredths of a joule.
  constexpr double kSeam_J = 0.05;
  const auto told = [&](int number, const std::string& name) {
    for (const Figure& f : comparison().ledger.at(static_cast<std::size_t>(number - 1)).figures) {
      if (f.name == name) return f.value;
    }
    ADD_FAILURE() << number << ": " << name;
    return 0.0;
  };
  EXPECT_NEAR(told(21, "given back by the load"), back, kSeam_J);
  EXPECT_NEAR(told(24, "of what the load gives back"), back, kSeam_J);
  EXPECT_NEAR(told(25, "its work on the load"), to_the_load, kSeam_J);
  const std::string text = backdrivability_table(comparison());
  EXPECT_NE(
      text.find(fmt::format("its load takes {:.2f} J and gives back {:.2f} J",
                            told(25, "its work on the load"), told(21, "given back by the load"))),
      std::string::npos)
      << text;
  EXPECT_EQ(text.find("given by the knee"), std::string::npos);
}

// Two sums over the rows that know nothing of events: energy by Simpson on each row interval.
TEST(Backdrivability, StretchesOfNegativePowerHoldAllThatTheKneeGives) {
  const KneeExample& knee = comparison().knee;
  double given = 0.0;
  for (const NegativeStretch& s : knee.negative) given += s.energy_J;
  EXPECT_NEAR(given, knee.runs.front().duty.negative_J, 1e-10);
  double net = 0.0;
  const actuator::Cycle& c = knee.cycle;
  for (std::size_t k = 0; k + 1 < c.time_s.size(); ++k) {
    const auto power = [&](double x) {
      return -(c.load_Nm[k] + x * (c.load_Nm[k + 1] - c.load_Nm[k])) *
             (c.motion[k] + x * (c.motion[k + 1] - c.motion[k]));
    };
    net += (c.time_s[k + 1] - c.time_s[k]) / 6.0 * (power(0.0) + 4.0 * power(0.5) + power(1.0));
  }
  const actuator::DutyCycle& d = knee.runs.front().duty;
  EXPECT_NEAR(d.positive_J - d.negative_J, net, 1e-10);
  // As the paper's Fig. 10: four stretches, each from zero torque to zero speed.
  ASSERT_EQ(knee.negative.size(), 4U);
  for (const NegativeStretch& s : knee.negative) {
    EXPECT_TRUE(s.begins_at_zero_torque);
    EXPECT_FALSE(s.ends_at_zero_torque);
  }
}

TEST(Backdrivability, KneeRunsCloseTheirLedgers) {
  const KneeExample& knee = comparison().knee;
  ASSERT_EQ(knee.runs.size(), 3U);
  for (const KneeRun& run : knee.runs) EXPECT_LT(run.duty.balance_error, 1e-12) << run.name;
  EXPECT_NEAR(knee.peak_torque_Nm, 75.0 * 0.46, 0.05);  // peak 0.46 N m/kg of the curves
  // What is saved without gear drag is most: the paper's "friction is mainly responsible".
  const auto most =
      std::ranges::max_element(knee.without_each, {}, &actuator::WithoutCause::saved_J);
  EXPECT_EQ(most->cause, "gear_coulomb");
}

// Similar gearboxes: forces on lengths squared, torques and stiffnesses on lengths cubed; only what
// ISO 6336 has depend on the module, the speed or the load in N/mm bends it a little.
TEST(Backdrivability, ADesignInOtherSizesIsAsStiffAsItsTorque) {
  const ScaledDesign design = scaled_design();
  ASSERT_EQ(design.sizes.size(), design.stiffness.points.size());
  EXPECT_NEAR(design.stiffness.factors[0].exponent, 1.0, 0.01);
  for (std::size_t k = 0; k < design.sizes.size(); ++k) {
    const double cube = std::pow(design.sizes[k], 3);
    EXPECT_NEAR(design.stiffness.points[k].y / design.stiffness.points[2].y / cube, 1.0, 0.02);
  }
}

// The stride in small steps by the law of docs/theory §58 written out here, with Table I's numbers
// by hand: J1, D1, eta_f, eta_b of the three sets.
TEST(Backdrivability, KneeRunsAreSumsOverSmallSteps) {
  struct Numbers {
    double j1, d1, eta_f, eta_b;
  };
  constexpr std::array<Numbers, 3> kNumbers{{{4.72, 2.02, 0.75, 0.8},
                                             {0.47232, 0.198948, 0.75, 0.75},
                                             {0.47232, 0.198948, 71.0 / 72.0, 70.0 / 71.0}}};
  constexpr int kSteps = 100;
  const KneeExample& knee = comparison().knee;
  const actuator::Cycle& c = knee.cycle;
  for (std::size_t n = 0; n < kNumbers.size(); ++n) {
    const Numbers& k = kNumbers[n];
    double drawn = 0.0;
    double regenerated = 0.0;
    for (std::size_t r = 0; r + 1 < c.time_s.size(); ++r) {
      const double dt = (c.time_s[r + 1] - c.time_s[r]) / kSteps;
      const double a = (c.motion[r + 1] - c.motion[r]) / (kSteps * dt);
      for (int step = 0; step < kSteps; ++step) {
        const double x = (step + 0.5) / kSteps;
        const double w = c.motion[r] + x * (c.motion[r + 1] - c.motion[r]);
        const double load = c.load_Nm[r] + x * (c.load_Nm[r + 1] - c.load_Nm[r]);
        const double s = w > 0.0 ? 1.0 : -1.0;
        const double mesh = 17.0 * s + 0.05 * w - load;
        const double input = s * mesh > 0.0 ? mesh / k.eta_f : k.eta_b * mesh;
        const double torque = k.j1 * a + k.d1 * w + input;
        const double current = torque / (120.0 * 0.0295);
        const double power = 0.447 * current * current + torque * w;
        (power > 0.0 ? drawn : regenerated) += std::abs(power) * dt;
      }
    }
    EXPECT_NEAR(knee.runs[n].duty.drawn_J, drawn, 1e-4 * drawn) << n;
    EXPECT_NEAR(knee.runs[n].duty.regenerated_J, regenerated, 1e-3 * regenerated) << n;
  }
}

TEST(Backdrivability, RegeneratingPlacesHoldAllNegativePower) {
  const KneeRun& run = comparison().knee.runs.back();
  const auto places = regenerating_places(run, 1.1);
  ASSERT_FALSE(places.empty());
  for (const actuator::MotorInstant& p : run.duty.instants) {
    if (p.electrical_W > -1e-9) continue;
    const double percent = 100.0 * p.time_s / 1.1;
    EXPECT_TRUE(std::ranges::any_of(places, [&](const auto& place) {
      return place.first <= percent + 1e-9 && percent <= place.second + 1e-9;
    })) << percent;
  }
}

}  // namespace
}  // namespace gear3k::papers::backdrivability_test
