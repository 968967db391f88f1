#include "calibrate/verdict/experiment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "numerics/linear_algebra.hpp"
#include "tests/calibrate/measured_grid.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::experiment_test {
namespace {

constexpr double kRpm = std::numbers::pi / 30.0;
constexpr double kNoise = 0.004;
constexpr double kTold = 9.0;  ///< χ² that tells two explanations apart, of the interface

class Plan : public testing::Test {
 protected:
  Plan() : design_(design_of(rig::bilateral_drive_gear())) {}

  static Candidate constant() { return candidate("drag_constant", {.name = "sun", .body = "sun"}); }
  static Candidate viscous() { return candidate("drag_viscous", {.name = "sun", .body = "sun"}); }

  void measure(const Hypothesis& truth) {
    const Simulation simulation(design_, Kind::kTransmission);
    const Eigen::VectorXd y = simulated(simulation, data_, truth).value();
    rig::DeterministicRandom random(7);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = y[static_cast<Eigen::Index>(i)] + kNoise * random.normal();
    }
  }
  [[nodiscard]] NextExperiment plan(const std::vector<Candidate>& explanations,
                                    const DiagnoseOptions& options = {}, double sigma = kNoise) {
    std::vector<Hypothesis> alone;
    alone.reserve(explanations.size());
    for (const Candidate& c : explanations) alone.push_back(with({}, c));
    return plan_for(alone, options, sigma);
  }
  [[nodiscard]] NextExperiment plan_for(const std::vector<Hypothesis>& explanations,
                                        const DiagnoseOptions& options = {},
                                        double sigma = kNoise) {
    const Simulation simulation(design_, Kind::kTransmission);
    const Problem p{.simulation = simulation, .data = data_, .noise = make_noise_model(data_)};
    fits_.clear();
    for (const Hypothesis& h : explanations) {
      const Fit first = fit(p, h, 10.0);
      fits_.push_back(
          {.id = std::string(h.effects.back().cause->id), .fit = fit(p, first.hypothesis, 10.0)});
    }
    return plan_experiment(p, fits_, sigma, options);
  }
  /// Squares that remain between one explanation and the other refitted, by least squares on rows
  /// written out one by one; both add to the torque in proportion to their parameter.
  [[nodiscard]] double between(const Fit& truth, const Fit& other,
                               const std::vector<Condition>& conditions,
                               const std::vector<double>& sigma = {}) const {
    const Simulation simulation(design_, Kind::kTransmission);
    Hypothesis unit = other.hypothesis;
    if (!unit.effects.empty()) unit.value = {0.01};
    const auto n = static_cast<Eigen::Index>(conditions.size());
    Eigen::VectorXd y(n);
    // Another coefficient of friction goes with the other explanation; by central differences.
    constexpr double kStep = 1e-4;
    const Candidate level = candidate("friction_level", {.name = "coefficient"});
    Hypothesis more = with(other.hypothesis, level);
    Hypothesis less = more;
    more.value.back() = kStep;
    less.value.back() = -kStep;
    Eigen::MatrixXd x(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Condition& c = conditions[static_cast<std::size_t>(i)];
      const double base = simulated(simulation, c);
      const double row_sigma = sigma.empty() ? kNoise : sigma[static_cast<std::size_t>(i)];
      y[i] = (simulated(simulation, c, truth.hypothesis) - base) / row_sigma;
      x(i, 1) =
          (simulated(simulation, c, more) - simulated(simulation, c, less)) / kStep / row_sigma;
      x(i, 0) = (simulated(simulation, c, unit) - base) / row_sigma;
    }
    const Eigen::MatrixXd free = unit.effects.empty() ? Eigen::MatrixXd(x.col(1)) : x;
    return (y - free * numerics::least_squares(free, y)).squaredNorm();
  }
  [[nodiscard]] std::vector<Condition> measured_conditions() const {
    std::vector<Condition> result;
    for (const Observation& row : data_.rows) result.push_back(row.condition);
    return result;
  }
  static bool names(const std::string& text, const std::string& id) {
    return text.find(id) != std::string::npos;
  }

  design::Design design_;
  MeasurementSet data_;
  std::vector<Explanation> fits_;
};

