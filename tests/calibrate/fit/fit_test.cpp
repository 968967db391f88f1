#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "calibrate/fit/final_fit.hpp"
#include "tests/calibrate/rig_campaign.hpp"
#include "tests/rig/deterministic_random.hpp"
#include "tests/sample.hpp"

namespace gear3k::calibrate::fit_test {
namespace {

enum class Of { kDesign, kBlackBox, kPair };

/// A gearbox with drags, so that those which depend on temperature have something to change.
Subject subject_of(Of of) {
  design::Design design = design_of(rig::bilateral_drive_gear());
  design.shafts.drag[design::kSunShaft] = {
      .constant_Nm = 0.004, .viscous_Nms = 2e-5, .quadratic_Nms2 = 1e-7};
  if (of == Of::kBlackBox) return some_black_box();
  if (of == Of::kPair) return pair_of(design);
  return design;
}

struct Case {
  Kind kind;
  Of of;
};
std::string name_of(const testing::TestParamInfo<Case>& info) {
  std::string name{kKindNames[static_cast<std::size_t>(info.param.kind)]};
  name += info.param.of == Of::kDesign ? "_design"
          : info.param.of == Of::kPair ? "_pair"
                                       : "_black_box";
  return name;
}

class EveryForm : public testing::TestWithParam<Case> {
 protected:
  EveryForm()
      : simulation_(subject_of(GetParam().of), GetParam().kind),
        all_(campaign(GetParam().kind)),
        data_(all_.rows.size() > 60 ? thinned(all_, 5) : all_),
        candidates_(candidates_for(simulation_, all_)),
        problem_{.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)},
        size_(measured(data_).cwiseAbs().mean()) {}

  [[nodiscard]] static std::string told(const Candidate& c) {
    return std::string(c.cause->id) + ' ' + c.form.name + ' ' + c.form.body;
  }
  [[nodiscard]] Eigen::VectorXd at(const Hypothesis& h) const {
    return simulated(simulation_, data_, h).value();
  }
  /// Derivative by a parameter of a hypothesis, by central differences.
  [[nodiscard]] Eigen::VectorXd difference(Hypothesis h, std::size_t parameter, double step) const {
    const double value = h.value[parameter];
    h.value[parameter] = value + step;
    const Eigen::VectorXd above = at(h);
    h.value[parameter] = value - step;
    return (above - at(h)) / (2.0 * step);
  }
  /// Expects a column to be the derivative.
  void expect_derivative(const Eigen::VectorXd& column, const Hypothesis& h, std::size_t parameter,
                         const std::string& what) const {
    const double greatest = column.cwiseAbs().maxCoeff();
    // Two steps, extrapolated: truncation is of the fourth order in a change of the response by
    // 1e-3 at most, rounding some 1e-12.
    const double step = greatest > 0.0 ? std::min(1e-3 * size_ / greatest, 0.01) : 1e-3;
    const Eigen::VectorXd found =
        (4.0 * difference(h, parameter, 0.5 * step) - difference(h, parameter, step)) / 3.0;
    const double tolerance = 2e-7 * greatest + 3e-13 * size_ / step;
    EXPECT_LT((column - found).cwiseAbs().maxCoeff(), tolerance) << what << ' ' << parameter;
  }
  [[nodiscard]] static Hypothesis with(Hypothesis h, const Candidate& c) {
    h.effects.push_back(c);
    h.value.resize(h.value.size() + c.parameters.size(), 0.0);
    return h;
  }
  /// Values that change the response by a few percent; 0.2 where a parameter acts only together
  /// with another.
  [[nodiscard]] std::vector<double> some_values(const Candidate& c) const {
    const Linearisation linear = linearise(problem_, {}, {c});
    std::vector<double> values;
    values.reserve(c.parameters.size());
    for (Eigen::Index k = 0; k < linear.other.cols(); ++k) {
      const double greatest = linear.other.col(k).cwiseAbs().maxCoeff();
      values.push_back(greatest > 0.0 ? 0.03 * size_ / greatest : 0.2);
    }
    return values;
  }

