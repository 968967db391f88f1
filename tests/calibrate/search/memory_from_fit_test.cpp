#include "calibrate/search/memory_from_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

TEST_F(MemoryFromFit, IsToldInThePlaceOfACause) {
  measure(1, 0.7);
  const auto d = diagnose(simulation_, data_, {});
  EXPECT_GT(d->memory.memory.correlation(), 0.3);
  EXPECT_EQ(d->verdict, Verdict::kNoDiscrepancy);
}

}  // namespace
}  // namespace gear3k::calibrate::memory_from_fit_test
