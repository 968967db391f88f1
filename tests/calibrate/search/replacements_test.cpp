#include "calibrate/search/replacements.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "calibrate/search/better_names.hpp"
#include "calibrate/search/free_shapes.hpp"
#include "numerics/linear_algebra.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::replacements_test {
namespace {

class Replacements : public Bench {
 protected:
  void measure(const Hypothesis& truth, double most) { measure_evenly(truth, most, 5); }
  [[nodiscard]] Hypothesis fitted(const Problem& p, Hypothesis h) const {
    for (double scale = 1.0; scale > 1e-3; scale *= 0.5) h = fit(p, h, scale).hypothesis;
    return h;
  }
  /// What a search would hold that had found this.
  [[nodiscard]] SearchResult found(const Problem& p, const Hypothesis& start) const {
    SearchResult result;
    const Hypothesis h = fitted(p, start);
    const double scale = robust_deviation(fit(p, h, 1.0).residual);
    result.fit = fit(p, h, scale);
    result.scale = scale;
    std::ranges::copy_if(candidates_for(simulation_, data_), std::back_inserter(result.candidates),
                         [](const Candidate& c) { return c.form.weight > 0.0; });
    const Judge judge(p, result.candidates, result.fit, scale);
    for (std::size_t e = 0; e < result.fit.hypothesis.effects.size(); ++e) {
      result.effects.push_back(judge_effect(judge, result, e));
    }
    return result;
  }
  static const Replacement* find(const FoundEffect& effect, const std::string& id) {
    const auto at = std::ranges::find_if(
        effect.replacements, [&](const Replacement& r) { return r.candidate.cause->id == id; });
    return at == effect.replacements.end() ? nullptr : &*at;
  }
  static std::string name(const SearchResult& result, std::size_t effect = 0) {
    return std::string(result.fit.hypothesis.effects.at(effect).cause->id);
  }
};

// Preference

class OneSlope : public Replacements {
 protected:
  /// Forward at one speed: all torques are in proportion to the load, whatever the coefficient of
  /// friction or the gain.
  OneSlope() {
    data_ = measured_grid({.sun_speeds_rpm = {600.0},
                           .directions = {design::Direction::kForward},
                           .rotations = {1},
                           .repeats = 8});
  }
  static constexpr double kNoise = 0.002;
};

TEST_F(OneSlope, OfAGainIsGivenToTheCoefficientOfFriction) {
  const Hypothesis gain = hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.05});
  measure(gain, kNoise);
  const Problem p = problem();
  SearchResult result = found(p, gain);
  const double slope = result.fit.simulated[0];
  const Judge judge(p, result.candidates, result.fit, result.scale);
  prefer_parameters(judge, result);
  EXPECT_EQ(name(result), "friction_level");
  // The same line through the same points: the same torque, by another name.
  EXPECT_NEAR(result.fit.simulated[0], slope, 1e-6 * slope);
  const Replacement* was = find(result.effects[0], "sensor_gain");
  ASSERT_NE(was, nullptr);
  EXPECT_NEAR(was->statistic, 0.0, 1e-6);
}

