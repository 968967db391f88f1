#include "calibrate/laws/law_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "calibrate/laws/law_fit.hpp"
#include "calibrate/laws/law_forms.hpp"
#include "calibrate/laws/law_result.hpp"
#include "calibrate/measurement/condition_quantity.hpp"
#include "calibrate/search/search.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "tests/rig/deterministic_random.hpp"

namespace gear3k::calibrate::law_search_test {
namespace {

constexpr double kArcmin = std::numbers::pi / 180.0 / 60.0;
constexpr double kRpm = std::numbers::pi / 30.0;

const BlackBox& box() {
  static const BlackBox b{.name = "box",
                          .ratio = 50.0,
                          .efficiency_forward = 0.8,
                          .efficiency_backward = 0.75,
                          .backlash_rad = 6.0 * kArcmin};
  return b;
}

/// Loads by speeds by directions, three times; the hidden law is a loss in Nm of rpm and Nm.
struct Rig {
  MeasurementSet data;
  std::vector<double> clean;
};
Rig transmission_rig(const std::function<double(double rpm, double nm)>& loss, double sd,
                     int seed) {
  Rig result;
  rig::DeterministicRandom random(static_cast<std::uint64_t>(seed));
  result.data.kind = Kind::kTransmission;
  for (int repeat = 0; repeat < 3; ++repeat) {
    for (const double nm : {6.0, 12.0, 20.0, 31.0, 40.0}) {
      for (const double rpm : {150.0, 400.0, 900.0, 1500.0, 2200.0, 3000.0}) {
        for (const bool forward : {true, false}) {
          Observation row;
          row.condition.direction =
              forward ? design::Direction::kForward : design::Direction::kBackward;
          row.condition.sun_speed_rad_s = rpm * kRpm;
          row.condition.output_torque_Nm = nm;
          // What the black box costs, by hand.
          const double clean =
              forward ? nm / 50.0 / 0.8 + loss(rpm, nm) : nm / 50.0 * 0.75 - loss(rpm, nm);
          result.clean.push_back(clean);
          row.response = clean + sd * random.normal();
          result.data.rows.push_back(row);
        }
      }
    }
  }
  return result;
}

Rig lost_motion_rig(const std::function<double(double nm, double c)>& added_arcmin,
                    double sd_arcmin, int seed) {
  Rig result;
  rig::DeterministicRandom random(static_cast<std::uint64_t>(seed));
  result.data.kind = Kind::kLostMotion;
  for (int k = 0; k < 96; ++k) {
    Observation row;
    row.condition.test_torque_Nm = 0.5 + 2.5 * (k % 8);
    row.condition.temperature_K = 273.15 + 20.0 + 5.0 * (k % 7);
    const double clean =
        6.0 + added_arcmin(row.condition.test_torque_Nm, row.condition.temperature_K - 273.15);
    result.clean.push_back(clean * kArcmin);
    row.response = (clean + sd_arcmin * random.normal()) * kArcmin;
    result.data.rows.push_back(row);
  }
  return result;
}

/// A law found in what the black box leaves, and its parameters.
struct Found {
  FoundLaw law;
  LawResult result;
};
std::optional<Found> law_in(const Rig& rig, LawScope scope = LawScope::kEveryForm) {
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  const Blocks blocks = holdout_blocks(rig.data, covariate_levels(rig.data));
  auto law = find_law(problem, {}, blocks, scope, candidates_for(simulation, rig.data).size());
  if (!law) return std::nullopt;
  const FinalFit final = final_fit(problem, law->hypothesis, law->scale);
  LawResult result = law_result(problem, *law, final, 1.0, 0.5);
  return Found{std::move(*law), std::move(result)};
}

/// Root mean square of held-out predictions less the clean response.
double held_out_error(const Found& found, const Rig& rig) {
  double sum = 0.0;
  for (std::size_t i = 0; i < rig.clean.size(); ++i) {
    const double e = found.law.predicted[static_cast<Eigen::Index>(i)] - rig.clean[i];
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(rig.clean.size()));
}

void expect_inside(const LawResult& law, std::string_view name, double truth) {
  const auto p = std::ranges::find(law.parameters, name, &ParameterResult::name);
  ASSERT_NE(p, law.parameters.end()) << law.formula << " has no " << name;
  EXPECT_LE(p->low, truth) << law.formula << ": " << name;
  EXPECT_GE(p->high, truth) << law.formula << ": " << name;
  EXPECT_LT(p->high - p->low, 0.5 * std::abs(truth) + 0.1) << law.formula << ": " << name;
}

TEST(LawSearch, APowerOfTheSpeedComesBackAsALossInsideItsIntervals) {
  constexpr double kNoise = 0.0004;
  const Rig rig = transmission_rig(
      [](double rpm, double) { return 0.012 * std::pow(rpm / 3000.0, 1.4); }, kNoise, 5);
  const auto found = law_in(rig);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->law.law.action, LawAction::kLoss);
  EXPECT_EQ(found->law.law.rows, LawRows::kAll);
  ASSERT_EQ(found->law.law.factors.size(), 1U);
  EXPECT_EQ(found->law.law.factors[0].shape, LawShape::kPower) << found->result.formula;
  EXPECT_EQ(found->result.unit, "Nm");
  expect_inside(found->result, "amplitude", 0.012);
  expect_inside(found->result, "exponent", 1.4);
  EXPECT_LT(held_out_error(*found, rig), 0.458 * kNoise);
}

TEST(LawSearch, AProductOfTwoPowersComesBackInsideItsIntervals) {
  constexpr double kNoise = 0.0001;
  const Rig rig = transmission_rig(
      [](double rpm, double nm) {
        return 0.02 * std::pow(rpm / 3000.0, 0.8) * std::pow(nm / 40.0, 1.5);
      },
      kNoise, 6);
  const auto found = law_in(rig);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->law.law.factors.size(), 2U) << found->result.formula;
  EXPECT_EQ(found->result.name, "law: power of output_torque times power of sun_speed");
  expect_inside(found->result, "amplitude", 0.02);
  expect_inside(found->result, "exponent", 1.5);
  expect_inside(found->result, "exponent_2", 0.8);
  EXPECT_LT(held_out_error(*found, rig), 0.458 * kNoise);
}