TEST_F(Plan, ExpectsWhatNewRowsAddToWhatOldRowsHold) {
  // Old rows at two speeds tell the drags apart to some degree already.
  data_ = measured_grid({.sun_speeds_rpm = {400.0, 600.0}, .repeats = 2});
  measure(hypothesis({constant()}, {0.02}));
  DiagnoseOptions options;
  options.sun_speed_rad_s = {300.0 * kRpm, 700.0 * kRpm};
  const NextExperiment next = plan({constant(), viscous()}, options);
  ASSERT_FALSE(next.conditions.empty());
  const std::vector<Condition> old = measured_conditions();
  std::vector<Condition> all = old;
  for (const ProposedCondition& c : next.conditions) {
    for (int k = 0; k < c.repeats; ++k) all.push_back(c.condition);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [truth, other] : std::array<std::array<std::size_t, 2>, 2>{{{0, 1}, {1, 0}}}) {
    const Fit& a = fits_[truth].fit;
    const Fit& b = fits_[other].fit;
    const double known = between(a, b, old);
    EXPECT_GT(known, 5.0);
    least = std::min(least, between(a, b, all) - known);
  }
  EXPECT_NEAR(next.expected_statistic, least, 1e-5 * least);
}

TEST_F(Plan, TellsACauseFromNoneByWhatTheCauseWouldAdd) {
  data_ = measured_grid({.sun_speeds_rpm = {400.0, 600.0}, .repeats = 2});
  measure(hypothesis({constant()}, {0.004}));
  const Simulation simulation(design_, Kind::kTransmission);
  const Problem p{.simulation = simulation, .data = data_, .noise = make_noise_model(data_)};
  const Fit drag = fit(p, with({}, constant()), 10.0);
  const Fit none = fit(p, {}, 10.0);
  std::vector<Explanation> explanations{{.id = "drag_constant", .fit = drag},
                                        {.id = "no_cause", .fit = none, .is_rest = true}};
  const NextExperiment next = plan_experiment(p, explanations, kNoise, {});
  EXPECT_EQ(next.separates, (std::vector<std::string>{"drag_constant", "no_cause"}));
  EXPECT_TRUE(next.inseparable.empty()) << next.advice;
  ASSERT_FALSE(next.conditions.empty());
  const std::vector<Condition> old = measured_conditions();
  std::vector<Condition> all = old;
  for (const ProposedCondition& c : next.conditions) {
    for (int k = 0; k < c.repeats; ++k) all.push_back(c.condition);
  }
  const double expected = between(drag, none, all) - between(drag, none, old);
  EXPECT_GE(expected, kTold);
  EXPECT_NEAR(next.expected_statistic, expected, 1e-5 * expected);
  // A drag of 0 does what none does: taken as true, none would tell nothing.
  explanations[1].is_rest = false;
  EXPECT_FALSE(plan_experiment(p, explanations, kNoise, {}).inseparable.empty());
}

TEST_F(Plan, TakesNewRowsToScatterLikeTheOldOnesOnAverage) {
  data_ = measured_grid({.sun_speeds_rpm = {400.0, 600.0}, .repeats = 2});
  measure(hypothesis({constant()}, {0.02}));
  const auto half = data_.rows.size() / 2;
  std::vector<double> sigma(data_.rows.size());
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    sigma[i] = data_.rows[i].sigma = (i < half ? 0.2 : 2.0) * kNoise;
  }
  DiagnoseOptions options;
  options.sun_speed_rad_s = {300.0 * kRpm, 700.0 * kRpm};
  const NextExperiment next = plan({constant(), viscous()}, options, 1.0);
  ASSERT_FALSE(next.conditions.empty());
  const std::vector<Condition> old = measured_conditions();
  std::vector<Condition> all = old;
  for (const ProposedCondition& c : next.conditions) {
    for (int k = 0; k < c.repeats; ++k) all.push_back(c.condition);
  }
  const double typical = kNoise * std::sqrt(0.5 * (0.2 * 0.2 + 2.0 * 2.0));
  std::vector<double> sigma_of_all = sigma;
  sigma_of_all.resize(all.size(), typical);
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [truth, other] : std::array<std::array<std::size_t, 2>, 2>{{{0, 1}, {1, 0}}}) {
    const Fit& a = fits_[truth].fit;
    const Fit& b = fits_[other].fit;
    least = std::min(least, between(a, b, all, sigma_of_all) - between(a, b, old, sigma));
  }
  EXPECT_NEAR(next.expected_statistic, least, 1e-5 * least);
}