  Simulation simulation_;
  MeasurementSet all_, data_;
  std::vector<Candidate> candidates_;
  Problem problem_;
  double size_;
};

TEST_P(EveryForm, HasTheDerivativesOfCentralDifferencesAtZero) {
  ASSERT_FALSE(candidates_.empty());
  const Linearisation linear = linearise(problem_, {}, candidates_);
  ASSERT_TRUE(linear.runs);
  Eigen::Index column = 0;
  for (const Candidate& c : candidates_) {
    const Hypothesis alone = with({}, c);
    for (std::size_t k = 0; k < c.parameters.size(); ++k) {
      expect_derivative(linear.other.col(column++), alone, k, told(c));
    }
  }
  EXPECT_EQ(column, linear.other.cols());
}

TEST_P(EveryForm, HasThemBesideOtherCausesToo) {
  // With the first and the last candidate of one parameter in the model already.
  Hypothesis known;
  for (const Candidate& c : {candidates_.front(), candidates_.back()}) {
    known = with(known, c);
    const auto values = some_values(c);
    std::ranges::copy(values, known.value.end() - static_cast<std::ptrdiff_t>(values.size()));
  }
  // Every third form: each has its own derivatives at zero and at other values tested by itself.
  std::vector<Candidate> others;
  for (std::size_t k = 0; k < candidates_.size(); k += sample<std::size_t>(3, 1)) {
    const Candidate& c = candidates_[k];
    if (std::ranges::none_of(known.effects,
                             [&](const Candidate& e) { return e.cause == c.cause; })) {
      others.push_back(c);
    }
  }
  const Linearisation linear = linearise(problem_, known, others);
  EXPECT_LT((linear.simulated - at(known)).norm(), 1e-15 * size_);
  for (std::size_t k = 0; k < known.value.size(); ++k) {
    expect_derivative(linear.own.col(static_cast<Eigen::Index>(k)), known, k, "own");
  }
  Eigen::Index column = 0;
  for (const Candidate& c : others) {
    const Hypothesis both = with(known, c);
    for (std::size_t k = 0; k < c.parameters.size(); ++k) {
      expect_derivative(linear.other.col(column++), both, known.value.size() + k, told(c));
    }
  }
}

TEST_P(EveryForm, HasThemAtOtherValues) {
  for (const Candidate& c : candidates_) {
    Hypothesis h = with({}, c);
    h.value = some_values(c);
    const Linearisation linear = linearise(problem_, h, {});
    for (std::size_t k = 0; k < h.value.size(); ++k) {
      expect_derivative(linear.own.col(static_cast<Eigen::Index>(k)), h, k, told(c));
    }
  }
}

TEST_P(EveryForm, IsFoundAgainInItsOwnDataWithoutNoise) {
  for (const Candidate& c : candidates_) {
    const Hypothesis nothing = with({}, c);
    const Linearisation linear = linearise(problem_, {}, {c});
    // A form that these few rows cannot show, or not with all of its parameters at once.
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(linear.other);
    qr.setThreshold(1e-6);
    const bool scale = c.form.name == "slow_excess_any_scale";
    if (qr.rank() < linear.other.cols() && !scale) continue;
    Hypothesis truth = nothing;
    truth.value = some_values(c);
    MeasurementSet data = data_;
    const Eigen::VectorXd y = at(truth);
    for (std::size_t i = 0; i < data.rows.size(); ++i) {
      data.rows[i].response = y[static_cast<Eigen::Index>(i)];
    }
    const Problem problem{.simulation = simulation_, .data = data, .noise = make_noise_model(data)};
    // The scale of the residuals that are left, from one fit to the next.
    Hypothesis h = nothing;
    for (const double share : {0.1, 1e-3, 1e-6}) h = fit(problem, h, share * size_).hypothesis;
    for (std::size_t k = 0; k < truth.value.size(); ++k) {
      EXPECT_NEAR(h.value[k], truth.value[k], 1e-6 * std::abs(truth.value[k])) << told(c) << k;
    }
  }
}

TEST_P(EveryForm, IsNearbyWhatItIsInASimulationOfItsOwn) {
  for (std::size_t index = 0; index < candidates_.size(); index += sample<std::size_t>(5, 1)) {
    const Candidate& c = candidates_[index];
    Hypothesis h = with({}, c);
    h.value = some_values(c);
    const auto times = [&](double factor) {
      std::vector<double> value = h.value;
      for (double& v : value) v *= factor;
      return value;
    };
    constexpr double kRoom = 0.1;
    const NearbyRows nearby(problem_, h, kRoom);
    // Greatest difference with all values greater by a share.
    const auto error = [&](double share) {
      Hypothesis moved = h;
      moved.value = times(1.0 + share);
      const Linearisation rows = nearby.at(moved.value);
      EXPECT_TRUE(rows.runs) << told(c);
      return (rows.simulated - at(moved)).cwiseAbs().maxCoeff();
    };
    if (nearby.is_exact_at(times(1.03))) {
      EXPECT_LT(error(0.03), 1e-6 * size_) << told(c);
    } else {
      // Linear in what acts in the gearbox: half as far, a quarter as wrong.
      EXPECT_LT(error(0.015), 0.3 * error(0.03) + 1e-6 * size_) << told(c);
    }
    if (c.cause->id == std::string("run_step") && changes_row_friction(c)) {
      EXPECT_FALSE(nearby.at(times(50.0)).runs) << told(c) << ": friction beyond the room";
    }
  }
}

TEST_P(EveryForm, BelongsToACauseOfItsKind) {
  std::set<std::string> ids;
  for (const Candidate& c : candidates_) ids.insert(std::string(c.cause->id));
  const std::size_t expected = GetParam().kind == Kind::kTransmission ? 15
                               : GetParam().kind == Kind::kLostMotion ? 7
                               : GetParam().kind == Kind::kPairLoss   ? 5
                                                                      : 4;
  // A black box has no teeth: neither mesh orders nor thermal expansion.
  const std::size_t without = GetParam().of != Of::kBlackBox           ? 0
                              : GetParam().kind == Kind::kTransmission ? 1
                              : GetParam().kind == Kind::kLostMotion   ? 2
                                                                       : 0;
  EXPECT_EQ(ids.size(), expected - without);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, EveryForm,
    testing::Values(Case{Kind::kTransmission, Of::kDesign},
                    Case{Kind::kTransmission, Of::kBlackBox}, Case{Kind::kLostMotion, Of::kDesign},
                    Case{Kind::kLostMotion, Of::kBlackBox}, Case{Kind::kTorqueAngle, Of::kDesign},
                    Case{Kind::kTorqueAngle, Of::kBlackBox}, Case{Kind::kPairLoss, Of::kDesign},
                    Case{Kind::kPairLoss, Of::kPair}),
    name_of);

// Fits of several causes

/// Friction and drag on the bilateral drive gear, a sixth of the campaign's rows.
class FrictionAndDrag : public testing::Test {
 protected:
  FrictionAndDrag()
      : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission),
        data_(thinned(campaign(Kind::kTransmission), 5)),
        start_(hypothesis({candidate("friction_level", {.name = "coefficient"}),
                           candidate("drag_constant", {.name = "sun", .body = "sun"})},
                          {0.0, 0.0})) {}