TEST(LawSearch, ASaturationOfLostMotionComesBackInsideItsIntervals) {
  constexpr double kNoise = 0.02;
  const Rig rig =
      lost_motion_rig([](double nm, double) { return 2.5 * nm / (nm + 4.0); }, kNoise, 7);
  const auto found = law_in(rig);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->law.law.factors[0].shape, LawShape::kSaturation) << found->result.formula;
  EXPECT_EQ(found->result.unit, "arcmin");
  expect_inside(found->result, "half_value", 4.0);
  // The amplitude is told at the greatest torque, 18 Nm.
  expect_inside(found->result, "amplitude", 2.5 * 18.0 / 22.0);
  ASSERT_EQ(found->result.range.size(), 1U);
  EXPECT_EQ(found->result.range[0].low, 0.5);
  EXPECT_EQ(found->result.range[0].high, 18.0);
}

// No two loads alike, 0.2 Nm apart from 6 Nm on; a loss above a threshold.
TEST(LawSearch, AThresholdIsFoundBetweenTheTwoLoadsThatItLiesBetween) {
  for (const double threshold : {17.05, 22.65, 27.25}) {
    Rig rig = transmission_rig([](double, double) { return 0.0; }, 0.001, 11);
    const std::size_t n = rig.data.rows.size();
    double below = 0.0;
    double above = 1e9;
    for (std::size_t i = 0; i < n; ++i) {
      Observation& row = rig.data.rows[i];
      const double nm = 6.0 + 0.2 * static_cast<double>(37 * i % n);
      const bool forward = row.condition.direction == design::Direction::kForward;
      const double noise = row.response - rig.clean[i];
      const double loss = nm > threshold ? 0.01 : 0.0;
      row.condition.output_torque_Nm = nm;
      row.response = noise + (forward ? nm / 50.0 / 0.8 + loss : nm / 50.0 * 0.75 - loss);
      (nm > threshold ? above : below) = nm > threshold ? std::min(above, nm) : std::max(below, nm);
    }
    const auto found = law_in(rig);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->law.law.factors.size(), 1U) << found->result.formula;
    ASSERT_EQ(found->law.law.factors[0].shape, LawShape::kStep) << found->result.formula;
    EXPECT_GT(found->law.law.factors[0].constant, below);
    EXPECT_LT(found->law.law.factors[0].constant, above);
  }
}