TEST_F(Plan, TakesAnglesBetweenThoseThatMakeOrdersAlike) {
  // At every twelfth of a turn order 13 is order 1.
  data_ = measured_grid({.sun_speeds_rpm = {600.0}, .repeats = 12});
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.output_angle_rad = std::numbers::pi / 6.0 * static_cast<double>(i % 12);
  }
  const auto wave = [](const char* id, double order) {
    return candidate(id, {.name = "constant", .body = "output", .order = order});
  };
  measure(hypothesis({wave("runout", 1.0)}, {0.02, 0.01}));
  const NextExperiment next = plan({wave("runout", 1.0), wave("mesh_order", 13.0)});
  EXPECT_TRUE(next.inseparable.empty()) << next.advice;
  EXPECT_GE(next.expected_statistic, kTold);
  for (const ProposedCondition& c : next.conditions) {
    const double twelfths = c.condition.output_angle_rad / (std::numbers::pi / 6.0);
    EXPECT_TRUE(std::isfinite(twelfths));
  }
}

TEST_F(Plan, StaysWithinTheMapAndTheDataWidenedByAQuarter) {
  design_.map.sun_speed_rad_s = {.from = 100.0 * kRpm, .to = 3000.0 * kRpm, .points = 3};
  design_.map.output_torque_Nm = {.from = 2.0, .to = 80.0, .points = 3};
  data_ = measured_grid({.sun_speeds_rpm = {590.0, 600.0}, .output_torques_Nm = {10.0, 20.0}});
  measure(hypothesis({constant()}, {0.02}));
  // Rows that scatter so much that no condition is more than enough.
  const NextExperiment next = plan({constant(), viscous()}, {}, 0.05);
  ASSERT_FALSE(next.conditions.empty());
  double fastest = 0.0;
  for (const ProposedCondition& c : next.conditions) {
    EXPECT_GE(c.condition.sun_speed_rad_s, 100.0 * kRpm * (1.0 - 1e-12));
    EXPECT_LE(c.condition.sun_speed_rad_s, 3000.0 * kRpm * (1.0 + 1e-12));
    EXPECT_GE(c.condition.output_torque_Nm, 2.0);
    EXPECT_LE(c.condition.output_torque_Nm, 80.0);
    EXPECT_GT(c.repeats, 0);
    fastest = std::max(fastest, c.condition.sun_speed_rad_s);
  }
  // A constant and a slope differ most where the gearbox runs fastest: five times the data's speed.
  EXPECT_NEAR(fastest, 3000.0 * kRpm, 1e-9);
}

TEST_F(Plan, StaysWithinTheLimitsThatAreStated) {
  data_ = measured_grid({.sun_speeds_rpm = {590.0, 600.0}, .output_torques_Nm = {10.0, 20.0}});
  for (Observation& row : data_.rows) row.condition.temperature_K = 300.0;
  measure(hypothesis({constant()}, {0.02}));
  DiagnoseOptions options;
  options.sun_speed_rad_s = {450.0 * kRpm, 700.0 * kRpm};
  options.output_torque_Nm = {12.0, 15.0};
  options.temperature_K = {303.0, 305.0};
  const NextExperiment next = plan({constant(), viscous()}, options);
  ASSERT_FALSE(next.conditions.empty());
  const auto within = [](double x, const std::array<double, 2>& limits) {
    constexpr double kRounding = 1e-12;
    return x >= limits[0] * (1.0 - kRounding) && x <= limits[1] * (1.0 + kRounding);
  };
  for (const ProposedCondition& c : next.conditions) {
    EXPECT_TRUE(within(c.condition.sun_speed_rad_s, *options.sun_speed_rad_s));
    EXPECT_TRUE(within(c.condition.output_torque_Nm, *options.output_torque_Nm));
    EXPECT_TRUE(within(c.condition.temperature_K, *options.temperature_K));
  }
}

