#include "calibrate/fit/holdout.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "numerics/linear_algebra.hpp"
#include "tests/calibrate/bench.hpp"

namespace gear3k::calibrate::holdout_test {
namespace {

MeasurementSet without_block(const MeasurementSet& data, const Blocks& blocks, int block) {
  MeasurementSet rest = data;
  rest.rows.clear();
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (blocks.of[i] != block) rest.rows.push_back(data.rows[i]);
  }
  return rest;
}

/// Each row by the least squares line of the rows outside its block.
Eigen::VectorXd line_without_its_block(const Eigen::MatrixXd& line, const Eigen::VectorXd& response,
                                       const Blocks& blocks) {
  Eigen::VectorXd predicted(response.size());
  for (int block = 0; block < blocks.count; ++block) {
    Eigen::MatrixXd x = line;
    Eigen::VectorXd y = response;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (blocks.of[static_cast<std::size_t>(i)] != block) continue;
      x.row(i).setZero();
      y[i] = 0.0;
    }
    const Eigen::VectorXd refit = line * numerics::least_squares(x, y);
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (blocks.of[static_cast<std::size_t>(i)] == block) predicted[i] = refit[i];
    }
  }
  return predicted;
}

class HeldOut : public Bench {
 protected:
  HeldOut() { data_ = campaign(Kind::kTransmission); }

  /// What the sensor shows is a line in the true torque: y = (1 + g) T + b s. [T, s]
  [[nodiscard]] Eigen::MatrixXd sensor_line() const {
    Eigen::MatrixXd line(static_cast<Eigen::Index>(data_.rows.size()), 2);
    line.col(0) = simulated(simulation_, data_, {}).value();
    for (Eigen::Index i = 0; i < line.rows(); ++i) {
      const Condition& c = data_.rows[static_cast<std::size_t>(i)].condition;
      line(i, 1) = c.direction == design::Direction::kForward ? c.rotation : -c.rotation;
    }
    return line;
  }
  [[nodiscard]] bool no_worse(const Hypothesis& h, const Hypothesis& other, const Blocks& blocks,
                              double scale) const {
    return predicts_no_worse(problem(), predict_held_out(problem(), h, blocks),
                             predict_held_out(problem(), other, blocks), scale);
  }
  [[nodiscard]] Blocks by(const std::string& name) const {
    for (const Levels& levels : covariate_levels(data_)) {
      if (levels.name == name) return {.name = name, .of = levels.of, .count = levels.count};
    }
    return {};
  }
  /// A step that only the last session shows.
  [[nodiscard]] Hypothesis step_in_last_session() const {
    return hypothesis(
        {candidate("run_step",
                   {.name = "from",
                    .constants = {{.name = "first_run",
                                   .unit = "",
                                   .value = static_cast<double>(data_.runs.size() - 1)}}})},
        {0.01});
  }
};

TEST_F(HeldOut, OfTheSensorAreRefitsWithoutTheBlock) {
  const Hypothesis sensor = hypothesis(
      {candidate("sensor_gain", {.name = "gain"}), candidate("sensor_offset", {.name = "offset"})},
      {0.04, 0.003});
  measure_evenly(sensor, 0.004, 3);
  const Eigen::MatrixXd line = sensor_line();
  for (const char* name : {"load", "speed", "run", "direction"}) {
    const Blocks blocks = by(name);
    ASSERT_GE(blocks.count, 2) << name;
    const Eigen::VectorXd refit = line_without_its_block(line, measured(data_), blocks);
    // From any values of the parameters, as nothing depends on them but the residual.
    Hypothesis from = sensor;
    for (const double gain : {0.04, 0.02}) {
      from.value[0] = gain;
      const Eigen::VectorXd predicted = predict_held_out(problem(), from, blocks);
      for (Eigen::Index i = 0; i < refit.size(); ++i) {
        EXPECT_NEAR(predicted[i], refit[i], 1e-9 * line.col(0).maxCoeff()) << name << ' ' << i;
      }
    }
  }
}