TEST(LawSearch, APeakBetweenTwoSpeedsIsNamedWhereNothingElseIsNear) {
  // At 900 and 1500 rpm it has 0.58 of its height.
  constexpr double kNoise = 0.0004;
  const Rig rig = transmission_rig(
      [](double rpm, double) {
        const double x = (rpm - 1200.0) / 350.0;
        return 0.02 / (1.0 + x * x);
      },
      kNoise, 12);
  const auto found = law_in(rig);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->law.law.factors[0].shape, LawShape::kResonance) << found->result.formula;
  expect_inside(found->result, "centre", 1200.0);
  expect_inside(found->result, "width", 350.0);
  EXPECT_LT(held_out_error(*found, rig), 0.458 * kNoise);
}

TEST(LawSearch, APeakFarAboveWhatTheRowsHoldIsNot) {
  // At 900 and 1500 rpm it has a fifth of its height.
  const Rig rig = transmission_rig(
      [](double rpm, double) {
        const double x = (rpm - 1200.0) / 150.0;
        return 0.02 / (1.0 + x * x);
      },
      0.0004, 13);
  const auto found = law_in(rig);
  ASSERT_TRUE(found);
  double greatest = 0.0;
  for (double rpm = 150.0; rpm <= 3000.0; rpm += 10.0) {
    Condition c = rig.data.rows.front().condition;
    c.sun_speed_rad_s = rpm * kRpm;
    const auto values = values_of(found->law.hypothesis, found->law.hypothesis.effects.size() - 1);
    if (!acts_in(found->law.law, c)) continue;
    greatest = std::max(greatest, std::abs(law_value(found->law.law, c, values.data())));
  }
  // Twice what the rows differ by: 0.004 less next to nothing.
  EXPECT_LT(greatest, 0.0088) << found->result.formula;
}

/// 8 torques by angles over seven turns of the output; pulses of lost motion.
Rig pulse_rig(double order) {
  Rig rig = lost_motion_rig([](double, double) { return 0.0; }, 0.05, 14);
  for (std::size_t i = 0; i < rig.data.rows.size(); ++i) {
    Observation& row = rig.data.rows[i];
    const double turn = 7.0 * std::fmod(0.6180339887 * static_cast<double>(i), 1.0);
    row.condition.output_angle_rad = 2.0 * std::numbers::pi * turn;
    const double off = order * turn - std::round(order * turn);
    row.response += 1.5 * kArcmin * std::exp(-off * off / (0.1 * 0.1));
  }
  return rig;
}

std::size_t condition_named(std::string_view name) {
  const auto at = std::ranges::find(law_conditions(), name, &LawCondition::name);
  return static_cast<std::size_t>(at - law_conditions().begin());
}

/// A trial refined and polished in all rows, and its sum between the two.
struct Polished {
  LawTrial trial;
  double refined_sum = 0.0;
};
Polished polished(const Rig& rig, LawTrial trial, double scale) {
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  const LawData data = law_data(problem, {}, LawScope::kEveryForm);
  std::vector<Eigen::Index> all(rig.data.rows.size());
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  const LawFit fit(data, scale);
  fit.refine(trial, all);
  const double refined_sum = trial.sum;
  fit.polish(trial, all);
  return {std::move(trial), refined_sum};
}

