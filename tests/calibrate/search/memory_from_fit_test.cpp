#include "calibrate/search/memory_from_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "calibrate/fit/screen.hpp"
#include "calibrate/verdict/diagnosis.hpp"
#include "tests/calibrate/rig_campaign.hpp"

namespace gear3k::calibrate::memory_from_fit_test {
namespace {

/// Rows in time whose responses are the baseline's own plus noise of our choice.
class MemoryFromFit : public testing::Test {
 protected:
  MemoryFromFit()
      : simulation_(some_black_box(), Kind::kTransmission), data_(campaign(Kind::kTransmission)) {
    const Eigen::VectorXd y = simulated(simulation_, data_, {}).value();
    clean_.assign(y.begin(), y.end());
    sigma_ = 0.01 * y.mean();
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].condition.time_s = 60.0 * static_cast<double>(i);
    }
  }
  /// Autoregression of first order, of variance σ².
  void measure(std::uint64_t seed, double correlation) {
    RandomBits random(seed);
    double before = random.normal();
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = clean_[i] + sigma_ * before;
      before = correlation * before + std::sqrt(1.0 - correlation * correlation) * random.normal();
    }
  }
  [[nodiscard]] Problem problem() const {
    return {.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
  }

  Simulation simulation_;
  MeasurementSet data_;
  std::vector<double> clean_;
  double sigma_ = 0.0;
};

TEST_F(MemoryFromFit, FindsTheCorrelationOfReadings) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    measure(seed, 0.5);
    const MemoryEstimate m = memory_of(problem(), {}, 0.03);
    EXPECT_LT(m.p_value, 0.03) << seed;
    EXPECT_NEAR(m.memory.correlation(), 0.5, 0.3) << seed;
    inside += m.low <= 0.5 && 0.5 <= m.high ? 1 : 0;
  }
  EXPECT_GE(inside, 17);
}

TEST_F(MemoryFromFit, IsRareInIndependentReadings) {
  int found = 0;
  int tenth = 0;
  constexpr int kSeeds = 200;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    measure(seed, 0.0);
    const double p = memory_of(problem(), {}, 0.03).p_value;
    found += p <= 0.03 ? 1 : 0;
    tenth += p <= 0.1 ? 1 : 0;
  }
  // 99.9 % of binomial counts of 3 % and 10 % are below.
  EXPECT_LE(found, 15);
  EXPECT_LE(tenth, 35);
}

TEST_F(MemoryFromFit, SessionsThatDifferAreNoMemory) {
  measure(1, 0.0);
  data_.runs = {"a", "b", "c"};
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const auto run = static_cast<int>(3 * i / data_.rows.size());
    data_.rows[i].condition.run = run;
    data_.rows[i].response += 5.0 * sigma_ * run;
  }
  EXPECT_GT(memory_of(problem(), {}, 0.03).p_value, 0.03);
}

TEST_F(MemoryFromFit, AWaveInTimeIsNoMemory) {
  measure(1, 0.0);
  const auto n = static_cast<double>(data_.rows.size());
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].response +=
        2.0 * sigma_ * std::sin(8.0 * std::numbers::pi * static_cast<double>(i) / n);
  }
  const MemoryEstimate m = memory_of(problem(), {}, 0.03);
  EXPECT_LT(m.p_value, 0.03);
  EXPECT_EQ(m.memory.share, 0.0);
}

TEST_F(MemoryFromFit, NeedsAnOrderAndRows) {
  measure(1, 0.7);
  Problem p = problem();
  p.noise.order = {};
  EXPECT_EQ(memory_of(p, {}, 0.03).p_value, 1.0);
}

TEST(MemoryOfSessions, IsRareBesideWhatIsConstantInEach) {
  // Eight sessions of eleven: the mean of eleven equal numbers is not quite that number.
  constexpr int kSessions = 8, kRows = 11, kSeeds = 100;
  const Simulation simulation(some_black_box(), Kind::kLostMotion);
  MeasurementSet data;
  data.kind = Kind::kLostMotion;
  for (int s = 0; s < kSessions; ++s) {
    data.runs.push_back(std::to_string(s));
    for (int i = 0; i < kRows; ++i) {
      Observation row;
      row.condition.run = s;
      row.condition.time_s = 60.0 * (kRows * s + i);
      row.condition.test_torque_Nm = 5.0 * (1 + (3 * i) % 5);
      data.rows.push_back(row);
    }
  }
  const std::vector<Candidate> all = candidates_for(simulation, data);
  for (const char* id : {"clearance", "run_step"}) {
    const auto cause = std::ranges::find_if(all, [&](const Candidate& c) {
      return c.cause->id == id && (c.cause->id != "run_step" || c.form.name == "sessions");
    });
    ASSERT_NE(cause, all.end()) << id;
    const Hypothesis h = with({}, *cause);
    const Eigen::VectorXd clean = simulated(simulation, data, h).value();
    int found = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      RandomBits random(static_cast<std::uint64_t>(seed));
      for (std::size_t i = 0; i < data.rows.size(); ++i) {
        data.rows[i].response = clean[static_cast<Eigen::Index>(i)] + 1e-4 * random.normal();
      }
      const Problem p{.simulation = simulation, .data = data, .noise = make_noise_model(data)};
      found += memory_of(p, h, 0.03).p_value <= 0.03 ? 1 : 0;
    }
    // 99.9 % of binomial counts of 3 % are below.
    EXPECT_LE(found, 9) << id;
  }
}