TEST_F(OneSlope, ThatIsLikelierTakesThePlaceOfTheName) {
  const Hypothesis gain = hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.05});
  measure(gain, kNoise);
  const Problem p = problem();
  // The same line by another name, as far ahead as is said here.
  const auto with_lead = [&](double statistic, const std::string& id, double value) {
    SearchResult result = found(p, gain);
    const Candidate other = candidate(
        id, id == "friction_level" ? Form{.name = "coefficient"} : Form{.name = "offset"});
    Fit fit_of_it = result.fit;
    fit_of_it.hypothesis = hypothesis({other}, {value});
    result.effects[0].replacements = {
        {.candidate = other, .statistic = statistic, .fit = std::move(fit_of_it)}};
    return result;
  };
  const SearchResult of_gain = found(p, gain);
  const Judge judge(p, of_gain.candidates, of_gain.fit, of_gain.scale);
  SearchResult ahead = with_lead(-2.3, "sensor_offset", 0.01);
  EXPECT_TRUE(take_likelier_name(judge, ahead));
  EXPECT_EQ(name(ahead), "sensor_offset");
  SearchResult as_good = with_lead(-2.1, "sensor_offset", 0.01);
  EXPECT_FALSE(take_likelier_name(judge, as_good));
  EXPECT_EQ(name(as_good), "sensor_gain");
  // Not by values that no gearbox shows.
  SearchResult implausible = with_lead(-5.0, "friction_level", -3.0);
  EXPECT_FALSE(take_likelier_name(judge, implausible));
  // Nor where a parameter more, ln 24 = 3.2, tells against it as much as it is said to be ahead.
  SearchResult costly = with_lead(-3.0, "sensor_offset", 0.01);
  costly.effects[0].replacements[0].fit.hypothesis =
      hypothesis({candidate("friction_level", {.name = "coefficient"}),
                  candidate("sensor_offset", {.name = "offset"})},
                 {0.0, 0.01});
  EXPECT_FALSE(take_likelier_name(judge, costly));
  // An effect more has to be ahead by as much as any beside another.
  SearchResult gain_and_zero = with_lead(-9.9, "sensor_offset", 0.01);
  Fit& both = gain_and_zero.effects[0].replacements[0].fit;
  both.hypothesis = costly.effects[0].replacements[0].fit.hypothesis;
  both.sum_of_squares = 0.0;
  ASSERT_FALSE(take_likelier_name(judge, gain_and_zero));
  gain_and_zero.effects[0].replacements[0].statistic = -10.1;
  EXPECT_TRUE(take_likelier_name(judge, gain_and_zero));
  // The coefficient of friction stays, whatever is a little ahead.
  SearchResult level = with_lead(-3.0, "sensor_offset", 0.01);
  level.fit.hypothesis = hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.1});
  EXPECT_FALSE(take_likelier_name(judge, level));
}

TEST_F(OneSlope, ThatNoGearboxShowsIsNotGivenToIt) {
  // Half as much again: friction would have to be several times the design's.
  const Hypothesis gain = hypothesis({candidate("sensor_gain", {.name = "gain"})}, {0.5});
  measure(gain, kNoise);
  const Problem p = problem();
  SearchResult result = found(p, gain);
  const Replacement* level = find(result.effects[0], "friction_level");
  ASSERT_NE(level, nullptr);
  EXPECT_LE(level->statistic, 4.0);
  EXPECT_GT(level->fit.hypothesis.value[0], 2.0);
  const Judge judge(p, result.candidates, result.fit, result.scale);
  prefer_parameters(judge, result);
  EXPECT_NE(name(result), "friction_level");
  EXPECT_NE(find(result.effects[0], "friction_level"), nullptr);
}

TEST_F(Replacements, OfAStepIsTheCoefficientOfFrictionWhereItDoesAsMuch) {
  // The first session almost without load: another coefficient of friction shows in the second.
  data_ = measured_grid({.sun_speeds_rpm = {600.0},
                         .output_torques_Nm = {0.02, 20.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 12});
  data_.runs = {"idle", "loaded"};
  for (Observation& row : data_.rows) row.condition.run = row.condition.output_torque_Nm > 1.0;
  measure(hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.3}), 0.004);
  const Problem p = problem();
  const Candidate step = candidate(
      "run_step", {.name = "from", .constants = {{.name = "first_run", .unit = "", .value = 1.0}}});
  SearchResult result = found(p, hypothesis({step}, {0.0}));
  const Judge judge(p, result.candidates, result.fit, result.scale);
  prefer_parameters(judge, result);
  EXPECT_EQ(name(result), "friction_level");
  EXPECT_NE(find(result.effects[0], "run_step"), nullptr);
}