/// Every second pulse of an order, at half the width of all.
LawTrial every_second_of(double order) {
  return {.law = {.factors = {{.shape = LawShape::kPulse,
                               .condition = condition_named(kOutputAngle.name),
                               .reference = 360.0,
                               .constant = 0.05}}},
          .value = {1.5, 0.5 * order, 0.0}};
}

TEST(LawFit, EverySecondPulseIsPolishedToAll) {
  const Polished all = polished(pulse_rig(5.3), every_second_of(5.3), 0.05 * kArcmin);
  EXPECT_LT(all.trial.sum, 0.2 * all.refined_sum);
  EXPECT_NEAR(all.trial.value[1], 5.3, 0.01);
  EXPECT_NEAR(all.trial.law.factors[0].constant, 0.1, 0.021);
}

TEST(LawFit, PulsesAreDoubledToTwiceTheOrdersThatWereLookedThroughAndNoFurther) {
  for (const auto& [highest, order] : {std::pair{2.6, 2.65}, std::pair{2.7, 5.3}}) {
    LawTrial trial = every_second_of(5.3);
    trial.highest_order = highest;
    EXPECT_NEAR(polished(pulse_rig(5.3), trial, 0.05 * kArcmin).trial.value[1], order, 0.02);
  }
  // Nor beyond the bound of an order.
  const LawTrial high =
      polished(pulse_rig(12000.0), every_second_of(12000.0), 0.05 * kArcmin).trial;
  EXPECT_NEAR(high.value[1], 6000.0, 0.02);
}

TEST(LawForms, PreferredNumbersAreTheNearestInRatio) {
  const std::vector<double> known{0.01, 0.0125, 0.016, 0.02, 0.025, 0.0315, 0.04,  0.05, 0.063,
                                  0.08, 0.1,    0.125, 0.16, 0.2,   0.25,   0.315, 0.4,  0.5,
                                  0.63, 0.8,    1.0,   1.25, 1.6,   2.0,    2.5};
  for (std::size_t k = 1; k + 1 < known.size(); ++k) {
    // Off the grid by less than half a step, which is a ratio of 1.12.
    for (const double off : {0.91, 1.0, 1.09}) {
      EXPECT_DOUBLE_EQ(preferred_number(off * known[k]), known[k]) << off;
      EXPECT_DOUBLE_EQ(preferred_number(off * known[k], -1), known[k - 1]) << off;
      EXPECT_DOUBLE_EQ(preferred_number(off * known[k], 1), known[k + 1]) << off;
    }
  }
}

TEST(LawForms, AStepHasFourRowsAndATwentiethOnEitherSide) {
  std::vector<double> rising(200);
  std::iota(rising.begin(), rising.end(), 1.0);
  const StepRange of_many(rising);
  EXPECT_FALSE(of_many.contains(9.5));
  EXPECT_TRUE(of_many.contains(10.5));
  EXPECT_TRUE(of_many.contains(190.5));
  EXPECT_FALSE(of_many.contains(191.5));
  rising.resize(8);
  EXPECT_FALSE(StepRange(rising).contains(3.5));
  EXPECT_TRUE(StepRange(rising).contains(4.5));
  EXPECT_FALSE(StepRange(rising).contains(5.5));
  rising.resize(7);
  EXPECT_FALSE(StepRange(rising).contains(4.5));
}