  /// Measures what the simulation says at other values, with normal deviations.
  void measure(const std::vector<double>& value, double sd, std::uint64_t seed) {
    Hypothesis truth = start_;
    truth.value = value;
    const Eigen::VectorXd y = simulated(simulation_, data_, truth).value();
    rig::DeterministicRandom random(seed);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = y[static_cast<Eigen::Index>(i)] + sd * random.normal();
    }
  }
  [[nodiscard]] Problem problem() const {
    return {.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
  }

  Simulation simulation_;
  MeasurementSet data_;
  Hypothesis start_;
};

TEST_F(FrictionAndDrag, AreFoundAgainExactlyWithoutNoise) {
  measure({0.37, 0.011}, 0.0, 0);
  const FinalFit final = final_fit(problem(), start_, 0.05);
  EXPECT_NEAR(final.hypothesis.value[0], 0.37, 1e-6);
  EXPECT_NEAR(final.hypothesis.value[1], 0.011, 1e-8);
  EXPECT_LT(final.scale, 1e-7);
  EXPECT_EQ(final.degrees, static_cast<int>(data_.rows.size()) - 2);
  EXPECT_EQ(final.at_bound, (std::vector<bool>{false, false}));
}

TEST_F(FrictionAndDrag, OfOneConditionAreNotDetermined) {
  EXPECT_EQ(final_fit(problem(), start_, 0.05).determined, (std::vector<bool>{true, true}));
  data_.rows.assign(20, data_.rows.front());
  data_.covariates.clear();
  measure({0.37, 0.011}, 0.001, 6);
  EXPECT_EQ(final_fit(problem(), start_, 0.001).determined, (std::vector<bool>{false, false}));
}