TEST_F(HeldOut, OfRowsThatShareNoiseAreRefitsThatHaveNotSeenTheBlock) {
  // Sessions that scatter, and readings that remember: generalised squares of the rows outside.
  const Hypothesis sensor = hypothesis(
      {candidate("sensor_gain", {.name = "gain"}), candidate("sensor_offset", {.name = "offset"})},
      {0.04, 0.003});
  measure_evenly(sensor, 0.004, 3);
  const Eigen::MatrixXd line = sensor_line();
  const Eigen::VectorXd y = measured(data_) - line.col(0);
  Problem p = problem();
  p.noise.session_variance = 0.7;
  p.noise.order = {};
  for (int i = 0; i < static_cast<int>(data_.rows.size()); ++i) {
    const bool first = i == 0 || p.noise.run[static_cast<std::size_t>(i)] !=
                                     p.noise.run[static_cast<std::size_t>(i) - 1];
    p.noise.order.row.push_back(i);
    p.noise.order.step.push_back(first ? 0 : 1);
  }
  for (const double share : {0.0, 0.6}) {
    constexpr double kDecay = 0.8;
    p.noise.memory = {.share = share, .decay = kDecay};
    const Blocks blocks = by("load");
    const Eigen::VectorXd predicted = predict_held_out(p, sensor, blocks);
    for (int block = 0; block < blocks.count; ++block) {
      std::vector<Eigen::Index> in;
      for (Eigen::Index i = 0; i < y.size(); ++i) {
        if (blocks.of[static_cast<std::size_t>(i)] != block) in.push_back(i);
      }
      const auto n = static_cast<Eigen::Index>(in.size());
      Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index k = 0; k < n; ++k) {
          const auto a = static_cast<std::size_t>(in[static_cast<std::size_t>(i)]);
          const auto b = static_cast<std::size_t>(in[static_cast<std::size_t>(k)]);
          if (p.noise.run[a] != p.noise.run[b]) continue;
          if (i != k) {
            const double apart = std::abs(static_cast<double>(a) - static_cast<double>(b));
            covariance(i, k) = share * std::pow(kDecay, apart);
          }
        }
      }
      // A unit more in a session is less in rows that remember: of their whitened ones.
      const Eigen::LLT<Eigen::MatrixXd> root(covariance);
      Eigen::MatrixXd x = root.matrixL().solve(line(in, Eigen::all));
      Eigen::VectorXd r = root.matrixL().solve(y(in));
      const Eigen::VectorXd one = root.matrixL().solve(Eigen::VectorXd::Ones(n));
      Eigen::MatrixXd shared = Eigen::MatrixXd::Identity(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index k = 0; k < n; ++k) {
          const auto a = static_cast<std::size_t>(in[static_cast<std::size_t>(i)]);
          const auto b = static_cast<std::size_t>(in[static_cast<std::size_t>(k)]);
          if (p.noise.run[a] == p.noise.run[b]) shared(i, k) += 0.7 * one[i] * one[k];
        }
      }
      const Eigen::LLT<Eigen::MatrixXd> of_sessions(shared);
      x = of_sessions.matrixL().solve(x);
      r = of_sessions.matrixL().solve(r);
      const Eigen::VectorXd refit = numerics::least_squares(x, r);
      for (Eigen::Index i = 0; i < y.size(); ++i) {
        if (blocks.of[static_cast<std::size_t>(i)] != block) continue;
        EXPECT_NEAR(predicted[i], line(i, 0) + line.row(i).dot(refit), 1e-9 * line.maxCoeff());
      }
    }
  }
}

TEST_F(HeldOut, WhatTheLastSessionAloneShowsIsUnknownWithoutItUnlessItIsAStep) {
  // The last session alone is warm: what warmth does is not known without it.
  const auto last_run = static_cast<int>(data_.runs.size()) - 1;
  for (Observation& row : data_.rows) {
    row.condition.temperature_K = row.condition.run == last_run ? 313.15 : 293.15;
  }
  const auto step_from = [&](int run) {
    return candidate(
        "run_step",
        {.name = "from",
         .constants = {{.name = "first_run", .unit = "", .value = static_cast<double>(run)}}});
  };
  const auto all = candidates_for(simulation_, data_);
  const auto warmth = std::ranges::find_if(all, [](const Candidate& c) {
    return c.cause->id == "friction_temperature" && c.form.name == "from_coldest";
  });
  ASSERT_NE(warmth, all.end());
  for (const bool with_warmth : {true, false}) {
    Hypothesis h = hypothesis({step_from(with_warmth ? 1 : last_run)}, {0.01});
    if (with_warmth) {
      h.effects.push_back(*warmth);
      h.value.push_back(-0.01);
    }
    measure_evenly(h, 1e-4, 3);
    const Eigen::VectorXd plain = simulated(simulation_, data_, {}).value();
    const Eigen::VectorXd predicted = predict_left_out(problem(), h, by("run"));
    for (Eigen::Index i = 0; i < predicted.size(); ++i) {
      if (data_.rows[static_cast<std::size_t>(i)].condition.run != last_run) continue;
      if (with_warmth) {
        EXPECT_TRUE(std::isnan(predicted[i])) << i;
      } else {
        EXPECT_NEAR(predicted[i], plain[i], 1e-9) << i;
      }
    }
  }
}