TEST(LawFit, AThresholdOfOneDirectionIsMovedBetweenTheLoadsOfThatDirection) {
  // Forward at four loads, backward at forty between each two of them; forward one step at 35 N m.
  constexpr double kNoise = 0.001;
  Rig rig;
  rig.data.kind = Kind::kTransmission;
  rig::DeterministicRandom random(5);
  const auto add = [&](bool forward, double nm) {
    Observation row;
    row.condition.direction = forward ? design::Direction::kForward : design::Direction::kBackward;
    row.condition.sun_speed_rad_s = 1000.0 * kRpm;
    row.condition.output_torque_Nm = nm;
    row.response = (forward ? nm / 50.0 / 0.8 + (nm > 35.0 ? 0.02 : 0.0) : nm / 50.0 * 0.75) +
                   kNoise * random.normal();
    rig.data.rows.push_back(row);
  };
  for (int k = 0; k < 120; ++k) {
    add(false, 10.125 + 0.25 * k);
    add(true, 10.0 * (1 + k % 4));
  }
  const LawTrial start{.law = {.rows = LawRows::kForward,
                               .factors = {{.shape = LawShape::kStep,
                                            .condition = condition_named(kOutputTorque.name),
                                            .reference = 40.0,
                                            .constant = 15.0}}},
                       .value = {0.01}};
  const LawTrial found = polished(rig, start, kNoise).trial;
  EXPECT_DOUBLE_EQ(found.law.factors[0].constant, 35.0);
  EXPECT_NEAR(found.value[0], 0.02, 4.0 * kNoise / std::sqrt(30.0));
}

TEST(LawFit, WithoutABlockALawThatIsExactPredictsItExactly) {
  // No noise: whatever block is left out, the others determine the law, and only fitting it anew,
  // not its linearisation at other values, gives what was hidden.
  const auto loss = [](double rpm, double) {
    const double x = (rpm - 1000.0) / 300.0;
    return 0.02 / (1.0 + x * x);
  };
  const Rig rig = transmission_rig(loss, 0.0, 1);
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  const Law law{.action = LawAction::kLoss,
                .factors = {{.shape = LawShape::kResonance,
                             .condition = condition_named(kSunSpeed.name),
                             .reference = 3000.0}}};
  const Form form = form_of(law);
  Hypothesis h = with({}, {.cause = &law_cause(),
                           .form = form,
                           .parameters = law_cause().parameters(form, rig.data.kind)});
  h.value = {0.018, 960.0, 330.0};
  const auto blocks = blocks_along("speed", covariate_levels(rig.data));
  ASSERT_TRUE(blocks);
  const Eigen::VectorXd predicted = predict_law_held_out(problem, h, *blocks, 0.0004);
  for (std::size_t i = 0; i < rig.clean.size(); ++i) {
    EXPECT_NEAR(predicted[static_cast<Eigen::Index>(i)], rig.clean[i], 1e-5) << i;
  }
}

TEST(LawFit, WithoutALawAsTheLastEffectNoneIsPredicted) {
  const Rig rig = transmission_rig([](double, double) { return 0.0; }, 0.002, 1);
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  const Blocks blocks = holdout_blocks(rig.data, covariate_levels(rig.data));
  EXPECT_THROW(predict_law_held_out(problem, {}, blocks, 0.002), std::invalid_argument);
  const Hypothesis cause = with({}, candidates_for(simulation, rig.data).front());
  EXPECT_THROW(predict_law_held_out(problem, cause, blocks, 0.002), std::invalid_argument);
}

TEST(LawSearch, AConstantIsNoLawOfWhatItDoesNotFollow) {
  EXPECT_FALSE(law_in(transmission_rig([](double, double) { return 0.02; }, 0.001, 4)));
  // Of the load alone, whatever the speed does beside it.
  const auto found =
      law_in(transmission_rig([](double, double nm) { return 0.0004 * nm; }, 0.0005, 5));
  ASSERT_TRUE(found);
  for (const LawFactor& f : found->law.law.factors) {
    EXPECT_EQ(law_conditions()[f.condition].name, "output_torque");
  }
}

TEST(LawSearch, NothingIsFoundInNoise) {
  for (int seed = 1; seed <= 12; ++seed) {
    EXPECT_FALSE(law_in(transmission_rig([](double, double) { return 0.0; }, 0.002, seed))) << seed;
    EXPECT_FALSE(law_in(lost_motion_rig([](double, double) { return 0.0; }, 0.1, seed))) << seed;
  }
}

TEST(LawSearch, WhatOnlyOneBlockShowsIsNoLaw) {
  // A loss at the highest load alone: no other load says anything of it.
  EXPECT_FALSE(
      law_in(transmission_rig([](double, double nm) { return nm > 35.0 ? 0.01 : 0.0; }, 0.002, 8)));
}