TEST_F(FrictionAndDrag, BothFitsAgreeOnNoisyData) {
  constexpr double kNoise = 0.004;
  measure({0.37, 0.011}, kNoise, 5);
  Fit search = fit(problem(), start_, kNoise);
  search = fit(problem(), search.hypothesis, kNoise);
  const FinalFit final = final_fit(problem(), start_, kNoise);
  for (std::size_t k = 0; k < 2; ++k) {
    const double sd =
        std::sqrt(final.covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
    // fit() stops where a step gains less than 1e-4 in χ²: within 0.01 standard deviations.
    EXPECT_NEAR(search.hypothesis.value[k], final.hypothesis.value[k], 0.02 * sd);
  }
}

TEST_F(FrictionAndDrag, CovarianceIsThatOfRepeatedMeasurements) {
  constexpr double kNoise = 0.004;
  const std::vector<double> truth{0.3, 0.02};
  constexpr int kSeeds = 250;
  Eigen::Matrix2d sample = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d stated = Eigen::Matrix2d::Zero();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double variance = 0.0;
  int covered = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    measure(truth, kNoise, static_cast<std::uint64_t>(seed));
    const FinalFit final = final_fit(problem(), start_, kNoise);
    const Eigen::Vector2d error(final.hypothesis.value[0] - truth[0],
                                final.hypothesis.value[1] - truth[1]);
    mean += error / kSeeds;
    sample += error * error.transpose() / kSeeds;
    stated += final.covariance / kSeeds;
    variance += final.scale * final.scale / kSeeds;
    covered += std::abs(error[0]) < 2.074 * std::sqrt(final.covariance(0, 0)) ? 1 : 0;
  }
  ASSERT_EQ(data_.rows.size(), 24U);  // 22 degrees of freedom: t = 2.074 at 95 %
  // A variance of 250 samples has a relative standard deviation of √(2/250) = 9 %; three of them.
  for (const Eigen::Index k : {0, 1}) {
    EXPECT_NEAR(sample(k, k) / stated(k, k), 1.0, 0.27) << k;
    EXPECT_LT(std::abs(mean[k]), 3.5 * std::sqrt(stated(k, k) / kSeeds)) << k;
  }
  const double correlation = sample(0, 1) / std::sqrt(sample(0, 0) * sample(1, 1));
  EXPECT_NEAR(correlation, stated(0, 1) / std::sqrt(stated(0, 0) * stated(1, 1)), 0.15);
  // Relative standard deviation √(2/(22 · 250)) = 2 %.
  EXPECT_NEAR(variance / (kNoise * kNoise), 1.0, 0.06);
  // Three binomial standard deviations of 1.4 %.
  EXPECT_NEAR(1.0 * covered / kSeeds, 0.95, 0.045);
}

TEST_F(FrictionAndDrag, CovarianceHoldsWhereFewRowsScatterMost) {
  // Noise of the reading: rows of great load, which say most of friction, scatter most.
  const std::vector<double> truth{0.3, 0.02};
  constexpr int kSeeds = 250;
  double sample = 0.0;
  double stated = 0.0;
  int covered = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    measure(truth, 0.0, 0);
    rig::DeterministicRandom random(static_cast<std::uint64_t>(seed));
    const double mean = measured(data_).mean();
    for (Observation& row : data_.rows) {
      row.response += 0.004 * row.response / mean * random.normal();
    }
    const FinalFit final = final_fit(problem(), start_, 0.004);
    const double error = final.hypothesis.value[0] - truth[0];
    sample += error * error / kSeeds;
    stated += final.covariance(0, 0) / kSeeds;
    covered += std::abs(error) < 2.074 * std::sqrt(final.covariance(0, 0)) ? 1 : 0;
  }
  EXPECT_LT(sample / stated, 1.27);
  EXPECT_GT(sample / stated, 0.5);
  // Four binomial standard deviations below 95 %.
  EXPECT_GE(1.0 * covered / kSeeds, 0.895);
}