TEST_F(HeldOut, TheLastSessionOfADriftIsAsTheRowsBeforeItLeftIt) {
  const auto last_run = static_cast<int>(data_.runs.size()) - 1;
  double end = 0.0;
  double before = 0.0;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    Condition& c = data_.rows[i].condition;
    c.time_s = 10.0 * static_cast<double>(i);
    end = std::max(end, c.time_s);
    if (c.run != last_run) before = std::max(before, c.time_s);
  }
  ASSERT_LT(before, end);
  constexpr double kMost_Nm = 0.03;
  const Hypothesis drift = hypothesis(
      {candidate("drift", {.name = "linear_time",
                           .constants = {{.name = "start", .unit = "s", .value = 0.0},
                                         {.name = "span", .unit = "s", .value = end},
                                         {.name = "time_constant", .unit = "s", .value = end}}})},
      {kMost_Nm});
  const Eigen::VectorXd torque = simulated(simulation_, data_, {}).value();
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].response =
        torque[static_cast<Eigen::Index>(i)] + kMost_Nm * data_.rows[i].condition.time_s / end;
  }
  const Eigen::VectorXd predicted = predict_left_out(problem(), drift, by("run"));
  for (Eigen::Index i = 0; i < predicted.size(); ++i) {
    const Condition& c = data_.rows[static_cast<std::size_t>(i)].condition;
    const double t = c.run == last_run ? before : c.time_s;
    EXPECT_NEAR(predicted[i], torque[i] + kMost_Nm * t / end, 1e-9) << i;
  }
}

TEST_F(HeldOut, DecideWhetherAnEffectOnlyFitsOrAlsoPredicts) {
  const Hypothesis offset = hypothesis({candidate("sensor_offset", {.name = "offset"})}, {0.0});
  const Eigen::MatrixXd line = sensor_line();
  const Blocks blocks = by("load");
  constexpr double kMost = 0.004;
  int fits_only = 0;
  int predicts = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    measure_evenly({}, kMost, seed);
    const Eigen::VectorXd shift = measured(data_) - line.col(0);
    const Eigen::VectorXd refit = line_without_its_block(line.col(1), shift, blocks);
    const bool expected = (shift - refit).squaredNorm() <= shift.squaredNorm();
    EXPECT_EQ(no_worse(offset, {}, blocks, kMost), expected) << seed;
    ++(expected ? predicts : fits_only);
  }
  // The fit to the rows themselves is better every time.
  EXPECT_GT(fits_only, 10);
  EXPECT_GT(predicts, 2);
  Hypothesis truth = offset;
  truth.value = {0.01};
  measure_evenly(truth, kMost, 3);
  EXPECT_TRUE(no_worse(offset, {}, blocks, kMost));
  EXPECT_FALSE(no_worse({}, offset, blocks, kMost));
}

TEST_F(HeldOut, DoNotSpeakAgainstWhatTheyCannotPredict) {
  const Hypothesis step = step_in_last_session();
  measure_evenly(step, 0.004, 3);
  // Without the last session nobody knows its step; the others do not depend on it.
  EXPECT_TRUE(no_worse(step, {}, by("run"), 0.004));
  EXPECT_TRUE(no_worse({}, step, by("run"), 0.004));
}