/// What stays where viscous drag and another coefficient of friction stand, and a law is looked for
/// in all rows.
std::optional<FoundLaw> plain_law_after_two_causes(const Rig& rig) {
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  Hypothesis causes;
  const std::vector<Candidate> candidates = candidates_for(simulation, rig.data);
  for (const char* id : {"drag_viscous", "friction_level"}) {
    const auto at =
        std::ranges::find_if(candidates, [&](const Candidate& c) { return c.cause->id == id; });
    causes = with(causes, *at);
  }
  causes = fit(problem, causes, 1.0).hypothesis;
  return find_law(problem, causes, holdout_blocks(rig.data, covariate_levels(rig.data)),
                  LawScope::kPlain, candidates.size());
}

TEST(LawSearch, OneFormulaTakesThePlaceOfTwoCausesThatImitateIt) {
  constexpr double kNoise = 0.0012;
  const Rig rig = transmission_rig(
      [](double rpm, double nm) { return 0.012 * rpm / 3000.0 * std::sqrt(nm / 40.0); }, kNoise,
      21);
  const auto law = plain_law_after_two_causes(rig);
  ASSERT_TRUE(law);
  EXPECT_EQ(law->hypothesis.effects.size(), 1U);
  EXPECT_EQ(law->law.factors.size(), 2U);
  double sum = 0.0;
  for (std::size_t i = 0; i < rig.data.rows.size(); ++i) {
    const Condition& c = rig.data.rows[i].condition;
    const double loss =
        0.012 * c.sun_speed_rad_s / kRpm / 3000.0 * std::sqrt(c.output_torque_Nm / 40.0);
    const double hidden = c.direction == design::Direction::kForward ? loss : -loss;
    const double e = law->change[static_cast<Eigen::Index>(i)] - hidden;
    sum += e * e;
  }
  // A measurement would miss it by 1.1 of the noise.
  EXPECT_LT(std::sqrt(sum / static_cast<double>(rig.clean.size())), 0.458 * kNoise);
}

TEST(LawSearch, WithoutACauseThatItLeavesNothingToItIsWhatItIsAlone) {
  const Rig rig = transmission_rig(
      [](double rpm, double) { return 0.012 * std::pow(rpm / 3000.0, 1.4); }, 0.0008, 5);
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  const Blocks blocks = holdout_blocks(rig.data, covariate_levels(rig.data));
  const std::vector<Candidate> candidates = candidates_for(simulation, rig.data);
  const auto offset = std::ranges::find_if(
      candidates, [](const Candidate& c) { return c.cause->id == "sensor_offset"; });
  ASSERT_NE(offset, candidates.end());
  const Hypothesis cause = fit(problem, with({}, *offset), 0.001).hypothesis;
  const auto law = find_law(problem, cause, blocks, LawScope::kEveryForm, candidates.size());
  ASSERT_TRUE(law);
  ASSERT_EQ(law->hypothesis.effects.size(), 1U);
  // Each row as all parameters of the law, and no others, say that are fitted without its block.
  const Eigen::VectorXd refitted =
      predict_law_held_out(problem, law->hypothesis, blocks, law->scale);
  EXPECT_LT((law->predicted - refitted).cwiseAbs().maxCoeff(), 1e-12);
  // The squares of the simulation as given less those with the law: the noise is far within three
  // deviations of the law, and not of the simulation.
  const Eigen::VectorXd changed = measured(rig.data) - linearise(problem, {}, {}).simulated;
  const auto sum = [&](const Eigen::VectorXd& r) {
    double s = 0.0;
    for (const double x : r) s += huber_square(x / law->scale);
    return s;
  };
  const double n = static_cast<double>(rig.data.rows.size());
  const double price = law_cost(law->law) * std::log(n) + 2.0 * std::log(law->forms);
  EXPECT_NEAR(law->delta_bic, sum(changed) - sum(changed - law->change) - price, 0.5);
}

