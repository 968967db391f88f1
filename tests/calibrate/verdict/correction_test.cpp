#include "calibrate/verdict/correction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calibrate/search/search.hpp"
#include "tests/calibrate/bench.hpp"
#include "tests/calibrate/measured_grid.hpp"

namespace gear3k::calibrate::correction_test {
namespace {

class CorrectionOf : public Bench {
 protected:
  CorrectionOf() { data_ = measured_grid({.rotations = {1}}); }

  [[nodiscard]] std::optional<FoundCorrection> find(double scale) const {
    const Problem p = problem();
    return find_correction(p, candidates_for(simulation_, data_),
                           holdout_blocks(data_, covariate_levels(data_)), scale);
  }
  /// Root mean square of predicted − response without noise.
  [[nodiscard]] double error(const Eigen::VectorXd& predicted) const {
    return std::sqrt((predicted - clean_).squaredNorm() / static_cast<double>(clean_.size()));
  }
};

TEST_F(CorrectionOf, ACauseOfTheLibraryPredictsItsOwnData) {
  const double noise = 1e-3;
  measure(hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.3}), noise, 3);
  const auto found = find(noise);
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->fit.hypothesis.effects.size(), 1U);
  EXPECT_LT(error(found->predicted), noise);
}

TEST_F(CorrectionOf, StructureThatIsNoCauseIsPredictedBetterThanByTheSimulation) {
  const double noise = 1e-3;
  measure({}, noise, 4);
  const Eigen::VectorXd as_given = clean_;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const Condition& c = data_.rows[i].condition;
    const double more =
        0.02 * c.output_torque_Nm / 50.0 * (1.0 + std::sin(0.1 * c.sun_speed_rad_s));
    data_.rows[i].response += more;
    clean_[static_cast<Eigen::Index>(i)] += more;
  }
  const auto found = find(5.0 * noise);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(error(found->predicted), 0.8 * error(as_given));
}

TEST_F(CorrectionOf, IsNoneWhereHeldOutRowsGainLessThanTheyScatter) {
  const double noise = 1e-3;
  const Blocks blocks = holdout_blocks(data_, covariate_levels(data_));
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    measure({}, noise, seed);
    const auto found = find(noise);
    if (!found) continue;
    // The gain of each block, all within three deviations or nearly so.
    std::vector<double> gain(static_cast<std::size_t>(blocks.count), 0.0);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const auto loss = [&](double predicted) {
        const double r = std::abs(data_.rows[i].response - predicted) / noise;
        return r <= 3.0 ? r * r : 6.0 * r - 9.0;
      };
      gain[static_cast<std::size_t>(blocks.of[i])] += loss(clean_[k]) - loss(found->predicted[k]);
    }
    double sum = 0.0, squares = 0.0;
    for (const double g : gain) sum += g;
    const auto count = static_cast<double>(gain.size());
    for (const double g : gain) squares += (g - sum / count) * (g - sum / count);
    EXPECT_GT(sum, 0.999 * std::sqrt(squares * count / (count - 1.0))) << seed;
  }
}

TEST_F(CorrectionOf, ARefitIsBetterOnlyWhereItPredictsHeldOutRowsBetter) {
  const double noise = 1e-3;
  const Candidate level = candidate("friction_level", {.name = "coefficient"});
  const Candidate drag = candidate("drag_constant", {.name = "sun", .body = "sun"});
  const auto contest = [&](const Hypothesis& found) {
    const Problem p = problem();
    return contest_with_refit(p, fit(p, found, noise).hypothesis,
                              candidates_for(simulation_, data_), covariate_levels(data_), noise);
  };
  const Hypothesis by_drag = hypothesis({drag}, {0.0});
  measure(hypothesis({level}, {0.3}), noise, 6);
  for (const Hypothesis& found : {by_drag, Hypothesis{}}) {
    const auto better = contest(found);
    ASSERT_TRUE(better.has_value());
    EXPECT_TRUE(better->refit_is_better());
    EXPECT_GT(better->error, better->refit_error);
    EXPECT_EQ(better->refit.fit.hypothesis.effects.front().cause->id, "friction_level");
    EXPECT_LT(error(better->refit.fit.simulated), noise);
  }
  EXPECT_FALSE(contest(hypothesis({level}, {0.0})).has_value());  // is that refit
  measure(hypothesis({drag}, {0.02}), noise, 6);
  const auto worse = contest(by_drag);
  ASSERT_TRUE(worse.has_value());
  EXPECT_FALSE(worse->refit_is_better());
  EXPECT_LT(worse->error, worse->refit_error);
}