TEST_F(Replacements, OfATrueCauseWithAParameterMoreIsThereInManyRows) {
  // Friction rises as the gearbox warms up, by a law of time or of temperature: no row tells which.
  data_ = measured_grid({.repeats = 23});
  ASSERT_GT(data_.rows.size(), 800U);
  const Eigen::VectorXd low = simulated(simulation_, data_, {}).value();
  const Eigen::VectorXd high =
      simulated(simulation_, data_,
                hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.2}))
          .value();
  const auto n = static_cast<double>(data_.rows.size());
  int listed = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    rig::DeterministicRandom random(seed);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      const double share = 1.0 - std::exp(-static_cast<double>(i) / (0.55 * n));
      Observation& row = data_.rows[i];
      row.condition.time_s = 5.0 * static_cast<double>(i);
      row.condition.temperature_K = 293.0 + 25.0 * share;
      const auto k = static_cast<Eigen::Index>(i);
      row.response = low[k] + share * (high[k] - low[k]) + random.between(-0.004, 0.004);
    }
    const Problem p = problem();
    const auto all = candidates_for(simulation_, data_);
    const auto by_temperature = std::ranges::find(all, "friction_temperature",
                                                  [](const Candidate& c) { return c.cause->id; });
    ASSERT_NE(by_temperature, all.end());
    const SearchResult result = found(p, hypothesis({*by_temperature}, {0.0}));
    const Judge judge(p, all, result.fit, result.scale);
    const FoundEffect effect = judge_effect(judge, result, 0);
    listed += find(effect, "drift") != nullptr ? 1 : 0;
  }
  EXPECT_EQ(listed, 4);
}

TEST_F(Replacements, WithAValueForEachSessionThatAllShareIsNoStep) {
  data_ = measured_grid({.repeats = 3});
  data_.runs = {"a", "b", "c"};
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.run = static_cast<int>(3 * i / data_.rows.size());
  }
  const Candidate offset = candidate("sensor_offset", {.name = "offset"});
  const Candidate sessions = candidate(
      "run_step",
      {.name = "sensor_sessions", .constants = {{.name = "sessions", .unit = "", .value = 3.0}}});
  // Values that differ by a tenth: they fit better than one value does.
  measure(hypothesis({sessions}, {0.011, 0.010, 0.009}), 0.001);
  const Problem one = problem();
  EXPECT_EQ(find(found(one, hypothesis({offset}, {0.01})).effects[0], "run_step"), nullptr);
  // Values of either sign are steps.
  measure(hypothesis({sessions}, {0.006, -0.005, 0.006}), 0.001);
  const Problem some = problem();
  EXPECT_NE(find(found(some, hypothesis({offset}, {0.002})).effects[0], "run_step"), nullptr);
}

TEST_F(Replacements, OfALawIsAStepWhereSessionsAreInItsOrder) {
  // The first session at 2, the second at 1000 rpm: a drag proportional to speed adds a constant
  // from the second session on, but for 0.2 %.
  data_ = measured_grid({.sun_speeds_rpm = {2.0, 1000.0},
                         .directions = {design::Direction::kForward},
                         .rotations = {1},
                         .repeats = 8});
  data_.runs = {"slow", "fast"};
  for (Observation& row : data_.rows)
    row.condition.run = row.condition.sun_speed_rad_s > 1.0 ? 1 : 0;
  const Hypothesis drag =
      hypothesis({candidate("drag_viscous", {.name = "sun", .body = "sun"})}, {2e-4});
  measure(drag, 0.004);
  const Problem p = problem();
  SearchResult result = found(p, drag);
  const Replacement* step = find(result.effects[0], "run_step");
  ASSERT_NE(step, nullptr);
  EXPECT_LT(std::abs(step->statistic), 0.5);
  const Judge judge(p, result.candidates, result.fit, result.scale);
  prefer_parameters(judge, result);
  EXPECT_EQ(name(result), "run_step");
  EXPECT_NE(find(result.effects[0], "drag_viscous"), nullptr);
}

TEST_F(Replacements, OfAConstantAreNoDriftThatIsOneBesideItsChange) {
  data_ = measured_grid({.sun_speeds_rpm = {600.0}, .rotations = {1}, .repeats = 2});
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.time_s = 60.0 * static_cast<double>(i);
  }
  const Hypothesis drag =
      hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.05});
  measure(drag, 0.004);
  const Problem p = problem();
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  const SearchResult result = found(p, drag);
  const Judge judge(p, all, result.fit, result.scale);
  // With a value at the start, levelling off explains a constant drag within what counts.
  const auto form = std::ranges::find_if(all, [](const Candidate& c) {
    return c.cause->id == "drift" && c.form.name == "levelling_any_scale_any_start_time_drag";
  });
  ASSERT_NE(form, all.end());
  const Fit started = fit(p, with({}, *form), result.scale);
  ASSERT_LE(judge.difference(started, result.fit), 6.0);
  EXPECT_EQ(find(judge_effect(judge, result, 0), "drift"), nullptr);
}