TEST(LawSearch, IsJudgedByTheRowsAboutItselfAndByAllThatItWasChosenFrom) {
  const Rig rig = lost_motion_rig([](double nm, double) { return 2.5 * nm / (nm + 4.0); }, 0.8, 7);
  const auto found = law_in(rig);
  ASSERT_TRUE(found);
  const FoundLaw& law = found->law;
  const Simulation simulation(box(), rig.data.kind);
  const Problem problem{
      .simulation = simulation, .data = rig.data, .noise = make_noise_model(rig.data)};
  const Eigen::VectorXd without = measured(rig.data) - linearise(problem, {}, {}).simulated;
  const Eigen::VectorXd left = without - law.change;
  const auto n = static_cast<double>(left.size());
  const double degrees = n - static_cast<double>(law.hypothesis.value.size());
  const double scale = robust_deviation(left) * std::sqrt(n / degrees);
  EXPECT_NEAR(law.scale, scale, 0.003 * scale);
  // N times that of the χ² of one form, rows far off as three deviations.
  const auto capped = [&](const Eigen::VectorXd& r) {
    double sum = 0.0;
    for (const double x : r) sum += std::min(x * x / (scale * scale), 9.0);
    return sum;
  };
  const double statistic = (degrees - 0.5) * std::log(capped(without) / capped(left));
  const boost::math::chi_squared one(law_cost(law.law));
  const double p = law.forms * law.orders * cdf(complement(one, statistic));
  ASSERT_LT(p, 1e-3);
  EXPECT_NEAR(std::log(law.p_value), std::log(p), 0.1);
}

TEST(LawSearch, TwoCausesThatAreThereStay) {
  for (int seed = 31; seed <= 34; ++seed) {
    EXPECT_FALSE(plain_law_after_two_causes(transmission_rig(
        [](double rpm, double nm) { return 0.006 * rpm / 3000.0 + 0.00025 * nm; }, 0.0012, seed)));
  }
}

TEST(LawSearch, TwoCausesOfAShapeStayWhereOneBendsALittle) {
  // A housing of two materials, whose expansion grows by 6 in 1000 for each kelvin, and play.
  const Simulation simulation(design_of(rig::bilateral_drive_gear()), Kind::kLostMotion);
  MeasurementSet data = lost_motion_rig([](double, double) { return 0.0; }, 0.0, 1).data;
  const auto of = [&](std::string_view id) {
    const std::vector<Candidate> candidates = candidates_for(simulation, data);
    return *std::ranges::find_if(candidates, [&](const Candidate& c) { return c.cause->id == id; });
  };
  const Hypothesis straight = hypothesis({of("thermal_expansion")}, {20.0});
  const Eigen::VectorXd cold = simulated(simulation, data, {}).value();
  const Eigen::VectorXd warm = simulated(simulation, data, straight).value();
  rig::DeterministicRandom random(3);
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double rise_K = data.rows[i].condition.temperature_K - 293.15;
    data.rows[i].response = cold[k] + (warm[k] - cold[k]) * (1.0 + 0.006 * rise_K) +
                            (0.4 + 0.08 * random.normal()) * kArcmin;
  }
  const Problem problem{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
  const Hypothesis causes =
      fit(problem, with(with({}, of("thermal_expansion")), of("clearance")), 0.1 * kArcmin)
          .hypothesis;
  ASSERT_NEAR(causes.value[1], 0.4, 0.1);
  const auto law = find_law(problem, causes, holdout_blocks(data, covariate_levels(data)),
                            LawScope::kPlain, candidates_for(simulation, data).size());
  EXPECT_TRUE(!law || law->hypothesis.effects.size() == 3U);
}

/// No two speeds alike, neighbours at different loads; a loss [Nm] by the place of the speed.
Rig loss_by_place(const std::function<double(double place)>& loss, int seed) {
  Rig rig = transmission_rig([](double, double) { return 0.0; }, 0.002, seed);
  const std::size_t n = rig.data.rows.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto place = static_cast<double>(37 * i % n);
    Observation& row = rig.data.rows[i];
    row.condition.sun_speed_rad_s = (150.0 + 15.0 * place) * kRpm;
    const bool forward = row.condition.direction == design::Direction::kForward;
    row.response += forward ? loss(place) : -loss(place);
  }
  return rig;
}