TEST_F(CorrectionOf, RowsOfABlockThatAreMissedTogetherAreNoMoreEvidenceTheMoreTheyAre) {
  const double noise = 1e-3;
  const Candidate drag = candidate("drag_constant", {.name = "sun", .body = "sun"});
  measure(hypothesis({drag}, {0.005}), noise, 6);
  const auto contest = [&] {
    const Problem p = problem();
    return contest_with_refit(p, fit(p, hypothesis({drag}, {0.0}), noise).hypothesis,
                              candidates_for(simulation_, data_), covariate_levels(data_), noise);
  };
  const auto once = contest();
  const std::vector<Observation> rows = data_.rows;
  data_.rows.insert(data_.rows.end(), rows.begin(), rows.end());
  const auto twice = contest();
  ASSERT_TRUE(once && twice);
  EXPECT_NEAR(twice->gain, 2.0 * once->gain, 1e-6 * once->gain);
  EXPECT_NEAR(twice->least_gain, once->least_gain, 1e-6 * std::abs(once->least_gain));
}

TEST_F(CorrectionOf, BlocksWithoutARowThatCountsAreNoEvidence) {
  // One load alone is warm, so that without it nothing is known of what warmth does.
  data_ = measured_grid({.sun_speeds_rpm = {600.0},
                         .output_torques_Nm = {5.0, 15.0, 30.0, 50.0},
                         .rotations = {1},
                         .repeats = 6});
  for (Observation& row : data_.rows) {
    row.condition.temperature_K = row.condition.output_torque_Nm > 40.0 ? 313.15 : 293.15;
  }
  const double noise = 1e-3;
  const auto all = candidates_for(simulation_, data_);
  const auto warmth = std::ranges::find_if(all, [](const Candidate& c) {
    return c.cause->id == "friction_temperature" && c.form.name == "from_coldest";
  });
  ASSERT_NE(warmth, all.end());
  const Candidate drag = candidate("drag_constant", {.name = "sun", .body = "sun"});
  const Hypothesis truth = hypothesis({drag, *warmth}, {0.004, -0.005});
  measure(truth, noise, 8);
  const Problem p = problem();
  const Hypothesis found = fit(p, truth, noise).hypothesis;
  const auto levels = covariate_levels(data_);
  const auto contest = contest_with_refit(p, found, all, levels, noise);
  const auto blocks = blocks_along("load", levels);
  ASSERT_TRUE(contest && blocks);
  ASSERT_EQ(blocks->count, 4);
  const Eigen::VectorXd by_found = predict_left_out(p, found, *blocks);
  const Eigen::VectorXd by_refit = predict_held_out(p, contest->refit.fit.hypothesis, *blocks);
  std::vector<double> sums;
  for (int b = 0; b < blocks->count; ++b) {
    double sum = 0.0;
    bool counts = false;
    for (Eigen::Index i = 0; i < by_found.size(); ++i) {
      if (blocks->of[static_cast<std::size_t>(i)] != b || std::isnan(by_found[i])) continue;
      const double y = p.data.rows[static_cast<std::size_t>(i)].response;
      sum += huber_square((y - by_refit[i]) / noise) - huber_square((y - by_found[i]) / noise);
      counts = true;
    }
    if (counts) sums.push_back(sum);
  }
  ASSERT_EQ(sums.size(), 3U);
  const double sum = sums[0] + sums[1] + sums[2];
  double squares = 0.0;
  for (const double x : sums) squares += (x - sum / 3.0) * (x - sum / 3.0);
  EXPECT_NEAR(contest->least_gain, sum / std::sqrt(1.5 * squares), 1e-9);
}

TEST_F(CorrectionOf, RowsFarOffCountByTheirDistanceWhereASimulationIsHeldAgainstARefit) {
  const double noise = 1e-3;
  measure(hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.05}), noise, 6);
  const Eigen::VectorXd torque = simulated(simulation_, data_, {}).value();
  data_.rows[3].response += 1000.0 * noise;
  const Problem p = problem();
  const auto contest =
      contest_with_refit(p, {}, candidates_for(simulation_, data_), covariate_levels(data_), noise);
  ASSERT_TRUE(contest.has_value());
  double expected = 0.0;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const double off =
        std::abs(data_.rows[i].response - torque[static_cast<Eigen::Index>(i)]) / noise;
    expected += off <= 3.0 ? off * off : 6.0 * off - 9.0;
  }
  // The three loads are left out in turn, and the three speeds.
  EXPECT_NEAR(contest->missed, 2.0 * expected, 1e-9 * expected);
  EXPECT_FALSE(is_much_worse(1.10, 1.0));
  EXPECT_TRUE(is_much_worse(1.11, 1.0));
}

TEST_F(CorrectionOf, RowsThatAgreeHaveNone) {
  measure({}, 0.0, 0);
  EXPECT_FALSE(find(1e-3).has_value());
}

}  // namespace
}  // namespace gear3k::calibrate::correction_test
