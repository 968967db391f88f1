#include "calibrate/search/noise_from_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>

#include "tests/calibrate/rig_campaign.hpp"

namespace gear3k::calibrate::noise_from_fit_test {
namespace {

/// Rows of a campaign with responses of the baseline's own plus noise of our choice.
class NoiseFromFit : public testing::Test {
 protected:
  NoiseFromFit()
      : simulation_(design_of(rig::bilateral_drive_gear()), Kind::kTransmission),
        data_(campaign(Kind::kTransmission)) {
    const Eigen::VectorXd y = simulated(simulation_, data_, {}).value();
    clean_.assign(y.begin(), y.end());
    mean_ = y.mean();
  }
  /// @param deviation  of a row's noise by its response
  void measure(std::uint64_t seed, const std::function<double(double)>& deviation) {
    RandomBits random(seed);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = clean_[i] + deviation(clean_[i]) * random.normal();
    }
  }
  /// Sessions of equal length, of which each has a mean of its own.
  void split(int sessions, std::uint64_t seed, double deviation) {
    RandomBits random(seed);
    data_.runs.clear();
    std::vector<double> mean;
    for (int r = 0; r < sessions; ++r) {
      data_.runs.push_back(std::to_string(r));
      mean.push_back(deviation * random.normal());
    }
    const std::size_t length = data_.rows.size() / static_cast<std::size_t>(sessions);
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      const std::size_t r = std::min(i / length, mean.size() - 1);
      data_.rows[i].condition.run = static_cast<int>(r);
      data_.rows[i].response += mean[r];
    }
  }
  [[nodiscard]] Problem problem() const {
    return {.simulation = simulation_, .data = data_, .noise = make_noise_model(data_)};
  }
  /// A search that found nothing.
  [[nodiscard]] static SearchResult nothing(const Problem& problem) {
    SearchResult result;
    result.fit = fit(problem, {}, 1.0);
    result.scale = robust_deviation(result.fit.residual);
    result.candidates = candidates_for(problem.simulation, problem.data);
    return result;
  }

  /// The greatest weight over the least.
  [[nodiscard]] static double spread(const Eigen::VectorXd& weights) {
    return weights.maxCoeff() / weights.minCoeff();
  }
  [[nodiscard]] double largest_ratio() const {
    const auto [low, high] = std::ranges::minmax(clean_);
    return high / low;
  }

  Simulation simulation_;
  MeasurementSet data_;
  std::vector<double> clean_;
  double mean_ = 0.0;
};

TEST_F(NoiseFromFit, WeighsRowsWhereScatterFollowsTheResponse) {
  int weighed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    measure(seed, [](double y) { return 0.01 * y; });
    const Problem p = problem();
    const auto weights = weights_by_response(p, nothing(p));
    if (!weights) continue;
    ++weighed;
    // All but in proportion to 1/y, whatever the common factor: full scale is hard to rule out.
    EXPECT_GT(spread(*weights), 0.6 * largest_ratio());
    EXPECT_LE(spread(*weights), largest_ratio() * (1.0 + 1e-9));
  }
  EXPECT_GE(weighed, 19);
}

TEST_F(NoiseFromFit, WeighsRowsOfReadingAndFullScale) {
  // The deviation rises from a to 3 a or so: as much as the weights fall, a row's own luck aside.
  const double b = 2.0 / largest_ratio();
  const auto deviation = [&](double y) {
    return 0.01 * mean_ * std::hypot(1.0, b * y / *std::ranges::min_element(clean_));
  };
  int weighed = 0;
  double middle = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    measure(seed, deviation);
    const Problem p = problem();
    const auto weights = weights_by_response(p, nothing(p));
    if (!weights) continue;
    ++weighed;
    middle += std::log(spread(*weights));
  }
  ASSERT_GE(weighed, 10);
  const auto [low, high] = std::ranges::minmax(clean_);
  EXPECT_NEAR(std::exp(middle / weighed) / (deviation(high) / deviation(low)), 1.0, 0.5);
}