TEST_F(MemoryFromFit, EvidenceIsTheMeanOfLikelihoodsByTheCovarianceItself) {
  measure(2, 0.5);
  const Problem p = problem();
  const auto n = static_cast<Eigen::Index>(data_.rows.size());
  const Eigen::VectorXd missed =
      measured(data_) - Eigen::Map<const Eigen::VectorXd>(clean_.data(), n);
  const Eigen::MatrixXd own = Eigen::MatrixXd::Ones(n, 1);
  // −2 ln of the likelihood of one memory: a dense covariance, the mean by generalised squares.
  const auto deviance = [&](double share, double decay) {
    Eigen::MatrixXd c(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) {
        const bool same = data_.rows[static_cast<std::size_t>(i)].condition.run ==
                          data_.rows[static_cast<std::size_t>(k)].condition.run;
        c(i, k) =
            i == k ? 1.0
                   : (same ? share * std::pow(decay, std::abs(static_cast<double>(i - k))) : 0.0);
      }
    }
    const Eigen::LLT<Eigen::MatrixXd> root(c);
    const Eigen::VectorXd y = root.matrixL().solve(missed);
    const Eigen::VectorXd one = root.matrixL().solve(own).col(0);
    const double left = y.squaredNorm() - std::pow(one.dot(y), 2) / one.squaredNorm();
    const Eigen::MatrixXd lower = root.matrixL();
    return 2.0 * lower.diagonal().array().log().sum() +
           static_cast<double>(n) * std::log(left / static_cast<double>(n));
  };
  const double independent = deviance(0.0, 0.5);
  double sum = 0.0;
  int count = 0;
  double least = HUGE_VAL;
  for (const double decay : {0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95}) {
    for (int k = 1; k <= (decay > 0.7 ? 5 : 10); ++k) {
      const double one = deviance(0.1 * k, decay);
      least = std::min(least, one);
      sum += std::exp(-0.5 * (one - independent));
      ++count;
    }
  }
  const double mean = independent - 2.0 * std::log(0.5 * sum / count + 0.5);
  const MemoryEvidence evidence = memory_evidence(p.noise, missed, own, 0.2);
  EXPECT_NEAR(-evidence.twice_log_likelihood, mean, 1e-6 * std::abs(mean));
  EXPECT_NEAR(evidence.likeliest.likelihood_ratio, independent - least, 1e-6);
  EXPECT_NEAR(evidence.likeliest.memory.correlation(), 0.5, 0.25);
}

TEST_F(MemoryFromFit, EvidenceNamesNoMemoryThatReadingsDoNotShow) {
  const auto n = static_cast<Eigen::Index>(data_.rows.size());
  int shown = 0;
  constexpr int kSeeds = 60;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    measure(seed, 0.0);
    const Eigen::VectorXd missed =
        measured(data_) - Eigen::Map<const Eigen::VectorXd>(clean_.data(), n);
    const MemoryEstimate m =
        memory_evidence(problem().noise, missed, Eigen::MatrixXd::Ones(n, 1), 0.2).likeliest;
    EXPECT_EQ(m.memory.share > 0.0, m.p_value <= 0.2) << seed;
    shown += m.memory.share > 0.0 ? 1 : 0;
  }
  // Of 60 with 20 % each 99.9 % have fewer than 23.
  EXPECT_LT(shown, 23);
}

TEST_F(MemoryFromFit, StepsOfTwiceTheNoiseAreNone) {
  measure(3, 0.0);
  data_.runs = {"a", "b", "c", "d"};
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    const auto run = static_cast<int>(4 * i / data_.rows.size());
    data_.rows[i].condition.run = run;
    data_.rows[i].response += (run % 2 == 0 ? 1.5 : -2.0) * sigma_;
  }
  const auto d = diagnose(simulation_, data_, {});
  ASSERT_EQ(d->effects.size(), 1U);
  EXPECT_EQ(d->effects[0].id, "run_step");
  EXPECT_EQ(d->memory.memory.share, 0.0);
}

TEST_F(MemoryFromFit, IsToldInThePlaceOfACause) {
  measure(1, 0.7);
  const auto d = diagnose(simulation_, data_, {});
  EXPECT_GT(d->memory.memory.correlation(), 0.3);
  EXPECT_EQ(d->verdict, Verdict::kNoDiscrepancy);
}

}  // namespace
}  // namespace gear3k::calibrate::memory_from_fit_test