TEST_F(FrictionAndDrag, ABoundThatIsHitIsFlagged) {
  // A drag below nothing: the best that is allowed is none.
  measure({0.2, -0.02}, 0.0, 0);
  const FinalFit final = final_fit(problem(), start_, 0.05);
  EXPECT_EQ(final.at_bound, (std::vector<bool>{false, true}));
  EXPECT_EQ(final.hypothesis.value[1], 0.0);
  EXPECT_EQ(fit(problem(), start_, 0.05).hypothesis.value[1], 0.0);
}

TEST_F(FrictionAndDrag, AtABoundTheOtherParametersAreTheBestThatAreLeft) {
  for (const double drag_Nm : {-0.02, -0.005, -0.001}) {
    measure({0.2, drag_Nm}, 0.0, 0);
    // The friction that is best without any drag, by golden section.
    const auto sum = [&](double level) {
      Hypothesis h = start_;
      h.value[0] = level;
      return (measured(data_) - simulated(simulation_, data_, h).value()).squaredNorm();
    };
    double low = -0.9;
    double high = 2.0;
    for (int k = 0; k < 60; ++k) {
      const double a = low + 0.381966 * (high - low);
      const double b = low + 0.618034 * (high - low);
      (sum(a) < sum(b) ? high : low) = sum(a) < sum(b) ? b : a;
    }
    // Of fits that end where the sum over scale² gains less than 1e-4.
    constexpr double kScale = 0.05;
    const double least = sum(low);
    const double tolerance = 2e-4 * kScale * kScale;
    EXPECT_LT(sum(fit(problem(), start_, kScale).hypothesis.value[0]), least + tolerance);
    EXPECT_LT(sum(final_fit(problem(), start_, kScale).hypothesis.value[0]), least + tolerance);
    EXPECT_NEAR(final_fit(problem(), start_, kScale).hypothesis.value[0], low, 1e-3);
  }
}

TEST_F(FrictionAndDrag, AnUpperBoundIsFlaggedToo) {
  start_ = hypothesis({candidate("friction_level", {.name = "coefficient"})}, {0.0});
  start_.effects[0].parameters[0].upper = 0.25;
  measure({0.5}, 0.0, 0);
  const FinalFit final = final_fit(problem(), start_, 0.05);
  EXPECT_EQ(final.at_bound, (std::vector<bool>{true}));
  EXPECT_EQ(final.hypothesis.value[0], 0.25);
}

TEST_F(FrictionAndDrag, AFewWildRowsHardlyMoveTheFit) {
  constexpr double kNoise = 0.004;
  measure({0.37, 0.011}, kNoise, 9);
  const FinalFit clean = final_fit(problem(), start_, kNoise);
  data_.rows[7].response += 100.0 * kNoise;
  const FinalFit wild = final_fit(problem(), start_, kNoise);
  // A row counts as three standard deviations at most; of 24 rows it has at most a third of the
  // weight on either parameter, so that neither moves by more than about one of its own.
  for (std::size_t k = 0; k < 2; ++k) {
    const double sd =
        std::sqrt(clean.covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
    EXPECT_LT(std::abs(wild.hypothesis.value[k] - clean.hypothesis.value[k]), 2.0 * sd);
  }
}

TEST(Winsorised, ResidualsBeyondThreeDeviationsCountAsThree) {
  const Eigen::VectorXd x = Eigen::Vector4d(-7.0, -5.9, 0.1, 6.1);
  EXPECT_EQ(winsorised(x, 2.0), Eigen::VectorXd(Eigen::Vector4d(-6.0, -5.9, 0.1, 6.0)));
  EXPECT_EQ(winsorised(x, 0.0), x);
}

}  // namespace
}  // namespace gear3k::calibrate::fit_test