TEST_F(Plan, GoesTenKelvinBeyondTheTemperaturesOfTheData) {
  data_ = measured_grid({});
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.temperature_K = i % 2 == 0 ? 300.0 : 306.0;
  }
  measure(hypothesis({constant()}, {0.02}));
  const std::vector<Candidate> all =
      candidates_for(Simulation(design_, Kind::kTransmission), data_);
  const auto warm = std::ranges::find_if(
      all, [](const Candidate& c) { return c.cause->id == "friction_temperature"; });
  ASSERT_NE(warm, all.end());
  const NextExperiment next = plan({constant(), *warm});
  ASSERT_FALSE(next.conditions.empty());
  for (const ProposedCondition& c : next.conditions) {
    const double t = c.condition.temperature_K;
    EXPECT_TRUE(std::abs(t - 290.0) < 1e-9 || std::abs(t - 316.0) < 1e-9) << t;
  }
}

TEST_F(Plan, ExpectsANewSessionAtTheMeanOfThoseWithAValueEach) {
  data_ = measured_grid({.repeats = 3});
  data_.runs = {"1", "2", "3"};
  const std::size_t of_run = data_.rows.size() / 3;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.run = static_cast<int>(i / of_run);
  }
  measure(hypothesis({constant()}, {0.02}));
  // A drag that is the same in all sessions, and one of each session: of a fourth they say the
  // same.
  const NextExperiment next = plan(
      {constant(), candidate("run_step", {.name = "sessions_drag",
                                          .constants = {{.name = "sessions", .value = 3.0}}})});
  EXPECT_EQ(next.inseparable.size(), 1U);
  EXPECT_TRUE(next.conditions.empty());
}

TEST_F(Plan, SaysWhereNoConditionTells) {
  // At one speed a constant and a slope are one.
  data_ = measured_grid({.sun_speeds_rpm = {600.0}});
  measure(hypothesis({constant()}, {0.02}));
  DiagnoseOptions options;
  options.sun_speed_rad_s = {600.0 * kRpm, 600.0 * kRpm};
  const NextExperiment next = plan({constant(), viscous()}, options);
  EXPECT_LT(next.expected_statistic, 1e-6);
  EXPECT_TRUE(names(next.advice, "drag_constant")) << next.advice;
  EXPECT_TRUE(names(next.advice, "drag_viscous")) << next.advice;
}

TEST_F(Plan, SaysWhereItsConditionsHardlyTell) {
  // The same question with rows that scatter more and more: first told, then hardly, then not.
  data_ = measured_grid({.sun_speeds_rpm = {590.0, 600.0}, .repeats = 2});
  measure(hypothesis({constant()}, {0.02}));
  DiagnoseOptions options;
  options.sun_speed_rad_s = {500.0 * kRpm, 700.0 * kRpm};
  int told = 0;
  int hardly = 0;
  int never = 0;
  for (double sigma = 1e-4; sigma < 1.0; sigma *= 1.5) {
    const NextExperiment next = plan({constant(), viscous()}, options, sigma);
    const bool tells = next.expected_statistic >= kTold;
    EXPECT_EQ(next.advice.empty(), tells) << sigma << ' ' << next.advice;
    if (!tells) {
      EXPECT_TRUE(names(next.advice, "drag_constant")) << next.advice;
      EXPECT_TRUE(names(next.advice, "drag_viscous")) << next.advice;
    }
    if (!next.inseparable.empty()) {
      ++never;
    } else {
      (tells ? told : hardly) += 1;
    }
  }
  EXPECT_GT(told, 0);
  EXPECT_GT(hardly, 0);
  EXPECT_GT(never, 0);
}

TEST_F(Plan, ExpectsMoreOfRowsThatScatterLess) {
  // χ² goes as 1/σ² for the same rows, while more than enough is not asked for.
  data_ = measured_grid({.sun_speeds_rpm = {590.0, 600.0}, .repeats = 2});
  measure(hypothesis({constant()}, {0.02}));
  double before = std::numeric_limits<double>::infinity();
  for (double sigma = 2e-3; sigma < 0.05; sigma *= 2.0) {
    const NextExperiment next = plan({constant(), viscous()}, {}, sigma);
    int rows = 0;
    for (const ProposedCondition& c : next.conditions) rows += c.repeats;
    EXPECT_LE(rows, 120);
    EXPECT_LE(next.conditions.size(), 4U);
    if (before < 40.0) {
      EXPECT_LT(next.expected_statistic, before);
    }
    before = next.expected_statistic;
  }
  EXPECT_LT(before, 40.0);
}