TEST(LawSearch, AFewFarRowsAreNoLawWhereNothingElseTellsOfStructure) {
  // Four neighbours twenty deviations off.
  const Rig rig =
      loss_by_place([](double place) { return place >= 60.0 && place < 64.0 ? 0.04 : 0.0; }, 4);
  EXPECT_TRUE(law_in(rig));
  EXPECT_FALSE(law_in(rig, LawScope::kPlain));
}

Rig chatter() {
  return transmission_rig(
      [](double rpm, double) {
        const double x = (rpm - 900.0) / 300.0;
        return 0.02 / (1.0 + x * x);
      },
      0.002, 9);
}

TEST(Laws, ADiagnosisWithoutACauseGetsOneAndItsModelAppliesIt) {
  const Rig rig = chatter();
  const Simulation simulation(box(), Kind::kTransmission);
  const auto d = diagnose(simulation, rig.data, {});
  ASSERT_TRUE(d);
  ASSERT_EQ(d->verdict, Verdict::kUnexplained);
  ASSERT_EQ(d->laws.size(), 1U);
  ASSERT_EQ(d->model.laws.size(), 1U);
  EXPECT_TRUE(d->laws[0].name.starts_with("law: "));
  EXPECT_GT(d->laws[0].held_out_gain, 0.3);
  EXPECT_EQ(d->laws[0].held_out_error, d->errors.extended_holdout);
  EXPECT_LT(d->errors.extended_train, 0.003);
  // The model says in every row what the diagnosis says.
  const Simulation extended(box(), Kind::kTransmission, {d->model});
  const Problem problem{
      .simulation = extended, .data = rig.data, .noise = make_noise_model(rig.data)};
  const Linearisation at = linearise(problem, {}, {});
  for (std::size_t i = 0; i < rig.data.rows.size(); ++i) {
    EXPECT_NEAR(at.simulated[static_cast<Eigen::Index>(i)], d->rows[i].extended, 1e-12);
  }
  // Nothing is left beyond it.
  const auto again = diagnose(extended, rig.data, {});
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->laws.empty());
}

TEST(Laws, OneFoundByItselfHeedsTheRateOfFalseDiscoveries) {
  // A peak twelve neighbouring speeds wide.
  const Rig rig = loss_by_place(
      [](double place) {
        const double x = (place - 90.0) / 6.0;
        return 0.005 / (1.0 + x * x);
      },
      1);
  const Simulation simulation(box(), Kind::kTransmission);
  DiagnoseOptions options;
  options.false_discovery_rate = 1e-5;
  const auto d = diagnose(simulation, rig.data, options);
  ASSERT_EQ(d->laws.size(), 1U);
  EXPECT_EQ(d->verdict, Verdict::kUnexplained);
  const double difference = d->laws[0].delta_bic;
  EXPECT_GT(difference, -2.0 * std::log(1e-5));
  EXPECT_LT(difference, -2.0 * std::log(1e-9));
  // What chance makes is rarer still: the price of a form's numbers is more than they are worth.
  EXPECT_LT(d->p_value, options.false_discovery_rate);
  options.false_discovery_rate = 1e-9;
  EXPECT_TRUE(diagnose(simulation, rig.data, options)->laws.empty());
}

TEST(Laws, WhatIsExplainedOrAgreesHasNone) {
  const Simulation simulation(box(), Kind::kTransmission);
  const auto explained = diagnose(
      simulation, transmission_rig([](double, double) { return 0.02; }, 0.002, 3).data, {});
  ASSERT_TRUE(explained);
  EXPECT_NE(explained->verdict, Verdict::kUnexplained);
  EXPECT_TRUE(explained->laws.empty());
  EXPECT_TRUE(explained->model.laws.empty());
}

}  // namespace
}  // namespace gear3k::calibrate::law_search_test