TEST_F(HeldOut, OutliersCountByTheirDistanceNotItsSquare) {
  measure_evenly({}, 0.004, 3);
  const Eigen::VectorXd y = measured(data_);
  Eigen::VectorXd one_far = y;
  one_far[0] += 100.0;
  Eigen::VectorXd all_off = y;
  // 2·3·100 − 9 = 591 deviations² in one row, or as many in all rows together.
  const auto rows = static_cast<double>(y.size());
  ASSERT_LT(591.0 / rows, 9.0);
  all_off.array() += std::sqrt(591.5 / rows);
  EXPECT_TRUE(predicts_no_worse(problem(), one_far, all_off, 1.0));
  all_off = y.array() + std::sqrt(590.5 / rows);
  EXPECT_FALSE(predicts_no_worse(problem(), one_far, all_off, 1.0));
}

TEST_F(HeldOut, OfFrictionAreCloseToRefitsWithoutTheBlock) {
  const Hypothesis start = hypothesis({candidate("friction_level", {.name = "coefficient"}),
                                       candidate("drag_constant", {.name = "sun", .body = "sun"})},
                                      {0.0, 0.0});
  Hypothesis truth = start;
  truth.value = {0.3, 0.02};
  constexpr double kNoise = 0.004;
  measure_evenly(truth, kNoise, 3);
  Hypothesis full = start;
  for (const double scale : {0.05, kNoise, 1e-2 * kNoise}) {
    full = fit(problem(), full, std::max(scale, kNoise)).hypothesis;
  }
  const Eigen::VectorXd fitted = simulated(simulation_, data_, full).value();
  for (const char* name : {"load", "speed"}) {
    const Blocks blocks = by(name);
    const Eigen::VectorXd predicted = predict_held_out(problem(), full, blocks);
    for (int block = 0; block < blocks.count; ++block) {
      const MeasurementSet rest = without_block(data_, blocks, block);
      const Problem left{.simulation = simulation_, .data = rest, .noise = make_noise_model(rest)};
      const FinalFit refit = final_fit(left, full, kNoise);
      const Eigen::VectorXd expected = simulated(simulation_, data_, refit.hypothesis).value();
      double moved = 0.0;
      double missed = 0.0;
      for (std::size_t i = 0; i < data_.rows.size(); ++i) {
        if (blocks.of[i] != block) continue;
        const auto k = static_cast<Eigen::Index>(i);
        moved = std::max(moved, std::abs(expected[k] - fitted[k]));
        missed = std::max(missed, std::abs(expected[k] - predicted[k]));
      }
      // The parameters move by their standard deviation: the curvature of the response over that
      // distance is a few percent of the step.
      EXPECT_GT(moved, 0.0);
      EXPECT_LT(missed, 0.05 * moved) << name << ' ' << block;
    }
  }
}

TEST_F(HeldOut, WithoutParametersAreTheSimulation) {
  const Blocks blocks = by("load");
  const Eigen::VectorXd y = simulated(simulation_, data_, {}).value();
  EXPECT_EQ(predict_held_out(problem(), {}, blocks), y);
}

TEST_F(HeldOut, AreUnknownWhereTheRestDoesNotDetermineTheParameters) {
  // A step that only the last session shows.
  const Hypothesis step = step_in_last_session();
  measure_evenly(step, 0.004, 3);
  const Blocks blocks = by("run");
  ASSERT_EQ(blocks.count, static_cast<int>(data_.runs.size()));
  const Eigen::VectorXd predicted = predict_held_out(problem(), step, blocks);
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const bool determined = data_.rows[i].condition.run != static_cast<int>(data_.runs.size()) - 1;
    EXPECT_EQ(std::isfinite(predicted[static_cast<Eigen::Index>(i)]), determined) << i;
  }
}

TEST_F(HeldOut, WithTooLittleInformationLeftAreUnknown) {
  // Of one offset every row tells as much: without a block the share of the other rows is left.
  const Hypothesis offset = hypothesis({candidate("sensor_offset", {.name = "offset"})}, {0.003});
  measure_evenly(offset, 0.004, 3);
  const Blocks blocks = by("load");
  ASSERT_GE(blocks.count, 3);
  const auto n = static_cast<double>(blocks.of.size());
  const auto own = static_cast<double>(std::ranges::count(blocks.of, blocks.of[0]));
  const Eigen::VectorXd plain = predict_held_out(problem(), offset, blocks);
  const Eigen::VectorXd kept = predict_held_out(
      problem(), offset, blocks, {.together = {true}, .least = 0.99 * (1.0 - own / n)});
  const Eigen::VectorXd gone = predict_held_out(
      problem(), offset, blocks, {.together = {true}, .least = 1.01 * (1.0 - own / n)});
  EXPECT_EQ(kept[0], plain[0]);
  EXPECT_TRUE(std::isnan(gone[0]));
}