TEST_F(Replacements, OfAConstantAreNoDriftThatIsOverWhenTheRowsBegin) {
  data_ = measured_grid({.sun_speeds_rpm = {600.0}, .rotations = {1}, .repeats = 2});
  const auto rows = static_cast<double>(data_.rows.size());
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.time_s = 60.0 * static_cast<double>(i);
  }
  data_.record_start_s = -60.0 * rows;
  const Hypothesis drag =
      hypothesis({candidate("drag_constant", {.name = "sun", .body = "sun"})}, {0.05});
  measure(drag, 0.004);
  const Problem p = problem();
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  const SearchResult result = found(p, drag);
  const Judge judge(p, all, result.fit, result.scale);
  const auto form = std::ranges::find_if(all, [](const Candidate& c) {
    return c.cause->id == "drift" && c.form.name == "levelling_any_scale_time_drag";
  });
  ASSERT_NE(form, all.end());
  // It levels off before the first row, within what counts.
  const Fit levelled = fit(p, with({}, *form), result.scale);
  ASSERT_LE(judge.difference(levelled, result.fit), 6.0);
  EXPECT_EQ(find(judge_effect(judge, result, 0), "drift"), nullptr);
}

TEST_F(Replacements, StayAwayFromALawThatTheDataTellFromAStep) {
  // Every session at every speed.
  data_ = measured_grid({.rotations = {1}, .repeats = 4});
  data_.runs = {"a", "b"};
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.run = i < data_.rows.size() / 2 ? 0 : 1;
  }
  const Hypothesis drag =
      hypothesis({candidate("drag_viscous", {.name = "sun", .body = "sun"})}, {2e-4});
  measure(drag, 0.004);
  const Problem p = problem();
  SearchResult result = found(p, drag);
  const Judge judge(p, result.candidates, result.fit, result.scale);
  prefer_parameters(judge, result);
  EXPECT_EQ(name(result), "drag_viscous");
  EXPECT_EQ(find(result.effects[0], "run_step"), nullptr);
  EXPECT_EQ(find(result.effects[0], "friction_level"), nullptr);
}

// What an effect adds

class OfTheSensor : public Replacements {
 protected:
  /// Gain and offset by themselves and together, least squares by QR decompositions of the line
  /// y − T = g T + b s, with s the sign in which the sensor sees its offset.
  struct Squares {
    double both, without_gain, without_offset;
  };
  [[nodiscard]] Squares squares() const {
    const Eigen::VectorXd torque = simulated(simulation_, data_, {}).value();
    Eigen::MatrixXd line(torque.size(), 2);
    line.col(0) = torque;
    for (Eigen::Index i = 0; i < torque.size(); ++i) {
      const Condition& c = data_.rows[static_cast<std::size_t>(i)].condition;
      line(i, 1) = c.direction == design::Direction::kForward ? c.rotation : -c.rotation;
    }
    const Eigen::VectorXd y = measured(data_) - torque;
    const auto left = [&](const Eigen::MatrixXd& x) {
      return (y - x * numerics::least_squares(x, y)).squaredNorm();
    };
    return {
        .both = left(line), .without_gain = left(line.col(1)), .without_offset = left(line.col(0))};
  }
  [[nodiscard]] static Hypothesis sensor(double gain, double offset) {
    return hypothesis({candidate("sensor_gain", {.name = "gain"}),
                       candidate("sensor_offset", {.name = "offset"})},
                      {gain, offset});
  }
};

TEST_F(OfTheSensor, BicIsThatOfTheSquaresThatAreLeft) {
  // Deviations of up to 0.004 and effects of a quarter of it: no row is clipped either way.
  data_ = measured_grid({.repeats = 6});
  measure(sensor(0.005, 0.002), 0.004);
  const Problem p = problem();
  const SearchResult result = found(p, sensor(0.0, 0.0));
  const Squares s = squares();
  const auto n = static_cast<double>(data_.rows.size());
  // ΔBIC = n ln(S_without/S_with) − p ln n.
  const double gain = n * std::log(s.without_gain / s.both) - std::log(n);
  const double offset = n * std::log(s.without_offset / s.both) - std::log(n);
  ASSERT_GT(offset, 10.0);
  EXPECT_NEAR(result.effects[0].delta_bic, gain, 1e-6 * n);
  EXPECT_NEAR(result.effects[1].delta_bic, offset, 1e-6 * n);
}