TEST_F(Plan, TurnsTheSunBackwardToTellAnOffsetFromADrag) {
  data_ = measured_grid({.rotations = {1}});
  measure(hypothesis({constant()}, {0.02}));
  const NextExperiment next = plan({constant(), candidate("sensor_offset", {.name = "offset"})});
  EXPECT_GE(next.expected_statistic, kTold);
  // Either against the rotation or with a sensor that has no offset.
  EXPECT_TRUE(std::ranges::any_of(next.conditions, [](const ProposedCondition& c) {
    return c.condition.rotation < 0 || c.condition.reference_sensor;
  }));
}

TEST_F(Plan, KeepsToRowsThatNoExplanationPutsBeyondPhysics) {
  // Of a zero error of 0.02 Nm, light loads would show an efficiency above 1 one way round.
  data_ = measured_grid({.rotations = {1}});
  measure(hypothesis({constant()}, {0.02}));
  const NextExperiment next = plan({constant(), candidate("sensor_offset", {.name = "offset"})});
  ASSERT_FALSE(next.conditions.empty());
  const Simulation simulation(design_, Kind::kTransmission);
  for (const ProposedCondition& c : next.conditions) {
    for (const Explanation& e : fits_) {
      const double torque = simulated(simulation, c.condition, e.fit.hypothesis);
      const double efficiency =
          c.condition.output_torque_Nm / std::abs(simulation.ratio()) / torque;
      EXPECT_LE(
          c.condition.direction == design::Direction::kForward ? efficiency : 1.0 / efficiency,
          1.0);
    }
  }
}

TEST_F(Plan, TellsWhereACauseActs) {
  // Forward a drag at the output is one at the sun, but for the load's share of the loss.
  data_ = measured_grid({.directions = {design::Direction::kForward}, .rotations = {1}});
  measure(hypothesis({constant()}, {0.02}));
  const Simulation simulation(design_, Kind::kTransmission);
  const Problem p{.simulation = simulation, .data = data_, .noise = make_noise_model(data_)};
  std::vector<Explanation> bodies;
  for (const char* body : {"sun", "output"}) {
    const Hypothesis drag = with({}, candidate("drag_constant", {.name = body, .body = body}));
    bodies.push_back(
        {.id = "drag_constant", .fit = fit(p, fit(p, drag, 10.0).hypothesis, 10.0), .body = body});
  }
  const NextExperiment next = plan_experiment(p, bodies, kNoise, {});
  EXPECT_EQ(next.separates, std::vector<std::string>{"drag_constant"});
  EXPECT_GE(next.expected_statistic, kTold);
  EXPECT_TRUE(std::ranges::any_of(next.conditions, [](const ProposedCondition& c) {
    return c.condition.direction == design::Direction::kBackward;
  }));
  const NextExperiment hopeless = plan_experiment(p, bodies, 10.0, {});
  EXPECT_TRUE(names(hopeless.advice, "drag_constant at the sun from drag_constant at the output"))
      << hopeless.advice;
}

TEST_F(Plan, TakesACalibratedSensorWhereNothingElseTellsAGain) {
  // A line through the origin forward and another one backward: a gain does what the coefficient of
  // friction and its asymmetry do together, at every speed and load.
  data_ = measured_grid({});
  const Hypothesis gain = hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.03});
  measure(gain);
  const Hypothesis friction =
      hypothesis({candidate("friction_level", {.name = "coefficient"}),
                  candidate("friction_direction", {.name = "forward_backward"})},
                 {0.0, 0.0});
  const NextExperiment next = plan_for({gain, friction});
  EXPECT_TRUE(next.inseparable.empty()) << next.advice;
  EXPECT_GE(next.expected_statistic, kTold);
  EXPECT_TRUE(std::ranges::any_of(
      next.conditions, [](const ProposedCondition& c) { return c.condition.reference_sensor; }));
  // Where no sensor is in question, the one at hand will do.
  const NextExperiment drags = plan({constant(), viscous()});
  EXPECT_TRUE(std::ranges::none_of(
      drags.conditions, [](const ProposedCondition& c) { return c.condition.reference_sensor; }));
}

}  // namespace
}  // namespace gear3k::calibrate::experiment_test