TEST_F(HeldOut, AskForTheInformationOfThoseParametersAlone) {
  // An offset that all rows show, a step that those of the last session do; all of these but one
  // are a block.
  const Hypothesis both = hypothesis(
      {candidate("sensor_offset", {.name = "offset"}), step_in_last_session().effects.front()},
      {0.003, 0.01});
  measure_evenly(both, 0.004, 3);
  const int last = static_cast<int>(data_.runs.size()) - 1;
  Blocks blocks{.name = "own", .of = {}, .count = 3};
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(data_.rows.size()), 2);
  columns.col(0) = sensor_line().col(1);
  bool spared = false;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const bool steps = data_.rows[i].condition.run == last;
    columns(static_cast<Eigen::Index>(i), 1) = steps ? 1.0 : 0.0;
    blocks.of.push_back(steps && spared ? 0 : 1 + static_cast<int>(i % 2));
    spared = spared || steps;
  }
  // Of one parameter: the variance with all rows over that without the block.
  const auto variance = [&](const Eigen::MatrixXd& j, Eigen::Index k) {
    const Eigen::Matrix2d n = j.transpose() * j;
    return n(1 - k, 1 - k) / (n(0, 0) * n(1, 1) - n(0, 1) * n(1, 0));
  };
  Eigen::MatrixXd rest = columns;
  for (std::size_t i = 0; i < blocks.of.size(); ++i) {
    if (blocks.of[i] == 0) rest.row(static_cast<Eigen::Index>(i)).setZero();
  }
  const auto first = static_cast<Eigen::Index>(std::ranges::find(blocks.of, 0) - blocks.of.begin());
  const auto predicts = [&](const Shown& shown) {
    return std::isfinite(predict_held_out(problem(), both, blocks, shown)[first]);
  };
  ASSERT_TRUE(predicts({}));
  std::array<double, 2> left{};
  for (const Eigen::Index k : {0, 1}) {
    left[static_cast<std::size_t>(k)] = variance(columns, k) / variance(rest, k);
    const std::vector<bool> of{k == 0, k == 1};
    const double share = left[static_cast<std::size_t>(k)];
    EXPECT_TRUE(predicts({.together = of, .least = 0.99 * share})) << k;
    EXPECT_FALSE(predicts({.together = of, .least = 1.01 * share})) << k;
  }
  // The step's loss says nothing of the offset.
  EXPECT_GT(left[0], 0.5);
  EXPECT_LT(left[1], 0.1);
  // Of both: the root of the determinants' ratio.
  const double share = std::sqrt((rest.transpose() * rest).determinant() /
                                 (columns.transpose() * columns).determinant());
  EXPECT_TRUE(predicts({.together = {true, true}, .least = 0.99 * share}));
  EXPECT_FALSE(predicts({.together = {true, true}, .least = 1.01 * share}));
  // One by one: of those asked for the one that the block takes most from.
  EXPECT_TRUE(predicts({.each = {true, true}, .least = 0.99 * left[1]}));
  EXPECT_FALSE(predicts({.each = {true, true}, .least = 1.01 * left[1]}));
  EXPECT_TRUE(predicts({.each = {true, false}, .least = 0.99 * left[0]}));
  EXPECT_FALSE(predicts({.each = {true, false}, .least = 1.01 * left[0]}));
}

// Which blocks

Blocks blocks_of_set(const MeasurementSet& data) {
  return holdout_blocks(data, covariate_levels(data));
}

/// Rows of one block share a value; rows of different blocks do not.
template <class Value>
void expect_blocks_by(const MeasurementSet& data, const std::string& name, int count, Value value) {
  const Blocks blocks = blocks_of_set(data);
  EXPECT_EQ(blocks.name, name);
  EXPECT_EQ(blocks.count, count);
  ASSERT_EQ(blocks.of.size(), data.rows.size());
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const bool same = value(data.rows[i].condition) == value(data.rows[k].condition);
      ASSERT_EQ(blocks.of[i] == blocks.of[k], same) << i << ' ' << k;
    }
  }
}