TEST_F(OfTheSensor, PValuesAreThoseOfTheEvidenceThatTheThresholdIsOf) {
  data_ = measured_grid({.sun_speeds_rpm = {600.0, 900.0}});
  measure(sensor(0.005, 0.002), 0.004);
  const Problem p = problem();
  SearchResult result = found(p, sensor(0.0, 0.0));
  result.first_luck = {.threshold = 6.0, .rate = 0.04};
  const Judge judge(p, result.candidates, result.fit, result.scale);
  const Squares s = squares();
  const auto n = static_cast<double>(data_.rows.size());
  // X = −(ν − 1/2) ln(1 − R²), E = −ln P(χ²_1 ≥ X) + ln w, p = q e^(E_q − E).
  const boost::math::chi_squared law(1);
  const std::array<double, 2> without{s.without_gain, s.without_offset};
  for (std::size_t e = 0; e < 2; ++e) {
    const double statistic = (n - 2.0 - 0.5) * std::log(without.at(e) / s.both);
    const double weight = std::exp(log_weight_of(result.fit.hypothesis.effects[e]));
    const double expected =
        std::min(1.0, 0.04 * std::exp(6.0) * cdf(complement(law, statistic)) / weight);
    ASSERT_LT(expected, 1.0);
    EXPECT_NEAR(judge_effect(judge, result, e).p_value, expected, 1e-5 * expected) << e;
  }
}

TEST_F(OneSlope, OfOneSidedCausesPValuesAreHalf) {
  // Forward at one load a drag and an offset are the same line; a drag can only brake.
  const Candidate drag = candidate("drag_constant", {.name = "sun", .body = "sun", .weight = 1.0});
  const Candidate offset = candidate("sensor_offset", {.name = "offset", .weight = 1.0});
  measure(hypothesis({drag}, {0.003}), 0.004);
  const Problem p = problem();
  const auto p_value = [&](const Candidate& c) {
    SearchResult result = found(p, hypothesis({c}, {0.0}));
    result.first_luck = {.threshold = 6.0, .rate = 0.04};
    const Judge judge(p, result.candidates, result.fit, result.scale);
    return judge_effect(judge, result, 0).p_value * std::exp(log_weight_of(c));
  };
  EXPECT_NEAR(p_value(drag), 0.5 * p_value(offset), 1e-6 * p_value(offset));
}

TEST_F(OfTheSensor, BicOfFewRowsOfStatedScatterIsADifferenceOfChiSquares) {
  constexpr double kSigma = 0.003;
  data_ = measured_grid({.sun_speeds_rpm = {600.0}});
  ASSERT_LT(data_.rows.size(), 15U);
  measure(sensor(0.005, 0.002), 0.004);
  for (Observation& row : data_.rows) row.sigma = kSigma;
  const Problem p = problem();
  SearchResult result = found(p, sensor(0.0, 0.0));
  result.fit = fit(p, result.fit.hypothesis, 1.0);
  const Judge judge(p, result.candidates, result.fit, 1.0);
  const Squares s = squares();
  const double price = std::log(static_cast<double>(data_.rows.size()));
  EXPECT_NEAR(judge_effect(judge, result, 0).delta_bic,
              (s.without_gain - s.both) / (kSigma * kSigma) - price, 1e-6);
  EXPECT_NEAR(judge_effect(judge, result, 1).delta_bic,
              (s.without_offset - s.both) / (kSigma * kSigma) - price, 1e-6);
}

// Forms