TEST_F(NoiseFromFit, LeavesRowsAloneThatScatterAlike) {
  int weighed = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    measure(seed, [&](double) { return 0.01 * mean_; });
    const Problem p = problem();
    if (weights_by_response(p, nothing(p))) ++weighed;
  }
  EXPECT_LE(weighed, 2);
  // A stated deviation is taken at its word.
  measure(1, [](double y) { return 0.05 * y; });
  for (Observation& row : data_.rows) row.sigma = 0.01;
  const Problem p = problem();
  EXPECT_FALSE(weights_by_response(p, nothing(p)).has_value());
}

TEST_F(NoiseFromFit, FindsSessionsThatScatter) {
  // τ = 3 σ in 12 sessions: τ²/σ² = 9, guarded upwards, and never far below.
  const double sigma = 0.01 * mean_;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    measure(seed, [&](double) { return sigma; });
    split(12, seed + 100, 3.0 * sigma);
    const Problem p = problem();
    const SessionScatter scatter = session_scatter(p, nothing(p));
    EXPECT_GT(scatter.estimate, 1.0) << seed;
    EXPECT_LT(scatter.estimate, 30.0) << seed;
    EXPECT_GT(scatter.guarded, scatter.estimate) << seed;
  }
}

TEST_F(NoiseFromFit, FindsHowMuchSessionsScatterInNoiseThatRemembers) {
  // Neighbours correlate by 0.7, so that the readings of a session say less of it than their
  // number.
  constexpr double kCorrelation = 0.7, kScatter = 3.0;
  const double sigma = 0.01 * mean_;
  for (std::size_t i = 0; i < data_.rows.size(); ++i) {
    data_.rows[i].condition.time_s = static_cast<double>(i);
  }
  double logs = 0.0;
  constexpr int kSeeds = 40;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    RandomBits random(seed);
    double off = random.normal();
    for (std::size_t i = 0; i < data_.rows.size(); ++i) {
      data_.rows[i].response = clean_[i] + sigma * off;
      off = kCorrelation * off + std::sqrt(1.0 - kCorrelation * kCorrelation) * random.normal();
    }
    split(12, seed + 100, kScatter * sigma);
    Problem p = problem();
    p.noise.memory = {.share = 1.0, .decay = kCorrelation};
    logs += std::log(session_scatter(p, nothing(p)).estimate / (kScatter * kScatter));
  }
  // The estimate of 11 degrees of freedom: its logarithm is low by 0.09 and scatters by 0.45.
  EXPECT_NEAR(logs / kSeeds, -0.09, 0.3);
}

TEST_F(NoiseFromFit, OffersFewPlacesOfAStepAmongManySessions) {
  const auto steps = [&](int sessions) {
    split(sessions, 1, 0.0);
    const auto all = candidates_for(simulation_, data_);
    return std::ranges::count_if(all, [](const Candidate& c) { return c.cause->id == "run_step"; });
  };
  // From or until each of the later ones, in one alone but the last, and all with a value each, on
  // five targets.
  EXPECT_EQ(steps(4), 5 * (2 * 3 + 2 + 1));
  const auto many = steps(40);
  EXPECT_EQ(many, 5 * 2 * 31);
  EXPECT_EQ(steps(60), many);
}

TEST_F(NoiseFromFit, TakesASingleStepForNoScatter) {
  const double sigma = 0.01 * mean_;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    measure(seed, [&](double) { return sigma; });
    split(4, seed, 0.0);
    for (Observation& row : data_.rows) {
      if (row.condition.run >= 2) row.response += 5.0 * sigma;
    }
    const Problem p = problem();
    EXPECT_EQ(session_scatter(p, nothing(p)).guarded, 0.0) << seed;
  }
  // Nor is one odd session of four, nor an offset that all have in common, however great.
  for (const int odd : {0, 1, 2, 3, -1}) {
    measure(7, [&](double) { return sigma; });
    split(4, 1, 0.0);
    for (Observation& row : data_.rows) {
      if (odd < 0 || row.condition.run == odd) row.response += 40.0 * sigma;
    }
    const Problem p = problem();
    EXPECT_EQ(session_scatter(p, nothing(p)).guarded, 0.0) << odd;
  }
  // Three sessions cannot say how sessions scatter.
  split(3, 1, 10.0 * sigma);
  const Problem p = problem();
  EXPECT_EQ(session_scatter(p, nothing(p)).guarded, 0.0);
}

}  // namespace
}  // namespace gear3k::calibrate::noise_from_fit_test