TEST(HoldoutBlocks, OfPairsAreWholePinions) {
  expect_blocks_by(campaign(Kind::kPairLoss), "pinion", 5,
                   [](const Condition& c) { return std::min(c.driving_teeth, c.driven_teeth); });
}

TEST(HoldoutBlocks, OfTransmissionsAreLoadsThenSpeedsThenSessions) {
  MeasurementSet data = campaign(Kind::kTransmission);
  expect_blocks_by(data, "load", 4, [](const Condition& c) { return c.output_torque_Nm; });
  for (Observation& row : data.rows) row.condition.output_torque_Nm = 20.0;
  expect_blocks_by(data, "speed", 5, [](const Condition& c) { return c.sun_speed_rad_s; });
  for (Observation& row : data.rows) row.condition.sun_speed_rad_s = 60.0;
  expect_blocks_by(data, "run", 4, [](const Condition& c) { return c.run; });
}

TEST(HoldoutBlocks, AreNotTheLoadsWhereALawHasAsManyParameters) {
  // Four loads: without one of them a law of three parameters goes through all that is left.
  const MeasurementSet data = campaign(Kind::kTransmission);
  const std::vector<Levels> levels = covariate_levels(data);
  const auto by = [&](const std::string& cause, std::size_t parameters) {
    const Hypothesis law{
        .effects = {{.cause = find_cause(cause),
                     .form = {},
                     .parameters = std::vector<ParameterRecord>(parameters, ParameterRecord{})}},
        .value = std::vector<double>(parameters, 0.0)};
    return holdout_blocks(data, levels, law).name;
  };
  EXPECT_EQ(by("friction_load", 2), "load");
  EXPECT_EQ(by("friction_load", 3), "speed");
  EXPECT_EQ(by("friction_speed", 3), "load");
}

TEST(HoldoutBlocks, AreNoneWhereALawGoesThroughAllThatHasLevels) {
  MeasurementSet data = campaign(Kind::kTransmission);
  for (Observation& row : data.rows) {
    row.condition.sun_speed_rad_s = 60.0;
    row.condition.run = 0;
  }
  const auto of = [&](const char* cause) {
    const Hypothesis law{.effects = {{.cause = find_cause(cause),
                                      .form = {},
                                      .parameters = std::vector<ParameterRecord>(4)}},
                         .value = std::vector<double>(4, 0.0)};
    return holdout_blocks(data, covariate_levels(data), law);
  };
  EXPECT_EQ(of("friction_speed").name, "load");
  const Blocks none = of("friction_load");
  EXPECT_EQ(none.name, "");
  EXPECT_EQ(none.count, 1);
  EXPECT_EQ(none.of, std::vector<int>(data.rows.size(), 0));
  // Without any levels there is nothing between them.
  for (Observation& row : data.rows) row.condition.output_torque_Nm = 20.0;
  EXPECT_EQ(of("friction_load").count, 10);
}

TEST(HoldoutBlocks, OfLostMotionAreTestTorques) {
  expect_blocks_by(campaign(Kind::kLostMotion), "test torque",
                   static_cast<int>(rig::lost_motion_plan().torques_Nm.size()),
                   [](const Condition& c) { return c.test_torque_Nm; });
}

TEST(HoldoutBlocks, WithoutLevelsAreSectorsOfTheAngle) {
  MeasurementSet data;
  data.kind = Kind::kLostMotion;
  for (int k = 0; k < 100; ++k) {
    Observation row;
    row.condition.test_torque_Nm = 2.0;
    row.condition.output_angle_rad = 1.7 * k - 60.0;
    data.rows.push_back(row);
  }
  expect_blocks_by(data, "angle", 10, [](const Condition& c) {
    double degrees = std::fmod(c.output_angle_rad * 180.0 / std::numbers::pi, 360.0);
    if (degrees < 0.0) degrees += 360.0;
    return static_cast<int>(degrees / 36.0);
  });
}

TEST(HoldoutBlocks, WithoutAnythingAreTenthsOfTheRows) {
  MeasurementSet data;
  data.kind = Kind::kLostMotion;
  data.rows.resize(40);
  const Blocks blocks = blocks_of_set(data);
  EXPECT_EQ(blocks.name, "rows");
  EXPECT_EQ(blocks.count, 10);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(blocks.of[i], static_cast<int>(i / 4));
  data.rows.resize(7);
  EXPECT_EQ(blocks_of_set(data).count, 7);
}