TEST_F(Replacements, OfAPowerOfTheLoadHaveItsExponentWhateverTheReference) {
  // μ (F/F₀)^A = μ (F_m/F₀)^A (F/F_m)^A: at the middle of the loads, with a coefficient of its own.
  constexpr double kExponent = -0.3;
  data_ = measured_grid({.output_torques_Nm = {5.0, 10.0, 20.0, 35.0, 50.0}, .rotations = {1}});
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  const auto form = [&](const std::string& name) {
    return *std::ranges::find_if(all, [&](const Candidate& c) {
      return c.cause->id == "friction_load" && c.form.name == name;
    });
  };
  Candidate hidden = form("about_middle");
  // A reference that is none of those tried.
  hidden.form.constants.front().value *= 1.35;
  measure(hypothesis({hidden}, {kExponent}), 1e-4);
  const Problem p = problem();
  SearchResult result = found(p, hypothesis({form("about_middle")}, {0.0}));
  const double searched = result.effects[0].delta_bic;
  result.fit = with_free_shapes(p, all, result.fit, result.scale);
  const Judge judge(p, all, result.fit, result.scale);
  take_better_names(judge, all, result);
  ASSERT_EQ(result.fit.hypothesis.value.size(), 2U);
  // The evidence is that of the form with the level as a parameter of its own.
  const auto n = static_cast<double>(data_.rows.size());
  const double without = fit(p, {}, result.scale).sum_of_squares;
  EXPECT_NEAR(result.effects[0].delta_bic,
              n * std::log(without / result.fit.sum_of_squares) - 2.0 * std::log(n), 1e-6);
  EXPECT_GT(std::abs(result.effects[0].delta_bic - searched), 1.0);
  EXPECT_NEAR(result.fit.hypothesis.value[0], kExponent, 0.01);
  EXPECT_NEAR(result.fit.hypothesis.value[1], std::pow(1.0 / 1.35, kExponent) - 1.0, 0.01);
}

TEST_F(Replacements, OfEitherDirectionAreTheFlanksWhereOneGearboxCannotTell) {
  data_ = measured_grid({.repeats = 3});
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  const Hypothesis hidden =
      hypothesis({candidate("friction_direction", {.name = "approach_recess"})}, {0.2});
  measure(hidden, 4e-4);
  const Problem p = problem();
  SearchResult result =
      found(p, hypothesis({candidate("friction_direction", {.name = "forward_backward"})}, {0.0}));
  const Judge judge(p, result.candidates, result.fit, result.scale);
  const double before = judge.chi(result.fit);
  take_unsearched_forms(judge, all, result);
  EXPECT_EQ(result.fit.hypothesis.effects[0].form.name, "approach_recess");
  EXPECT_LE(judge.chi(result.fit), before + 2.0);
  EXPECT_NEAR(result.fit.hypothesis.value[0], 0.2, 0.05);
}

TEST_F(Replacements, OfAWaveWithAHarmonicAreTheBodiesThatHaveItsOrderOnTheGrid) {
  data_ = measured_grid({.sun_speeds_rpm = {600.0}, .rotations = {1}, .repeats = 8});
  const auto set_angles = [&](double step_rad) {
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].condition.output_angle_rad = static_cast<double>(7 * i % 41) * step_rad;
    }
  };
  const auto wave = [&](const char* body) {
    for (const Candidate& c : candidates_for(simulation_, data_)) {
      if (c.cause->id == "runout" && c.form.name == "proportional_with_second" &&
          c.form.body == body) {
        return c;
      }
    }
    throw std::invalid_argument("no such body");
  };
  set_angles(1.0);
  // The sun goes backward by as much as the planet forward, from each angle to the next.
  const double sum = wave("sun").form.order + wave("planet").form.order;
  set_angles(2.0 * std::numbers::pi / sum);
  const Hypothesis truth = hypothesis({wave("planet")}, {0.02, 0.01, -0.01, 0.005});
  measure(truth, 0.001);
  const Problem p = problem();
  SearchResult result;
  result.fit = fit(p, fitted(p, truth), 0.001);
  result.scale = 0.001;
  result.effects.resize(1);
  const std::vector<Candidate> all = candidates_for(simulation_, data_);
  const Judge judge(p, all, result.fit, result.scale);
  take_better_names(judge, all, result);
  EXPECT_EQ(result.fit.hypothesis.effects.at(0).form.body, "planet");
  const auto& others = result.effects.at(0).other_bodies;
  EXPECT_TRUE(std::ranges::any_of(
      others, [](const Replacement& r) { return r.candidate.form.body == "sun"; }));
  EXPECT_TRUE(std::ranges::none_of(
      others, [](const Replacement& r) { return r.candidate.form.body == "output"; }));
}

}  // namespace
}  // namespace gear3k::calibrate::replacements_test