TEST(HoldoutBlocks, OfTwoPinionsAreNot) {
  MeasurementSet data;
  data.kind = Kind::kPairLoss;
  for (int k = 0; k < 20; ++k) {
    Observation row;
    row.condition.driving_teeth = k % 2 == 0 ? 20 : 30;
    row.condition.driven_teeth = 40;
    data.rows.push_back(row);
  }
  const Blocks blocks = blocks_of_set(data);
  EXPECT_EQ(blocks.name, "rows");
  EXPECT_EQ(blocks.of.size(), data.rows.size());
}

/// Rows of five loads, each at two speeds, in blocks by load.
struct FiveLoads {
  std::vector<Levels> levels = std::vector<Levels>(2);
  Blocks blocks{.name = "load", .of = {}, .count = 5};
  FiveLoads() {
    levels[0].name = "load";
    levels[1].name = "speed";
    for (int load = 0; load < 5; ++load) {
      for (int speed = 0; speed < 2; ++speed) {
        levels[0].of.push_back(load);
        levels[1].of.push_back(speed);
        blocks.of.push_back(load);
      }
    }
    levels[0].count = 5;
    levels[1].count = 2;
  }
  [[nodiscard]] std::vector<bool> known_beside(const Hypothesis& h, const Blocks& by) const {
    Eigen::VectorXd predicted = Eigen::VectorXd::Zero(10);
    forget_beyond(h, by, levels, predicted);
    std::vector<bool> known;
    for (const double x : predicted) known.push_back(std::isfinite(x));
    return known;
  }
};

/// One law of a form that is searched for (weight 1) or freed (0).
Hypothesis law_of_one(const char* cause, double weight) {
  Hypothesis h;
  h.effects.push_back(
      {.cause = find_cause(cause), .form = {.name = "any_smooth"}, .parameters = {}});
  h.effects.back().form.weight = weight;
  return h;
}

TEST(ForgetBeyond, TakesTheEndsOfWhatALawOfFreeShapeIsALawOf) {
  const FiveLoads rows;
  const Hypothesis by_load = law_of_one("friction_load", 0.0);
  const std::vector<bool> inner{false, false, true, true, true, true, true, true, false, false};
  EXPECT_EQ(rows.known_beside(by_load, rows.blocks), inner);
  const std::vector<bool> all(10, true);
  // Blocks that hold some of an end each leave the others the rest of it.
  Blocks halves = rows.blocks;
  for (std::size_t i = 0; i < halves.of.size(); ++i) halves.of[i] = static_cast<int>(i % 2);
  EXPECT_EQ(rows.known_beside(by_load, halves), all);
  // A law of searched shape says what comes beyond; one of another condition goes on.
  EXPECT_EQ(rows.known_beside(law_of_one("friction_load", 1.0), rows.blocks), all);
  EXPECT_EQ(rows.known_beside(law_of_one("friction_speed", 0.0), rows.blocks), all);
}

TEST(KnownRows, AreHalfOfAllAtLeast) {
  Eigen::VectorXd predicted = Eigen::VectorXd::Zero(4);
  predicted[1] = predicted[2] = kUnknown;
  EXPECT_EQ(known_rows(predicted), (std::vector<Eigen::Index>{0, 3}));
  predicted[0] = kUnknown;
  EXPECT_TRUE(known_rows(predicted).empty());
}

TEST_F(HeldOut, AFitWithoutABlockKeepsToTheBoundsOfItsParameters) {
  // The sensor reads 30 % too little, where the fit allows 20: so do the rows without any block.
  Candidate gain = candidate("sensor_gain", {.name = "gain"});
  const Hypothesis free = hypothesis({gain}, {-0.3});
  measure_evenly(free, 1e-6, 3);
  const Blocks blocks = by("load");
  gain.parameters[0].lower = -0.2;
  const Eigen::VectorXd predicted = predict_held_out(problem(), hypothesis({gain}, {-0.2}), blocks);
  const Eigen::VectorXd at_bound = linearise(problem(), hypothesis({gain}, {-0.2}), {}).simulated;
  EXPECT_LT((predicted - at_bound).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace gear3k::calibrate::holdout_test
